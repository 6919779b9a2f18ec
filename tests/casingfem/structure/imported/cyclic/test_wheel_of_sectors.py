"""A sector and its wheel: nodes, groups, fields, motions on the axis, the stiffness of a blade."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.parts import STEEL

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


@pytest.mark.parametrize(("sectors", "told"), [(1, "found 1, expected 2 or more"), (0, "found 0")])
def test_a_wheel_has_two_sectors_or_more(sector, sectors, told):
    with pytest.raises(cf.errors.ModelError, match=rf"cyclic\.sectors: {told}"):
        cf.imported.CyclicSector(structure=sector.structure, sectors=sectors)
