"""Arrays of measurements that a campaign of mutations found to end in a traceback: refused, file and name said."""

import numpy as np
import pytest

import casingfem as cf
from reports.tables import DATA
from reports.verification.robustness.sample_files import frfs

SCAN = {"fs": np.array(100.0), "velocity": np.ones(4), "angle": np.arange(4.0), "tones": np.array([5.0]),
        "card": np.array(["SYNTHETIC"])}  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tones": np.array(5.0)}, r"tones \(\)"),
        ({"fs": np.array([1.0, 2.0])}, r"fs \(2,\)"),
        ({"card": np.array("x")}, r"card \(\)"),
    ],
)
def test_a_scan_of_other_shapes(changes, message, tmp_path):
    np.savez(tmp_path / "a.npz", **SCAN | changes)
    with pytest.raises(cf.errors.InputError, match=rf"a\.npz: .*{message}"):
        cf.circle.ScanRecord.load(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"freq": np.array(["text"] * 10)}, "member 'freq': found <U4, expected real numbers"),
        ({"seconds": np.ones(3)}, r"seconds of shape \(3,\)"),
        ({"card": np.array("text")}, r"card of shape \(\)"),
        ({"notes": np.array(5.0)}, "member 'notes': found float64, expected text"),
        ({"doublets": np.array([[0.0, 1e300]])}, "mode 1e.300 in a pair"),
        ({"doublets": np.array([[0, 1, 2]])}, "two in each pair"),
    ],
)
def test_identified_modes_of_other_kinds(changes, message, tmp_path):
    with np.load(DATA / "experiments" / "bench.npz") as stored:
        np.savez(tmp_path / "a.npz", **dict(stored) | changes)
    with pytest.raises(cf.errors.InputError, match=rf"a\.npz: .*{message}"):
        cf.Identified.load(tmp_path / "a.npz")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"x": np.arange(40) + 0.5j}, "member 'x': found complex128, expected real"),
        ({"response_point": np.array([b"2001-01-01", b"x"])}, "member 'response_point': found"),
        ({"response_point": np.array([3.5, 5.0])}, "response_point that are not whole numbers"),
        ({"response_point": np.array([np.nan, 5.0], np.float16)}, "response_point that are not whole numbers"),
    ],
)
def test_responses_of_other_kinds_in_hdf5(changes, message, tmp_path):
    h5py = pytest.importorskip("h5py")
    whole = frfs()
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name in ("x", "responses", "response_point"):
            file[name] = changes.get(name, getattr(whole, name))
        file.attrs["unit"] = "m/N"
    with pytest.raises(cf.errors.InputError, match=rf"a\.h5: .*{message}"):
        cf.frf.read_frfs(tmp_path / "a.h5")
