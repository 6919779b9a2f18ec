"""Readers that loop, fill the memory or crash are found by a child, which hands over what it reads, if asked."""

import io
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.frf.files import read_hdf5
from casingfem.io import probe

IN_CHILD = probe.in_child


@pytest.fixture(autouse=True)
def in_new_processes(monkeypatch):
    """As programs read, not by a fork of this process."""
    monkeypatch.setattr(probe, "in_child", IN_CHILD)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "fault"),
    [
        ("bytearray(10**11)", True),
        ("import os; os.abort()", True),
        ("raise KeyError('x')", False),
        ("path.read_text()", False),
    ],
)
def test_what_a_reader_does_is_found_out(tmp_path, monkeypatch, code, fault):
    (tmp_path / "reader_of_tests.py").write_text(f"def read(path):\n    {code}\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(probe, "SECONDS", 1.0)
    found = probe.fault_of(tmp_path / "reader_of_tests.py", "reader_of_tests", "read")
    assert bool(found) == fault, found
    if fault:
        assert found == "its reader took more than 1 s or 1.5 GB, or crashed"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="bounds on processor time are those of POSIX")
def test_a_loop_ends_by_its_processor_time_not_by_the_clock(tmp_path, monkeypatch):
    (tmp_path / "reader_that_loops.py").write_text("def read(path):\n    while True: pass\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(probe, "SECONDS", 0.5)
    codes, patient = [], subprocess.run

    def run(*arguments, timeout, **more):
        done = patient(*arguments, timeout=20.0 * timeout, **more)
        codes.append(done.returncode)
        return done

    monkeypatch.setattr(subprocess, "run", run)
    assert probe.fault_of(tmp_path / "reader_that_loops.py", "reader_that_loops", "read")
    assert codes[0] in (-signal.SIGXCPU, -signal.SIGKILL)


READERS = """import os
import numpy as np

def arrays(path):
    print("a library that talks")
    os.write(1, b"from its own code too")
    return {"file": np.arange(6.0).reshape(2, 3).T, "a": np.array(["x"]), "none": np.zeros((0, 2), dtype=complex)}

def raises(path):
    raise KeyError(f"no K in {path.name}")

def objects(path):
    return {"K": np.array([None])}

def of_its_place(path):
    if os.getpid() == PARENT:
        os.abort()
    return {"K": np.eye(2)}

def aborts(path):
    os.abort()
"""


@pytest.fixture
def readers(tmp_path, monkeypatch):
    """A module of readers, and the path of some file."""
    (tmp_path / "handing_readers.py").write_text(READERS.replace("PARENT", str(os.getpid())))
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path / "handing_readers.py"


@pytest.mark.slow
def test_arrays_come_from_the_child_as_they_are(readers):
    found = probe.arrays_of(readers, "handing_readers", "arrays")
    assert list(found) == ["file", "a", "none"]
    np.testing.assert_array_equal(found["file"], np.arange(6.0).reshape(2, 3).T)
    assert found["a"].tolist() == ["x"]
    assert (found["none"].shape, found["none"].dtype) == ((0, 2), complex)


@pytest.mark.slow
def test_what_would_crash_the_parent_is_not_called_there(readers):
    np.testing.assert_array_equal(probe.arrays_of(readers, "handing_readers", "of_its_place")["K"], np.eye(2))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("reader", "said"),
    [("raises", "no K in handing"), ("objects", "K is no array of numbers"), ("aborts", "or crashed")],
)
def test_what_a_child_states_of_a_file(readers, reader, said):
    with pytest.raises(probe.UnreadableError, match=said):
        probe.arrays_of(readers, "handing_readers", reader)


def raised(error):
    """A reader that fails."""

    def call(path):
        raise error

    return call


def test_what_a_reader_returns_is_written_and_taken_up_whole():
    stream, given = io.BytesIO(), {"b": np.eye(2), "a": np.array([1, 2]), "c": np.array(["x"])}
    assert probe.give(stream, lambda path: given | {"path": str(path)}, Path("f.dat")) == 0
    stream.seek(0)
    found = probe.taken(stream)
    assert list(found) == ["b", "a", "c", "path"]
    for name, array in given.items():
        np.testing.assert_array_equal(found[name], array)
    assert found["path"].item() == "f.dat"


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (raised(ValueError("no K")), "no K"), (raised(IndexError()), "IndexError"),
        (lambda path: {"a": np.ones(1), "K": np.array([None])}, "K is no array of numbers"),
    ],
)  # fmt: skip
def test_what_a_reader_raises_is_written_too(call, said):
    stream = io.BytesIO()
    assert probe.give(stream, call, Path("f.dat")) == probe.REFUSED == 3
    stream.seek(0)
    with pytest.raises(probe.UnreadableError, match=f"^{said}$"):
        probe.taken(stream)


def test_a_reader_without_memory_states_nothing():
    stream = io.BytesIO()
    assert probe.give(stream, raised(MemoryError()), Path("f.dat")) == 1
    assert stream.getvalue() == b""


@pytest.mark.slow
def test_bounds_grow_with_the_file(tmp_path):
    """By a second for 20 MB, by 20 bytes of memory for a byte."""
    with (tmp_path / "large").open("wb") as file:
        file.truncate(50_000_000)
    code, fault = probe.in_child("read", tmp_path / "large", "os", "fspath", subprocess.DEVNULL)
    assert (code, fault) == (0, "its reader took more than 5.5 s or 2.5 GB, or crashed")


def refuse(words):
    """What the child says."""
    raise probe.UnreadableError(words)


def test_an_hdf5_file_whose_reader_does_not_end_is_refused(tmp_path, monkeypatch):
    """The child reads by the package's own function: told to have found a fault, the parent does not read."""
    asked = []
    monkeypatch.setattr(
        "casingfem.experiment.frf.files.arrays_of", lambda *names: asked.append(names) or refuse("its reader crashed")
    )
    (tmp_path / "a.h5").write_bytes(b"x")
    with pytest.raises(cf.errors.InputError, match=r"no readable HDF5 file \(its reader crashed\)"):
        read_hdf5(tmp_path / "a.h5")
    assert asked == [(tmp_path / "a.h5", "casingfem.experiment.frf.files", "_contents")]
