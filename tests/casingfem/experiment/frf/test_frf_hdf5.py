"""Frequency responses in HDF5: the same bits back, and what is no such file refused in words."""

import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest

import casingfem as cf

ARRAYS = ("x", "responses", "response_point", "response_direction", "reference_point", "reference_direction")


def write_hdf5(frfs, path):
    """Data sets named as the fields of `FrfSet`, the rest as attributes."""
    with h5py.File(path, "w") as file:
        for name in ARRAYS:
            file[name] = getattr(frfs, name)
        for name in ("kind", "unit", "form"):
            file.attrs[name] = getattr(frfs, name)
        file.attrs["card"] = list(frfs.card)
    return path


@pytest.fixture
def two() -> cf.frf.FrfSet:
    rng = np.random.default_rng(719)
    return cf.frf.FrfSet.from_arrays(
        kind="frf",
        x=[10.0, 20.0, 40.0],
        responses=rng.normal(size=(2, 3)) + 1j * rng.normal(size=(2, 3)),
        response_point=[3, 5],
        response_direction=[1, -1],
        unit="m/N",
        card=("SYNTHETIC: one", "two"),
    )


@pytest.mark.slow
def test_every_bit_comes_back(two, tmp_path):
    back = cf.frf.read_frfs(write_hdf5(two, tmp_path / "f.h5"))
    assert all(np.array_equal(getattr(back, name), getattr(two, name)) for name in ARRAYS)
    assert (back.kind, back.unit, back.card) == (two.kind, two.unit, two.card)
    stated = replace(two, kind="frf", form="accelerance", unit="")
    again = cf.frf.read_frfs(write_hdf5(stated, tmp_path / "g.hdf5"))
    assert all(np.array_equal(getattr(again, name), getattr(two, name)) for name in ARRAYS)
    assert (again.kind, again.unit, again.form, again.card) == ("frf", "", "accelerance", two.card)


def change(path, edit):
    with h5py.File(path, "r+") as file:
        edit(file)


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda file: file.pop("x"), "no data set 'x'"),
        (
            lambda file: file.pop("responses"),
            "no data set 'responses'; expected data sets x, responses, ",
        ),
        (lambda file: file.attrs.pop("unit"), "no attribute 'unit'"),
        (
            lambda file: (file.pop("responses"), file.create_dataset("responses", data=[[True, False, True]])),
            r"f\.hdf5: member 'responses': found bool, expected numbers",
        ),
        (lambda file: file["x"].write_direct(np.array([10.0, np.nan, 40.0])), "nan or infinity"),
        (lambda file: file.attrs.__setitem__("kind", "shape"), "kind 'shape'"),
        (lambda file: (file.pop("x"), file.create_dataset("x", data=[1.0, 2.0])), "x \\(2,\\)"),
    ],
)
def test_what_does_not_fit_is_refused(edit, said, two, tmp_path):
    path = write_hdf5(two, tmp_path / "f.hdf5")
    change(path, edit)
    with pytest.raises(cf.errors.InputError, match=said):
        cf.frf.read_frfs(path)


def test_without_h5py_it_is_named(two, tmp_path, monkeypatch):
    path = write_hdf5(two, tmp_path / "f.h5")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(cf.errors.InputError) as caught:
        cf.frf.read_frfs(path)
    assert f"{path}: found an HDF5 file; expected the package h5py: " in str(caught.value)
    assert "test-data" in str(caught.value)


@pytest.mark.slow
def test_places_may_be_missing(two, tmp_path):
    path = write_hdf5(two, tmp_path / "f.h5")
    change(path, lambda file: file.pop("reference_point"))
    assert cf.frf.read_frfs(path).reference_point.tolist() == [0, 0]


@pytest.mark.parametrize("ending", [".h5", ".npz"])
@pytest.mark.slow
def test_other_bytes_and_no_file(ending, tmp_path):
    path = tmp_path / f"f{ending}"
    with pytest.raises(cf.errors.InputError, match="no readable"):
        cf.frf.read_frfs(path)
    path.write_bytes(b"freq_hz,real,imag\n")
    with pytest.raises(cf.errors.InputError, match="no readable"):
        cf.frf.read_frfs(path)
    path.write_bytes(b"PK\x03\x04")
    with pytest.raises(cf.errors.InputError, match="no readable"):
        cf.frf.read_frfs(path)
