"""Motions of what hangs on a mesh: rows of springs, ties and connections, worked out by hand."""

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.attachments.system import (
    enlarged,
    mass_matrix,
    sorted_parts,
    spring_rows,
    without_mass,
)
from casingfem.structure.imported.attachments.ties import Rows, eliminated, fitted, motions_of, tied_rows
from casingfem.structure.imported.mesh.joints import joints_of
from casingfem.structure.imported.mesh.walls import walls_apart

X = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 3, 5], [7, 1, 1], [4, 4, 4.0]])
NUMBERS = np.arange(11, 18)
NONE = np.zeros(0, dtype=np.int64)
RNG = np.random.default_rng(2)


def motions(**items):
    """A tetrahedron of nodes 0 to 3 with 4, 5 and 6 beside it."""
    mesh = cf.imported.MeshData(
        kind="tetra",
        points=X,
        cells=np.array([[0, 1, 2, 3]]),
        node_numbers=NUMBERS,
        source="part.bdf",
        attachments=cf.imported.Attachments(**items),
    )
    return motions_of(mesh, 3)


def shell(**items):
    """A square of nodes 0 to 3 with its normal along (1, 2, 2)/3, and node 4 beside it."""
    n = np.array([1.0, 2.0, 2.0]) / 3.0
    e = np.array([[2.0, 1.0, -2.0], [-2.0, 2.0, -1.0]]) / 3.0
    x = np.array([np.zeros(3), e[0], e[0] + e[1], e[1], [1.0, 2.0, 3.0]])
    mesh = cf.imported.MeshData(
        kind="quad",
        points=x,
        cells=np.array([[0, 1, 2, 3]]),
        source="skin",
        attachments=cf.imported.Attachments(**items),
    )
    return motions_of(mesh, 5, joints_of(walls_apart(mesh), np.tile(n, (5, 1)), np.tile(e, (5, 1, 1))))


def rigid_motion(at, u, theta):
    """Displacements of all nodes, then the turns of nodes that have their own, of a rigid motion."""
    moved = u + np.cross(theta, at.mesh.points)
    if at.joints is not None:
        turned = np.einsum("nac,nc->na", at.joints.frames, np.cross(theta, at.joints.normals))
        moved = np.hstack([moved, turned])
    return np.concatenate([moved.ravel(), *[theta] * len(at.turning)])


def test_nodes_of_no_cell_and_references_have_turns_behind_the_dofs_of_nodes():
    spring = cf.imported.Spring(terms=(cf.imported.Term(4, 0, 1.0), cf.imported.Term(6, 0, -1.0)), stiffness=1.0)
    at = motions(springs=(spring,), rigids=(cf.imported.Rigid(reference=1, nodes=np.array([2, 3])),))
    assert at.turning.tolist() == [1, 4, 6]
    assert at.size == 3 * 7 + 3 * 3
    assert [at.turn(node) for node in range(7)] == [-1, 21, -1, -1, 24, -1, 27]
    assert [at.place(dof) for dof in (0, 20, 21, 23, 28)] == [(0, 0), (6, 2), (1, 3), (1, 5), (6, 4)]
    assert at.row(5, 2, "") == {17: 1.0}
    assert at.row(4, 5, "") == {26: 1.0}
    with pytest.raises(
        cf.errors.ModelError, match=r"part\.bdf: CELAS2 7: node 13: found the turn about y, and nodes of solids"
    ):
        at.row(2, 4, "CELAS2 7")


def test_turns_of_a_shells_node_are_those_of_its_director():
    """theta of w_1 = 1 is n x e_1 = e_2, of w_2 = 1 is n x e_2 = -e_1."""
    at = shell()
    e = at.joints.frames[0]
    for c in range(3):
        assert at.row(2, 3 + c, "") == pytest.approx({13: e[1, c], 14: -e[0, c]}, rel=1e-14)
    assert at.row(2, 2, "") == {12: 1.0}
    assert at.place(14) == (2, 4)
    assert at.combined(
        [cf.imported.Term(0, 0, 2.0), cf.imported.Term(0, 0, -2.0), cf.imported.Term(1, 1, 3.0)], ""
    ) == {6: 3.0}


def test_springs_feel_their_terms():
    at = motions(
        springs=(
            cf.imported.Spring(
                terms=(cf.imported.Term(0, 1, 2.0), cf.imported.Term(0, 1, 0.5), cf.imported.Term(4, 3, -1.0)),
                stiffness=9.0,
            ),
            cf.imported.Spring(terms=(cf.imported.Term(3, 2, 1.0),), stiffness=9.0),
        )
    )
    expected = np.zeros((2, at.size))
    expected[0, [1, 21]], expected[1, 11] = [2.5, -1.0], 1.0
    np.testing.assert_array_equal(spring_rows(at).toarray(), expected)
    assert spring_rows(motions()).shape == (0, 21)


def test_masses_stand_on_the_dofs_of_their_nodes():
    heavy = cf.imported.PointMass(node=4, mass=2.0, inertia=np.diag([3.0, 4.0, 5.0]), offset=(0.1, 0.2, 0.3))
    at = motions(masses=(cf.imported.PointMass(node=2, mass=7.0), heavy))
    expected = np.zeros((at.size, at.size))
    expected[6:9, 6:9] = 7.0 * np.eye(3)
    six = [12, 13, 14, 21, 22, 23]
    expected[np.ix_(six, six)] = heavy.matrix
    np.testing.assert_allclose(mass_matrix(at).toarray(), expected, rtol=1e-14)


@pytest.mark.parametrize("kind", ["rigid", "mean", "shell", "tie"])
def test_every_dof_of_a_rigid_motion_is_what_its_connections_make_of_it(kind):
    """Of any rigid motion what follows others is where they carry it."""
    at = {
        "rigid": lambda: motions(
            rigids=(
                cf.imported.Rigid(reference=4, nodes=np.array([1, 5])),
                cf.imported.Rigid(reference=5, nodes=np.array([6])),
            )
        ),
        "mean": lambda: motions(
            means=(cf.imported.Mean(reference=5, nodes=np.arange(4), weights=np.array([1.0, 2.0, 4.0, 8.0])),)
        ),
        "shell": lambda: shell(rigids=(cf.imported.Rigid(reference=0, nodes=np.array([1, 2, 4])),)),
        "tie": lambda: shell(
            glued=(
                cf.imported.Tie(
                    nodes=np.array([3]), others=np.array([[0, 1, 2]]), weights=np.array([[1.0, -1.0, 1.0]])
                ),
            )
        ),
    }[kind]()
    rows = tied_rows(at, NONE)
    R = eliminated(rows)
    motion = rigid_motion(at, np.array([0.3, -0.5, 0.8]), np.array([0.7, 0.2, -0.4]))
    assert len(rows.owner) > 2
    np.testing.assert_allclose(R @ motion, motion, atol=1e-12)
    assert not set(R.indices) & set(rows.owner)


def test_components_that_are_not_named_stay_free():
    at = motions(
        rigids=(cf.imported.Rigid(reference=4, nodes=np.array([5, 1]), components=(0, 2, 4), where="RBE2 3"),),
        means=(cf.imported.Mean(reference=6, nodes=np.arange(4), weights=np.ones(4), components=(1, 5)),),
    )
    rows = tied_rows(at, NONE)
    turn5, turn6 = at.turn(5), at.turn(6)
    assert sorted(rows.owner) == sorted([3, 5, 15, 17, turn5 + 1, 19, turn6 + 2])
    along_z = {dof: value for to, dof, value in rows.entries if to == 17}
    assert along_z == {14: 1.0, 21: -2.0, 22: -5.0}  # of theta x (5, -2, -4)


def test_a_mean_fits_its_nodes_by_weighted_least_squares():
    """Of displacements that are no rigid motion: minimise sum w |u_j - u - theta x (x_j - x)|^2 over (u, theta)."""
    w = np.array([1.0, 2.0, 4.0, 8.0, 3.0])
    nodes = np.array([0, 1, 2, 3, 4])
    at = motions(means=(cf.imported.Mean(reference=6, nodes=nodes, weights=w),))
    u = RNG.standard_normal((5, 3))
    A, b = [], []
    for k, node in enumerate(nodes):
        arm = X[node] - X[6]
        A.append(np.sqrt(w[k]) * np.hstack([np.eye(3), np.cross(np.eye(3), arm).T]))
        b.append(np.sqrt(w[k]) * u[k])
    best = np.linalg.lstsq(np.vstack(A), np.concatenate(b), rcond=None)[0]
    found = np.einsum("sjc,jc->s", fitted(at, at.mesh.attachments.means[0]), u)
    np.testing.assert_allclose(found, best, rtol=1e-10)


@pytest.mark.parametrize(("off", "taken"), [(1e-4, True), (1e-6, False)])
def test_nodes_of_a_mean_span_a_triangle(off, taken):
    x = np.array([[0, 0, 0], [1, 0, 0], [2, off, 0], [0, 0, 1], [0, 0, 0]])
    mean = cf.imported.Mean(reference=4, nodes=np.arange(3), weights=np.ones(3), where="RBE3 9")
    mesh = cf.imported.MeshData(
        kind="tetra", points=x, cells=np.array([[0, 1, 2, 3]]), attachments=cf.imported.Attachments(means=(mean,))
    )
    at = motions_of(mesh, 3)
    if taken:
        assert fitted(at, mean).shape == (6, 3, 3)
    else:
        with pytest.raises(
            cf.errors.ModelError, match="RBE3 9: node 5: found 3 nodes in a line, expected three that span"
        ):
            fitted(at, mean)


def test_an_equation_is_solved_for_its_first_term():
    """2 u_0x - 3 u_1y + 8 u_4z = 0."""
    equation = cf.imported.Equation(
        terms=(cf.imported.Term(0, 0, 2.0), cf.imported.Term(1, 1, -3.0), cf.imported.Term(4, 2, 8.0))
    )
    rows = tied_rows(motions(equations=(equation,)), NONE)
    assert rows.entries == [(0, 4, 1.5), (0, 14, -4.0)]
    assert rows.owner == {0: "equation"}


def test_what_is_tied_twice_or_in_a_ring_is_refused():
    one = cf.imported.Equation(terms=(cf.imported.Term(0, 0, 1.0), cf.imported.Term(1, 0, -1.0)), where="MPC 1")
    other = cf.imported.Equation(terms=(cf.imported.Term(1, 0, 1.0), cf.imported.Term(0, 0, -1.0)), where="MPC 2")
    with pytest.raises(cf.errors.ModelError, match="MPC 2: node 11: found it tied already by MPC 1"):
        tied_rows(motions(equations=(one, cf.imported.Equation(terms=one.terms, where="MPC 2"))), NONE)
    with pytest.raises(cf.errors.ModelError, match="found connections that hang on one another in a ring"):
        eliminated(tied_rows(motions(equations=(one, other)), NONE))


@pytest.mark.parametrize(("depth", "taken"), [(2, True), (33, True), (64, True), (65, False)])
def test_connections_hang_on_one_another_sixty_four_deep(depth, taken):
    """Each node follows the next with a factor of one half; the last is free."""
    count = depth + 1
    x = np.vstack([X[:4], np.column_stack([np.arange(count), np.ones((count, 2))])])
    chain = tuple(
        cf.imported.Equation(terms=(cf.imported.Term(4 + k, 0, 1.0), cf.imported.Term(5 + k, 0, -0.5)))
        for k in range(depth)
    )
    mesh = cf.imported.MeshData(
        kind="tetra", points=x, cells=np.array([[0, 1, 2, 3]]), attachments=cf.imported.Attachments(equations=chain)
    )
    rows = tied_rows(motions_of(mesh, 3), NONE)
    if taken:
        assert eliminated(rows)[[12]].toarray()[0, 12 + 3 * depth] == 0.5**depth
    else:
        with pytest.raises(cf.errors.ModelError, match="in a ring"):
            eliminated(rows)


def test_of_a_tie_what_a_support_holds_is_kept():
    at = motions(
        glued=(
            cf.imported.Tie(nodes=np.array([3]), others=np.array([[0, 1, 2]]), weights=np.array([[0.5, 0.0, 0.25]])),
        )
    )
    rows = tied_rows(at, np.array([10]))
    assert rows.entries == [(9, 0, 0.5), (9, 6, 0.25), (11, 2, 0.5), (11, 8, 0.25)]


def test_entries_of_nothing_are_left_out():
    rows = Rows(motions())
    rows.add(4, 1, {0: 2.0, 3: 0.0}, "one")
    assert rows.entries == [(4, 0, 2.0)]


def test_unknowns_without_mass_follow_statically_or_are_idle():
    """A spring along (3, 4)/5 of dofs 1 and 2 to dof 0 leaves their motion (4, -3) idle; dof 3 is alone."""
    row = np.array([-1.0, 0.6, 0.8, 0.0])
    K = csc_array(7.0 * np.outer(row, row) + np.diag([2.0, 0.0, 0.0, 0.0]))
    kept, idle = without_mass(K, np.array([1, 2, 3]))
    assert len(kept) == 2
    assert 0 in kept
    assert 3 not in kept
    still = idle.toarray()
    assert still.shape == (4, 2)
    np.testing.assert_allclose(K.toarray() @ still, 0.0, atol=1e-13)
    assert np.linalg.matrix_rank(still) == 2
    none = without_mass(csc_array(np.diag([1.0, 2.0])), np.array([1]))
    assert (none[0].tolist(), none[1].shape) == ([0, 1], (2, 0))
    assert without_mass(K, NONE)[0].tolist() == [0, 1, 2, 3]


def test_parts_that_hang_together_stand_one_after_the_other():
    A = np.zeros((5, 5))
    A[0, 3] = A[3, 0] = A[1, 4] = A[4, 1] = 1.0
    order, begins = sorted_parts(csc_array(A))
    assert order.tolist() == [0, 3, 1, 4, 2]
    assert begins.tolist() == [2, 4]


def test_an_enlarged_matrix_is_a_copy_with_nothing_behind():
    A = csc_array(np.array([[1.0, 2.0], [3.0, 4.0]]))
    assert enlarged(A, 3).toarray().tolist() == [[1, 2, 0], [3, 4, 0], [0, 0, 0]]
    assert A.shape == (2, 2)


def test_the_director_of_a_reference_on_a_shell_turns_with_it():
    at = shell(
        rigids=(
            cf.imported.Rigid(reference=0, nodes=np.array([1])),
            cf.imported.Rigid(reference=0, nodes=np.array([4])),
        )
    )
    rows = tied_rows(at, NONE)
    assert rows.own == {3, 4}
    assert rows.owner[3] == rows.owner[4] == "its turns as the reference of rigid connection"
    assert sorted(rows.owner) == [3, 4, *range(5, 10), *range(20, 23), *range(at.turn(4), at.turn(4) + 3)]
