"""LOBPCG with multigrid: equal to shift-invert on thick solids, free ones too; never a result where it fails."""

import numpy as np
import pytest
from scipy.sparse import csc_array, eye_array

import casingfem as cf
from casingfem.linalg import factor, multigrid
from casingfem.linalg.eigen import solve_modes
from casingfem.linalg.factor import factorise
from casingfem.linalg.krylov import ConvergenceError
from casingfem.linalg.memory import MemoryNeedError
from casingfem.linalg.multigrid import multigrid_modes
from casingfem.linalg.pencil import make_pencil
from casingfem.structure.geometry.rotation import rigid_motions
from casingfem.structure.imported.solid import assemble_solid


def solid(steel, counts, size, *, free=False):
    mesh = cf.imported.grid_mesh("hexahedron20", counts, lambda u: u * np.array(size), groups={"root": (0, 0.0)})
    return cf.Solid(mesh=mesh, material=steel, supports={} if free else {"root": cf.Clamped()})


def block(*args, **options):
    system = assemble_solid(solid(*args, **options))
    return system, rigid_motions(system.points)[system.free], -((0.5 * system.frequency_scale) ** 2)


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.slow
def test_a_thick_block_equals_shift_invert(steel, free, monkeypatch):
    monkeypatch.setattr(multigrid, "COARSEST", 20)
    thick = solid(steel, (4, 4, 3), (1.0, 0.8, 0.6), free=free)
    a, b = (cf.modal.mesh_modes(thick, 9, multigrid=cycles) for cycles in (True, False))
    np.testing.assert_allclose(a.freq**2, b.freq**2, rtol=1e-8, atol=1e-8 * b.freq[-1] ** 2)
    assert a.sturm_count == b.sturm_count
    system = assemble_solid(thick)
    vectors = a.fields.reshape(-1, 9)[system.free]
    np.testing.assert_allclose(vectors.T @ (system.M @ vectors), np.eye(9), atol=1e-8)


@pytest.mark.slow
def test_static_shapes_equal_those_of_a_factor(steel, monkeypatch):
    monkeypatch.setattr(multigrid, "COARSEST", 20)
    system, near_null, _ = block(steel, (4, 4, 3), (1.0, 0.8, 0.6))
    loads = np.eye(system.size)[:, [10, 200, 301]] * [1.0, 1e6, 0.0]  # one of them none at all
    exact = factorise(system.K).solve(loads)
    found = multigrid.static_by_cycles(system.K, near_null, loads)
    assert np.all(np.abs(found - exact).max(axis=0) <= 1e-8 * np.abs(exact).max(axis=0))
    monkeypatch.setattr(multigrid, "ITERATIONS", 2)
    with pytest.raises(ConvergenceError, match="of a load remains unbalanced after 2 cycles"):
        multigrid.static_by_cycles(system.K, near_null, loads)


def test_matrices_beyond_their_first_eigenvalue_are_refused(steel):
    system, near_null, shift = block(steel, (2, 1, 1), (1.0, 0.8, 0.6))
    load, one = np.eye(system.size)[:, [3]], eye_array(system.size)
    lowest = np.linalg.eigvalsh(system.K.toarray())[0]
    held, loose = (csc_array(system.K - part * lowest * one) for part in (0.99, 1.01))
    np.testing.assert_allclose(held @ multigrid.static_by_cycles(held, near_null, load), load, atol=1e-9)
    with pytest.raises(ConvergenceError, match="the coarsest matrix is not positive definite"):
        multigrid.static_by_cycles(loose, near_null, load)
    pencil, first = make_pencil(system.K, system.M), solve_modes(system.K, system.M, 1, shift).eigenvalues[0]
    multigrid.make_levels(pencil, near_null, 0.99 * first)
    with pytest.raises(ConvergenceError, match="the coarsest matrix is not positive definite"):
        multigrid.make_levels(pencil, near_null, 1.01 * first)


def test_an_iteration_beside_known_modes_finds_the_next_and_refuses_the_same_twice(steel):
    system, near_null, shift = block(steel, (2, 1, 1), (1.0, 0.8, 0.6))
    exact = solve_modes(system.K, system.M, 4, shift)
    pencil = make_pencil(system.K, system.M)
    levels = multigrid.make_levels(pencil, near_null, shift)
    _, known, _ = multigrid.iterate(pencil, levels, 4, shift)
    values, _, _ = multigrid.iterate(pencil, levels, 2, shift, beside=known[:, :2])
    np.testing.assert_allclose(values, exact.eigenvalues[2:4], rtol=1e-9)
    with pytest.raises(ConvergenceError, match="the iteration broke down: Linearly dependent"):
        multigrid.iterate(pencil, levels, 2, shift, beside=known[:, [0, 0]])


@pytest.mark.slow
def test_a_thick_solid_is_reduced_where_its_factor_does_not_fit(steel, monkeypatch):
    """The same compliance as with a factor; a thin one is refused as before."""
    part = block(steel, (4, 4, 3), (1.0, 0.8, 0.6))[0].structure
    corner = cf.modal.AtNodes((int(part.mesh.node_numbers[-1]),))
    exact = cf.reduce(part, corner, modes=4)
    monkeypatch.setattr(factor, "free_memory", lambda: 0.0)
    found = cf.reduce(part, corner, modes=4)
    np.testing.assert_allclose(found.compliance, exact.compliance, rtol=1e-6)
    thin = block(steel, (4, 4, 1), (1.0, 0.8, 0.004))[0].structure
    with pytest.raises(MemoryNeedError, match="modes-memory"):
        cf.reduce(thin, cf.modal.AtNodes((int(thin.mesh.node_numbers[-1]),)), modes=4)


@pytest.mark.slow
def test_what_does_not_converge_is_reported_and_solved_by_shift_invert(steel, monkeypatch):
    monkeypatch.setattr(multigrid.iterate, "__defaults__", (2, None, None))
    thin = solid(steel, (8, 6, 1), (1.0, 0.8, 0.004))
    with pytest.warns(cf.errors.ModelWarning, match=r"modes converged, the largest residual.*modes-lobpcg"):
        found = cf.modal.mesh_modes(thin, 6, multigrid=True)
    np.testing.assert_array_equal(found.freq, cf.modal.mesh_modes(thin, 6).freq)


@pytest.mark.slow
def test_a_mode_that_it_misses_shows_in_the_count(steel, monkeypatch):
    def losing(*arguments):
        values, vectors, products = iterate(*arguments)
        return np.delete(values, 1), np.delete(vectors, 1, axis=1), products

    iterate = multigrid.iterate
    monkeypatch.setattr(multigrid, "iterate", losing)
    system, near_null, shift = block(steel, (3, 3, 2), (1.0, 0.8, 0.6))
    with pytest.warns(cf.errors.ModelWarning, match="4 of 5 modes found"):
        found = multigrid_modes(system.K, system.M, near_null, 4, shift)
    assert found.sturm_count == len(found.eigenvalues) == 4


@pytest.mark.slow
def test_a_mode_that_it_misses_shows_in_a_search_where_nothing_is_counted(steel, monkeypatch):
    def losing(*arguments, **options):
        values, vectors, products = iterate(*arguments, **options)
        return (values, vectors, products) if options else (np.delete(values, 1), np.delete(vectors, 1, 1), products)

    system, near_null, shift = block(steel, (3, 3, 2), (1.0, 0.8, 0.6))
    exact = solve_modes(system.K, system.M, 4, shift)
    found = multigrid_modes(system.K, system.M, near_null, 4, shift, counted=False)
    np.testing.assert_allclose(found.eigenvalues, exact.eigenvalues, rtol=1e-8)
    assert found.sturm_count is None
    iterate = multigrid.iterate
    monkeypatch.setattr(multigrid, "iterate", losing)
    with pytest.warns(cf.errors.ModelWarning, match="1 modes missed at first"):
        again = multigrid_modes(system.K, system.M, near_null, 4, shift, counted=False)
    np.testing.assert_array_equal(again.eigenvalues, exact.eigenvalues)


@pytest.mark.slow
@pytest.mark.parametrize("free", [False, True])
def test_a_cycle_is_symmetric_positive_definite_and_near_the_inverse(steel, free, monkeypatch):
    """C = C^T and the eigenvalues of C A: between 0 and about 1, the smaller ones not small, rigid motions included."""
    monkeypatch.setattr(multigrid, "COARSEST", 20)
    system, near_null, shift = block(steel, (4, 3, 3), (1.0, 0.8, 0.6), free=free)
    pencil = make_pencil(system.K, system.M)
    levels = multigrid.make_levels(pencil, near_null, shift)
    assert len(levels.levels) >= 1
    C = levels.cycle(np.eye(system.size))
    np.testing.assert_allclose(C, C.T, atol=1e-10 * np.abs(C).max())
    np.testing.assert_allclose(levels.operator @ np.eye(system.size)[3], C[3], atol=1e-10 * np.abs(C).max())
    L = np.linalg.cholesky(pencil.shifted(shift).toarray())
    damped = np.linalg.eigvalsh(L.T @ C @ L)
    assert damped[0] > 0.05
    assert damped[-1] < 1.1
    assert levels.bytes > 12 * system.K.nnz
