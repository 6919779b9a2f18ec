"""Matrices of solid cells against the integrals that they stand for, written out for linear fields."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.cells.mapped import (
    cell_dofs,
    facet_shape_products,
    mapped,
    mapped_parts,
    on_free,
    put,
    scatter,
    shape_products,
    symmetric,
)
from casingfem.structure.imported.cells.solid import (
    cell_stiffness,
    consistent_mass,
    elasticity,
    stiffness,
    strain_table,
)
from casingfem.structure.imported.solid_spin import (
    batches,
    geometric,
    products,
    solid_inertia,
    solid_stiffening,
    tangent,
)
from tests.casingfem.structure.imported.parts import flat

RNG = np.random.default_rng(4)
CONSTANTS = np.array([[3.0, 11.0], [0.2, 0.35], [5.0, 7.0]])
SKEW = np.array([[2.0, 0.3, 0.0], [0.1, 3.0, 0.2], [0.0, -0.2, 5.0]])
BRICKS = cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u @ SKEW.T)
VOLUME = np.linalg.det(SKEW) / 2.0  # of each of the two
H = np.array([[0.1, -0.4, 0.2], [0.3, 0.7, -0.1], [0.5, 0.2, -0.6]])  # u = H x
PART = SimpleNamespace(mesh=BRICKS, constants=lambda: CONSTANTS)


def stress_of(strain, E, nu):
    """Hooke's law by the compliance: eps = ((1 + nu) sigma - nu tr sigma)/E, solved for sigma."""
    trace = np.trace(strain) * E / (1.0 - 2.0 * nu)
    return (E * strain + nu * trace * np.eye(3)) / (1.0 + nu)


def voigt(tensor):
    return np.array([tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[1, 2], tensor[0, 2], tensor[0, 1]])


def test_stress_is_hookes():
    strain = 0.5 * (H + H.T)
    engineering = voigt(strain) * [1, 1, 1, 2, 2, 2]
    for D, (E, nu, _) in zip(elasticity(CONSTANTS), CONSTANTS.T, strict=True):
        np.testing.assert_allclose(D @ engineering, voigt(stress_of(strain, E, nu)), rtol=1e-12)


def test_strains_of_a_linear_field_and_along_a_gradient():
    """sym grad v, and sym F^T grad v, shears doubled."""
    slopes, v = RNG.standard_normal((3, 4)), RNG.standard_normal((4, 3))
    gradient = (slopes @ v).T  # dv_k/dx_i
    for given, about in ((None, np.eye(3)), (H, H)):
        both = about.T @ gradient
        table = strain_table(slopes, given) @ v.ravel()
        np.testing.assert_allclose(table, voigt(both + both.T) * [0.5, 0.5, 0.5, 1, 1, 1], rtol=1e-12)


def test_stiffness_has_the_energy_of_a_uniform_strain():
    u = (BRICKS.points @ H.T)[BRICKS.cells].reshape(2, -1)
    matrices = cell_stiffness("hexahedron20", BRICKS.points, BRICKS.cells, CONSTANTS)
    strain = 0.5 * (H + H.T)
    energy = [VOLUME * np.sum(strain * stress_of(strain, E, nu)) for E, nu, _ in CONSTANTS.T]
    np.testing.assert_allclose(np.einsum("ei,eij,ej->e", u, matrices, u), energy, rtol=1e-11)
    on = mapped("hexahedron20", BRICKS.points, BRICKS.cells)
    np.testing.assert_array_equal(stiffness(on, CONSTANTS), matrices)


@pytest.mark.parametrize("block", [None, H])
def test_mass_has_the_integral_of_linear_velocities(block):
    """int rho v.B u with v = x e_i and u = y e_j over two skew bricks, by five Gauss points along each side."""
    on = mapped("hexahedron20", BRICKS.points, BRICKS.cells)
    matrices = consistent_mass(on, CONSTANTS[2], block)
    t, w = np.polynomial.legendre.leggauss(5)
    unit = np.stack(np.meshgrid(*[0.5 + 0.5 * t] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    weight = np.einsum("i,j,k->ijk", w, w, w).ravel() / 8.0 * VOLUME
    B = np.eye(3) if block is None else block
    x = BRICKS.points[BRICKS.cells]
    for e in range(2):
        at = (unit * [0.5, 1.0, 1.0] + [0.5 * e, 0.0, 0.0]) @ SKEW.T
        product = weight @ (at[:, 0] * at[:, 1]) * CONSTANTS[2, e]
        for i, j in ((0, 0), (0, 1), (2, 1)):
            v, u = np.zeros((2, 20, 3))
            v[:, i], u[:, j] = x[e, :, 0], x[e, :, 1]
            assert v.ravel() @ matrices[e] @ u.ravel() == pytest.approx(B[i, j] * product, rel=1e-11, abs=1e-12)


def test_stress_stiffens_by_the_slopes_of_a_motion():
    """sum over points of sigma_ij dv_k/dx_i dv_k/dx_j."""
    slopes, stress, v = RNG.standard_normal((1, 2, 3, 4)), RNG.standard_normal((1, 2, 6)), RNG.standard_normal((4, 3))
    energy = 0.0
    for N, s in zip(slopes[0], stress[0], strict=True):
        sigma = np.array([[s[0], s[5], s[4]], [s[5], s[1], s[3]], [s[4], s[3], s[2]]])
        energy += np.einsum("ij,ik,jk->", sigma, N @ v, N @ v)
    assert v.ravel() @ geometric(slopes, stress)[0] @ v.ravel() == pytest.approx(energy, rel=1e-12)
    left, right = RNG.standard_normal((2, 3, 2, 6, 5))
    expected = [sum(a[q].T @ b[q] for q in range(2)) for a, b in zip(left, right, strict=True)]
    np.testing.assert_allclose(products(left, right), expected, rtol=1e-11, atol=1e-12)


def test_batches_hold_slopes_gradients_and_weights():
    (batch,) = batches(PART, BRICKS.points @ H.T)
    np.testing.assert_allclose(batch.gradient, np.broadcast_to(H, batch.gradient.shape), atol=1e-12)
    np.testing.assert_allclose(batch.weight.sum(axis=(1, 2)), VOLUME, rtol=1e-12)
    x = BRICKS.points[batch.nodes]
    np.testing.assert_allclose(batch.slopes @ x[:, None], np.broadcast_to(np.eye(3), batch.gradient.shape), atol=1e-11)
    assert (batch.rows.tolist(), batch.slots.tolist()) == ([0, 1], list(range(20)))


def test_a_uniform_strain_stiffens_as_greens_strain_says():
    """Of u1 = H x and v = G x: sigma1 : G^T G + 2 e(v) : C : e2(u1, v), and e2 : C : e2, times the volume."""
    G = RNG.standard_normal((3, 3))
    added = solid_stiffening(PART, BRICKS.points @ H.T)
    v = (BRICKS.points @ G.T)[BRICKS.cells].reshape(2, -1)
    strain, linear, mixed = 0.5 * (H + H.T), 0.5 * (G + G.T), 0.5 * (H.T @ G + G.T @ H)
    bow = 0.5 * H.T @ H
    energies = {"first": [], "second": [], "strained": [], "bowed": []}
    for E, nu, _ in CONSTANTS.T:
        energies["first"].append(VOLUME * (np.sum(stress_of(strain, E, nu) * (G.T @ G))
                                           + 2.0 * np.sum(stress_of(mixed, E, nu) * linear)))  # fmt: skip
        energies["second"].append(VOLUME * np.sum(stress_of(mixed, E, nu) * mixed))
        energies["strained"].append(np.sum(stress_of(strain, E, nu) * strain))
        energies["bowed"].append(np.sum(stress_of(bow, E, nu) * bow))
    for name, matrices in (("first", added.first), ("second", added.second)):
        np.testing.assert_allclose(np.einsum("ei,eij,ej->e", v, matrices, v), energies[name], rtol=1e-10)
    assert added.ratio == pytest.approx(np.sqrt(sum(energies["bowed"]) / sum(energies["strained"])), rel=1e-10)
    still = solid_stiffening(PART, np.zeros_like(BRICKS.points))
    assert still.ratio == 0.0
    assert not still.first.any()


def test_inner_forces_of_a_large_uniform_strain():
    """S = C : (F^T F - 1)/2: the power of a motion G x is F S : G times the volume."""
    G = RNG.standard_normal((3, 3))
    moved = np.eye(3) + H
    green = 0.5 * (moved.T @ moved - np.eye(3))
    _, inner = tangent(PART, BRICKS.points @ H.T)
    power = sum(VOLUME * np.sum((moved @ stress_of(green, E, nu)) * G) for E, nu, _ in CONSTANTS.T)
    assert inner @ (BRICKS.points @ G.T).ravel() == pytest.approx(power, rel=1e-10)


def test_inertia_about_a_slanted_axis():
    """Of uniform velocities v and w: rho V v.P w and 2 rho V v.(a x w); the force is that of the middle's arm."""
    a = np.array([2.0, -1.0, 2.0]) / 3.0
    rotation = cf.Rotation(omega=7.0, axis=(2.0, -1.0, 2.0), centre=(0.3, 0.1, -0.2))
    of = solid_inertia(PART, rotation)
    v, w = np.array([0.3, 0.5, -0.7]), np.array([1.0, -2.0, 0.4])
    V, W = (np.tile(vector, 20) for vector in (v, w))
    mass = CONSTANTS[2] * VOLUME
    np.testing.assert_allclose(V @ of.softening @ W, mass * (v @ w - (v @ a) * (w @ a)), rtol=1e-11)
    np.testing.assert_allclose(V @ of.gyroscopic @ W, 2.0 * mass * (v @ np.cross(a, w)), rtol=1e-11)
    middle = np.array([BRICKS.points[cell].mean(axis=0) for cell in BRICKS.cells]) - rotation.centre
    np.testing.assert_allclose(of.force @ V, mass * ((middle - np.outer(middle @ a, a)) @ v), rtol=1e-11)


@pytest.mark.parametrize(
    ("kind", "sides", "size"), [("line", [3.0], 3.0), ("quad", [3.0, 2.0], 6.0), ("hexahedron", [3.0, 2.0, 5.0], 30.0)]
)
def test_cells_are_mapped_with_their_places_tangents_and_measure(kind, sides, size):
    from casingfem.structure.imported.mesh.cell_kind import KINDS

    places = KINDS[kind].places * sides
    points = np.zeros((len(places), 3))
    points[:, : len(sides)] = places
    on = mapped(kind, points, np.arange(len(places))[None])
    assert on.measure.sum() == pytest.approx(size, rel=1e-13)
    np.testing.assert_allclose(
        on.tangents[0],
        np.broadcast_to(np.diag(sides + [0] * (3 - len(sides)))[: len(sides)], on.tangents[0].shape),
        atol=1e-13,
    )
    np.testing.assert_allclose((on.x * on.measure[..., None]).sum(axis=1) / size, [points.mean(axis=0)], atol=1e-13)


def test_products_of_shape_functions_of_a_collapsed_square():
    """A triangle of six nodes of area 2 as a square: its corners' functions have no mean, its middles' a third."""
    x = flat(np.array([[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1.0]]))
    from casingfem.structure.imported.mesh.mesh_data import natives

    mesh = cf.imported.MeshData(kind="quad8", points=x, cells=np.array([[0, 1, 2, 2, 3, 4, 2, 5]]))
    whole, size = shape_products(mesh.points, mesh.cells, natives(mesh))
    assert size.tolist() == pytest.approx([2.0], rel=1e-13)
    rows = np.zeros(6)
    np.add.at(rows, mesh.cells[0], whole[0].sum(axis=1))
    np.testing.assert_allclose(rows, [0, 0, 0, 2 / 3, 2 / 3, 2 / 3], atol=1e-13)
    ((row, nodes, on),) = mapped_parts(mesh)
    assert (row.tolist(), nodes.tolist(), on.x.shape[0]) == ([0], [[2, 0, 1, 5, 3, 4]], 1)
    made, own, length = facet_shape_products(mesh, np.array([[0, 1]]))
    assert (own.tolist(), length.tolist()) == ([[1, 2, 4]], pytest.approx([2.0]))
    np.testing.assert_allclose(made[0], np.array([[4, -1, 2], [-1, 4, 2], [2, 2, 16]]) / 15.0, atol=1e-13)


def test_matrices_of_cells_are_summed_at_their_dofs():
    cells = np.array([[3, 0], [0, 2], [3, 0]])
    rows = cell_dofs(cells, 2)
    assert rows.tolist() == [[6, 7, 0, 1], [0, 1, 4, 5], [6, 7, 0, 1]]
    matrices = RNG.standard_normal((3, 4, 4))
    matrices[1, 0, 0] = -matrices[0, 2, 2] - matrices[2, 2, 2]
    expected = np.zeros((9, 9))
    for row, matrix in zip(rows, matrices, strict=True):
        expected[np.ix_(row, row)] += matrix
    np.testing.assert_allclose(scatter(matrices, rows, 9).toarray(), expected, atol=1e-14)
    assert scatter(matrices * 1j, rows, 9).dtype == complex


def test_free_dofs_of_a_matrix_are_exactly_symmetric_without_zeros():
    A = RNG.standard_normal((5, 5))
    A[1, 3] = A[3, 1] = 0.0
    A[1, 4], A[4, 1] = 2.0, -2.0
    found = on_free(csc_array(A), np.array([1, 3, 4]))
    expected = 0.5 * (A + A.T)[np.ix_([1, 3, 4], [1, 3, 4])]
    np.testing.assert_array_equal(found.toarray(), expected)
    assert found.nnz == np.count_nonzero(expected)
    assert symmetric(csc_array(A)).has_sorted_indices


def test_matrices_of_some_nodes_stand_at_their_places():
    total = np.zeros((3, 6, 6))
    own = RNG.standard_normal((2, 4, 4))
    put(total, np.array([2, 0]), np.array([2, 0]), own, 2)
    assert not total[1].any()
    np.testing.assert_array_equal(total[2][np.ix_([4, 5, 0, 1], [4, 5, 0, 1])], own[0])
    np.testing.assert_array_equal(total[0][np.ix_([4, 5, 0, 1], [4, 5, 0, 1])], own[1])
    assert not total[:, 2:4].any()
    whole = RNG.standard_normal((1, 6, 6))
    put(total, np.array([1]), np.array([0, 1, 2]), whole, 2)
    np.testing.assert_array_equal(total[1], whole[0])
