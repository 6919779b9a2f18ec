"""What an assembled part gives and takes: fields and unknowns, forces, fixed dofs, with attachments and without."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from tests.casingfem.structure.imported.parts import STEEL, added_nodes, flat, hung

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-linear-cells", "ignore:.*mesh-orphan-nodes")
ENDS = {"root": (0, 0.0), "tip": (0, 1.0)}
BAR = cf.imported.grid_mesh("hexahedron", (2, 1, 1), lambda u: u * [0.2, 0.05, 0.04], groups=ENDS)


def bar(**items):
    """Two bricks with a node beyond the tip, where its nodes hang."""
    mesh, (node,) = added_nodes(BAR, (0.3, 0.01, 0.02))
    return hung(mesh, rigids=(cf.imported.Rigid(reference=node, nodes=mesh.groups["tip"].nodes),), **items), node


def test_fields_of_a_part_are_zero_where_it_is_fixed_and_where_no_cell_is():
    mesh, (orphan,) = added_nodes(BAR, (1.0, 1.0, 1.0))
    system = cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()}).assembled()
    assert system.size == 3 * 8
    vectors = np.random.default_rng(1).standard_normal((24, 2))
    fields = system.expand(vectors)
    assert fields.shape == (13, 3, 2)
    moving = np.ones(13, dtype=bool)
    moving[[*BAR.groups["root"].nodes, orphan]] = False
    assert not fields[~moving].any()
    assert system.moving.tolist() == np.repeat(moving[:, None], 3, axis=1).tolist()
    np.testing.assert_array_equal(system.restrict(fields), vectors)
    np.testing.assert_array_equal(system.collect(fields), vectors)
    axes = np.array([[0.6, 0.8, 0.0]])
    np.testing.assert_array_equal(system.expand(system.translations(axes))[moving, :, 0], np.tile(axes, (8, 1)))
    assert system.cells[1].tolist() == [12, *BAR.cells[1]]


def test_fields_of_a_part_with_connections_go_there_and_back():
    """Virtual work is the same; a translation moves every node alike; what hangs on a node moves too."""
    mesh, node = bar()
    system = cf.Solid(mesh=mesh, material=STEEL).assembled()
    rng = np.random.default_rng(2)
    vectors, forces = rng.standard_normal((system.size, 2)), rng.standard_normal((len(mesh.points), 3, 2))
    fields = system.expand(vectors)
    work = np.einsum("ndi,ndj->ij", fields, forces)
    np.testing.assert_allclose(vectors.T @ system.restrict(forces), work, rtol=1e-10)
    np.testing.assert_allclose(system.collect(fields), vectors, atol=1e-10)
    axes = np.array([[0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    moved = system.expand(system.translations(axes))
    np.testing.assert_allclose(moved, np.tile(axes.T, (len(mesh.points), 1, 1)), atol=1e-12)
    assert system.moving.all()
    assert (system.rigid, system.dofs) == (6, 3)
    assert node == len(mesh.points) - 1


@pytest.mark.parametrize("shell", [False, True])
def test_masses_lower_the_floor_of_frequencies(shell):
    """By the root of the part's own mass over all."""
    mesh = cf.imported.grid_mesh("quad", (2, 1), lambda u: flat(u * [0.2, 0.05]), groups=ENDS) if shell else BAR
    light, heavy = (hung(mesh, masses=(cf.imported.PointMass(node=0, mass=m),)) for m in (1e-12, 7.0))

    def scale(mesh):
        part = cf.MeshShell(mesh=mesh, thickness=0.01, material=STEEL) if shell else cf.Solid(mesh=mesh, material=STEEL)
        return part.assembled().frequency_scale

    own = 7800.0 * 0.2 * 0.05 * (0.01 if shell else 0.04)
    assert scale(heavy) / scale(light) == pytest.approx(np.sqrt(own / (own + 7.0)), rel=1e-9)
    assert scale(light) == pytest.approx(scale(mesh), rel=1e-9)
    if shell:
        expected = np.sqrt(STEEL.E / STEEL.rho) * 0.01 / (0.2**2 + 0.05**2)
    else:
        wall = 2.0 * 0.2 * 0.05 * 0.04 / (2.0 * (0.2 * 0.05 + 0.2 * 0.04 + 0.05 * 0.04))
        expected = np.sqrt(STEEL.E / STEEL.rho) * wall / (0.2**2 + 0.05**2 + 0.04**2)
    assert scale(mesh) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("part", "refused"), [(4e-9, False), (-4e-9, False), (6e-9, True), (-6e-9, True)])
def test_forces_along_a_motion_that_nothing_resists_are_refused_beyond_round_off(part, refused):
    """Idle is (.8, -.6) of node 3's x and y; of the force (3, 4) 1e-9 (3 x .8 + 4 x .6) is round-off."""
    mesh = cf.imported.MeshData(
        kind="tetra",
        points=np.vstack([np.zeros(3), np.eye(3)]),
        cells=np.array([[0, 1, 2, 3]]),
        node_numbers=np.array([5, 6, 7, 8]),
        source="part.inp",
    )
    idle = np.zeros((12, 2))
    idle[6:8, 1], idle[9, 0] = [0.8, -0.6], 1.0
    nothing = csc_array((12, 12))
    system = cf.imported.MeshSystem(
        structure=SimpleNamespace(mesh=mesh),
        K=nothing,
        M=nothing,
        free=np.arange(12),
        dofs=3,
        rigid=0,
        wall=1.0,
        frequency_scale=1.0,
        idle=csc_array(idle),
    )
    forces = np.zeros((4, 3, 1))
    forces[2, :2, 0] = np.array([3.0, 4.0]) + part * np.array([0.8, -0.6])
    forces[0] = 1e6
    if refused:
        with pytest.raises(cf.errors.ModelError, match=r"part\.inp: found a force on node 7 along [xy].*load-idle"):
            system.restrict(forces)
    else:
        np.testing.assert_array_equal(system.restrict(forces)[:, 0], forces.ravel())


def test_a_system_without_idle_motions_takes_every_force():
    system = cf.Solid(mesh=BAR, material=STEEL).assembled()
    forces = np.random.default_rng(3).standard_normal((12, 3, 1))
    np.testing.assert_array_equal(system.restrict(forces)[:, 0], forces.ravel())
    assert system.idle is None


def test_materials_of_groups_and_springs_on_facets_of_one_brick():
    """k_face on the area of the tip: the springs of a shift are k times the area, the least speed of sound counts."""
    soft = cf.Material(E=1e9, nu=0.3, rho=7800.0)
    groups = {"one": cf.imported.Group(nodes=BAR.cells[1], cells=[1]), "tip": BAR.groups["tip"]}
    mesh = replace(BAR, groups=groups)
    part = cf.Solid(mesh=mesh, material=STEEL, materials={"one": soft}, supports={"tip": cf.ElasticEdge(k_face=3e9)})
    system = part.assembled()
    assert part.constants().tolist() == [[210e9, 1e9], [0.3, 0.3], [7800.0, 7800.0]]
    assert part.density().tolist() == [7800.0, 7800.0]
    shift = system.translations(np.eye(3))
    np.testing.assert_allclose(shift.T @ (system.K @ shift), 3e9 * 0.05 * 0.04 * np.eye(3), rtol=1e-6, atol=1.0)
    np.testing.assert_allclose(shift.T @ (system.M @ shift), 3.12 * np.eye(3), rtol=1e-12, atol=1e-12)
    assert system.rigid == 0
    own = cf.Solid(mesh=mesh, material=STEEL).assembled().frequency_scale
    assert system.frequency_scale / own == pytest.approx(np.sqrt(1e9 / 210e9), rel=1e-12)
