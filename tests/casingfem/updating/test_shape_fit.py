"""Shapes of an update before and after: what the page says is what the modes do."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

import casingfem as cf
from casingfem.plot.correlation import mac_panel
from casingfem.plot.pages.fit import figure_shape_mac, shapes_section
from casingfem.updating.shape_fit import shape_fit
from tests.test_results import assert_whole

THETA = 2.0 * np.pi * np.arange(20) / 20 + 0.05
ROWS = 8
LOOSE = 7


@pytest.fixture(scope="module")
def fit(frustum):
    """An update of one harmonic; no shape of the last row, a shape of no row, one sensor that lies."""
    mesh = cf.ShellMesh(order=5, rows=1, around=9)
    truth = frustum(
        supports={"base": cf.ElasticEdge(k_face=5e11, around=cf.FourierField.of({3: (0.4, 0.2)}))},
        radius_defect=cf.FourierField.of({8: (0.002, 0.001)}), mesh=mesh,
    )  # fmt: skip
    found = cf.modes(truth, 14)
    table = cf.FrequencyTable.from_arrays(
        freq_hz=found.freq[:ROWS], sigma_hz=1e-3 * found.freq[:ROWS], n=found.nodal_diameters[:ROWS]
    )
    seen = [*range(ROWS - 1), 11]
    out = np.column_stack([np.cos(THETA), np.sin(THETA), 0.0 * THETA])
    points = np.real(truth.geometry(np.full(20, 0.25), THETA).surface.x).T
    blank = cf.updating.SensorShapes.on_edge(truth, "top", THETA, np.ones((20, 1)), 0.01)
    values = blank.readings(found)[:, seen]
    values[LOOSE] *= np.random.default_rng(3).uniform(-1.0, 1.0, len(seen))
    measured = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=found.freq[seen], values=values, points=points, directions=out, labels=np.arange(101, 121), sigma=0.05
    )
    start = cf.updating.with_value(truth, "support.base.around.p3.cos", 0.1)
    shapes = cf.updating.SensorShapes.of(measured, start, table)
    return cf.update(
        start, table, [cf.Parameter(name="support.base.around.p3.cos", lower=-0.5, upper=0.7)], shapes=shapes
    )


@pytest.mark.slow
def test_macs_rise_and_the_lying_sensor_is_named(fit):
    found = shape_fit(fit)
    assert fit.value[0] == pytest.approx(0.4, abs=4.0 * fit.sigma[0])
    assert found.after.mean_plane > found.before.mean_plane
    of = dict(zip(found.after.rows.tolist(), found.after.found, strict=True))
    readings = found.shapes.readings(fit.after)
    for match in fit.pairing.matches:  # the plane of a doublet is both its modes, though one row alone has a shape
        rows = [row for row in match.rows if row in of]
        plane = next((pair for pair in fit.after.doublets if match.modes[0] in pair), match.modes)
        alike = cf.correlation.subspace_mac(found.shapes.shapes[:, rows], readings[:, list(plane)])
        assert [of[row].plane for row in rows] == pytest.approx([alike] * len(rows))
    assert found.after.rows.tolist() == list(range(ROWS - 1))
    assert found.worst_sensors(1)[0][0] == 101 + LOOSE


@pytest.mark.slow
def test_what_is_left_over_is_listed_on_both_sides(fit):
    document = json.loads(json.dumps(shape_fit(fit).to_json()))
    assert document["unused_hz"] == [pytest.approx(fit.problem.shapes.unused_hz[0])]
    assert len(document["rows"]) == ROWS - 1
    assert document["unpaired_modes"]
    said = " ".join(shapes_section(shape_fit(fit)).paragraphs)
    assert f"Without a shape: modes {ROWS} of the table" in said
    assert f"Measured shapes of no row: {document['unused_hz'][0]:.2f} Hz" in said
    assert "shapes of 7 of 8 rows" in repr(shape_fit(fit))


@pytest.mark.slow
def test_pictures_frame_every_pair(fit, tmp_path):
    assert_whole(shape_fit(fit), tmp_path)
    figure = figure_shape_mac(shape_fit(fit))
    axes = [axes for axes in figure.axes if axes.get_xlabel() == "computed mode"]
    mac = shape_fit(fit).after.mac
    np.testing.assert_allclose(np.asarray(axes[1].collections[0].get_array()).reshape(mac.shape), mac)
    assert axes[1].get_xlim() == (-0.5, mac.shape[1] - 0.5)
    assert axes[1].get_ylim() == (mac.shape[0] - 0.5, -0.5)
    paired = [
        (row, mode) for match in fit.pairing.matches for row in match.rows if row < ROWS - 1 for mode in match.modes
    ]
    assert framed_cells(axes[1]) == sorted(paired)


def framed_cells(axes):
    """Cells (row, column) inside the frames of a MAC picture."""
    cells = []
    for line in axes.lines:
        x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        inside = [np.arange(np.ceil(side.min()), side.max()).astype(int).tolist() for side in (y, x)]
        cells += [(row, column) for row in inside[0] for column in inside[1]]
    return sorted(cells)


def test_frames_of_a_pair_whose_members_are_not_neighbours_hold_its_cells_alone():
    axes = Figure().add_subplot()
    pairs = [(np.array([0, 2]), np.array([1, 4])), (np.array([1]), np.array([2]))]
    mac_panel(axes, np.eye(3, 5), pairs, SimpleNamespace(nodal_diameters=np.arange(5)), np.arange(3.0))
    assert framed_cells(axes) == [(0, 1), (0, 4), (1, 2), (2, 1), (2, 4)]
    assert not any(line.get_clip_on() for line in axes.lines)


@pytest.mark.slow
def test_an_update_without_shapes_has_no_comparison(frustum):
    shell = frustum(mesh=cf.ShellMesh(order=5, rows=1, around=9))
    found = cf.modes(shell, 4)
    table = cf.FrequencyTable.from_arrays(freq_hz=found.freq, sigma_hz=0.1, n=found.nodal_diameters)
    assert shape_fit(cf.update(shell, table, [cf.Parameter(name="material.E", lower=1e11, upper=3e11)])) is None


def test_each_shape_has_the_mac_of_its_own_mode_and_of_its_own_pair(fit):
    seen = shape_fit(fit)
    for told, modes in ((seen.before, fit.before), (seen.after, fit.after)):
        readings = seen.shapes.readings(modes)
        for row, match in zip(told.rows, told.found, strict=True):
            shape, mode = seen.shapes.shapes[:, row], readings[:, match.mode]
            assert match.mac == pytest.approx((shape @ mode) ** 2 / (shape @ shape) / (mode @ mode), rel=1e-9)
