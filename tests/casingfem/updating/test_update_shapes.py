"""Measured shapes: sign and turn do not matter, derivatives are exact, and they say what frequencies cannot."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.probed import numbers_of_result

MESH = cf.ShellMesh(order=5, rows=1, around=9)
COUNT, ROWS = 16, 8
THETA = 2.0 * np.pi * np.arange(24) / 24 + 0.05


def casing(frustum, c8=0.002, k=5e11):
    return frustum(
        supports={"base": cf.ElasticEdge(k_face=k, around=cf.FourierField.of({3: (0.4, 0.2)}))},
        radius_defect=cf.FourierField.of({8: (c8, 0.001), 3: (0.001, 0.001)}), mesh=MESH,
    )  # fmt: skip


def measured(shell, turn=0.0, noise=0.0):
    """A table, and shapes of it: doublets turned in their plane, signs at random."""
    found = cf.modes(shell, COUNT)
    table = cf.FrequencyTable.from_arrays(
        freq_hz=found.freq[:ROWS], sigma_hz=1e-3 * found.freq[:ROWS], n=found.nodal_diameters[:ROWS]
    )
    blank = cf.updating.SensorShapes.on_edge(shell, "top", THETA, np.ones((len(THETA), 1)), 0.01)
    shapes = blank.readings(found)[:, :ROWS].copy()
    random = np.random.default_rng(31)
    for low, high in found.doublets:
        if high < ROWS:
            c, s = np.cos(turn), np.sin(turn)
            shapes[:, [low, high]] = shapes[:, [low, high]] @ np.array([[c, -s], [s, c]])
    shapes = shapes / np.linalg.norm(shapes, axis=0) * random.choice([-3.0, 2.0], ROWS)
    shapes += noise * np.linalg.norm(shapes, axis=0) * random.standard_normal(shapes.shape)
    return table, cf.updating.SensorShapes.on_edge(shell, "top", THETA, shapes, noise or 0.01)


@pytest.mark.slow
def test_an_update_with_shapes_finds_the_truth_and_knows_more(frustum, held):
    truth = casing(frustum, c8=0.0025)
    start = cf.updating.with_value(casing(frustum), "support.base.around.p3.cos", 0.3)
    table, shapes = measured(truth, turn=0.4, noise=0.005)
    vary = [
        cf.Parameter(name="radius.p8.cos", lower=-0.01, upper=0.01),
        cf.Parameter(name="support.base.around.p3.cos", lower=-0.5, upper=0.7),
    ]
    bare = cf.update(start, table, vary)
    fit = cf.update(start, table, vary, shapes=shapes)
    assert (fit.sigma < bare.sigma).all()
    assert fit.sigma[1] < 0.7 * bare.sigma[1]
    assert (np.abs(np.subtract(fit.value, [0.0025, 0.4])) < 3.5 * fit.sigma).all()
    assert 0.8 < fit.misfit < 1.2
    assert fit.free == fit.residuals - 2 * ROWS - 2  # two modes a shape, two parameters
    compared = cf.updating.shape_fit(fit)
    held(1e-4, **numbers_of_result(fit), **numbers_of_result(compared, "shapes "))
    first, *others = compared.before.found
    without = replace(compared, before=replace(compared.before, found=(first._replace(mode=None), *others)))
    numbers = [None, *(match.mode + 1 for match in others)]
    assert [row["computed_before"] for row in without.records()] == numbers


@pytest.mark.slow
def test_eight_sensors_at_each_place_give_the_fit_of_one(frustum):
    """A shape has unit norm and sigma is that of its values: eight of each value, an eighth of the square each."""
    truth, start = casing(frustum, c8=0.0025), casing(frustum, c8=0.0024)
    table, once = measured(truth, turn=0.4)
    angles, shapes = np.repeat(THETA, 8), np.repeat(once.shapes, 8, axis=0)
    often = cf.updating.SensorShapes.on_edge(start, "top", angles, shapes, 0.01)
    vary = [cf.Parameter(name="radius.p8.cos", lower=-0.01, upper=0.01)]
    one, many = (cf.update(start, table, vary, shapes=given) for given in (once, often))
    assert many.value[0] == pytest.approx(0.0025, abs=1e-7)
    assert many.sigma[0] == pytest.approx(one.sigma[0], rel=1e-4)


def test_sensors_without_labels_are_numbered_from_1(frustum):
    shapes = cf.updating.SensorShapes.on_edge(casing(frustum), "top", THETA, np.ones((24, 1)), 0.01)
    assert shapes.labels.tolist() == list(range(1, 25))


def test_shapes_that_do_not_fit_are_refused(frustum):
    table, shapes = measured(casing(frustum))
    vary = [cf.Parameter(name="material.E", lower=1e11, upper=3e11)]
    with pytest.raises(cf.errors.InputError, match="found 3 columns, expected 8"):
        cf.update(casing(frustum), table, vary, shapes=shapes.only([0, 1, 2]))
    with pytest.raises(ValueError, match="column 2 with only zeros or with some nan"):
        cf.updating.SensorShapes.on_edge(casing(frustum), "top", THETA, np.tile([1.0, 0.0], (24, 1)), 0.01)
    with pytest.raises(ValueError, match="'middle', expected an edge that runs around"):
        cf.updating.SensorShapes.on_edge(casing(frustum), "middle", THETA, np.ones((24, 1)), 0.01)
    with pytest.raises(ValueError, match="expected one number above 0"):
        cf.updating.SensorShapes.on_edge(casing(frustum), "top", THETA, np.ones((24, 1)), 0.0)


@pytest.mark.parametrize(
    ("freq", "n", "words"),
    [
        ([100.04, 300.0], [-1, -1], "the shape at 100.04 Hz, which fits modes 1 and 2 of table, at 100 and 100.1 Hz"),
        ([100.045, 100.055], [-1, -1], "fits modes 1 and 2"),  # exchanged, both differ hardly more
        ([299.9, 300.15], [-1, -1], "two shapes, 299.9 and 300.15 Hz, that fit mode 3 of table"),
        ([400.0, 500.0], [-1, -1], r"the shape at 400 Hz and mode 3 of table at 300 Hz; .*at most 0.1 % apart"),
        ([0.1, 0.3], [-1, -1], r"frequencies that are 0\.001 times those in table: they are probably in kHz"),
        ([6006.0, 18000.0], [-1, -1], r"frequencies that are 60 times those in table: they are probably in 1/min"),
        ([628.3185, 1884.956], [-1, -1], r"frequencies that are 6\.283 times those in table: .* in rad/s"),
        ([99.95, 100.15], [4, 3], r"the shape at 100.15 Hz \(n = 3\) and mode 2 of table at 100.1 Hz \(n = 4\)"),
    ],
)
def test_shapes_that_fit_no_row_or_more_than_one_are_refused(frustum, freq, n, words):
    with pytest.raises(cf.errors.InputError, match=words):
        rows_of(frustum, freq, n)


def test_each_shape_has_the_row_of_its_number_and_frequency(frustum):
    assert rows_of(frustum, [100.04, 300.0], [4, -1]).tolist() == [False, True, True]
    assert rows_of(frustum, [100.04, 300.0], [3, 7]).tolist() == [True, False, True]
    assert rows_of(frustum, [100.0, 100.1], [-1, -1]).tolist() == [True, True, False]


def rows_of(frustum, freq, n):
    """Whether each row of a table has a shape."""
    shell, table = (
        casing(frustum),
        cf.FrequencyTable.from_arrays(freq_hz=[100.0, 100.1, 300.0], sigma_hz=0.1, n=[3, 4, -1]),
    )
    point = np.real(shell.geometry(np.array([0.25]), np.array([0.3])).surface.x).T
    shapes = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=freq, values=[[1.0, 2.0]], n=n, points=point, directions=[[0.0, 0.0, 1.0]]
    )
    return np.isfinite(cf.updating.SensorShapes.of(shapes, shell, table, sigma=0.01).shapes[0])


def test_noise_over_a_shapes_rms_is_spread_over_the_sensors_of_a_shape_of_unit_norm(frustum):
    """A shape of unit norm at 24 sensors has an rms of 1/sqrt(24); the model's error adds in squares."""
    shell = casing(frustum)
    out = np.column_stack([np.cos(THETA), np.sin(THETA), 0.0 * THETA])
    points = np.real(shell.geometry(np.full(len(THETA), 0.25), THETA).surface.x).T
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.0, 200.0, 300.0], sigma_hz=0.1)
    values = np.cos(np.multiply.outer(THETA, [2, 3]))
    shapes = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=[300.0, 100.0], values=values, points=points, directions=out, sigma=[0.03, 0.12]
    )
    found = cf.updating.SensorShapes.of(shapes, shell, table, error=0.04)
    told = found.sigma_of(range(3)) * np.sqrt(len(THETA))
    np.testing.assert_allclose(told, [np.hypot(0.12, 0.04), np.nan, 0.05], rtol=1e-12)
    same = cf.updating.SensorShapes.of(shapes, shell, table, sigma=0.03, error=0.04).sigma_of([0, 2])
    np.testing.assert_allclose(same * np.sqrt(len(THETA)), 0.05, rtol=1e-12)
    np.testing.assert_allclose(found.shapes[:, 2], values[:, 0] / np.linalg.norm(values[:, 0]), rtol=1e-12)
