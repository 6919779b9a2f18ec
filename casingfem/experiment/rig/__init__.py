"""The virtual test rig: records that a test would have made, all marked SYNTHETIC."""

import lazy_loader

FORMER = {"Unkind": "Troubles", "unkind_frfs": "troubled_frfs"}
_exported, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """A name of the stub, or one of before."""
    if name not in FORMER:
        return _exported(name)
    from contact.io.former import former

    return former(__name__, FORMER, name)
