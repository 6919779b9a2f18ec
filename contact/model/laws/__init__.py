"""Contact laws beside the usual ones: forces by depth and rate, a table, a law of one's own."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
