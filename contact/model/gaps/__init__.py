"""Gaps between bodies: point gaps, rims, rubs, disks, their rotation and the loads on them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
