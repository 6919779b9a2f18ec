"""The references checked against each other."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contact as ct

CARPENTER = {"length": 0.254, "area": 6.4516e-4, "E": 206.8427e9, "rho": 7844.181}  # 10 in, 30e6 psi
BAR = {"length": 10.0, "area": 1.0, "E": 900.0, "rho": 1.0, "x": 5.0}


def test_two_rods_published_values():
    exact = ct.reference.two_rods(ct.Rod(**CARPENTER), gap=2.54e-4, velocity=5.13588)
    assert exact.intervals[0, 0] == pytest.approx(4.9456e-5, rel=1e-5)
    assert exact.intervals[0, 1] - exact.intervals[0, 0] == pytest.approx(9.8928e-5, rel=1e-5)
    assert exact.force[0, 0] == pytest.approx(66732.0, rel=1e-4)


def test_characteristics_give_the_closed_forms():
    drop = ct.reference.bar_by_characteristics(ct.Rod(**BAR), gravity=10.0, t_end=160.0 / 3.0, cells=30)
    middle = 0.5 * (drop.time[1:] + drop.time[:-1])
    assert np.abs(drop.force - ct.reference.bouncing_bar(20)(middle)).max() <= 1e-9 * 500.0
    assert drop.gap[-1] == pytest.approx(5.0, abs=1e-9)
    shot = ct.Rod(**BAR, velocity=-10.0)
    history = ct.reference.bar_by_characteristics(shot, gravity=0.0, t_end=2.0, cells=60)
    middle = 0.5 * (history.time[1:] + history.time[:-1])
    assert np.abs(history.force - ct.reference.rod_on_wall(shot, gap=5.0, velocity=10.0)(middle)).max() <= 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(("length", "x"), [(10.0, 20.0), (0.01, 100.0)])
def test_a_bar_touches_its_wall_within_a_thousand_millionth_of_the_lengths(length, x):
    """So that round-off of the gap, after any number of steps, neither delays a contact nor makes one."""
    bar = {"length": length, "area": 1.0, "E": 900.0, "rho": 1.0}
    for gap, touches in ((0.9e-9, True), (1.1e-9, False)):
        slow = ct.Rod(**bar, x=gap * length, velocity=-1e-12)
        history = ct.reference.bar_by_characteristics(slow, gravity=0.0, t_end=length / 30.0, cells=1)
        assert (history.force[0] > 0.0) == touches
    fast = ct.Rod(**bar, x=x, velocity=-30.0)  # as fast as its waves: the gap shrinks by whole cells
    history = ct.reference.bar_by_characteristics(fast, gravity=0.0, t_end=1.1 * x / 30.0, cells=7)
    assert history.time[np.flatnonzero(history.force)[0]] == pytest.approx(x / 30.0, rel=1e-9)


def test_st_venant_by_characteristics():
    """B5: force 2.135335 after one round trip, contact ends at 3.067668 L/c, rebound -.687619 V; second order."""
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="right")
    errors = []
    for n in (50, 100, 200):
        impact = ct.reference.impact_by_characteristics(
            ct.PointMass(mass=1.0, velocity=1.0), rod, dt=1.0 / n, t_end=4.0
        )
        errors.append(abs(impact.force[2 * n] - (2.0 + np.exp(-2.0))))
        assert impact.intervals[0, 1] == pytest.approx(3.067668, abs=1.0 / n)
        assert impact.left[-1] == pytest.approx(-0.687619, abs=2e-4)
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.1)


def test_characteristics_of_two_bodies_give_the_closed_forms():
    left = ct.Rod(**CARPENTER, x=-0.254, velocity=5.13588)
    right = ct.Rod(**CARPENTER)
    impact = ct.reference.impact_by_characteristics(
        left, right, dt=ct.reference.lcm_step(left, right, cells=20), t_end=1.5e-4
    )
    assert impact.force[0] == pytest.approx(66732.0, rel=1e-4)
    assert impact.impulse == pytest.approx(ct.reference.two_rods(right, gap=0.0, velocity=5.13588).impulse, rel=1e-12)
    assert [impact.left[-1], impact.right[-1]] == pytest.approx([0.0, 5.13588], abs=1e-9)
    bar = ct.Rod(**BAR, velocity=-10.0)
    wall = ct.reference.impact_by_characteristics(ct.Wall(), bar, dt=1.0 / 60.0, t_end=2.0)
    assert wall.intervals[0] == pytest.approx([0.5, 7.0 / 6.0])
    assert (wall.force.max(), wall.right[-1]) == pytest.approx((300.0, 10.0))


def test_unequal_rods_make_a_staircase():
    """Impedances 4 and 1: F = .8 (.6)^k in the k-th round trip of the short rod, while the long one is silent."""
    short = ct.Rod(length=1.0, area=4.0, E=1.0, rho=1.0, x=-1.0, velocity=1.0)
    long = ct.Rod(length=8.0, area=1.0, E=1.0, rho=1.0)
    impact = ct.reference.impact_by_characteristics(short, long, dt=0.05, t_end=20.0)
    steps = 0.8 * 0.6 ** np.arange(8)
    assert impact.force[20:320:40] == pytest.approx(steps, rel=1e-12)
    assert impact.intervals[0] == pytest.approx([0.0, 16.0])
    assert impact.impulse == pytest.approx(2.0 * steps.sum(), rel=1e-12)


def test_a_bar_thrown_to_its_stop_grazes_it():
    bar = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="left", velocity=1.0)
    graze = ct.reference.impact_by_characteristics(bar, ct.Wall(x=2.0), dt=0.05, t_end=12.0)
    assert graze.force.max() == 0.0
    assert [graze.gap.min(), graze.gap.max()] == pytest.approx([0.0, 2.0], abs=1e-12)
    hit = ct.reference.impact_by_characteristics(bar, ct.Wall(x=1.5), dt=0.05, t_end=2.0)
    assert hit.intervals[0] == pytest.approx([0.5, 1.0])  # until the release wave of the fixed end arrives
    assert hit.impulse == pytest.approx(0.5)


def test_rods_of_odd_lengths_are_refused():
    rods = [ct.Rod(length=x, area=1.0, E=1.0, rho=1.0, x=y) for x, y in ((1.0, -1.0), (1.03, 0.0))]
    with pytest.raises(ct.InputError, match="whole number"):
        ct.reference.impact_by_characteristics(*rods, dt=0.1, t_end=1.0)


@pytest.mark.parametrize(("omega", "gap", "e"), [(2.0, 0.05, 0.5), (2.7, 0.0, 0.8), (2.7, 0.1, 0.8)])
def test_the_driven_orbit_closes_on_itself(omega, gap, e):
    orbit = ct.reference.driven_orbit(omega=1.0, drive=1.0, drive_omega=omega, gap=gap, restitution=e)
    whole = solve_ivp(
        lambda t, y: [y[1], np.cos(omega * t + orbit.phase) - y[0]], (0.0, orbit.period), [gap, -e * orbit.speed],
        rtol=1e-11, atol=1e-12,
    )  # fmt: skip
    assert whole.y[:, -1] == pytest.approx([gap, orbit.speed], abs=1e-9)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"gap": np.nan}, "gap: found nan, expected a finite number"),
        ({"restitution": 1.5}, "restitution: found 1.5, expected between 0 and 1"),
        ({"restitution": -1.5}, "restitution: found -1.5, expected between 0 and 1"),
        ({"restitution": np.nan}, "restitution: found nan, expected between 0 and 1"),
        ({"drive_omega": 1.0}, "drive_omega: found 1 rad/s with cycles = 1, expected a period that is not a multiple"),
        ({"drive_omega": 2.0, "cycles": 2}, "drive_omega: found 2 rad/s with cycles = 2, expected a period that is no"),
        (
            {"drive_omega": 2.0, "restitution": 1.0},
            "restitution: found 1 at drive_omega = 2 rad/s, expected a lower value",
        ),
        ({"cycles": 1.5}, "cycles: found 1.5, expected a whole number >= 1"),
        ({"gap": 10.0}, "drive: found 1 m/s"),
    ],
)
def test_what_has_no_driven_orbit_is_refused(given, words):
    with pytest.raises(ct.InputError, match=words):
        ct.reference.driven_orbit(
            **({"omega": 1.0, "drive": 1.0, "drive_omega": 2.7, "gap": 0.0, "restitution": 0.8} | given)
        )


@pytest.mark.parametrize("contacts", [0, 1.5, np.nan])
def test_a_bar_bounces_a_whole_number_of_times(contacts):
    with pytest.raises(ct.InputError, match=f"contacts: found {contacts}, expected a whole number >= 1"):
        ct.reference.bouncing_bar(contacts)


def test_ball_and_oscillator():
    ball = ct.reference.Bounces(height=1.0, gravity=9.81, restitution=0.8)
    assert (ball.instant(1), ball.instant(200)) == pytest.approx((ball.first, ball.rest))
    high = ct.reference.Bounces(height=5.0, gravity=10.0, restitution=0.5)  # falls for a second, arrives with 10 m/s
    assert (high.first, high.rest, high.rebound(1)) == pytest.approx((1.0, 3.0, 5.0))
    assert ct.reference.stopped_period(1.0, 1.0, 2.0) == pytest.approx(np.pi + 2 * np.arcsin(0.5))
    with pytest.raises(ct.InputError, match="a gap below the amplitude"):
        ct.reference.stopped_period(1.0, 3.0, 2.0)


def test_an_instant_has_the_mean_force_of_its_step():
    left, right = (ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, x=x, velocity=v) for x, v in ((-1.1, 1.0), (0.0, 0.0)))
    impact = ct.reference.impact_by_characteristics(left, right, dt=0.05, t_end=3.0)
    steps = np.arange(impact.step_force.size)
    for part in (0.0, 0.3, 0.9):
        np.testing.assert_array_equal(impact((steps + part) * 0.05), impact.step_force)
    assert impact(np.array([-0.01, 3.01])).tolist() == [0.0, 0.0]
    assert np.unique(impact.step_force).size > 1
