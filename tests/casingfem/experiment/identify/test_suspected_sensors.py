"""Wrong sensors of a circle: each kind is named at its limit, with what it is, and no right one beside it."""

import re

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.test_completeness import ANGLES, THETA, receptances

N = np.array([2, 2, 3, 3, 4, 4, 1, 1])
ONE = 6  # the sensor that is wrong


def waves(count=16, modes=8):
    theta = THETA[:count]
    return np.cos(N[:modes] * theta[:, None] - 0.7 * np.arange(modes)), theta


def named(shapes, theta, most=5):
    """Notes on the sensors 101, 102, ... of responses of modes with these shapes, by the sensors named."""
    points, freq = np.arange(len(theta)) + 101, 100.0 + 15.0 * np.arange(shapes.shape[1])
    x = np.arange(90.0, freq[-1] + 10.0, 0.1)
    frfs = receptances(x, [(f, 4e-3, r) for f, r in zip(freq, shapes.T, strict=True)], response_point=points)
    found = cf.identify(frfs, angles=dict(zip(points.tolist(), np.degrees(theta).tolist(), strict=True)), n_max=most)
    np.testing.assert_allclose(found.freq, freq, rtol=1e-5)
    assert found.sure.all()
    about = [note for note in found.notes if note.startswith("point")]
    return {tuple(int(word) - 101 for word in re.findall(r"\b1\d\d\b", note.partition(":")[0])): note for note in about}


def test_right_sensors_are_not_named():
    assert named(*waves()) == {}


@pytest.mark.parametrize("size", [1e-6, 1e-3])
def test_a_sensor_without_a_signal_of_the_structure_is_named(size):
    shapes, theta = waves()
    shapes[ONE] = size * np.array([1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0]) * np.sign(shapes[ONE])
    found = named(shapes, theta)
    assert set(found) == {(ONE,)}
    assert found[ONE,].startswith("point 107 does not move as the others predict, in ")
    assert found[ONE,].endswith(" modes: no signal, loose, or at another angle?")


@pytest.mark.parametrize("seed", range(6))
def test_a_sensor_of_noise_alone_has_no_sign_and_no_scale(seed):
    """By chance its noise may go with the prediction, or against it."""
    shapes, theta = waves()
    shapes[ONE] = 1e-4 * np.random.default_rng(seed).standard_normal(shapes.shape[1])
    found = named(shapes, theta)
    assert set(found) == {(ONE,)}
    assert found[ONE,].endswith(" modes: no signal, loose, or at another angle?")


def test_a_sensor_of_the_wrong_sign_is_named():
    shapes, theta = waves()
    shapes[ONE] *= -1.0
    found = named(shapes, theta)
    assert set(found) == {(ONE,)}
    assert found[ONE,].startswith("point 107 seems to have the wrong sign: in ")


@pytest.mark.parametrize(
    ("scale", "words"),
    [(0.49, "moves 0.49 times"), (0.51, ""), (1.99, ""), (2.01, "moves 2 times"), (37.3, "moves 37 times")],
)
def test_a_sensor_is_named_beyond_twice_or_half_of_what_the_others_predict(scale, words):
    shapes, theta = waves()
    shapes[ONE] *= scale
    found = named(shapes, theta)
    assert set(found) == ({(ONE,)} if words else set())
    for why in found.values():
        assert why.startswith(f"point 107 {words} as much as the others predict, in ")
        assert why.endswith("wrong sensitivity or unit?")


def test_exchanged_sensors_are_named_together_and_once():
    theta = np.arange(12) * np.pi / 6
    shapes = np.cos(N * theta[:, None] - 0.7 * np.arange(8))
    shapes[[7, 9]] = shapes[[9, 7]]
    found = named(shapes, theta)
    assert set(found) == {(7, 9)}
    assert found[7, 9] == "points 108 and 110 seem exchanged: in 7 modes each moves as the other should"


@pytest.mark.parametrize(("sensors", "modes", "found"), [(8, 5, {(3,)}), (7, 5, set()), (8, 4, set())])
def test_sensors_are_judged_from_eight_of_them_and_five_modes_on(sensors, modes, found):
    theta = 2.0 * np.pi * np.arange(sensors) / sensors
    shapes = np.cos(np.array([1, 1, 2, 2, 0])[:modes] * theta[:, None] - 0.7 * np.arange(modes))
    shapes[3] *= -1.0
    assert set(named(shapes, theta, most=2)) == found


def test_no_sensor_is_named_where_most_disagree():
    shapes, theta = waves()
    assert named(np.random.default_rng(1).standard_normal(shapes.shape), theta) == {}


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1.0, 4.0])
def test_labels_are_those_without_the_wrong_sensor(scale):
    x = np.arange(180.0, 320.0, 0.1)
    orders = [2, 2, 3, 3, 4, 4]
    shapes = np.cos(np.array(orders) * THETA[:, None] - 0.4 - np.pi / 2 * (np.arange(6) % 2))
    shapes[5] *= scale
    shapes[10] *= 1.0 if scale == 1.0 else -1.0
    freqs = [200.0, 202.0, 240.0, 243.0, 290.0, 294.0]
    found = cf.identify(
        receptances(x, [(f, 2e-3, shape) for f, shape in zip(freqs, shapes.T, strict=True)], noise=0.1), angles=ANGLES
    )
    assert found.n.tolist() == orders
    about = [note for note in found.notes if note.startswith("point ")]
    assert len(about) == (2 if scale > 1.0 else 0)
    if about:
        assert about[0].startswith("point 5 moves 4 times as much as the others predict, in 6 modes")
        assert about[1].startswith("point 10 seems to have the wrong sign")
    np.testing.assert_allclose(np.diff(found.angle_deg.reshape(3, 2))[:, 0] % (180.0 / np.array([2, 3, 4])),
                               90.0 / np.array([2, 3, 4]), atol=0.5)  # fmt: skip
