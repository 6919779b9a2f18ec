"""Exact answers of contact problems: impacts of rods, waves in rods, periodic motions with impacts."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
