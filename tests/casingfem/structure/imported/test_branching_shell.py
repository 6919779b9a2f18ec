"""Shells whose walls branch and fold: a box of seven walls, a T, and what must not change their frequencies."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from casingfem.errors import ModelError
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.cells.support import Fixed
from casingfem.structure.imported.cyclic.sector import CyclicSector
from casingfem.structure.imported.mesh.cell_kind import KINDS, shape_functions
from casingfem.structure.imported.mesh.collapsed import mirror
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.read import read_mesh

FILES = Path(__file__).parent / "branching"
STEEL = cf.Material(E=207e9, nu=0.3, rho=7850.0)
FAN_LUAH = [20.28, 25.43, 28.79, 30.62]  # Hz: Fan & Luah, Comput. Struct. 56, 1995, 1065, of a double-cell box


def part(name):
    """A mesh of the folder."""
    return read_mesh(FILES / f"{name}.inp")


def shell(mesh, thickness=1e-3, *, held=True, **given):
    supports = {"BASE": cf.Clamped()} if held else {}
    return cf.MeshShell(mesh=mesh, thickness=thickness, material=STEEL, supports=supports, **given)


def frequencies(mesh, thickness=1e-3, count=12, *, held=True):
    return cf.modes(shell(mesh, thickness, held=held), count).freq


def merged(points, kind, **given):
    """A mesh from the nodes of its cells (cells, nodes, 3)."""
    x, cells = np.unique(np.round(points.reshape(-1, 3), 9), axis=0, return_inverse=True)
    return MeshData(kind=kind, points=x, cells=cells.reshape(points.shape[:2]), **given)


def divided(mesh, n, kind):
    """Each four-noded cell as n x n of a kind; groups are the nodes in the box around their corners."""
    steps = np.array([(i, j) for j in range(n) for i in range(n)])
    local = ((steps[:, None] + KINDS[kind].places) / n).reshape(-1, 2)
    N, _ = shape_functions("quad", np.ascontiguousarray(local.T))
    x = np.einsum("kq,ekc->eqc", N, mesh.points[mesh.cells])
    finer = merged(x.reshape(-1, len(KINDS[kind].places), 3), kind)
    ends = {name: mesh.points[group.nodes] for name, group in mesh.groups.items()}
    inside = {
        name: ((finer.points > x.min(axis=0) - 1e-6) & (finer.points < x.max(axis=0) + 1e-6)).all(axis=1)
        for name, x in ends.items()
    }
    return replace(finer, groups={name: Group(nodes=np.flatnonzero(mask)) for name, mask in inside.items()})


def permuted(mesh):
    """The same with nodes and cells in another order, cells beginning at another corner."""
    rng = np.random.default_rng(1)
    order = rng.permutation(len(mesh.points))
    place = np.argsort(order)
    cells = np.roll(place[mesh.cells][rng.permutation(len(mesh.cells))], 1, axis=1)
    groups = {name: Group(nodes=place[group.nodes]) for name, group in mesh.groups.items()}
    return MeshData(kind=mesh.kind, points=mesh.points[order], cells=cells, groups=groups)


def turned(mesh):
    """The same elsewhere, turned about a skew axis."""
    R = np.linalg.qr(np.random.default_rng(2).standard_normal((3, 3)))[0]
    return replace(mesh, points=mesh.points @ (R * np.sign(np.linalg.det(R))).T + [0.3, -0.2, 0.9])


def reversed_walls(mesh):
    """The same with the cells across x numbered the other way round: those of the T's web, of four walls of the box."""
    flat = np.ptp(mesh.points[mesh.cells][:, :, 0], axis=1) < 1e-9
    return replace(mesh, cells=np.where(flat[:, None], mesh.cells[:, mirror(mesh.kind)], mesh.cells))


@pytest.mark.slow
def test_a_box_of_seven_walls_has_the_published_frequencies():
    """Three walls meet along two lines, two at the corners; eight-noded cells instead of the four-noded of the file."""
    box = part("box")
    assert shell(box, 12.7e-3).assembled().dofs == 6
    coarse = frequencies(box, 12.7e-3, 4)
    fine = frequencies(divided(box, 1, "quad8"), 12.7e-3, 4)
    np.testing.assert_allclose(fine, FAN_LUAH, rtol=5e-3)
    assert (coarse > fine).all()
    np.testing.assert_allclose(coarse, fine, rtol=0.035)


@pytest.mark.parametrize("change", [permuted, turned, reversed_walls])
@pytest.mark.parametrize(("name", "thickness"), [("tee", 1e-3), pytest.param("box", 12.7e-3, marks=pytest.mark.slow)])
def test_order_place_and_orientation_change_no_frequency(name, thickness, change):
    mesh = part(name)
    np.testing.assert_allclose(frequencies(change(mesh), thickness), frequencies(mesh, thickness), rtol=1e-8)


@pytest.mark.parametrize("kind", ["quad", "quad8"])
def test_a_free_part_has_six_rigid_motions(kind):
    freq = frequencies(divided(part("tee"), 1, kind), 1e-3, 7, held=False)
    assert freq[:6].max() < 1e-4 * freq[6]


def gutter():
    """A wall along x through the z axis, its upper edge with two flanges that lean, (y, z) extruded along x."""
    place = KINDS["quad9"].places
    cells = []
    for (y, z), (y1, z1) in (((0, 0), (0, 0.3)), ((0, 0.3), (0.15, 0.4)), ((0, 0.3), (-0.1, 0.35))):
        for i, j in np.ndindex(2, 4):
            s, x = (i + place[:, 0]) / 2, 0.2 - 0.1 * (j + place[:, 1])
            cells.append(np.stack([x, y + s * (y1 - y), z + s * (z1 - z)], axis=1))
    mesh = merged(np.array(cells), "quad9")
    on_axis = np.hypot(mesh.points[:, 0], mesh.points[:, 1]) < 1e-9
    groups = {"axis": on_axis, "lip": np.abs(mesh.points[:, 1] - 0.15) < 1e-9}
    return replace(mesh, groups={name: Group(nodes=np.flatnonzero(mask)) for name, mask in groups.items()})


def test_a_turning_part_is_neutral_to_a_turn_about_its_axis():
    """theta.K1 theta = 0 with the moment of inertia as the scale; without the arms of the joints it is 0.05."""
    supports = {"axis": Fixed(directions=("x", "y", "z")), "lip": cf.ElasticEdge(k_face=1.0)}
    structure = cf.MeshShell(mesh=gutter(), thickness=2e-3, material=STEEL, supports=supports)
    system = structure.assembled()
    spin = structure.spin(system, Rotation(omega=1.0, axis=(0.0, 0.0, 1.0)))
    motion = np.concatenate([np.cross([0, 0, 1], system.points), system.walls.joints.axes @ [0, 0, 1]], axis=1)
    r = system.collect(motion[:, :, None])[:, 0]
    assert r @ system.M @ r > 0.05
    assert abs(r @ spin.K1 @ r) < 1e-6 * (r @ system.M @ r)


def test_a_branched_shell_that_spins_is_stiffer():
    """A T whose web runs along the radius, clamped at its root 0.3 m from the axis: a beam so long has 2.8 Omega^2."""
    mesh = part("tee")
    root = Group(nodes=np.flatnonzero(mesh.points[:, 1] < 1e-9))
    mesh = replace(mesh, groups={"BASE": root})
    spin = Rotation(omega=60.0, axis=(0.0, 0.0, 1.0), centre=(0.2, -0.3, 0.0))
    at_rest, spinning = (cf.modes(shell(mesh, rotation=rotation), 3).freq for rotation in (None, spin))
    rise = (spinning**2 - at_rest**2) / (60.0 / (2.0 * np.pi)) ** 2
    assert ((rise > 1.0) & (rise < 4.0)).all()


def test_a_sector_of_a_wheel_may_not_branch():
    with pytest.raises(ModelError, match=r"tee\.inp: a sector of a wheel with walls that meet.*7 nodes.*mesh-branch"):
        CyclicSector(structure=shell(part("tee")), sectors=12)
