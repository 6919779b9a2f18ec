"""The steel ring under a casing, as a beam and as a thick strip of the shell.

`python -m reports.verification.modes.steel_ring [--quick] [--out DIR]`. A frustum R .50 -> .45 m, height .25 m, 3 mm
steel, on a ring of 40 x 40 mm whose middle line continues the cone. (a) strip: the chart goes on for 40 mm below the
casing, 40 mm thick; (b) beam: an eccentric curved Timoshenko beam tied to the edge (`Ring`). Both are on the same
springs at their foot.

steel_ring.csv: the lowest frequency of each n, by one small problem for each n, on springs spread evenly; beside them
the bare casing on the same springs, and what (b) changes by without the ring's shear and without its centre's offset.
They part because the beam's section stays plane and square, while the strip is as thick as it is high: a shell bends,
shears and stretches along its height too, and its springs hold one line. steel_ring_bolts.csv: first modes on 24 bolts.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.modal.fourier import lowest
from casingfem.modal.modes import modes
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.section import Section
from casingfem.structure.edge.support import ElasticEdge, Support
from casingfem.structure.geometry.chart import Frustum
from casingfem.structure.geometry.strip import Strip
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.shell import Shell
from reports.tables import Row, command_line, show, write

STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
SIDE, SLOPE = 0.04, -0.2  # m; dr/dz of the cone
SQUARE = Section.rectangle(width=SIDE, depth=SIDE)
STEP = (-0.5 * SIDE * SLOPE, -0.5 * SIDE)  # m, radial and axial: from the edge to the centre, from there to the foot
BOLTS = Bolts(count=24, k=2e8, k_rot=2e5)
EDGE = Frustum(r_base=0.50, r_top=0.45, height=0.25)
SPREAD = ElasticEdge(k_r=1.5e9, k_theta=1.5e9, k_z=1.5e9, k_rot=1.5e6)  # 24 bolts over 2 pi .5 m


def strip(under: Support, thickness: float = SIDE) -> Shell:
    """(a) The chart continued below the casing, with a thick strip; `under` at its lower end, r = .508 m."""
    chart = Frustum(r_base=0.5 - SLOPE * SIDE, r_top=0.45, height=0.25 + SIDE)
    ring = Strip(start=0.0, end=SIDE, thickness=thickness)
    return Shell(chart=chart, thickness=3e-3, material=STEEL, supports={"base": under}, strips=(ring,))


def beam(
    under: ElasticEdge | Bolts, section: Section | None = None, offset: tuple[float, float] | None = None
) -> Shell:
    """(b) The casing on a ring; the centre and the foot lie on the cone's continuation."""
    step = (-0.5 * SIDE * SLOPE, -0.5 * SIDE)
    ring = Ring(
        section=section or Section.rectangle(width=SIDE, depth=SIDE),
        offset=step if offset is None else offset,
        support=under,
        foot=step,
    )
    return Shell(chart=EDGE, thickness=3e-3, material=STEEL, supports={"base": ring})


def first(shell: Shell, n: int) -> float:
    """The lowest frequency of n nodal diameters [Hz], torsion left aside where n = 0."""
    meridian = harmonic_matrices(shell, n)
    values, vectors = lowest(meridian, 3, 1e4)
    size = np.abs(meridian.expand(vectors)[:, :3]).max(axis=0)
    bends = size[1] < 10.0 * np.maximum(size[0], size[2])
    return float(np.sqrt(max(values[np.argmax(bends)], 0.0)) / (2.0 * np.pi))


def row(n: int) -> Row:
    """One n: both models on spread springs, the bare casing, and what shear and offset of the beam are worth."""
    a, b = first(strip(at_foot(SPREAD)), n), first(beam(SPREAD), n)
    stiff = first(beam(SPREAD, replace(SQUARE, shear=1e3)), n)
    centred = first(beam(SPREAD, offset=(0.0, 0.0)), n)
    bare = first(Shell(chart=EDGE, thickness=3e-3, material=STEEL, supports={"base": SPREAD}), n)
    return {
        "n": n,
        "strip Hz": float(a),
        "beam Hz": float(b),
        "beam/strip - 1 %": 100.0 * float(b / a - 1.0),
        "no shear %": 100.0 * float(stiff / b - 1.0),
        "no offset %": 100.0 * float(centred / b - 1.0),
        "no ring Hz": float(bare),
    }


def at_foot(spread: ElasticEdge) -> ElasticEdge:
    """The same springs in sum at the strip's lower end, which is longer than the casing's edge."""
    part = 0.5 / (0.5 - SLOPE * SIDE)
    names = ("k_r", "k_theta", "k_z", "k_rot")
    return replace(spread, **{name: part * getattr(spread, name) for name in names})


def bolted(count: int, quick: bool) -> list[Row]:
    """The first modes of both on 24 bolts."""
    rows = (0.0, 0.08, SIDE / 0.29, 0.97, 1.0)
    order = 5 if quick else 7
    a = modes(replace(strip(BOLTS), mesh=ShellMesh(order=order, rows=rows, around=24)), count)
    b = modes(replace(beam(BOLTS), mesh=ShellMesh(order=order, rows=(0.0, 0.03, 0.97, 1.0), around=24)), count)
    return [
        {
            "mode": k + 1,
            "n strip": int(a.nodal_diameters[k]),
            "n beam": int(b.nodal_diameters[k]),
            "strip Hz": float(a.freq[k]),
            "beam Hz": float(b.freq[k]),
            "beam/strip - 1 %": 100.0 * float(b.freq[k] / a.freq[k] - 1.0),
        }
        for k in range(count)
    ]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write both tables; returns the rows of the first."""
    table = [row(n) for n in ((0, 1, 6, 12) if quick else range(13))]
    show("Steel ring 40 x 40 mm on spread springs, lowest frequency of each n", table)
    write(out / "steel_ring.csv", table)
    part = bolted(6 if quick else 16, quick)
    show("The same on 24 bolts", part)
    write(out / "steel_ring_bolts.csv", part)
    return table


if __name__ == "__main__":
    command_line(__doc__, main)
