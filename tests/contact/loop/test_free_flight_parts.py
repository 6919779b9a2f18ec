"""What skips a rim's free flight, and a turn of a rim in closed contact, against loops and whole matrices."""

import math

import numpy as np
import pytest

from tests.contact.plain import names

FLIGHT = names("loop.rub.free_flight")


@pytest.mark.parametrize("turn", [0.013, -0.013, 0.11, -0.11])
def test_steps_over_cells_that_are_surely_open_are_counted(turn):
    rng = np.random.default_rng(4)
    for _ in range(12):
        floor, phi = rng.uniform(0.0, 1.0, 9), rng.uniform(-9.0, 9.0)
        found = FLIGHT.open_steps(floor, 0.35, phi, turn)

        def is_open(k, phi=phi, floor=floor):
            place = (phi + k * turn) / (2.0 * math.pi)
            return floor[int((place - math.floor(place)) * 9)] > 0.35

        here = is_open(0)
        run = next((k for k in range(1, 2000) if is_open(k) != here), None)
        assert run is not None
        if here:
            assert found == run
        else:
            assert found in (-run, -(run + 1))


def test_where_all_or_nothing_is_open_it_is_for_ever_or_to_be_looked_at_again():
    floor = np.full(6, 0.5)
    for turn in (0.0, 0.1, -0.1):
        assert FLIGHT.open_steps(floor, 0.4, 1.0, turn) == FLIGHT.FOREVER
        assert FLIGHT.open_steps(floor, 0.5, 1.0, turn) == -FLIGHT.WAIT
    slow = np.array([0.5, 0.1, 0.1, 0.1, 0.1, 0.1])
    assert FLIGHT.open_steps(slow, 0.4, 1.1, 1e-5) == -FLIGHT.WAIT  # it would be a long time


def free(steps, q, d, al, be):
    for _ in range(steps):
        d = al * d - be * q
        q = q + d
    return q, d


def test_an_amplitude_bounds_what_a_mode_does_without_force_and_is_reached():
    h, omega, zeta = 0.05, 7.0, 0.01
    fade, turn = math.exp(-zeta * omega * h), omega * math.sqrt(1.0 - zeta**2) * h
    al, be = fade**2, 1.0 - 2.0 * fade * math.cos(turn) + fade**2
    q, d = 0.3, -0.2
    bound = FLIGHT.amplitude(q, d, fade, math.cos(turn), math.sin(turn))
    seen = [free(n, q, d, al, be)[0] for n in range(60)]
    assert np.abs(seen).max() <= bound
    still = FLIGHT.amplitude(q, d, 1.0, math.cos(turn), math.sin(turn))
    seen = [free(n, q, d, 1.0, 2.0 - 2.0 * math.cos(turn))[0] for n in range(600)]
    assert still == pytest.approx(np.abs(seen).max(), rel=1e-3)
    assert FLIGHT.amplitude(-0.3, 0.0, 1.0, 1.0, 0.0) == 0.3
    assert FLIGHT.amplitude(-0.3, 0.1, 1.0, 1.0, 0.0) == math.inf


def flight(m=2, bits=4):
    """Two undamped modes with waves 0, 1 and 2, 3; maps over 1, 2, 4, 8 steps."""
    al, be = np.ones(m), np.array([0.02, 0.05])
    step = np.array([[1.0 - be, al], [-be, al]])  # q, d -> q + d, d
    powers = np.zeros((bits, 4, m))
    for i in range(m):
        one = step[:, :, i]
        for b in range(bits):
            powers[b, :, i] = np.linalg.matrix_power(one, 2**b).ravel()
    turn = np.arccos(1.0 - be / 2.0)
    return al, be, FLIGHT.FreeFlight(
        powers=powers, fade=np.ones(m), cos=np.cos(turn), sin=np.sin(turn), start=np.array([0, 2, 4]),
        wave=np.array([0, 2, 2, 3]), row=np.array([0.5, -1.5, 2.0, 0.7]), floor=np.full(5, 9.0), reach=np.zeros(4),
        taken=np.zeros(2, dtype=int),
    )  # fmt: skip


def test_the_largest_share_adds_amplitudes_by_wave():
    _, _, f = flight()
    q, d = np.array([0.1, -0.2]), np.array([0.01, 0.03])
    a, b = (FLIGHT.amplitude(q[i], d[i], 1.0, f.cos[i], f.sin[i]) for i in (0, 1))
    assert FLIGHT.largest_share(f, q, d) == pytest.approx(0.5 * a + math.hypot(1.5 * a + 2.0 * b, 0.7 * b), rel=1e-13)


@pytest.mark.parametrize(("room", "taken"), [(99, 15), (11, 11), (6, 6)])
def test_a_skip_goes_as_far_as_there_is_room_and_powers(room, taken):
    al, be, f = flight()
    q, d = np.array([0.1, -0.2]), np.array([0.01, 0.03])
    exact = free(taken, q, d, al, be)
    assert FLIGHT.skip_free_flight(f, q, d, 0.3, 0.1, room) == taken
    np.testing.assert_allclose([q, d], exact, rtol=1e-12)
    assert f.taken.tolist() == [1, taken]


def test_a_skip_that_would_be_short_waits_and_one_into_contact_too():
    _, _, f = flight()
    q, d = np.array([0.1, -0.2]), np.array([0.01, 0.03])
    assert FLIGHT.skip_free_flight(f, q, d, 0.3, 0.1, 5) == -6
    f.floor[:] = 1e-3
    assert FLIGHT.skip_free_flight(f, q, d, 0.3, 0.1, 99) == -FLIGHT.WAIT
    assert f.taken.tolist() == [0, 0]


def test_the_discrete_energy_is_kept_without_damping_and_is_that_of_both_gaps():
    al, be, _ = flight()
    q, d, c = np.array([0.1, -0.2]), np.array([0.01, 0.03]), np.array([2e-3, 3e-3])
    exact = sum(0.5 * d[i] ** 2 / c[i] + 0.5 * be[i] / c[i] * (q[i] - d[i]) * q[i] for i in (0, 1))
    assert FLIGHT.discrete_energy(q, d, be, c) == pytest.approx(exact, rel=1e-14)
    assert FLIGHT.discrete_energy(*free(9, q, d, al, be), be, c) == pytest.approx(exact, rel=1e-12)
