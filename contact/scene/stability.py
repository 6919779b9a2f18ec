"""Scene files for `casingfem stability`: a pair by hand, or a rim and a blade by their bases, over speeds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.growth.closed_contact import rim_stability, stability
from contact.growth.growth_map import StabilityMap
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import HandPair, ModalPair
from contact.model.law import Unilateral
from contact.scene.load import SceneError, load_scene, read_scene

if TYPE_CHECKING:
    from contact.scene.tables import PairFile, ScanTable


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class StabilityScene:
    """What stays in contact, and the speeds [Hz] to look at; `mu` is a rim's friction."""

    what: HandPair | RotatingRim
    speed_hz: Array
    mu: float = 0.0

    def solve(self) -> StabilityMap:
        """Growth map over the speeds."""
        if isinstance(self.what, HandPair):
            return stability(self.what.contact(), self.speed_hz)
        return rim_stability(self.what, self.speed_hz, mu=self.mu)


def load_stability(path: str | Path) -> StabilityScene:
    """Read a scene of kind "pair", or of kind "rim" with `scan` in [speed].

    Raises SceneError, which lists every problem with file, key, what was found and what is expected.
    """
    file = Path(path)
    table, _ = read_scene(file)
    if table.scene.kind == "pair":
        return StabilityScene(what=_pair(table, file), speed_hz=_speeds(table.speed))
    if table.scene.kind != "rim":
        raise SceneError([f"{file}: scene.kind: found {table.scene.kind!r}, expected 'pair' or 'rim'"])
    scan = table.speed.scan
    if scan is None:
        raise SceneError([f"{file}: speed.scan: missing, expected {{from_hz = ..., to_hz = ..., steps = ...}}"])
    scene = load_scene(file)
    mu = (scene.law or Unilateral()).mu
    return StabilityScene(what=cast(RotatingRim, scene.what), speed_hz=_speeds(scan), mu=mu)


def _pair(table: PairFile, file: Path) -> HandPair:
    contact = table.contact
    compliance = contact.compliance if contact.stiffness is None else 1.0 / contact.stiffness
    assert compliance is not None  # the table has one of both
    try:
        return HandPair(
            casing=ModalPair(**table.casing.model_dump()), blade=ModalPair(**table.blade.model_dump()),
            compliance=compliance, friction=contact.friction, lean_deg=contact.lean_deg,
        )  # fmt: skip
    except InputError as error:
        raise SceneError([f"{file}: {error}"]) from error


def _speeds(scan: ScanTable) -> Array:
    return np.linspace(scan.from_hz, scan.to_hz, scan.steps)
