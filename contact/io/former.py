"""Names that stood at the top of a package once: they still work, and say what they are called now."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from importlib import import_module


def former(package: str, names: Mapping[str, str], name: str) -> object:
    """What a name of before stands for, `names` from there to here; warns of the one it has now.

    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     found = former("contact", {"HHT": "scheme.HHT"}, "HHT")
    >>> print(caught[0].message)
    contact.HHT is contact.scheme.HHT now
    """
    found: object = import_module(package)
    for part in names[name].split("."):
        found = getattr(found, part)
    warnings.warn(f"{package}.{name} is {package}.{names[name]} now", DeprecationWarning, stacklevel=3)
    return found


def by_room(rooms: Mapping[str, str], renamed: Mapping[str, str]) -> dict[str, str]:
    """Names of now by those of before: of those that moved into a room as they were, and of those that changed.

    >>> by_room({"scheme": "HHT MoreauJean"}, {"Tip": "ContactPoint"})
    {'HHT': 'scheme.HHT', 'MoreauJean': 'scheme.MoreauJean', 'Tip': 'ContactPoint'}
    """
    moved = {name: f"{room}.{name}" for room, names in rooms.items() for name in names.split()}
    return moved | dict(renamed)
