"""Numbers held: matrices, static answers and spin of small shells of every kind of part."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.shell.assembly import spin
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.nodal_mass import nodal_mass
from casingfem.structure.shell.plausible import extent
from casingfem.structure.shell.rigid import free_motions, rigid_fields
from tests.probed import probed

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BRASS = cf.Material(E=100e9, nu=0.35, rho=8500.0)
CLOSED, OPEN = cf.ShellMesh(order=4, rows=1, around=7), cf.ShellMesh(order=4, rows=2, around=2)
BAR = cf.edge.Section.rectangle(width=0.02, depth=0.012)
GRAPHITE = cf.shell.Lamina(E1=25e9, E2=1e9, nu12=0.25, G12=0.5e9, G13=0.5e9, G23=0.2e9, rho=1500.0)
FRUSTUM, PLATE = cf.Frustum(r_base=0.50, r_top=0.45, height=0.25), cf.Plate(length=0.2, width=0.05)
WAVES = cf.FourierField.of({2: 0.004, 3: (0.001, -0.002)})
EMBEDDED = cf.ElasticEdge(k_r=3e8, k_theta=2e8, k_z=4e8, k_rot=1e5, around=cf.FourierField.of({2: (0.3, 0.1)}))
PIECES = cf.geometry.PiecewiseMeridian(
    start=(0.3, 0.0),
    fillet=0.01,
    pieces=(
        cf.geometry.Piece(to=(0.3, 0.1)),
        cf.geometry.Piece(to=(0.25, 0.2)),
        cf.geometry.Piece(to=(0.28, 0.3), radius=0.2),
    ),
)


def closed(chart=FRUSTUM, **parts):
    return cf.Shell(**{"chart": chart, "thickness": 3e-3, "material": STEEL, "mesh": CLOSED, **parts})


def open_shell(chart=PLATE, **parts):
    own = {"chart": chart, "thickness": 3e-3, "material": STEEL, "mesh": OPEN, "supports": {"root": cf.Clamped()}}
    return cf.Shell(**{**own, **parts})


SHELLS = {
    "imperfect": lambda: closed(
        radius_defect=WAVES, thickness_defect=cf.FourierField.of({1: 0.1}), supports={"base": EMBEDDED}
    ),
    "on a face": lambda: closed(supports={"base": cf.ElasticEdge(k_face=5e12), "top": cf.ElasticEdge(k_r=1e7)}),
    "linear wall": lambda: closed(wall="linear", supports={"top": cf.ShearDiaphragm()}),
    "bolts": lambda: closed(
        mesh=cf.ShellMesh(order=4, rows=1, around=8),
        supports={"base": cf.Bolts(count=8, k=(1e6, 2e6, 3e6), k_rot=1e3, first_angle=0.1, width=0.4, loose={3: 0.3})},
    ),
    "ring": lambda: closed(
        supports={
            "base": cf.Ring(section=BAR, material=BRASS, offset=(0.004, -0.01), support=EMBEDDED, foot=(0.0, -0.02)),
            "top": cf.Ring(section=BAR),
        },
    ),
    "stiffeners": lambda: closed(
        chart=cf.Cylinder(radius=0.3, height=0.25),
        supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=4, rows=2, around=7),
        stiffeners=(cf.edge.Stiffener(at=0.125, section=BAR, offset=(0.0075, 0.001), material=BRASS),),
    ),
    "plies": lambda: closed(
        wall="linear",
        supports={"base": cf.Clamped()},
        plies=(cf.shell.Ply(thickness=1.0), cf.shell.Ply(thickness=2.0, angle_deg=30.0, lamina=GRAPHITE)),
    ),
    "revolved": lambda: closed(
        chart=cf.Revolved(profile=PIECES),
        mesh=cf.ShellMesh(order=4, rows=tuple(np.array(PIECES.lines) / PIECES.length), around=7),
        supports={"base": cf.Clamped()},
        radius_defect=WAVES,
        rotation=cf.Rotation(omega=300.0),
    ),
    "masses": lambda: closed(supports={"base": cf.Clamped()}, masses={"top": (cf.edge.EdgeMass(angle=0.3, mass=0.2),)}),
    "blade": lambda: open_shell(
        cf.Blade(
            length=0.2,
            chord=(0.12, 0.1, 0.09),
            camber=(0.6, -0.1),
            twist=(0.1, 0.6),
            sweep=(0.0, 0.0, 0.02),
            lean=(0.0, 0.01),
        ),
        taper=cf.Taper(along=(1.0, 0.6), across=(1.0, 0.7, 0.8)),
    ),
    "turning blade": lambda: open_shell(
        rotation=cf.Rotation.of_blade(PLATE, omega=300.0, hub_radius=0.3, stagger=0.6), supports={"root": EMBEDDED}
    ),
    "twisted": lambda: open_shell(
        cf.TwistedPlate(length=0.3, width=0.1, twist=1.1),
        supports={"root": cf.Clamped(), "left": cf.ElasticEdge(k_theta=1e7)},
    ),
    "panel": lambda: open_shell(
        cf.Panel(radius=0.3, length=0.2, angle=0.25), supports={"root": cf.ShearDiaphragm(), "right": EMBEDDED}
    ),
    "symmetric": lambda: open_shell(supports={"root": cf.Clamped(), "left": cf.edge.Symmetry()}),
    "strips": lambda: open_shell(strips=(cf.Strip(start=0.0, end=0.1, thickness=5e-3, material=BRASS),)),
}
LOADS = (
    cf.loads.SurfaceLoad(force=(1e3, 2e3, -3e3)),
    cf.loads.Pressure(pressure=5e4),
    cf.loads.PointLoad(at=(0.07, 0.021), force=(1e2, 2e2, 7e2)),
)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHELLS)
def test_numbers_of_shells(name, held):
    shell = SHELLS[name]()
    system = cf.shell.assemble(shell)
    edge = "top" if "top" in shell.chart.edges else "tip"
    loads = [*LOADS, cf.loads.EdgeLoad(edge=edge, force=(1e3, -5e2, 2e3))]
    if not shell.rings and not shell.masses:
        loads.append(cf.loads.Gravity(acceleration=(1.0, -2.0, 3.0)))
    found = [cf.solve_static(shell, [load], system=system) for load in loads]
    grid, size = system.grid, extent(shell)
    turning = {}
    if shell.rotation is not None:
        spun = spin(cf.shell.assemble(replace(shell, rotation=None)), shell.rotation)
        turning = {"G": probed(spun.G), "K1": probed(spun.K1), "K2": probed(spun.K2), "nonlinear": [spun.nonlinear]}
    held(
        size=[system.size, system.own, len(system.frames)],
        K=probed(system.K),
        mass=probed(system.M),
        energy=[one.energy for one in found],
        at=[one.at(0.15, 0.02) for one in found],
        nodal_mass=probed(nodal_mass(shell, grid).moments),
        rigid=probed(rigid_fields(shell, grid).reshape(-1, 6)),
        free=[free_motions(shell, grid).shape[-1]],
        extent=[size.diagonal, *size.sides, size.curvature.max(), size.curvature.sum()],
        **turning,
    )


@pytest.mark.parametrize("name", ["on a face", "linear wall", "stiffeners"])
def test_numbers_of_harmonics(name, held):
    found = {n: harmonic_matrices(SHELLS[name](), n) for n in (0, 1, 3)}
    held(**{f"K{n}": probed(one.K) for n, one in found.items()}, **{f"M{n}": one.mass for n, one in found.items()})
