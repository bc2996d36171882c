"""Files: one module a format; detection and dispatch in :mod:`pliant.io.registry`."""
