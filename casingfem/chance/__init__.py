"""From random inputs to results: probabilities with intervals, rare events, importance of inputs, chances of a rub."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
