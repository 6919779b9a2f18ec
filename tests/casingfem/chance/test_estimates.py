"""Estimates from draws against distributions that are known: intervals, quantiles, rare events, Sobol indices."""

from functools import cache

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import beta, binom, chi2, norm
from scipy.stats import t as student

import casingfem as cf

CHANCE = 0.1


def rayleigh(u):
    """Splits to first order: of two normal coefficients, half of the square of which is exponential."""
    x, y = ndtri(u[:, 0]), ndtri(u[:, 1])
    return np.hypot(x, y)


def test_points_of_a_draw_do_not_depend_on_the_others():
    together = cf.chance.points(3, range(64), 5)
    assert np.array_equal(np.vstack([cf.chance.points(3, range(k, k + 16), 5) for k in (0, 16, 32, 48)]), together)
    assert not np.array_equal(cf.chance.points(4, range(64), 5), together)


@pytest.mark.campaign
def test_intervals_of_probabilities_contain_the_truth_as_often_as_they_say():
    """93 to 97 % of 200 repetitions, where Clopper's and Pearson's own, for independent draws, are too wide."""
    inside = plain = 0
    for seed in range(200):
        hit = ndtri(cf.chance.points(seed, range(512), 6)).sum(axis=1) / np.sqrt(6.0) > ndtri(1.0 - CHANCE)
        found, wide = cf.chance.probability(hit), cf.chance.clopper_pearson(int(hit.sum()), 512)
        inside += found.low < CHANCE < found.high
        plain += wide.low < CHANCE < wide.high
    assert 186 <= inside <= 194
    assert plain > inside


@cache
def points_of_seeds():
    return [cf.chance.points(seed, range(512), 1)[:, 0] for seed in range(100)]


def test_a_rare_event_that_some_sequences_meet_once_has_the_interval_of_independent_draws():
    """5 of 16 sequences have one of 512 draws each: the rule of even sequences would end at 0.018, not at 0.022."""
    hit = np.zeros(512, dtype=bool)
    hit[:5] = True
    found = cf.chance.probability(hit)
    assert found.value == pytest.approx(5.0 / 512.0)
    assert found.high == pytest.approx(0.0226, rel=0.06)


def in_turn(counts, size):
    """Draws of 16 sequences in turn, with these numbers of hits of `size` draws each."""
    return np.array([[row < count for count in counts] for row in range(size)]).ravel()


@pytest.mark.parametrize("level", [0.95, 0.8])
@pytest.mark.parametrize("more", [1, 7, 15])
@pytest.mark.parametrize(("fewest", "size"), [(1, 4), (3, 5), (2, 4)])
def test_neighbouring_numbers_of_hits_have_the_mid_p_interval_of_the_larger(fewest, more, size, level):
    """At each end the chance of more, or of fewer, than were found, and half of that of as many, is that of a tail."""
    found = cf.chance.probability(in_turn([fewest + (k < more) for k in range(16)], size), level=level)
    assert found.value == pytest.approx((fewest + more / 16.0) / size)
    low, high = found.low * size - fewest, found.high * size - fewest
    tail = 0.5 * (1.0 - level)
    assert binom.sf(more, 16, low) + 0.5 * binom.pmf(more, 16, low) == pytest.approx(tail)
    assert binom.cdf(more - 1, 16, high) + 0.5 * binom.pmf(more, 16, high) == pytest.approx(tail)


@pytest.mark.parametrize(("count", "size"), [(1, 4), (2, 4)])
def test_equal_numbers_of_hits_have_an_interval_as_far_below_as_above(count, size):
    """Half of the chance of none of 16 is 2.5 % at the end: (1 - p)^16 = 0.05."""
    found, reach = cf.chance.probability(in_turn([count] * 16, size)), 1.0 - 0.05 ** (1.0 / 16.0)
    assert found == pytest.approx((count / size, (count - reach) / size, (count + reach) / size))


@pytest.mark.parametrize(
    ("counts", "size"),
    [([0] * 9 + [3] * 7, 5), ([1] * 8 + [3] * 8, 5), ([0] * 15 + [1], 5), ([5, 4] * 8, 5), ([2] * 4 + [0] * 12, 2)],
)
def test_other_numbers_of_hits_are_worth_as_many_independent_draws_as_their_variance_states(counts, size):
    level = 0.9
    found = cf.chance.probability(in_turn(counts, size), level=level)
    means = np.array(counts) / size
    p, variance = means.mean(), means.var(ddof=1) / 16.0
    worth = p * (1.0 - p) / variance * (norm.ppf(0.95) / student.ppf(0.95, 15)) ** 2
    hits = p * worth
    low, high = beta.ppf(0.05, hits, worth - hits + 1.0), beta.ppf(0.95, hits + 1.0, worth - hits)
    assert found == pytest.approx((p, low, high))


def test_few_draws_none_and_all_have_the_interval_of_independent_draws():
    for hit in (np.arange(31) < 9, np.zeros(64, bool), np.ones(64, bool)):
        assert cf.chance.probability(hit) == cf.chance.clopper_pearson(int(hit.sum()), hit.size)
    uneven = np.r_[in_turn([2] * 16, 4), True]  # the first sequence has a draw more
    assert cf.chance.probability(uneven).high - cf.chance.probability(uneven).low < 0.05
    exact = cf.chance.clopper_pearson(3, 20, level=0.9)
    assert binom.sf(2, 20, exact.low) == pytest.approx(0.05)
    assert binom.cdf(3, 20, exact.high) == pytest.approx(0.05)


@pytest.mark.parametrize(("hits", "draws", "level"), [(-1, 5, 0.9), (0, 0, 0.9), (1, 5, 0.0), (1, 5, 1.0)])
def test_hits_are_of_draws_and_a_level_is_between_its_ends(hits, draws, level):
    with pytest.raises(cf.errors.InputError, match="expected 0 <= hits <= draws"):
        cf.chance.clopper_pearson(hits, draws, level=level)
    assert cf.chance.clopper_pearson(5, 5)[0::2] == (1.0, 1.0)


@pytest.mark.parametrize("at", [0.0, 1.0])
def test_a_quantile_lies_between_its_ends(at):
    with pytest.raises(cf.errors.InputError, match=f"found {at:g} of 3 values"):
        cf.chance.quantile(np.arange(3.0), at)
    assert cf.chance.quantile(np.array([7.0]), 0.5) == (7.0, 7.0, 7.0)


@pytest.mark.parametrize(("size", "at", "level"), [(400, 0.1, 0.95), (401, 0.9, 0.8), (40, 0.99, 0.95)])
def test_the_ends_of_a_quantile_are_the_order_statistics_that_contain_it(size, at, level):
    """The numbers of values below the quantile at whose distribution function a tail ends (H. David, 1981, 2.5)."""
    found = cf.chance.quantile(np.random.default_rng(1).permutation(size) * 1.0, at, level=level)
    below = binom.cdf(np.arange(size + 1), size, at)
    low = int(np.argmax(below >= 0.5 * (1.0 - level))) - 1
    high = int(np.argmax(below >= 0.5 * (1.0 + level)))
    assert found == (at * (size - 1), max(low, 0), min(high, size - 1))


@pytest.mark.parametrize("limit", [0.5, 0.507])
def test_an_interval_is_narrow_and_right_where_sequences_have_nearly_the_same_number_of_hits(limit):
    """Half of each sequence is below 0.5: 256 of 512 draws, where independent draws leave +-0.044."""
    found = [cf.chance.probability(points < limit) for points in points_of_seeds()]
    assert sum(each.low <= limit <= each.high for each in found) >= 93
    assert max(each.high - each.low for each in found) < 0.03
    if limit == 0.5:
        assert found[0] == pytest.approx((0.5, 0.5 - 0.1707 / 32.0, 0.5 + 0.1707 / 32.0), abs=1e-5)


def test_quantiles_of_splits_to_first_order_are_those_of_rayleigh():
    splits = rayleigh(cf.chance.points(5, range(4096), 2))
    for at in (0.5, 0.9, 0.99):
        found = cf.chance.quantile(splits, at)
        exact = np.sqrt(-2.0 * np.log(1.0 - at))
        assert found.low < exact < found.high
        assert found.value == pytest.approx(exact, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("response", "threshold"),
    [
        pytest.param(lambda u: u.sum(axis=1) / np.sqrt(20.0), -ndtri(1e-5), marks=pytest.mark.campaign),
        (lambda u: np.hypot(u[:, 0], u[:, 1]), np.sqrt(2.0 * np.log(1e5))),  # all around a circle
        pytest.param(lambda u: np.abs(u[:, 0]), -ndtri(5e-6), marks=pytest.mark.campaign),  # at two places
    ],
)
def test_a_rare_event_is_found_within_a_fifth_of_its_probability(response, threshold):
    """1e-5 by 1e4 evaluations: 9 of 10 single runs, and a variation as each estimates it."""
    found = [cf.chance.subset_simulation(response, 20, threshold, seed=seed) for seed in range(10)]
    chances = np.array([each.probability for each in found])
    assert np.mean([each.runs for each in found]) < 11_000
    assert np.sum(np.abs(chances / 1e-5 - 1.0) <= 0.2) >= 9
    assert chances.mean() == pytest.approx(1e-5, rel=0.1)
    assert chances.std() / chances.mean() == pytest.approx(np.mean([each.variation for each in found]), rel=0.7)


def test_an_event_in_all_directions_is_left_to_the_subsets():
    """Far from the origin of ten numbers: no few directions have a density of their own."""
    found = cf.chance.subset_simulation(lambda u: np.linalg.norm(u, axis=1), 10, np.sqrt(chi2.isf(1e-4, 10)), seed=3)
    assert found.by == "subset"
    assert found.probability == found.subset
    assert found.probability == pytest.approx(1e-4, rel=4.0 * found.variation)


@pytest.mark.slow
def test_sobol_indices_of_ishigami_are_those_of_its_formula():
    """I. Sobol, Y. Levitan, Comput. Phys. Comm. 117, 1999, 52: a = 7, b = 0.1."""

    def results(u):
        x = np.pi * (2.0 * u - 1.0)
        return (np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0]))[:, None]

    groups = {name: slice(k, k + 1) for k, name in enumerate("abc")}
    (rows,) = cf.chance.importance(results, groups, 3, seed=7, size=2048)
    assert [row.first for row in rows] == pytest.approx([0.3139, 0.4424, 0.0], abs=0.02)
    assert [row.total for row in rows] == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.02)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: cf.chance.clopper_pearson(3, 2), "3 hits, 2 draws"),
        (lambda: cf.chance.quantile(np.zeros(0), 0.5), "0 values"),
        (lambda: cf.chance.points(1, range(0, 16), 0), "0 random numbers"),
        (lambda: cf.chance.points(1, range(5, 16), 2), "multiple of 16"),
        (lambda: cf.chance.importance(np.sin, {}, 1, seed=1), "a power of 2 and at least one group"),
        (lambda: cf.chance.subset_simulation(np.sin, 1, 1.0, seed=1, size=10), "100 evaluations"),
    ],
)
def test_what_cannot_be_estimated_is_refused(call, words):
    with pytest.raises(cf.errors.InputError, match=words):
        call()


def test_an_event_that_cannot_happen_ends_as_an_error():
    with pytest.raises(cf.errors.NumericsError, match="the event may be impossible"):
        cf.chance.subset_simulation(lambda u: np.minimum(u[:, 0], 1.0), 2, 2.0, seed=1, size=200)
