"""Plausibility checks of a scene's numbers: those that keys declare, and those that involve several keys."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from contact.io.plausible import CHECKS, Implausible, implausible, refused
from contact.io.tables import value_of
from contact.model.bodies.body import Rod
from contact.scene.problems import SceneError

if TYPE_CHECKING:
    from contact.scene.scheme import CheckedFile


def refusals(table: CheckedFile, file: Path) -> list[str]:
    """Implausible numbers that the file does not allow, a line each: file: key: found X, expected Y."""
    from contact.scene.rods import RodsFile

    found = list(implausible(table, radius=table.radius(file.parent)))
    if isinstance(table, RodsFile):
        found += [one for k, rod in enumerate(table.rod, 1) for one in of_rod(value_of(rod, Rod), f"rod[{k}]")]
    return [f"{file}: {line}" for line in refused(found, table.checks.allow)]


def require_plausible(table: CheckedFile, file: Path) -> None:
    """Raise SceneError with all `refusals`."""
    if found := refusals(table, file):
        raise SceneError(found)


def of_rod(rod: Rod, key: str) -> Iterator[Implausible]:
    """Refuse E or rho of a rod if the other one has the value of a solid in SI.

    Rods may be in any consistent units, as in textbooks (E = 900, rho = 1): then neither has the value of a solid.
    """
    E, rho = CHECKS["E"], CHECKS["rho"]
    if rho.usual[0] <= rod.rho <= rho.usual[1] and (text := E.fault(rod.E)):
        yield Implausible(f"{key}.E", "E", text)
    if E.usual[0] <= rod.E <= E.usual[1] and (text := rho.fault(rod.rho)):
        yield Implausible(f"{key}.rho", "rho", text)
