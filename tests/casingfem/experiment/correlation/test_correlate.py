"""Measured shapes against modes: where sensors stand, what pairs, where shapes differ, what expansion predicts."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import splu

import casingfem as cf

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


def channels(count=24):
    """The same channels as sensors of an update: where they are on the chart, along what they measure."""
    theta = np.tile(2.0 * np.pi * np.arange(count) / count + 0.1, len(HEIGHTS))
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    blank = np.ones((len(theta), 1))
    return cf.updating.SensorShapes(a=np.repeat(HEIGHTS, count), b=theta, directions=out, shapes=blank, sigma=1.0)


def readings(found):
    """Computed shapes at the channels, (channels, modes)."""
    return channels().readings(found)


def measured_of(found, values, casing, freq=None):
    points, out = placed(casing)
    freq = found.freq[: values.shape[1]] if freq is None else freq
    return cf.correlation.MeasuredShapes.from_arrays(freq_hz=freq, values=values, points=points, directions=out)


def orthogonality(shapes, computed, M):
    """(psi^T M phi)^2/(psi^T M psi phi^T M phi)."""
    sizes = [np.sqrt(np.einsum("ik,ij,jk->k", x, M, x)) for x in (shapes, computed)]
    return (shapes.T @ M @ computed / np.multiply.outer(*sizes)) ** 2


@pytest.mark.slow
def test_orthogonality_is_by_guyans_mass_or_by_that_of_serep(casing, system, found):
    """Guyan: G^T M G, G the statics of unit motions of the channels; SEREP: the pseudo-inverse of the modes."""
    values = readings(found)
    rng = np.random.default_rng(6)
    shapes = values + 0.05 * np.abs(values).max() * rng.standard_normal(values.shape)
    test = measured_of(found, shapes, casing)
    result = cf.correlate(found, test, mass="Guyan", system=system)
    loads = np.zeros((len(system.points), system.dofs, len(values)))
    loads[:, :5] = channels().loads(found.grid)
    P = system.restrict(loads)
    attachment = splu(system.K.tocsc()).solve(P)
    G = np.linalg.solve(P.T @ attachment, attachment.T).T
    np.testing.assert_allclose(P.T @ G, np.eye(len(values)), atol=1e-6)
    np.testing.assert_allclose(result.nco, orthogonality(shapes, values, G.T @ (system.M @ G)), atol=1e-6)
    result = cf.correlate(found, test)
    inverse = np.linalg.pinv(values[:, result.expansion.modes])
    assert (result.mass_by, len(result.expansion.modes)) == ("SEREP", 12)
    np.testing.assert_allclose(result.nco, orthogonality(shapes, values, inverse.T @ inverse), atol=1e-9)
    for mass, options in (("Guyan", {}), ("guyan", {"system": system}), ("IRS", {})):
        with pytest.raises(ValueError, match='mass must be "SEREP", or "Guyan" with the assembled system'):
            cf.correlate(found, test, mass=mass, **options)


def test_two_channels_of_one_motion_have_no_guyan_mass(casing, system, found):
    points, out = placed(casing)
    twice = np.r_[np.arange(48), 7]
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=found.freq, values=readings(found)[twice], points=points[twice], directions=out[twice]
    )
    with pytest.raises(cf.errors.ModelError, match="sensor-twice"):
        cf.correlate(found, test, mass="Guyan", system=system)


def test_an_expansion_is_a_fit_and_its_left_out_errors_are_those_of_refits(casing, found):
    values = readings(found)
    rng = np.random.default_rng(5)
    noisy = values[:, :3] + 0.05 * np.abs(values[:, :3]).max() * rng.standard_normal((len(values), 3))
    exact, whole = (cf.correlate(found, measured_of(found, v, casing)).expansion for v in (values[:, :3], noisy))
    np.testing.assert_allclose(exact.fields(found.fields), found.fields[:, :, :3], atol=1e-8 * abs(found.fields).max())
    assert exact.outside.max() < 1e-9
    basis = values[:, whole.modes]
    best = np.linalg.lstsq(basis, noisy, rcond=None)[0]
    np.testing.assert_allclose(whole.coordinates, best, atol=1e-9 * np.abs(best).max())
    np.testing.assert_allclose(whole.smoothed, basis @ best, atol=1e-9 * np.abs(noisy).max())
    left = np.linalg.norm(noisy - basis @ best, axis=0)
    np.testing.assert_allclose(whole.outside, left / np.linalg.norm(noisy, axis=0), rtol=1e-9)
    assert whole.condition == pytest.approx(np.linalg.cond(basis), rel=1e-9)
    kept = np.arange(len(values)) != 7
    predicted = values[7][whole.modes] @ np.linalg.lstsq(basis[kept], noisy[kept], rcond=None)[0]
    error = np.abs(predicted - noisy[7]) / np.sqrt(np.mean(noisy**2, axis=0))
    np.testing.assert_allclose(whole.left_out[7], error, rtol=1e-8)


@pytest.mark.parametrize(("count", "kept"), [(3, 2), (4, 2), (6, 4)])
def test_an_expansion_takes_at_most_two_modes_for_three_channels(casing, found, count, kept):
    points, out = placed(casing)
    values = readings(found)
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=found.freq[:1], values=values[:count, :1], points=points[:count], directions=out[:count]
    )
    assert len(cf.correlate(found, test).expansion.modes) <= kept


def test_comac_is_the_agreement_of_each_channel_and_ecomac_sees_signs(casing, found):
    """COMAC: (sum |a b|)^2/(sum a^2 sum b^2) over shapes of unit norm, singles of distinct n: planes are the modes."""
    values = readings(found)
    changed = values * (1.0 + 0.2 * np.random.default_rng(3).standard_normal((len(values), 1)))
    changed[2] *= -1.0
    result = cf.correlate(found, measured_of(found, changed, casing))
    near = np.empty_like(values)
    for match in result.pairing.matches:
        plane = values[:, list(match.modes)]
        near[:, list(match.rows)] = plane @ np.linalg.lstsq(plane, changed[:, list(match.rows)], rcond=None)[0]
    order = [row for match in result.pairing.matches for row in match.rows]
    a, b = (x[:, order] / np.linalg.norm(changed, axis=0)[order] for x in (changed, near))
    comac = np.sum(np.abs(a * b), axis=1) ** 2 / np.sum(a**2, axis=1) / np.sum(b**2, axis=1)
    np.testing.assert_allclose(result.comac, comac, rtol=1e-9)
    assert result.comac[2] > 0.9
    assert int(result.ecomac.argmax()) == 2


def test_sensors_are_put_on_the_wall_and_refused_when_far(casing, found):
    points, out = placed(casing, outward=2e-3)
    given = {"freq_hz": found.freq, "values": readings(found), "directions": out}
    sensors = cf.correlate(found, cf.correlation.MeasuredShapes.from_arrays(points=points, **given)).sensors
    np.testing.assert_allclose(sensors.a, np.repeat(HEIGHTS, 24), atol=1e-3)
    np.testing.assert_allclose(sensors.distance, 2e-3, rtol=0.05)
    assert sensors.labels.tolist() == list(range(1, 49))
    with pytest.raises(cf.errors.ModelError, match=r"sensor \d+ at .* is 0\.\d+ m from the wall.*sensor-far"):
        cf.correlate(found, cf.correlation.MeasuredShapes.from_arrays(points=1.2 * points, **given))


def test_sensors_of_an_imported_part_read_its_nearest_nodes(steel):
    """Displacements of nodes, named a little beside them."""
    block = cf.imported.grid_mesh("hexahedron20", (6, 2, 1), lambda u: u * [0.3, 0.1, 0.02])
    part = cf.Solid(mesh=block, material=steel)
    found = cf.modes(part, 12)
    nodes = np.random.default_rng(2).choice(len(block.points), 24, replace=False)
    out = np.tile([0.0, 0.0, 1.0], (24, 1))
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=found.freq[6:], values=found.fields[nodes, 2, 6:], points=block.points[nodes] + 1e-4, directions=out
    )
    result = cf.correlate(found, test)
    np.testing.assert_allclose(result.alike, 1.0, atol=1e-9)
    np.testing.assert_allclose(result.sensors.distance, np.sqrt(3.0) * 1e-4, rtol=1e-6)
    assert result.sensors.nodes[:, 0].tolist() == nodes.tolist()


NODES = cf.uff.Nodes(
    labels=np.array([2, 4]), points=np.array([[0.0, 1.0, 2.0], [6.0, 7.0, 8.0]]), systems=np.zeros(2, int),
    motions=np.zeros(2, int),
)  # fmt: skip
MOVED = np.array([[1.0, 0.0, 0.5], [2.0, 3.0, 0.0]])


def shape(freq=50.0, width=3, **changes):
    values = np.zeros((2, width))
    values[:, :3], values[:, 3:] = MOVED, 1e9  # turns, which no translation is
    given = {
        "text": ("",) * 5, "model": 1, "analysis": 2, "characteristic": width // 3 + 1, "quantity": 8,
        "integers": (1, 1), "reals": (freq, 1.0, 0.0, 0.0), "nodes": np.array([4, 2]), "values": values,
    }  # fmt: skip
    return cf.uff.Shape(**given | changes)


@pytest.mark.parametrize("width", [3, 6])
def test_translations_of_a_universal_file_come_sorted_with_or_without_turns(tmp_path, width):
    path = cf.uff.write_uff(tmp_path / "a.uff", nodes=NODES, shapes=[shape(60.0, width), shape(30.0, width)])
    test = cf.correlation.MeasuredShapes.from_uff(path)
    assert test.freq_hz.tolist() == [30.0, 60.0]
    for label, point, row in ((4, [6.0, 7.0, 8.0], MOVED[0]), (2, [0.0, 1.0, 2.0], MOVED[1])):
        of = test.labels == label
        assert (test.points[of] == point).all()
        np.testing.assert_array_equal(test.directions[of].T @ test.values[of, 0], row)


@pytest.mark.parametrize(
    ("nodes", "changes", "words"),
    [
        (None, {}, "found no nodes; expected a set 15 or 2411"),
        (NODES, {"nodes": np.array([4]), "values": MOVED[:1]}, "found shapes with values at different nodes"),
        (replace(NODES, labels=np.array([2, 5])), {}, "found node 4, not among the nodes of the file"),
        (replace(NODES, motions=np.array([0, 7])), {}, "motions in coordinate system 7; expected global motions, 0"),
        (NODES, {"characteristic": 1, "values": MOVED[:, :1]}, "found data characteristic 1; expected 2 or 3"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*uff-shapes:casingfem.errors.ModelWarning")
def test_universal_files_whose_shapes_have_no_place_are_refused(tmp_path, nodes, changes, words):
    path = cf.uff.write_uff(tmp_path / "a.uff", nodes=nodes, shapes=[shape(), shape(60.0, **changes)])
    with pytest.raises(cf.errors.InputError, match=words):
        cf.correlation.MeasuredShapes.from_uff(path)


def test_of_itself(casing, found):
    points, out = placed(casing)
    values = readings(found)
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
    values = readings(found)
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
    values = readings(found)[:, :6]
    freq = found.freq[:6].copy()
    freq[5] = 2.0 * freq[5]
    test = cf.correlation.MeasuredShapes.from_arrays(freq_hz=freq, values=values, points=points, directions=out)
    result = cf.correlate(found, test)
    assert result.pairing.unpaired_rows == (5,)
    assert 5 in result.pairing.unpaired_modes
    assert "unpaired: 1 measured, 7 computed" in repr(result)
    assert result.records()[5]["mode"] is None


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


def test_the_left_out_error_of_a_record_is_the_rms_over_sensors(casing, found):
    points, out = placed(casing)
    values = readings(found)[:, :3].copy()
    values[5] *= 1.5
    result = cf.correlate(found, cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=found.freq[:3], values=values, points=points, directions=out))  # fmt: skip
    told = [row["left_out_error"] for row in result.records()]
    np.testing.assert_allclose(np.square(told), np.mean(result.expansion.left_out**2, axis=0))


def test_shapes_a_fifth_off_in_frequency_pair_and_no_others_unless_asked(casing, found):
    points, out = placed(casing)
    values = readings(found)[:, :1]
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
