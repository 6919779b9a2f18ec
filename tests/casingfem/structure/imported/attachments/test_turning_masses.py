"""What rotation adds through a mass on an arm and through connections: energies written out."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.attachments.ties import motions_of, tied_rows
from casingfem.structure.imported.attachments.turning import arm_stiffness, attached_spin, carried, points_of, summed

X = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 3, 5], [7, 1, 1], [4, 4, 4.0]])
J = np.array([[0.3, 0.02, 0.01], [0.02, 0.4, 0.05], [0.01, 0.05, 0.5]])
A = np.array([2.0, -1.0, 2.0]) / 3.0
ROTATION = cf.Rotation(omega=7.0, axis=(2.0, -1.0, 2.0), centre=(0.3, 0.1, -0.2))
U, THETA = np.array([0.5, -1.0, 2.0]), np.array([0.3, 0.7, -0.4])
V, PHI = np.array([1.5, 0.2, -0.3]), np.array([-0.6, 0.1, 0.8])
NONE = np.zeros(0, dtype=np.int64)


def motions(**items):
    mesh = cf.imported.MeshData(
        kind="tetra", points=X, cells=np.array([[0, 1, 2, 3]]), attachments=cf.imported.Attachments(**items)
    )
    return motions_of(mesh, 3)


def across(vector):
    return vector - (vector @ A) * A


@pytest.mark.parametrize(
    "mass",
    [
        cf.imported.PointMass(node=4, mass=7.0, inertia=J, offset=(0.1, -0.2, 0.3)),
        cf.imported.PointMass(node=4, mass=7.0, inertia=J),
        cf.imported.PointMass(node=4, mass=7.0, offset=(0.1, -0.2, 0.3)),
        cf.imported.PointMass(node=4, mass=7.0),
    ],
)
def test_a_mass_adds_what_its_points_do(mass):
    """Two motions (u, theta) of the node; the points of the mass stand at x + r."""
    at = motions(masses=(mass,))
    found = attached_spin(at, ROTATION)
    one, other = np.zeros((2, at.size))
    one[12:15], one[21:24], other[12:15], other[21:24] = U, THETA, V, PHI
    points = points_of(mass)
    if not mass.turns:
        assert len(points) == 1
    moved = [(m, r, U + np.cross(THETA, r), V + np.cross(PHI, r)) for m, r in points]
    turns = mass.turns
    if not turns:
        moved = [(m, r, U, V) for m, r in points]
    assert one @ found.mass @ other == pytest.approx(sum(m * (p @ q) for m, _, p, q in moved), rel=1e-11)
    expected = sum(m * (across(p) @ across(q)) for m, _, p, q in moved)
    assert one @ found.softening @ other == pytest.approx(expected, rel=1e-11)
    expected = sum(2.0 * m * (p @ np.cross(A, q)) for m, _, p, q in moved)
    assert one @ found.gyroscopic @ other == pytest.approx(expected, rel=1e-10)
    forces = [m * across(X[4] + r - ROTATION.centre) for m, r, _, _ in moved]
    work = sum(F @ p for F, (_, _, p, _) in zip(forces, moved, strict=True))
    assert found.force @ one == pytest.approx(work, rel=1e-11)
    bent = sum(-(F @ np.cross(THETA, np.cross(THETA, r))) for F, (_, r, _, _) in zip(forces, moved, strict=True))
    assert one @ found.stiffness @ one == pytest.approx(bent if turns else 0.0, rel=1e-10, abs=1e-12)


def test_masses_on_two_nodes_add_up():
    one, other = cf.imported.PointMass(node=4, mass=7.0), cf.imported.PointMass(node=1, mass=3.0)
    both = attached_spin(motions(masses=(one, other)), ROTATION)
    assert both.mass.diagonal()[[3, 4, 5, 12, 13, 14]].tolist() == [3.0, 3.0, 3.0, 7.0, 7.0, 7.0]
    np.testing.assert_allclose(both.force[3:6], 3.0 * across(X[1] - ROTATION.centre), rtol=1e-12)


def test_a_force_on_an_arm_stiffens_its_turns():
    force, r = np.array([3.0, -1.0, 2.0]), np.array([0.5, 0.7, -0.2])
    S = arm_stiffness(force, r)
    assert THETA @ S @ THETA == pytest.approx(-force @ np.cross(THETA, np.cross(THETA, r)), rel=1e-12)
    np.testing.assert_array_equal(S, S.T)


def test_rigid_connections_carry_the_forces_of_what_follows_them():
    """Node 6 follows 5, which follows 4: the arm from 4 to 5 carries the forces on both."""
    at = motions(
        rigids=(
            cf.imported.Rigid(reference=4, nodes=np.array([5, 1])),
            cf.imported.Rigid(reference=5, nodes=np.array([6])),
        )
    )
    residual = np.random.default_rng(3).standard_normal(at.size)
    found = carried(at, tied_rows(at, NONE), residual).toarray()
    on = residual[:21].reshape(7, 3)
    expected = np.zeros((at.size, at.size))
    first, other = at.turn(4), at.turn(5)
    expected[first : first + 3, first : first + 3] = (
        arm_stiffness(on[5] + on[6], X[5] - X[4]) + arm_stiffness(on[1], X[1] - X[4])
    )  # fmt: skip
    expected[other : other + 3, other : other + 3] = arm_stiffness(on[6], X[6] - X[5])
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_connection_carries_forces_along_its_components_alone():
    at = motions(rigids=(cf.imported.Rigid(reference=4, nodes=np.array([5]), components=(0, 2)),))
    residual = np.arange(1.0, at.size + 1.0)
    first = at.turn(4)
    found = carried(at, tied_rows(at, NONE), residual).toarray()[first : first + 3, first : first + 3]
    np.testing.assert_allclose(found, arm_stiffness(np.array([16.0, 0.0, 18.0]), X[5] - X[4]), rtol=1e-12)


def test_a_mean_spreads_its_force_over_its_nodes():
    """Its nodes have parts of the force with its moment; the mean turn carries less the sum of them on their arms."""
    mean = cf.imported.Mean(reference=6, nodes=np.array([0, 1, 2, 3]), weights=np.array([1.0, 2.0, 3.0, 4.0]))
    at = motions(means=(mean,))
    residual = np.zeros(at.size)
    force, moment = np.array([3.0, -1.0, 2.0]), np.array([0.5, 0.2, 0.7])
    residual[18:21], residual[at.turn(6) : at.turn(6) + 3] = force, moment
    rows = tied_rows(at, NONE)
    found = carried(at, rows, residual).toarray()
    table = np.zeros((at.size, at.size))
    for to, of, value in rows.entries:
        table[to, of] = value
    push = (table.T @ residual)[:12].reshape(4, 3)
    np.testing.assert_allclose(push.sum(axis=0), force, rtol=1e-12)
    np.testing.assert_allclose(np.cross(X[:4] - X[6], push).sum(axis=0), moment, rtol=1e-11)
    stiff = -sum(arm_stiffness(push[k], X[k] - X[6]) for k in range(4))
    turns = table[at.turn(6) : at.turn(6) + 3]
    np.testing.assert_allclose(found, turns.T @ stiff @ turns, atol=1e-11)


def test_matrices_on_combinations_of_motions_are_summed():
    rows = [{0: 2.0, 2: -1.0}, {1: 3.0}]
    matrix = np.array([[5.0, 1.0], [1.0, 4.0]])
    table = np.array([[2.0, 0.0, -1.0], [0.0, 3.0, 0.0]])
    found = summed([(rows, matrix), ([{2: 1.0}], np.array([[7.0]]))], 3).toarray()
    np.testing.assert_allclose(found, table.T @ matrix @ table + np.diag([0.0, 0.0, 7.0]), rtol=1e-14)
