"""Measured functions: sets of frequency responses, their files, and their estimation from records."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
