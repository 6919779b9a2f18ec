"""Windows of a run and the growth over them: partitions, exact exponentials, pieces, scales, drawn noise."""

import numpy as np
import pytest
from scipy.stats import t as student

from contact.stability.envelope import envelope, growth_of, slope_of, window_bounds

TIME = np.linspace(0.0, 1.0, 32)


@pytest.mark.parametrize("count", [32, 47, 320, 1000, 4096])
@pytest.mark.parametrize("period", [0.0, 3e-3, 0.03, 10.0])
@pytest.mark.parametrize("turn", [np.inf, 4e-3, 0.05, 3.0])
def test_windows_cut_a_run_into_equal_parts_up_to_its_end(count, period, turn):
    bounds, step = window_bounds(count, 1e-3, period, turn), 1e-3
    sizes = np.diff(bounds)
    assert bounds[-1] == count
    assert 0 <= bounds[0] < max(sizes.max(), 1)
    assert np.ptp(sizes) <= 1
    assert 8 <= sizes.size <= 32
    assert sizes.min() >= 4
    length = (bounds[-1] - bounds[0]) * step / sizes.size
    if sizes.size > 8:
        assert length >= 2.0 * period - step
    if np.isfinite(turn):  # whole revolutions, where eight windows of them have room
        whole = length / turn == pytest.approx(round(length / turn), abs=step / turn)
        assert whole or 8.0 * turn * np.ceil((length - step) / turn) > count * step


def test_too_few_states_have_no_windows():
    assert window_bounds(31, 1e-3, 0.0, np.inf).size == 0
    assert window_bounds(32, 1e-3, 0.0, np.inf).tolist() == list(range(0, 33, 4))
    t = np.linspace(0.0, 1.0, 33)
    assert envelope(t, np.cos(50.0 * t)[:, None], np.array([50.0]), np.zeros(1, int)) is None


@pytest.mark.parametrize("rate", [-7.0, 0.0, 3.0])
def test_an_exponential_has_its_rate_whatever_its_scale_and_the_zero_of_time(rate):
    assert growth_of(TIME, np.exp(2.0 * rate * TIME)).rate == pytest.approx(rate, abs=1e-9)
    energy = np.exp(2.0 * rate * TIME + 0.1 * np.random.default_rng(1).standard_normal(32))
    one = growth_of(TIME, energy)
    assert one.rate == pytest.approx(rate, abs=0.1)
    assert one.first == 0
    assert one.low < rate < one.high
    for other in (growth_of(TIME, 1e-12 * energy), growth_of(TIME + 50.0, energy)):
        assert (other.rate, other.low, other.high, other.scatter) == pytest.approx(
            (one.rate, one.low, one.high, one.scatter), abs=1e-8
        )
    slow = growth_of(4.0 * TIME, energy)
    assert (slow.rate, slow.low, slow.high) == pytest.approx((one.rate / 4, one.low / 4, one.high / 4), abs=1e-9)


@pytest.mark.parametrize("corner", [10, 16, 22])
def test_growth_is_that_of_the_last_straight_piece(corner):
    y = np.where(np.arange(32) < corner, 5.0 * (TIME - TIME[corner]), -8.0 * (TIME - TIME[corner]))
    found = growth_of(TIME, np.exp(2.0 * y))
    assert abs(found.first - corner) <= 1
    assert found.rate == pytest.approx(-8.0, abs=1e-6)
    two = np.interp(np.arange(32), [0, 10, 20, 31], [0.0, 3.0, 3.0, 1.0])
    last = growth_of(TIME, np.exp(2.0 * two))
    assert last.first in (19, 20, 21)
    assert last.rate == pytest.approx(-2.0 / (TIME[31] - TIME[20]), rel=1e-6)


def test_windows_before_the_motion_begins_are_left_out():
    energy = np.exp(6.0 * TIME)
    energy[:9] = 0.0
    found = growth_of(TIME, energy)
    assert (found.first, found.rate) == (9, pytest.approx(3.0))
    energy[9:] *= 1e30
    assert growth_of(TIME, energy).first == 9
    still = np.zeros(32)
    still[-5:] = 1.0
    assert growth_of(TIME, still) is None
    still[-6:] = np.exp(TIME[-6:])
    assert growth_of(TIME, still).rate == pytest.approx(0.5)
    assert growth_of(TIME, np.where(np.arange(32) < 4, np.nan, np.exp(6.0 * TIME))).first == 4


def test_slopes_have_the_interval_of_a_line_where_windows_are_independent():
    """Student's interval, by least squares; residuals that alternate have no positive autocorrelation."""
    x = np.arange(20.0)
    y = 0.3 * x + 0.1 * (-1.0) ** x
    rate, low, high = slope_of(x, y)
    A = np.column_stack([np.ones(20), x])
    beta, rss, *_ = np.linalg.lstsq(A, y, rcond=None)
    error = np.sqrt((rss[0] / 18.0 + 0.005**2) * np.linalg.inv(A.T @ A)[1, 1])
    assert rate == pytest.approx(beta[1])
    assert high - rate == pytest.approx(rate - low) == pytest.approx(student.ppf(0.975, 18) * error)


def test_intervals_contain_the_slope_of_drawn_windows():
    """Of 300 draws of independent noise 95 %, and of correlated noise most."""
    rng, x = np.random.default_rng(6), np.arange(32.0)
    for r, least in ((0.0, 0.92), (0.5, 0.78)):
        inside = 0
        for _ in range(300):
            noise = rng.standard_normal(32)
            for k in range(1, 32):
                noise[k] += r * noise[k - 1]
            _, low, high = slope_of(x, 0.02 * x + 0.1 * noise)
            inside += low < 0.02 < high
        assert least < inside / 300 < 0.99


@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_energy_of_a_free_motion_is_that_of_its_modes(step):
    """Coarse states have velocities of no use; there the energy is twice that of the displacement."""
    t, omega = np.arange(0.0, 4.0, step), np.array([300.0, 330.0, 700.0])
    amplitude = np.array([2e-3, 1e-3, 5e-4])
    q = amplitude * np.cos(omega * t[:, None] + [0.0, 1.0, 2.0]) + [0.1, 0.0, -0.2]
    found = envelope(t, q, omega, np.array([0, 0, 1]))
    exact = 0.5 * (omega * amplitude) ** 2
    np.testing.assert_allclose(found.energy.mean(axis=0), [exact[:2].sum(), exact[2]], rtol=0.06)
    assert found.time[0] == pytest.approx(0.5 * (found.start[0] + found.start[1]), abs=step)
    assert np.all(np.diff(found.time) > 0.0)
