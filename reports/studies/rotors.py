"""Convergence of the examples of NASA rotors 37 and 67: mesh, untwist, modes, places along the tip, step.

`python -m reports.studies.rotors [--quick] [--out DIR]` prints seven tables of each rotor and writes them as CSV.

- Mesh: six frequencies at rest, and their worst distance from those of the finest mesh.
- Steady shape over speed: untwist and growth of the tip, and what the deformed shape changes in six frequencies.
- Modes: the impulse of all touches in a turn, against a basis with half of all modes of a coarse mesh and the residual
  compliance of the others, which is the full finite element model up to 400 kHz and more. Then the same on the mesh and
  with the places of the example, against 96 modes.
- Wheel: frequencies of the coupled wheel (wheel.toml of the example) over the mesh, by nodal diameter.
- Places along the tip, and step: the same impulse, against the most places and the shortest step. Between two steps a
  short touch can appear or vanish, which changes the later touches; the error is of second order below that step.

The rub: five places, or as many as the table says, 30 um from the casing of the example, whose radius varies by 50 um
twice around: two touches of 20 um a turn at the design speed, friction 0.15.
"""

import tomllib
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import eigsh

import casingfem as cf
import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.modal.basis import ModalBasis
from contact.model.gaps.rub_laws import RimProfile
from reports.tables import DATA, Row, command_line, show_all
from reports.verification.modes import nasa_rotors

TURN = 1.0  # turns of a run
SPEEDS = (0.5, 0.75, 1.0, 1.1)  # of the design speed
AXIS = (0.0, 0.0, 1.0)
MESHES = ((12, 8, 1), (16, 12, 1), (24, 20, 1), (24, 28, 1), (32, 24, 1), (32, 24, 2))  # the fourth: the example's
COARSE = (6, 4, 1)  # for the blade with all its modes
CELLS = MESHES[3]
MODES, QUICK_MODES = (4, 8, 12, 24, 48, 96), (8, 24, 48)
OF_EXAMPLE = (24, 48, 96)  # modes of the blade on its mesh
WHEELS = (
    ((8, 6, 1), 2, 2),
    ((12, 8, 1), 3, 3),
    ((16, 12, 1), 3, 3),
    ((24, 20, 1), 4, 5),
)  # cells: blade, around, radial
PLACES = (1, 3, 5, 9)
STEPS = (1e-5, 5e-6, 2.5e-6, 1.25e-6, 6.25e-7)
HEAD = 3  # lines before the points of a flow path
SHORT = 2.5e-7  # s: the step of the table of modes


def turns(name: str) -> float:
    """Design speed [turns/s]."""
    return nasa_rotors.RPM[name] / 60.0


def frequencies(name: str, cells: tuple[int, int, int]) -> Row:
    """Six frequencies of a mesh at rest."""
    blade = nasa_rotors.blade(name, cells)
    found = cf.modes(blade, nasa_rotors.COUNT).freq
    names = {f"mode {k} [Hz]": float(value) for k, value in enumerate(found, 1)}
    return {"cells": " x ".join(map(str, cells)), "nodes": len(blade.mesh.points), **names}


def meshes(name: str, quick: bool) -> list[Row]:
    """Frequencies over meshes, and the worst distance from the finest [%]."""
    rows = [frequencies(name, cells) for cells in MESHES[: 3 if quick else None]]
    values = np.array([[row[f"mode {k} [Hz]"] for k in range(1, nasa_rotors.COUNT + 1)] for row in rows], dtype=float)
    worst = 100.0 * np.abs(values / values[-1] - 1.0).max(axis=1)
    return [row | {"worst [%]": float(error)} for row, error in zip(rows, worst, strict=True)]


def steady(name: str, cells: tuple[int, int, int]) -> list[Row]:
    """Untwist and growth of the tip over speed, and the largest change of six frequencies by the deformed shape."""
    rows: list[Row] = []
    for part in SPEEDS:
        blade = nasa_rotors.blade(name, cells, part * nasa_rotors.RPM[name])
        assert blade.rotation is not None
        resting = nasa_rotors.blade(name, cells).assembled()
        spin = blade.spin(resting, blade.rotation)
        omega = blade.rotation.omega
        linear = csc_array(resting.K + omega**2 * spin.K1 + omega**4 * spin.K2)
        squares = eigsh(linear, nasa_rotors.COUNT, resting.M, sigma=0.0, return_eigenvectors=False)
        freq = cf.modes(blade, nasa_rotors.COUNT).freq
        changed = abs(2.0 * np.pi * freq / np.sqrt(np.sort(squares)) - 1.0)
        moved = blade.steady_shape()
        front, rear = edges_of_tip(blade)
        before, after = blade.mesh.points, blade.mesh.points + moved
        grown = np.hypot(*after[:, :2].T) - np.hypot(*before[:, :2].T)
        rows.append({
            "speed [rpm]": part * nasa_rotors.RPM[name],
            "untwist of the tip [deg]": stagger(before, front, rear) - stagger(after, front, rear),
            "growth, leading edge [um]": 1e6 * float(grown[front]),
            "growth, trailing edge [um]": 1e6 * float(grown[rear]),
            "mode 1 [Hz]": float(freq[0]),
            "six modes by the deformed shape [%]": 100.0 * float(changed.max()),
        })  # fmt: skip
    return rows


def edges_of_tip(blade: cf.Solid) -> tuple[int, int]:
    """Nodes of the tip that are first and last along the axis."""
    nodes = blade.mesh.groups["tip"].nodes
    along = blade.mesh.points[nodes, 2]
    return int(nodes[along.argmin()]), int(nodes[along.argmax()])


def stagger(points: FloatArray, front: int, rear: int) -> float:
    """Angle between the chord of the tip and the axis [deg]."""
    angle = np.arctan2(points[[front, rear], 1], points[[front, rear], 0])
    radius = np.hypot(points[[front, rear], 0], points[[front, rear], 1]).mean()
    return float(np.degrees(np.arctan2(radius * abs(angle[1] - angle[0]), points[rear, 2] - points[front, 2])))


def tip(name: str, cells: tuple[int, int, int], places: int, modes: int) -> ModalBasis:
    """The blade's basis at its design speed, at places along the tip."""
    blade = nasa_rotors.blade(name, cells, nasa_rotors.RPM[name])
    return cf.reduce(blade, cf.TipNodes("tip", places, axis=AXIS), modes=modes, zeta=1e-3)


@cache
def rim(name: str, arcs: tuple[float, ...]) -> ModalBasis:
    """The casing's basis on lines over the tip."""
    casing = cf.load_study(DATA / "scenes" / name / "casing.toml").structure
    return cf.reduce(casing, cf.Rim(lines=arcs, n_max=12), modes=46, zeta=2e-3)


def impulse(name: str, blade: ModalBasis, dt: float) -> float:
    """Impulse of all touches in a turn [N s]."""
    places = np.array(blade.provenance["places"])
    path = np.loadtxt(DATA / "scenes" / name / "flow_path.csv", delimiter=",", skiprows=HEAD)
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    casing = rim(name, tuple(np.interp(places[:, 0], path[:, 1], arc).round(7).tolist()))
    tips = tuple(
        ct.ContactPoint(span=f"node{k}.span", flap=f"node{k}.flap", line=k, angle_deg=float(angle))
        for k, angle in enumerate(places[:, 2])
    )
    rub = ct.Rub(
        ct.ModalBody.of(casing), (ct.ModalBody.of(blade),), tips, clearance=3e-5, speed=ct.Speed.constant(turns(name)),
        turning="blades", profile=RimProfile.fourier([{"p": 2, "cos": 5e-5}]),
    )  # fmt: skip
    run = ct.run(rub, law=ct.Coulomb(mu=0.15), scheme=ct.ExactModal(), t_end=TURN / turns(name), dt=dt)
    return float(np.sum(run.impulse))


def compared(name: str, values: dict[str, float]) -> list[Row]:
    """Impulses, and their distance from the last [%]."""
    last = list(values.values())[-1]
    return [{name: key, "impulse [N s]": v, "from the last [%]": 100.0 * (v / last - 1.0)} for key, v in values.items()]


def kept(name: str, quick: bool) -> list[Row]:
    """Impulse over modes kept of a coarse blade; the last row has half of all its modes."""
    every = nasa_rotors.blade(name, COARSE).assembled().size // 2 - 1
    counts = [*(QUICK_MODES if quick else MODES), every]
    return compared("modes", {f"{n}": impulse(name, tip(name, COARSE, 3, n), SHORT) for n in counts})


def kept_of_example(name: str) -> list[Row]:
    """Impulse over modes kept of the blade of the example, with its mesh and its places along the tip."""
    return compared("modes", {f"{n}": impulse(name, tip(name, CELLS, 5, n), SHORT) for n in OF_EXAMPLE})


def wheels(name: str, quick: bool) -> list[Row]:
    """Frequencies of the wheel with two nodal diameters at its speed, and their distances from the finest mesh [%]."""
    study = tomllib.loads((DATA / "scenes" / name / "wheel.toml").read_text())
    ring, sectors = study["solid"]["disk"], study["cyclic"]["sectors"]
    blade = cf.imported.BladeSections.from_csv(DATA / "scenes" / name / "sections.csv")
    rotation = cf.Rotation(omega=2.0 * np.pi * turns(name), axis=AXIS)
    rows: list[Row] = []
    for cells, around, radial in WHEELS[: 2 if quick else None]:
        disk = cf.imported.DiskRing(**ring, cells_around=around, cells_radial=radial)
        part = cf.Solid(
            mesh=blade.sector(sectors, disk, cells), material=nasa_rotors.MATERIAL[name],
            supports={"bore": cf.Clamped()}, rotation=rotation,
        )  # fmt: skip
        wheel = cf.imported.CyclicSector(structure=part, sectors=sectors, faces=("low", "high"))
        found = cf.modal.cyclic_modes(wheel, 4, diameters=[2]).freq
        rows.append(
            {"cells": " x ".join(map(str, cells)), "around": around, "radial": radial}
            | {f"mode {k}, n = 2 [Hz]": float(value) for k, value in enumerate(found, 1)}
        )
    last = np.array([rows[-1][f"mode {k}, n = 2 [Hz]"] for k in range(1, 5)], dtype=float)
    values = np.array([[row[f"mode {k}, n = 2 [Hz]"] for k in range(1, 5)] for row in rows], dtype=float)
    return [
        row | {"worst of the wheel [%]": float(error)}
        for row, error in zip(rows, 100.0 * np.abs(values / last - 1.0).max(axis=1), strict=True)
    ]


def tables(name: str, quick: bool) -> Iterator[tuple[str, str, list[Row]]]:
    """Name, title and rows of each table of a rotor."""
    yield "mesh", "Frequencies at rest over the mesh", meshes(name, quick)
    yield "steady", "Steady shape over speed", steady(name, (12, 8, 1) if quick else CELLS)
    blades = {str(n): tip(name, (12, 8, 1), n, 24) for n in PLACES[: 3 if quick else None]}
    places = compared("places", {n: impulse(name, blade, 5e-6) for n, blade in blades.items()})
    yield "places", "Impulse over places along the tip", places
    steps = {f"{dt:.3g}": impulse(name, blades["5"], dt) for dt in STEPS}
    yield "step", "Impulse over the step", compared("step [s]", steps)
    yield "modes", "Impulse over the modes of the blade; last: half of all of a coarse mesh", kept(name, quick)
    yield "wheel", "Frequencies of the wheel over the mesh", wheels(name, quick)
    if not quick:
        yield "example", "Impulse over the modes of the blade of the example", kept_of_example(name)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the tables of both rotors."""
    rows: list[Row] = []
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*mesh-(thin-curved|coarse|distorted-cell)")  # what the tables show
        warnings.filterwarnings("ignore", message=".*reduce-steady")  # runs are at the speed of the modes
        for name in nasa_rotors.RPM:
            for key, title, found in tables(name, quick):
                rows += show_all(out, f"{name}_", {key: (f"{name}: {title}", found)})
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
