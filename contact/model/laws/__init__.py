"""Further contact laws: force as a function of depth and rate, a table, a law of your own."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
