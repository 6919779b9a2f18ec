"""ModalBasis: a round trip through its file, and what it refuses."""

import os
from dataclasses import fields

import numpy as np
import pytest

import casingfem as cf
import contact as ct


def basis(**changes):
    rng = np.random.default_rng(23)
    parts = {
        "omega": np.array([100.0, 250.0, 251.0]),
        "zeta": np.array([0.002, 0.002, 0.004]),
        "channels": ("radial.cos0", "radial.cos1"),
        "rows": rng.normal(size=(2, 3)),
        "S": np.array([[2e-9, 1e-10], [1e-10, 3e-9]]),
        "kind": "rim",
        "n_max": 1,
        "radius": 0.45,
        "recovery": rng.normal(size=(6, 3)),
        "recovery_S": rng.normal(size=(6, 2)),
        "recovery_points": rng.normal(size=(2, 3)),
        "lines": np.array([[0.0, 0.45]]),
        "outputs": ("tip.x",),
        "output_rows": rng.normal(size=(1, 3)),
        "output_S": rng.normal(size=(1, 2)),
        "stiffness_by_speed": rng.normal(size=(3, 3)),
        "spin": 31.4,
        "sectors": 2,
        "participation": rng.normal(size=(3, 3)),
        "provenance": {"method": "free", "versions": {"numpy": "2"}},
    }
    return cf.ModalBasis(**(parts | changes))


def test_file_gives_everything_back_bit_for_bit(tmp_path):
    first = basis()
    path = first.save(tmp_path / "deep" / "casing.npz")
    again = cf.ModalBasis.load(path)
    for name in (field.name for field in fields(cf.ModalBasis)):
        ours, theirs = getattr(first, name), getattr(again, name)
        assert ours.tobytes() == theirs.tobytes() if isinstance(ours, np.ndarray) else ours == theirs, name
    assert os.listdir(path.parent) == ["casing.npz"]


def test_a_body_of_a_basis_is_that_of_its_file(tmp_path):
    path = basis(channels=("tip.x", "tip.y"), kind="point", n_max=0, sectors=0).save(tmp_path / "blade.npz")
    read = ct.ModalBody.load(path)
    made = ct.ModalBody.of(cf.ModalBasis.load(path))
    for name in (field.name for field in fields(ct.ModalBody)):
        ours, theirs = getattr(made, name), getattr(read, name)
        assert ours.tobytes() == theirs.tobytes() if isinstance(ours, np.ndarray) else ours == theirs, name
    with pytest.raises(ct.InputError, match="basis: found str, expected a reduced basis"):
        ct.ModalBody.of("blade.npz")


def test_what_is_not_given_is_nothing(tmp_path):
    """No recovery, no outputs, no rotation: a basis of a structure at rest."""
    given = {name: getattr(basis(), name) for name in ("omega", "zeta", "channels", "rows", "S", "kind")}
    bare = cf.ModalBasis(**given)
    for made in (bare, cf.ModalBasis.load(bare.save(tmp_path / "bare.npz"))):
        rest = {field.name: getattr(made, field.name) for field in fields(cf.ModalBasis) if field.name not in given}
        assert {name: value for name, value in rest.items() if np.size(value)} == {
            "n_max": 0, "sectors": 0, "radius": 0.0, "thickness": 0.0, "spin": 0.0, "provenance": {},
        }  # fmt: skip


def test_file_needs_no_pickle(tmp_path):
    path = basis().save(tmp_path / "casing.npz")
    with np.load(path, allow_pickle=False) as stored:
        assert all(stored[name].dtype != object for name in stored.files)


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = basis().save(tmp_path / "casing.npz")
    before = path.read_bytes()

    def failing(*args, **arrays):
        raise OSError("disk full")

    monkeypatch.setattr(np, "savez", failing)
    with pytest.raises(OSError, match="disk full"):
        basis(n_max=2).save(path)
    assert path.read_bytes() == before


def test_arrays_are_copies_and_read_only():
    omega = np.array([1.0, 2.0, 3.0])
    made = basis(omega=omega)
    omega[0] = 7.0
    assert made.omega[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        made.rows[0, 0] = 1.0


def test_compliance_is_that_of_the_modes_and_of_the_rest():
    made = basis()
    expected = made.rows @ np.diag(1 / made.omega**2) @ made.rows.T + made.S
    np.testing.assert_allclose(made.compliance, expected, rtol=1e-14)
    np.testing.assert_allclose(made.freq, made.omega / 2 / np.pi, rtol=1e-15)


def test_repr_shows_modes_band_and_the_share_of_S():
    made = basis()
    share = 100 * np.trace(made.S) / np.trace(made.compliance)
    assert repr(made) == f"ModalBasis(rim, 3 modes 15.9-39.9 Hz, 2 channels, S has {share:.1f} % of the " + (
        "static compliance)"
    )
    empty = basis(omega=np.zeros(0), zeta=np.zeros(0), rows=np.zeros((2, 0)))
    assert "no modes" in repr(empty)
    assert len(empty) == 0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"zeta": np.zeros(2)}, r"zeta: found the shape \(2,\), expected \(3,\)"),
        ({"rows": np.zeros((3, 2))}, r"rows: found .* expected \(2, 3\)"),
        ({"S": np.zeros((2, 3))}, r"S: found .* expected \(2, 2\)"),
        ({"omega": np.array([1.0, np.nan, 2.0])}, "omega: found nan"),
        ({"S": np.full((2, 2), np.inf)}, "S: found nan or inf"),
        ({"kind": "ring"}, "kind must be"),
    ],
)
def test_refuses_arrays_that_do_not_fit(changes, message):
    with pytest.raises(cf.errors.InputError, match=message):
        basis(**changes)


def stored_without(path, *names, **replaced):
    with np.load(path) as file:
        data = {name: file[name] for name in file.files if name not in names}
    np.savez(path, **(data | replaced))
    return path


@pytest.mark.parametrize("kept", [0, 10, 200, 900])
def test_refuses_a_file_cut_short(tmp_path, kept):
    path = basis().save(tmp_path / "casing.npz")
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(cf.errors.InputError):
        cf.ModalBasis.load(path)


def test_refuses_a_file_with_a_flipped_byte_in_an_array(tmp_path):
    path = basis().save(tmp_path / "casing.npz")
    data = bytearray(path.read_bytes())
    place = data.find(np.float64(250.0).tobytes())
    data[place + 3] ^= 0xFF
    path.write_bytes(data)
    with pytest.raises(cf.errors.InputError):
        cf.ModalBasis.load(path)


def test_refuses_provenance_that_is_not_json(tmp_path):
    path = stored_without(basis().save(tmp_path / "casing.npz"), provenance=np.array("{not json"))
    with pytest.raises(cf.errors.InputError):
        cf.ModalBasis.load(path)


def test_refuses_files_that_keep_no_basis(tmp_path):
    path = basis().save(tmp_path / "casing.npz")
    with np.load(path) as file:
        data = dict(file)
    for change, words in (
        ({"rows": None, "S": None}, "found no arrays S, rows"),
        ({"format": np.array("other")}, "expected format '.*', found 'other'"),
        ({"format": None}, "found 'None'"),
    ):
        np.savez(path, **{name: value for name, value in (data | change).items() if value is not None})
        with pytest.raises(cf.errors.InputError, match=words):
            cf.ModalBasis.load(path)
    (tmp_path / "text.npz").write_text("no arrays")
    for name in ("absent.npz", "text.npz"):
        with pytest.raises(cf.errors.InputError, match="no readable npz"):
            cf.ModalBasis.load(tmp_path / name)
