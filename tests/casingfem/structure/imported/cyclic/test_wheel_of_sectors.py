"""A sector and its wheel: nodes, groups, fields, motions on the axis, the stiffness of a blade."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.cells.shell import directors, tangent_frames
from casingfem.structure.imported.cyclic.faces import Turn
from casingfem.structure.imported.cyclic.sector import (
    assemble_cyclic,
    joint_directors,
    node_turns,
    require_axis,
    still_motions,
    tied,
)
from casingfem.structure.imported.cyclic.wheel import blade_stiffness, wheel_fields, wheel_mesh, wheel_nodes
from tests.casingfem.structure.imported.parts import STEEL

Z_TURN = Turn((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.pi / 2.0)
CONE = cf.imported.revolved((0.5, 0.3), (0.0, 0.2), 0.1)


def cone(u):
    """A quarter of a frustum's mid-surface."""
    return CONE(np.column_stack([np.full(len(u), 0.5), 0.25 * u[:, 0], u[:, 1]]))


def shell_sector(**given):
    mesh = cf.imported.grid_mesh("quad9", (2, 1), cone, groups={"low": (0, 0.0), "base": (1, 0.0)})
    mesh = replace(mesh, groups={**mesh.groups, "blade": cf.imported.Group(nodes=mesh.cells[1], cells=[1])})
    part = cf.MeshShell(mesh=mesh, thickness=0.01, material=STEEL, supports={}, **given)
    return cf.imported.CyclicSector(structure=part, sectors=4)


@pytest.fixture(scope="module")
def sector():
    return shell_sector()


@pytest.mark.parametrize(("sectors", "diameters", "counts"), [(5, (0, 1, 2), (1, 2, 2)), (4, (0, 1, 2), (1, 2, 1))])
def test_diameters_and_how_many_modes_of_the_wheel_each_has(sector, sectors, diameters, counts):
    other = replace(sector)
    object.__setattr__(other, "sectors", sectors)
    assert other.diameters == diameters
    assert tuple(other.count(n) for n in diameters) == counts


def test_the_wheel_has_the_nodes_of_each_sector_turned_on(sector):
    """Every node of sector j lies where that of sector 0 comes after j turns; high faces are the next low ones."""
    nodes, mesh = wheel_nodes(sector), sector.structure.mesh
    whole = wheel_mesh(sector)
    low, high = sector.pairs
    assert nodes.shape == (4, len(mesh.points))
    assert np.unique(nodes).tolist() == list(range(4 * (len(mesh.points) - len(low))))
    assert nodes[1, low].tolist() == nodes[0, high].tolist()
    assert nodes[0, low].tolist() == nodes[3, high].tolist()
    for j in range(4):
        c, s = np.cos(j * np.pi / 2), np.sin(j * np.pi / 2)
        turned = mesh.points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]])
        np.testing.assert_allclose(whole.points[nodes[j]], turned, atol=1e-14)
        np.testing.assert_array_equal(whole.cells[2 * j : 2 * j + 2], nodes[j][mesh.cells])
    assert whole.source == "wheel of grid"


def test_groups_of_the_wheel_are_those_of_all_sectors(sector):
    whole, nodes = wheel_mesh(sector), wheel_nodes(sector)
    base, mesh = whole.groups["base"], sector.structure.mesh
    assert base.nodes.tolist() == np.unique(nodes[:, mesh.groups["base"].nodes]).tolist()
    own = mesh.groups["base"].facets.tolist()
    assert base.facets.tolist() == [[2 * j + cell, facet] for j in range(4) for cell, facet in own]
    assert whole.groups["blade"].cells.tolist() == [1, 3, 5, 7]
    assert whole.groups["blade"].facets is None


def test_fields_of_a_diameter_turn_with_the_sectors_and_their_phase(sector):
    """u_j = Re, Im of R^j u e^(i n j pi/2), as vectors: displacements and leanings of the directors."""
    mesh, whole, nodes = sector.structure.mesh, wheel_mesh(sector), wheel_nodes(sector)
    part = replace(sector.structure, mesh=whole)
    rng = np.random.default_rng(3)
    shapes, n = rng.standard_normal((len(mesh.points), 5, 2)), np.array([1, 2])
    real, imaginary = wheel_fields(sector, shapes, n, part.mesh)
    inner = np.setdiff1d(np.arange(len(mesh.points)), [*sector.pairs.low, *sector.pairs.high])
    own, others = tangent_frames(directors(mesh)), tangent_frames(directors(whole))
    for j in range(4):
        c, s = np.cos(j * np.pi / 2), np.sin(j * np.pi / 2)
        R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
        phase = np.exp(0.5j * np.pi * j * n)
        for k in inner:
            there = nodes[j, k]
            u = (R @ shapes[k, :3]) * phase
            np.testing.assert_allclose(real[there, :3] + 1j * imaginary[there, :3], u, atol=1e-13)
            lean = (R @ own[k].T @ shapes[k, 3:]) * phase
            found = others[there].T @ (real[there, 3:] + 1j * imaginary[there, 3:])
            np.testing.assert_allclose(found, lean, atol=1e-9)


def test_directors_on_the_faces_are_those_of_the_whole_wheel(sector):
    whole, nodes = wheel_mesh(sector), wheel_nodes(sector)
    np.testing.assert_allclose(sector.structure.mesh.directors, directors(whole)[nodes[0]], atol=1e-13)
    plain = replace(sector.structure.mesh, directors=None)
    np.testing.assert_allclose(
        joint_directors(plain, sector.pairs, sector.turn), sector.structure.mesh.directors, atol=1e-14
    )


def test_turns_of_nodes_carry_displacements_and_leanings_over(sector):
    turns, (low, high) = node_turns(sector, 5), sector.pairs
    R = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    frames = tangent_frames(sector.structure.mesh.directors)
    assert turns.shape == (len(low), 5, 5)
    for k in range(len(low)):
        np.testing.assert_allclose(turns[k, :3, :3], R, atol=1e-15)
        np.testing.assert_allclose(frames[high[k]].T @ turns[k, 3:, 3:], R @ frames[low[k]].T, atol=1e-12)
        assert not turns[k, :3, 3:].any()
        assert not turns[k, 3:, :3].any()
    assert node_turns(sector, 3).shape == (len(low), 3, 3)


@pytest.mark.parametrize(("n", "count"), [(0, 1), (1, 1), (2, 0)])
def test_a_node_on_the_axis_moves_along_it_at_n_0_and_across_at_1(n, count):
    """u = e^(i n alpha) R u for a quarter turn: (0, 0, 1) at n = 0, (1, i, 0)/sqrt 2 or its conjugate at 1."""
    R = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    phase = np.exp(0.5j * np.pi * n)
    moves = still_motions(R, np.array([True, True, True]), phase)
    assert moves.shape == (3, count)
    np.testing.assert_allclose(phase * R @ moves, moves, atol=1e-12)
    np.testing.assert_allclose(moves.conj().T @ moves, np.eye(count), atol=1e-12)
    assert still_motions(R, np.array([True, True, False]), 1.0).shape == (2, 0)
    assert still_motions(R, np.zeros(3, dtype=bool), phase).shape == (0, 0)


def test_tied_matrices_are_hermitian():
    rng = np.random.default_rng(1)
    A, T = rng.standard_normal((4, 4)), rng.standard_normal((4, 2)) + 1j * rng.standard_normal((4, 2))
    A = A + A.T
    found = tied(csc_array(A), csc_array(T)).toarray()
    np.testing.assert_allclose(found, T.conj().T @ A @ T, rtol=1e-12)
    np.testing.assert_array_equal(found, found.conj().T)


@pytest.mark.parametrize(("axis", "centre", "told"), [
    ((0.0, 0.0, 2.0), (0.0, 0.0, 7.0), None), ((0.0, 0.0, -1.0), (0.0, 0.0, 0.0), None),
    ((0.0, 1e-3, 1.0), (0.0, 0.0, 0.0), r"axis \(0\.0, 0\.001, 1\.0\) through"),
    ((0.0, 0.0, 1.0), (1e-6, 0.0, 0.0), "beside"),
])  # fmt: skip
def test_a_sector_turns_about_the_axis_of_its_wheel(axis, centre, told):
    rotation = cf.Rotation(omega=1.0, axis=axis, centre=centre)
    if told is None:
        require_axis(rotation, Z_TURN)
        require_axis(None, Z_TURN)
        return
    with pytest.raises(cf.errors.ModelError, match=f"rotation: found .*{told}") as caught:
        require_axis(rotation, Z_TURN)
    assert caught.value.code == "cyclic-axis"


def test_the_scale_of_a_wheel_is_that_of_its_whole_breadth(sector):
    """c t over the square of the larger size: the breadth of the wheel is 2 x 0.5 m."""
    made = assemble_cyclic(sector)
    size = sector.structure.mesh.size
    expected = np.sqrt(STEEL.E / STEEL.rho) * 0.01 / (size**2 + 1.0)
    assert made.frequency_scale == pytest.approx(expected, rel=1e-9)
    assert made.spin is None


def test_a_blade_is_all_cells_or_those_of_its_group(sector):
    system = assemble_cyclic(sector).system
    structure = sector.structure
    whole = blade_stiffness(structure, system, None)
    np.testing.assert_allclose(whole.toarray(), system.K.toarray(), rtol=1e-9, atol=1e-6 * abs(system.K).max())
    part = blade_stiffness(structure, system, "blade").toarray()
    touched = np.isin(system.free // 5, structure.mesh.cells[1])
    assert not part[~touched].any()
    alone = np.flatnonzero(np.isin(system.free // 5, np.setdiff1d(structure.mesh.cells[1], structure.mesh.cells[0])))
    np.testing.assert_allclose(part[np.ix_(alone, alone)], system.K.toarray()[np.ix_(alone, alone)], rtol=1e-9)
    with pytest.raises(cf.errors.ModelError, match=r"grid: blade 'base'.*\[mesh-group-no-cells\]"):
        blade_stiffness(structure, system, "base")


@pytest.mark.parametrize(("sectors", "told"), [(1, "found 1, expected 2 or more"), (0, "found 0")])
def test_a_wheel_has_two_sectors_or_more(sector, sectors, told):
    with pytest.raises(cf.errors.ModelError, match=rf"cyclic\.sectors: {told}"):
        cf.imported.CyclicSector(structure=sector.structure, sectors=sectors)


def test_two_halves_with_named_faces_make_a_wheel():
    ends = {"low": (0, 0.0), "high": (0, 1.0)}
    mesh = cf.imported.grid_mesh("quad9", (4, 1), lambda u: cone(u * [2.0, 1.0]), groups=ends)
    part = cf.MeshShell(mesh=mesh, thickness=0.01, material=STEEL, supports={})
    half = cf.imported.CyclicSector(structure=part, sectors=2, faces=("low", "high"))
    assert half.diameters == (0, 1)
    assert len(np.unique(wheel_nodes(half))) == 8 * 2 * 3
