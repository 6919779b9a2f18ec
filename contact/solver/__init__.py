"""Contact problems of one step, for schemes of your own; compiled when they are first called."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
