"""Identified modes as a file, and as shapes at places: what was written comes back, what does not fit is refused."""

from dataclasses import fields, replace

import numpy as np
import pytest

import casingfem as cf

THETA = 0.2 + 2.0 * np.pi * np.arange(12) / 12
COUNT = len(THETA)


def responses(direction=1):
    """A pair of n = 2 and a mode of n = 3 at sensors on a circle, seen from two references."""
    x = np.arange(90.0, 135.0, 0.05)
    rows = np.stack([np.cos(2 * THETA), np.sin(2 * THETA), np.cos(3 * THETA)], axis=1)
    drives = np.array([[1.0, 0.4, 0.7], [0.3, 1.0, 0.9]])
    freq, zeta = np.array([100.0, 101.0, 125.0]), 0.002
    seen = 1.0 / (freq[:, None] ** 2 - x**2 + 2j * zeta * freq[:, None] * x)
    H = np.concatenate([np.sign(direction) * rows * drive @ seen for drive in drives])
    random = np.random.default_rng(77)
    H = H + 1e-3 * np.abs(H).max() * (random.standard_normal(H.shape) + 1j * random.standard_normal(H.shape))
    return cf.frf.FrfSet.from_arrays(
        kind="frf", x=x, responses=H, unit="m/N", response_point=np.tile(np.arange(1, COUNT + 1), 2),
        response_direction=direction, reference_point=np.repeat([101, 102], COUNT), card=("SYNTHETIC: for a test",),
    )  # fmt: skip


ANGLES = {k + 1: float(np.degrees(a)) for k, a in enumerate(THETA)}
PLACES = {k + 1: (0.4 * np.cos(a), 0.4 * np.sin(a), 0.1) for k, a in enumerate(THETA)}


@pytest.fixture(scope="module")
def found():
    return cf.identify(responses(), angles=ANGLES, places=PLACES)


def equal(a, b):
    return np.array_equal(a, b, equal_nan=True) if isinstance(a, np.ndarray) else a == b


@pytest.mark.slow
def test_every_field_comes_back_bit_for_bit(found, tmp_path):
    again = cf.Identified.load(found.save(tmp_path / "found.npz"))
    for name in (field.name for field in fields(found)):
        ours, theirs = getattr(found, name), getattr(again, name)
        if name in ("sensors", "diagram"):
            assert all(equal(getattr(ours, f.name), getattr(theirs, f.name)) for f in fields(ours)), name
        else:
            assert equal(ours, theirs), name
    assert repr(again) == repr(found)


def test_without_responses_the_modes_are_the_same_and_the_file_is_small(found, tmp_path):
    whole, small = found.save(tmp_path / "whole.npz"), found.save(tmp_path / "small.npz", responses=False)
    assert small.stat().st_size < 0.1 * whole.stat().st_size
    again = cf.Identified.load(small)
    np.testing.assert_array_equal(again.table().freq_hz, found.table().freq_hz)
    np.testing.assert_array_equal(again.shapes, found.shapes)
    assert "without responses" in repr(again)


def spoilt(path, found, **arrays):
    found.save(path)
    with np.load(path) as archive:
        stored = {name: archive[name] for name in archive.files} | arrays
    np.savez(path, **{name: value for name, value in stored.items() if value is not None})
    return path


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"sigma_freq": None}, "no array sigma_freq"),
        ({"sensors.theta": None}, "no array sensors.theta"),
        ({"zeta": np.zeros(2)}, r"zeta of shape \(2,\)"),
        ({"shapes": np.full((COUNT, 3), np.nan)}, "shapes with nan"),
        ({"shapes": np.zeros((COUNT, 2))}, "for 3 modes at 12 sensors"),
        ({"doublets": np.array([[0, 7]])}, "mode 8 in a pair"),
    ],
)
def test_a_file_that_does_not_fit_is_refused(found, tmp_path, arrays, words):
    path = spoilt(tmp_path / "found.npz", found, **arrays)
    with pytest.raises(cf.errors.InputError, match=words) as caught:
        cf.Identified.load(path)
    assert str(path) in str(caught.value)


def test_other_files_are_refused(found, tmp_path):
    (tmp_path / "text.npz").write_text("mode,freq_hz\n", encoding="utf-8")
    with pytest.raises(cf.errors.InputError, match="no readable npz file"):
        cf.Identified.load(tmp_path / "text.npz")
    with pytest.raises(cf.errors.InputError, match="casingfem identify --out"):
        cf.Identified.load(responses().save(tmp_path / "frfs.npz"))
    with pytest.raises(OSError, match="nowhere"):
        cf.Identified.load(tmp_path / "nowhere.npz")
    with pytest.raises(cf.errors.InputError, match=r"found ending '\.csv'"):
        cf.correlation.read_shapes(tmp_path / "found.csv")


def test_shapes_are_at_their_sensors_with_n_and_noise(found, tmp_path):
    shapes = cf.correlation.read_shapes(found.save(tmp_path / "found.npz"))
    np.testing.assert_allclose(shapes.points, list(PLACES.values()))
    np.testing.assert_allclose(shapes.directions[:, 0], np.cos(THETA), atol=1e-12)
    np.testing.assert_allclose(shapes.directions[:, 1], np.sin(THETA), atol=1e-12)
    assert shapes.n.tolist() == [2, 2, 3]
    truth = np.cos(3 * THETA) / np.linalg.norm(np.cos(3 * THETA))
    off = shapes.values[:, 2] - truth * (truth @ shapes.values[:, 2])
    assert 0.3 * shapes.sigma[2] < np.linalg.norm(off) < 3.0 * shapes.sigma[2]


def test_no_mode_has_no_shape(found):
    none = replace(found, freq=found.freq[:0], shapes=found.shapes[:, :0], sigma_shapes=found.sigma_shapes[:, :0])
    with pytest.raises(cf.errors.InputError, match=r"found\.npz: found no mode; expected at least one"):
        cf.correlation.identified_shapes(none, "found.npz")


@pytest.mark.slow
def test_hoop_axial_and_turned_sensors_have_their_directions():
    hoop = cf.correlation.identified_shapes(cf.identify(responses(2), angles=ANGLES, places=PLACES))
    np.testing.assert_allclose(hoop.directions[:, 0], -np.sin(THETA), atol=1e-12)
    axial = cf.correlation.identified_shapes(cf.identify(responses(3), angles=ANGLES, places=PLACES))
    np.testing.assert_allclose(axial.directions, np.tile([0.0, 0.0, 1.0], (COUNT, 1)))
    inward = cf.correlation.identified_shapes(cf.identify(responses(-1), angles=ANGLES, places=PLACES))
    np.testing.assert_allclose(inward.directions[:, 0], -np.cos(THETA), atol=1e-12)
    flat = cf.correlation.identified_shapes(cf.identify(responses(-2), places=PLACES))  # no circle: x, y, z
    np.testing.assert_allclose(flat.directions, np.tile([0.0, -1.0, 0.0], (COUNT, 1)))


@pytest.mark.slow
def test_sensors_without_place_or_direction_are_named(found):
    bare = cf.identify(responses(), angles=ANGLES)
    with pytest.raises(
        cf.errors.InputError, match="no position of point 1; expected positions: responses in a universal"
    ):
        cf.correlation.identified_shapes(bare)
    blind = replace(found, sensors=replace(found.sensors, directions=np.r_[1, 1, 0, np.ones(COUNT - 3, int)]))
    with pytest.raises(cf.errors.InputError, match="direction 0 of point 3"):
        cf.correlation.identified_shapes(blind, "found.npz")


def test_sigma_and_n_of_shapes_are_checked():
    points = np.eye(3)
    common = {"values": np.ones((3, 2)), "points": points, "directions": points}
    shapes = cf.correlation.MeasuredShapes.from_arrays(freq_hz=[20.0, 10.0], sigma=[0.2, 0.1], n=[4, 3], **common)
    assert (shapes.sigma.tolist(), shapes.n.tolist()) == ([0.1, 0.2], [3, 4])  # in the order of the frequencies
    assert np.isnan(cf.correlation.MeasuredShapes.from_arrays(freq_hz=[10.0, 20.0], **common).sigma).all()
    with pytest.raises(cf.errors.InputError, match="a sigma above 0"):
        cf.correlation.MeasuredShapes.from_arrays(freq_hz=[10.0, 20.0], sigma=[0.1, 0.0], **common)
