"""Rotors: a disk on a massless shaft, a beam shaft with disks and bearings, given matrices; whirl and unbalance."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
