"""References on numbers that are no ones: straight lines, plateaus, errors, orbits, characteristics."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contact as ct

ROD = ct.Rod(length=3.0, area=0.5, E=8.0, rho=2.0)  # waves run with 2 m/s, the impedance is 2 kg/s


def test_a_force_in_straight_lines():
    lines = ct.reference.ExactContact(
        intervals=np.array([[1.0, 3.0], [5.0, 6.0]]), force=np.array([[2.0, 6.0], [4.0, 1.0]])
    )
    assert lines.impulse == 2.0 * 4.0 + 1.0 * 2.5
    assert lines(np.array([0.9, 1.0, 1.5, 2.999, 3.0, 5.0, 5.5, 6.0])).tolist() == pytest.approx(
        [0.0, 2.0, 3.0, 5.998, 0.0, 4.0, 2.5, 0.0], rel=1e-12
    )


def test_plateaus_of_rods():
    pair, wall = ct.reference.two_rods(ROD, gap=0.6, velocity=3.0), ct.reference.rod_on_wall(ROD, gap=0.6, velocity=3.0)
    assert pair.force.tolist() == [[3.0, 3.0]]
    assert wall.force.tolist() == [[6.0, 6.0]]
    for exact in (pair, wall):
        assert exact.intervals[0] == pytest.approx([0.2, 3.2], rel=1e-14)
    for make in (ct.reference.two_rods, ct.reference.rod_on_wall):
        assert make(ROD, gap=0.0, velocity=3.0).intervals[0, 0] == 0.0
        with pytest.raises(ct.InputError, match=r"gap: found -0\.1"):
            make(ROD, gap=-0.1, velocity=3.0)
        with pytest.raises(ct.InputError, match=r"velocity: found 0\.0"):
            make(ROD, gap=0.1, velocity=0.0)


def test_a_bar_bounces_in_turns_of_two():
    bar = ct.reference.bouncing_bar(5)
    starts = [1.0, 11 / 3, 19 / 3, 9.0, 35 / 3]
    np.testing.assert_allclose(bar.intervals, [[a, a + 2 / 3] for a in starts], rtol=1e-14)
    assert bar.force.tolist() == [[300.0, 500.0], [500.0, 300.0]] * 2 + [[300.0, 500.0]]


@pytest.mark.parametrize("norm", [1, 2])
def test_errors_are_shares_of_the_exact_norm(norm):
    """Of a force 2 t, four points in each of two steps of 0.5 s about 1 and 1.5 s."""
    at = np.array([[0.8125, 0.9375, 1.0625, 1.1875], [1.3125, 1.4375, 1.5625, 1.6875]])
    left = np.abs(np.array([[1.5], [3.5]]) - 2.0 * at)
    expected = (np.sum(left**norm) / np.sum((2.0 * at) ** norm)) ** (1.0 / norm)
    given = np.array([1.0, 1.5]), np.array([1.5, 3.5]), 0.5, lambda t: 2.0 * t
    assert ct.reference.force_error(*given, points=4, norm=norm) == pytest.approx(expected, rel=1e-13)
    fine = ct.reference.force_error(*given, points=16, norm=1)
    assert ct.reference.force_error(*given) == fine


def test_a_falling_bar_by_characteristics_is_free_until_it_meets_the_wall():
    """Gap x + v t - g t^2/2 at whole steps, force -Z times the speed of arrival."""
    bar = ct.Rod(length=3.0, area=0.5, E=8.0, rho=2.0, x=2.0, velocity=-1.0)
    found = ct.reference.bar_by_characteristics(bar, gravity=0.5, t_end=0.95, cells=10)
    assert found.time.size == found.gap.size == found.force.size + 1
    assert (found.time[1], found.time[-1]) == pytest.approx((0.15, 1.05), rel=1e-14)
    np.testing.assert_allclose(found.gap, 2.0 - found.time - 0.25 * found.time**2, rtol=1e-13)
    assert not found.force.any()
    touching = ct.Rod(length=3.0, area=0.5, E=8.0, rho=2.0, x=0.0, velocity=-1.0)
    pressed = ct.reference.bar_by_characteristics(touching, gravity=0.5, t_end=0.45, cells=10)
    np.testing.assert_allclose(pressed.force, 2.0 * (1.0 + 0.5 * 0.15 * (np.arange(3) + 0.5)), rtol=1e-13)
    assert pressed.gap.tolist() == [0.0] * 4
    assert ct.reference.bar_by_characteristics(touching, gravity=0.0, t_end=0.3, cells=10).force.size == 2
    with pytest.raises(ct.InputError, match=r"t_end: found 0\.0"):
        ct.reference.bar_by_characteristics(touching, gravity=0.0, t_end=0.0, cells=10)


def test_a_ball_and_a_stopped_oscillator_by_hand():
    ball = ct.reference.Bounces(height=2.5, gravity=5.0, restitution=0.5)
    assert (ball.first, ball.rest) == (1.0, 3.0)
    assert [ball.rebound(n) for n in range(3)] == [5.0, 2.5, 1.25]
    assert [ball.instant(n) for n in (1, 2, 3)] == [1.0, 2.0, 2.5]
    assert ct.reference.stopped_period(2.0, 0.3, 0.6) == pytest.approx((math.pi + math.pi / 3.0) / 2.0, rel=1e-14)
    assert ct.reference.stopped_period(2.0, -0.6, 0.6) == pytest.approx(0.0, abs=1e-12)
    assert ct.reference.stopped_period(2.0, 0.6, 0.6) == pytest.approx(math.pi, rel=1e-14)
    with pytest.raises(ct.InputError, match=r"gap: found -0\.7 m with amplitude 0\.6 m"):
        ct.reference.stopped_period(2.0, -0.7, 0.6)
    for given in ((0.0, 0.1, 1.0), (1.0, 0.1, 0.0)):
        with pytest.raises(ct.InputError, match=r"found 0\.0, expected a finite number > 0"):
            ct.reference.stopped_period(*given)


@pytest.mark.parametrize(
    ("omega", "drive", "drive_omega", "gap", "e", "cycles"),
    [(1.5, 2.0, 4.0, 0.05, 0.7, 1), (2.5, 7.0, 7.0, 0.02, 0.6, 2), (1.0, 1.0, 2.7, 0.0, 0.0, 1)],
)
def test_an_orbit_of_other_numbers_comes_back_after_its_period(omega, drive, drive_omega, gap, e, cycles):
    orbit = ct.reference.driven_orbit(
        omega=omega, drive=drive, drive_omega=drive_omega, gap=gap, restitution=e, cycles=cycles
    )
    assert orbit.period == pytest.approx(2.0 * math.pi * cycles / drive_omega, rel=1e-14)
    end = solve_ivp(
        lambda t, y: [y[1], drive * math.cos(drive_omega * t + orbit.phase) - omega**2 * y[0]], (0.0, orbit.period),
        [gap, -e * orbit.speed], rtol=1e-11, atol=1e-13,
    ).y[:, -1]  # fmt: skip
    assert end == pytest.approx([gap, orbit.speed], abs=1e-8)
    assert orbit.speed > 0.0


def test_an_impact_is_read_step_by_step():
    step_force = np.array([0.0, 4.0, 2.0, 1e-10, 0.0])
    none = np.zeros(6)
    impact = ct.reference.Impact(
        time=0.5 * np.arange(6), force=none, step_force=step_force, gap=none, left=none, right=none
    )
    assert impact.impulse == 3.00000000005
    assert impact.intervals.tolist() == [[0.5, 1.5]]  # a thousand-millionth of the largest is none
    assert impact(np.array([-1e-6, 0.0, 0.5, 0.99, 1.49, 1.5, 2.49, 2.5])).tolist() == [
        0.0, 0.0, 4.0, 4.0, 2.0, 1e-10, 0.0, 0.0,
    ]  # fmt: skip
    assert impact(np.array([1.0 - 1e-12])).tolist() == [2.0]


def test_rods_and_masses_by_characteristics_are_refused_or_fit():
    wall = ct.Wall(x=0.0)
    for body, words in (
        (ct.PointMass(mass=1.0, x=-1.0, stiffness=1.0), "mass: found a spring, dashpot or force"),
        (ct.PointMass(mass=1.0, x=-1.0, damping=1.0), "mass: found a spring, dashpot or force"),
        (ct.PointMass(mass=1.0, x=-1.0, force=1.0), "mass: found a spring, dashpot or force"),
        (ct.Rod(length=3.0, area=0.5, E=8.0, rho=2.0, x=-4.0, end_mass=1.0), "rod: found an end mass or damping"),
    ):  # fmt: skip
        with pytest.raises(ct.InputError, match=words):
            ct.reference.impact_by_characteristics(body, wall, dt=0.5, t_end=1.0)
    rod = ct.Rod(length=3.0, area=0.5, E=8.0, rho=2.0, x=-4.0, velocity=1.0)
    for dt, fits in ((3.0 / (10.0 + 0.9e-6), True), (3.0 / (10.0 + 1.2e-6), False), (3.0 / (10.0 - 1.2e-6), False)):
        if fits:
            ct.reference.impact_by_characteristics(rod, wall, dt=dt, t_end=1.0)
            continue
        with pytest.raises(ct.InputError, match=r"dt: found a travel time 2 L/c of 10 steps, expected a whole number"):
            ct.reference.impact_by_characteristics(rod, wall, dt=dt, t_end=1.0)
    assert ct.reference.lcm_step(ROD, ct.Rod(length=1.0, area=0.5, E=8.0, rho=2.0), cells=4) == 0.125


def test_a_mass_thrown_at_a_rod_that_never_answers_is_braked_exponentially():
    """m v' = -Z v: the trapezoidal rule's own quotient in every step, the gap closed, the rod's end as fast."""
    mass = ct.PointMass(mass=0.8, x=-0.3, velocity=1.5)
    long = ct.Rod(length=30.0, area=0.5, E=8.0, rho=2.0)
    found = ct.reference.impact_by_characteristics(mass, long, dt=0.1, t_end=2.0)
    np.testing.assert_allclose(found.gap[:3], [0.3, 0.15, 0.0], atol=1e-15)
    assert found.force[:2].tolist() == [0.0, 0.0]
    decay = (1.0 - 0.5 * 0.1 * 2.0 / 0.8) / (1.0 + 0.5 * 0.1 * 2.0 / 0.8)
    expected = 2.0 * 1.5 * decay ** np.arange(19)
    np.testing.assert_allclose(found.force[2:], expected, rtol=1e-12)
    np.testing.assert_allclose(found.left[2:], expected / 2.0, rtol=1e-12)
    np.testing.assert_allclose(found.right[2:], expected / 2.0, rtol=1e-12)
    assert np.abs(found.gap[2:]).max() < 1e-15
    assert found.impulse == pytest.approx(0.8 * (1.5 - found.left[-1]), rel=1e-12)
