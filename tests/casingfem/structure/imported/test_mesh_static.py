"""Statics of imported parts: resultants of loads, beams and pressure vessels, refusals."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
ENDS = {"root": (0, 0.0), "tip": (0, 1.0), "top": (2, 1.0)}
BEAM = cf.imported.grid_mesh("hexahedron20", (8, 2, 2), lambda u: u * [1.0, 0.1, 0.1], groups=ENDS)
SOLID = cf.Solid(mesh=BEAM, material=STEEL, supports={"root": cf.Clamped()})
SKIN = cf.imported.grid_mesh(
    "quad9", (32, 6), lambda u: cf.imported.revolved((0.5, 0.5), (0.0, 1.0), 0.01)(np.insert(u, 0, 0.5, axis=1)),
    groups={"base": (1, 0.0), "end": (1, 1.0)}, wrap=0,
)  # fmt: skip


PINNED = replace(
    SOLID, mesh=replace(BEAM, groups={**BEAM.groups, "pin": cf.imported.Group(nodes=BEAM.groups["tip"].nodes[:3])})
)


def shell(**supports):
    return cf.MeshShell(mesh=SKIN, thickness=0.01, material=STEEL, supports=supports)


@pytest.mark.slow
def test_a_pipe_under_pressure_grows_by_membrane_theory():
    """Open ends, one held along the axis, the other on soft springs: u_r = p R^2/(E t)."""
    held = shell(base=cf.imported.Fixed(directions=("z",)), end=cf.ElasticEdge(k_face=1e6))
    bent = cf.solve_static(held, [cf.loads.Pressure(pressure=1e6)])
    node = int(SKIN.node_numbers[np.abs(SKIN.points[:, 2] - 0.5).argmin()])
    radial = float(np.linalg.norm(bent.at(node)[:2]))
    assert radial == pytest.approx(1e6 * 0.25 / (210e9 * 0.01), rel=1e-3)


@pytest.mark.parametrize(
    ("part", "load", "message"),
    [
        (
            SOLID,
            cf.loads.PointLoad(at=(0.0, 0.0), force=(0.0, 0.0, 1.0)),
            "found a PointLoad, which cannot act on a mesh",
        ),
        (SOLID, cf.loads.Pressure(pressure=1.0), "found a Pressure, which cannot act on a mesh of hexahedron20"),
        (SOLID, cf.loads.EdgeLoad(edge="tpi", force=(0.0, 0.0, 1.0)), "no group 'tpi'"),
        (
            SOLID,
            cf.imported.NodeLoad(node=99999, force=(0.0, 0.0, 1.0)),
            "found a load at node 99999, expected a node of a cell",
        ),
        (
            shell(base=cf.Clamped()),
            cf.imported.FacetPressure(group="end", pressure=1.0),
            "expected a Pressure",
        ),
        (cf.Solid(mesh=BEAM, material=STEEL), cf.loads.Gravity(), "static-loose"),
        (PINNED, cf.imported.FacetPressure(group="pin", pressure=1.0), r"load on group 'pin'.*mesh-group-no-facets"),
        (PINNED, cf.loads.EdgeLoad(edge="pin", force=(0.0, 0.0, 1.0)), r"load on group 'pin'.*mesh-group-no-facets"),
    ],
)
def test_loads_that_cannot_be_are_named(part, load, message):
    with pytest.raises(cf.errors.ModelError, match=message):
        cf.solve_static(part, [load])


def test_no_loads_and_no_node():
    with pytest.raises(cf.errors.ModelError, match="load-none"):
        cf.solve_static(SOLID, [])
    with pytest.raises(cf.errors.ModelError, match="node 99999"):
        cf.solve_static(SOLID, [cf.loads.Gravity()]).at(99999)
