"""Accelerometers weigh: one degree of freedom, the model with the masses built in, static answers."""

import numpy as np
import pytest

import casingfem as cf

ANGLES = (0.2, 1.9)
MASS = 0.012
MASSES = (MASS, 0.008)


@pytest.fixture(scope="module")
def bare(coarse, frustum):
    return cf.modes(frustum(mesh=coarse), 30, method="shell")


@pytest.mark.slow
def test_masses_of_sensors_move_the_modes_as_masses_of_the_model_do(bare):
    places = [cf.rig.Place(at=(0.25, a), mass=m) for a, m in zip(ANGLES, MASSES, strict=True)]
    rig = cf.rig.rig_of(bare, places, zeta=0.002)
    masses = {"top": [cf.edge.EdgeMass(angle=a, mass=m) for a, m in zip(ANGLES, MASSES, strict=True)]}
    truth = cf.modes(cf.Shell(chart=bare.shell.chart, thickness=bare.shell.thickness, material=bare.shell.material,
                              supports=bare.shell.supports, mesh=bare.shell.mesh, masses=masses), 30)  # fmt: skip
    shift = truth.freq / bare.freq - 1.0
    assert shift[:14].min() < -4e-3
    np.testing.assert_allclose(rig.freq[:14], truth.freq[:14], rtol=2e-5)


def test_static_answers_do_not_feel_the_mass(bare):
    system = cf.shell.assemble(bare.shell)
    places = cf.rig.circle(0.25, 5)
    light = cf.rig.rig_of(bare, places, zeta=0.002, system=system)
    heavy = cf.rig.rig_of(bare, cf.rig.circle(0.25, 5, mass=0.05), zeta=0.002, system=system)
    at = range(5)
    np.testing.assert_allclose(heavy.receptance(at, at, [0.0]), light.receptance(at, at, [0.0]), rtol=1e-9, atol=1e-18)


def test_places_at_one_point_have_one_number_and_probes_their_points(bare):
    places = [cf.rig.Place(at=(0.25, 0.1)), cf.rig.Place(at=(0.1, -2.0)), cf.rig.Place(at=(0.25, 0.1), direction="y")]
    zeta = np.linspace(0.001, 0.002, 30)
    rig = cf.rig.rig_of(bare, places, zeta=zeta, first=5)
    assert [p.node for p in rig.probes] == [5, 6, 5]
    assert [p.node for p in cf.rig.rig_of(bare, places[:2], zeta=0.1).probes] == [1, 2]
    np.testing.assert_allclose([p.angle for p in rig.probes], [0.1, -2.0, 0.1], atol=1e-12)
    x = np.real(bare.shell.geometry(np.array([0.25, 0.1]), np.array([0.1, -2.0])).surface.x).T
    np.testing.assert_allclose([p.point for p in rig.probes], x[[0, 1, 0]], atol=1e-12)
    np.testing.assert_array_equal(rig.zeta, zeta)
    np.testing.assert_array_equal(rig.omega, bare.omega)
    np.testing.assert_array_equal(rig.S, rig.S.T)


def test_a_circle_of_sensors_goes_round_from_its_first_angle():
    found = cf.rig.circle(0.2, 3, first_angle=0.5, direction="axial", mass=0.01)
    assert [place.at[0] for place in found] == [0.2] * 3
    np.testing.assert_allclose([place.at[1] for place in found], 0.5 + 2.0 * np.pi / 3.0 * np.arange(3), rtol=1e-14)
    assert {(place.direction, place.mass) for place in found} == {("axial", 0.01)}
    assert {(place.direction, place.mass) for place in cf.rig.circle(0.2, 2)} == {("radial", 0.0)}
