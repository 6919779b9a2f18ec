"""What a run means: displacements, forces, histories and films of bodies from stored modal coordinates."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
