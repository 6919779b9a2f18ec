"""Parts of the evaluation of circles against what they say: orders told apart, labels, lines, noise."""

import re

import numpy as np
import pytest
from scipy.linalg import subspace_angles
from scipy.stats import norm as normal
from scipy.stats import t as student

import casingfem as cf
from casingfem.experiment.circle.lines import (
    clear_rate,
    closest,
    line_frequencies,
    noise_beside,
    require_clear,
    white_level,
)
from casingfem.experiment.circle.orientation import Circle, antinode, harmonic, quadrature, reading, spread_of_others
from casingfem.experiment.circle.record import from_tacho

SEED = 3391
EVEN = 2.0 * np.pi * np.arange(24) / 24


@pytest.mark.parametrize(
    ("count", "orders"), [(2, ()), (3, (0, 1)), (4, (0, 1)), (5, (0, 1, 2)), (6, (0, 1, 2)), (7, (0, 1, 2, 3))]
)
def test_even_sensors_tell_orders_below_half_their_number(count, orders):
    assert Circle.of(0.3 + 2.0 * np.pi * np.arange(count) / count).orders == orders


def test_orders_end_where_it_is_asked_and_sensors_in_one_place_tell_none():
    assert Circle.of(EVEN, n_max=3).orders == (0, 1, 2, 3)
    assert Circle.of(EVEN, n_max=0).orders == (0,)
    assert Circle.of(np.ones(5)).orders == ()


@pytest.mark.parametrize("seed", range(12))
def test_orders_end_where_one_looks_like_a_smaller_one_and_miss_those_of_which_a_part_is_not_seen(seed):
    """Within 18.2 deg of it (cosine .95); less seen of the sine than a quarter of the cosine, or the other way."""
    theta = np.sort(np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, 9))
    told = {}
    for n in range(9):
        waves = np.column_stack([np.cos(n * theta), np.sin(n * theta)])[:, : 1 + (n > 0)]
        if n and np.linalg.cond(waves) > 4.0:
            continue
        if any(np.cos(subspace_angles(waves, other).min()) > 0.95 for other in told.values()):
            break
        told[n] = waves
    assert Circle.of(theta).orders == (tuple(told) if len(told) > 1 else ())


@pytest.mark.parametrize(
    ("shares", "n"), [((0.36, 0.32, 0.32), 3), ((0.34, 0.33, 0.33), -1), ((0.8, 0.2, 0.0), 3), ((0.2, 0.8, 0.0), 5)]
)
@pytest.mark.parametrize("size", [1.0, 7.0])
def test_a_label_has_the_largest_share_of_the_energy_a_third_at_least(shares, n, size):
    shape = size * sum(np.sqrt(share) * np.cos(m * (EVEN - 0.1)) for share, m in zip(shares, (3, 5, 7), strict=True))
    found = Circle.of(EVEN).label(shape, 1e-8 * np.eye(24))
    assert found.n == n
    assert found.purity == pytest.approx(max(shares), rel=1e-6)
    assert np.isnan(found.angle) == np.isnan(found.sigma) == (n < 0)
    if n > 0:
        assert found.angle == pytest.approx(0.1, abs=1e-6)


def test_a_mean_beside_a_wave_is_n_0_by_its_share_and_has_no_antinode():
    found = Circle.of(EVEN).label(2.0 + np.cos(3.0 * EVEN), 1e-8 * np.eye(24))
    assert (found.n, found.purity) == (0, pytest.approx(4.0 / 4.5, rel=1e-6))
    assert np.isnan(found.angle)
    assert np.isnan(found.sigma)


def test_the_sigma_of_a_pure_shape_is_that_of_its_noise():
    """sigma sqrt(2/N)/(n A)."""
    found = Circle.of(EVEN).label(2.0 * np.cos(4.0 * (EVEN - 0.2)), 0.01**2 * np.eye(24))
    assert found.sigma == pytest.approx(0.01 * np.sqrt(2.0 / 24) / (4 * 2.0), rel=2e-2)


def test_the_interval_of_an_antinode_is_student_s_where_other_orders_turn_it():
    """Freedom 10/(share of what is estimated)^2, by the orders up to 8 beyond the largest told."""
    theta = EVEN[::2] + np.radians([0, 3, -2, 4, -4, 1, -3, 2, 4, -1, 3, -4])
    shape = np.cos(3.0 * (theta - 0.2)) + 0.1 * np.cos(5.0 * theta) + 0.05 * np.sin(8.0 * theta)
    C = np.diag(np.linspace(0.5, 1.5, 12)) * 1e-4
    circle = Circle.of(theta)
    rest = [harmonic(theta, m) for m in range(circle.n_max + 8) if m != 3]
    order = np.concatenate([[k] * part.shape[1] for k, part in enumerate(rest)])
    others = spread_of_others(shape, harmonic(theta, 3), np.hstack(rest), order, C)
    read = reading(harmonic(theta, 3), others + 1e-4 * np.eye(12))
    (angle, whole), (_, known) = (antinode(read @ shape, read @ part @ read.T, 3) for part in (C + others, C))
    freedom = 10.0 / (1.0 - (known / whole) ** 2) ** 2
    found = circle.label(shape, C)
    assert found.angle == pytest.approx(angle, rel=1e-9)
    assert found.sigma == pytest.approx(whole * student.ppf(0.975, freedom) / normal.ppf(0.975), rel=1e-6)


def test_an_antinode_and_its_deviation_by_hand():
    """a = 3, b = -4, n = 3: d psi = (a db - b da)/(3 . 25)."""
    C = np.array([[0.4, 0.1], [0.1, 0.9]])
    angle, sigma = antinode(np.array([3.0, -4.0]), C, 3)
    assert angle == pytest.approx((np.arctan2(-4.0, 3.0) + 2.0 * np.pi) / 3.0 % (np.pi / 3.0), rel=1e-14)
    assert sigma == pytest.approx(np.sqrt(16 * 0.4 + 9 * 0.9 + 2 * 12 * 0.1) / 75.0, rel=1e-14)
    assert antinode(np.array([1.0, -1e-10]), C, 3)[0] == 0.0
    assert antinode(np.array([1.0, -1e-8]), C, 3)[0] == pytest.approx(np.pi / 3.0, abs=1e-7)


def test_harmonics_are_ones_or_cosine_and_sine():
    theta = np.array([0.2, 1.0])
    assert harmonic(theta, 0).tolist() == [[1.0], [1.0]]
    np.testing.assert_allclose(harmonic(theta, 2), [[np.cos(0.4), np.sin(0.4)], [np.cos(2.0), np.sin(2.0)]])


@pytest.mark.parametrize(("apart", "share"), [(0.0, 0.0), (90.0, 1.0), (180.0, 0.0), (-30.0, 0.5), (150.0, 0.5)])
def test_antinodes_are_a_quarter_wave_apart_or_a_part_of_it(apart, share):
    assert quadrature(0.3, 0.3 - np.radians(apart) / 5, 5) == pytest.approx(share, abs=1e-14)


def test_a_reading_is_generalised_least_squares():
    rng = np.random.default_rng(SEED)
    own, half = rng.normal(size=(5, 2)), rng.normal(size=(5, 5))
    C = half @ half.T + np.eye(5)
    exact = np.linalg.inv(own.T @ np.linalg.inv(C) @ own) @ own.T @ np.linalg.inv(C)
    np.testing.assert_allclose(reading(own, C), exact, rtol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_the_spread_of_other_orders_is_what_expectation_and_maximisation_leave_alone(seed):
    """Orders of one or two columns of the identity: their variances stand on the diagonal."""
    rng = np.random.default_rng(seed)
    shape, own, S = (
        rng.normal(size=8) + 2.0,
        np.column_stack([np.ones(8), np.arange(8.0)]),
        np.diag(rng.uniform(0.01, 0.1, 8)),
    )
    order = np.array([0, 0, 1, 2, 2, 3, 4, 4])
    spread = spread_of_others(shape, own, np.eye(8), order, S)
    np.testing.assert_allclose(spread, np.diag(np.diag(spread)), atol=1e-15)
    assert np.diag(spread).min() > 0.1
    inverse = np.linalg.inv(S + spread)
    P = inverse - inverse @ own @ np.linalg.inv(own.T @ inverse @ own) @ own.T @ inverse
    v = np.diag(spread)[[0, 2, 3, 5, 6]]
    scale = 1.0 / np.mean(1.0 / v)
    for m in range(5):
        B = np.eye(8)[:, order == m]
        w = B.shape[1]
        square = np.sum((v[m] * B.T @ P @ shape) ** 2) + w * v[m] - v[m] ** 2 * np.trace(B.T @ P @ B)
        assert (6.0 * scale + square) / (6.0 + w) == pytest.approx(v[m], rel=1e-2)


def test_noise_beside_a_line_is_the_median_of_bins_3_to_30_away_over_ln_2():
    """Bins as high as they are far from the line, 3 to 30: median 16.5; nothing else counts."""
    power = np.abs(np.arange(101.0) - 50.0)
    power[48:53], power[:20], power[81:] = 1e9, 0.0, 0.0
    assert noise_beside(power, 200, 400.0, np.array([100.0, 100.9])) * np.log(2.0) == pytest.approx([16.5, 16.5])


def test_bins_end_at_the_first_and_the_last():
    """At 0 Hz half of them are bin 1, at fs/2 half are the last: medians halfway to the third from there."""
    power = np.arange(101.0)
    assert noise_beside(power, 200, 400.0, np.array([0.0, 200.0])) * np.log(2.0) == pytest.approx([2.0, 98.5])


def test_the_spectrum_of_white_noise_is_its_variance():
    rng = np.random.default_rng(SEED)
    residual = rng.normal(size=64)
    window = np.sin(np.pi * np.arange(64) / 64) ** 2
    exact = [abs(np.sum(residual * window * np.exp(-2j * np.pi * k * np.arange(64) / 64))) ** 2 for k in range(33)]
    np.testing.assert_allclose(white_level(residual), np.array(exact) / np.sum(window**2), rtol=1e-9)
    assert white_level(3.0 * rng.normal(size=40_000)).mean() == pytest.approx(9.0, rel=0.03)


def test_a_line_below_0_hz_stands_above_it():
    assert line_frequencies([5.0], np.array([-3, 3]), 2.0).tolist() == [1.0, 11.0]
    assert line_frequencies([5.0], np.array([1]), -2.0, runout=2).tolist() == [3.0, 0.0, 2.0, 4.0]


def test_the_closest_lines_and_none_of_a_single_one():
    assert closest(np.array([5.0, 1.0, 4.25, 9.0])) == (2, 0, 0.75)
    assert closest(np.array([5.0])) == (0, 0, np.inf)


@pytest.mark.parametrize(
    ("tones", "n", "rate", "seconds", "fs", "found"),
    [
        ((300.0,), [-1, 0, 1], 1.0, 1.9, 2000.0, 1.055), ((300.0,), [-1, 0, 1], 1.0, 1.43, 2000.0, 1.4),
        ((300.0,), [-1, 0, 1], 1.0, 1.42, 2000.0, None), ((100.0,), [-10, 0, 10], 5.0, 9.0, 272.0, 3.5875),
        ((100.0,), [-10, 0, 10], 5.0, 9.0, 269.9, None), ((100.0,), [-10, 0, 10], -5.0, 9.0, 272.0, -3.5875),
    ],
)  # fmt: skip
def test_the_nearest_clear_rate_is_found_from_seven_tenths_to_fourteen(tones, n, rate, seconds, fs, found):
    """Two bins between lines at least, all below fs/2; tried in steps of a 400th."""
    better = clear_rate(tones, np.array(n), rate, seconds, fs)
    assert better == (None if found is None else pytest.approx(found, rel=1e-12))


REFUSED = [
    ((100.0,), [0], 1.49, 1.0, 999.0, 0, "found 1.49 turns of the spot, expected 1.5 (1.01 s, or a faster mirror"),
    ((100.0,), [0], -1.49, 1.0, 999.0, 0, "found 1.49 turns of the spot, expected 1.5 (1.01 s, or a faster mirror"),
    ((100.0,), [0], 0.0, 1.0, 999.0, 0, "found 0.00 turns of the spot, expected 1.5 (a mirror or a casing that turns)"),
    ((100.0,), [0], 2.0, 1.0, 200.0, 0, "found a line at 100.00 Hz, expected all below fs/2 = 100 Hz"),
    ((100.0, 100.9), [0], 2.0, 1.0, 999.0, 0, "n = 0 of 100.000 Hz (+nW) and n = 0 of 100.900 Hz (+nW) stand 0.9 Hz "
     "apart at 100.000 Hz, a record of 1 s tells 1 Hz: excite fewer tones at a time"),
    ((100.0, 113.0), [-7, 6], 1.0, 4.0, 999.0, 0, "n = 6 of 100.000 Hz (+nW) and n = 7 of 113.000 Hz (-nW) stand 0 Hz "
     "apart at 106.000 Hz, a record of 4 s tells 0.25 Hz: turn at 1.04 turns/s"),
    ((6.0,), [0], 2.0, 1.0, 999.0, 3, "n = 0 of 6.000 Hz (+nW) and the run-out's harmonic 3 stand 0 Hz apart"),
]  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_a_record_that_does_not_tell_its_lines_apart_is_refused_in_words(case):
    tones, n, rate, seconds, fs, runout, words = case
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        require_clear(tones, np.array(n), rate, seconds, fs, runout)


def test_what_just_suffices_is_taken():
    require_clear((100.0,), np.array([0]), 1.5, 1.0, 201.0, 0)
    require_clear((100.0,), np.array([0]), -1.5, 1.0, 201.0, 0)
    require_clear((100.0, 101.0), np.array([0]), 2.0, 1.0, 999.0, 0)


def test_a_record_comes_back_with_or_without_force(tmp_path):
    for force in (None, [4.0, 5.0, 6.0]):
        given = cf.circle.ScanRecord(
            fs=8.0, velocity=[1.0, 2.0, 3.5], angle=[0.5, 0.75, 1.25], tones=(3.0, 4.0), force=force, card=("a", "b")
        )
        found = cf.circle.ScanRecord.load(given.save(tmp_path / "scan.npz"))
        assert (found.fs, found.tones, found.card) == (8.0, (3.0, 4.0), ("a", "b"))
        assert found.velocity.tolist() == [1.0, 2.0, 3.5]
        assert found.angle.tolist() == [0.5, 0.75, 1.25]
        assert (found.force is None) if force is None else (found.force.tolist() == force)
        assert found.seconds == 0.375
        assert not given.velocity.flags.writeable
        assert found.rate == pytest.approx(0.75 / (2.0 * np.pi * 2.0) * 8.0, rel=1e-14)


def test_a_tacho_spans_the_record_and_has_two_pulses():
    np.testing.assert_allclose(from_tacho([0.0, 2.0], 2.0, 5), np.pi * np.array([0.0, 0.5, 1.0, 1.5, 2.0]))
    for pulses, words in (([0.1, 2.0], "from 0.1 to 2 s, expected them to span the record, 0 to 2 s"),
                          ([0.0, 1.9], "from 0 to 1.9 s"), ([0.0], "two pulses or more"), ([0.0, np.nan], "two pulses"),
                          ([[0.0, 2.0]], "two pulses")):  # fmt: skip
        with pytest.raises(cf.errors.InputError, match=words):
            from_tacho(pulses, 2.0, 5)
