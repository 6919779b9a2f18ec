"""Parts of the passage through a phase against complex numbers, and whole phases against dense looks."""

import cmath
import math

import numpy as np
import pytest

from tests.contact.plain import names

N = names("contact.loop.phase")
LAM = np.array([-0.3 + 2.0j, 0.2 - 1.1j, -0.5 + 0.0j, 0.0])
BETA = np.array([0.4 - 0.2j, 0.1 + 0.3j, -0.6 + 0.1j, 0.25])
ROWS = np.array([[0.7 - 0.4j, -0.3 + 0.2j, 0.5 + 0.1j, -0.2], [0.1 + 0.6j, 0.9 - 0.5j, -0.4 + 0.3j, 0.3]])
REST, WAVE, HARMONIC = (
    np.array([0.9, -0.2]),
    np.array([[0.05 + 0.1j, -0.07j], [0.2 - 0.1j, 0.04]]),
    np.array([1.5, 4.0]),
)
START = np.array([0.3 + 0.1j, -0.2 + 0.4j, 0.5 - 0.3j, 0.1])


def parts(x):
    return np.stack([np.real(x), np.imag(x)])


def phase(rest=REST, rows=ROWS, wave=WAVE):
    return N.PhaseArrays(
        lam=parts(LAM), beta=parts(BETA), rows=parts(rows), rest=np.array(rest), wave=parts(wave), harmonic=HARMONIC
    )  # fmt: skip


def moved(tau, y=START):
    """y after tau: e^(lam tau) y + tau phi(lam tau) beta."""
    tau = np.asarray(tau)[..., None]
    safe = np.where(LAM == 0.0, 1.0, LAM)
    return np.exp(LAM * tau) * y + np.where(LAM == 0.0, tau, (np.exp(LAM * tau) - 1.0) / safe) * BETA


def value(row, t, tau, rest=REST):
    """What is watched, tau after t."""
    waves = np.real(np.exp(1j * HARMONIC * (t + np.asarray(tau)[..., None])) @ WAVE[row])
    return rest[row] + waves + np.real(moved(tau) @ ROWS[row])


@pytest.mark.parametrize("z", [0.3 + 0.2j, -1.5 + 2.0j, 1e-3 - 2e-3j, 0.0099 + 0.0j, 0.011j, 0.0])
def test_the_flow_of_a_mode_is_the_exponential_and_its_mean(z):
    tau = 0.7
    c, s, u, v = N.flow(parts(np.array([0.0, z / tau])), 1, tau)
    assert complex(c, s) == pytest.approx(cmath.exp(z), rel=1e-14)
    mean = tau * sum(z**k / math.factorial(k + 1) for k in range(25))
    assert complex(u, v) == pytest.approx(mean, rel=1e-11)


@pytest.mark.parametrize("row", [0, 1])
def test_what_is_watched_and_its_slope_are_those_of_the_closed_form(row):
    found, slope = N.watched_at(phase(), parts(START), row, 0.4, 0.8)
    assert found == pytest.approx(value(row, 0.4, 0.8), rel=1e-13)
    step = 1e-6
    exact = (value(row, 0.4, 0.8 + step) - value(row, 0.4, 0.8 - step)) / (2.0 * step)
    assert slope == pytest.approx(exact, abs=1e-8)
    alone, slope = N.wave_at(phase(), row, 1.2)
    waves = np.exp(1j * HARMONIC * 1.2)
    assert alone == pytest.approx(REST[row] + np.real(WAVE[row] @ waves), rel=1e-14)
    assert slope == pytest.approx(np.real(WAVE[row] @ (1j * HARMONIC * waves)), rel=1e-13)
    y = parts(START)
    N.move_to(phase(), y, 0.8)
    np.testing.assert_allclose(y, parts(moved(0.8)), atol=1e-14)


def test_roots_and_turns_are_where_a_dense_appear_finds_them():
    p, y, taus, seen = phase([0.2, 0.0]), parts(START), np.linspace(0.0, 4.0, 4001), set()
    for row in (0, 1):
        values = value(row, 0.4, taus, [0.2, 0.0])
        for k in np.flatnonzero((values[:-1] > 0.0) & (values[1:] < 0.0)):
            found = N.root(p, y, row, 0.4, taus[k], taus[k + 1])
            assert taus[k] < found < taus[k + 1]
            assert value(row, 0.4, found, [0.2, 0.0]) == pytest.approx(0.0, abs=1e-14)
            seen.add("root")
        for sense in (1.0, -1.0):
            rises = sense * np.diff(values)
            for k in np.flatnonzero((rises[:-1] < 0.0) & (rises[1:] > 0.0)):
                low, high = taus[k], taus[k + 2]
                at = N.turn(p, y, row, 0.4, low, high, sense)
                assert low < at < high
                assert abs(N.watched_at(p, y, row, 0.4, at)[1]) <= 1e-8
                assert N.turned(p, y, row, 0.4, low, high) == at
                assert N.turn(p, y, row, 0.4, high, high + 0.01, sense) == high
                assert N.turn(p, y, row, 0.4, high, high + 0.01, -sense) == high + 0.01
                assert N.turned(p, y, row, 0.4, high, high + 0.01) == math.inf
                seen.add(sense)
    assert seen == {"root", 1.0, -1.0}


def begin(p, y=START):
    w = N.phase_work(p)
    w.y[:] = parts(y)
    w.most[:], w.least[:] = -1e9, 1e9
    return w


def test_the_start_counts_and_shows_a_contact_that_is_past_its_event():
    p = phase()
    w = begin(p)
    slopes = [N.watched_at(p, parts(START), row, 0.4, 0.0)[1] for row in (0, 1)]
    assert N.begun(p, w, 2, 0.4) == -1
    assert value(1, 0.4, 0.0) < 0.0 < slopes[1]
    exact = [value(row, 0.4, 0.0) for row in (0, 1)]
    np.testing.assert_allclose([w.now, w.last, w.most, w.least], [exact] * 4, rtol=1e-13)
    size = [
        abs(REST[k]) + sum(abs(f(ROWS[k, i])) * abs(f(START[i])) for f in (np.real, np.imag) for i in range(4))
        + np.abs([np.real(WAVE[k]), np.imag(WAVE[k])]).sum() for k in (0, 1)
    ]  # fmt: skip
    np.testing.assert_allclose(w.size, size, rtol=1e-13)
    lifted = np.array([REST[k] - value(k, 0.4, 0.0) for k in (0, 1)])  # both are zero at the start
    falling = [k for k in (0, 1) if slopes[k] < 0.0]
    assert N.begun(phase(lifted), begin(p), 2, 0.4) == (falling[-1] if falling else -1)
    turned = phase(-lifted, -ROWS, -WAVE)
    rising = [k for k in (0, 1) if slopes[k] > 0.0]
    assert N.begun(turned, begin(p), 2, 0.4) == rising[-1] == 1
    assert N.begun(turned, begin(p), 1, 0.4) == (0 if 0 in rising else -1)  # the second is only watched
    assert N.begun(phase(-lifted + 1e-9, -ROWS, -WAVE), begin(p), 2, 0.4) == -1


@pytest.mark.parametrize("longest", [0.02, 0.11, 0.4])
def test_a_phase_without_events_ends_where_it_is_reported_with_its_extremes(longest):
    p, t, end = phase([5.0, 5.0]), 0.4, 3.3
    w = begin(p)
    assert N.pass_phase(p, w, 2, t, end, longest) == -1
    assert w.at[0] == end
    np.testing.assert_allclose(w.y, parts(moved(end - t)), atol=1e-12)
    taus = np.linspace(0.0, end - t, 4001)
    for row in (0, 1):
        values = value(row, t, taus, [5.0, 5.0])
        assert w.most[row] == pytest.approx(max(values), abs=1e-6)
        assert w.least[row] == pytest.approx(min(values), abs=1e-6)
        assert w.most[row] >= max(values) - 1e-12
        assert w.least[row] <= min(values) + 1e-12


@pytest.mark.parametrize("longest", [0.02, 0.11, 0.4])
def test_a_phase_ends_at_its_first_event(longest):
    t, rest = 0.4, np.array([0.3, 5.0])
    p = phase(rest)
    w = begin(p)
    taus = np.linspace(0.0, 6.0, 6001)
    values = value(0, t, taus, rest)
    assert values[0] > 0.0
    k = int(np.argmax(values < 0.0))
    assert k > 100
    assert N.pass_phase(p, w, 2, t, t + 6.0, longest) == 0
    when = w.at[0] - t
    assert taus[k - 1] < when < taus[k]
    assert value(0, t, when, rest) == pytest.approx(0.0, abs=1e-13)
    np.testing.assert_allclose(w.y, parts(moved(when)), atol=1e-12)
    for row in (0, 1):
        seen = value(row, t, np.linspace(0.0, when, 2001), rest)
        assert w.most[row] == pytest.approx(max(seen), abs=1e-6)
        assert w.least[row] == pytest.approx(min(seen), abs=1e-6)
        assert w.least[row] <= min(seen) + 1e-12
    w = begin(p)
    assert N.pass_phase(p, w, 0, t, t + 1.0, longest) == -1  # none is a contact


def test_an_extreme_that_nobody_asks_for_stays():
    p = phase([5.0, 5.0])
    w = begin(p)
    w.most[1], w.least[1] = math.inf, -math.inf
    N.pass_phase(p, w, 2, 0.4, 3.3, 0.1)
    assert (w.most[1], w.least[1]) == (math.inf, -math.inf)


@pytest.mark.parametrize("depth", [1e-3, 1e-5])
@pytest.mark.parametrize("longest", [0.1, 0.25])
def test_a_dip_below_zero_between_two_evaluations_is_an_event(depth, longest):
    t = 0.4
    taus = np.linspace(0.05, 4.0, 4001)
    values = value(0, t, taus)
    lows = [j for j in range(1, 4000) if values[j - 1] > values[j] < values[j + 1]]
    k = min(lows, key=lambda j: values[j])
    rest = np.array([REST[0] - values[k] - depth, 9.0])
    first = int(np.argmax(value(0, t, taus, rest) < 0.0))
    w = begin(phase(rest))
    assert N.pass_phase(phase(rest), w, 2, t, t + 4.0, longest) == 0
    assert w.at[0] - t == pytest.approx(taus[first], abs=2e-3)
    assert value(0, t, w.at[0] - t, rest) == pytest.approx(0.0, abs=1e-12)
