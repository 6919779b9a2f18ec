"""What the table of a bundle says of each field of a NamedTuple."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import types

from contact.jit.bundle import Bundle, array_type, bundle_type, bundled


class Inner(NamedTuple):
    count: int
    values: np.ndarray


class Outer(NamedTuple):
    matrix: np.ndarray
    step: float
    on: bool
    inner: Inner
    whole: np.ndarray
    last: int


def made():
    matrix = np.arange(24.0).reshape(4, 6)[:, ::2]
    return Outer(matrix, -0.3, True, Inner(5, np.arange(3.0)), np.arange(4), -7)


def test_fields_stand_one_after_the_other_by_what_they_are():
    given = made()
    bundle = bundled(given)
    table, inner = bundle.table.tolist(), bundle.held[1]
    assert bundle.held[0] is given
    assert table[:6] == [12, given.matrix.__array_interface__["data"][0], 4, 3, 48, 16]
    assert np.array(table[6:7]).view(np.float64)[0] == -0.3
    assert table[7:9] == [1, inner.address]
    assert table[9:13] == [4, given.whole.__array_interface__["data"][0], 4, 8]
    assert table[13:] == [-7]
    assert inner.table.tolist() == [5, 3, given.inner.values.__array_interface__["data"][0], 3, 8]
    assert bundle.address == bundle.table.__array_interface__["data"][0]
    assert bundle.kind.begin == {"matrix": 0, "step": 6, "on": 7, "inner": 8, "whole": 9, "last": 13}
    assert inner.kind.begin == {"count": 0, "values": 1}


def test_types_of_fields_are_numba_s_and_those_of_one_class_are_made_once():
    first, again = Bundle(made()), Bundle(made())
    assert first.kind is again.kind
    fields = first.kind.fields
    assert fields["matrix"] == types.Array(types.float64, 2, "A")
    assert fields["whole"] == types.Array(types.int64, 1, "C")
    assert (fields["step"], fields["on"], fields["last"]) == (types.float64, types.boolean, types.int64)
    assert fields["inner"] is Bundle(made().inner).kind
    assert first.kind.literal_type is first.kind
    assert bundle_type(Inner, [types.int64, array_type(np.zeros(2))]) is fields["inner"]
    assert bundle_type(Inner, [types.float64, array_type(np.zeros(2))]) is not fields["inner"]


@pytest.mark.parametrize("on", [False, np.bool_(True), np.bool_(False)])
def test_truth_is_told_from_numbers(on):
    bundle = Bundle(made()._replace(on=on))
    assert bundle.kind.fields["on"] == types.boolean
    assert bundle.table[7] == int(on)


def test_what_is_no_named_tuple_is_passed_as_it_is():
    for value in (3, (1, 2), np.zeros(2), None):
        assert bundled(value) is value


def test_arrays_of_other_kinds_have_other_types():
    plain, readonly = np.zeros((2, 3)), np.zeros((2, 3))
    readonly.flags.writeable = False
    kinds = [array_type(x) for x in (plain, plain.T, plain[:, ::2], plain[0], plain.astype(int), readonly)]
    assert len({str(kind) for kind in kinds}) == 6
    assert array_type(np.ones((5, 7))) is kinds[0]
