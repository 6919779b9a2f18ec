"""Where a band is cut, how a slice is searched, and when a static solution balances: by hand."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.linalg import factor as factors
from casingfem.linalg import slicing
from casingfem.linalg.factor import BALANCE, canonical, factorise, solve_held
from casingfem.linalg.krylov import RitzPairs
from casingfem.linalg.pencil import make_pencil
from casingfem.linalg.slicing import Counter, End, Slice, around_middle, slices, solve_slice


def pencil_of(values):
    return make_pencil(csc_array(np.diag(np.asarray(values, float))), np.ones(len(values)))


@pytest.mark.parametrize(("place", "width"), [(4.0, 4e-7), (-4.0, 4e-7), (0.02, 3e-9), (-0.02, 3e-9), (0.03, 3e-9)])
def test_how_near_is_on_an_end_goes_by_its_size_or_the_floor(place, width):
    counter = Counter(pencil_of([1.0]), 0.03, "superlu")
    assert counter.width(place) == pytest.approx(width, rel=1e-12)
    assert counter.width(place, 0.5) == pytest.approx(5e6 * width, rel=1e-12)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_an_end_is_counted_a_width_outwards_or_two(way):
    counter = Counter(pencil_of([1.0, 2.0, 3.0]), 0.01, "superlu")
    assert counter.counted(2.0, way) == End(2.0 + way * 2e-7, 2 if way > 0.0 else 1)
    met = Counter(pencil_of([1.0, 2.0 + way * 2e-7, 3.0]), 0.01, "superlu")
    assert met.counted(2.0, way) == End(2.0 + way * 4e-7, 2 if way > 0.0 else 1)


def cut(monkeypatch, values, low, high, most, shift=-0.01, reach=0.0):
    """The ends of the slices of a band; each reaches a little beyond its end."""
    pairs = []

    def solved(counter, start, end):
        pairs.append((start, end))
        high = end.place + reach
        return Slice(start.place, high, np.zeros(0), np.zeros((0, 0)), 0, counter.pencil.count_below(high), True)

    monkeypatch.setattr(slicing, "MANY", most)
    monkeypatch.setattr(slicing, "solve_slice", solved)
    made = list(slices(pencil_of(values), low, high, shift, "superlu"))
    assert len(made) == len(pairs)
    for (_, before), (after, _) in pairwise(pairs):
        assert after.place == before.place + reach
        assert after.settled
    return pairs


def test_a_band_from_zero_starts_below_all_modes_and_is_cut_at_half_its_frequency(monkeypatch):
    pairs = cut(monkeypatch, np.arange(1.0, 101.0) - 0.5, 0.0, 100.0, 31)
    assert pairs[0][0] == End(-0.01, 0, settled=True)
    np.testing.assert_allclose([end.place for _, end in pairs], [25.0, 56.25, 76.5625, 100.0], rtol=1e-6)
    assert [end.below for _, end in pairs] == [25, 56, 77, 100]


def test_a_band_starts_a_little_below_its_lower_end(monkeypatch):
    values = np.r_[np.arange(1.0, 101.0) - 0.5, 4.0, 100.0]
    pairs = cut(monkeypatch, values, 4.0, 100.0, 50)
    start, last = pairs[0][0], pairs[-1][1]
    assert (start.below, last.below) == (4, 102)
    assert start.place == pytest.approx(4.0 * (1.0 - 1e-7), rel=1e-12)
    assert last.place == pytest.approx(100.0 * (1.0 + 1e-7), rel=1e-12)
    np.testing.assert_allclose([end.place for _, end in pairs], [36.0, 64.0, 100.0], rtol=1e-6)
    assert len(cut(monkeypatch, values, 4.0, 100.0, 98)) == 1  # as many as one slice may hold
    assert len(cut(monkeypatch, values, 4.0, 100.0, 97)) == 2


@pytest.mark.parametrize(("high", "count"), [(100.0999, 1), (100.1003, 2)])
def test_a_slice_a_thousandth_wide_is_not_cut(monkeypatch, high, count):
    values = np.linspace(100.01, 100.09, 9)
    assert len(cut(monkeypatch, values, 100.0, high, 8)) == count


def test_an_end_that_the_last_slice_passed_is_dropped(monkeypatch):
    """The second slice reaches from 49 past the end of the band."""
    values = np.arange(1.0, 65.0) - 0.5
    for reach, ends in ((0.0, [16.0, 36.0, 49.0, 64.0]), (20.0, [16.0, 49.0])):
        pairs = cut(monkeypatch, values, 0.0, 64.0, 20, reach=reach)
        np.testing.assert_allclose([end.place for _, end in pairs], ends, rtol=1e-6)


def recorded(monkeypatch, change=lambda found: found):
    calls = []

    def search(pencil, solve, sigma, wanted, block):
        calls.append((sigma, wanted, block))
        order = np.argsort(np.abs(pencil.A.diagonal() - sigma), kind="stable")[:wanted]
        return change(RitzPairs(pencil.A.diagonal()[order], np.eye(pencil.size)[:, order], 10 * wanted))

    monkeypatch.setattr(slicing, "nearest", search)
    return calls


def test_more_pairs_are_asked_for_until_they_reach_beyond_both_ends(monkeypatch):
    """Four beyond those counted, then half as many more, or eight; never more than there are modes."""
    calls = recorded(monkeypatch)
    counter = Counter(pencil_of(np.arange(1.0, 61.0)), 0.01, "superlu")
    found = around_middle(counter, End(3.4, 7), End(44.4, 7), 8, 1e-7)
    assert [wanted for _, wanted, _ in calls] == [4, 12, 20, 30, 45]
    assert {(round(sigma, 9), block) for sigma, _, block in calls} == {(23.9, 8)}
    assert found.products == 10 * (4 + 12 + 20 + 30 + 45)
    assert len(found.values) == 45
    calls.clear()
    around_middle(counter, End(3.4, 0), End(44.4, 40), 32, 1e-7)
    assert calls == [(pytest.approx(23.9), 44, 32)]  # 24 +- 22 reaches beyond
    calls.clear()
    around_middle(counter, End(0.4, 0), End(90.4, 70), 8, 1e-7)
    assert [wanted for _, wanted, _ in calls] == [60]


@pytest.mark.parametrize(("clear", "count"), [(1e-7, 8), (0.06, 8), (0.08, 16)])
def test_pairs_must_reach_ten_widths_beyond_the_ends(monkeypatch, clear, count):
    """From 10 the pairs reach by 4 to 14: the ends at 9 and 11 have widths of 11 times `clear`."""
    calls = recorded(monkeypatch)
    counter = Counter(
        pencil_of(np.r_[10.3, 10.5, 9.0, 8.0, 2.0, 2.2, 2.25, 2.3, np.arange(30.0, 60.0)]), 0.01, "superlu"
    )
    around_middle(counter, End(9.1, 0), End(10.9, 4), 8, clear)
    assert [wanted for _, wanted, _ in calls] == ([8] if count == 8 else [8, 16])


def test_a_shift_that_drowns_the_others_is_left_for_the_next(monkeypatch):
    """Nearer than a ten-millionth of the radius: 10 from 0 to 20, then 9.4."""
    for off, shifts in ((0.9e-6, [10.0, 9.4]), (1.1e-6, [10.0])):
        calls = recorded(monkeypatch)
        counter = Counter(pencil_of([10.0 + off, 1.0, 3.0, 5.0, 15.0, 25.0]), 0.01, "superlu")
        around_middle(counter, End(0.0, 0), End(20.0, 5), 8, 1e-7)
        np.testing.assert_allclose([sigma for sigma, *_ in calls], shifts, rtol=1e-12)


def test_a_slice_that_misses_a_mode_is_searched_again_with_larger_blocks(monkeypatch):
    """Blocks of 8, 32 and 128; what all searches multiplied is told."""
    calls = []

    def missing(found):
        few = slice(1, None) if len(calls) < 3 else slice(None)
        return RitzPairs(found.values[few], found.vectors[:, few], found.products)

    calls = recorded(monkeypatch, missing)
    counter = Counter(pencil_of(np.arange(1.0, 31.0)), 0.01, "superlu")
    part = solve_slice(counter, counter.counted(3.5, -1.0), counter.counted(8.4, 1.0))
    assert [block for *_, block in calls] == [8, 32, 128]
    assert part.values.tolist() == [4.0, 5.0, 6.0, 7.0, 8.0]
    assert part.vectors.T.argmax(axis=1).tolist() == [3, 4, 5, 6, 7]
    assert (part.below, part.counted, part.products) == (8, True, 10 * sum(wanted for _, wanted, _ in calls))
    assert (part.low, part.high) == (pytest.approx(3.5, rel=2e-7), pytest.approx(8.4, rel=2e-7))


class Off:
    """A factorisation whose solutions are too large by a share."""

    def __init__(self, K, by):
        self.K, self.by = K.toarray(), by

    def solve(self, f):
        return (1.0 + self.by) * np.linalg.solve(self.K, f)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("by", [0.0, 0.99 * BALANCE, -0.99 * BALANCE, 1.01 * BALANCE, -1.01 * BALANCE])
def test_strain_is_the_work_done_to_a_thousandth(monkeypatch, sign, by):
    """Too large by e, the work is 1 + e and the strain (1 + e)^2."""
    K = csc_array(sign * np.array([[2.0, -1.0], [-1.0, 3.0]]))
    f = np.array([1.0, 4.0])
    monkeypatch.setattr(factors, "factorise", lambda K: Off(K, by))
    if abs(by) < BALANCE:
        np.testing.assert_allclose(solve_held(K, f), (1.0 + by) * np.linalg.solve(K.toarray(), f), rtol=1e-12)
    else:
        with pytest.raises(cf.errors.ModelError, match=r"J of strain for .* J of work.*\[static-loose\]"):
            solve_held(K, f)


def test_entries_in_order_are_taken_as_they_are_and_others_copied():
    tidy = csc_array(np.array([[1.0, 2.0], [0.0, 3.0]]))
    assert canonical(tidy) is tidy
    twice = csc_array((np.array([1.0, 2.0, 4.0]), np.array([1, 0, 1]), np.array([0, 3, 3])), shape=(2, 2))
    assert canonical(twice).data.tolist() == [2.0, 5.0]
    assert twice.data.tolist() == [1.0, 2.0, 4.0]


@pytest.mark.parametrize("direct", ["multifrontal", "superlu"])
def test_solutions_are_kept_unless_said_otherwise(direct):
    A = csc_array(np.diag([2.0, -4.0, 5.0]))
    factor = factorise(A, direct)
    assert factor.solve(np.ones(3)).tolist() == [0.5, -0.25, 0.2]
    assert factor.negative() == 1
    assert factorise(A, direct, keep=False).negative() == 1
    if direct == "multifrontal":
        assert factorise(A, keep=False).steps == ()
    with pytest.raises(cf.errors.NumericsError, match="singular"):
        factorise(csc_array(np.zeros((2, 2))), direct)
