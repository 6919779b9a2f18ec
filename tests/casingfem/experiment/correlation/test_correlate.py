"""Measured shapes against modes: where sensors stand, what pairs, where shapes differ, what expansion predicts."""

from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.sparse.linalg import splu

import casingfem as cf
from casingfem.experiment.correlation.expansion import (
    expand,
    guyan_mass,
    serep_mass,
    well_conditioned,
)
from casingfem.experiment.correlation.mac import comac, ecomac
from casingfem.experiment.correlation.measured_shapes import uff_shapes
from casingfem.experiment.correlation.sensors import nearest, sensors_of, sensors_on
from casingfem.export.modes_uff import write_modes_uff

HEIGHTS = (0.12, 0.25)


@pytest.fixture(scope="module")
def casing(frustum):
    mesh = cf.ShellMesh(order=6, rows=1, around=13)
    return frustum(radius_defect=cf.FourierField.of({3: 1e-3, 14: 3e-4}), mesh=mesh)


@pytest.fixture(scope="module")
def system(casing):
    return cf.shell.assemble(casing)


@pytest.fixture(scope="module")
def found(casing, system):
    return cf.modes(casing, 12, method="shell", system=system)


def placed(casing, count=24, outward=0.0):
    """Radial channels on two circles."""
    theta = np.tile(2.0 * np.pi * np.arange(count) / count + 0.1, len(HEIGHTS))
    z = np.repeat(HEIGHTS, count)
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    x = np.real(casing.geometry(z, theta).surface.x).T
    return x + outward * out, out


def test_of_itself(casing, found):
    points, out = placed(casing)
    values = sensors_of(found, points, out).shapes(found.fields)
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=found.freq, values=values * -3.0, points=points, directions=out
    )
    result = cf.correlate(found, test)
    assert [match.modes for match in result.pairing.matches] == [match.rows for match in result.pairing.matches]
    np.testing.assert_allclose(result.alike, 1.0, atol=1e-12)
    np.testing.assert_allclose(np.diag(result.nco), 1.0, atol=1e-9)
    np.testing.assert_allclose(result.nco - np.diag(np.diag(result.nco)), 0.0, atol=1e-9)
    np.testing.assert_allclose(result.comac, 1.0, atol=1e-9)
    np.testing.assert_allclose(result.ecomac, 0.0, atol=1e-9)
    assert result.pairing.unpaired_rows == result.pairing.unpaired_modes == ()
    assert result.sensors.distance.max() < 1e-9


def test_a_rotated_doublet_is_no_difference_and_a_sensor_turned_over_is_found(casing, found):
    points, out = placed(casing)
    values = sensors_of(found, points, out).shapes(found.fields)
    turned = values.copy()
    for low, high in found.doublets:
        turned[:, [low, high]] = values[:, [low, high]] @ np.array([[0.6, -0.8], [0.8, 0.6]])
    turned[5] *= -1.0
    test = cf.correlation.MeasuredShapes.from_arrays(freq_hz=found.freq, values=turned, points=points, directions=out)
    result = cf.correlate(found, test)
    assert np.diag(result.mac).max() < 0.75
    assert result.alike.min() > 0.7
    assert int(result.ecomac.argmax()) == 5
    assert result.expansion.left_out[5].max() > 3.0 * np.median(result.expansion.left_out)


def test_unpaired_shapes_are_listed(casing, found):
    points, out = placed(casing)
    values = sensors_of(found, points, out).shapes(found.fields)[:, :6]
    freq = found.freq[:6].copy()
    freq[5] = 2.0 * freq[5]
    test = cf.correlation.MeasuredShapes.from_arrays(freq_hz=freq, values=values, points=points, directions=out)
    result = cf.correlate(found, test)
    assert result.pairing.unpaired_rows == (5,)
    assert 5 in result.pairing.unpaired_modes
    assert "unpaired: 1 measured, 7 computed" in repr(result)
    assert result.records()[5]["mode"] is None


@pytest.mark.slow
def test_guyan_mass_is_exact_in_statics_and_serep_for_its_modes(casing, system, found):
    points, out = placed(casing)
    sensors = sensors_of(found, points, out)
    at = sensors.shapes(found.fields)
    M = guyan_mass(system, sensors)
    np.testing.assert_allclose(M, M.T, atol=1e-9 * abs(M).max())
    assert np.linalg.eigvalsh(M)[0] > 0.0
    force = np.random.default_rng(2).standard_normal(len(at))
    static = splu(system.K).solve(sensors.loads(system) @ force)
    motion = sensors.loads(system).T @ static
    assert motion @ M @ motion == pytest.approx(static @ (system.mass * static), rel=1e-8)
    guyan = cf.correlation.mac(at, at, M)
    assert (guyan - np.diag(np.diag(guyan)))[:4, :4].max() < 0.01
    basis = at[:, :8]
    np.testing.assert_allclose(basis.T @ serep_mass(basis) @ basis, np.eye(8), atol=1e-10)
    twice = sensors_on(casing, found.grid, points[[0, 1, 0]], out[[0, 1, 0]])
    with pytest.raises(cf.errors.ModelError, match="sensor-twice"):
        guyan_mass(system, twice)


def test_the_mass_of_orthogonality_is_the_one_that_is_asked_for(casing, system, found):
    points, out = placed(casing)
    values = sensors_of(found, points, out).shapes(found.fields)
    test = cf.correlation.MeasuredShapes.from_arrays(freq_hz=found.freq, values=values, points=points, directions=out)
    sensors = sensors_of(found, points, out)
    for mass, options, M in (
        ("Guyan", {"system": system}, guyan_mass(system, sensors)), ("SEREP", {"system": system}, None),
    ):  # fmt: skip
        result = cf.correlate(found, test, mass=mass, **options)
        M = serep_mass(values[:, result.expansion.modes]) if M is None else M
        size = np.sqrt(np.einsum("ik,ij,jk->k", values, M, values))
        inner = (values.T @ M @ values / np.multiply.outer(size, size)) ** 2
        assert result.mass_by == mass
        np.testing.assert_allclose(result.nco, inner, atol=1e-9)
    for mass, options in (("Guyan", {}), ("guyan", {"system": system}), ("IRS", {})):
        with pytest.raises(ValueError, match='mass must be "SEREP", or "Guyan" with the assembled system'):
            cf.correlate(found, test, mass=mass, **options)


def test_loads_are_the_sensors_own(system, found):
    """Work of a unit force at a channel is the motion there: P^T x = S x."""
    points, out = placed(found.shell, count=5)
    sensors = sensors_of(found, points, out)
    vectors = system.collect(found.fields, found.own)
    np.testing.assert_allclose(sensors.loads(system).T @ vectors, sensors.shapes(found.fields), atol=1e-10)


def test_expansion_gives_the_whole_shape_and_the_left_out_error_of_a_refit(casing, found):
    points, out = placed(casing)
    sensors = sensors_of(found, points, out)
    at = sensors.shapes(found.fields)
    rng = np.random.default_rng(5)
    noisy = at[:, :3] + 0.05 * np.abs(at[:, :3]).max() * rng.standard_normal((len(at), 3))
    whole = expand(noisy, at, sensors.labels)
    exact = expand(at[:, :3], at, sensors.labels)
    np.testing.assert_allclose(exact.fields(found.fields), found.fields[:, :, :3], atol=1e-8 * abs(found.fields).max())
    assert exact.outside.max() < 1e-9
    assert 0.01 < whole.outside.max() < 0.3
    basis = at[:, whole.modes]
    best = np.linalg.lstsq(basis, noisy, rcond=None)[0]
    np.testing.assert_allclose(whole.coordinates, best, atol=1e-9 * np.abs(best).max())
    np.testing.assert_allclose(whole.smoothed, basis @ best, atol=1e-9 * np.abs(noisy).max())
    left = np.linalg.norm(noisy - basis @ best, axis=0)
    np.testing.assert_allclose(whole.outside, left / np.linalg.norm(noisy, axis=0), rtol=1e-9)
    assert whole.condition == pytest.approx(np.linalg.cond(basis), rel=1e-9)
    kept = np.arange(len(at)) != 7
    refit = at[kept][:, whole.modes]
    predicted = at[7][whole.modes] @ np.linalg.lstsq(refit, noisy[kept], rcond=None)[0]
    error = np.abs(predicted - noisy[7]) / np.sqrt(np.mean(noisy**2, axis=0))
    np.testing.assert_allclose(whole.left_out[7], error, rtol=1e-8)


def test_expansion_refuses_what_the_sensors_do_not_tell():
    shapes = np.column_stack([np.ones(6), np.ones(6), np.arange(6.0)])
    assert well_conditioned(shapes) == [0, 2]
    with pytest.raises(cf.errors.ModelError, match="look alike"):
        expand(shapes[:, :1], shapes, np.arange(6), modes=[0, 1])
    with pytest.raises(cf.errors.ModelError, match="4 modes on 3 channels"):
        expand(np.ones((3, 1)), np.ones((3, 4)), np.arange(3), modes=[0, 1, 2, 3])
    shapes[:, 1] += np.arange(6.0)
    with pytest.raises(cf.errors.ModelError, match="3 modes look alike on 6 channels"):
        expand(shapes[:, :1], shapes, np.arange(6), modes=[0, 1, 2])


def test_one_mode_expands_by_its_share():
    """q = phi.psi/phi.phi."""
    found = expand(np.array([[5.0], [1.0], [2.0]]), np.array([[1.0], [2.0], [2.0]]), np.arange(3), modes=[0])
    assert found.coordinates.item() == pytest.approx(11.0 / 9.0, rel=1e-12)
    assert found.condition == 1.0


@pytest.mark.parametrize(("channels", "most"), [(1, 1), (2, 1), (3, 2), (9, 6), (10, 6)])
def test_expansion_takes_at_most_two_modes_for_three_channels(channels, most):
    assert well_conditioned(np.eye(channels)) == list(range(most))


def test_expansion_leaves_out_what_makes_the_shapes_ill_conditioned():
    """Two unit shapes at an angle a have the condition 1/tan(a/2)."""
    for condition, taken in ((9.9, [0, 1]), (10.1, [0])):
        a = 2.0 * np.arctan(1.0 / condition)
        assert well_conditioned(np.array([[1.0, np.cos(a)], [0.0, np.sin(a)], [0.0, 0.0]]), worst=10.0) == taken
    zero = np.column_stack([np.zeros(6), np.eye(6)[0], np.eye(6)[1]])
    assert well_conditioned(zero) == [1, 2]


def test_sensors_are_put_on_the_wall_and_refused_when_far(casing, found):
    points, out = placed(casing, outward=2e-3)
    a, _ = nearest(casing, points)
    np.testing.assert_allclose(a, np.repeat(HEIGHTS, 24), atol=1e-3)
    sensors = sensors_of(found, points, out)
    np.testing.assert_allclose(sensors.distance, 2e-3, rtol=0.05)
    assert sensors.labels.tolist() == list(range(1, 49))
    assert sensors_on(casing, found.grid, points[:2], out[:2], [7, 7]).labels.tolist() == [7, 7]
    with pytest.raises(cf.errors.ModelError, match=r"sensor \d+ at .* is 0\.\d+ m from the wall.*sensor-far"):
        sensors_of(found, points * 1.2, out)


def test_sensors_on_a_plate(steel):
    plate = cf.Shell(chart=cf.Plate(length=0.4, width=0.2), thickness=2e-3, material=steel)
    a, b = nearest(plate, np.array([[0.1, 0.05, 0.0], [0.39, -0.1, 0.01]]))
    x = np.real(plate.geometry(a, b).surface.x).T
    np.testing.assert_allclose(x[0], [0.1, 0.05, 0.0], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(x[1] - [0.39, -0.1, 0.01]), 0.01, rtol=1e-9)


def test_comac_is_one_where_shapes_agree_and_enhanced_comac_sees_signs():
    rng = np.random.default_rng(3)
    a = rng.standard_normal((6, 4))
    b = a.copy()
    b[2] *= -1.0
    assert comac(a, b)[2] == pytest.approx(1.0)
    assert ecomac(a, b).argmax() == 2
    with pytest.raises(ValueError, match="equal sizes"):
        comac(a, b[:, :2])


@pytest.mark.slow
def test_universal_files_give_shapes_at_their_points(tmp_path, found):
    path = write_modes_uff(found, tmp_path / "modes.uff", [0, 1, 4], nodes_set="2411")
    test = cf.correlation.MeasuredShapes.from_uff(path)
    np.testing.assert_allclose(test.freq_hz, found.freq[[0, 1, 4]], rtol=1e-5)
    result = cf.correlate(found, test)
    assert [match.modes for match in result.pairing.matches] == [(0, 1), (4,)]
    assert result.alike.min() > 0.9999
    assert result.sensors.distance.max() < 1e-4


def scalars(shape):
    return replace(shape, characteristic=1, values=shape.values[:, :1])


@pytest.mark.parametrize(
    ("nodes", "change", "words"),
    [
        (lambda nodes: None, lambda shape: shape, "found no nodes; expected a set 15 or 2411"),
        (
            lambda nodes: nodes,
            lambda shape: replace(shape, nodes=shape.nodes[:-1], values=shape.values[:-1]),
            "found shapes with values at different nodes",
        ),
        (
            lambda nodes: cf.uff.Nodes(**{field.name: getattr(nodes, field.name)[1:] for field in fields(nodes)}),
            lambda shape: shape,
            "found values at node 1, which has no point; expected its point",
        ),
        (
            lambda nodes: replace(nodes, motions=7 * (nodes.labels == 3)),
            lambda shape: shape,
            "found motions in coordinate system 7; expected global motions, 0",
        ),
        (lambda nodes: nodes, scalars, "found data characteristic 1; expected 2 or 3: translations"),
        (lambda nodes: nodes, lambda shape: replace(shape, analysis=1), "found 2 shapes, none of a mode"),
    ],
)
def test_universal_files_whose_shapes_have_no_place_are_refused(tmp_path, found, nodes, change, words):
    given = cf.uff.read_uff(write_modes_uff(found, tmp_path / "modes.uff", [0, 1]))
    first, second = given.shapes
    if words.startswith("found 2 shapes"):
        first = change(first)
    with pytest.raises(cf.errors.InputError, match=words):
        uff_shapes(replace(given, nodes=nodes(given.nodes), shapes=(first, change(second))))


@pytest.mark.parametrize("width", [3, 6])
def test_translations_of_a_universal_file_come_with_or_without_turns(tmp_path, found, width):
    given = cf.uff.read_uff(write_modes_uff(found, tmp_path / "modes.uff", [0]))
    values = np.zeros((len(given.nodes.labels), width))
    values[:, :3] = np.arange(1.0, 1.0 + values[:, :3].size).reshape(-1, 3)
    values[:, 3:] = 1e9  # turns, which no translation is
    shape = replace(given.shapes[0], characteristic=width // 3 + 1, values=values)
    np.testing.assert_array_equal(uff_shapes(replace(given, shapes=(shape,))).values[:, 0], values[:, :3].ravel())


def test_complex_shapes_are_made_real():
    theta = 2.0 * np.pi * np.arange(12) / 12
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    turned = np.cos(3 * theta) * np.exp(0.7j)
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=[300.0], values=turned[:, None], points=out, directions=out
    )
    assert abs(np.corrcoef(test.real[:, 0], np.cos(3 * theta))[0, 1]) == pytest.approx(1.0)
    assert test.collinearity[0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"freq_hz": [-1.0]}, "above 0"),
        ({"values": np.full((4, 1), np.nan)}, "not finite"),
        ({"values": np.zeros((4, 1))}, "zero everywhere"),
        ({"values": np.ones((3, 1))}, "points .4, 3."),
        ({"directions": np.zeros((4, 3))}, "no length"),
        ({"values": np.ones((4, 2))}, "1 modes"),
    ],
)
def test_bad_shapes_are_named(changes, words):
    good = {"freq_hz": [100.0], "values": np.ones((4, 1)), "points": np.ones((4, 3)), "directions": np.ones((4, 3))}
    with pytest.raises(cf.errors.InputError, match=words):
        cf.correlation.MeasuredShapes.from_arrays(**(good | changes))


def test_what_belongs_to_a_shape_is_sorted_with_its_frequency():
    given = {"values": np.diag([3.0, 1.0, 2.0]), "sigma": [0.3, 0.1, 0.2], "n": [3, 1, 2]}
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=[30.0, 10.0, 20.0], points=np.eye(3), directions=np.eye(3), **given
    )
    assert test.freq_hz.tolist() == [10.0, 20.0, 30.0]
    assert test.values.sum(axis=0).tolist() == [1.0, 2.0, 3.0]
    assert test.sigma.tolist() == [0.1, 0.2, 0.3]
    assert test.n.tolist() == [1, 2, 3]


def test_the_collinearity_of_an_ellipse_is_the_share_of_its_longer_axis():
    """A wave of unit and half amplitude in quadrature: 1/(1 + 1/4) of its energy is in phase, at any common phase."""
    theta = 2.0 * np.pi * np.arange(12) / 12
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    values = (np.cos(3 * theta) + 0.5j * np.sin(2 * theta)) * np.exp(0.9j)
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=[300.0], values=values[:, None], points=out, directions=out
    )
    assert test.collinearity[0] == pytest.approx(0.8, rel=1e-12)


def test_errors_of_an_expansion_are_relative():
    """Three decades of unit apart; alone, the one mode (1, 1, 1, 1) leaves of (1, 1, 1, 0) a quarter of its square."""
    basis, shape, labels = np.ones((4, 1)), np.array([[1.0], [1.0], [1.0], [0.0]]), np.arange(4)
    found = expand(shape * [1.0, 1e3], basis, labels, modes=[0])
    left = np.sqrt(np.mean(shape**2)) * found.left_out  # each channel less the mean of the other three
    np.testing.assert_allclose(found.outside, np.sqrt([0.25, 0.25]))
    np.testing.assert_allclose(left, np.array([1.0, 1.0, 1.0, 3.0])[:, None] / 3.0 * [1.0, 1.0])


def test_the_left_out_error_of_a_record_is_the_rms_over_sensors(casing, found):
    points, out = placed(casing)
    values = sensors_of(found, points, out).shapes(found.fields)[:, :3].copy()
    values[5] *= 1.5
    result = cf.correlate(found, cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=found.freq[:3], values=values, points=points, directions=out))  # fmt: skip
    told = [row["left_out_error"] for row in result.records()]
    np.testing.assert_allclose(np.square(told), np.mean(result.expansion.left_out**2, axis=0))


def test_enhanced_comac_sees_neither_sign_nor_scale_of_a_shape():
    shapes = np.random.default_rng(4).standard_normal((6, 3))
    np.testing.assert_allclose(ecomac(shapes, shapes * [-1.0, 3.0, -0.2]), 0.0, atol=1e-15)


def test_shapes_a_fifth_off_in_frequency_pair_and_no_others_unless_asked(casing, found):
    points, out = placed(casing)
    values = sensors_of(found, points, out).shapes(found.fields)[:, :1]
    near, far = (
        cf.correlation.MeasuredShapes.from_arrays(
            freq_hz=factor * found.freq[:1], values=values, points=points, directions=out
        )
        for factor in (0.84, 0.82)
    )
    assert len(cf.correlate(found, near).pairing) == 1
    with pytest.raises(cf.errors.InputError, match=r"no shape that pairs with a mode; expected one within 0\.2 of a"):
        cf.correlate(found, far)
    assert len(cf.correlate(found, far, reach=0.25).pairing) == 1
