"""What a static solution of an imported part says: its table, a node by its number, its energy."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.parts import STEEL, added_nodes, box, flat

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-linear-cells", "ignore:.*mesh-orphan-nodes")
LOADS = [cf.imported.NodeLoad(node=37, force=(3e3, -1e3, 2e3)), cf.imported.NodeLoad(node=34, force=(0.0, 5e3, -7e3))]


def plate():
    return cf.imported.grid_mesh("quad", (3, 1), lambda u: flat(u * [0.3, 0.1]), groups={"root": (0, 0.0)})


def numbered(mesh):
    """Numbers 30, 31, ... and at last a node of no cell."""
    mesh, _ = added_nodes(mesh, (5.0, 5.0, 5.0))
    return replace(mesh, node_numbers=np.arange(30, 30 + len(mesh.points)))


def brick():
    mesh = box(0.2, 0.1, 0.1)
    return replace(mesh, groups={"root": cf.imported.Group(nodes=np.flatnonzero(mesh.points[:, 2] == 0.0))})


@pytest.mark.parametrize("shell", [False, True])
def test_two_loads_bend_a_part_and_its_table_has_the_nodes_of_its_cells(shell):
    mesh = numbered(plate() if shell else brick())
    given = {"mesh": mesh, "material": STEEL, "supports": {"root": cf.Clamped()}}
    part = cf.MeshShell(thickness=0.01, **given) if shell else cf.Solid(**given)
    bent = cf.solve_static(part, LOADS)
    system = part.assembled()
    dofs = 5 if shell else 3
    forces = np.zeros((len(mesh.points), dofs))
    forces[7, :3], forces[4, :3] = LOADS[0].force, LOADS[1].force
    u = np.linalg.solve(system.K.toarray(), forces.ravel()[system.free])
    fields = np.zeros(forces.size)
    fields[system.free] = u
    fields = fields.reshape(-1, dofs)
    np.testing.assert_allclose(bent.fields, fields, rtol=1e-6, atol=1e-9 * np.abs(fields).max())
    assert bent.energy == pytest.approx(0.5 * float((forces * bent.fields).sum()), rel=1e-7)
    assert bent.structure is part
    table = bent.columns()
    names = ["node", "x_m", "y_m", "z_m", "u_x_m", "u_y_m", "u_z_m", "w_1_rad", "w_2_rad"]
    assert list(table) == names[: 4 + dofs]
    assert table["node"].tolist() == list(range(30, 38))
    np.testing.assert_array_equal(np.stack([table[name] for name in names[1:4]], axis=1), mesh.points[:8])
    np.testing.assert_array_equal(np.stack([table[name] for name in names[4 : 4 + dofs]], axis=1), bent.fields[:8])
    assert bent.at(34).tolist() == bent.fields[4, :3].tolist()
    with pytest.raises(cf.errors.ModelError, match=r"found node 38, expected a node of a cell.*load-place"):
        bent.at(38)
    again = cf.solve_static(part, LOADS[:1], system=replace(system, K=2.0 * system.K))
    alone = cf.solve_static(part, LOADS[:1])
    np.testing.assert_allclose(again.fields, 0.5 * alone.fields, rtol=1e-6, atol=1e-9 * np.abs(fields).max())
    with pytest.raises(cf.errors.ModelError, match=r"solve_static: found no loads, expected at least one"):
        cf.solve_static(part, [])
