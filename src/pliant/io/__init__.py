"""Files: one module a format; detection in :mod:`pliant.io.meshes` and :mod:`pliant.io.transforms`."""
