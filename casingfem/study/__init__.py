"""Study files: reading study.toml, its schema, and writing of updated studies."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
