"""Files of arrays that are read whole or refused in words; cores that a process may use; threads of its children."""

import os

import numpy as np
import pytest

import casingfem as cf
from casingfem.io.npz import read_npz
from casingfem.io.side_by_side import one_thread, side_by_side, usable_cores


@pytest.fixture
def stored(tmp_path):
    path = tmp_path / "some.npz"
    np.savez(path, a=np.arange(3.0), b=np.array("text"), c=np.array([1j]))
    return path


def test_all_arrays_come_by_name_whether_wanted_or_not(stored):
    for wanted in ((), ("a", "c")):
        found = read_npz(stored, wanted)
        assert sorted(found) == ["a", "b", "c"]
        assert found["a"].tolist() == [0.0, 1.0, 2.0]
    kinds = {"b": "text", "c": "complex"}
    assert read_npz(str(stored), "abc", "modes", kinds)["c"].tolist() == [1j]


def test_what_is_missing_is_named_beside_what_is_expected(stored):
    with pytest.raises(cf.errors.InputError, match=r"some\.npz: found an npz without d, e; expected a, d, e"):
        read_npz(stored, {"e", "a", "d"})
    with pytest.raises(cf.errors.InputError, match=r"found an npz without d; expected what somebody wrote"):
        read_npz(stored, {"d"}, "what somebody wrote")


def test_other_files_are_refused_by_what_they_should_be(tmp_path):
    path = tmp_path / "table.npz"
    path.write_text("1,2,3\n")
    for expected, words in (("", "a file of arrays"), ("modes", "modes")):
        with pytest.raises(
            cf.errors.InputError, match=rf"table\.npz: found no readable npz file \(.+\); expected {words}$"
        ):
            read_npz(path, (), expected)


def test_arrays_of_other_kinds_are_refused_where_kinds_are_said(stored):
    with pytest.raises(cf.errors.InputError, match=r"^\S*some\.npz: .*b"):
        read_npz(stored, (), "", {"c": "complex"})
    assert read_npz(stored)["b"] == "text"
    with pytest.raises(cf.errors.InputError, match=r"^\S*some\.npz: .*c"):
        read_npz(stored, (), "", {"b": "text"})


def test_cores_are_those_of_the_scheduler_or_of_the_machine_or_one(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {1, 4, 6} if process == 0 else set(), raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 9)
    assert usable_cores() == 3
    monkeypatch.delattr(os, "sched_getaffinity")
    assert usable_cores() == 9
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert usable_cores() == 1


@pytest.mark.parametrize("workers", [1, 0])
def test_a_single_worker_is_this_process(workers):
    with side_by_side(workers) as each:
        assert each is map


def test_children_have_one_thread_and_this_process_what_it_had_even_after_an_error(monkeypatch):
    names = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
    for name, value in zip(names, ("5", None, "2"), strict=True):
        monkeypatch.delenv(name, raising=False) if value is None else monkeypatch.setenv(name, value)
    inside = []

    def fail():
        inside.extend(os.environ.get(name) for name in names)
        raise ValueError("on the way")

    with pytest.raises(ValueError, match="on the way"), one_thread():
        fail()
    assert inside == ["1", "1", "1"]
    assert [os.environ.get(name) for name in names] == ["5", None, "2"]
