"""Rods by central differences: B1, B2, B5 of the benchmark list, the energy ledger and the limits."""

import numpy as np
import pytest

import contact as ct

# 10 in, 1 in^2, 30e6 psi, 7.34e-4 lbf s^2/in^4
CARPENTER = {"length": 0.254, "area": 6.4516e-4, "E": 206.8427e9, "rho": 7844.181}
SPEED, GAP = 5.13588, 2.54e-4  # 202.2 in/s, 0.01 in
BAR = {"length": 10.0, "area": 1.0, "E": 900.0, "rho": 1.0, "x": 5.0}
MESHES = [(20, 0.06), (100, 0.016)]
COURANTS = [0.9, 0.5, 0.1]


def carpenter(elements, courant, **options):
    left = ct.Rod(**CARPENTER, elements=elements, x=-0.254254, velocity=SPEED)
    right = ct.Rod(**CARPENTER, elements=elements)
    return ct.run([left, right], t_end=2.5e-4, courant=courant, **options)


@pytest.mark.parametrize(("elements", "bound"), MESHES)
@pytest.mark.parametrize("courant", COURANTS)
def test_two_identical_rods(elements, bound, courant):
    result = carpenter(elements, courant)
    exact = ct.reference.two_rods(ct.Rod(**CARPENTER), gap=GAP, velocity=SPEED)
    (start, end), duration = result.intervals[0][0], exact.intervals[0, 1] - exact.intervals[0, 0]
    momentum = sum(motion.momentum for motion in result.motions)
    assert ct.reference.force_error(result.time, result.force[:, 0], result.dt, exact) <= bound
    assert result.max_penetration[0] <= 1e-12 * 0.254
    assert abs(momentum / (ct.Rod(**CARPENTER).mass * SPEED) - 1.0) <= 1e-12
    assert start == pytest.approx(4.9456e-5, rel=1e-4)
    assert len(result.intervals[0]) == 1
    if elements == 100:
        assert result.impulse[0] == pytest.approx(exact.impulse, rel=0.01)
        assert end - start == pytest.approx(duration, rel=0.01)
        assert abs(result.motions[0].mean_velocity) <= 0.01 * SPEED


def test_first_force_spike_is_reported_beside_the_windowed_force():
    spikes = [carpenter(100, courant) for courant in (0.9, 0.1)]
    raw = [result.peak_force[0] / 66732.0 for result in spikes]
    windowed = [result.windowed_force().max() / 66732.0 for result in spikes]
    assert raw[0] < 1.35
    assert 4.0 < raw[1] < 5.0
    assert max(windowed) < 1.05


@pytest.mark.parametrize(("elements", "bound"), MESHES)
@pytest.mark.parametrize("courant", COURANTS)
def test_rod_on_wall(elements, bound, courant):
    bar = ct.Rod(**BAR, elements=elements, velocity=-10.0)
    result = ct.run([bar, ct.Wall(x=0.0)], t_end=2.0, courant=courant)
    exact = ct.reference.rod_on_wall(bar, gap=5.0, velocity=10.0)
    assert ct.reference.force_error(result.time, result.force[:, 0], result.dt, exact) <= bound
    assert result.max_penetration[0] <= 1e-11
    assert result.motions[0].mean_velocity == pytest.approx(10.0, rel=0.05 if elements == 20 else 0.015)
    assert result.residual[0] <= 1e-12
    if elements == 100:
        assert result.impulse[0] == pytest.approx(200.0, rel=0.01)


def test_bouncing_bar_one_period():
    bar = ct.Rod(**BAR, elements=100)
    T = 16.0 / 3.0
    result = ct.run([bar, ct.Wall(x=0.0)], t_end=T, courant=0.9, gravity=10.0, record=ct.Record(state_every=1))
    history = ct.reference.bar_by_characteristics(bar, gravity=10.0, t_end=T, cells=300)
    gap = 5.0 + result.state[:, 1]  # node 0 is the wall
    assert np.abs(gap - np.interp(result.state_time, history.time, history.gap)).max() <= 0.03 * 5.0
    assert ct.reference.force_error(result.time, result.force[:, 0], result.dt, ct.reference.bouncing_bar(2)) <= 0.05
    assert result.impulse[0] == pytest.approx(2 * 266.667, rel=0.005)
    assert len(result.intervals[0]) == 2
    energy = result.energy
    assert energy.start.total == pytest.approx(1000.0, rel=1e-4)
    assert abs(energy.unaccounted) <= 1e-12 * energy.start.total
    assert 0.0 < energy.lost_in_contact <= 0.01 * 500.0


def test_point_mass_on_fixed_rod_st_venant():
    """B5, alpha = 1: force e^{-t} up to 2L/c, contact ends at 3.067668 L/c, rebound -.687619 V."""
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=400, fixed="right")
    result = ct.run([ct.PointMass(mass=1.0, velocity=1.0), rod], t_end=4.0, courant=0.9)
    early = (result.time > 0.2) & (result.time < 1.9)
    assert np.abs(result.force[early, 0] - np.exp(-result.time[early])).max() <= 0.01
    assert result.impulse[0] == pytest.approx(1.687619, rel=0.005)
    assert result.intervals[0][-1][1] == pytest.approx(3.067668, rel=0.005)
    assert result.motions[0].kind == "mass"
    assert result.motions[0].mean_velocity == pytest.approx(-0.687619, rel=0.005)


def test_three_rods_pass_the_momentum_on():
    rods = [ct.Rod(**CARPENTER, elements=50, x=x) for x in (0.0, 0.254254, 0.508508)]
    rods[0] = ct.Rod(**CARPENTER, elements=50, x=0.0, velocity=SPEED)
    result = ct.run(rods, t_end=6e-4, courant=0.9)
    assert result.force.shape[1] == 2
    assert [round(m.mean_velocity / SPEED, 1) for m in result.motions] == [0.0, 0.0, 1.0]
    assert abs(result.energy.unaccounted) <= 1e-12 * result.energy.start.total


def test_order_of_the_bodies_is_the_users():
    result = ct.run([ct.Wall(x=0.0), ct.Rod(**BAR, velocity=-10.0)], t_end=2.0, courant=0.9)
    mirrored = ct.Rod(**{**BAR, "x": -15.0}, velocity=10.0)
    other = ct.run([mirrored, ct.Wall(x=0.0)], t_end=2.0, courant=0.9)
    assert other.impulse[0] == pytest.approx(result.impulse[0], rel=1e-12)
    assert [m.number for m in result.motions] == [1]


def test_penalty_error_does_not_fall_with_the_mesh():
    errors = []
    exact = ct.reference.two_rods(ct.Rod(**CARPENTER), gap=GAP, velocity=SPEED)
    for elements in (20, 100):
        result = carpenter(elements, 0.5, law=ct.Penalty(stiffness=3.5e8))
        errors.append(ct.reference.force_error(result.time, result.force[:, 0], result.dt, exact))
        assert result.max_penetration[0] > 2.5e-5
        assert abs(result.energy.unaccounted) <= 1e-12 * result.energy.start.total
    assert errors[1] > 0.7 * errors[0] > 0.02


def test_steps_beyond_the_limit_are_refused_with_numbers():
    with pytest.raises(ct.LimitError, match=r"dt \* omega_max = 2.2, expected <= 2 .*use dt <="):
        carpenter(20, 1.1)
    with pytest.raises(ct.LimitError, match="stability"):
        carpenter(20, 0.9, law=ct.Penalty(stiffness=2e11))


@pytest.mark.parametrize(
    ("bodies", "message"),
    [
        ([ct.Rod(**BAR)], "expected at least two"),
        ([ct.Rod(**BAR), ct.Rod(**{**BAR, "x": 14.0})], "overlap by 1 m"),
        ([ct.Rod(**{**BAR, "x": -2.0}), ct.Wall(x=0.0)], "overlap"),
        ([ct.Wall(x=0.0), ct.Wall(x=1.0)], "fixed ends on both sides"),
        ([ct.Rod(**BAR, fixed="left"), ct.Wall(x=5.0), ct.PointMass(mass=1.0, x=20.0)], "fixed ends on both sides"),
    ],
)
def test_scenes_that_cannot_be(bodies, message):
    with pytest.raises(ct.InputError, match=message):
        ct.run(bodies, t_end=1.0, dt=0.001)


@pytest.mark.parametrize(
    ("field", "value"),
    [("area", -1.0), ("length", 0.0), ("E", float("nan")), ("elements", 0), ("fixed", "middle")],
)
def test_rods_that_cannot_be(field, value):
    with pytest.raises(ct.InputError, match=f"^{field}: found"):
        ct.Rod(**{**BAR, field: value})


def test_options_that_do_not_fit():
    pair = [ct.Rod(**BAR), ct.Wall(x=0.0)]
    with pytest.raises(ct.InputError, match="t_end"):
        ct.run(pair, t_end=0.0, courant=0.9)
    with pytest.raises(ct.InputError, match="both or neither"):
        ct.run(pair, t_end=1.0)
    with pytest.raises(ct.InputError, match="Coulomb"):
        ct.run(pair, t_end=1.0, courant=0.9, law=ct.Coulomb(mu=0.3))


@pytest.mark.parametrize("ratio", [1e-8, 1.0, 1e8])
@pytest.mark.parametrize("gap", [0.0, 1e-12])
def test_extreme_masses_and_gaps_stay_finite(ratio, gap):
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=50, x=gap, fixed="right")
    result = ct.run([ct.PointMass(mass=ratio, velocity=1.0), rod], t_end=2.0, courant=0.9)
    assert np.isfinite(result.force).all()
    assert result.max_penetration[0] <= 1e-12
    assert result.residual[0] <= 1e-12
    assert abs(result.energy.unaccounted) <= 1e-9 * result.energy.scale


def test_resting_contact_stays_at_rest():
    """Dropped from zero height: the force settles around the weight, nothing creeps in over 2e5 steps."""
    bar = ct.Rod(**{**BAR, "x": 0.0}, elements=10)
    result = ct.run([bar, ct.Wall(x=0.0)], t_end=6000.0, courant=0.9, gravity=10.0, record=ct.Record(every=10))
    assert result.steps > 190_000
    assert result.impulse[0] / 6000.0 == pytest.approx(100.0, rel=1e-3)
    assert result.max_penetration[0] <= 1e-12
    assert abs(result.energy.unaccounted) <= 1e-9 * result.energy.start.total
