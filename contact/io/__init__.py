"""Strict reading, safe writing, checks of names, and the base of results; nothing here knows physics."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
