"""What a motion consists of, by hand: plants and drives of driven bodies, forcings, phases of closed contacts."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.cycles.driven import looks_of
from contact.cycles.switched import Forcing, Plant, phase_of

OMEGA, ZETA = np.array([2.0, 5.0]), np.array([0.01, 0.03])
ROWS = np.array([[1.0, 0.5], [0.3, -0.7], [-0.2, 0.9], [0.4, 0.6]])
COUPLED = np.array([[0.5, 0.1, 0.0, 0.2], [0.1, 0.4, 0.05, 0.0], [0.0, 0.05, 0.3, 0.1], [0.2, 0.0, 0.1, 0.6]])


def body(omega=OMEGA, S=COUPLED):
    return ct.ModalBody(omega=omega, zeta=ZETA, channels=("d", "n1", "t1", "n2"), rows=ROWS, S=S)


def driven(mu=0.0, slide=-3.0, S=COUPLED, **more):
    """One contact with friction, or two without."""
    given = {"normal": ("n1",), "tangent": (("t1",),), "slide": slide} if mu else {"normal": ("n1", "n2")}
    patch = ct.Patch(body=body(S=S), clearance=0.25, load=[0.7, -0.4], pressed=0.125, **given)
    return ct.cycles.DrivenBody(
        patch=patch, channel="d", amplitude=3.0, mu=mu, **{"stiffness": 8.0, "shown": ("d",)} | more
    )


def test_the_plant_of_a_driven_body_without_friction():
    plant = driven(restitution=[0.0, 0.5]).over("freq_hz", freq_hz=1.5).plant
    A = np.zeros((4, 4))
    A[:2, 2:], A[2:, :2], A[2:, 2:] = np.diag(OMEGA), -np.diag(OMEGA), -np.diag(2.0 * ZETA * OMEGA)
    np.testing.assert_allclose(plant.A, A, rtol=1e-14)
    N = ROWS[[1, 3]]
    np.testing.assert_allclose(plant.B, np.vstack([np.zeros((2, 2)), N.T / OMEGA[:, None]]), rtol=1e-14)
    np.testing.assert_allclose(plant.C, np.hstack([N, np.zeros((2, 2))]), rtol=1e-14)
    np.testing.assert_allclose(plant.S, [[0.4 + 0.125, 0.0], [0.0, 0.6 + 0.125]], rtol=1e-14)
    np.testing.assert_allclose(plant.D, [[1.0, 0.5, 0.0, 0.0]], rtol=1e-14)
    np.testing.assert_allclose(plant.E, [[0.1, 0.2]], rtol=1e-14)
    assert plant.restitution.tolist() == [0.0, 0.5]
    springs = N.T @ np.diag([1.0 / 0.525, 1.0 / 0.725]) @ N
    slow = driven().over("freq_hz", freq_hz=0.01).plant
    assert slow.rate == pytest.approx(math.sqrt(25.0 + np.linalg.norm(springs, 2)), rel=1e-12)
    assert driven().over("freq_hz", freq_hz=100.0).plant.rate == pytest.approx(200.0 * math.pi, rel=1e-12)
    assert (plant.slips, plant.hidden) == ((), 0)


@pytest.mark.parametrize("slide", [-3.0, 4.0])
def test_friction_pushes_along_the_slide(slide):
    plant, sign, mu = driven(0.2, slide).over("freq_hz", freq_hz=1.5).plant, math.copysign(1.0, slide), 0.2
    push = ROWS[1] + mu * sign * ROWS[2]
    np.testing.assert_allclose(plant.B[2:, 0], push / OMEGA, rtol=1e-14)
    np.testing.assert_allclose(plant.S, [[0.4 + mu * sign * 0.05 + 0.125]], rtol=1e-14)
    np.testing.assert_allclose(plant.D, [[1.0, 0.5, 0, 0], [0, 0, *(-sign * ROWS[2] * OMEGA)]], atol=1e-14)
    np.testing.assert_allclose(plant.E, [[0.1], [0.0]], atol=1e-14)
    assert (plant.slips, plant.hidden) == (((0, 1),), 1)
    motion, _ = driven(0.2, slide).over("freq_hz", freq_hz=1.5).at(2.0)
    assert motion.drive.d.rest.tolist() == [0.0, abs(slide)]
    assert motion.drive.d.wave.tolist() == [[1.5], [0.0]]


def test_the_drive_of_a_driven_body_is_its_force_and_load():
    family = driven().over("freq_hz", freq_hz=1.5)
    motion, period = family.at(2.0)
    drive = motion.drive
    assert (period, drive.w, drive.harmonics.tolist()) == (0.5, pytest.approx(4.0 * math.pi), [1.0])
    np.testing.assert_allclose(drive.b.rest, [0.0, 0.0, 0.35, -0.08], rtol=1e-14)
    np.testing.assert_allclose(drive.b.wave[:, 0], [0.0, 0.0, 1.5, 0.3], rtol=1e-14)
    np.testing.assert_allclose(drive.c.rest, [0.375, 0.375], rtol=1e-14)
    np.testing.assert_allclose(drive.c.wave[:, 0], [0.3, 0.6], rtol=1e-14)
    np.testing.assert_allclose(drive.d.wave[:, 0], [1.5], rtol=1e-14)
    assert drive.d.rest.tolist() == [0.0]


@pytest.mark.parametrize(("name", "value"), [("freq_hz", 2.0), ("amplitude", 7.0), ("clearance", 0.5)])
def test_one_parameter_varies_and_the_others_stay(name, value):
    family = driven().over(name, freq_hz=1.5)
    motion, period = family.at(value)
    assert period == pytest.approx(1.0 / (value if name == "freq_hz" else 1.5))
    assert motion.drive.b.wave[2, 0] == pytest.approx((value if name == "amplitude" else 3.0) / 2.0)
    assert motion.drive.c.rest[0] == pytest.approx((value if name == "clearance" else 0.25) + 0.125)
    assert (family.name, family.channels) == (name, ("d",))


def test_frequencies_of_a_drive_are_above_zero():
    for freq_hz in (0.0, -1.0):
        with pytest.raises(ct.InputError, match="freq_hz: found"):
            driven().over("amplitude", freq_hz=freq_hz)
        with pytest.raises(ct.InputError, match="freq_hz: found"):
            driven().over("freq_hz", freq_hz=1.0).at(freq_hz)
    for name in ("amplitude", "mu"):
        with pytest.raises(ct.InputError, match=f"{name}: found -0.5"):
            replace(driven(), **{name: -0.5})


def test_a_rigid_mode_has_a_frequency_too_low_to_be_felt_and_no_damping():
    patch = ct.Patch(body=body(omega=np.array([0.0, 0.5])), normal=("n1",))
    family = ct.cycles.DrivenBody(patch=patch, channel="d", amplitude=1.0, stiffness=8.0).over("freq_hz", freq_hz=1.5)
    scale, slow = 3.0 * math.pi, 1e-6 * 3.0 * math.pi
    np.testing.assert_allclose(family.scale, [scale, 0.5], rtol=1e-14)
    np.testing.assert_allclose(np.diag(family.plant.A[2:, :2]), [-(slow**2) / scale, -0.5], rtol=1e-12)
    np.testing.assert_allclose(np.diag(family.plant.A[2:, 2:]), [0.0, -0.03], rtol=1e-12)
    assert family.state([1.0, 2.0], [3.0, 4.0]).tolist() == pytest.approx([1.0, 2.0, 3.0 / scale, 8.0])
    assert family.channels == ("d", "n1", "t1", "n2")


def test_runs_begin_where_the_patch_does():
    patch = ct.Patch(body=body(), normal=("n1",), clearance=9.0, displacement=[1.0, -2.0], velocity=[4.0, 10.0])
    family = ct.cycles.DrivenBody(patch=patch, channel="d", amplitude=1.0, stiffness=8.0).over("freq_hz", freq_hz=1.5)
    assert family.begin.tolist() == [1.0, -2.0, 2.0, 2.0]


def test_looks_in_a_period():
    """Every half a radian of the fastest vibration, from 128 to 65,536; as many as wanted."""
    assert looks_of(2.0, 100.25, None) == 2.0 / 401
    assert looks_of(2.0, 1.0, None) == 2.0 / 128
    assert looks_of(2.0, 1e6, None) == 2.0 / 65536
    assert looks_of(2.0, 1e6, 10) == 0.2
    motion, period = driven().over("freq_hz", freq_hz=1.0, looks=50).at(2.0)
    assert motion.step == pytest.approx(period / 50)


def test_rigid_contacts_that_follow_from_each_other_are_refused():
    patch = ct.Patch(body=body(S=np.zeros((4, 4))), normal=("n1", "n1"), clearance=1.0)
    with pytest.raises(ct.InputError, match="normal: found rigid contacts that are not independent"):
        ct.cycles.DrivenBody(patch=patch, channel="d", amplitude=1.0)
    ct.cycles.DrivenBody(patch=patch, channel="d", amplitude=1.0, stiffness=[8.0, math.inf])
    for name in ("channel", "shown"):
        with pytest.raises(ct.InputError, match="channel: found 'z'"):
            ct.cycles.DrivenBody(
                patch=patch, **{"channel": "d", "amplitude": 1.0} | {name: ("z",) if name == "shown" else "z"}
            )


def test_forcings_add_turn_into_rates_and_are_seen():
    one = Forcing(np.array([1.0, -2.0]), np.array([[1.0 + 2.0j, 3.0j], [0.5, -1.0j]]))
    angle, w = np.array([0.4, 1.1]), np.array([2.0, 6.0])
    exact = [1.0 + np.cos(0.4) - 2.0 * np.sin(0.4) - 3.0 * np.sin(1.1), -2.0 + 0.5 * np.cos(0.4) + np.sin(1.1)]
    assert one.at(angle) == pytest.approx(exact, rel=1e-12)
    rate = [-2.0 * np.sin(0.4) - 4.0 * np.cos(0.4) - 18.0 * np.cos(1.1), -np.sin(0.4) + 6.0 * np.cos(1.1)]
    assert one.rate(w).at(angle) == pytest.approx(rate, rel=1e-12)
    assert one.plus(one).at(angle) == pytest.approx(2.0 * np.array(exact), rel=1e-12)
    assert one.seen(np.array([[2.0, -1.0]])).at(angle) == pytest.approx([2.0 * exact[0] - exact[1]], rel=1e-12)


def plant(S):
    """Two coordinates before two contacts, the second one rigid where S is."""
    A = np.array([[0, 0, 1.0, 0], [0, 0, 0, 1.0], [-3.0, 0.5, -0.1, 0], [0.5, -7.0, 0, -0.2]])
    C = np.array([[1.0, 0.2, 0, 0], [-0.3, 1.0, 0, 0]])
    B = np.vstack([np.zeros((2, 2)), C[:, :2].T * [[1.0, 1.0], [2.0, 2.0]]])
    return Plant(A=A, B=B, C=C, S=np.array(S), D=np.array([[0.6, 0.1, 0, 0]]), E=np.array([[0.05, 0.02]]),
                 restitution=np.zeros(2), rate=4.0)  # fmt: skip


def test_soft_contacts_press_by_what_they_overlap():
    both = plant([[0.2, 0.03], [0.01, 0.5]])
    phase, give = phase_of(both, (0, 1)), np.linalg.inv([[0.2, 0.03], [0.01, 0.5]])
    np.testing.assert_allclose(phase.K, -give @ both.C, rtol=1e-12)
    np.testing.assert_allclose(phase.A, both.A - both.B @ give @ both.C, rtol=1e-12)
    np.testing.assert_allclose(phase.rows, np.vstack([phase.K, both.D + both.E @ phase.K]), rtol=1e-12)
    one = phase_of(both, (1,))
    np.testing.assert_allclose(one.K, -both.C[[1]] / 0.5, rtol=1e-12)
    np.testing.assert_allclose(one.rows[0], both.C[0] + 0.03 * one.K[0], rtol=1e-12)
    start = np.array([0.3, -0.2, 0.5, 1.0])
    h = 1e-4
    moved = (phase.flow(h, start[:, None]) - phase.flow(-h, start[:, None]))[:, 0] / (2.0 * h)
    np.testing.assert_allclose(moved, phase.A @ start, rtol=1e-6)
    np.testing.assert_allclose(phase.flow(0.0, np.eye(4)), np.eye(4), atol=1e-12)
    assert both.rigid.tolist() == [False, False]


def test_a_rigid_contact_is_held_by_what_pulls_its_gap_back():
    """gap'' + 2.7 r gap' + 1.7 r^2 gap = 0 at the rate r of the plant."""
    held = plant([[0.2, 0.0], [0.0, 0.0]])
    assert held.rigid.tolist() == [False, True]
    assert (held.soft.tolist(), held.soft_S.tolist()) == ([0], [[0.2]])
    np.testing.assert_allclose(held.impulse, held.C @ held.A @ held.B, rtol=1e-12)
    for closed in ((1,), (0, 1)):
        A, c = phase_of(held, closed).A, held.C[1]
        np.testing.assert_allclose(c @ A @ A + 2.7 * 4.0 * c @ A + 1.7 * 16.0 * c, 0.0, atol=1e-11)
    np.testing.assert_allclose(phase_of(held, (0, 1)).K[0], -held.C[0] / 0.2, rtol=1e-12)
