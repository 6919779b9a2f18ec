"""Periodic motions, their amplitude and stability: orbits by shooting, branches by continuation."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
