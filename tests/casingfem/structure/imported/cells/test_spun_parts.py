"""What rotation adds to parts as wholes: sums over cells, ties, the steady state on the deformed shape."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.solid_spin import solid_spin, steady_stiffness, tangent
from casingfem.structure.imported.spin import LARGE, Inertia, MeshSpin, MeshTurning, Stiffening, mesh_spin, spun
from tests.casingfem.structure.imported.parts import STEEL, supported

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
BAR = cf.imported.grid_mesh(
    "hexahedron", (2, 1, 1), lambda u: u * [0.2, 0.05, 0.04], groups={"root": (0, 0.0), "tip": (0, 1.0)}
)
AXIS, CENTRE = np.array([2.0, -1.0, 2.0]) / 3.0, np.array([-0.05, 0.01, 0.02])
ROTATION = cf.Rotation(omega=1.0, axis=(2.0, -1.0, 2.0), centre=tuple(CENTRE))
P = np.eye(3) - np.outer(AXIS, AXIS)
NOTHING = csc_array((2, 2))


def summed(matrices):
    """Cells' matrices (2, 24, 24) on the dofs of all nodes."""
    total = np.zeros((36, 36))
    for cell, matrix in zip(BAR.cells, matrices, strict=True):
        rows = (3 * cell[:, None] + np.arange(3)).ravel()
        total[np.ix_(rows, rows)] += matrix
    return total


@pytest.mark.parametrize("tied", [False, True])
def test_what_cells_add_is_summed_on_the_free_dofs(tied):
    """Of any matrices of cells: u1 = K^-1 f among those that are admitted, first - softening, second, Coriolis."""
    rng = np.random.default_rng(3)
    system = supported(BAR).assembled()
    T = rng.standard_normal((24, 9))
    system = replace(system, tie=csc_array(T)) if tied else system
    softening, gyroscopic, first, second = rng.standard_normal((4, 2, 24, 24))
    pull, seen = rng.standard_normal((2, 24)), []

    def stiffening(fields):
        seen.append(fields)
        return Stiffening(first, second, 0.07)

    inertia = Inertia(softening, gyroscopic, pull)
    found = mesh_spin(MeshTurning(system=system, rotation=ROTATION, inertia=inertia, stiffening=stiffening))
    pulled = np.zeros((12, 3))
    np.add.at(pulled, BAR.cells, pull.reshape(2, 8, 3))
    force, K = pulled.ravel()[system.free], system.K.toarray()
    u = T @ np.linalg.solve(T.T @ K @ T, T.T @ force) if tied else np.linalg.solve(K, force)
    np.testing.assert_allclose(found.fields, system.expand(u[:, None])[:, :, 0], rtol=1e-6, atol=1e-9 * np.abs(u).max())
    assert seen[0] is found.fields
    own = np.ix_(system.free, system.free)
    for matrix, expected in ((found.K1, summed(first - softening)), (found.K2, summed(second))):
        np.testing.assert_allclose(matrix.toarray(), 0.5 * (expected + expected.T)[own], atol=1e-12)
    np.testing.assert_allclose(found.G.toarray(), summed(gyroscopic)[own], atol=1e-12)
    assert (found.nonlinear, found.steady) == (0.07, None)
    faster = spun(system, found, 2.0)
    np.testing.assert_allclose(faster.K.toarray(), K + 4.0 * found.K1.toarray() + 16.0 * found.K2.toarray(), rtol=1e-12)


@pytest.mark.parametrize(("nonlinear", "iterated"), [(0.25 * LARGE, False), (0.2500001 * LARGE, True)])
def test_the_steady_state_is_sought_from_a_hundredth_on(nonlinear, iterated):
    """At 2 rad/s: quadratic strains 4 times those at 1 rad/s."""
    one, two = csc_array(np.diag([1.0, 2.0])), csc_array(np.diag([3.0, 5.0]))
    asked = []
    added = MeshSpin(one, two, NOTHING, np.zeros((1, 3)), nonlinear, lambda omega: asked.append(omega) or NOTHING)
    found = added.stiffness(2.0).toarray()
    assert asked == [2.0] * iterated
    np.testing.assert_array_equal(found, np.diag([52.0, 88.0]) * (not iterated))
    linear = replace(added, steady=None).stiffness(2.0).toarray()
    np.testing.assert_array_equal(linear, np.diag([52.0, 88.0]))


@pytest.mark.slow
def test_the_tangent_of_the_steady_state_on_springs_and_a_clamp():
    """Inner forces, springs and Omega^2 M P (x + u - c) in balance, sought by steps with the stiffness at rest."""
    part = supported(BAR, rotation=ROTATION)
    part = replace(part, supports={**part.supports, "tip": cf.ElasticEdge(k_face=5e11)})
    system, whole = part.assembled(), cf.Solid(mesh=BAR, material=STEEL).assembled()
    own, omega = np.ix_(system.free, system.free), 4000.0
    springs = system.K.toarray() - whole.K.toarray()[own]
    u, q, at_rest = np.zeros((12, 3)), np.zeros(24), np.linalg.inv(system.K.toarray())
    for _ in range(60):
        pull = omega**2 * (whole.M @ ((BAR.points + u - CENTRE) @ P).ravel())
        step = at_rest @ ((pull - tangent(part, u)[1])[system.free] - springs @ q)
        q = q + step
        u = system.expand(q[:, None])[:, :, 0]
        if np.abs(step).max() < 1e-13:
            break
    assert np.abs(step).max() < 1e-12
    assert np.abs(u).max() > 1e-3
    softening = omega**2 * np.kron(whole.M.toarray()[::3, ::3], P)
    expected = (tangent(part, u)[0].toarray() - softening - whole.K.toarray())[own]
    added = solid_spin(system, part, ROTATION)
    for found in (
        steady_stiffness(system, part, ROTATION.at(omega), np.zeros((12, 3))),
        added.stiffness(omega),
    ):
        np.testing.assert_allclose(found.toarray(), expected, rtol=1e-6, atol=1e-7 * np.abs(expected).max())
    assert omega**2 * added.nonlinear > LARGE
