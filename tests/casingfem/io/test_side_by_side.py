"""Work that processes share: in the order of the items, with the errors that it meets."""

import math
import os

import pytest

from casingfem.io.side_by_side import largest_first, side_by_side


def where(item: int) -> tuple[int, int]:
    """The item and who worked on it."""
    return item, os.getpid()


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.slow
def test_results_come_in_the_order_of_the_items(workers):
    with side_by_side(workers) as each:
        found = list(each(where, range(20)))
    assert [item for item, _ in found] == list(range(20))
    assert (os.getpid() in {process for _, process in found}) == (workers == 1)


def test_the_largest_begin_first_and_keep_their_numbers():
    assert list(largest_first(map, abs, [-3, 2, -7], size=abs)) == [(2, 7), (0, 3), (1, 2)]


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_of_one_item_is_met_by_who_asked(workers):
    with pytest.raises(ValueError, match="domain"), side_by_side(workers) as each:
        list(each(math.sqrt, [1.0, -1.0]))


@pytest.mark.slow
def test_threads_are_as_before_when_all_is_done(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    with side_by_side(2) as each:
        assert list(each(os.getenv, ["OMP_NUM_THREADS", "MKL_NUM_THREADS"])) == ["1", "1"]
    assert (os.environ["OMP_NUM_THREADS"], os.environ.get("MKL_NUM_THREADS")) == ("3", None)
