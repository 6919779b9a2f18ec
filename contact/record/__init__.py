"""What a run stores: samples, sums, the ledger of its energy, what a coating lost."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
