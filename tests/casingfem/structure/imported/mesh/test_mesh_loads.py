"""Loads on facets that no axis is normal to, cell by cell and node by node."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.loads import group_facets, nodal_loads, solve_mesh_static, spread
from tests.casingfem.structure.imported.parts import STEEL, added_nodes, flat

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-linear-cells", "ignore:.*mesh-orphan-nodes")
SKEW = np.array([[2.0, 0.3, 0.0], [0.1, 3.0, 0.2], [0.0, -0.2, 5.0]])
ENDS = {"root": (0, 0.0), "tip": (0, 1.0)}
BRICKS = cf.imported.grid_mesh("hexahedron", (2, 1, 1), lambda u: u @ SKEW.T, groups=ENDS)
SOFT = cf.Material(E=1e9, nu=0.3, rho=1000.0)
TIP = BRICKS.groups["tip"].nodes


@pytest.fixture
def solid():
    """Two skew bricks, the second of a material of its own."""
    groups = {**BRICKS.groups, "one": cf.imported.Group(nodes=BRICKS.cells[1], cells=[1])}
    held = {"root": cf.Clamped()}
    return cf.Solid(mesh=replace(BRICKS, groups=groups), material=STEEL, materials={"one": SOFT}, supports=held)


def test_a_pressure_pushes_each_corner_of_a_parallelogram_alike(solid):
    """Less p/4 of the area along the outward normal, the cross product of the sides."""
    outward = np.cross(SKEW[:, 1], SKEW[:, 2])
    loads = nodal_loads(solid, cf.imported.FacetPressure(group="tip", pressure=7.0))
    np.testing.assert_allclose(loads[TIP], np.tile(-7.0 * outward / 4.0, (4, 1)), rtol=1e-12)
    assert np.flatnonzero(loads.any(axis=1)).tolist() == TIP.tolist()


def test_a_force_per_area_and_a_weight_are_shared_by_the_nodes(solid):
    area = np.linalg.norm(np.cross(SKEW[:, 1], SKEW[:, 2]))
    loads = nodal_loads(solid, cf.loads.EdgeLoad(edge="tip", force=(1.0, -2.0, 3.0)))
    np.testing.assert_allclose(loads[TIP], np.tile(area / 4.0 * np.array([1.0, -2.0, 3.0]), (4, 1)), rtol=1e-12)
    volume = np.linalg.det(SKEW) / 2.0
    weight = nodal_loads(solid, cf.loads.Gravity(acceleration=(0.5, 0.0, -10.0)))
    for nodes, rho in ((BRICKS.groups["root"].nodes, 7800.0), (TIP, 1000.0)):
        np.testing.assert_allclose(
            weight[nodes], np.tile(rho * volume / 8.0 * np.array([0.5, 0.0, -10.0]), (4, 1)), rtol=1e-12
        )


def test_a_shell_is_pushed_along_its_normal_or_as_a_force_says():
    mesh = cf.imported.grid_mesh("quad", (1, 1), lambda u: flat(u) @ SKEW.T)
    shell = cf.MeshShell(mesh=mesh, thickness=0.1, material=STEEL)
    area = np.cross(SKEW[:, 0], SKEW[:, 1])
    pressed = nodal_loads(shell, cf.loads.Pressure(pressure=7.0))
    np.testing.assert_allclose(pressed, np.tile(7.0 * area / 4.0, (4, 1)), rtol=1e-12)
    force = np.array([1.0, -2.0, 3.0])
    pushed = nodal_loads(shell, cf.loads.SurfaceLoad(force=tuple(force)))
    np.testing.assert_allclose(pushed, np.tile(np.linalg.norm(area) * force / 4.0, (4, 1)), rtol=1e-12)


def test_a_density_that_varies_goes_to_the_nodes_by_their_shape_functions():
    """x per area on a square of 2 x 3 from x = 0: a sixth of 12 on nodes at 0, a third on those at 2."""
    mesh = cf.imported.grid_mesh("hexahedron", (1, 1, 1), lambda u: u * [2.0, 3.0, 1.0], groups={"top": (2, 1.0)})
    ((on, nodes),) = group_facets(mesh, "top")
    density = on.x[..., :1] * [0.0, 0.0, 1.0]
    loads = spread(mesh, on, nodes, density)
    share = np.where(mesh.points[:, 0] > 1.0, 2.0, 1.0) * (mesh.points[:, 2] > 0.5)
    np.testing.assert_allclose(loads, share[:, None] * [0.0, 0.0, 1.0], atol=1e-13)


def test_a_force_is_put_on_a_node_by_its_number_in_the_file(solid):
    mesh, (orphan,) = added_nodes(BRICKS, (9.0, 9.0, 9.0))
    mesh = replace(mesh, node_numbers=np.arange(30, 30 + len(mesh.points)))
    part = replace(solid, mesh=mesh, materials={})
    loads = nodal_loads(part, cf.imported.NodeLoad(node=30 + int(TIP[1]), force=(1.0, 2.0, 3.0)))
    assert np.flatnonzero(loads.any(axis=1)).tolist() == [TIP[1]]
    assert loads[TIP[1]].tolist() == [1.0, 2.0, 3.0]
    with pytest.raises(cf.errors.ModelError, match=f"grid: load at node {30 + orphan}, which no cell has"):
        nodal_loads(part, cf.imported.NodeLoad(node=30 + orphan, force=(1.0, 2.0, 3.0)))


def test_loads_that_act_together_add_up_and_their_table_names_the_nodes(solid):
    """Energy u.f/2; rows of the nodes that a cell has."""
    mesh, _ = added_nodes(BRICKS, (9.0, 9.0, 9.0))
    part = replace(solid, mesh=replace(mesh, node_numbers=np.arange(30, 30 + len(mesh.points))), materials={})
    loads = [
        cf.imported.NodeLoad(node=30 + int(TIP[0]), force=(1e3, 2e3, 3e3)),
        cf.imported.FacetPressure(group="tip", pressure=1e3),
    ]
    both = solve_mesh_static(part, loads)
    one, other = (solve_mesh_static(part, [load]) for load in loads)
    np.testing.assert_allclose(both.fields, one.fields + other.fields, rtol=1e-9, atol=1e-18)
    force = sum(nodal_loads(part, load) for load in loads)
    assert both.energy == pytest.approx(0.5 * np.sum(force * both.fields), rel=1e-9)
    np.testing.assert_array_equal(both.at(30 + int(TIP[0])), both.fields[TIP[0], :3])
    columns = both.columns()
    assert columns["node"].tolist() == list(range(30, 42))
    assert list(columns)[:4] == ["node", "x_m", "y_m", "z_m"]
    assert len(columns) == 7
    np.testing.assert_array_equal(columns["y_m"], BRICKS.points[:, 1])
    np.testing.assert_array_equal(list(columns.values())[6], both.fields[:12, 2])
    with pytest.raises(cf.errors.ModelError, match="grid: displacement at node 42, which no cell has"):
        both.at(42)
