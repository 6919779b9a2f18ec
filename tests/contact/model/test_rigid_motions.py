"""Matrices of a free body against the rigid motions of its nodes: exact trusses, wrong positions, axes and masses."""

import numpy as np
import pytest

import contact as ct

X = np.array(
    [[0.0, 0.0, 0.0], [0.4, 0.1, 0.0], [0.1, 0.5, 0.1], [0.0, 0.1, 0.3], [0.5, 0.4, 0.2], [0.2, 0.6, 0.5]]
)  # fmt: skip
MASS = np.array([1.0, 2.0, 0.5, 1.5, 3.0, 2.5])
TURNED = np.array([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])


def dofs(x, first=1):
    return [(first + k, axis) for k in range(len(x)) for axis in "xyz"]


def truss(x=X):
    """Stiffness of bars between all nodes, each of its own stiffness."""
    K = np.zeros((3 * len(x), 3 * len(x)))
    for i in range(len(x)):
        for j in range(i):
            n = (x[i] - x[j]) / np.linalg.norm(x[i] - x[j])
            row = np.zeros(3 * len(x))
            row[3 * i : 3 * i + 3], row[3 * j : 3 * j + 3] = n, -n
            K += 1e6 * (1.0 + 0.1 * i + 0.03 * j) * np.outer(row, row)
    return K


def found(K=None, M=None, x=X, named=None, points=None, contact=None, **more):
    """Body and report; `points` are the positions that are stated, those of the bars if left out."""
    K, M = truss(x) if K is None else K, np.diag(np.repeat(MASS[: len(x)], 3)) if M is None else M
    places = {k + 1: tuple(place) for k, place in enumerate(x)} if points is None else points
    given = ct.bodies.Matrices.of(K=K, M=M, dofs=named or dofs(x), points=places, **more)
    return ct.bodies.body_of(given, contact or [(1, "x")])


def moved(by):
    """Stated positions of which one is off by this along x."""
    return {k + 1: tuple(place + np.array([by, 0.0, 0.0]) * (k == 4)) for k, place in enumerate(X)}


def residual(K, x):
    """The largest |sum_j K_ij R_j| / sum_j |K_ij| |R_j| of a rotation about the row's node, by plain loops."""
    worst, shortest = 0.0, 0.05 * np.ptp(x, axis=0).max()
    for i in range(len(K)):
        left, terms = np.zeros(3), 0.0
        for j in range(len(K)):
            arm = x[j // 3] - x[i // 3]
            left += K[i, j] * np.cross(arm, np.eye(3)[j % 3])
            terms += abs(K[i, j]) * max(np.linalg.norm(arm), shortest) * (K[i, j] != 0.0)
        worst = max(worst, np.linalg.norm(left) / terms)
    return worst


def test_a_free_truss_moves_rigidly_and_has_the_mass_centre_and_inertia_of_its_nodes():
    body, report = found()
    assert report.rigid == 6
    assert body.omega[:6].tolist() == [0.0] * 6
    assert body.omega[6] > 0.0
    number = float(report.rigid_motion.partition("K R is ")[2].partition(" of its terms, expected at most 0.003")[0])
    assert number < 1e-12
    assert report.rigid_motion.endswith("expected at most 0.003")
    centre = MASS @ X / MASS.sum()
    arm = X - centre
    inertia = np.einsum(
        "k,kij->ij", MASS, np.einsum("ki,ki,ab->kab", arm, arm, np.eye(3)) - arm[:, :, None] * arm[:, None]
    )
    np.testing.assert_allclose(report.mass, MASS.sum())
    np.testing.assert_allclose(report.centre, centre)
    np.testing.assert_allclose(report.inertia, inertia, atol=1e-12)
    assert np.allclose(body.participation[:, 6:], 0.0, atol=1e-6)  # an elastic mode has no momentum


def test_a_body_is_the_same_in_millimetres_and_tonnes_and_wherever_its_origin_is():
    body, _ = found()
    scaled = found(K=1e-3 * truss(), M=1e-3 * np.diag(np.repeat(MASS, 3)), units="mm-t-s",
                   points={k + 1: tuple(1e3 * place) for k, place in enumerate(X)})  # fmt: skip
    far = found(points={k + 1: tuple(place + np.array([3.0, -20.0, 7.0])) for k, place in enumerate(X)})
    for other, report in (scaled, far):
        np.testing.assert_allclose(other.omega[6:], body.omega[6:], rtol=1e-9)
        np.testing.assert_allclose(other.S, body.S, rtol=1e-6, atol=1e-20)
        assert report.rigid_motion.startswith("rigid-body motion: K R is ")


@pytest.mark.parametrize("by", [1e-3, -1e-3])
def test_positions_of_few_digits_are_taken_with_what_they_leave(by):
    _, report = found(points=moved(by))
    expected = residual(truss(), np.array(list(moved(by).values())))
    assert 5e-4 < expected < 3e-3
    assert f"K R is {expected:.1e} of its terms" in report.rigid_motion


def test_wrong_positions_are_refused_with_the_row_that_resists_most():
    at = np.array(list(moved(0.1).values()))
    with pytest.raises(ct.InputError) as refused:
        found(points=moved(0.1))
    said = str(refused.value)
    assert said.startswith("K: found 6 rigid modes, but a rotation of all nodes causes ")
    assert f"causes {residual(truss(), at):.2g} of the terms of row " in said
    assert "the positions of nodes, their length unit or their axes do not fit K; give the axes of the nodes" in said


def turned_at(node, K):
    """K with the directions of one node turned."""
    T = np.eye(len(K))
    T[3 * node - 3 : 3 * node, 3 * node - 3 : 3 * node] = TURNED
    return T @ K @ T.T


def test_axes_of_a_node_are_wanted_where_its_rows_are_along_others():
    K = turned_at(5, truss())
    with pytest.raises(
        ct.InputError, match=r"but a translation of all nodes causes 0.* of row 5\.[xy].* the axes of nodes do"
    ):
        found(K=K)
    body, report = found(K=K, axes={5: TURNED})
    assert report.rigid_motion.startswith("rigid-body motion: K R is ")
    np.testing.assert_allclose(body.omega[6:], found()[0].omega[6:], rtol=1e-9)
    with pytest.raises(ct.InputError, match="translation of all nodes"):
        found(K=K, axes={4: TURNED})


def test_without_positions_only_translations_are_tested():
    _, report = found(points={})
    assert report.rigid_motion.endswith("expected at most 0.003; rotations not tested, since positions are unknown")
    assert (report.centre, report.inertia) == (None, None)
    assert "inertia: unknown, since positions of nodes are missing" in str(report)
    with pytest.raises(ct.InputError, match="translation of all nodes"):
        found(K=turned_at(5, truss()), points={})
    one_less = {k: place for k, place in moved(0.0).items() if k != 6}
    assert found(points=one_less)[1].rigid_motion.endswith("; rotations not tested, since positions are unknown")


def test_a_supported_part_is_tested_in_part():
    K = truss()
    K[:3, :3] += 1e7 * np.eye(3)  # at node 1
    _, report = found(K=K)
    assert report.rigid == 3  # rotations about node 1
    assert report.rigid_motion == "rigid-body motion: tested in part, since the part has supports"
    _, wrong = found(K=K, points=moved(0.1))
    assert wrong.rigid_motion.startswith(
        "rigid-body motion: warning: the rigid modes of K are not rigid motions of its"
    )
    _, unknown = found(K=K, points={})
    assert unknown.rigid_motion == "rigid-body motion: tested in part, since the part has supports"
    K[3:6, 3:6] += 1e7 * np.eye(3)
    K[6:9, 6:9] += 1e7 * np.eye(3)
    _, fixed = found(K=K, points=moved(0.1))
    assert fixed.rigid == 0
    assert fixed.rigid_motion == "rigid-body motion: tested in part, since the part has supports"


@pytest.mark.parametrize("wrong", [False, True])
def test_each_of_two_parts_is_tested_by_itself(wrong):
    """The second part is a copy beside the first; the stated position of one of its nodes may be wrong."""
    x = np.vstack([X, X + np.array([2.0, 0.0, 0.0])])
    K, M = np.zeros((36, 36)), np.diag(np.repeat(np.tile(MASS, 2), 3))
    K[:18, :18] = K[18:, 18:] = truss()
    K[:18, :18] += 1e7 * np.eye(18)  # on supports
    points = {k + 1: tuple(place) for k, place in enumerate(x)}
    if wrong:
        points[11] = (2.7, 0.4, 0.2)
        with pytest.raises(ct.InputError, match="found 6 rigid modes, but a rotation of all nodes"):
            found(K=K, M=M, x=x, points=points)
    else:
        assert found(K=K, M=M, x=x, points=points)[1].rigid_motion.endswith(
            "tested in part, since the part has supports"
        )


@pytest.mark.parametrize(("share", "taken"), [(0.9e-3, True), (1.1e-3, False), (0.5, False)])
def test_masses_of_a_free_body_are_equal_in_all_directions_within_a_thousandth(share, taken):
    M = np.diag(np.repeat(MASS, 3))
    M[1::3, 1::3] *= 1.0 - share
    if taken:
        assert found(M=M)[1].rigid == 6
        return
    y = MASS.sum() * (1.0 - share)
    with pytest.raises(ct.InputError) as refused:
        found(M=M)
    assert f"M: found the masses 10.5 {y:.6g} 10.5 kg along x, y, z of a free part, expected equal" in str(
        refused.value
    )


def test_amplitudes_of_modes_that_k_couples_are_condensed():
    """The last node as three amplitudes: the others with it free still move rigidly."""
    named = [*dofs(X)[:15], *((k, "q") for k in (101, 102, 103))]
    T = np.eye(18)
    T[15:, 15:] = np.array([[2.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 3.0]])
    M = np.diag(np.repeat(MASS, 3))
    body, report = found(K=T.T @ truss() @ T, M=T.T @ M @ T, named=named, points=moved(0.0))
    assert report.rigid == 6
    assert report.rigid_motion.startswith("rigid-body motion: K R is ")
    np.testing.assert_allclose(body.omega[6:], found()[0].omega[6:], rtol=1e-9)
    with pytest.raises(ct.InputError, match="rotation of all nodes"):
        found(K=T.T @ truss() @ T, M=T.T @ M @ T, named=named, points=moved(0.1))
    scalars = [(k + 1, "q") for k in range(18)]
    _, none = found(named=scalars, contact=[(1, "q")], points={})
    assert none.rigid_motion == "rigid-body motion: not tested, since no row belongs to a node"


def stiff_joints(x):
    """Stiffness of joints that resist relative motion and rotation of nodes with six dofs, and its masses."""
    n = len(x)
    K = np.zeros((6 * n, 6 * n))
    for i in range(n):
        for j in range(i):
            middle, B = 0.5 * (x[i] + x[j]), np.zeros((6, 6 * n))
            for node, sign in ((i, 1.0), (j, -1.0)):
                arm = middle - x[node]
                B[:3, 6 * node : 6 * node + 3] = sign * np.eye(3)
                B[:3, 6 * node + 3 : 6 * node + 6] = sign * np.cross(np.eye(3), arm).T
                B[3:, 6 * node + 3 : 6 * node + 6] = sign * np.eye(3)
            K += B.T @ np.diag([1e6, 2e6, 3e6, 1e4, 2e4, 3e4]) @ B
    return K


def test_nodes_with_rotations_move_rigidly_too():
    x = X[:4]
    named = [(k + 1, axis) for k in range(4) for axis in ("x", "y", "z", "rx", "ry", "rz")]
    M = np.diag(np.tile([2.0, 2.0, 2.0, 0.01, 0.01, 0.01], 4))
    body, report = found(K=stiff_joints(x), M=M, x=x, named=named)
    assert report.rigid == 6
    assert report.rigid_motion.startswith("rigid-body motion: K R is ")
    np.testing.assert_allclose(report.mass, 8.0)
    with pytest.raises(ct.InputError, match="rotation of all nodes"):
        found(K=stiff_joints(x), M=M, x=x, named=named, points={k: tuple(2.0 * x[k - 1]) for k in range(1, 5)})
    unit = np.tile([1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3], 4)  # force and moment of a millimetre
    scaled, _ = found(
        K=1e-3 * stiff_joints(x) / np.outer(unit, unit), M=1e-3 * M / np.outer(unit, unit), x=x, named=named,
        points={k + 1: tuple(1e3 * place) for k, place in enumerate(x)}, units="mm-t-s",
    )  # fmt: skip
    np.testing.assert_allclose(scaled.omega[6:], body.omega[6:], rtol=1e-9)
