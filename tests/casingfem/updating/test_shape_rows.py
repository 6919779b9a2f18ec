"""Which row of a table a measured shape stands for: what is nearly as good another way is refused, nothing else."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.updating.shape_rows import EXACT, SURE, refuse_doubtful, rows_of_shapes

NONE = np.inf


def refused(apart, rows, groups=((0,), (1,))):
    """Whether shapes so far `apart` (shapes, rows) from rows, and given `rows`, are refused; the words."""
    count = len(rows)
    measured = SimpleNamespace(
        freq_hz=100.0 + np.arange(count), error=lambda found, said: cf.errors.InputError(f"{found}; {said}")
    )
    table = SimpleNamespace(
        mode=np.array([1, 2]), freq_hz=np.array([100.0, 101.0]), path="table.csv",
        groups=lambda: [SimpleNamespace(rows=group) for group in groups],
    )  # fmt: skip
    try:
        refuse_doubtful(np.array(apart, dtype=float), np.array(rows), measured, table)
    except cf.errors.InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("by", [1.0 - 1e-6, 1.0 + 1e-6])
def test_another_order_of_two_shapes_is_doubted_up_to_the_sum_that_is_sure(by):
    """Both shapes count: either one's distance to the other's row, beside what they have now."""
    then = by * (SURE * (0.2 + 0.3) + EXACT)
    words = refused([[0.2, 0.25 * then], [0.75 * then, 0.3]], [0, 1])
    assert ("modes 1 and 2 of table.csv, 100 and 101 Hz" in words) == (by < 1.0)


@pytest.mark.parametrize("by", [1.0 - 1e-6, 1.0 + 1e-6])
def test_a_free_row_is_doubted_by_the_shapes_own_distance(by):
    words = refused([[0.2, by * (SURE * 0.2 + EXACT)]], [0])
    assert ("the shape at 100 Hz near modes 1 and 2" in words) == (by < 1.0)


def test_rows_of_one_group_and_rows_out_of_reach_are_no_doubt():
    assert refused([[0.2, 0.2]], [0], groups=((0, 1),)) == ""
    assert refused([[0.2, NONE]], [0]) == ""


@pytest.mark.parametrize("by", [1.0 - 1e-6, 1.0 + 1e-6])
def test_a_second_shape_without_a_row_is_doubted_by_its_distance(by):
    words = refused([[0.2, NONE], [by * (SURE * 0.2 + EXACT), NONE]], [0, -1])
    assert ("two shapes, 100 and 101 Hz, near mode 1 of table.csv; one shape for each row" in words) == (by < 1.0)
    assert refused([[0.2, NONE], [NONE, NONE]], [0, -1]) == ""


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (1e-3, "no shape of a row of t.csv, whose freq_hz is 0.001 times that of the shapes, as of kHz; .* both in Hz"),
        (2.0 * np.pi, "whose freq_hz is 6.283 times that of the shapes, as of rad/s"),
        (1.01, "the nearest has 130.01 Hz, mode 2 of t.csv at 131.3 Hz"),
    ],
)
def test_a_table_in_another_unit_than_its_shapes_is_called_so(factor, words):
    """Some rows have no shape, and some shapes no row."""
    freq = factor * np.array([100.0, 130.0, 150.0, 190.0])
    table = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=1e-3 * freq, path="t.csv")
    shapes = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=[130.01, 150.0, 171.0], values=np.eye(3), points=np.eye(3), directions=np.eye(3)
    )
    with pytest.raises(cf.errors.InputError, match=words):
        rows_of_shapes(shapes, table)
