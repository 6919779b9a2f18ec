"""Sensors and their shapes: what is refused, what they read of a motion, which rows and planes they see."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.matches import Match
from casingfem.modal.neighbour import solved
from casingfem.structure.mesh.shell_mesh import make_grid
from casingfem.updating.shape_fit import ShapeComparison, ShapeFit, ShapeMatch, only_seen
from casingfem.updating.shapes import plane_at, redundant, shape_jacobian, shape_values

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
        ({"shapes": ((1.0, 1.0), (1.0, NAN), (1.0, 1.0))}, "column 2 is zero or partly nan"),
        ({"shapes": ((0.0, 1.0), (0.0, 1.0), (0.0, 1.0))}, "column 1 is zero or partly nan"),
        ({"sigma": np.array([0.1, 0.2])}, "sigma must be positive, one or 3"),
        ({"sigma": np.array([0.1, 0.1, 0.0])}, "sigma must be positive, one or 3"),
        ({"sigma": NAN}, "sigma must be positive, one or 3"),
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
        with pytest.raises(ValueError, match=f"{edge!r} is no closed edge"):
            cf.updating.SensorShapes.on_edge(shell, edge, THETA, np.ones((3, 1)), 0.2)


def test_readings_are_displacements_along_the_directions():
    """Fields that the elements carry exactly: polynomials along the meridian. Rotations are not read."""
    grid = make_grid(CASING.chart, CASING.mesh, CASING.stations)
    z = grid.nodes[0]
    fields = np.stack([1.0 + z, z**2, 3.0 - z, 1e6 * z, 1e6 * z], axis=1)[:, :, None] * [1.0, -2.0]
    unit = np.array([[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, 0.6, -0.8]])
    at = sensors(directions=unit)
    a = at.a
    read = unit[:, 0] * (1.0 + a) + unit[:, 1] * a**2 + unit[:, 2] * (3.0 - a)
    modes = SimpleNamespace(grid=grid, fields=fields)
    np.testing.assert_allclose(at.readings(modes), read[:, None] * [1.0, -2.0], rtol=1e-9)


class Read(cf.updating.SensorShapes):
    """Sensors that read given columns."""

    def readings(self, modes):
        return modes.read


class Four(SimpleNamespace):
    """Four modes that the sensors read as given, the middle two a pair."""

    doublets = ((1, 2),)
    read = np.array([[3.0, 1.0, 1.0, 0.0], [4.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 2.0]])

    def __len__(self):
        return 4


MODES = Four()


def match(rows, modes):
    return Match(
        rows=rows, modes=modes, n=2, confidence=1.0, measured_hz=rows, computed_hz=tuple(10 * m for m in modes)
    )


@pytest.mark.parametrize(
    ("modes", "plane"), [((0,), [0]), ((1,), [1, 2]), ((2,), [1, 2]), ((2, 1), [2, 1]), ((3,), [3])]
)
def test_a_row_of_half_a_pair_has_the_plane_of_both(modes, plane):
    found, phi = plane_at(MODES, match((0,) * len(modes), modes), MODES.read)
    assert found == plane
    np.testing.assert_array_equal(phi, MODES.read[:, plane])


def read_sensors():
    shapes = np.array([[3.0, NAN, 1.0, 0.6], [4.0, NAN, 2.0, 0.0], [12.0, NAN, 2.0, 0.8]])
    return Read(
        a=np.zeros(3), b=THETA, directions=np.eye(3), shapes=shapes, sigma=np.array([0.1, 0.1, 0.2, 0.4])
    )  # fmt: skip


def test_what_a_shape_has_beside_its_modes_is_left_over_sigma():
    """The third component is beyond modes 0, 1, 2 at the sensors; row 1 has no shape."""
    matches = [match((0, 1), (1, 2)), match((3,), (0,)), match((2,), (2,))]
    found = shape_values(MODES, read_sensors(), matches)
    along = np.array([0.6, 0.8, 0.0])
    single = np.array([0.6, 0.0, 0.8]) - 0.36 * along
    expected = [0.0, 0.0, 12.0 / 13.0 / 0.1, *(single / 0.4), 0.0, 0.0, 2.0 / 3.0 / 0.2]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    assert shape_values(MODES, read_sensors(), []).shape == (0,)
    assert redundant(MODES, read_sensors(), matches) == 2 + 1 + 2
    assert redundant(MODES, None, matches) == 0


def test_the_mac_of_rows_without_a_shape_is_zero():
    found = read_sensors().mac(MODES)
    assert found.shape == (4, 4)
    np.testing.assert_array_equal(found[1], np.zeros(4))
    np.testing.assert_allclose(found[0], [(5.0 / 13.0) ** 2, 1.0 / 2.0 / 169.0, 9.0 / 169.0, 144.0 / 169.0], rtol=1e-12)
    assert read_sensors().seen(match((1, 0), (1, 2))) == [0]


def test_measured_shapes_need_a_noise_and_tell_what_is_unused(frustum):
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


def comparison(found, comac):
    pairing = cf.correlation.Pairing(matches=(), unpaired_rows=(), unpaired_modes=(4, 0))
    return ShapeComparison(
        modes=None, pairing=pairing, rows=np.array([0, 2]), mac=np.zeros((2, 5)), found=found, comac=np.array(comac)
    )


BEFORE = comparison((ShapeMatch(1, 0.5, 0.6), ShapeMatch(None, NAN, NAN)), [0.3, 0.2, 0.9])
AFTER = comparison((ShapeMatch(0, 0.7, 0.8), ShapeMatch(3, 0.4, 0.9)), [0.9, 0.5, 0.5])


def shape_fit():
    table = cf.FrequencyTable.from_arrays(freq_hz=[10.0, 20.0, 30.5], sigma_hz=0.1, n=[0, 3, -1], mode=[2, 4, 7])
    shapes = SimpleNamespace(labels=np.array([11, 12, 13]), unused_hz=(77.5,))
    return ShapeFit(fit=SimpleNamespace(table=table, measured=table), shapes=shapes, before=BEFORE, after=AFTER)


def test_sensors_that_agree_least_after_an_update_come_first():
    assert shape_fit().worst_sensors() == [(12, 0.2, 0.5), (13, 0.9, 0.5), (11, 0.3, 0.9)]
    assert shape_fit().worst_sensors(1) == [(12, 0.2, 0.5)]
    assert BEFORE.mean_plane == 0.6
    assert AFTER.mean_plane == pytest.approx(0.85)
    assert np.isnan(comparison((ShapeMatch(None, NAN, NAN),) * 2, [NAN] * 3).mean_plane)


def test_a_comparison_of_shapes_is_told_as_plain_data_and_in_words():
    told = shape_fit().to_json()
    first, second = told["rows"]
    assert first == {
        "mode": 2, "n": 0, "measured_hz": 10.0, "computed_before": 2, "mac_before": 0.5, "plane_before": 0.6,
        "computed_after": 1, "mac_after": 0.7, "plane_after": 0.8,
    }  # fmt: skip
    assert (second["mode"], second["n"], second["computed_before"], second["computed_after"]) == (7, None, None, 4)
    assert told["unused_hz"] == [77.5]
    assert told["unpaired_modes"] == [5, 1]
    assert told["worst_sensors"][0] == {"sensor": 12, "comac_before": 0.2, "comac_after": 0.5}
    assert repr(shape_fit()).splitlines() == [
        "shapes of 2 of 3 rows: MAC of planes 0.600 -> 0.850 in the mean, least 0.800 (mode 2)",
        "mode  n  measured [Hz]  mode before  MAC before  plane before  mode after  MAC after  plane after",
        "   2  0         10.000            2       0.500         0.600           1      0.700        0.800",
        "   7  -         30.500            -           -             -           4      0.400        0.900",
        "shapes of no row: 77.50 Hz",
    ]


def test_of_a_match_the_rows_with_shapes_are_kept():
    rows = np.array([0, 2, 5])
    assert only_seen(match((3, 4), (1, 2)), rows) is None
    assert only_seen(match((4, 5), (1, 2)), rows) == match((5,), (2,))
    assert only_seen(match((2, 0), (1, 2)), rows) == match((2, 0), (1, 2))


@pytest.mark.slow
def test_slopes_of_shapes_are_those_of_what_is_left_of_them():
    """Three modes across a plate at six places, of shapes that are none of its own."""
    rng = np.random.default_rng(5)
    plate = cf.Shell(
        chart=cf.Plate(length=0.2, width=0.07), thickness=3e-3, material=STEEL,
        supports={"root": cf.ElasticEdge(k_face=1e11)}, mesh=cf.ShellMesh(order=4, rows=1, around=1),
    )  # fmt: skip
    at = cf.updating.SensorShapes(
        a=np.array([0.05, 0.1, 0.15, 0.2, 0.2, 0.12]), b=np.array([0.0, 0.02, -0.03, 0.03, -0.03, -0.01]),
        directions=np.tile([0.0, 0.0, 1.0], (6, 1)), shapes=rng.standard_normal((6, 3)), sigma=np.full(3, 0.1),
    )  # fmt: skip
    here = solved(plate, 5)
    seen = np.flatnonzero(np.linalg.norm(at.readings(here.modes), axis=0) > 0.1).tolist()
    matches = [match((2,), (seen[0],)), match((0,), (seen[2],)), match((1,), (seen[1],))]
    names = ("material.nu", "support.root.k_face")
    found = shape_jacobian(here, [cf.Parameter(name=name, lower=0.01, upper=1e13) for name in names], at, matches)
    assert found.shape == (18, 2)
    for k, name in enumerate(names):
        x = cf.updating.get_value(plate, name)
        ends = [
            shape_values(solved(cf.updating.with_value(plate, name, x * by), 5).modes, at, matches)
            for by in (1.0001, 0.9999)
        ]
        slope = (ends[0] - ends[1]) / (2e-4 * x)
        np.testing.assert_allclose(found[:, k], slope, atol=1e-3 * np.abs(slope).max(), err_msg=name)
