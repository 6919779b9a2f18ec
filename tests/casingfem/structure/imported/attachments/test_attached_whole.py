"""Matrices with all that hangs on a mesh against energies written out, and rigid motions that are left."""

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.geometry.rotation import rigid_motions
from casingfem.structure.imported.attachments.system import attached
from casingfem.structure.imported.attachments.ties import motions_of

X = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 3, 5], [7, 1, 1], [4, 4, 4.0]])
J = np.array([[0.3, 0.02, 0.01], [0.02, 0.4, 0.05], [0.01, 0.05, 0.5]])
NONE = np.zeros(0, dtype=np.int64)
RNG = np.random.default_rng(12)
TURN = cf.imported.Spring(terms=(cf.imported.Term(4, 5, 1.0),), stiffness=3.0)
SPIDER = (cf.imported.Rigid(reference=4, nodes=np.array([1, 2, 3])),)
ITEMS = {
    "rigids": (cf.imported.Rigid(reference=4, nodes=np.array([1])),),
    "springs": (
        cf.imported.Spring(terms=(cf.imported.Term(5, 0, 1.0), cf.imported.Term(2, 1, -2.0)), stiffness=9.0),
        cf.imported.Spring(terms=(cf.imported.Term(5, 1, 1.0),), stiffness=4.0),
        TURN,
        cf.imported.Spring(terms=(cf.imported.Term(6, 0, 1.0), cf.imported.Term(2, 0, -1.0)), stiffness=5.0),
        cf.imported.Spring(terms=(cf.imported.Term(6, 0, 1.0),), stiffness=2.0),
    ),
    "masses": (
        cf.imported.PointMass(node=4, mass=2.0, inertia=J, offset=(0.1, -0.2, 0.3)),
        cf.imported.PointMass(node=5, mass=7.0),
    ),
}


def positive(size):
    """A symmetric matrix with positive eigenvalues on the dofs of the tetrahedron, nothing on those behind."""
    A = RNG.standard_normal((12, 12))
    whole = np.zeros((size, size))
    whole[:12, :12] = A @ A.T + np.eye(12)
    return csc_array(whole)


def hung(held=(), still=(), supports=(), **items):
    """A tetrahedron of nodes 0 to 3 with 4, 5 and 6 beside it: what it becomes, and matrices of its cells."""
    mesh = cf.imported.MeshData(
        kind="tetra", points=X, cells=np.array([[0, 1, 2, 3]]), attachments=cf.imported.Attachments(**items)
    )
    motions, (K, M) = motions_of(mesh, 3), (positive(21) for _ in range(2))
    held, still = (np.array(part, dtype=np.int64) for part in (held, still))
    return attached(motions, K, M, held, still, rigid_motions(X), supports), motions, K, M


def test_energies_are_those_of_cells_springs_and_masses():
    """Node 0 held, 1 on an arm from 4, 6 without mass between two springs: its y and z, and turns of 5 and 6, idle."""
    found, motions, K, M = hung((0, 1, 2), **ITEMS)
    pivot = motions.turn(4)
    assert found.unknowns.tolist() == [*range(6, 19), pivot, pivot + 1, pivot + 2]
    q = RNG.standard_normal(len(found.unknowns))
    at = dict(zip(found.unknowns.tolist(), q.tolist(), strict=True))
    u, theta = (np.array([at[first + k] for k in range(3)]) for first in (12, pivot))
    field = np.array([at.get(dof, 0.0) for dof in range(21)])
    field[3:6] = u + np.cross(theta, X[1] - X[4])
    np.testing.assert_allclose(found.lift @ q, field, atol=1e-13)
    strained = 9.0 * (field[15] - 2.0 * field[7]) ** 2 + 4.0 * field[16] ** 2 + 3.0 * theta[2] ** 2
    strained += 5.0 * (field[18] - field[6]) ** 2 + 2.0 * field[18] ** 2
    assert q @ (found.K @ q) == pytest.approx(field @ (K @ field) + strained, rel=1e-12)
    moved = u + np.cross(theta, [0.1, -0.2, 0.3])
    moving = 2.0 * moved @ moved + theta @ J @ theta + 7.0 * field[15:18] @ field[15:18]
    assert q @ (found.M @ q) == pytest.approx(field @ (M @ field) + moving, rel=1e-12)
    assert found.rigid == 0
    idle = found.idle.toarray()
    assert idle.shape == (21, 8)
    assert np.flatnonzero(idle.any(axis=1)).tolist() == [19, 20]
    assert np.linalg.matrix_rank(idle) == 2


def test_what_is_connected_knows_all_motions_and_the_stiffness_on_them():
    found, motions, K, _ = hung((0, 1, 2), **ITEMS)
    on = found.connected
    assert on.whole.shape == (motions.size, len(found.unknowns))
    np.testing.assert_array_equal(on.whole[:21].toarray(), found.lift.toarray())
    np.testing.assert_array_equal(on.whole[found.unknowns].toarray(), np.eye(len(found.unknowns)))
    v = RNG.standard_normal(motions.size)
    strained = 9.0 * (v[15] - 2.0 * v[7]) ** 2 + 4.0 * v[16] ** 2 + 3.0 * v[motions.turn(4) + 2] ** 2
    strained += 5.0 * (v[18] - v[6]) ** 2 + 2.0 * v[18] ** 2
    assert v @ (on.K @ v) == pytest.approx(v[:21] @ (K @ v[:21]) + strained, rel=1e-12)
    assert sorted(on.rows.owner) == [3, 4, 5]


def test_turns_are_held_with_a_clamped_node_that_has_some():
    """Node 4 clamped; node 2 has no turns to hold."""
    found, motions, *_ = hung((6, 7, 8, 12, 13, 14), (2, 4), **ITEMS)
    assert found.unknowns.tolist() == [0, 1, 2, *range(9, 12), *range(15, 19)]
    free, *_ = hung((6, 7, 8, 12, 13, 14), (2,), **ITEMS)
    pivot = motions.turn(4)
    assert free.unknowns.tolist() == [*found.unknowns.tolist(), pivot, pivot + 1, pivot + 2]


def support(*dofs):
    return csc_array(np.diag(np.isin(np.arange(21), dofs) * 5.0))


def tilt(error):
    """A spring that feels two points on a line along y move along y, but for an error."""
    return cf.imported.Spring(terms=(cf.imported.Term(0, 1, 1.0), cf.imported.Term(2, 1, -1.0 + error)), stiffness=1.0)


@pytest.mark.parametrize(
    ("left", "held", "supports", "items"),
    [
        (6, (), (), {"rigids": SPIDER}),
        (
            6,
            (),
            (),
            {"means": (cf.imported.Mean(reference=5, nodes=np.arange(4), weights=np.array([1.0, 2.0, 4.0, 8.0])),)},
        ),
        (5, (), (), {"rigids": SPIDER, "springs": (TURN,)}),
        (5, (1,), (), {"rigids": SPIDER}),
        (3, (0, 1, 2), (), {"rigids": SPIDER}),
        (2, (0, 1, 2), (), {"rigids": SPIDER, "springs": (TURN,)}),
        (1, (0, 1, 2), (support(9, 10),), {"rigids": SPIDER}),
        (4, (), (support(3), support(10)), {"rigids": SPIDER}),
        (
            6,
            (),
            (),
            {"equations": (cf.imported.Equation(terms=(cf.imported.Term(0, 0, 1.0), cf.imported.Term(1, 0, -1.0))),)},
        ),
        (
            5,
            (),
            (),
            {"equations": (cf.imported.Equation(terms=(cf.imported.Term(0, 1, 1.0), cf.imported.Term(1, 1, -1.0))),)},
        ),
        (
            5,
            (),
            (),
            {"equations": (cf.imported.Equation(terms=(cf.imported.Term(0, 2, 2.0), cf.imported.Term(1, 2, -3.0))),)},
        ),
        (6, (), (), {"springs": (tilt(0.9e-9),)}),
        (5, (), (), {"springs": (tilt(1.1e-9),)}),
        (6, (), (), {"springs": (tilt(-0.9e-9),)}),
        (5, (), (), {"springs": (tilt(-1.1e-9),)}),
    ],
)
def test_rigid_motions_that_nothing_feels_are_counted(left, held, supports, items):
    """A node held leaves the turns about it, of which a spring on one and supports of another point feel some."""
    assert hung(held, supports=supports, **items)[0].rigid == left
