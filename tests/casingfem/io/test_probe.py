"""Readers that loop, fill the memory or crash are found by a child; those that raise are left to the parent."""

import time

import pytest

from casingfem.errors import InputError
from casingfem.experiment.frf.hdf5 import read_hdf5
from casingfem.io import probe


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "fault"),
    [
        ("while True: pass", True),
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
    started = time.perf_counter()
    found = probe.fault_of(tmp_path / "reader_of_tests.py", "reader_of_tests", "read")
    assert bool(found) == fault, found
    assert time.perf_counter() - started < 10.0
    if fault:
        assert found == "its reader took more than 1 s or 1.5 GB, or crashed"


def test_an_hdf5_file_whose_reader_does_not_end_is_refused(tmp_path, monkeypatch):
    """The child reads by the package's own function: told to have found a fault, the parent does not read."""
    asked = []
    monkeypatch.setattr(
        "casingfem.experiment.frf.hdf5.fault_of", lambda *names: asked.append(names) or "its reader crashed"
    )
    (tmp_path / "a.h5").write_bytes(b"x")
    with pytest.raises(InputError, match=r"no readable HDF5 file \(its reader crashed\)"):
        read_hdf5(tmp_path / "a.h5")
    assert asked == [(tmp_path / "a.h5", "casingfem.experiment.frf.hdf5", "_contents")]
