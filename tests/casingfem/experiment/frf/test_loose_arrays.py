"""Responses in MATLAB files and plain npz: every layout gives the same set, other arrays are refused by name."""

import re

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import savemat

import casingfem as cf
from casingfem.cli import main

pytestmark = pytest.mark.slow  # a MATLAB file is read by a process of its own

FREQ = np.arange(40.0, 80.0, 0.25)
RESIDUES = np.array([[1.0, 0.5], [-0.7, 0.3], [0.2, -0.9]])  # of 3 sensors to 2 references
W, W0 = 2.0 * np.pi * FREQ, 2.0 * np.pi * 60.0
H = RESIDUES[:, :, None] / (W0**2 - W**2 + 0.02j * W0 * W)
EXTRA = {"points": [4, 5, 9], "directions": [3, 3, -3], "references": [4, 9], "form": "receptance"}


def written(folder, kind, **arrays):
    path = folder / f"test.{kind}"
    if kind == "mat":
        savemat(path, arrays)
    else:
        np.savez(path, **arrays)
    return path


@pytest.mark.parametrize("kind", ["mat", "npz"])
@pytest.mark.parametrize("names", [("freq_hz", "frf"), ("f", "H"), ("Frequency", "FRFs")])
@pytest.mark.parametrize("first", [True, False])
def test_lines_are_first_or_last_and_names_are_common_ones(kind, names, first, tmp_path):
    values = np.moveaxis(H, -1, 0) if first else H
    found = cf.frf.read_frfs(written(tmp_path, kind, **{names[0]: FREQ, names[1]: values}, **EXTRA))
    np.testing.assert_array_equal(found.x, FREQ)
    np.testing.assert_array_equal(found.responses, H.reshape(6, -1))
    assert found.response_point.tolist() == [4, 4, 5, 5, 9, 9]
    assert found.response_direction.tolist() == [3, 3, 3, 3, -3, -3]
    assert found.reference_point.tolist() == [4, 9] * 3
    assert found.form == "receptance"


@pytest.mark.parametrize("kind", ["mat", "npz"])
def test_channels_count_from_one_and_coherence_is_beside(kind, tmp_path):
    path = written(tmp_path, kind, omega=W, frf=H[:, 0], coherence=0.9 * np.ones(H[:, 0].shape))
    found, coherence = cf.frf.read_frfs(path), cf.frf.read_coherence(path)
    np.testing.assert_allclose(found.x, FREQ, rtol=1e-15)
    assert (found.response_point.tolist(), found.reference_point.tolist()) == ([1, 2, 3], [1, 1, 1])
    assert np.all(coherence.responses == 0.9)
    assert cf.frf.read_coherence(written(tmp_path, kind, f=FREQ, H=H)) is None


@pytest.mark.parametrize("kind", ["mat", "npz"])
def test_stated_names_of_arrays_come_before_common_ones(kind, tmp_path):
    path = written(tmp_path, kind, Freq_domain=FREQ, Hf_chan_2=H[:, 0], f=np.arange(7.0), form="receptance")
    names = {"freq_hz": "Freq_domain", "frf": "Hf_chan_2"}
    np.testing.assert_array_equal(cf.frf.read_frfs(path, arrays=names).responses, H[:, 0])
    words = [word for meaning, name in names.items() for word in ("--array", f"{meaning}={name}")]
    found = CliRunner().invoke(main, ["identify", str(path), *words])
    assert found.exit_code == 0, found.output
    assert "60.0" in found.output


def test_names_of_arrays_that_are_not_there_are_refused(tmp_path):
    path = written(tmp_path, "npz", Freq_domain=FREQ, Hf_chan_2=H[:, 0], f=np.arange(7.0), form="receptance")
    wrong = ["--array", "frf=Hf"], ["--array", "frg=Hf_chan_2"], ["--array", "frf="]
    for (_, word), reason in zip(
        wrong, ("no array 'Hf' among Freq_domain", "no such meaning", "MEANING=NAME"), strict=True
    ):
        refused = CliRunner().invoke(main, ["identify", str(path), "--array", word])
        assert refused.exit_code == 2, refused.output
        assert reason in refused.output
    with pytest.raises(cf.errors.InputError, match="a file of arrays"):
        cf.frf.read_frfs(tmp_path / "t.csv", arrays={"freq_hz": "Freq_domain", "frf": "Hf_chan_2"})


def test_arrays_of_a_struct_and_of_version_7_3_are_read(tmp_path):
    h5py = pytest.importorskip("h5py")
    savemat(tmp_path / "struct.mat", {"test": {"f": FREQ, "H": H[:, 0], "unit": "(m/s^2)/N"}})
    found = cf.frf.read_frfs(tmp_path / "struct.mat")
    assert found.unit == "(m/s^2)/N"
    with h5py.File(tmp_path / "new.mat", "w", userblock_size=512) as file:
        file["f"] = FREQ[:, None]
        pairs = np.empty(H[:, 0].shape, [("real", "f8"), ("imag", "f8")])  # MATLAB's H is (lines, channels)
        pairs["real"], pairs["imag"] = H[:, 0].real, H[:, 0].imag
        file["H"] = pairs
        text = file.create_dataset("unit", data=np.array([[ord(letter)] for letter in "m/N"], np.uint16))
        text.attrs["MATLAB_class"] = np.bytes_("char")
    with (tmp_path / "new.mat").open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    new = cf.frf.read_frfs(tmp_path / "new.mat")
    np.testing.assert_array_equal(new.responses, found.responses)
    assert new.unit == "m/N"


def test_modes_of_plain_arrays_by_the_command(tmp_path):
    path = written(tmp_path, "npz", freq_hz=FREQ, frf=H, **EXTRA)
    done = CliRunner().invoke(main, ["identify", str(path), "--open", "--json"])
    assert done.exit_code == 0, done.output
    (freq,) = re.findall(r'"freq_hz": ([0-9.]+)', done.output)
    assert float(freq) == pytest.approx(60.0, rel=1e-8)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"t": FREQ, "H": H}, "found arrays H, t; expected freq_hz (lines,) and frf (channels, lines) or"),
        ({"f": FREQ, "freq": FREQ, "H": H}, "found f and freq for freq_hz; expected one of them"),
        ({"f": FREQ, "H": H[..., :7]}, "found frf (3, 2, 7) for 160 frequencies; expected freq_hz (lines,)"),
        ({"f": FREQ[:3], "H": H[:3, 0, :3]}, "found frf (3, 3) for 3 frequencies; expected"),
        ({"f": FREQ, "H": H, "points": [1, 2]}, "; expected whole numbers (3,)"),
        ({"f": FREQ, "H": H, "form": "compliance"}, "found form 'compliance'; expected receptance or"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_with_their_names(arrays, words, tmp_path):
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        cf.frf.read_frfs(written(tmp_path, "npz", **arrays))


def test_objects_and_damaged_files_are_refused(tmp_path):
    np.savez(tmp_path / "objects.npz", f=FREQ, H=np.array([None, {}], dtype=object))
    (tmp_path / "cut.mat").write_bytes(written(tmp_path, "mat", f=FREQ, H=H).read_bytes()[:900])
    with pytest.raises(cf.errors.InputError, match="no readable npz"):
        cf.frf.read_frfs(tmp_path / "objects.npz")
    with pytest.raises(cf.errors.InputError, match="no readable MATLAB file"):
        cf.frf.read_frfs(tmp_path / "cut.mat")
