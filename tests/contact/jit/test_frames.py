"""Room for frames: what is called with it does not ask the system for memory at every call, however deep it stands."""

import resource

import pytest

from contact.jit.progress import with_room

CALLS, DEPTHS = 500, 200


def wide(a, b, c, d, e, f, g, h):
    """A frame larger than one of `faults_at`: where a chunk ends one of its calls does not fit."""
    return a


def faults_at(depth):
    """Pages asked for by calls in a loop, so many frames deep."""
    if depth:
        return faults_at(depth - 1)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for k in range(CALLS):
        wide(k, k, k, k, k, k, k, k)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


def test_no_depth_is_where_a_chunk_ends():
    found = [with_room(faults_at, depth) for depth in range(DEPTHS)]
    assert max(found) < CALLS // 2  # without room a chunk is asked for at each call, at some of the depths


def test_values_and_errors_come_through():
    assert with_room(divmod, 7, 2) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        with_room(divmod, 7, 0)
