"""Statics of imported parts: resultants of loads, beams and pressure vessels, refusals."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.loads import nodal_loads

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


def weighed(offset):
    mass = cf.imported.PointMass(
        node=int(BEAM.groups["tip"].nodes[0]), mass=2.0, offset=(0.0, offset, 0.0), where="CONM2 7"
    )
    return replace(SOLID, mesh=replace(BEAM, attachments=cf.imported.Attachments(masses=(mass,))))


def shell(**supports):
    return cf.MeshShell(mesh=SKIN, thickness=0.01, material=STEEL, supports=supports)


def test_resultants_of_loads():
    """Force and moment of each load about the origin."""
    cases = [
        (cf.loads.Gravity(acceleration=(0.0, 0.0, -10.0)), (0, 0, -780.0), (-39.0, 390.0, 0)),
        (cf.loads.EdgeLoad(edge="tip", force=(0.0, 1e3, 0.0)), (0, 10.0, 0), (-0.5, 0, 10.0)),
        (cf.imported.FacetPressure(group="top", pressure=1e3), (0, 0, -100.0), (-5.0, 50.0, 0)),
        (cf.imported.NodeLoad(node=int(BEAM.node_numbers[0]), force=(1.0, 2.0, 3.0)), (1, 2, 3), (0, 0, 0)),
    ]
    for load, force, moment in cases:
        nodal = nodal_loads(SOLID, load)
        np.testing.assert_allclose(nodal.sum(axis=0), force, atol=1e-9 * 780)
        np.testing.assert_allclose(np.cross(BEAM.points, nodal).sum(axis=0), moment, atol=1e-9 * 780)


def test_the_weight_of_a_mass_hangs_on_its_node():
    load = cf.loads.Gravity(acceleration=(1.0, 0.0, -10.0))
    more = nodal_loads(weighed(0.0), load) - nodal_loads(SOLID, load)
    assert np.flatnonzero(more.any(axis=1)).tolist() == [BEAM.groups["tip"].nodes[0]]
    np.testing.assert_allclose(more.sum(axis=0), [2.0, 0.0, -20.0], rtol=1e-12)
    with pytest.raises(cf.errors.ModelError, match=r"Gravity on the CONM2 7, which stands off its node.*load-edge"):
        nodal_loads(weighed(-1e-9), load)


def test_loads_on_a_shells_wall():
    weight = nodal_loads(shell(), cf.loads.Gravity(acceleration=(0.0, 0.0, 1.0))).sum(axis=0)
    np.testing.assert_allclose(weight[:3], [0, 0, 7800 * 0.01 * np.pi], rtol=1e-5, atol=1e-9)
    line = nodal_loads(shell(), cf.loads.EdgeLoad(edge="end", force=(0.0, 0.0, 2.0))).sum(axis=0)
    np.testing.assert_allclose(line, [0, 0, 2.0 * np.pi], rtol=1e-5, atol=1e-9)
    pushed = nodal_loads(shell(), cf.loads.SurfaceLoad(force=(3.0, 0.0, 0.0))).sum(axis=0)
    np.testing.assert_allclose(pushed, [3.0 * np.pi, 0, 0], rtol=1e-5, atol=1e-9)
    pressed = nodal_loads(shell(), cf.loads.Pressure(pressure=1.0))
    radial = (pressed[:, :2] * SKIN.points[:, :2]).sum() / 0.5
    assert abs(radial) == pytest.approx(np.pi, rel=1e-4)  # the mesh's normal points in or out all round


@pytest.mark.slow
def test_a_pipe_under_pressure_grows_by_membrane_theory():
    """Open ends, one held along the axis, the other on soft springs: u_r = p R^2/(E t)."""
    held = shell(base=cf.imported.Fixed(directions=("z",)), end=cf.ElasticEdge(k_face=1e6))
    bent = cf.solve_static(held, [cf.loads.Pressure(pressure=1e6)])
    node = int(SKIN.node_numbers[np.abs(SKIN.points[:, 2] - 0.5).argmin()])
    radial = float(np.linalg.norm(bent.at(node)[:2]))
    assert radial == pytest.approx(1e6 * 0.25 / (210e9 * 0.01), rel=1e-3)


def test_a_cantilever_under_its_weight():
    beam = cf.Solid(mesh=BEAM, material=cf.Material(E=210e9, nu=0.0, rho=7800.0), supports={"root": cf.Clamped()})
    bent = cf.solve_static(beam, [cf.loads.Gravity()])
    w = 7800 * 0.01 * 9.80665
    inertia = 0.1**4 / 12
    expected = w / (8 * 210e9 * inertia) + 1.2 * w / (2 * 105e9 * 0.01)  # bending, and Timoshenko's shear
    assert -bent.fields[BEAM.groups["tip"].nodes, 2].mean() == pytest.approx(expected, rel=2e-3)
    weight = nodal_loads(beam, cf.loads.Gravity())
    assert bent.energy == pytest.approx(0.5 * float((weight * bent.fields).sum()), rel=1e-6)


@pytest.mark.parametrize(
    ("part", "load", "message"),
    [
        (SOLID, cf.loads.PointLoad(at=(0.0, 0.0), force=(0.0, 0.0, 1.0)), "a PointLoad on an imported mesh"),
        (SOLID, cf.loads.Pressure(pressure=1.0), "a Pressure on an imported mesh of hexahedron20"),
        (SOLID, cf.loads.EdgeLoad(edge="tpi", force=(0.0, 0.0, 1.0)), "no group 'tpi'"),
        (SOLID, cf.imported.NodeLoad(node=99999, force=(0.0, 0.0, 1.0)), "node 99999, which no cell has"),
        (
            shell(base=cf.Clamped()),
            cf.imported.FacetPressure(group="end", pressure=1.0),
            "expected a Pressure on its wall",
        ),
        (cf.Solid(mesh=BEAM, material=STEEL), cf.loads.Gravity(), "static-loose"),
        (PINNED, cf.imported.FacetPressure(group="pin", pressure=1.0), r"load on 'pin'.*mesh-group-no-facets"),
        (PINNED, cf.loads.EdgeLoad(edge="pin", force=(0.0, 0.0, 1.0)), r"load on 'pin'.*mesh-group-no-facets"),
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
