"""From random inputs to answers: probabilities with intervals, rare events, which input matters; chances of a rub."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
