"""pliant deforms 3-D shapes: control many points with few.

Names are loaded when they are first used, so that importing pliant costs almost nothing. What there is stands
in ``__init__.pyi``.
"""

import lazy_loader

from pliant._version import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
