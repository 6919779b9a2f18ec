"""The modal basis file: round trip, and every way it can be wrong."""

from dataclasses import fields, replace

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
        recovery=[[0.0, 3.0, 1.0]], recovery_S=[[0.5]], outputs=("u",), output_rows=[[0.0, 3.0, 1.0]], output_S=[[0.5]],
    )  # fmt: skip
    again = body.retuned(3.0 / np.pi)  # the lowest elastic one from 2 to 6 rad/s, everything nine times as stiff
    assert again.omega == pytest.approx([0.0, 6.0, 24.0], rel=1e-15)
    moved = [
        (one.recovery[0, 1:] * one.rows[0, 1:]) @ one.omega[1:] ** -2.0 + one.recovery_S[0, 0] for one in (body, again)
    ]
    assert moved[0] == pytest.approx(0.75 + 2.0 / 64.0 + 0.5, rel=1e-15)
    assert moved[1] == pytest.approx(moved[0] / 9.0, rel=1e-14)
    assert np.array_equal(again.output_S, again.recovery_S)  # an output at the point of the recovery


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
        (
            {"K_omega": np.eye(10)},
            "found unknown keys K_omega, expected those of this version: reduce the structure again",
        ),
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


def three(**more):
    """Three modes, not in order of frequency, seen in two channels."""
    given = {
        "omega": [5.0, 1.0, 9.0], "zeta": [0.0, 0.01, 0.02], "channels": ("span", "flap"),
        "rows": [[1.0, 2.0, 3.0], [0.0, 4.0, 6.0]], "S": np.eye(2),
    }  # fmt: skip
    return ct.ModalBody(**given | more)


def two_lines(**more):
    """A rim seen on two lines, without a mode that moves it."""
    channels = ct.bodies.rim_channels(2, 2, 2)
    given = {"omega": [1.0], "zeta": [0.0], "channels": channels, "rows": np.zeros((20, 1)), "S": np.eye(20)}
    return ct.ModalBody(**given | {"kind": "rim", "n_max": 2, "radius": 0.4} | more)


@pytest.mark.parametrize(
    ("make", "changes", "message"),
    [
        (three, {"recovery": np.ones((4, 3)), "recovery_S": np.ones((3, 2))}, r"recovery_S: .* expected \(4, 2\)"),
        (three, {"outputs": ("a",), "output_rows": np.ones((2, 3))}, r"output_rows: .*\(2, 3\), expected \(1, 3\)"),
        (three, {"outputs": ("a",), "output_S": np.ones((1, 3))}, r"output_S: .*\(1, 3\), expected \(1, 2\)"),
        (three, {"outputs": ("a", "a"), "output_rows": np.ones((2, 3))}, "outputs: found"),
        (three, {"stiffness_by_speed": np.eye(2)}, r"stiffness_by_speed: found shape \(2, 2\), expected \(3, 3\)"),
        (
            three,
            {"gyroscopic": np.eye(3)},
            r"gyroscopic: found 1 at \(0, 0\) and 1 at \(0, 0\), expected a skew-symmetric matrix",
        ),
        (
            three,
            {"gyroscopic_higher": [np.zeros((3, 3)), np.diag([0.0, 0.0, 2.0])]},
            r"gyroscopic_higher\[1\]: found 2 at \(2, 2\) and 2 at \(2, 2\), expected a skew-symmetric matrix",
        ),
        (three, {"participation": np.ones((2, 3))}, r"participation: found shape \(2, 3\), expected \(3, 3\)"),
        (three, {"out_of_roundness": np.ones((1, 1))}, r"out_of_roundness: found shape \(1, 1\), expected \(0, 1\)"),
        (three, {"zeta": [0.0, 1.0, 0.0]}, "zeta: found 0 .. 1, expected 0 <= zeta < 1"),
        (three, {"zeta": [0.0, -0.1, 0.0]}, r"zeta: found -0\.1 .. 0, expected 0 <= zeta < 1"),
        (two_lines, {"out_of_roundness": np.ones((1, 5))}, r"out_of_roundness: .*\(1, 5\), expected \(2, 5\)"),
        (two_lines, {"lines": np.ones((1, 2))}, r"lines: found shape \(1, 2\), expected \(2, 2\)"),
        (two_lines, {"radius": -0.4}, r"radius: found -0\.4, expected a finite number >= 0"),
        (two_lines, {"thickness": -1e-3}, r"thickness: found -0\.001, expected a finite number >= 0"),
    ],
)
def test_arrays_that_do_not_fit_each_other_are_refused(make, changes, message):
    make()
    with pytest.raises(ct.InputError, match=message):
        make(**changes)


def test_truncation_takes_the_same_modes_out_of_every_array():
    nine, participation = np.arange(9.0).reshape(3, 3), np.arange(9.0).reshape(3, 3) + 10.0
    skew = np.array([[0.0, 1.0, 2.0], [-1.0, 0.0, 3.0], [-2.0, -3.0, 0.0]])
    whole = three(
        stiffness_by_speed=nine, damping=nine + 1.0, stiffness=nine + 2.0, gyroscopic=skew, participation=participation
    )
    short = whole.truncated(1.0)  # a mode at the limit is kept
    assert short.omega == short.rows[0] / 2.0 == [1.0]
    assert (short.zeta, short.stiffness_by_speed) == ([0.01], [[4.0]])
    assert (short.damping, short.stiffness, short.gyroscopic) == ([[5.0]], [[6.0]], [[0.0]])
    np.testing.assert_array_equal(whole.truncated(5.0).gyroscopic, skew[:2, :2])
    assert short.participation[:, 0].tolist() == [11.0, 14.0, 17.0]
    expected = np.eye(2) + np.diag([1.0, 0.0]) / 25.0 + np.array([[9.0, 18.0], [18.0, 36.0]]) / 81.0
    np.testing.assert_allclose(short.S, expected, rtol=1e-15)


def test_roundness_and_radius_are_those_of_the_line_asked_for():
    found = np.array([[1e-3, 2e-5, 0.0, -3e-5, 0.0], [0.0, 0.0, 4e-5, 0.0, 5e-5]])  # cos0 .. cos2, sin1, sin2
    body = two_lines(out_of_roundness=found, lines=[[0.0, 0.41], [0.1, 0.43]])
    assert body.rim_lines == 2
    assert body.roundness() == body.roundness(0) == [{"p": 1, "cos": 2e-5, "sin": -3e-5}]
    assert body.roundness(1) == [{"p": 2, "cos": 4e-5, "sin": 5e-5}]
    assert [body.line_radius(k) for k in (0, 1)] == [0.41, 0.43]
    assert two_lines().line_radius(1) == 0.4
    with pytest.raises(ct.InputError, match="out_of_roundness: found none in the basis"):
        two_lines().roundness()


def test_whirl_of_a_disk_from_the_matrices_of_its_body():
    """Foucault's pendulum: two modes of w that turn at W have the frequencies w +- W in the turning frame."""
    w, W, G = 5.0, 0.7, np.array([[0.0, -2.0], [2.0, 0.0]])
    body = ct.ModalBody(
        omega=[w, w], zeta=[0.01, 0.01], channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)), gyroscopic=G,
        stiffness_by_speed=-np.eye(2), spin=0.0, damping=np.zeros((2, 2)), stiffness=np.zeros((2, 2)),
    )  # fmt: skip
    C, K = body.matrices(W)
    np.testing.assert_allclose(C, 0.1 * np.eye(2) + W * G, rtol=1e-15)
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K, -(C - 0.1 * np.eye(2))]])
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(A).imag), [-w - W, -w + W, w - W, w + W], rtol=1e-12)
    C, K = replace(body, spin=W, damping=[[1.0, 2.0], [3.0, 4.0]], stiffness=[[0.0, 6.0], [-6.0, 0.0]]).matrices(W)
    np.testing.assert_allclose(C, [[1.1, 2.0 - 2.0 * W], [3.0 + 2.0 * W, 4.1]], rtol=1e-15)
    assert K.tolist() == [[25.0, 6.0], [-6.0, 25.0]]  # the modes are those of this speed


def test_detuning_is_drawn_by_the_seed_and_linear_in_the_scatter():
    draw = np.random.default_rng(3).standard_normal(3)
    np.testing.assert_allclose(three().detuned(0.01, seed=3).omega / [5.0, 1.0, 9.0], 1.0 + 0.01 * draw, rtol=1e-15)
    assert three().detuned(0.0, seed=3).omega.tolist() == [5.0, 1.0, 9.0]
    with pytest.raises(ct.InputError, match=r"scatter: found -0\.01, expected a finite number >= 0"):
        three().detuned(-0.01, seed=3)


def test_retuning_goes_by_the_lowest_elastic_mode_and_to_a_positive_frequency():
    body = three(omega=[4.0, 0.0, 2.0])
    np.testing.assert_allclose(body.retuned(0.5 / np.pi).omega, [2.0, 0.0, 1.0], rtol=1e-15)
    with pytest.raises(ct.InputError, match=r"freq_hz: found 0\.0, expected a finite number > 0"):
        body.retuned(0.0)


def test_single_numbers_and_every_array_come_back_from_the_file(tmp_path):
    wheel = three(
        channels=("sector0.span", "sector1.span"), sectors=2, spin=7.5, stiffness_by_speed=2.0 * np.eye(3),
        gyroscopic=np.zeros((3, 3)), damping=3.0 * np.eye(3), stiffness=np.arange(9.0).reshape(3, 3),
        participation=np.arange(9.0).reshape(3, 3), recovery=np.ones((4, 3)), recovery_points=np.ones((4, 3)),
        recovery_cells=[[0, 1, 2, 3]],
    )  # fmt: skip
    for body in (wheel, two_lines(thickness=2e-3, lines=[[0.0, 0.41], [0.1, 0.43]], out_of_roundness=np.ones((2, 5)))):
        body.save(tmp_path / "body.npz")
        again = ct.ModalBody.load(tmp_path / "body.npz")
        for name in (field.name for field in fields(ct.ModalBody)):
            np.testing.assert_array_equal(getattr(again, name), getattr(body, name), err_msg=name)


def test_what_is_no_basis_in_memory_is_refused_by_name():
    class Own:
        def arrays(self):
            return {"omega": np.ones(1), "zeta": np.zeros(1), "channels": np.array(["span"]), "kind": "point"}

    with pytest.raises(ct.InputError, match=r"basis: missing rows, S$"):
        ct.ModalBody.of(Own())
    with pytest.raises(ct.InputError, match="basis: found float, expected a reduced basis"):
        ct.ModalBody.of(1.0)
