"""Scene files for `casingfem stability` and `interactions`: a pair by hand, or a rim and its blades, over speeds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.interacting import RUNS, Interactions, interactions, speeds_of
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import HandPair, ModalPair
from contact.model.gaps.rub import Rub
from contact.model.law import Unilateral
from contact.model.rotor.rotor import Rotor
from contact.prepared import Scene
from contact.scene.load import load_scene, read_scene
from contact.scene.plausible import require_plausible
from contact.scene.problems import SceneError
from contact.stability.growing import of_contact, of_rim
from contact.stability.growth_map import StabilityMap
from contact.stability.on_springs import Turning, on_springs
from contact.stability.whirling import RotorStability, rotor_stability

if TYPE_CHECKING:
    from contact.scene.laws import AnyLaw
    from contact.scene.pair import PairFile
    from contact.scene.scheme import ScanTable


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class StabilityScene:
    """A problem in permanent contact, or a rotor, and the speeds [Hz] to examine; `mu` is the friction coefficient."""

    what: HandPair | RotatingRim | Rotor | Rub
    speed_hz: Array
    mu: float = 0.0

    def solve(self) -> StabilityMap | RotorStability:
        """Growth over the speeds."""
        if isinstance(self.what, Rotor | Rub):
            return rotor_stability(self.what, self.speed_hz, mu=self.mu)
        if isinstance(self.what, HandPair):
            return of_contact(self.what.contact(), self.speed_hz)
        return of_rim(self.what, self.speed_hz, mu=self.mu)


def load_stability(path: str | Path) -> StabilityScene:
    """Read a scene of kind "pair", of kind "rim" with `scan` in [speed], or of kind "rotor".

    Without a scan a rotor is examined at the speeds of `speeds_of`.

    Raises SceneError, which lists every problem with file, key, what was found and what is expected.

    >>> import contact as ct
    >>> scene = ct.scene.load_stability("data/scenes/pair.toml")
    >>> found = scene.solve()
    >>> found.diverges, round(found.peak_speed_hz, 2)
    (True, 52.84)
    """
    file = Path(path)
    table, _ = read_scene(file)
    if table.scene.kind == "pair":
        return StabilityScene(what=_pair(table, file), speed_hz=_speeds(table.speed))
    if table.scene.kind == "rotor":
        scene = load_scene(file)
        rotor = cast("Rotor | Rub", scene.what)
        closed = rotor if isinstance(rotor, Rotor) else _on_law(rotor, table.law, file)
        mu = (scene.law or Unilateral()).mu
        return StabilityScene(what=closed, speed_hz=_speeds_around(table, scene, file), mu=mu)
    if table.scene.kind != "rim":
        more = ": use casingfem interactions" if table.scene.kind in ("rub", "disk") else ""
        raise SceneError([f"{file}: scene.kind: found {table.scene.kind!r}, expected 'pair', 'rim' or 'rotor'{more}"])
    scan = table.speed.scan
    if scan is None:
        expected = "{from_hz = ..., to_hz = ..., steps = ...}; casingfem interactions runs without it"
        raise SceneError([f"{file}: speed.scan: missing, expected {expected}"])
    scene = load_scene(file)
    mu = (scene.law or Unilateral()).mu
    what = _on_law(cast(RotatingRim, scene.what), table.law, file)
    return StabilityScene(what=what, speed_hz=_speeds(scan), mu=mu)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class InteractionScene:
    """A scene, or a pair by hand, and the speeds [Hz] to examine.

    `closed` has springs with the slope of its law at the tips.
    """

    scene: Scene | HandPair
    speed_hz: Array
    closed: RotatingRim | Rub | None = None

    def solve(self, runs: int = RUNS, processes: int = 1) -> Interactions:
        """The table of dangerous speeds, from runs evenly over the speeds, at each peak, and between those."""
        return interactions(self.scene, self.speed_hz, runs=runs, closed=self.closed, processes=processes)


def load_interactions(path: str | Path) -> InteractionScene:
    """Read a scene of kind "pair", "rim", "rub", "disk" or "rotor"; by default with the speeds of `speeds_of`.

    Raises SceneError, which lists every problem with file, key, what was found and what is expected.

    >>> import contact as ct
    >>> scene = ct.scene.load_interactions("data/scenes/pair.toml")
    >>> float(scene.speed_hz[0]), float(scene.speed_hz[-1])
    (52.0, 54.0)
    """
    file = Path(path)
    table, _ = read_scene(file)
    if table.scene.kind == "pair":
        return InteractionScene(scene=_pair(table, file), speed_hz=_speeds(table.speed))
    if table.scene.kind not in ("rim", "rub", "disk", "rotor"):
        expected = "'pair', 'rim', 'rub', 'disk' or 'rotor'"
        raise SceneError([f"{file}: scene.kind: found {table.scene.kind!r}, expected {expected}"])
    scene = load_scene(file)
    if table.scene.kind == "rotor":
        return InteractionScene(scene=scene, speed_hz=_speeds_around(table, scene, file))
    closed = _on_law(cast("RotatingRim | Rub", scene.what), table.law, file)
    return InteractionScene(scene=scene, speed_hz=_speeds_around(table, scene, file), closed=closed)


def _speeds_around(table: Any, scene: Scene, file: Path) -> Array:
    """The speeds of speed.scan [Hz]; by default those of `speeds_of`."""
    hz = np.atleast_1d(table.speed.turns if table.scene.kind == "rotor" else table.speed.hz)
    if hz.min() < 0.0 and table.scene.kind != "rotor":
        expected = "a speed of 0 or above: mirror the scene (lean_deg and shape)"
        raise SceneError([f"{file}: speed.hz: found {hz.min():g} Hz, expected {expected}"])
    top = float(np.abs(hz).max())
    if table.speed.scan is not None:
        if not table.speed.scan.from_hz > 0.0:
            found = f"found {table.speed.scan.from_hz:g} Hz, expected a speed above 0"
            raise SceneError([f"{file}: speed.scan.from_hz: {found}"])
        return _speeds(table.speed.scan)
    if not top > 0.0:
        expected = "{from_hz = ..., to_hz = ..., steps = ...} for a scene at rest"
        raise SceneError([f"{file}: speed.scan: missing, expected {expected}"])
    return speeds_of(scene)


def _on_law(what: Turning, law: AnyLaw | None, file: Path) -> Turning:
    """The scene with springs at the tips that have the slope of its force-depth law."""
    if law is None:
        return what
    try:
        return on_springs(what, law.closed_slope())
    except InputError as error:
        raise SceneError([f"{file}: law.closed_depth: {str(error).removeprefix('depth: ')}"]) from error


def _pair(table: PairFile, file: Path) -> HandPair:
    require_plausible(table, file)
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
