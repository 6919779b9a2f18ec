"""The modal basis file: round trip, and every way it can be wrong."""

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

KEYS = ("omega", "zeta", "rows", "S", "channels", "kind")


def written(path, **changes):
    """Save a basis file with keys replaced, or left out where the change is None."""
    body = ring()
    data = {"format": "casingfem-modal-basis-1", "n_max": body.n_max, "radius": body.radius}
    data |= {key: np.array(getattr(body, key)) for key in KEYS} | changes
    np.savez(path, **{key: value for key, value in data.items() if value is not None})
    return path


def test_round_trip(tmp_path):
    body = ring(imperfect=0.05)
    body.save(tmp_path / "casing.npz")
    again = ct.ModalBody.load(tmp_path / "casing.npz")
    for key in ("omega", "zeta", "rows", "S"):
        assert np.array_equal(getattr(again, key), getattr(body, key))
    assert (again.channels, again.kind, again.n_max, again.radius) == (body.channels, "rim", 6, 0.45)
    assert [file.name for file in tmp_path.iterdir()] == ["casing.npz"]
    assert not again.omega.flags.writeable


def test_recovery_is_kept(tmp_path):
    body = ct.ModalBody(
        omega=[1.0, 9.0], zeta=[0.0, 0.0], channels=("span", "flap"), rows=np.eye(2), S=np.zeros((2, 2)),
        recovery=[[1.0, 2.0]], recovery_S=[[0.0, 0.1]], recovery_points=[[0.0, 0.0, 1.0]], provenance='{"a": 1}',
    )  # fmt: skip
    body.save(tmp_path / "blade.npz")
    again = ct.ModalBody.load(tmp_path / "blade.npz")
    assert np.array_equal(again.recovery_S, [[0.0, 0.1]])
    assert again.provenance == '{"a": 1}'
    short = again.truncated(5.0)
    assert np.allclose(short.recovery_S, [[0.0, 0.1 + 2.0 / 81.0]])


def test_retuning_scales_what_a_force_moves_elsewhere_by_the_square_of_the_ratio():
    body = ct.ModalBody(
        omega=[0.0, 2.0, 8.0], zeta=[0.0] * 3, channels=("span",), rows=[[0.0, 1.0, 2.0]], S=[[0.3]],
        recovery=[[0.0, 3.0, 1.0]], recovery_S=[[0.5]],
    )  # fmt: skip
    again = body.retuned(3.0 / np.pi)  # the lowest elastic one from 2 to 6 rad/s, everything nine times as stiff
    assert again.omega == pytest.approx([0.0, 6.0, 24.0], rel=1e-15)
    moved = [
        (one.recovery[0, 1:] * one.rows[0, 1:]) @ one.omega[1:] ** -2.0 + one.recovery_S[0, 0] for one in (body, again)
    ]
    assert moved[0] == pytest.approx(0.75 + 2.0 / 64.0 + 0.5, rel=1e-15)
    assert moved[1] == pytest.approx(moved[0] / 9.0, rel=1e-14)


def test_empty_recovery_counts_as_none(tmp_path):
    none = np.zeros((0, 0))
    file = written(tmp_path / "casing.npz", recovery=none, recovery_S=none, recovery_points=np.zeros((0, 3)))
    body = ct.ModalBody.load(file)
    assert body.recovery is None
    assert body.truncated(1e3).omega.size < body.omega.size


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"omega": None}, "missing keys omega"),
        ({"format": "other"}, "key 'format': found 'other', expected 'casingfem-modal-basis-1'"),
        ({"omega": np.ones(3)}, r"zeta: found shape \(10,\), expected \(3,\)"),
        ({"rows": np.full((26, 10), np.nan)}, "rows: found 260 entries that are NaN"),
        ({"omega": -np.ones(10)}, "omega: found -1 rad/s"),
        ({"zeta": np.full(10, 2.0)}, "zeta: found 2 .. 2, expected 0 <= zeta < 1"),
        ({"S": np.triu(np.ones((26, 26)))}, "S: found asymmetry"),
        ({"recovery": np.ones((3, 4))}, r"recovery: found shape \(3, 4\), expected \(3, 10\)"),
        ({"kind": "disk"}, "kind: found 'disk', expected 'rim' or 'point'"),
        ({"n_max": 5}, "expected the 22 channels of a rim with n_max = 5"),
    ],
)
def test_bad_files_name_file_and_key(tmp_path, changes, message):
    with pytest.raises(ct.InputError, match=message) as caught:
        ct.ModalBody.load(written(tmp_path / "casing.npz", **changes))
    assert "casing.npz" in str(caught.value)


def test_files_that_are_no_basis(tmp_path):
    with pytest.raises(ct.InputError, match=r"absent.npz: found no such file"):
        ct.ModalBody.load(tmp_path / "absent.npz")
    (tmp_path / "text.npz").write_text("not a zip")
    with pytest.raises(ct.InputError, match=r"text.npz: not a readable npz"):
        ct.ModalBody.load(tmp_path / "text.npz")
    np.savez(tmp_path / "pickled.npz", omega=np.array([{}], dtype=object))
    with pytest.raises(ct.InputError, match=r"pickled.npz: not a readable npz"):
        ct.ModalBody.load(tmp_path / "pickled.npz")
    whole = written(tmp_path / "whole.npz").read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ct.InputError, match=r"cut.npz"):
        ct.ModalBody.load(tmp_path / "cut.npz")


def test_channels_are_found_by_name():
    assert blade().channel("flap") == 1
    with pytest.raises(ct.InputError, match="expected one of span, flap"):
        blade().channel("tip")
