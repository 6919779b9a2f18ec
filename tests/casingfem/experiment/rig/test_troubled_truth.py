"""A bench with troubles against closed forms: two drives, modes beyond the band, what is left out, each switch."""

import numpy as np
import pytest

import casingfem as cf

SEED = 4407
X = np.arange(80.0, 160.0, 0.5)
QUIET = 240.0  # dB: as good as no noise
OMEGA = 2.0 * np.pi * np.array([60.0, 101.3, 130.2, 200.0])
ZETA = np.array([0.01, 0.004, 0.007, 0.02])
ROWS = np.random.default_rng(SEED).uniform(0.3, 1.5, (7, 4)) * np.random.default_rng(8).choice([-1.0, 1.0], (7, 4))
HALF = np.random.default_rng(SEED).normal(size=(7, 7))
S = 1e-6 * HALF @ HALF.T
SENSORS, DRIVES = (0, 2, 3, 4, 5), (6, 1)
RESIDUES = np.concatenate([ROWS[list(SENSORS)] * ROWS[drive] for drive in DRIVES])
STATIC = np.concatenate([S[list(SENSORS), drive] for drive in DRIVES])[:, None]
POWERS = {"receptance": 0, "mobility": 1, "accelerance": 2}


def made(quantity="accelerance", seed=SEED, **troubles):
    rig = cf.rig.Rig.of(omega=OMEGA, zeta=ZETA, rows=ROWS, S=S)
    what = cf.rig.Troubles(**{"snr_db": QUIET, **troubles})
    return cf.rig.troubled_frfs(rig, X, what, sensors=SENSORS, drives=DRIVES, seed=seed, quantity=quantity)


def exact(freq=X, quantity="accelerance", decay=0.0, omega=OMEGA):
    """s^q [sum r/(s^2 + 2 zeta omega s + omega^2) + S], s = 2 pi j f + decay, (channels, lines)."""
    s = 2j * np.pi * freq + decay
    modes = 1.0 / (s**2 + 2.0 * (ZETA * omega)[:, None] * s + omega[:, None] ** 2)
    return (RESIDUES @ modes + STATIC) * s ** POWERS[quantity]


def close(found, expected, rtol=1e-9):
    np.testing.assert_allclose(found, expected, rtol=rtol, atol=rtol * np.abs(expected).max())


@pytest.mark.parametrize("quantity", POWERS)
@pytest.mark.parametrize("exponential", [0.0, 0.2])
def test_every_quantity_is_its_sum_of_modes_under_its_window(quantity, exponential):
    decay = 5.0 if exponential else 0.0
    found = made(quantity, exponential=exponential)
    close(found.frfs.responses, exact(quantity=quantity, decay=decay))
    assert found.frfs.card[-1].startswith("troubles: Troubles(")
    assert found.frfs.card[-1].endswith(f"seed {SEED}")
    assert (found.coherence.kind, found.coherence.unit) == ("spectrum", "")
    own = np.hypot(ZETA * OMEGA + decay, OMEGA * np.sqrt(1.0 - ZETA**2))
    close(found.truth.freq, [own / (2.0 * np.pi)])
    close(found.truth.zeta, [(ZETA * OMEGA + decay) / own])


@pytest.mark.parametrize("quantity", POWERS)
def test_records_that_are_cut_off_lack_the_ringing_after_their_end(quantity):
    """The lines of a record of 2 s that begins 0.4 s before the hit: a sum over its samples gives the same."""
    found, fs = made(quantity, cut_off=True, pre_trigger=0.4), 2.0**16
    t = np.arange(round(1.6 * fs)) / fs
    poles = OMEGA * (-ZETA + 1j * np.sqrt(1.0 - ZETA**2))
    lines = X[[30, 43, 44, 100]]
    kernel = np.exp(np.multiply.outer(t, poles)[None] - 2j * np.pi * lines[:, None, None] * t[:, None])
    kernel[:, 0], kernel[:, -1] = 0.5 * kernel[:, 0], 0.5 * kernel[:, -1]  # trapezia
    free = kernel.sum(axis=1) / fs  # (lines, modes): integral of exp((p - s) t)
    kernel = np.exp(np.multiply.outer(t, poles.conj())[None] - 2j * np.pi * lines[:, None, None] * t[:, None])
    kernel[:, 0], kernel[:, -1] = 0.5 * kernel[:, 0], 0.5 * kernel[:, -1]
    mirror = kernel.sum(axis=1) / fs
    A, q = RESIDUES / (2j * poles.imag), POWERS[quantity]
    direct = {0: 0.0, 1: 0.0, 2: RESIDUES.sum(axis=1)[:, None]}[q]  # acceleration at the instant of the hit
    expected = (A * poles**q) @ free.T + (A * poles**q).conj() @ mirror.T + direct
    expected = expected + STATIC * (2j * np.pi * lines) ** q
    np.testing.assert_allclose(
        found.frfs.responses[:, [30, 43, 44, 100]], expected, atol=2e-4 * np.abs(expected).max(axis=1).min()
    )
    np.testing.assert_allclose(found.truth.left, np.exp(-ZETA * OMEGA * 1.6))
    assert made(quantity).truth.left.tolist() == [0.0] * 4


@pytest.mark.parametrize(
    ("troubles", "words"),
    [({"pre_trigger": 0.1}, "without cut_off"), ({"cut_off": True, "leakage": True}, "cut_off and leakage"),
     ({"cut_off": True, "pre_trigger": 2.5}, "less than the record, 2 s")],
)  # fmt: skip
def test_a_pre_trigger_belongs_to_a_record_that_is_cut_off(troubles, words):
    with pytest.raises(cf.errors.InputError, match=words):
        made(**troubles)


def test_without_a_word_there_is_noise_of_a_hundredth_and_no_other_trouble():
    rig = cf.rig.Rig.of(omega=OMEGA, zeta=ZETA, rows=ROWS, S=S)
    found = cf.rig.troubled_frfs(rig, X, cf.rig.Troubles(), sensors=SENSORS, drives=DRIVES, seed=SEED)
    H, truth = exact(), found.truth
    sigma = 0.01 * np.sqrt(np.mean(np.abs(H) ** 2, axis=1, keepdims=True))
    close(found.coherence.responses.real, np.abs(H) ** 2 / (np.abs(H) ** 2 + 5.0 * sigma**2))
    noise = (found.frfs.responses - H) / sigma
    assert np.mean(np.abs(noise) ** 2, axis=1) == pytest.approx(np.ones(10), abs=0.3)
    assert np.abs(np.corrcoef(noise) - np.eye(10)).max() < 0.4
    assert truth.setup.tolist() == [0] * 10
    assert truth.dead == truth.noisy == truth.swapped == truth.flipped == ()
    assert truth.fixture_hz.size == 0
    close(truth.freq, [OMEGA / (2.0 * np.pi)])


def test_peaks_are_those_of_live_channels_over_the_noise_at_their_line_or_the_nearest_end():
    """A mode k peaks at |r| (2 pi f)^(q - 2)/(2 zeta): of frequency and damping as the window makes them."""
    found = made("mobility", snr_db=20.0, colour=1.5, exponential=0.2, dead=2, noisy=3)
    H, truth = exact(quantity="mobility", decay=5.0), found.truth
    sigma = 0.1 * np.sqrt(np.mean(np.abs(H) ** 2, axis=1, keepdims=True)) * (X.mean() / X) ** 1.5
    sigma[list(truth.noisy)] *= 10.0
    (freq,), (zeta,) = truth.freq, truth.zeta
    lines = [0, int(np.flatnonzero(freq[1] <= X)[0]), int(np.flatnonzero(freq[2] <= X)[0]), -1]
    peaks = np.abs(RESIDUES) / (2.0 * np.pi * freq) / (2.0 * zeta) / sigma[:, lines]
    alive = np.delete(np.arange(10), truth.dead)
    close(truth.peak, np.sqrt(np.mean(peaks[alive] ** 2, axis=0)))


def test_leakage_is_a_mean_over_lines_nearby_by_the_power_of_a_hann_window():
    lines = np.linspace(-3.75, 3.75, 31)
    power = np.array([0.25 if abs(x) == 1.0 else (np.sinc(x) / (1.0 - x * x)) ** 2 for x in lines])
    blurred = sum(p * exact(X + x * 0.5) for p, x in zip(power, lines, strict=True)) / power.sum()
    close(made(leakage=True).frfs.responses, blurred, 1e-7)


@pytest.mark.parametrize(
    ("setups", "groups"), [(1, [0] * 5), (2, [0, 0, 0, 1, 1]), (3, [0, 0, 1, 1, 2]), (5, [0, 1, 2, 3, 4])]
)
def test_sensors_are_measured_in_groups_of_neighbours_whatever_the_drive(setups, groups):
    found = made(setups=setups, shift=0.03)
    assert found.truth.setup.tolist() == groups * 2
    off = found.truth.freq / (OMEGA / (2.0 * np.pi)) - 1.0
    assert off.shape == (setups, 4)
    if setups == 1:
        assert np.abs(off).max() < 1e-12
    for k in range(setups):
        here = found.truth.setup == k
        close(found.frfs.responses[here], exact(omega=2.0 * np.pi * found.truth.freq[k])[here])


def test_there_are_no_more_groups_than_sensors():
    assert made(setups=8, shift=0.01).truth.setup.tolist() == [0, 1, 2, 3, 4] * 2


def test_frequencies_are_shifted_up_and_down_by_as_much_as_is_reported():
    off = made(setups=100, shift=0.03).truth.freq / (OMEGA / (2.0 * np.pi)) - 1.0
    assert -0.03 <= off.min() < -0.029
    assert 0.029 < off.max() <= 0.03
    assert np.unique(off).size == 400


def test_half_a_rim_is_its_first_half_rounded_up():
    half = made(half_rim=True)
    assert half.frfs.response_point.tolist() == [1, 3, 4] * 2
    close(half.frfs.responses, exact()[[0, 1, 2, 5, 6, 7]])


@pytest.mark.parametrize("exponential", [0.0, 0.2])
def test_local_modes_peak_at_three_tenths_of_the_median_of_modes_in_the_band(exponential):
    """Damped .8 %, by 1/2, 1, 1/2 at three sensors in a ring, under each drive."""
    decay = 5.0 if exponential else 0.0
    found = made(fixture=4, exponential=exponential)
    rate, s = 2.0 * np.pi * found.truth.fixture_hz[:, None], 2j * np.pi * X + decay
    own = np.sqrt((0.008 * decay) ** 2 + rate**2 - decay**2) - 0.008 * decay  # |p - decay| = rate
    usual = np.median(np.abs(RESIDUES[:, 1:3]) / (2.0 * (ZETA * OMEGA**2)[1:3]))
    each = 0.3 * usual * 2.0 * 0.008 * own**2 / (s**2 + 2.0 * 0.008 * own * s + own**2) * s**2
    added = found.frfs.responses - exact(decay=decay)
    parts = np.linalg.lstsq(np.hstack([each.real, each.imag]).T, np.hstack([added.real, added.imag]).T, rcond=None)[0]
    close(parts.T @ each, added, 1e-7)
    for part in parts:
        ring = np.roll([1.0, 0.5, 0.0, 0.0, 0.5], part[:5].argmax())
        np.testing.assert_allclose(part, np.tile(ring, 2), atol=1e-6)
    assert {0, 4} & {int(part[:5].argmax()) for part in parts}  # across the seam


def test_local_modes_lie_in_the_inner_four_fifths_of_the_band():
    freq = made(fixture=300).truth.fixture_hz
    low, high = X[0] + 0.1 * np.ptp(X), X[-1] - 0.1 * np.ptp(X)
    assert low <= freq.min() < low + 1.0
    assert high - 1.0 < freq.max() <= high


def test_phases_have_their_rms_and_leave_sizes():
    """200 sensors, one mode: A/(s - p) + A*/(s - p*) with |A| = |r|/(2 omega_d)."""
    rows = np.r_[np.linspace(0.5, 1.5, 200), 1.0][:, None]
    rig = cf.rig.Rig.of(omega=OMEGA[1:2], zeta=0.01, rows=rows)
    found = cf.rig.troubled_frfs(
        rig,
        X,
        cf.rig.Troubles(snr_db=QUIET, phase_deg=12.0),
        sensors=range(200),
        drives=[200],
        seed=SEED,
        quantity="mobility",
    )
    s, p = 2j * np.pi * X, OMEGA[1] * (-0.01 + 1j * np.sqrt(1.0 - 0.01**2))
    pole, mirrored = 1.0 / (s - p), 1.0 / (s - np.conj(p))
    columns = np.column_stack([pole + mirrored, 1j * (pole - mirrored)])
    H = (found.frfs.responses / s).T
    parts = np.linalg.lstsq(np.vstack([columns.real, columns.imag]), np.vstack([H.real, H.imag]), rcond=None)[0]
    close(columns @ parts, H, 1e-8)
    A = parts[0] + 1j * parts[1]
    close(np.abs(A), rows[:-1, 0] / (2.0 * p.imag), 1e-8)
    phase = np.degrees(np.angle(A * 1j))
    assert np.sqrt(np.mean(phase**2)) == pytest.approx(12.0, rel=0.15)
    assert abs(np.mean(phase)) < 3.0


def test_spoilt_channels_are_different_ones_and_no_more_than_there_are():
    for pairs in (1, 0):
        truth = made(dead=3, noisy=2, flipped=2, swapped=pairs).truth
        spoilt = [*truth.dead, *truth.noisy, *truth.flipped, *np.ravel(truth.swapped).astype(int).tolist()]
        assert (len(truth.dead), len(truth.noisy), len(truth.flipped), len(truth.swapped)) == (3, 2, 2, pairs)
        assert len(set(spoilt)) == len(spoilt)
    with pytest.raises(
        cf.errors.InputError, match="troubles: found dead 3, noisy 2, flipped 2, swapped 2; expected at most the"
    ):
        made(dead=3, noisy=2, flipped=2, swapped=2)


def test_a_window_shorter_than_a_period_is_refused():
    with pytest.raises(cf.errors.InputError, match=r"troubles.exponential: found 1e-300 s; expected none, or at least"):
        made(exponential=1e-300)


def test_pairs_are_exchanged_with_their_coherence_and_dead_channels_have_noise_alone():
    found = made(snr_db=20.0, swapped=3, dead=2, flipped=1)
    H, truth = exact(), found.truth
    sigma = 0.1 * np.sqrt(np.mean(np.abs(H) ** 2, axis=1, keepdims=True))
    coherence = np.abs(H) ** 2 / (np.abs(H) ** 2 + 5.0 * sigma**2)
    coherence[list(truth.dead)] = 0.0
    where, signs, there = np.arange(10), np.ones(10), np.ones(10)
    for a, b in truth.swapped:
        where[[a, b]] = b, a
    signs[list(truth.flipped)], there[list(truth.dead)] = -1.0, 0.0
    assert len({k for pair in truth.swapped for k in pair}) == 6
    close(found.coherence.responses.real, coherence[where])
    noise = found.frfs.responses - (signs * there)[:, None] * H[where]
    assert np.mean(np.abs(noise / sigma[where]) ** 2, axis=1) == pytest.approx(np.ones(10), abs=0.3)


OUTSIDE = {
    "coherent": (-1e-9, 1.001, float("nan")), "shift": (-1e-9, 0.0501), "double_hit": (-1e-9, 0.9901),
    "phase_deg": (-1e-9, 90.1), "noisy": (-1,), "swapped": (-1,), "flipped": (-1,), "exponential": (float("nan"),),
}  # fmt: skip
ENDS = {"coherent": (0.0, 1.0), "shift": (0.0, 0.05), "double_hit": (0.0, 0.99), "phase_deg": (0.0, 90.0)}


@pytest.mark.parametrize("name", OUTSIDE)
def test_ranges_keep_their_ends_and_nothing_beyond(name):
    for value in ENDS.get(name, (0,)):
        assert getattr(cf.rig.Troubles(**{name: value}), name) == value
    for value in OUTSIDE[name]:
        with pytest.raises(cf.errors.InputError, match=f"{name}: found {value!r}, expected "):
            cf.rig.Troubles(**{name: value})
