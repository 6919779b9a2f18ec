"""Measurements around the circumference: orientations from sensors on a circle, and scans by a moving laser spot."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
