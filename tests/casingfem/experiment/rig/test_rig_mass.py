"""Accelerometers weigh: one degree of freedom, the model with the masses built in, static answers."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.rig.structure import loaded, towards

ANGLES = (0.2, 1.9)
MASS = 0.012
MASSES = (MASS, 0.008)


@pytest.fixture(scope="module")
def bare(coarse, frustum):
    return cf.modes(frustum(mesh=coarse), 30, method="shell")


def test_a_mass_on_one_degree_of_freedom():
    rig = cf.rig.Rig.of(omega=[700.0], zeta=[0.02], rows=[[2.0], [1.0]])  # 1/4 kg
    heavy = loaded(rig, [0], [0.01])
    assert heavy.omega[0] == pytest.approx(700.0 * np.sqrt(0.25 / 0.26), rel=1e-12)
    np.testing.assert_allclose(heavy.rows[:, 0], [1.0 / np.sqrt(0.26), 0.5 / np.sqrt(0.26)], rtol=1e-12)
    viscous = 2.0 * heavy.zeta[0] * heavy.omega[0] * 0.26  # c does not change
    assert viscous == pytest.approx(2.0 * 0.02 * 700.0 * 0.25, rel=1e-12)


def test_loaded_modes_are_free_vibrations_of_the_bare_rig_under_the_masses_inertia():
    """phi = omega^2 H(omega) m phi with the bare rig's undamped H, S and all; unit modal mass; damping of its parts."""
    rows = np.array([[1.0, 0.2, 0.7], [-0.4, 0.9, 0.5], [0.3, 0.3, -1.1], [0.6, -0.8, 0.1]])
    half = np.array([[2.0, 0.0, 0.0, 0.0], [0.5, 1.5, 0.0, 0.0], [0.3, -0.4, 1.2, 0.0], [0.1, 0.2, 0.3, 1.0]])
    bare = cf.rig.Rig.of(omega=[900.0, 1300.0, 2500.0], zeta=[0.01, 0.02, 0.005], rows=rows, S=1e-7 * half @ half.T)
    at, m = [2, 0], np.array([0.3, 0.12])
    heavy = loaded(bare, at, m)
    assert np.all(heavy.omega < 0.999 * bare.omega)
    for k, omega in enumerate(heavy.omega):
        phi = heavy.rows[:, k]
        pushed = omega**2 * m * phi[at]
        q = bare.rows[at].T @ pushed / (bare.omega**2 - omega**2)
        np.testing.assert_allclose(bare.rows @ q + bare.S[:, at] @ pushed, phi, rtol=1e-9)
        assert q @ q + m @ phi[at] ** 2 == pytest.approx(1.0, rel=1e-9)
        assert 2.0 * heavy.zeta[k] * omega == pytest.approx(q**2 @ (2.0 * bare.zeta * bare.omega), rel=1e-9)
    np.testing.assert_allclose(heavy.receptance(range(4), range(4), [0.0]), bare.receptance(range(4), range(4), [0.0]))


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


def test_without_the_residual_the_shift_is_too_small(bare):
    at = [cf.rig.Place(at=(0.25, a), direction=d) for a in ANGLES for d in ("x", "y", "z")]
    rig = cf.rig.rig_of(bare, at, zeta=0.002)
    with_S = loaded(rig, range(6), MASS).freq
    without = loaded(cf.rig.Rig.of(omega=rig.omega, zeta=rig.zeta, rows=rig.rows), range(6), MASS).freq
    assert np.max(without[:20] / with_S[:20] - 1.0) > 2e-4


def test_static_answers_do_not_feel_the_mass(bare):
    system = cf.shell.assemble(bare.shell)
    places = cf.rig.circle(0.25, 5)
    light = cf.rig.rig_of(bare, places, zeta=0.002, system=system)
    heavy = cf.rig.rig_of(bare, cf.rig.circle(0.25, 5, mass=0.05), zeta=0.002, system=system)
    at = range(5)
    np.testing.assert_allclose(heavy.receptance(at, at, [0.0]), light.receptance(at, at, [0.0]), rtol=1e-9, atol=1e-18)


def test_bad_masses_are_refused():
    rig = cf.rig.Rig.of(omega=[700.0], zeta=[0.02], rows=[[2.0]])
    with pytest.raises(cf.errors.InputError, match="expected 0 or more"):
        cf.rig.Place(at=(0.0, 0.0), mass=np.inf)
    for mass in (-1.0, np.nan):
        with pytest.raises(cf.errors.InputError, match="masses of 0 kg or more"):
            loaded(rig, [0], [mass])
        with pytest.raises(cf.errors.InputError, match="masses of 0 kg or more"):
            loaded(rig, [0, 0], [0.1, mass])
        with pytest.raises(cf.errors.InputError, match="expected 0 or more"):
            cf.rig.Place(at=(0.0, 0.0), mass=mass)


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


C, S = np.cos(0.3), np.sin(0.3)
TOWARDS = {  # vector, its number on a closed casing and on an open part
    "radial": ([C, S, 0.0], 1, 0), "hoop": ([-S, C, 0.0], 2, 0), "axial": ([0.0, 0.0, 1.0], 3, 3),
    "x": ([1.0, 0.0, 0.0], 0, 1), "y": ([0.0, 1.0, 0.0], 0, 2), "z": ([0.0, 0.0, 1.0], 3, 3),
    "normal": ([0.6, 0.0, 0.8], 0, 0),
}  # fmt: skip


@pytest.mark.parametrize("direction", TOWARDS)
def test_a_direction_is_its_unit_vector_and_its_number(direction):
    vector, closed, open_ = TOWARDS[direction]
    for periodic, code in ((True, closed), (False, open_)):
        unit, number = towards(direction, 0.3, np.array([0.6, 0.0, 0.8]), closed=periodic)
        np.testing.assert_allclose(unit, vector, rtol=1e-15)
        assert number == code
