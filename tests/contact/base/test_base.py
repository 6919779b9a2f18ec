"""Checks of numbers on both sides of their bounds, limits that are told, files that are refused, results kept."""

import re

import numpy as np
import pytest

import contact as ct
from contact.base.arrays import (
    aligned,
    is_whole,
    keep_readonly,
    read_npz,
    readonly,
    require_count,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
)
from contact.base.errors import rounded_down
from contact.base.remembered import remembered
from contact.io.npz import write_npz


@pytest.mark.parametrize("value", [1.0 / 1e60, 1e60, 5.0])
def test_a_positive_number_lies_within_sixty_decades_of_one(value):
    require_positive(length=value)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.0, "expected a finite number > 0"), (-1.0, "expected a finite number > 0"),
        (np.inf, "expected a finite number > 0"), (np.nan, "expected a finite number > 0"),
        (0.9e-60, "expected a number between 1e-60 and 1e+60"), (1.1e60, "expected a number between 1e-60 and 1e+60"),
    ],
)  # fmt: skip
def test_what_is_not_positive_or_far_from_one_is_refused(value, words):
    with pytest.raises(ct.InputError, match=f"^second: found {re.escape(repr(value))}, {re.escape(words)}$"):
        require_positive(first=2.0, second=value)


def test_numbers_that_may_be_zero_or_must_be_finite():
    require_not_negative(a=0.0, b=1e300)
    require_finite(a=-1e300, b=0.0)
    for value in (-1e-300, np.inf, np.nan):
        with pytest.raises(ct.InputError, match=r"^b: found .*, expected a finite number >= 0$"):
            require_not_negative(a=0.0, b=value)
    for value in (-np.inf, np.nan):
        with pytest.raises(ct.InputError, match=r"^b: found .*, expected a finite number$"):
            require_finite(a=0.0, b=value)


def test_counts_are_whole_and_no_more_than_memory_holds():
    require_count(n=1, m=np.int32(10_000_000))
    require_count(0, n=0)
    for least, value, words in (
        (1, 0, "n: found 0, expected a whole number >= 1"), (0, -1, "n: found -1, expected a whole number >= 0"),
        (3, 2, "n: found 2, expected a whole number >= 3"), (1, 2.0, "n: found 2.0, expected a whole number >= 1"),
        (1, 10_000_001, "n: found 10000001, expected at most 10000000"),
        (1, 10**17, "n: found 100000000000000000, expected"), (1, 10**18, "n: found over 1e18, expected at most"),
    ):  # fmt: skip
        with pytest.raises(ct.InputError, match=f"^{re.escape(words)}"):
            require_count(least, n=value)
    with pytest.raises(ct.InputError, match="expected a whole number >= 1"):
        require_count(n=0)
    assert [is_whole(value) for value in (3, np.int64(3), 3.0, "3", None)] == [True, True, False, False, False]


def test_shapes_and_entries_that_are_no_numbers_are_told():
    require_shape("S", np.zeros((2, 3)), [2, 3])
    with pytest.raises(ct.InputError, match=re.escape("S: found shape (2, 3), expected (3, 2)")):
        require_shape("S", np.zeros((2, 3)), (3, 2))
    with pytest.raises(ct.InputError, match=r"^S: found 2 entries that are NaN or infinite, expected finite numbers$"):
        require_shape("S", np.array([np.nan, 1.0, np.inf]), (3,))
    with pytest.raises(ct.InputError, match="found 1 entries"):
        require_shape("S", np.array([np.nan, 1.0]), (2,))


def test_read_only_arrays_are_copies_in_order():
    given = np.asfortranarray(np.arange(6).reshape(2, 3))
    kept = readonly(given)
    given[0, 0] = 9
    assert (kept.dtype, kept.tolist()) == (np.float64, [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]])
    assert kept.flags.c_contiguous
    assert not kept.flags.writeable
    start = ct.gaps.Start(displacement=[1.0, 2.0])
    keep_readonly(start, "displacement", "velocity")
    assert start.velocity is None
    assert not start.displacement.flags.writeable


@pytest.mark.parametrize("shape", [(8,), (3, 8), (1,), (5, 2, 8)])
def test_aligned_zeros_begin_on_a_cache_line(shape):
    kept = [aligned(*shape) for _ in range(9)]
    for array in kept:
        assert array.shape == shape
        assert array.ctypes.data % 64 == 0
        assert not array.any()


@pytest.mark.parametrize(
    ("limit", "digits", "text"),
    [
        (1.26, 2, "1.2"), (1.24, 2, "1.2"), (0.0996, 2, "0.099"), (2.5, 2, "2.4"), (123.9, 3, "123"),
        (9.996, 3, "9.99"), (1.26e-7, 2, "1.2e-07"),
    ],
)  # fmt: skip
def test_a_limit_that_is_told_lies_below_the_limit(limit, digits, text):
    assert rounded_down(limit, digits) == text
    assert float(text) < limit


def test_a_file_of_arrays_is_read_or_refused_with_its_key(tmp_path):
    path = tmp_path / "body.npz"
    with pytest.raises(ct.InputError, match="found no such file, expected an npz file"):
        read_npz(path, "body-1", (), ())
    path.write_text("no archive")
    with pytest.raises(ct.InputError, match=r"body\.npz: not a readable npz file without pickled objects"):
        read_npz(path, "body-1", (), ())
    write_npz(path, {"x": np.arange(3.0)})
    with pytest.raises(ct.InputError, match="key 'format': found \"no key 'format'\", expected 'body-1'"):
        read_npz(path, "body-1", (), ("format",))
    write_npz(path, {"format": "body-1", "x": np.arange(3.0), "name": "tip"})
    with pytest.raises(ct.InputError, match="key 'format': found 'body-1', expected 'body-2'"):
        read_npz(path, "body-2", ("x",), ("format", "name"))
    with pytest.raises(ct.InputError, match=r"missing keys y, z$"):
        read_npz(path, "body-1", ("y", "x", "z"), ("format", "name"))
    with pytest.raises(ct.InputError, match=r"body\.npz: member 'name': found <U3, expected real numbers"):
        read_npz(path, "body-1", ("x",), ("format",))
    found = read_npz(path, "body-1", ("x", "name"), ("format", "name"))
    assert (found["x"].tolist(), str(found["name"])) == ([0.0, 1.0, 2.0], "tip")


def test_the_last_sixteen_results_are_kept():
    calls = []
    double = remembered(lambda value: calls.append(value) or 2 * value)
    assert [double(k) for k in range(16)] == [2 * k for k in range(16)]
    assert [double(k) for k in range(16)] == [2 * k for k in range(16)]
    assert calls == list(range(16))
    assert (double(16), double(1), double(15)) == (32, 2, 30)  # the first had to go, and it alone
    assert calls == list(range(17))
    assert double(0) == 0
    assert calls == [*range(17), 0]


def test_equal_arrays_are_two_and_named_arguments_are_not_kept():
    calls = []
    total = remembered(lambda values, power=1: calls.append(power) or float(values.sum()) ** power)
    one, other = readonly([1.0, 2.0]), readonly([1.0, 2.0])
    assert (total(one), total(one), total(other), len(calls)) == (3.0, 3.0, 3.0, 2)
    assert (total(one, power=2), total(one, power=2), len(calls)) == (9.0, 9.0, 4)
    assert (total(one, 2), total(one, 2), len(calls)) == (9.0, 9.0, 5)
