"""Growth of motions in contact: poles of closed contact, coincidences, Floquet, maps over speed, growth of a run."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
