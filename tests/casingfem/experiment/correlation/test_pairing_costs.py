"""What a pairing costs, by hand: confidence, reach, modes skipped, rows left out, members of a doublet."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf

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
