"""Geometry of the mid-surface: charts, meridians, twisted plates, blades, tapers, axes of rotation."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
