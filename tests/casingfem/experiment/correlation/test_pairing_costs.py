"""What a pairing costs, by hand: confidence, reach, modes skipped, rows left out, members of a doublet."""

from functools import cache
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.pairing import align, member_of

LN = np.log


def computed(freq, n=-1, doublets=(), **more):
    freq = np.asarray(freq, float)
    return SimpleNamespace(freq=freq, nodal_diameters=np.broadcast_to(n, freq.shape), doublets=doublets, **more)


def measured(freq, n=-1, **more):
    return cf.FrequencyTable.from_arrays(freq_hz=freq, n=n, **{"sigma_hz": 0.1} | more)


def places(pairing):
    return {row: mode for match in pairing.matches for row, mode in zip(match.rows, match.modes, strict=True)}


PAIR = 0.5 * LN((100.0**2 + 102.0**2) / (97.0**2 + 98.0**2))
NEXT = 0.5 * LN((110.0**2 + 111.0**2) / (100.0**2 + 102.0**2))
CONFIDENCE = {
    "another mode": (computed([99.0, 105.0]), measured([100.0]), None, LN(100 / 99), LN(105 / 100)),
    "left out": (computed([99.0]), measured([100.0]), None, LN(100 / 99), LN(1.5)),
    "another doublet": (computed([97.0, 98.0, 110.0, 111.0], 4, ((0, 1), (2, 3))), measured([100.0, 102.0], 4), None,
                        PAIR, NEXT),
    "a doublet left out": (computed([97.0, 98.0], 4, ((0, 1),)), measured([100.0, 102.0], 4), None, PAIR, LN(1.5)),
    "a shape": (computed([99.0, 105.0]), measured([100.0]), [[0.8, 0.3]], LN(100 / 99) + 0.2, LN(105 / 100) + 0.7),
    "a shape left out": (computed([99.0]), measured([100.0]), [[0.8]], LN(100 / 99) + 0.2, LN(1.5) + 0.5),
    "a plane": (computed([99.0, 99.0], 2, ((0, 1),)), measured([100.0], 2), [[0.5, 0.2]], LN(100 / 99) + 0.3,
                LN(1.5) + 0.5),
    "two in a plane": (computed([97.0, 98.0], 4, ((0, 1),)), measured([100.0, 102.0], 4), [[0.5, 0.2], [0.1, 0.6]],
                       PAIR + 0.3, LN(1.5) + 0.5),
    "more than one": (computed([99.0, 99.0], 2, ((0, 1),)), measured([100.0], 2), [[0.7, 0.5]], LN(100 / 99),
                      LN(1.5) + 0.5),
}  # fmt: skip


@pytest.mark.parametrize("case", CONFIDENCE)
def test_confidence_is_one_less_the_cost_over_that_of_the_next_best(case):
    modes, table, shapes, best, second = CONFIDENCE[case]
    (match,) = cf.correlation.pair(modes, table, shape_mac=shapes).matches
    assert match.modes == tuple(range(len(table)))
    assert match.confidence == pytest.approx(1.0 - best / second, rel=1e-12)


def test_a_match_that_is_no_better_than_another_has_no_confidence():
    (match,) = cf.correlation.pair(computed([100.0, 100.0]), measured([100.0])).matches
    assert match.confidence == 0.0


@pytest.mark.parametrize(("freq", "found"), [(149.9, 1), (150.1, 0), (66.8, 1), (66.5, 0)])
@pytest.mark.parametrize("n", [-1, 3])
def test_a_row_pairs_within_half_of_the_computed_frequency(freq, found, n):
    assert len(cf.correlation.pair(computed([100.0], n), measured([freq], n)).matches) == found


@pytest.mark.parametrize(("worth", "found"), [(0.41, 1), (0.39, 0)])
def test_with_shapes_a_row_is_left_out_where_its_likeness_is_half_beyond_the_reach(worth, found):
    """ln 1.1 + 1 - MAC against ln 1.1 + .6, at a reach of 1.1 e^.1 - 1."""
    reach = 1.1 * np.exp(0.1) - 1.0
    assert (
        len(cf.correlation.pair(computed([100.0]), measured([110.0]), reach=reach, shape_mac=[[worth]]).matches)
        == found
    )


@pytest.mark.parametrize("n", [-1, 3])
@pytest.mark.parametrize(("freq", "mode"), [(102.1, 0), (102.6, 1)])
def test_a_mode_skipped_costs_two_hundredths(freq, mode, n):
    """|ln| to 100 Hz is .0208 or .0257, to 103 Hz .0088 or .0039 and the .02 of a mode left out below."""
    assert places(cf.correlation.pair(computed([100.0, 103.0], n), measured([freq], n))) == {0: mode}


def test_a_member_of_a_doublet_is_skipped_for_nothing_by_a_row_without_label():
    modes = computed([100.0, 100.4], 5, ((0, 1),))
    assert places(cf.correlation.pair(modes, measured([100.4]))) == {0: 1}


@pytest.mark.parametrize("n", [-1, 3])
@pytest.mark.parametrize(("count", "shift"), [(3, 0), (4, 1)])
def test_a_row_is_left_out_where_that_saves_three_reaches(count, shift, n):
    """Each row a step of e^.378 below its mode, or above the mode before: ln 1.5 thrice is 1.216, between 3 and 4."""
    steps = 100.0 * np.exp(0.378 * np.arange(count + 1))
    found = places(cf.correlation.pair(computed(steps[1:], n), measured(steps[:-1], n)))
    assert found == {row: row - shift for row in range(shift, count)}


def test_of_members_alike_in_all_else_the_one_whose_shape_it_is_takes_the_row():
    modes = computed([100.0, 100.0, 120.0], -1, ((0, 1),))
    assert places(cf.correlation.pair(modes, measured([101.0]), shape_mac=[[0.3, 0.6, 0.0]])) == {0: 1}
    assert places(cf.correlation.pair(modes, measured([101.0]), shape_mac=[[0.6, 0.3, 0.0]])) == {0: 0}


def test_a_match_lists_its_rows_by_frequency_and_has_the_label_of_either_side():
    found = cf.correlation.pair(computed([99.0, 99.5], -1, ((0, 1),)), measured([101.0, 100.0, 300.0], [4, 4, -1]))
    (match,) = found.matches
    assert (match.rows, match.modes, match.n) == ((1, 0), (0, 1), 4)
    assert (match.measured_hz, match.computed_hz) == ((100.0, 101.0), (99.0, 99.5))
    assert (found.unpaired_rows, found.unpaired_modes) == ((2,), ())


TURNED = {  # sigma, n, the row's angle, the member taken; the second is nearer in frequency
    "clear": (0.1, 4, 6.0, 0), "clear, a period on": (0.1, 4, 51.0, 0),
    "the other": (0.1, 4, 27.0, 1), "split by more than ten sigma": (0.39, 4, 6.0, 0),
    "split by less": (0.41, 4, 6.0, 1), "less than twice as near": (0.1, 4, 12.6, 1),
    "more than twice as near": (0.1, 4, 12.4, 0), "unknown": (0.1, 4, np.nan, 1), "without label": (0.1, -1, 6.0, 1),
    "n of 1": (0.1, 1, 185.0, 0),
}  # fmt: skip


@pytest.mark.parametrize("case", TURNED)
def test_a_row_is_the_member_of_its_angle_where_that_is_clear_else_the_nearer(case):
    sigma, n, angle, member = TURNED[case]
    turned = [5.0, 27.5] if n != 1 else [5.0, 95.0]
    modes = computed([100.0, 104.0], n, ((0, 1),), angle_deg=np.array(turned))
    table = measured([103.0], n, sigma_hz=sigma, angle_deg=[angle])
    assert member_of((0, 1), modes, table, 0) == member


@pytest.mark.parametrize(("freq", "member"), [(101.0, 0), (103.0, 1), (102.0, 0)])
def test_without_computed_angles_the_nearer_member_is_taken(freq, member):
    table = measured([freq], 4, angle_deg=[6.0])
    assert member_of((0, 1), computed([100.0, 104.0], 4), table, 0) == member
    unknown = computed([100.0, 104.0], 4, angle_deg=np.array([27.5, np.nan]))
    assert member_of((0, 1), unknown, table, 0) == member


def all_ways(groups, slots, cost, left_out, skipped):
    """The least price of all ways to use up groups and slots from their ends."""

    @cache
    def least(g, s):
        if g == 0:
            return sum(skipped[:s])
        ways = [least(g - 1, s) + left_out * len(groups[g - 1])]
        if s:
            rows, modes = groups[g - 1], slots[s - 1]
            ways.append(least(g, s - 1) + skipped[s - 1])
            if len(rows) <= len(modes):
                ways.append(least(g - 1, s - 1) + cost(rows, modes))
            else:
                ways += [least(g - 1, s - 1) + cost((row,), modes) + left_out for row in rows]
            if g > 1 and len(modes) == 2 and len(rows) == len(groups[g - 2]) == 1:
                both = cost(groups[g - 2], modes[:1]) + cost(rows, modes[1:])
                ways.append(least(g - 2, s - 1) + both)
            if s > 1 and len(rows) == 2 and len(modes) == len(slots[s - 2]) == 1:
                ways.append(least(g - 1, s - 2) + cost(rows, slots[s - 2] + modes))
        return min(ways)

    return min(least(len(groups), s) for s in range(len(slots) + 1))


def grouped(sizes):
    """Consecutive indices in groups of these sizes."""
    ends = np.cumsum([0, *sizes]).tolist()
    return [tuple(range(low, high)) for low, high in pairwise(ends)]


@pytest.mark.parametrize("seed", range(40))
def test_doublets_and_single_ones_are_aligned_as_cheaply_as_can_be(seed):
    rng = np.random.default_rng(seed)
    groups, slots = (grouped(rng.integers(1, 3, rng.integers(1, 5)).tolist()) for _ in range(2))
    target, freq = (np.sort(rng.uniform(1.0, 3.0, 9)) for _ in range(2))
    skipped, left_out = rng.uniform(0.0, 0.2, len(slots)).tolist(), 0.3

    def cost(rows, modes):
        of_rows, of_modes = target[list(rows)], freq[list(modes)]
        return len(rows) * abs(float(of_rows.mean() - of_modes.mean())) + 0.01 * (len(modes) - len(rows))

    found = align(groups, slots, cost, left_out=left_out, skipped=skipped)
    price = 0.0
    for rows, modes in found:
        alone = len(rows) == 2 and rows not in groups
        price += sum(cost((r,), (m,)) for r, m in zip(rows, modes, strict=True)) if alone else cost(rows, modes)
    used_rows = [row for rows, _ in found for row in rows]
    used = [k for k, slot in enumerate(slots) if any(set(slot) & set(modes) for _, modes in found)]
    price += left_out * (sum(map(len, groups)) - len(used_rows))
    price += sum(skipped[k] for k in range(max(used, default=-1)) if k not in used)
    assert used_rows == sorted(set(used_rows))
    assert price == pytest.approx(all_ways(groups, slots, cost, left_out, skipped), rel=1e-12)


def test_two_single_rows_fill_a_doublet_and_a_measured_one_two_single_modes():
    def cost(rows, modes):
        return 0.0

    both = [((0, 1), (0, 1))]
    assert align([(0,), (1,)], [(0, 1)], cost, left_out=1.0, skipped=[0.0]) == both
    assert align([(0, 1)], [(0,), (1,)], cost, left_out=1.0, skipped=[0.0, 0.0]) == both
    assert align([(0, 1)], [(0,)], cost, left_out=1.0, skipped=[0.0]) in ([((0,), (0,))], [((1,), (0,))])
