"""Windows of a run and the growth over them: partitions, exact exponentials, pieces, scales, drawn noise."""

import numpy as np
import pytest
from scipy.stats import t as student

import contact as ct

TIME = np.linspace(0.0, 1.0, 32)


def bounds_of(count, step, period, turn):
    """First of `count` inner instants of each window of a vibration with this period, and the end."""
    time = step * np.arange(count + 2)
    omega = 2.0 * np.pi / period if period else 0.0
    found = ct.stability.envelope(time, np.sin(omega * time)[:, None], np.array([omega]), np.zeros(1, int), turn)
    first = np.rint(found.start / step).astype(int) - 1
    end = round(2.0 * found.time[-1] / step - first[-1] - 1)
    return np.append(first, end)


@pytest.mark.parametrize("count", [32, 47, 320, 1000, 4096])
@pytest.mark.parametrize("period", [0.0, 3e-3, 0.03, 10.0])
@pytest.mark.parametrize("turn", [np.inf, 4e-3, 0.05, 3.0])
def test_windows_cut_a_run_into_equal_parts_up_to_its_end(count, period, turn):
    bounds, step = bounds_of(count, 1e-3, period, turn), 1e-3
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
    assert bounds_of(32, 1e-3, 0.0, np.inf).tolist() == list(range(0, 33, 4))
    t = np.linspace(0.0, 1.0, 33)
    assert ct.stability.envelope(t, np.cos(50.0 * t)[:, None], np.array([50.0]), np.zeros(1, int)) is None


@pytest.mark.parametrize("rate", [-7.0, 0.0, 3.0])
def test_an_exponential_has_its_rate_whatever_its_scale_and_the_zero_of_time(rate):
    assert ct.stability.growth_of(TIME, np.exp(2.0 * rate * TIME)).rate == pytest.approx(rate, abs=1e-9)
    energy = np.exp(2.0 * rate * TIME + 0.1 * np.random.default_rng(1).standard_normal(32))
    one = ct.stability.growth_of(TIME, energy)
    assert one.rate == pytest.approx(rate, abs=0.1)
    assert one.first == 0
    assert one.low < rate < one.high
    for other in (ct.stability.growth_of(TIME, 1e-12 * energy), ct.stability.growth_of(TIME + 50.0, energy)):
        assert (other.rate, other.low, other.high, other.scatter) == pytest.approx(
            (one.rate, one.low, one.high, one.scatter), abs=1e-8
        )
    slow = ct.stability.growth_of(4.0 * TIME, energy)
    assert (slow.rate, slow.low, slow.high) == pytest.approx((one.rate / 4, one.low / 4, one.high / 4), abs=1e-9)


@pytest.mark.parametrize("corner", [10, 16, 22])
def test_growth_is_that_of_the_last_straight_piece(corner):
    y = np.where(np.arange(32) < corner, 5.0 * (TIME - TIME[corner]), -8.0 * (TIME - TIME[corner]))
    found = ct.stability.growth_of(TIME, np.exp(2.0 * y))
    assert abs(found.first - corner) <= 1
    assert found.rate == pytest.approx(-8.0, abs=1e-6)
    two = np.interp(np.arange(32), [0, 10, 20, 31], [0.0, 3.0, 3.0, 1.0])
    last = ct.stability.growth_of(TIME, np.exp(2.0 * two))
    assert last.first in (19, 20, 21)
    assert last.rate == pytest.approx(-2.0 / (TIME[31] - TIME[20]), rel=1e-6)


def test_windows_before_the_motion_begins_are_left_out():
    energy = np.exp(6.0 * TIME)
    energy[:9] = 0.0
    found = ct.stability.growth_of(TIME, energy)
    assert (found.first, found.rate) == (9, pytest.approx(3.0))
    energy[9:] *= 1e30
    assert ct.stability.growth_of(TIME, energy).first == 9
    still = np.zeros(32)
    still[-5:] = 1.0
    assert ct.stability.growth_of(TIME, still) is None
    still[-6:] = np.exp(TIME[-6:])
    assert ct.stability.growth_of(TIME, still).rate == pytest.approx(0.5)
    assert ct.stability.growth_of(TIME, np.where(np.arange(32) < 4, np.nan, np.exp(6.0 * TIME))).first == 4


def half_student(A, y, column):
    """Half of Student's 95 % interval of a coefficient of a least-squares fit; 0.005 of scatter is always counted."""
    _, rss, *_ = np.linalg.lstsq(A, y, rcond=None)
    k, p = A.shape
    error = np.sqrt((rss[0] / (k - p) + 0.005**2) * np.linalg.inv(A.T @ A)[column, column])
    return student.ppf(0.975, k - p) * error


@pytest.mark.parametrize("count", [6, 9, 20])
def test_slopes_have_the_interval_of_a_line_and_of_a_bend_where_windows_are_independent(count):
    """Residuals that alternate have no positive autocorrelation. The bend is a parabola's, the beat 0.05 e-folds."""
    x, u = np.arange(float(count)), np.linspace(-0.5, 0.5, count)
    y = 0.3 * x + 0.1 * (-1.0) ** x
    found = ct.stability.growth_of(x, np.exp(2.0 * y))
    line, parabola = np.column_stack([np.ones(count), x]), np.column_stack([np.ones(count), u, u**2])
    assert found.first == 0
    assert found.rate == pytest.approx(np.linalg.lstsq(line, y, rcond=None)[0][1])
    assert found.scatter == pytest.approx(half_student(line, y, 1))
    bend = np.hypot(np.linalg.lstsq(parabola, y, rcond=None)[0][2], half_student(parabola, y, 2)) / (count - 1.0)
    whole = np.sqrt(found.scatter**2 + bend**2 + (0.05 / count) ** 2)
    assert found.high - found.rate == pytest.approx(found.rate - found.low) == pytest.approx(whole)


def test_intervals_contain_the_slope_of_drawn_windows():
    """Of 300 draws of independent noise 95 %, and of correlated noise most; without the bend of the piece."""
    rng, x = np.random.default_rng(6), np.arange(32.0)
    for r, least in ((0.0, 0.92), (0.5, 0.78)):
        inside = 0
        for _ in range(300):
            noise = rng.standard_normal(32)
            for k in range(1, 32):
                noise[k] += r * noise[k - 1]
            found = ct.stability.growth_of(x, np.exp(2.0 * (0.02 * x + 0.1 * noise)))
            inside += abs(found.rate - 0.02) < found.scatter
        assert least < inside / 300 < 0.99


@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_energy_of_a_free_motion_is_that_of_its_modes(step):
    """Coarse states have velocities of no use; there the energy is twice that of the displacement."""
    t, omega = np.arange(0.0, 4.0, step), np.array([300.0, 330.0, 700.0])
    amplitude = np.array([2e-3, 1e-3, 5e-4])
    q = amplitude * np.cos(omega * t[:, None] + [0.0, 1.0, 2.0]) + [0.1, 0.0, -0.2]
    found = ct.stability.envelope(t, q, omega, np.array([0, 0, 1]))
    exact = 0.5 * (omega * amplitude) ** 2
    np.testing.assert_allclose(found.energy.mean(axis=0), [exact[:2].sum(), exact[2]], rtol=0.06)
    assert found.time[0] == pytest.approx(0.5 * (found.start[0] + found.start[1]), abs=step)
    assert np.all(np.diff(found.time) > 0.0)
