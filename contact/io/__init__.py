"""How are files written whole, read strictly, names kept? What has every result? Nothing here knows physics."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
