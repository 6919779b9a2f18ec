"""Mean shifts: the algebra of sets of wrong rows, and the bounds from which one counts, against brute force."""

from itertools import combinations

import numpy as np
import pytest
from scipy.stats import t as student

import casingfem as cf
from casingfem.experiment.correlation.matches import Match
from casingfem.updating.outliers import (
    Found,
    Shift,
    beside,
    grown,
    outlying,
    projected,
    shifts_of,
    solved,
    step_without,
    strongest,
)
from casingfem.updating.targets import values
from tests.casingfem.updating.test_pairs_by_hand import pair_of_modes

FIRST = np.eye(12)[:, :1]  # a parameter that only the first residual feels


def units(count, first=1):
    """A shift of its own for each residual but the first ones."""
    return [Shift("frequency", (k,), -2.0 * np.eye(12)[k]) for k in range(first, first + count)]


def chi_square(columns, r):
    """What least squares leave."""
    return np.sum((r + columns @ np.linalg.lstsq(columns, -r, rcond=None)[0]) ** 2)


def test_shifts_of_a_set_are_those_of_least_squares():
    rng = np.random.default_rng(2)
    U, r = rng.standard_normal((9, 3)) * [1.0, 50.0, 0.02], rng.standard_normal(9)
    delta, spread, left = solved(U, r)
    np.testing.assert_allclose(delta, np.linalg.lstsq(U, -r, rcond=None)[0], rtol=1e-9)
    np.testing.assert_allclose(spread, np.sqrt(np.diag(np.linalg.inv(U.T @ U))), rtol=1e-9)
    assert left == pytest.approx(chi_square(U, r), rel=1e-9)


@pytest.mark.parametrize("apart", [0.9e-8, 1.1e-8])
def test_shifts_that_are_all_but_the_same_cannot_be_told_apart(apart):
    """The correlation matrix of two columns at an angle has the eigenvalues 1 - cos and 1 + cos."""
    c = 1.0 - apart
    U = np.array([[3.0, 0.7 * c], [0.0, 0.7 * np.sqrt(1.0 - c**2)]])
    delta, spread, left = solved(U, np.array([1.0, 2.0]))
    assert np.isinf(left) == (apart < 1e-8)
    if apart < 1e-8:
        assert delta.tolist() == [0.0, 0.0]
        assert spread.tolist() == [1.0, 1.0]


def test_the_next_shift_is_the_one_that_lowers_chi_square_most_beside_the_others():
    rng = np.random.default_rng(4)
    U, r = rng.standard_normal((8, 6)) * [1.0, 5.0, 0.1, 1.0, 2.0, 9.0], rng.standard_normal(8)
    for rest in ([], [1], [4, 0]):
        usable = [0, 1, 2, 4, 5]
        left = {k: chi_square(U[:, [*rest, k]], r) for k in usable if k not in rest}
        assert beside(rest, U, r, usable) == [min(left, key=left.get)]


@pytest.mark.parametrize(("square", "found"), [(0.9e-8, []), (1.1e-8, [1])])
def test_a_shift_within_the_span_of_the_others_lowers_nothing(square, found):
    U = np.array([[1.0, np.sqrt(1.0 - square)], [0.0, np.sqrt(square)]]) * [2.0, 3.0]
    assert beside([0], U, np.array([1.0, 1.0]), [0, 1]) == found


def test_of_shifts_one_of_which_is_made_by_the_others_another_is_taken():
    """The second is the first once more; the third lowers chi^2 by very little."""
    U = np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    assert beside([0], U, np.array([1.0, 1e-3, 1.0]), [0, 1, 2]) == [2]


def test_a_set_grows_to_the_best_of_its_size_whatever_it_began_with():
    rng = np.random.default_rng(7)
    U = rng.standard_normal((10, 6))
    r = 5.0 * (U[:, 2] - U[:, 5]) + 0.1 * rng.standard_normal(10)
    best = min(combinations(range(6), 2), key=lambda set_: chi_square(U[:, set_], r))
    for begun in range(6):
        assert sorted(grown([begun], U, r, range(6))) == list(best)


def test_what_the_parameters_make_is_taken_from_shifts_and_residuals():
    """One direction of two parameters that do the same; one shift that the parameters swallow."""
    rng = np.random.default_rng(9)
    J = rng.standard_normal((6, 2))
    u = [J @ [2.0, -1.0], *rng.standard_normal((2, 4))]  # the last two rows are those of priors
    r = rng.standard_normal(6)
    shifts = [Shift("frequency", (k,), change) for k, change in enumerate(u)]
    away, left, usable = projected(shifts, r, np.column_stack([J, J[:, 0] - 3.0 * J[:, 1]]))
    P = np.eye(6) - J @ np.linalg.solve(J.T @ J, J.T)
    np.testing.assert_allclose(left, P @ r, atol=1e-12)
    expected = np.column_stack([P @ u[0], P @ np.append(u[1], [0.0, 0.0]), P @ np.append(u[2], [0.0, 0.0])])
    np.testing.assert_allclose(away, expected, atol=1e-12)
    assert usable == [1, 2]


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_parameters_that_the_residuals_hardly_feel_are_none(scale):
    J = scale * np.array([[1.0, 0.0], [0.0, 0.9e-12], [0.0, 0.0]])
    shifts = [Shift("frequency", (0,), np.array([0.0, 1.0, 1.0]))]
    r = np.array([5.0, 6.0, 7.0])
    np.testing.assert_allclose(projected(shifts, r, J)[1], [0.0, 6.0, 7.0], atol=1e-12)
    np.testing.assert_allclose(projected(shifts, r, 1.2 * J * [1.0, 1.2])[1], [0.0, 0.0, 7.0], atol=1e-12)


@pytest.mark.parametrize(("part", "usable"), [(0.9e-6, []), (1.1e-6, [0])])
def test_a_shift_counts_by_what_the_parameters_leave_of_it(part, usable):
    shifts = [Shift("frequency", (0,), 4.0 * np.array([np.sqrt(1.0 - part**2), part]))]
    assert projected(shifts, np.ones(2), np.array([[1.0], [0.0]]))[2] == usable


def test_the_strongest_shift_has_the_sign_of_what_was_added_to_the_table():
    shifts = [Shift("frequency", (4,), np.array([-0.5, 0.0])), Shift("split", (5, 6), np.array([0.0, -2.0]))]
    for r in (3.0, -3.0):
        found = strongest(shifts, np.array([0.1, r]), np.zeros((2, 1)))
        assert found == Found("split", (5, 6), pytest.approx(-0.5 * r), pytest.approx(3.0))


@pytest.mark.parametrize("J", [np.eye(2), np.array([[2.0, 1.0], [0.3, 1.0]])])
def test_of_shifts_that_the_parameters_swallow_the_largest_residual_is_the_strongest(J):
    """As many parameters as residuals: it was an error, or left to round-off."""
    shifts = [Shift("frequency", (k,), -np.eye(2)[k]) for k in (0, 1)]
    found = strongest(shifts, np.array([0.3, -0.2]), J)
    assert found == Found("frequency", (0,), pytest.approx(-0.3), pytest.approx(0.3))


@pytest.mark.parametrize("scatter", [0.0, 0.5, 3.0])
@pytest.mark.parametrize("by", [0.999, 1.001])
def test_a_shift_is_significant_by_students_t_over_the_number_of_shifts(scatter, by):
    """Of 7 shifts; 12 residuals less a parameter and a shift; in stated sigma where the scatter is smaller."""
    r = np.zeros(12)
    r[8:] = scatter * np.sqrt(10.0 / 4.0) * np.array([1.0, -1.0, 1.0, -1.0])  # chi^2/10 = scatter^2
    deviation = by * student.isf(0.01 / 7.0 / 2.0, 10)
    r[3] = -deviation * max(scatter, 1.0)
    found = outlying(units(7), r, FIRST, 5)
    assert [one.rows for one in found] == ([(3,)] if by > 1.0 else [])
    for one in found:
        assert one.shift == pytest.approx(-0.5 * r[3], rel=1e-12) == pytest.approx(0.5 * abs(r[3]), rel=1e-12)
        assert one.deviation == pytest.approx(deviation, rel=1e-12)


@pytest.mark.parametrize(("rows", "named"), [(3, [(2,)]), (9, [(2,)]), (10, [(2,), (6,)]), (14, [(2,), (6,)])])
def test_one_row_of_five_may_be_wrong_and_one_at_least(rows, named):
    r = np.zeros(12)
    r[[2, 6, 7]] = 1e9, 1e6, 1e3
    assert [one.rows for one in outlying(units(9), r, FIRST, rows)] == named


@pytest.mark.parametrize(("unfelt", "found"), [(7, True), (8, False)])
def test_three_degrees_of_freedom_are_left(unfelt, found):
    """12 residuals less the parameters and one shift."""
    r = np.zeros(12)
    r[11] = 1e6
    J = np.eye(12)[:, : unfelt + 1]
    assert bool(outlying(units(12 - unfelt - 1, unfelt + 1), r, J, 12)) is found


def test_there_are_fewer_wrong_rows_than_rows_that_may_be():
    """Both of two can hardly contradict the rest."""
    r = np.zeros(12)
    r[[1, 2]] = 1e9, 1e6
    assert [one.rows for one in outlying(units(2), r, FIRST, 12)] == [(1,)]
    assert [one.rows for one in outlying(units(3), r, FIRST, 12)] == [(1,), (2,)]


def test_the_step_without_what_was_found_is_least_squares_beside_its_shifts():
    """A column for each shift, zero in the rows of priors; one parameter is not felt at all and stays."""
    rng = np.random.default_rng(12)
    J, r = rng.standard_normal((7, 3)), rng.standard_normal(7)
    J[:, 1] = 0.0
    shifts = [Shift(kind, (3, 4), rng.standard_normal(5)) for kind in ("frequency", "split", "orientation")]
    found = [Found("orientation", (3, 4), 1.0, 9.0), Found("split", (3, 4), 1.0, 9.0)]
    columns = np.column_stack([J[:, [0, 2]], *(np.append(shifts[k].change, [0.0, 0.0]) for k in (2, 1))])
    step = np.linalg.lstsq(columns, -r, rcond=None)[0]
    np.testing.assert_allclose(step_without(found, shifts, r, J), [step[0], 0.0, step[1]], rtol=1e-9, atol=1e-15)


def test_changes_of_a_table_are_the_slopes_of_its_residuals():
    """By a frequency, by a split at a mean that stays, by both angles; against larger differences."""
    modes = pair_of_modes()
    matches = [
        Match(rows=(0,), modes=(0,), n=-1, confidence=1.0, measured_hz=(101.0,), computed_hz=(100.0,)),
        Match(rows=(2, 1), modes=(1, 2), n=3, confidence=1.0, measured_hz=(301.0, 306.0), computed_hz=(300.0, 304.0)),
    ]
    table = cf.FrequencyTable.from_arrays(
        freq_hz=[101.0, 306.0, 301.0], sigma_hz=[0.1, 0.2, 0.3], n=[-1, 3, 3], angle_deg=[np.nan, np.nan, 12.0]
    )

    def moved(freq=(0.0, 0.0, 0.0), angle=0.0):
        other = cf.FrequencyTable.from_arrays(
            freq_hz=table.freq_hz + freq, sigma_hz=table.sigma_hz, n=table.n, angle_deg=table.angle_deg + angle
        )
        return values(modes, other, matches)

    ways = {
        ("frequency", (0,)): {"freq": np.array([1.0, 0.0, 0.0])},
        ("frequency", (1,)): {"freq": np.array([0.0, 1.0, 0.0])},
        ("frequency", (2,)): {"freq": np.array([0.0, 0.0, 1.0])},
        ("split", (2, 1)): {"freq": np.array([0.0, 0.5, -0.5])},
        ("orientation", (2, 1)): {"angle": 1.0},
    }
    found = shifts_of(modes, table, matches)
    assert {(shift.kind, shift.rows) for shift in found} == set(ways)
    for shift in found:
        way = ways[shift.kind, shift.rows]
        ahead, behind = (moved(**{k: h * v for k, v in way.items()}) for h in (1e-3, -1e-3))
        slope = (ahead - behind) / 2e-3
        np.testing.assert_allclose(shift.change, slope, atol=1e-4 * np.abs(slope).max(), err_msg=shift.kind)
