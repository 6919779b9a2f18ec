"""Scaled pencils, gaps between eigenvalues, sums of elements and groups of coupled masses, against dense matrices."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh, eigvalsh
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.linalg.eigen import EigenResult, gap_after, gaps, solve, solve_band, sturm_count
from casingfem.linalg.element_sum import Elements, ElementSum, absolute
from casingfem.linalg.memory import MemoryNeedError, require_affordable, require_memory
from casingfem.linalg.pencil import (
    clear_of_eigenvalues,
    diagonalised,
    make_pencil,
    most_round_off,
    places_in,
    round_off,
    scaled,
    widened,
)

RNG = np.random.default_rng(31)
SIZE = 9
DIAGONAL = np.linspace(0.5, 4.0, SIZE)
HALF = RNG.standard_normal((SIZE, SIZE))
K = HALF @ HALF.T + np.diag(np.arange(SIZE))
COUPLED = np.diag(DIAGONAL) + np.diag(np.full(SIZE - 1, 0.2), 1) + np.diag(np.full(SIZE - 1, 0.2), -1)


@pytest.mark.parametrize("mass", [DIAGONAL, COUPLED])
def test_a_pencil_is_scaled_to_a_unit_diagonal_of_its_mass(mass):
    M = np.diag(mass) if mass.ndim == 1 else mass
    pencil = make_pencil(csc_array(K), mass if mass.ndim == 1 else csc_array(mass))
    R = np.diag(1.0 / np.sqrt(np.diag(M)))
    x = RNG.standard_normal((SIZE, 2))
    np.testing.assert_allclose(pencil.A.toarray(), R @ K @ R, rtol=1e-12)
    np.testing.assert_allclose(pencil.shifted(0.7).toarray(), R @ (K - 0.7 * M) @ R, atol=1e-12)
    np.testing.assert_allclose(pencil.weigh(x), R @ M @ R @ x, rtol=1e-12)
    assert (pencil.size, pencil.modes) == (SIZE, SIZE)
    lengths = np.sqrt(np.diag(x.T @ R @ M @ R @ x))
    assert pencil.norm(x) == pytest.approx(lengths.max(), rel=1e-12)
    lam = np.array([-2.0, 0.5])
    left = np.linalg.norm(R @ K @ R @ x - R @ M @ R @ x * lam, axis=0)
    np.testing.assert_allclose(pencil.residuals(lam, x, 1.0), left / [2.0, 1.0], rtol=1e-12)
    values = eigvalsh(K, M)
    assert [pencil.count_below(v) for v in (values[2] * 0.999, values[2] * 1.001, values[-1] + 1.0)] == [2, 3, SIZE]
    assert sturm_count(csc_array(K), csc_array(M), 0.5 * (values[4] + values[5])) == 5


def test_complex_vectors_are_measured_by_their_conjugates():
    pencil = make_pencil(csc_array(K), DIAGONAL)
    assert pencil.norm(np.array([[3j], [4.0], *[[0.0]] * (SIZE - 2)])) == pytest.approx(5.0)


def test_entries_of_a_mass_have_places_in_the_stiffness():
    A = csc_array(np.array([[1.0, 2.0, 0.0], [2.0, 3.0, 4.0], [0.0, 4.0, 5.0]]))
    assert A.data[places_in(A, None)].tolist() == [1.0, 3.0, 5.0]
    M = csc_array(np.array([[9.0, 0.0, 0.0], [0.0, 9.0, 9.0], [0.0, 9.0, 9.0]]))
    assert A.data[places_in(A, M)].tolist() == [1.0, 3.0, 4.0, 4.0, 5.0]
    np.testing.assert_array_equal(scaled(A, np.array([1.0, 2.0, 3.0])).toarray(), [[1, 4, 0], [4, 12, 24], [0, 24, 45]])


def test_a_stiffness_without_entries_of_the_mass_is_widened():
    diagonal = csc_array(np.diag([2.0, 3.0, 4.0]))
    M = csc_array(np.array([[1.0, 0.1, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    wide = widened(diagonal, M)
    assert wide.nnz == 5
    np.testing.assert_array_equal(wide.toarray(), diagonal.toarray())
    values = eigvalsh(diagonal.toarray(), M.toarray())
    pencil = make_pencil(diagonal, M)
    assert [pencil.count_below(v + 0.01) for v in values] == [1, 2, 3]
    hollow = csc_array(np.array([[0.0, 1.0], [1.0, 0.0]]))
    assert make_pencil(hollow, np.array([1.0, 4.0])).count_below(0.0) == 1
    np.testing.assert_allclose(make_pencil(hollow, np.array([1.0, 4.0])).shifted(2.0).toarray(), [[-2, 0.5], [0.5, -2]])


def test_unknowns_without_mass_are_as_stiff_as_the_others_and_no_modes():
    stiff = np.array([[5.0, -0.4, 0.0], [-0.4, 0.5, -0.1], [0.0, -0.1, 3.0]])
    M = np.diag([1.0, 0.0, 4.0])
    pencil = make_pencil(csc_array(stiff), csc_array(M))
    assert (pencil.size, pencil.modes, pencil.massless) == (3, 2, 1)
    condensed = stiff[::2, ::2] - np.outer(stiff[::2, 1], stiff[1, ::2]) / 0.5
    values = eigvalsh(condensed, M[::2, ::2])
    assert [pencil.count_below(v * by) for v in values for by in (0.99, 1.01)] == [0, 1, 1, 2]
    np.testing.assert_allclose(pencil.A.diagonal(), [5.0, np.median([5.0, 0.75]), 0.75], rtol=1e-12)
    assert pencil.weigh(np.eye(3))[1, 1] == 0.0


@pytest.mark.parametrize("mass", [np.array([1.0, 0.0, 1.0]), csc_array(np.diag([1.0, -1.0, 1.0]))])
def test_masses_that_are_not_positive_are_refused(mass):
    with pytest.raises(cf.errors.NumericsError, match="the mass has a diagonal that is not positive"):
        make_pencil(csc_array(np.eye(3)), mass)
    with pytest.raises(cf.errors.NumericsError, match="the mass is of 3 unknowns, the stiffness of 2"):
        make_pencil(csc_array(np.eye(2)), mass)
    loose = csc_array(np.diag([1.0, 0.0, 1.0]))
    with pytest.raises(cf.errors.NumericsError, match="not positive"):  # neither mass nor stiffness
        make_pencil(loose, csc_array(np.diag([1.0, 0.0, 1.0])))


def test_a_count_on_an_eigenvalue_names_its_shift():
    with pytest.raises(cf.errors.NumericsError, match="no Sturm count at shift 2: the matrix is singular"):
        make_pencil(csc_array(np.diag([2.0, 8.0])), np.array([1.0, 1.0])).count_below(2.0)


VALUES = np.array([-1.0, 0.0, 1.0, 1.0 + 1e-8, 1.0 + 3e-7, 5.0, 9.0])


@pytest.mark.parametrize(
    ("count", "floor", "clear", "found"),
    [
        (1, 0.0, 1e-7, [0, 1, 3, 4, 5]),
        (3, 0.0, 1e-7, [1, 2, 3]),
        (3, 0.0, 1e-6, [2, 3]),
        (1, 3.0, 0.4, [4, 5]),
        (5, 0.0, 0.6, [0]),
    ],
)
def test_gaps_are_clear_relative_to_the_upper_value_or_the_floor(count, floor, clear, found):
    assert gaps(VALUES, count, floor, clear).tolist() == found


@pytest.mark.parametrize(
    ("count", "noise", "below", "middle"),
    [
        (1, 0.0, 1, -0.5),
        (3, 0.0, 4, 1.0 + 1.55e-7),
        (3, 1e-3, 5, 3.00000015),
        (3, 1.99, 5, 3.00000015),
        (3, 2.1, 4, 1.0 + 1.55e-7),
        (6, 0.0, 6, 7.0),
    ],
)
def test_a_gap_wider_than_round_off_comes_first(count, noise, below, middle):
    found = gap_after(VALUES, count, noise=noise)
    assert found[0] == below
    assert found[1] == pytest.approx(middle, rel=1e-9)
    with pytest.raises(cf.errors.NumericsError, match="no gap among eigenvalues 7 to 7"):
        gap_after(VALUES, 7)


def test_frequencies_are_roots_over_two_pi_and_never_below_zero():
    found = EigenResult(np.array([-1e-3, 0.0, 39.4784176]), np.zeros((3, 3)), 3)
    np.testing.assert_allclose(found.freq, [0.0, 0.0, 1.0], rtol=1e-8)


@pytest.mark.parametrize("wanted", [3, (1e-3, 0.55)])
def test_a_count_or_a_band_in_hertz_gives_mass_normalised_modes(wanted):
    values, vectors = eigh(K, np.diag(DIAGONAL))
    inside = (
        np.arange(3) if wanted == 3 else np.flatnonzero((values > (2e-3 * np.pi) ** 2) & (values < (1.1 * np.pi) ** 2))
    )
    found = solve(csc_array(K), DIAGONAL, wanted, shift=-0.1)
    np.testing.assert_allclose(found.eigenvalues, values[inside], rtol=1e-9)
    assert found.sturm_count == len(inside)
    np.testing.assert_allclose(
        np.abs(found.vectors.T @ (DIAGONAL[:, None] * vectors[:, inside])), np.eye(len(inside)), atol=1e-7
    )
    assert found.products > 0


@pytest.mark.parametrize("band", [(1.0, 1.0), (-1.0, 2.0), (0.0, np.inf)])
def test_a_band_that_is_none_is_refused(band):
    with pytest.raises(cf.errors.NumericsError, match="a band runs from 0 or above to a higher end"):
        solve_band(csc_array(K), DIAGONAL, band, -0.1)


DOFS = np.array([[0, 2, 5], [2, 4, 3], [5, 1, 4]])  # 5 is held


def element_sum():
    parts = RNG.standard_normal((3, 3, 3))
    parts = parts + parts.transpose(0, 2, 1)
    first = Elements(DOFS[:2], parts[:2])
    dense = np.zeros((6, 6))
    bound = np.zeros((6, 6))
    for dofs, part in zip(DOFS, parts, strict=True):
        np.add.at(dense, np.ix_(dofs, dofs), part)
        np.add.at(bound, np.ix_(dofs, dofs), np.abs(part))
    return ElementSum.of([first, Elements(DOFS[2:], parts[2:])], 5), dense[:5, :5], bound[:5, :5]


def test_a_sum_of_elements_is_that_of_its_matrices_scaled_and_with_a_diagonal():
    A, dense, bound = element_sum()
    root, added = np.array([1.0, -2.0, 0.5, 3.0, 1.5]), np.array([1.0, -2.0, 3.0, 0.0, 5.0])
    other = A.plus(added).scaled(root).plus(0.25)
    expected = root[:, None] * (dense + np.diag(added)) * root + 0.25 * np.eye(5)
    x = RNG.standard_normal((5, 2))
    np.testing.assert_allclose(other @ x, expected @ x, atol=1e-12)
    np.testing.assert_allclose(other @ x[:, 0], expected @ x[:, 0], atol=1e-12)
    np.testing.assert_allclose(other.tocsc().toarray(), expected, atol=1e-12)
    most = np.abs(root)[:, None] * bound * np.abs(root) + np.diag(np.abs(root**2 * added + 0.25))
    np.testing.assert_allclose(abs(other) @ x, most @ x, atol=1e-12)
    held = make_pencil(other.plus(50.0), np.array([1.0, 4.0, 9.0, 1.0, 0.25]))
    R = np.diag([1.0, 0.5, 1.0 / 3.0, 1.0, 2.0])
    np.testing.assert_allclose(held.shifted(0.7) @ x, (R @ (expected + 50.0 * np.eye(5)) @ R - 0.7 * np.eye(5)) @ x)
    assert other.shape == (5, 5)
    assert other.finite
    assert not A.plus(np.array([np.nan, 0, 0, 0, 0])).finite
    assert not replace(A, scale=np.array([np.inf, 1.0, 1.0, 1.0, 1.0])).finite


def test_stacked_products_of_absolute_values_do_not_depend_on_their_pieces(monkeypatch):
    matrices, x = RNG.standard_normal((7, 3, 3)), RNG.standard_normal((7, 3, 2))
    expected = np.abs(matrices) @ x
    np.testing.assert_allclose(absolute(matrices, x), expected, rtol=1e-13)
    for chunk in (1, 18, 27):
        monkeypatch.setitem(absolute.__globals__, "CHUNK", chunk)
        np.testing.assert_allclose(absolute(matrices, x), expected, rtol=1e-13)


def test_coupled_masses_keep_their_diagonal_and_lose_their_coupling():
    """Loewdin: T = D^-1/2 S^-1/2 D^1/2 in each group; what is not coupled stays as it is."""
    M = np.diag([2.0, 3.0, 1.0, 5.0, 4.0])
    M[0, 3] = M[3, 0] = 1.0
    M[3, 4] = M[4, 3] = -0.7
    mass, change = diagonalised(csc_array(M))
    T = change.toarray()
    np.testing.assert_array_equal(mass, np.diag(M))
    np.testing.assert_allclose(T.T @ M @ T, np.diag(mass), atol=1e-13)
    np.testing.assert_array_equal(T[[1, 2]], np.eye(5)[[1, 2]])
    root = np.sqrt(np.diag(M))
    S = M / np.outer(root, root)
    values, turn = np.linalg.eigh(S)
    np.testing.assert_allclose(T, np.diag(1.0 / root) @ (turn / np.sqrt(values)) @ turn.T @ np.diag(root), atol=1e-12)
    np.testing.assert_array_equal(diagonalised(csc_array(np.diag([1.0, 2.0])))[1].toarray(), np.eye(2))


@pytest.mark.parametrize(
    ("M", "words"), [(np.diag([1.0, 0.0]), "a dof without mass"), (np.array([[1.0, 2.0], [2.0, 1.0]]), "not positive$")]
)
def test_a_mass_that_is_not_positive_cannot_be_made_diagonal(M, words):
    with pytest.raises(ValueError, match=words):
        diagonalised(csc_array(M))


def test_round_off_of_an_eigenvalue_is_a_unit_of_all_that_adds_up_to_it():
    A, x = np.array([[2.0, -3.0], [-3.0, 7.0]]), np.array([[0.6, -1.0], [-0.8, 2.0]])
    unit = np.finfo(float).eps
    np.testing.assert_allclose(
        round_off(A, x), unit * np.array([0.72 + 2 * 1.44 + 4.48, 2.0 + 12.0 + 28.0]), rtol=1e-12
    )
    np.testing.assert_allclose(most_round_off(A, x), unit * np.array([5 * 0.36 + 10 * 0.64, 5.0 + 40.0]), rtol=1e-12)
    assert not clear_of_eigenvalues(1.0, np.array([0.5, 3.0]), np.array([0.5, 0.1]))
    assert clear_of_eigenvalues(1.0, np.array([0.5, 3.0]), np.array([0.499, 1.9]))


@pytest.mark.parametrize(
    ("modes", "unknowns", "refused"),
    [(1000.0, 10**9, False), (1001.0, 10**9, True), (2e4, 10**4, False), (2.01e4, 10**4, True)],
)
def test_an_hours_modes_or_a_thousand_are_affordable(modes, unknowns, refused):
    if refused:
        with pytest.raises(Exception, match="modes-count"):
            require_affordable(modes, unknowns)
    else:
        require_affordable(modes, unknowns)


def test_nine_tenths_of_what_is_free_may_be_taken():
    require_memory(8.99e9, 10, 1e10)
    with pytest.raises(MemoryNeedError, match=r"the factor of 10 unknowns takes 9\.1 GB, 10 GB are free"):
        require_memory(9.1e9, 10, 1e10)
    with pytest.raises(MemoryNeedError, match="0 GB are free"):
        require_memory(1.0, 10, -5.0)
