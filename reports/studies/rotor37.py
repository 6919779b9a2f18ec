"""What the rub of NASA rotor 37 converges with: mesh, modes, places along the tip, step.

`python -m reports.studies.rotor37 [--quick] [--out DIR]` prints four tables and writes them as CSV.

- Mesh: six frequencies at rest, and their worst distance from those of the finest mesh.
- Modes: the impulse of all touches in a turn, against a basis with half of all modes of a coarse mesh and the residual
  compliance of the others, which is the full finite element model up to 100 kHz and more.
- Places along the tip, and step: the same impulse, against the most places and the shortest step.

The rub: five places, or as many as the table says, 30 um from the casing of data/scenes/rotor37, whose radius varies by
50 um twice around: two touches of 20 um a turn at 220.3 turns/s (13,218 rpm), friction 0.15.
"""

import warnings
from functools import cache
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.modal.basis import ModalBasis
from contact.model.gaps.rub_laws import RimProfile
from reports.tables import DATA, Row, command_line, show_all
from reports.verification.modes import nasa_rotors

NAME, SPEED, TURN = "rotor37", 220.3, 1.0  # turns/s, turns of a run
AXIS = (0.0, 0.0, 1.0)
MESHES = ((12, 8, 1), (16, 12, 1), (24, 20, 1), (24, 28, 1), (32, 24, 1), (32, 24, 2))  # the fourth: the example's
COARSE = (6, 4, 1)  # for the blade with all its modes
MODES = (2, 4, 8, 12, 24)
PLACES = (1, 3, 5, 9)
STEPS = (1e-5, 5e-6, 2.5e-6, 1.25e-6)
SHORT = 5e-7  # s: the step of the table of modes


def frequencies(cells: tuple[int, int, int]) -> Row:
    """Six frequencies of a mesh at rest."""
    blade = nasa_rotors.blade(NAME, cells)
    found = cf.modes(blade, nasa_rotors.COUNT).freq
    names = {f"mode {k} [Hz]": float(value) for k, value in enumerate(found, 1)}
    return {"cells": " x ".join(map(str, cells)), "nodes": len(blade.mesh.points), **names}


def meshes(quick: bool) -> list[Row]:
    """Frequencies over meshes, and the worst distance from the finest [%]."""
    rows = [frequencies(cells) for cells in MESHES[: 3 if quick else None]]
    values = np.array([[row[f"mode {k} [Hz]"] for k in range(1, nasa_rotors.COUNT + 1)] for row in rows], dtype=float)
    worst = 100.0 * np.abs(values / values[-1] - 1.0).max(axis=1)
    return [row | {"worst [%]": float(error)} for row, error in zip(rows, worst, strict=True)]


def tip(cells: tuple[int, int, int], places: int, modes: int) -> ModalBasis:
    """The blade's basis at its design speed, at places along the tip."""
    blade = nasa_rotors.blade(NAME, cells, nasa_rotors.RPM[NAME])
    return cf.reduce(blade, cf.TipNodes("tip", places, axis=AXIS), modes=modes, zeta=1e-3)


@cache
def rim(arcs: tuple[float, ...]) -> ModalBasis:
    """The casing's basis on lines over the tip."""
    casing = cf.load_study(DATA / "scenes" / NAME / "casing.toml").structure
    return cf.reduce(casing, cf.Rim(lines=arcs, n_max=12), modes=46, zeta=2e-3)


def impulse(blade: ModalBasis, dt: float) -> float:
    """Impulse of all touches in a turn [N s]."""
    places = np.array(blade.provenance["places"])
    path = np.loadtxt(DATA / "scenes" / NAME / "flow_path.csv", delimiter=",", skiprows=4)
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    casing = rim(tuple(np.interp(places[:, 0], path[:, 1], arc).round(7).tolist()))
    tips = tuple(
        ct.ContactPoint(span=f"node{k}.span", flap=f"node{k}.flap", line=k, angle_deg=float(angle))
        for k, angle in enumerate(places[:, 2])
    )
    rub = ct.Rub(
        ct.ModalBody.of(casing), (ct.ModalBody.of(blade),), tips, clearance=3e-5, speed=ct.Speed.constant(SPEED),
        turning="blades", profile=RimProfile.fourier([{"p": 2, "cos": 5e-5}]),
    )  # fmt: skip
    run = ct.run(rub, law=ct.Coulomb(mu=0.15), scheme=ct.ExactModal(), t_end=TURN / SPEED, dt=dt)
    return float(np.sum(run.impulse))


def compared(name: str, values: dict[str, float]) -> list[Row]:
    """Impulses, and their distance from the last [%]."""
    last = list(values.values())[-1]
    return [{name: key, "impulse [N s]": v, "from the last [%]": 100.0 * (v / last - 1.0)} for key, v in values.items()]


def kept(quick: bool) -> list[Row]:
    """Impulse over modes kept of a coarse blade; the last row has half of all its modes."""
    every = nasa_rotors.blade(NAME, COARSE).assembled().size // 2 - 1
    counts = [*MODES[1 : 3 if quick else None], every]
    return compared("modes", {f"{n}": impulse(tip(COARSE, 3, n), SHORT) for n in counts})


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the tables."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*mesh-(thin-curved|coarse|distorted-cell)")  # what the tables show
        rows = show_all(out, "rotor37_", {"mesh": ("Frequencies at rest over the mesh", meshes(quick))})
        blades = {str(n): tip((12, 8, 1), n, 12) for n in PLACES[: 3 if quick else None]}
        places = compared("places", {n: impulse(blade, 5e-6) for n, blade in blades.items()})
        rows += show_all(out, "rotor37_", {"places": ("Impulse over places along the tip", places)})
        steps = {f"{dt:.3g}": impulse(blades["5"], dt) for dt in STEPS[: 3 if quick else None]}
        rows += show_all(out, "rotor37_", {"step": ("Impulse over the step", compared("step [s]", steps))})
        title = "Impulse over the modes of the blade; last: half of all of a coarse mesh"
        return rows + show_all(out, "rotor37_", {"modes": (title, kept(quick))})


if __name__ == "__main__":
    command_line(__doc__, main)
