"""Strict reading, safe writing, checks of names, and the base class of results; independent of physics."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
