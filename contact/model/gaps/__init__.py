"""How bodies meet: point gaps, rims, rubs, disks, what turns them and pulls at them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
