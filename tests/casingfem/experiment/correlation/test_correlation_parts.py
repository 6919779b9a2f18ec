"""Parts of a correlation written out: planes, expansions, sensors left out, what differs, shapes of a file."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import sqrtm, subspace_angles

import casingfem as cf
from casingfem.experiment.correlation.correlate import alike, partners, plane_of, seen_mac
from casingfem.experiment.correlation.expansion import expand, well_conditioned
from casingfem.experiment.correlation.mac import comac, ecomac, nearest_in_plane
from casingfem.experiment.correlation.matches import Match
from casingfem.experiment.correlation.measured_shapes import uff_shapes
from casingfem.experiment.correlation.sensors import refuse_far

RNG_SEED = 2231


def rng():
    return np.random.default_rng(RNG_SEED)


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize(("left", "right"), [(1, 1), (1, 2), (3, 2), (2, 2)])
def test_a_subspace_mac_is_the_mean_squared_cosine_of_principal_angles(left, right, weighted):
    A, B, half = rng().normal(size=(7, left)), rng().normal(size=(7, 3 + right))[:, 3:], rng().normal(size=(7, 7))
    M = half @ half.T + np.eye(7) if weighted else np.eye(7)
    root = np.real(sqrtm(M))
    exact = np.mean(np.cos(subspace_angles(root @ A, root @ B)) ** 2)
    assert cf.correlation.subspace_mac(A, B, M if weighted else None) == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_planes_of_any_size_and_phase_have_their_likeness(size):
    a, b = (rng().normal(size=(6, k)) + 1j * rng().normal(size=(6, k)) for k in (2, 3))
    exact = np.mean(np.cos(subspace_angles(a, b)) ** 2)
    assert cf.correlation.subspace_mac(size * a, b) == pytest.approx(exact, rel=1e-9)
    with pytest.raises(ValueError, match="linearly independent"):
        cf.correlation.subspace_mac(size * a[:, [0, 0]], b)
    with pytest.raises(ValueError, match="same dofs, not 5 and 6"):
        cf.correlation.subspace_mac(a[:5], b)


def test_likeness_of_complex_shapes_takes_the_weight_on_both_sides():
    a, b = (rng().normal(size=(4, k)) + 1j * rng().normal(size=(4, k)) for k in (2, 3))
    M = np.diag([1.0, 2.0, 5.0, 0.5])
    exact = [
        [abs(x.conj() @ M @ y) ** 2 / ((x.conj() @ M @ x).real * (y.conj() @ M @ y).real) for y in b.T] for x in a.T
    ]
    np.testing.assert_allclose(cf.correlation.mac(a, b, M), exact, rtol=1e-12)
    assert cf.correlation.mac(np.zeros((4, 0)), b).shape == (0, 3)
    for one, other in ((a * [1.0, 0.0], b), (a, b * [1.0, 0.0, 1.0])):
        with pytest.raises(ValueError, match="a shape has no norm"):
            cf.correlation.mac(one, other)


def test_where_shapes_differ_by_hand():
    a, b = rng().normal(size=(5, 3)), rng().normal(size=(5, 4))[:, 1:]
    a[4], b[1, 0] = 0.0, 0.0
    found = comac(a, b)
    assert np.isnan(found[4])
    exact = [np.sum(np.abs(x * y)) ** 2 / (x @ x) / (y @ y) for x, y in zip(a[:4], b[:4], strict=True)]
    np.testing.assert_allclose(found[:4], exact, rtol=1e-12)
    exact = np.zeros(5)
    for x, y in zip((a / np.linalg.norm(a, axis=0)).T, (b / np.linalg.norm(b, axis=0)).T, strict=True):
        exact += np.abs(x - (y if x @ y >= 0.0 else -y)) / 6.0
    np.testing.assert_allclose(ecomac(a, b), exact, rtol=1e-12)
    plane = rng().normal(size=(5, 2))
    project = plane @ np.linalg.inv(plane.T @ plane) @ plane.T
    np.testing.assert_allclose(nearest_in_plane(a, plane), project @ a, atol=1e-12)


def test_an_expansion_is_a_fit_and_its_errors_those_of_fits_without_each_sensor():
    """Eight channels at four sensors, three of five modes."""
    shapes, labels = rng().normal(size=(8, 5)), np.array([3, 3, 1, 1, 1, 7, 7, 9])
    measured = rng().normal(size=(8, 7))[:, 5:]
    found = expand(measured, shapes, labels, modes=[4, 0, 1])
    basis = shapes[:, [4, 0, 1]]
    fit = np.linalg.lstsq(basis, measured, rcond=None)[0]
    np.testing.assert_allclose(found.coordinates, fit, atol=1e-12)
    np.testing.assert_allclose(found.smoothed, basis @ fit, atol=1e-12)
    assert found.condition == pytest.approx(np.linalg.cond(basis), rel=1e-9)
    away = np.linalg.norm(measured - basis @ fit, axis=0) / np.linalg.norm(measured, axis=0)
    np.testing.assert_allclose(found.outside, away, rtol=1e-9)
    for k, label in enumerate((1, 3, 7, 9)):
        on = labels == label
        others = np.linalg.lstsq(basis[~on], measured[~on], rcond=None)[0]
        error = np.sqrt(np.mean((measured[on] - basis[on] @ others) ** 2, axis=0) / np.mean(measured**2, axis=0))
        np.testing.assert_allclose(found.left_out[k], error, rtol=1e-8)
    nodal = rng().normal(size=(2, 5, 5))
    np.testing.assert_allclose(found.fields(nodal), np.einsum("ncm,mk->nck", nodal[:, :, [4, 0, 1]], fit), atol=1e-12)


def test_a_sensor_without_which_the_modes_are_not_told_has_no_error():
    found = expand(
        np.array([[1.0], [2.0], [3.0]]), np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.arange(3), [0, 1]
    )
    np.testing.assert_allclose(found.left_out[:, 0], [np.sqrt(3.0 / 14.0)] * 2 + [np.nan], rtol=1e-12)


def test_an_expansion_has_a_mode_at_least_and_no_more_than_channels():
    shapes = rng().normal(size=(3, 5))
    assert len(expand(shapes[:, :1], shapes, np.arange(3), [0, 1, 2]).modes) == 3
    for modes, words in (
        ([], "0 modes on 3 channels"),
        ([0, 1, 2, 3], "4 modes on 3 channels"),
        ([1, 1], "2 modes look al"),
    ):
        with pytest.raises(cf.errors.ModelError, match=words):
            expand(shapes[:, :1], shapes, np.arange(3), modes)


@pytest.mark.parametrize(("angle", "kept"), [(0.0201, [0, 2, 3]), (0.0199, [0, 3])])
def test_modes_are_kept_up_to_a_condition_of_a_hundred(angle, kept):
    """Of two unit vectors an angle apart it is 1/tan(angle/2); a mode that no sensor sees is left out."""
    shapes = np.zeros((6, 4))
    shapes[0, 0], shapes[:2, 2], shapes[2, 3] = 5.0, [np.cos(angle), np.sin(angle)], 0.1
    assert well_conditioned(shapes) == kept


@pytest.mark.parametrize(("channels", "most"), [(1, 1), (2, 1), (3, 2), (4, 2), (5, 3), (6, 4)])
def test_as_many_modes_are_kept_as_two_thirds_of_the_channels(channels, most):
    assert well_conditioned(np.eye(channels)) == list(range(most))


@pytest.mark.parametrize(("size", "seen"), [(1.2e-9, True), (0.8e-9, False)])
def test_a_mode_is_seen_from_a_billionth_of_the_largest_on(size, seen):
    measured, computed = np.array([[1.0], [0.5]]), np.array([[1.0, 0.0], [0.0, size]])
    assert (seen_mac(measured, computed)[0, 1] > 0.0) == seen
    mass = np.diag([1.0, 1.0 / size])
    assert (seen_mac(measured, computed, mass)[0, 1] > 0.0) == seen


def match(rows, modes, n=4, **more):
    hz = {"measured_hz": (100.0,) * len(rows), "computed_hz": (101.0,) * len(rows)}
    return Match(**{"rows": rows, "modes": modes, "n": n, "confidence": 0.5} | hz | more)


def test_a_match_is_compared_with_the_whole_plane_of_its_doublet():
    modes = SimpleNamespace(doublets=((1, 2), (4, 5)))
    measured, computed = rng().normal(size=(6, 3)), rng().normal(size=(6, 9))[:, 3:]
    one, two, alone = match((2,), (2,)), match((0, 1), (4, 5)), match((1,), (3,))
    assert [plane_of(each, modes) for each in (one, two, alone)] == [[1, 2], [4, 5], [3]]
    exact = np.mean(np.cos(subspace_angles(measured[:, :2], computed[:, 4:])) ** 2)
    assert alike(two, modes, measured, computed) == pytest.approx(exact, rel=1e-9)
    first, second = partners((one, two), modes, measured, computed)
    for k, (row, plane) in enumerate(((2, [1, 2]), (0, [4, 5]), (1, [4, 5]))):
        size, basis = np.linalg.norm(measured[:, row]), computed[:, plane]
        near = basis @ np.linalg.lstsq(basis, measured[:, row], rcond=None)[0]
        np.testing.assert_allclose(first[:, k], measured[:, row] / size, rtol=1e-12)
        np.testing.assert_allclose(second[:, k], near / size, rtol=1e-9)


@pytest.mark.parametrize("allowed", [0.3, 0.2])
def test_a_sensor_is_refused_where_it_stands_further_away_than_is_allowed(allowed):
    where, distance = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.12345]]), np.array([0.1, 0.3])
    if allowed == 0.3:
        refuse_far(where, np.array([11, 12]), distance, allowed, "the wall")
        return
    with pytest.raises(
        cf.errors.ModelError, match=r"sensor 12 at \[4.0, 5.0, 6.1234\] m is 0.3 m from the wall, 0.2 m are allowed"
    ):
        refuse_far(where, np.array([11, 12]), distance, allowed, "the wall")


def test_measured_shapes_have_unit_directions_numbers_and_a_table():
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=[20.0, 10.0],
        values=[[1.0, 2.0], [3.0, 4.0]],
        points=np.eye(3)[:2],
        directions=[[0.0, 3.0, 4.0], [2.0, 0, 0]],
    )
    np.testing.assert_allclose(test.directions, [[0.0, 0.6, 0.8], [1.0, 0.0, 0.0]], rtol=1e-15)
    assert (test.labels.tolist(), test.sensors.tolist(), test.n.tolist()) == ([1, 2], [1, 2], [-1, -1])
    assert np.isnan(test.sigma).all()
    assert test.real.tolist() == [[2.0, 1.0], [4.0, 3.0]]
    assert test.collinearity.tolist() == [1.0, 1.0]
    np.testing.assert_allclose(test.table().sigma_hz, [0.01, 0.02], rtol=1e-14)
    np.testing.assert_allclose(test.table(0.1).sigma_hz, [1.0, 2.0], rtol=1e-14)
    assert test.table().freq_hz.tolist() == [10.0, 20.0]
    assert not any(getattr(test, name).flags.writeable for name in ("freq_hz", "values", "points", "sigma", "n"))


def shape(values, analysis=2, reals=(50.0, 1.0, 0.0, 0.0), nodes=(4, 2)):
    return cf.uff.Shape(
        text=("",) * 5,
        model=1,
        analysis=analysis,
        characteristic=2,
        quantity=8,
        integers=(1, 1),
        reals=reals,
        nodes=np.array(nodes),
        values=np.array(values),
    )


def test_a_file_s_channels_are_the_directions_in_which_a_mode_moves():
    """From a billionth of the largest value on; real and complex modes, not those of 0 Hz or of another analysis."""
    nodes = cf.uff.Nodes(
        labels=np.array([2, 3, 4]),
        points=np.arange(9.0).reshape(3, 3),
        systems=np.zeros(3),
        motions=np.array([0, 5, 0]),
    )
    first = shape([[2.0, 1.8e-9, 0.0], [0.0, 2.2e-9, 1.0]])
    second = shape([[1.0j, 0.0, 0.0], [0.0, 0.0, 0.5]], 3, (0.0, 2.0 * np.pi * 30.0, 0.0, 0.0, 0.0, 0.0))
    third = shape([[0.5, 0.0, 0.0], [0.0, 0.0, 2.0]], 7, (0.0, 2.0 * np.pi * 60.0, 0.0, 0.0, 0.0, 0.0))
    left_out = [shape([[9.0, 9.0, 9.0]] * 2, reals=(0.0, 1.0, 0.0, 0.0)), shape([[9.0, 9.0, 9.0]] * 2, 5)]
    found = uff_shapes(cf.uff.UniversalFile(path="f.uff", nodes=nodes, shapes=(first, *left_out, second, third)))
    np.testing.assert_allclose(found.freq_hz, [30.0, 50.0, 60.0])
    assert found.labels.tolist() == [4, 2, 2]
    assert found.directions.tolist() == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    assert found.points.tolist() == [[6.0, 7.0, 8.0], [0.0, 1.0, 2.0], [0.0, 1.0, 2.0]]
    np.testing.assert_array_equal(found.values, [[1.0j, 2.0, 0.5], [0.0, 2.2e-9, 0.0], [0.5, 1.0, 2.0]])
    assert found.path == "f.uff"
    with pytest.raises(cf.errors.InputError, match="found 2 shapes, none of a mode"):
        uff_shapes(cf.uff.UniversalFile(path="f.uff", nodes=nodes, shapes=tuple(left_out)))
