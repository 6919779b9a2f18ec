"""Sensors and their shapes: what is refused, what they read of a motion, which rows and planes they see."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
CASING = cf.Shell(
    chart=cf.Frustum(r_base=0.5, r_top=0.4, height=0.25), thickness=3e-3, material=STEEL,
    supports={"base": cf.Clamped()}, mesh=cf.ShellMesh(order=4, rows=1, around=8),
)  # fmt: skip
NAN = np.nan
THETA = np.array([0.1, 0.9, 2.0])


def sensors(shapes=((3.0, NAN, 1.0), (4.0, NAN, -1.0), (0.0, NAN, 0.0)), sigma=0.1, **changes):
    given = {"a": np.array([0.1, 0.2, 0.25]), "b": THETA, "directions": np.eye(3)} | changes
    return cf.updating.SensorShapes(shapes=np.array(shapes), sigma=sigma, **given)


def test_shapes_are_scaled_to_unit_norm_and_have_a_sigma_each():
    found = sensors(sigma=np.array([0.1, 5.0, 0.3]))
    np.testing.assert_allclose(found.shapes[:, [0, 2]], [[0.6, 0.5**0.5], [0.8, -(0.5**0.5)], [0.0, 0.0]], rtol=1e-14)
    assert np.isnan(found.shapes[:, 1]).all()
    np.testing.assert_array_equal(found.sigma, [0.1, NAN, 0.3])
    np.testing.assert_array_equal(sensors(sigma=0.2).sigma, [0.2, NAN, 0.2])
    assert found.labels.tolist() == [1, 2, 3]
    assert sensors(labels=np.array([7, 8, 9])).labels.tolist() == [7, 8, 9]
    assert sensors(sigma=np.array([0.1, NAN, 0.3])).sigma_of([2, 0]).tolist() == [0.3, 0.1]
    few = replace(found, unused_hz=(5.0,)).only([2, 0])
    np.testing.assert_allclose(few.shapes, found.shapes[:, [2, 0]], rtol=1e-14)
    assert few.sigma.tolist() == [0.3, 0.1]
    assert few.unused_hz == (5.0,)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"b": np.zeros(2)}, r"found 3 places, directions \(3, 3\), shapes \(3, 3\)"),
        ({"directions": np.eye(3)[:, :2]}, r"found 3 places, directions \(3, 2\)"),
        ({"a": np.zeros(2), "b": np.zeros(2), "directions": np.eye(3)[:2]}, "found 2 places"),
        ({"shapes": ((1.0, 1.0), (1.0, NAN), (1.0, 1.0))}, "column 2 with only zeros or with some nan"),
        ({"shapes": ((0.0, 1.0), (0.0, 1.0), (0.0, 1.0))}, "column 1 with only zeros or with some nan"),
        ({"sigma": np.array([0.1, 0.2])}, "expected one number above 0, or 3"),
        ({"sigma": np.array([0.1, 0.1, 0.0])}, "expected one number above 0, or 3"),
        ({"sigma": NAN}, "expected one number above 0, or 3"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        sensors(**changes)


def test_a_circle_of_sensors_measures_radially_on_its_edge():
    found = cf.updating.SensorShapes.on_edge(CASING, "base", THETA, np.ones((3, 2)), 0.2)
    np.testing.assert_array_equal(found.a, np.zeros(3))
    np.testing.assert_allclose(
        found.directions, np.column_stack([np.cos(THETA), np.sin(THETA), 0.0 * THETA]), atol=1e-14
    )
    np.testing.assert_array_equal(
        cf.updating.SensorShapes.on_edge(CASING, "top", THETA, np.ones((3, 1)), 0.2).a, np.full(3, 0.25)
    )
    plate = cf.Shell(chart=cf.Plate(length=1.0, width=0.5), thickness=0.01, material=STEEL)
    for shell, edge in ((plate, "root"), (CASING, "rim")):
        with pytest.raises(ValueError, match=f"{edge!r}, expected an edge that runs around"):
            cf.updating.SensorShapes.on_edge(shell, edge, THETA, np.ones((3, 1)), 0.2)


def test_measured_shapes_need_a_noise_and_show_what_is_unused(frustum):
    points = np.array([[np.cos(t), np.sin(t), 0.0] for t in THETA]) * 0.46 + [0.0, 0.0, 0.1]
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.0, 200.0], sigma_hz=0.1)

    def shapes(sigma):
        return cf.correlation.MeasuredShapes.from_arrays(
            freq_hz=[100.0, 150.0, 200.0], values=np.eye(3) + 0.1, points=points, directions=np.eye(3), sigma=sigma,
            labels=np.array([4, 5, 9]),
        )  # fmt: skip

    found = cf.updating.SensorShapes.of(shapes([0.1, 0.2, 0.3]), CASING, table)
    assert found.unused_hz == (150.0,)
    assert found.labels.tolist() == [4, 5, 9]
    np.testing.assert_allclose(found.sigma * np.sqrt(3.0), [0.1, 0.3], rtol=1e-12)
    np.testing.assert_allclose(found.a, 0.1, atol=1e-12)
    np.testing.assert_allclose(found.b, THETA, rtol=1e-12)
    with pytest.raises(cf.errors.InputError, match="no uncertainty of the shapes"):
        cf.updating.SensorShapes.of(shapes([0.1, np.nan, 0.3]), CASING, table)
    told = cf.updating.SensorShapes.of(shapes([0.1, np.nan, 0.3]), CASING, table, sigma=0.2)
    np.testing.assert_allclose(told.sigma * np.sqrt(3.0), 0.2, rtol=1e-12)
