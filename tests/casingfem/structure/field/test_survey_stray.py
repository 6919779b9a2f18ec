"""Points that contradict others, robust weights and repeats: small cases against brute force and tables."""

import numpy as np
import pytest
from scipy import stats

from casingfem.structure.field.survey.points import SurveyPoints, largest_gap_deg
from casingfem.structure.field.survey.stray import (
    beyond,
    least_squares,
    passes_words,
    pure_error,
    robust_weights,
    shifted_points,
    significant,
    stray_points,
)

NOISE = np.random.default_rng(5).normal(size=60)


def line(points=60):
    return np.column_stack([np.ones(points), np.linspace(-1.0, 1.0, points)])


def without(design, values, out):
    """Residuals of all points by the fit without some, and the scatter of those kept."""
    kept = ~out
    x = np.linalg.lstsq(design[kept], values[kept], rcond=None)[0]
    free = kept.sum() - design.shape[1]
    return values - design @ x, np.sqrt(np.sum((values - design @ x)[kept] ** 2) / free), free


def test_weighted_least_squares_are_those_of_scaled_rows():
    design, w = line(), np.linspace(0.1, 3.0, 60)
    root = np.sqrt(w)
    for weights, rows in ((None, np.ones(60)), (w, root)):
        exact = np.linalg.lstsq(design * rows[:, None], NOISE * rows, rcond=None)[0]
        np.testing.assert_allclose(least_squares(design, NOISE, weights), exact, rtol=1e-11)


def test_weights_that_leave_too_few_points_give_the_shortest_coefficients():
    weights = np.zeros(60)
    weights[59] = 2.0
    np.testing.assert_allclose(least_squares(line(), NOISE, weights), [NOISE[59] / 2] * 2, rtol=1e-12)


def t_values(design, values):
    """Student's t of each point against the fit of all others, brute force, and its degrees of freedom."""
    found = []
    for k in range(len(values)):
        out = np.arange(len(values)) == k
        left, scale, free = without(design, values, out)
        own = design[~out]
        found.append(left[k] / scale / np.sqrt(1.0 + design[k] @ np.linalg.solve(own.T @ own, design[k])))
    return np.array(found), free


def shifted_to(design, values, k, t):
    """The values with point k moved so that its t against all others is t."""
    out = np.arange(len(values)) == k
    left, scale, _ = without(design, values, out)
    own = design[~out]
    width = np.sqrt(1.0 + design[k] @ np.linalg.solve(own.T @ own, design[k]))
    moved = values.copy()
    moved[k] += t * scale * width - left[k]
    return moved


@pytest.mark.parametrize("k", [0, 25, 59])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_stray_point_is_told_at_a_chance_of_a_hundredth_over_all_points(k, sign):
    design = line()
    limit = stats.t.isf(0.5 * 0.01 / 60, 60 - 2 - 1)
    for part, found in ((0.999, False), (1.001, True)):
        values = shifted_to(design, 1e-4 * NOISE, k, sign * part * limit)
        assert t_values(design, values)[0][k] == pytest.approx(sign * part * limit, rel=1e-9)
        expected = (np.arange(60) == k) & found
        residual = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
        np.testing.assert_array_equal(shifted_points(design, values), expected)
        np.testing.assert_array_equal(shifted_points(design, residual), expected)
        np.testing.assert_array_equal(significant(design, residual, np.arange(60) == k), expected)
        np.testing.assert_array_equal(beyond(design, values, np.arange(60) != k), expected)


def test_of_candidates_only_the_significant_stay():
    design, values = line(), 1e-4 * NOISE
    values[[7, 30]] += [0.01, -0.02]
    residual = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    candidates = np.isin(np.arange(60), [3, 7, 30, 44])
    np.testing.assert_array_equal(np.flatnonzero(significant(design, residual, candidates)), [7, 30])
    assert not significant(design, residual, np.zeros(60, bool)).any()


def test_one_stray_point_of_a_fit_with_little_left_is_the_only_one():
    """A robust fit of 17 unknowns to 27 points sets aside far more than can be judged: what a shift explains stands."""
    angle = 2.0 * np.pi * np.arange(27)[:, None] / 27 * np.arange(1, 9)
    design = np.column_stack([np.ones(27), np.cos(angle), np.sin(angle)])
    values = 1e-5 * np.random.default_rng(0).normal(size=27)
    values[3] += 1e-2
    residual = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    assert np.flatnonzero(stray_points(design, residual)).tolist() == [3]


def test_no_more_than_a_tenth_and_one_are_taken():
    """Of 60 points six and one may be stray: of eight, seven are told."""
    design = line()
    for count in (1, 6, 7, 8):
        values = 1e-6 * NOISE
        values[:count] += 0.1 * (-1.0) ** np.arange(count)
        found = np.flatnonzero(shifted_points(design, values))
        assert found.size == min(count, 7)
        assert set(found) <= set(range(count))


def test_exact_points_hide_nothing_below_a_billionth():
    """Round-off of an exact surface is not a stray point, a shift of 2e-9 is."""
    design = line()
    for shift, found in ((0.9e-9, False), (1.2e-9, True)):
        values = np.zeros(60)
        values[20] = shift / np.sqrt(1.0 - design[20] @ np.linalg.solve(design.T @ design, design[20]))
        assert shifted_points(design, values)[20] == found
        assert not shifted_points(design, np.zeros(60)).any()
    values = np.zeros(60)
    values[20] = 1.1e-9
    assert np.flatnonzero(beyond(design, values, np.arange(60) != 20)).tolist() == [20]
    assert not beyond(design, 0.8 * values, np.arange(60) != 20).any()


def test_scans_are_searched_by_a_robust_fit():
    design, values = line(2001), 1e-4 * np.random.default_rng(3).normal(size=2001)
    values[[5, 900]] += [0.01, -0.02]
    np.testing.assert_array_equal(np.flatnonzero(stray_points(design, values)), [5, 900])


def test_bisquare_weights_of_a_mean():
    """Weights (1 - (r/(4.685 s))^2)^2 with s = 1.4826 sqrt(n/(n - 1)) med |r| about their own weighted mean."""
    values = np.concatenate([NOISE[:20], [4.5, -6.0, 30.0]])
    weights = robust_weights(np.ones((23, 1)), values)
    r = np.abs(values - weights @ values / weights.sum())
    u = r / (1.4826 * np.sqrt(23 / 22) * np.median(r))
    np.testing.assert_allclose(weights, np.maximum(1.0 - (u / 4.685) ** 2, 0.0) ** 2, atol=1e-5)
    assert weights[-1] == 0.0


def test_exact_values_keep_their_weights():
    design = line()
    np.testing.assert_array_equal(robust_weights(design, np.zeros(60)), np.ones(60))
    far = np.zeros(60)
    far[3] = 1.0
    np.testing.assert_allclose(robust_weights(design, far), np.arange(60) != 3, atol=1e-12)


def measured(theta, z, value):
    return SurveyPoints(theta=np.asarray(theta), z=np.asarray(z), value=np.asarray(value))


def test_pure_error_is_the_scatter_about_each_place():
    theta = np.radians([10.0, 10.0004, 370.0, 20.0, 20.0, 359.9999, 0.0, 90.0])
    z = [0.1, 0.100004, 0.1, 0.1, 0.10002, 0.2, 0.2, 0.1]
    value = [0.5, 0.501, 0.502, 0.6, 0.7, 0.503, 0.505, 0.9]
    scatter, repeats = pure_error(measured(theta, z, value))
    assert repeats == 3  # two at 10 deg, one at 0; 20 deg stands at two heights
    assert scatter == pytest.approx(np.sqrt((2 * 1e-6 + 2 * 1e-6) / 3), rel=1e-9)
    assert pure_error(measured([0.0, 1.0], [0.0, 0.0], [0.5, 0.5])) == (None, 0)


def twice(apart, turned=0.0):
    """Places measured once and again, each by so much more; the second time turned a little."""
    theta = np.radians(np.arange(len(apart)) * 7.0)
    at, value = np.concatenate([theta, theta - turned]), np.concatenate([0.5 + 0 * theta, 0.5 + apart])
    return measured(at, np.full(len(at), 0.1), value)


def test_an_offset_of_a_second_pass_is_told_from_five_standard_errors_on():
    scatter = 1e-6 * np.tile([1.0, -1.0], 8)  # neighbours differ: no drift
    limit = 5.0 * np.std(scatter, ddof=1) / 4.0
    assert passes_words(twice(scatter + 0.999 * limit)) == ""
    words = passes_words(twice(scatter - 1.001 * limit))
    assert (
        words == f"the second measurements of 16 places differ from the first by {-1.001e6 * limit:+.3g} um on average"
    )


def test_twelve_places_are_needed_and_a_billionth_is_nothing():
    assert passes_words(twice(np.full(11, 1e-6))) == ""
    assert "of 12 places differ from the first by +1 um on average" in passes_words(twice(np.full(12, 1e-6)))
    assert "of 12 places" in passes_words(twice(np.full(12, 1e-6), turned=np.radians(4e-4)))  # 0 and 359.9996 deg
    assert passes_words(twice(np.full(12, 1e-6), turned=np.radians(6e-4))) == ""
    assert passes_words(twice(np.full(12, 0.9e-9))) == ""
    assert passes_words(twice(np.full(12, 1.1e-9))) != ""


def test_a_shape_of_a_second_pass_is_told_by_neighbours_alike():
    wave = np.sin(2.0 * np.pi * np.arange(50) / 50)
    drift = 1.0 - 0.5 * np.mean(np.diff(wave) ** 2) / np.var(wave, ddof=1)
    assert drift * np.sqrt(50) > 5.0
    assert passes_words(twice(1e-6 * wave)).endswith(f"by {np.std(wave, ddof=1):.3g} um, not at random")
    assert passes_words(twice(0.9e-9 * wave)) == ""
    assert passes_words(twice(1e-6 * NOISE[:50])) == ""
    few = np.sin(2.0 * np.pi * np.arange(25) / 25)  # sqrt(25) times less than one
    assert passes_words(twice(1e-6 * few)) == ""


def test_a_third_measurement_is_paired_with_a_fourth():
    """Of three equal passes the third has no partner; of four, the first two make pairs and so do the last two."""
    theta = np.radians(np.arange(12) * 7.0)
    passes = [0.5, 0.5 + 1e-6, 0.5, 0.5 + 1e-6]
    for count, places in ((3, 12), (4, 24)):
        points = measured(np.tile(theta, count), np.full(12 * count, 0.1), np.repeat(passes[:count], 12))
        assert passes_words(points).startswith(f"the second measurements of {places} places")


def test_places_are_ordered_by_height_and_angle():
    """A shape that changes with height: neighbours are alike ring by ring only."""
    rings, steps = 5, np.array([1.0, -1.0, 1.0, -1.0, 1.0])
    theta = np.radians(np.arange(0.0, 360.0, 20.0))
    order = np.random.default_rng(1).permutation(rings * 18)
    at, z = np.tile(theta, rings)[order], np.repeat(0.1 * np.arange(rings), 18)[order]
    apart = 1e-6 * np.repeat(steps, 18)[order] * (1.0 + 0.01 * np.cos(at))
    points = measured(np.tile(at, 2), np.tile(z, 2), np.concatenate([0.5 + 0 * z, 0.5 + apart]))
    assert "not at random" in passes_words(points)


def test_the_largest_gap_closes_the_circle():
    assert largest_gap_deg(np.radians([350.0, 20.0, 200.0])) == pytest.approx(180.0, rel=1e-12)
    assert largest_gap_deg(np.radians([-100.0, 20.0])) == pytest.approx(240.0, rel=1e-12)
    assert largest_gap_deg(np.zeros(1)) == pytest.approx(360.0, rel=1e-12)
