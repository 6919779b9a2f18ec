"""Steps of the block Lanczos search, one by one, against dense matrices."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.linalg.krylov import Basis, independent, nearest, orthonormal, project_out
from casingfem.linalg.pencil import make_pencil

SIZE = 14
KINDS = pytest.mark.parametrize("complex_", [False, True])


def pencil_of(complex_=False):
    """A dense pencil of some size, its A and B."""
    rng = np.random.default_rng(5)
    half, other = (rng.standard_normal((SIZE, SIZE)) + 1j * complex_ * rng.standard_normal((SIZE, SIZE)) for _ in "ab")
    K, M = half @ half.conj().T, 0.05 * other @ other.conj().T + np.diag(np.linspace(1.0, 3.0, SIZE))
    pencil = make_pencil(csc_array(K if complex_ else K.real), csc_array(M if complex_ else M.real))
    return pencil, pencil.A.toarray(), pencil.B.toarray()


def block_of(complex_, columns, seed=1):
    rng = np.random.default_rng(seed)
    found = rng.standard_normal((SIZE, columns)) + (1j * rng.standard_normal((SIZE, columns)) if complex_ else 0.0)
    return np.asfortranarray(found)


@KINDS
def test_an_independent_span_is_b_orthonormal_and_as_wide_as_its_directions_are_long(complex_):
    pencil, _, B = pencil_of(complex_)
    X = block_of(complex_, 3)
    X = np.linalg.solve(np.linalg.cholesky(X.conj().T @ B @ X), X.conj().T).conj().T  # B-orthonormal
    turn = np.linalg.qr(block_of(complex_, 3, 2)[:3])[0]
    made = np.asfortranarray(X * [5.0, 2.0, 1e-3] @ turn)
    for noise, count in ((0.0, 3), (0.99e-3, 3), (1.01e-3, 2), (1.99, 2), (2.01, 1), (5.1, 0)):
        found = independent(pencil, made, noise)
        assert found.shape == (SIZE, count)
        np.testing.assert_allclose(found.conj().T @ B @ found, np.eye(count), atol=1e-9)
        kept = X[:, :count]
        np.testing.assert_allclose(kept @ (kept.conj().T @ B @ found), found, atol=1e-9)
    faint = np.asfortranarray(X * [5.0, 2.0, 1e-7] @ turn)
    assert independent(pencil, faint).shape == (SIZE, 2)  # its square is round-off of the largest
    basis, C = orthonormal(pencil, made, 0.0)
    np.testing.assert_allclose(basis @ C, made, atol=1e-12)
    np.testing.assert_allclose(basis.conj().T @ B @ basis, np.eye(3), atol=1e-14)
    assert orthonormal(pencil, made, 2.5)[1].shape == (1, 3)


@KINDS
def test_what_a_block_has_of_a_basis_is_taken_off_and_told(complex_):
    pencil, _, B = pencil_of(complex_)
    Q = np.asfortranarray(independent(pencil, block_of(complex_, 4)))
    block = block_of(complex_, 2, 3)
    before = block.copy()
    part = project_out(pencil, Q, block)
    np.testing.assert_allclose(part, Q.conj().T @ B @ before, atol=1e-13)
    np.testing.assert_allclose(block, before - Q @ part, atol=1e-13)
    nothing = project_out(pencil, Q[:, :0], block)
    assert (nothing.shape, nothing.dtype) == ((0, 2), Q.dtype)
    assert project_out(pencil, Q, block[:, :0]).shape == (4, 0)


def basis_of(complex_, room=12):
    pencil, A, B = pencil_of(complex_)
    inverse = np.linalg.inv(A - 0.4 * B)
    Q, T = np.empty((SIZE, room), dtype=A.dtype, order="F"), np.zeros((room, room), dtype=A.dtype)
    return Basis(pencil=pencil, solve=lambda b: inverse @ b, Q=Q, T=T), inverse, B


@KINDS
def test_a_basis_grows_by_images_and_restarts_from_its_best_vectors(complex_):
    """T is the inverse seen by the basis, and what the basis cannot hold of it is the next block times `coupling`."""
    basis, inverse, B = basis_of(complex_)
    basis.begin(block_of(complex_, 3))
    assert (basis.count, basis.fresh.shape, basis.coupling.shape) == (0, (SIZE, 3), (3, 0))
    for count in (3, 6):
        basis.grow()
        assert (basis.count, basis.tied, basis.products) == (count, count - 3, count)
    seen_before = basis.count
    Q = basis.Q[:, :6].copy()
    np.testing.assert_allclose(Q.conj().T @ B @ Q, np.eye(6), atol=1e-12)
    seen = Q.conj().T @ B @ inverse @ B @ Q
    np.testing.assert_allclose(basis.T[:6, :6], seen, atol=1e-11 * np.abs(seen).max())
    left = inverse @ B @ Q - Q @ seen
    np.testing.assert_allclose(left[:, 3:], basis.fresh @ basis.coupling, atol=1e-11 * np.abs(seen).max())
    assert np.abs(left[:, :3]).max() < 1e-11 * np.abs(seen).max()
    theta, S, over = basis.ritz()
    values = np.linalg.eigvalsh(seen)
    np.testing.assert_allclose(theta, values[np.argsort(-np.abs(values))], rtol=1e-9)
    np.testing.assert_allclose(seen @ S, S * theta, atol=1e-10 * np.abs(theta[0]))
    miss = left @ S
    sizes = np.sqrt(np.diag(miss.conj().T @ B @ miss).real)
    np.testing.assert_allclose(over, sizes / np.maximum(1e-9 * np.abs(theta), 1e-14 * np.abs(theta[0])), rtol=1e-5)
    basis.restart(theta, S, 2)
    assert (basis.count, basis.tied) == (2, 0)
    np.testing.assert_allclose(basis.Q[:, :2], Q @ S[:, :2], atol=1e-12)
    np.testing.assert_array_equal(basis.T[:2, :2], np.diag(theta[:2]))
    assert not basis.T[2:].any()
    basis.grow()
    Q = basis.Q[:, :5]
    np.testing.assert_allclose(Q.conj().T @ B @ Q, np.eye(5), atol=1e-11)
    seen = Q.conj().T @ B @ inverse @ B @ Q
    np.testing.assert_allclose(basis.T[:5, :5], seen, atol=1e-10 * np.abs(seen).max())
    assert (basis.products, seen_before) == (9, 6)


@pytest.mark.parametrize(
    ("theta", "allowed"), [(1.0, 1e-9), (1e-4, 1e-13), (2e-6, 1e-14), (2e-7, 1e-14), (5e-8, 5e-15), (-1e-4, 1e-13)]
)
def test_a_residual_is_allowed_by_its_theta_or_by_round_off_of_the_largest(theta, allowed):
    """A billionth of theta, 1e-14 of the largest theta, but no more than 1e-7 of its own."""
    basis, *_ = basis_of(False)
    basis.count = 2
    basis.T[:2, :2] = np.diag([theta, 1.0])
    basis.coupling = np.array([[3e-10, 0.0], [4e-10, 0.0]])
    values, _, over = basis.ritz()
    assert values.tolist() == sorted([theta, 1.0], key=lambda v: -abs(v))
    assert over.max() == pytest.approx(5e-10 / allowed, rel=1e-12)


def test_a_new_beginning_keeps_clear_of_the_basis():
    basis, _, B = basis_of(False)
    basis.begin(block_of(False, 3))
    basis.grow()
    old = basis.Q[:, :3].copy()
    mixed = old + 1e-3 * block_of(False, 3, 4)
    basis.begin(mixed)
    np.testing.assert_allclose(old.T @ B @ basis.fresh, 0.0, atol=1e-13)
    np.testing.assert_allclose(basis.fresh.T @ B @ basis.fresh, np.eye(3), atol=1e-13)
    assert basis.coupling.shape == (3, 3)
    assert not basis.coupling.any()
    basis.begin(old)
    assert basis.fresh.shape[1] == 0  # it has nothing of its own


def test_the_nearest_are_on_either_side_of_the_shift():
    pencil, A, B = pencil_of(True)
    values = eigh(A, B, eigvals_only=True)
    sigma = values[5] + 0.3 * (values[6] - values[5])
    inverse = np.linalg.inv(A - sigma * B)
    found = nearest(pencil, lambda b: inverse @ b, sigma, 4, block=2)
    order = np.argsort(np.abs(values - sigma))[:4]
    np.testing.assert_allclose(found.values, values[order], rtol=1e-9)
    np.testing.assert_allclose(found.vectors.conj().T @ B @ found.vectors, np.eye(4), atol=1e-8)
    np.testing.assert_allclose(A @ found.vectors, B @ found.vectors * found.values, atol=1e-6)


def test_a_mass_of_fewer_ways_than_wanted_modes_is_refused():
    K, M = np.diag([2.0, 3.0, 4.0, 5.0]), np.zeros((4, 4))
    M[:2, :2] = [[1.0, 1.0], [1.0, 1.0]]
    pencil = make_pencil(csc_array(K), csc_array(M))
    assert pencil.modes == 2
    A = pencil.A.toarray() + 1.0 * pencil.B.toarray()
    with pytest.raises(cf.errors.NumericsError, match="the mass moves 1 ways, 2 modes were asked for"):
        nearest(pencil, lambda b: np.linalg.solve(A, b), -1.0, 2)
