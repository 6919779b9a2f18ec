"""Skips over contact-free time: the same end as without, to the round-off of the steps."""

import numpy as np
import pytest
from scipy.linalg import expm

import contact as ct
from contact.loop.rub.free_flight import FOREVER, WAIT, largest_share, open_steps, propagate
from contact.model.gaps.rub import rub_of
from contact.model.gaps.rub_system import rub_system
from contact.model.trig import fourier
from contact.scheme.modal.free_flight import BITS, CELLS, free_flight, least_clearance, powers
from contact.scheme.modal.propagator import propagator
from tests.contact.synthetic_rim import blade, ring

pytestmark = pytest.mark.slow  # whichever comes first compiles the loop

DT = 2e-5
SPARSE = ct.Record(every=500, state_every=1000)


def lobed(*, clearance=2e-4, zeta=0.01, imperfect=0.0, speed_hz=20.0, **more):
    """Two lobes reach .05 mm into the blade's circle, twice a turn."""
    return ct.RotatingRim(
        ring(S=4e-7, zeta=zeta, imperfect=imperfect), blade(S=1e-6, zeta=zeta), clearance=clearance, speed_hz=speed_hz,
        lean_deg=25.0, out_of_roundness=[{"p": 2, "cos": 2.5e-4}], angle_deg=45.0, **more,
    )  # fmt: skip


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.6])
def test_a_step_is_the_exponential_of_its_matrix(zeta):
    """Under a load, from (q, v): where it goes, how it came, its speed on arrival and its energies."""
    h, omega, load, start = 0.2, 3.0, 0.7, np.array([0.4, -0.9])
    rest = np.array([load / omega**2, 0.0])
    A = np.array([[0.0, 1.0], [-(omega**2), -2.0 * zeta * omega]])
    before, after = (rest + expm(t * A) @ (start - rest) for t in (-h, h))
    p = propagator(np.array([omega]), np.array([zeta]), np.array([load]), h)
    d = p.backward(start[:1], start[1:])
    assert d[0] == pytest.approx(start[0] - before[0], rel=1e-12)
    q = start[0] + p.al * d - p.be * start[0] + p.c * load
    assert q[0] == pytest.approx(after[0], rel=1e-12)
    assert p.velocity(q, q - start[0], p.load)[0] == pytest.approx(after[1], rel=1e-12)
    stored = p.stored(q, q - start[0], np.zeros(1), 0.25, 0.125)
    assert stored.kinetic == pytest.approx(0.5 * after[1] ** 2, rel=1e-12)
    assert stored.strain == pytest.approx(0.5 * (omega * after[0]) ** 2, rel=1e-12)
    assert stored.potential == pytest.approx(0.125 - load * after[0], rel=1e-12)
    assert stored.residual == 0.25
    energy = 0.5 * (q[0] - start[0]) ** 2 / p.c[0] + 0.5 * omega**2 * start[0] * q[0] - 0.5 * load * (start[0] + q[0])
    assert stored.discrete == pytest.approx(0.125 + energy, rel=1e-12)


def test_a_rigid_mode_falls():
    h, load, q, v = 0.3, -2.0, 0.5, 0.7
    p = propagator(np.zeros(1), np.zeros(1), np.array([load]), h)
    d = p.backward(np.array([q]), np.array([v]))
    assert d[0] == pytest.approx(v * h - 0.5 * load * h**2, rel=1e-14)
    d = p.al * d - p.be * q + p.c * load
    assert d[0] == pytest.approx(v * h + 0.5 * load * h**2, rel=1e-14)
    assert p.velocity(q + d, d, p.load)[0] == pytest.approx(v + load * h, rel=1e-14)


def pair(scene, t_end=0.2, **settings):
    return [
        ct.run(scene, t_end=t_end, dt=DT, scheme=ct.ExactModal(skip=skip), record=SPARSE, **settings)
        for skip in (True, False)
    ]


def test_powers_are_repeated_steps():
    al, be = np.array([1.0, 0.98, 0.9999]), np.array([0.0, 0.3, 2e-4])
    found = powers(al, be)
    assert found.shape == (BITS, 4, 3)
    q, d = np.array([1.0, -2.0, 0.5]), np.array([0.1, 0.2, -0.3])
    x, y = q.copy(), d.copy()
    for _ in range(1000):
        y = al * y - be * x
        x = x + y
    propagate(q, d, found, 1000)
    assert np.allclose(q, x, rtol=1e-12, atol=1e-13)
    assert np.allclose(d, y, rtol=1e-12, atol=1e-13)


def test_the_floor_lies_below_the_clearance_and_close_to_it():
    terms = fourier([(0, 1.0, 0.0), (7, 0.3, -0.2), (20, 0.0, 0.05)])
    floor = least_clearance(terms)
    angle = 2.0 * np.pi * (np.arange(CELLS * 50) + 0.5) / (CELLS * 50)
    least = np.array([terms(a) for a in angle]).reshape(CELLS, 50).min(axis=1)
    assert np.all(floor <= least)
    assert np.max(least - floor) < 2e-3


def test_open_steps_count_what_the_cells_allow():
    floor = np.where(np.arange(8) < 4, 2.0, 0.0)  # open in the first half turn
    eighth = 2.0 * np.pi / 8.0
    assert open_steps(floor, 1.0, 0.25 * eighth, 0.5 * eighth) == 8  # at .25, .75, .. 3.75 of an eighth
    assert open_steps(floor, 1.0, 0.25 * eighth, -0.5 * eighth) == 1
    assert open_steps(floor, 1.0, -3.75 * eighth, 0.5 * eighth) == -8 - 1  # the second half turn
    assert open_steps(floor, 3.0, 0.0, 0.5 * eighth) == -WAIT
    assert open_steps(floor, -1.0, 0.0, 0.5 * eighth) == FOREVER
    assert open_steps(floor, 1.0, 0.1, 0.0) == FOREVER
    assert open_steps(floor, 1.0, -0.1, 0.0) == -WAIT
    assert open_steps(floor, np.nan, 0.1, 0.1) == -WAIT


@pytest.mark.parametrize("imperfect", [0.0, 0.05])
def test_no_angle_and_no_time_sees_more_than_the_largest_share(imperfect):
    rub = rub_of(lobed(imperfect=imperfect))
    system = rub_system(rub, 2)
    parts = propagator(system.omega, system.zeta, system.load, DT)
    rng = np.random.default_rng(11)
    flight = free_flight(rub, system, parts, skip=True)
    q, d = rng.standard_normal((2, system.omega.size)) * 1e-4
    d *= system.omega * DT
    bound = largest_share(flight, q, d)
    worst = 0.0
    for phi in rng.uniform(0.0, 2.0 * np.pi, 400):
        worst = max(worst, abs(system.rim.rows(0, phi) @ q[:10] + system.blade_rows[0] @ q[10:]))
        propagate(q, d, flight.powers, 7)
    assert 0.2 * bound < worst < bound


@pytest.mark.parametrize(("imperfect", "mu"), [(0.0, 0.0), (0.05, 0.2)])
def test_the_same_run_with_and_without_leaps(imperfect, mu):
    leaping, plain = pair(lobed(imperfect=imperfect), law=ct.Coulomb(mu=mu) if mu else ct.Unilateral())
    assert 0.02 < plain.contact_steps[0] / plain.steps < 0.5
    assert len(plain.merged_intervals()[0]) >= 7
    scale = np.abs(plain.state).max()
    assert np.abs(leaping.state - plain.state).max() <= 1e-11 * scale
    assert np.allclose(leaping.gap, plain.gap, rtol=0.0, atol=1e-12 * np.abs(plain.gap).max() * 10)
    assert np.array_equal(leaping.time, plain.time)
    assert np.array_equal(leaping.contact_steps, plain.contact_steps)
    assert leaping.impulse[0] == pytest.approx(plain.impulse[0], rel=1e-11)
    assert np.allclose(leaping.intervals[0], plain.intervals[0], rtol=0.0, atol=1e-10 * DT * plain.steps)
    for name in ("contact", "rotation", "friction", "damping"):
        assert getattr(leaping.energy, name) == pytest.approx(getattr(plain.energy, name), rel=1e-9, abs=1e-15)
    assert abs(leaping.energy.unaccounted) <= 1e-11 * leaping.energy.scale


def test_leaps_are_taken_and_none_when_every_step_is_stored():
    from contact.record.record import samples
    from contact.scheme.modal.exact_modal import ExactModal

    for record, few in ((SPARSE, True), (ct.Record(), False)):
        stepper = ExactModal().prepare(lobed(), ct.Unilateral(), dt=DT, courant=None)
        stepper.advance(samples(record, 5000, 1, stepper.size), 0, 5000)
        taken, over = stepper.flight.taken
        assert (over > 2000) == few
        assert (taken > 3) == few


def test_a_blade_out_of_reach_leaps_all_the_way():
    far = lobed(clearance=0.03, zeta=0.0, blade_velocity=[0.3, -0.2], casing_velocity=np.linspace(0.1, 1.0, 10))
    leaping, plain = pair(far, t_end=1.0)
    assert np.abs(leaping.state - plain.state).max() <= 1e-10 * np.abs(plain.state).max()
    assert leaping.energy.end.total == pytest.approx(leaping.energy.start.total, rel=1e-9)
    assert leaping.steps == 50_000


def test_a_blade_out_of_reach_leaps_from_one_stored_step_to_the_next():
    from contact.record.record import samples
    from contact.scheme.modal.exact_modal import ExactModal

    stepper = ExactModal().prepare(lobed(clearance=0.03), ct.Unilateral(), dt=DT, courant=None)
    stepper.advance(samples(SPARSE, 5000, 1, stepper.size), 0, 5000)
    taken, over = stepper.flight.taken
    assert taken == 10  # one step is taken plainly where a sample is stored
    assert over == 5000 - 10
