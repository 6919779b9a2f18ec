"""Calls are looked up once while step loops are compiled, and as numba does it before and after."""

import numba
import pytest
from numba.core import types

from contact.jit import progress
from contact.jit.progress import calls_looked_up_once


@pytest.fixture
def looked_up(monkeypatch):
    """Calls that numba itself is asked for."""
    asked = []

    def look_up(function, context, args, kws):
        asked.append((function, args))
        return original(function, context, args, kws)

    original = progress.LOOK_UP
    monkeypatch.setattr(progress, "LOOK_UP", look_up)
    monkeypatch.setattr(progress, "KNOWN", {})
    return asked


def sums(a, b):
    return a * b + a * b + a * b + b * a


def test_each_kind_of_call_is_looked_up_once(looked_up):
    with calls_looked_up_once():
        compiled = numba.njit("float64(float64, float64)")(sums)
    assert compiled(2.0, 3.0) == 24.0
    assert len(looked_up) == len(set(looked_up)) == 2  # a product and a sum, of seven


def test_other_types_are_other_calls(looked_up):
    with calls_looked_up_once():
        compiled = numba.njit(["float64(float64, float64)", "int64(int64, int64)"])(sums)
    assert compiled(2, 3) == 24
    assert isinstance(compiled(2, 3), int)
    assert len(looked_up) == 4


def test_afterwards_numba_looks_up_as_it_did(looked_up):
    before = types.Function.get_call_type
    with calls_looked_up_once():
        with calls_looked_up_once():
            pass
        assert types.Function.get_call_type is not before  # loops compile their parts
    assert types.Function.get_call_type is before
    with pytest.raises(TypeError), calls_looked_up_once():
        numba.njit("void()")(sums)
    assert types.Function.get_call_type is before
