"""Eigen solver: Sturm count against dense eigenvalues, recovery of missed modes, refusals."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csc_array, diags_array

import casingfem as cf
from casingfem.linalg import eigen, krylov
from casingfem.linalg.eigen import gap_after, solve, solve_modes, sturm_count
from casingfem.linalg.factor import factorise, solve_held
from casingfem.linalg.krylov import ConvergenceError, RitzPairs, nearest
from casingfem.linalg.pencil import make_pencil


def chain(size, ends=1.0):
    """Springs and unit masses in a line, held at both ends by `ends`: eigenvalues 4 sin^2(k pi/2/(size + 1))."""
    K = diags_array([np.full(size, 2.0), np.full(size - 1, -1.0), np.full(size - 1, -1.0)], offsets=[0, 1, -1])
    K = csc_array(K).tolil()
    K[0, 0] = K[size - 1, size - 1] = 1.0 + ends
    return csc_array(K)


def random_pair(size, seed):
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(size, size))
    return A @ A.T + 0.1 * np.eye(size), rng.uniform(0.5, 2.0, size)


@pytest.mark.parametrize("size", [5, 12, 30])
def test_sturm_count_equals_the_dense_count(size):
    K, mass = random_pair(size, seed=size)
    values = eigh(K, np.diag(mass), eigvals_only=True)
    for count, (low, high) in enumerate(pairwise(values), 1):
        assert sturm_count(csc_array(K), mass, 0.5 * (low + high)) == count


def test_sturm_count_on_a_chain_of_known_eigenvalues():
    exact = 4 * np.sin(np.arange(1, 201) * np.pi / 402) ** 2
    for below in (0, 1, 57, 199, 200):
        sigma = 0.5 * (np.append(0, exact)[below] + np.append(exact, 5)[below])
        assert sturm_count(chain(200), np.ones(200), sigma) == below


def off_sines(shapes):
    """How far modes of a held chain or string, of length 1 each, are from sines."""
    size, count = shapes.shape
    sines = np.sin(np.outer(np.arange(1, size + 1), np.arange(1, count + 1)) * np.pi / (size + 1))
    sines, shapes = (columns / np.linalg.norm(columns, axis=0) for columns in (sines, shapes))
    return np.linalg.norm(shapes * np.sign(np.sum(sines * shapes, axis=0)) - sines, axis=0)


@pytest.mark.parametrize("unit", [1.0, 1e12])
def test_modes_of_a_chain_are_sines_in_any_unit(unit):
    exact = 4 * np.sin(np.arange(1, 301) * np.pi / 602) ** 2
    found = solve_modes(unit * chain(300), np.ones(300), 12, shift=-1e-6 * unit)
    np.testing.assert_allclose(found.eigenvalues, unit * exact[:12], rtol=1e-10)
    assert found.sturm_count == 12
    assert off_sines(found.vectors).max() < 1e-10


@pytest.mark.slow
def test_vectors_to_spare_take_less_and_the_others_lose_nothing():
    pencil = make_pencil(chain(2000), np.ones(2000))
    solve = factorise(pencil.shifted(-1e-6)).solve
    all_exact, some_spare = (nearest(pencil, solve, -1e-6, 40, spare=spare) for spare in (0, 8))
    assert some_spare.products < all_exact.products
    exact = 4 * np.sin(np.arange(1, 41) * np.pi / 4002) ** 2
    np.testing.assert_allclose(some_spare.values, exact, rtol=1e-9)
    shapes = some_spare.vectors[:, np.argsort(some_spare.values)]
    assert off_sines(shapes)[:32].max() < 1e-9


@pytest.mark.slow
def test_modes_of_a_shell_equal_the_dense_solution(frustum, coarse):
    system = cf.shell.assemble(frustum(mesh=coarse))
    found = solve_modes(system.K, system.mass, 10, shift=-1e3)
    exact = eigh(make_pencil(system.K, system.mass).A.toarray(), subset_by_index=[0, 9], eigvals_only=True)
    np.testing.assert_allclose(found.eigenvalues, exact, rtol=1e-9)
    gram = found.vectors.T @ (system.mass[:, None] * found.vectors)
    np.testing.assert_allclose(gram, np.eye(10), atol=1e-10)
    np.testing.assert_allclose(found.vectors.T @ (system.K @ found.vectors), np.diag(exact), atol=1e-9 * exact[-1])


@pytest.mark.parametrize("extra", [0, 1])
def test_few_modes_beyond_those_wanted_end_too(extra):
    """Without one mode more there is no gap to see: the search goes on instead of round in circles."""
    found = solve_modes(chain(300), np.ones(300), 5, shift=-1e-6, extra=extra)
    assert len(found.eigenvalues) == found.sturm_count == 5


def blind(misses, count=1):
    """A search that loses the second lowest eigenpair in its first `misses` calls."""
    calls = []

    def search(pencil, solve, sigma, wanted, *rest):
        calls.append(wanted)
        found = nearest(pencil, solve, sigma, wanted, *rest)
        if len(calls) > misses:
            return found
        kept = np.argsort(found.values)[np.r_[0, 1 + count : wanted]]
        return RitzPairs(values=found.values[kept], vectors=found.vectors[:, kept], products=found.products)

    return search, calls


def test_a_missed_mode_shows_in_the_count_and_is_found(monkeypatch):
    search, calls = blind(misses=1)
    monkeypatch.setattr(eigen, "nearest", search)
    found = solve_modes(chain(300), np.ones(300), 6, shift=-1e-6)
    exact = 4 * np.sin(np.arange(1, 7) * np.pi / 602) ** 2
    np.testing.assert_allclose(found.eigenvalues, exact, rtol=1e-10)
    assert len(calls) == 2
    assert calls[1] > calls[0]


def test_modes_missed_again_and_again_are_an_error(monkeypatch):
    search, calls = blind(misses=99)
    monkeypatch.setattr(eigen, "nearest", search)
    with pytest.raises(cf.errors.NumericsError, match=r"7 modes lie below .* Hz, 6 were found"):
        solve_modes(chain(300), np.ones(300), 6, shift=-1e-6)
    assert len(calls) == 3


def test_free_body_is_solved_by_the_shift():
    found = solve_modes(chain(100, ends=0.0), np.ones(100), 3, shift=-1e-4)
    np.testing.assert_allclose(found.eigenvalues, 4 * np.sin(np.arange(3) * np.pi / 200) ** 2, atol=1e-13)


def consistent_mass(size):
    """Mass of linear elements of unit length and density, held ends: (4, 1)/6 on its three diagonals."""
    return csc_array(diags_array([np.full(size, 4.0), np.ones(size - 1), np.ones(size - 1)], offsets=[0, 1, -1]) / 6.0)


def test_a_mass_that_is_not_diagonal():
    """Linear elements on a held string: lambda = 6 (1 - c)/(2 + c), c = cos(k pi/(size + 1))."""
    size = 300
    c = np.cos(np.arange(1, 13) * np.pi / (size + 1))
    exact = 6 * (1 - c) / (2 + c)
    K, M = chain(size), consistent_mass(size)
    found = solve_modes(K, M, 12, shift=-1e-6)
    np.testing.assert_allclose(found.eigenvalues, exact, rtol=1e-10)
    np.testing.assert_allclose(found.vectors.T @ (M @ found.vectors), np.eye(12), atol=1e-10)
    assert found.sturm_count == 12
    assert off_sines(found.vectors).max() < 1e-10
    assert sturm_count(K, M, 0.5 * (exact[6] + exact[7])) == 7


def test_entries_may_are_in_any_order_and_in_parts():
    """As matrices of other programs have them: each column backwards, each entry as two halves."""
    K, M = chain(40), consistent_mass(40)
    exact = solve_modes(K, M, 6, shift=-1e-6)
    mixed = []
    for A in (csc_array(K), csc_array(M)):
        order = np.concatenate([np.arange(a, b)[::-1].repeat(2) for a, b in pairwise(A.indptr)])
        mixed.append(csc_array((0.5 * A.data[order], A.indices[order], 2 * A.indptr), shape=A.shape))
    found = solve_modes(*mixed, 6, shift=-1e-6)
    np.testing.assert_allclose(found.eigenvalues, exact.eigenvalues, rtol=1e-12)
    assert found.sturm_count == 6
    assert sturm_count(*mixed, 0.5 * (exact.eigenvalues[2] + exact.eigenvalues[3])) == 3


def test_a_hermitian_stiffness_that_lacks_entries_of_the_mass():
    """As in a wheel's sector, where an entry of K cancels and the one of M does not."""
    turn = np.diag(np.exp(1j * np.arange(30)))
    K, M = (csc_array(turn @ A.toarray() @ turn.conj().T) for A in (chain(30), consistent_mass(30)))
    K[[9, 10], [10, 9]] = 0.0
    K.eliminate_zeros()
    exact = eigh(K.toarray(), M.toarray(), eigvals_only=True)
    found = solve_modes(K, M, 6, shift=-1e-3)
    np.testing.assert_allclose(found.eigenvalues, exact[:6], rtol=1e-10)


@pytest.mark.parametrize("mass", [np.r_[1.0, 0.0, np.ones(28)], csc_array(np.diag(np.r_[np.ones(29), -1.0]))])
def test_refuses_a_mass_that_is_not_positive(mass):
    with pytest.raises(cf.errors.NumericsError, match="the mass has a diagonal that is not positive"):
        solve_modes(chain(30), mass, 3, shift=-1e-6)


def test_unknowns_without_mass_follow_statically():
    """Every third point of a chain without mass: the modes of its static condensation, in a count and in a band."""
    K, bare = chain(30), np.arange(1, 30, 3)
    M = np.ones(30)
    M[bare] = 0.0
    A, kept = K.toarray(), np.flatnonzero(M)
    inner = np.linalg.solve(A[np.ix_(bare, bare)], A[np.ix_(bare, kept)])
    exact = eigh(A[np.ix_(kept, kept)] - A[np.ix_(kept, bare)] @ inner, eigvals_only=True)
    low, high = np.sqrt(0.5 * (exact[2:10:6] + exact[3:11:6])) / 2 / np.pi
    whole, band = (
        solve_modes(K, csc_array(np.diag(M)), 12, shift=-1e-6),
        solve(K, csc_array(np.diag(M)), (float(low), float(high)), shift=-1e-6),
    )
    np.testing.assert_allclose(whole.eigenvalues, exact[:12], rtol=1e-10)
    np.testing.assert_allclose(band.eigenvalues, exact[3:9], rtol=1e-10)
    assert (whole.sturm_count, band.sturm_count) == (12, 6)
    np.testing.assert_allclose(whole.vectors[bare], -inner @ whole.vectors[kept], atol=1e-12)
    every = solve_modes(K, csc_array(np.diag(M)), 20, shift=-1e-6)
    np.testing.assert_allclose(every.eigenvalues, exact, rtol=1e-10)
    with pytest.raises(cf.errors.NumericsError, match="count must lie between 1 and 20"):
        solve_modes(K, csc_array(np.diag(M)), 21, shift=-1e-6)


def test_refuses_a_mass_of_another_size():
    with pytest.raises(cf.errors.NumericsError, match="the mass is of 29 unknowns, the stiffness of 30"):
        sturm_count(chain(30), np.ones(29), 1.0)


def test_singular_matrix_is_refused():
    with pytest.raises(cf.errors.NumericsError, match="singular: the structure is not supported"):
        factorise(csc_array(np.zeros((4, 4))))


def test_superlu_states_where_it_cannot_factor_or_count():
    """[[0, 1], [1, 0]] has the eigenvalues 1 and -1, but no pivot on its diagonal."""
    with pytest.raises(cf.errors.NumericsError, match="singular: the structure is not supported"):
        factorise(csc_array(np.ones((3, 3))), "superlu")
    swapped = factorise(csc_array(np.array([[0.0, 1.0], [1.0, 0.0]])), "superlu")
    np.testing.assert_allclose(swapped.solve(np.array([2.0, 3.0])), [3.0, 2.0])
    with pytest.raises(cf.errors.NumericsError, match="pivots off the diagonal"):
        swapped.negative()
    assert factorise(csc_array(np.array([[1.0, 2.0], [2.0, 1.0]])), "superlu").negative() == 1


def test_a_stiffness_without_effect_is_called_loose():
    np.testing.assert_allclose(solve_held(chain(2), np.array([3.0, 0.0])), [2.0, 1.0])
    with pytest.raises(cf.errors.ModelError, match=r"found a singular stiffness.*static-loose"):
        solve_held(csc_array(np.zeros((2, 2))), np.ones(2))


@pytest.mark.parametrize("direct", ["multifrontal", "superlu"])
def test_nothing_is_counted_on_an_eigenvalue(direct):
    pencil = make_pencil(csc_array(np.diag(np.arange(1.0, 9.0))), np.ones(8))
    assert [pencil.count_below(sigma, direct) for sigma in (2.999, 3.001)] == [2, 3]
    with pytest.raises(cf.errors.NumericsError, match="no Sturm count at shift 3: the matrix is singular"):
        pencil.count_below(3.0, direct)


@pytest.mark.parametrize("ways", [1, 2, 5])
def test_a_mass_in_few_places_moves_as_many_ways(ways):
    pencil = make_pencil(csc_array(np.diag(np.arange(1.0, 31.0))), csc_array(np.diag(1.0 * (np.arange(30) < ways))))
    solve = factorise(pencil.shifted(-1.0)).solve
    np.testing.assert_allclose(nearest(pencil, solve, -1.0, ways).values, np.arange(1.0, ways + 1.0))
    with pytest.raises(cf.errors.NumericsError, match=f"the mass moves {ways} ways, {ways + 1} modes were requested"):
        nearest(pencil, solve, -1.0, ways + 1)


def test_pairs_that_never_converge_end_the_search(monkeypatch):
    """A factor that answers noise."""
    monkeypatch.setattr(krylov, "RESTARTS", 2)
    pencil, rng = make_pencil(chain(300), np.ones(300)), np.random.default_rng(4)
    with pytest.raises(ConvergenceError, match=r"0 of 5 modes near shift 0\.25 converged in 2 restarts"):
        nearest(pencil, lambda b: rng.standard_normal(b.shape), 0.25, 5)


@pytest.mark.parametrize(("size", "count"), [(1, 1), (2, 1), (2, 2), (6, 2), (6, 6), (30, 26), (30, 30)])
def test_few_unknowns_show_as_many_modes_as_they_have(size, count):
    """Where fewer lie beyond those wanted than a gap takes, all are found."""
    K, mass = chain(size), np.linspace(1.0, 2.0, size)
    found = solve_modes(K, mass, count, shift=-1e-6)
    assert len(found.eigenvalues) == found.sturm_count >= count
    exact = eigh(K.toarray(), np.diag(mass), eigvals_only=True)
    np.testing.assert_allclose(found.eigenvalues, exact[: found.sturm_count], rtol=1e-10)


@pytest.mark.parametrize("count", [0, -3, 31, 500])
def test_refuses_a_count_there_is_not(count):
    with pytest.raises(cf.errors.NumericsError, match=f"count must lie between 1 and 30, found {count}"):
        solve_modes(chain(30), np.ones(30), count, shift=-1e-6)


def test_gap_after_goes_past_a_double():
    values = np.array([1.0, 2.0, 2.0 + 1e-12, 3.0, 4.0])
    assert gap_after(values, 1) == (1, 1.5)
    assert gap_after(values, 2) == (3, pytest.approx(2.5))
    assert gap_after(values, 3)[0] == 3


def test_no_gap_is_an_error():
    with pytest.raises(cf.errors.NumericsError, match="found no gap between eigenvalues 2 and 4"):
        gap_after(np.array([1.0, 2.0, 2.0, 2.0]), 2)
