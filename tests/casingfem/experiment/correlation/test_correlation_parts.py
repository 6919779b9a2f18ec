"""Parts of a correlation written out: planes, expansions, sensors left out, what differs, shapes of a file."""

import numpy as np
import pytest
from scipy.linalg import sqrtm, subspace_angles

import casingfem as cf

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
        with pytest.raises(ValueError, match="found a shape that is zero"):
            cf.correlation.mac(one, other)


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
