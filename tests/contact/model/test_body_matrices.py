"""Bodies from matrices: exact small systems, free bodies, massless dofs, damping, units, reports, refusals."""

import json

import numpy as np
import pytest
from scipy.sparse import block_diag, csc_array, diags_array

import contact as ct


def rod(n, fixed, *, E=210e9, rho=7800.0, A=1e-4, L=1.0):
    """Lumped rod along x: n elements, node numbers from 1 at the left, the fixed ones taken out."""
    h = L / n
    K = diags_array([np.full(n, -1.0), np.r_[1.0, np.full(n - 1, 2.0), 1.0], np.full(n, -1.0)], offsets=[-1, 0, 1])
    M = np.full(n + 1, rho * A * h)
    M[[0, -1]] *= 0.5
    free = [k for k in range(n + 1) if k + 1 not in fixed]
    K = csc_array(E * A / h * K)[free][:, free]
    dofs = [(k + 1, "x") for k in free]
    return csc_array(diags_array(M[free])), K, dofs, {k + 1: (k * h, 0.0, 0.0) for k in range(n + 1)}


def compliance(body):
    elastic = body.omega > 0.0
    return (body.rows[:, elastic] / body.omega[elastic] ** 2) @ body.rows[:, elastic].T + body.S


@pytest.mark.parametrize("modes", [1, 5, 40])
def test_a_fixed_rod_has_its_frequencies_and_its_static_compliance(modes):
    M, K, dofs, points = rod(40, {41})
    body = ct.ModalBody.from_matrices(M, K, dofs=dofs, points=points, contact=[1, 21], modes=modes)
    k = np.arange(1, 6)[:modes]
    exact = 2 * 40 * np.sqrt(210e9 / 7800) * np.sin((2 * k - 1) * np.pi / 160)
    np.testing.assert_allclose(body.omega[:5], exact, rtol=1e-9)
    flexible = 1.0 / (210e9 * 1e-4)
    np.testing.assert_allclose(compliance(body), [[flexible, flexible / 2], [flexible / 2, flexible / 2]], rtol=1e-9)
    assert body.channels == ("1.x", "21.x")
    assert (modes < 40) == bool(body.S.any())  # all 40 kept: nothing is left


def test_a_free_rod_keeps_its_rigid_mode_and_the_compliance_of_the_others():
    """By inertia relief, against the pseudo-inverse over the elastic modes."""
    M, K, dofs, _ = rod(20, set())
    body = ct.ModalBody.from_matrices(M, K, dofs=dofs, contact=[1, 8], modes=6)
    assert body.omega[0] == 0.0
    root = np.sqrt(M.diagonal())
    lam, X = np.linalg.eigh(K.toarray() / np.outer(root, root))
    seen = (X / root[:, None])[[0, 7]]
    np.testing.assert_allclose(body.omega[1:], np.sqrt(lam[1:6]), rtol=1e-9)
    np.testing.assert_allclose(compliance(body), (seen[:, 1:] / lam[1:]) @ seen[:, 1:].T, rtol=1e-8)
    np.testing.assert_allclose(body.rows[:, 0] ** 2, 1.0 / (7800 * 1e-4), rtol=1e-9)
    facts = json.loads(body.provenance)["matrices"]
    assert facts["rigid"] == 1
    np.testing.assert_allclose(body.participation[0] ** 2, [0.78, *np.zeros(5)], atol=1e-9)


def test_masses_without_support_may_outnumber_those_that_something_does():
    three = {"dofs": [(k, "x") for k in (1, 2, 3)], "contact": [1, 3]}
    body = ct.ModalBody.from_matrices(np.eye(3), np.diag([0.0, 0.0, 4.0]), **three)
    assert body.omega.tolist() == pytest.approx([0.0, 0.0, 2.0], rel=1e-9)
    np.testing.assert_allclose(np.sort(np.abs(body.rows), axis=1)[:, -1], [1.0, 1.0], rtol=1e-9)
    with pytest.raises(ct.InputError, match="K: found no stiffness on its diagonal"):
        ct.ModalBody.from_matrices(np.diag([1.0, 1.0, 0.0]), np.diag([0.0, 0.0, 4.0]), **three)


def test_massless_dofs_go_into_the_residual():
    """A spring 2e6 to a mass of 3 kg on 1e6: one mode, and the whole static compliance at the massless end."""
    K = [[2e6, -2e6], [-2e6, 3e6]]
    body = ct.ModalBody.from_matrices(np.diag([0.0, 3.0]), K, dofs=[(1, "x"), (2, "x")], contact=[1])
    assert body.omega.tolist() == pytest.approx([np.sqrt(1e6 / 3)], rel=1e-9)
    assert compliance(body).item() == pytest.approx(1 / 1e6 + 1 / 2e6, rel=1e-9)
    assert body.S.item() == pytest.approx(1 / 2e6, rel=1e-9)


def test_a_rod_of_many_elements_has_its_closed_form():
    """More than 1500 unknowns: its modes are computed by a Lanczos method."""
    M, K, dofs, _ = rod(1600, {1601})
    held = ct.ModalBody.from_matrices(M, K, dofs=dofs, contact=[1], modes=8)
    speed, k = np.sqrt(210e9 / 7800), np.arange(1, 9)
    np.testing.assert_allclose(held.omega, 3200 * speed * np.sin((2 * k - 1) * np.pi / 6400), rtol=1e-8)
    np.testing.assert_allclose(compliance(held), [[1.0 / (210e9 * 1e-4)]], rtol=1e-7)
    M, K, dofs, _ = rod(1600, set())
    free = ct.ModalBody.from_matrices(M, K, dofs=dofs, contact=[1], modes=8)
    assert free.omega[0] == 0.0
    np.testing.assert_allclose(free.omega[1:], 3200 * speed * np.sin(k[:7] * np.pi / 3200), rtol=1e-7)


def test_damping_ratios_and_what_they_leave_out():
    M, K, dofs, _ = rod(10, {11})
    proportional = ct.bodies.body_of(ct.bodies.Matrices.of(M, K, 1e-6 * K, dofs=dofs), [1], modes=4)
    np.testing.assert_allclose(proportional[0].zeta, 0.5e-6 * proportional[0].omega, rtol=1e-9)
    assert proportional[1].coupling == pytest.approx(0.0, abs=1e-9)
    C = np.zeros(K.shape)
    C[0, 0] = 100.0
    assert ct.bodies.body_of(ct.bodies.Matrices.of(M, K, C, dofs=dofs), [1], modes=4)[1].coupling == pytest.approx(
        1.0, rel=1e-6
    )
    assert set(ct.ModalBody.from_matrices(M, K, dofs=dofs, contact=[1], zeta=0.01).zeta) == {0.01}


UNITS = {  # kg, m, s of one unit of mass, length, time
    "m-kg-s": (1.0, 1.0, 1.0),
    "mm-t-s": (1e3, 1e-3, 1.0),
    "in-lbf-s": (4.4482216152605 / 0.0254, 0.0254, 1.0),
    "mm-kg-ms": (1.0, 1e-3, 1e-3),
}


def dumbbell(units):
    """Two masses of 2 and 1 kg, 3 m apart along x, all six directions of each joined by stiff springs."""
    T = np.eye(6)
    T[:3, 3:] = -np.array([[0, -0.0, 0.0], [0.0, 0, -3.0], [-0.0, 3.0, 0]])  # u2 = u1 + w x (3, 0, 0)
    D = np.diag([1e6] * 3 + [1e5] * 3)
    B = np.hstack([-T, np.eye(6)])
    K, M = B.T @ D @ B, np.diag([2.0] * 3 + [0.1] * 3 + [1.0] * 3 + [0.2] * 3)
    mass, length, time = UNITS[units]
    scale = np.diag(([1.0] * 3 + [1.0 / length] * 3) * 2)
    dofs = [(node, direction) for node in (5, 9) for direction in range(1, 7)]
    points = {5: np.zeros(3), 9: np.array([3.0, 0, 0]) / length}
    given = scale @ M @ scale / mass, scale @ K @ scale / (mass / time**2)
    return ct.bodies.Matrices.of(*given, dofs=dofs, points=points, units=units)


@pytest.mark.parametrize("units", ["m-kg-s", "mm-t-s", "in-lbf-s", "mm-kg-ms"])
def test_mass_centre_and_inertia_in_any_units(units):
    body, facts = ct.bodies.body_of(dumbbell(units), [9], modes=12)
    assert facts.mass == pytest.approx((3.0, 3.0, 3.0), rel=1e-9)
    assert facts.centre == pytest.approx((1.0, 0.0, 0.0), abs=1e-9)
    np.testing.assert_allclose(facts.inertia, np.diag([0.3, 6.3, 6.3]), atol=1e-8)
    assert facts.rigid == 6
    assert body.channels == ("9.x", "9.y", "9.z")
    assert facts.freq_hz[0] > 1.0
    assert "3 3 3 along x, y, z" in str(facts)


def test_frequencies_do_not_depend_on_the_units():
    one, other = (ct.bodies.body_of(dumbbell(units), [9], modes=12)[0] for units in ("m-kg-s", "mm-t-s"))
    np.testing.assert_allclose(other.omega, one.omega, rtol=1e-7)
    np.testing.assert_allclose(np.abs(other.rows[:, 6:]), np.abs(one.rows[:, 6:]), atol=1e-7)


def craig_bampton(M, K, boundary, count):
    """Someone's Craig-Bampton set: boundary dofs first, then amplitudes of fixed-interface modes."""
    n = K.shape[0]
    inner = [k for k in range(n) if k not in boundary]
    M, K = M.toarray(), K.toarray()
    static = np.zeros((n, len(boundary)))
    static[boundary] = np.eye(len(boundary))
    static[inner] = -np.linalg.solve(K[np.ix_(inner, inner)], K[np.ix_(inner, boundary)])
    root = np.sqrt(np.diag(M)[inner])
    _, X = np.linalg.eigh(K[np.ix_(inner, inner)] / np.outer(root, root))
    fixed = np.zeros((n, count))
    fixed[inner] = (X / root[:, None])[:, :count]
    T = np.hstack([static, fixed])
    return T.T @ M @ T, T.T @ K @ T


def test_a_craig_bampton_set_is_diagonalised_and_truncated_into_its_residual():
    M, K, dofs, _ = rod(60, {61})
    mass, stiff = craig_bampton(M, K, [0], 9)
    labels = [(1, "x"), *((100 + k, "q") for k in range(9))]
    whole, facts = ct.bodies.body_of(ct.bodies.Matrices.of(mass, stiff, dofs=labels), [1], modes=10)
    assert not whole.S.any()
    assert "residual compliance: none" in str(facts)
    full = ct.ModalBody.from_matrices(M, K, dofs=dofs, contact=[1], modes=10)
    np.testing.assert_allclose(whole.omega[:4], full.omega[:4], rtol=2e-3)
    assert np.all(whole.omega[:4] > full.omega[:4])
    np.testing.assert_allclose(compliance(whole), compliance(full), rtol=1e-9)
    fewer, facts = ct.bodies.body_of(ct.bodies.Matrices.of(mass, stiff, dofs=labels), [1], modes=6)
    np.testing.assert_allclose(compliance(fewer), compliance(full), rtol=1e-9)
    assert facts.residual > 0.01
    assert f"{100 * facts.residual:.3g} % of the static compliance" in facts.words


def test_a_free_craig_bampton_set_has_its_whole_mass():
    M, K, dofs, _ = rod(60, set())
    mass, stiff = craig_bampton(M, K, [0], 5)
    labels = [dofs[0], *((100 + k, 0) for k in range(5))]
    body, facts = ct.bodies.body_of(ct.bodies.Matrices.of(mass, stiff, dofs=labels), [1])
    assert facts.mass == pytest.approx((0.78, 0.0, 0.0), rel=1e-9)
    assert facts.rigid == 1
    assert facts.inertia is None
    assert "inertia: unknown" in str(facts)
    assert body.omega[0] == 0.0


TWO = {"dofs": [(1, "x"), (2, "x")], "contact": [1]}
I2 = np.eye(2)


@pytest.mark.parametrize(
    ("M", "K", "change", "message"),
    [
        (I2, np.eye(3), {}, r"K: found shape \(3, 3\), expected \(2, 2\)"),
        (I2, [[1.0, 0.5], [0.0, 1.0]], {}, "K: found asymmetry of 5.00e-01"),
        (I2, [[1.0, np.nan], [0.0, 1.0]], {}, "K: found entries that are NaN"),
        (I2, [[1.0, 2.0], [2.0, 1.0]], {}, "without negative modes"),
        (np.diag([1.0, -1.0]), I2, {}, "M: found"),
        (np.zeros((2, 2)), I2, {}, "M: found only zeros"),
        (1.0 - I2, I2, {}, "M: found no mass on its diagonal"),
        (I2, (1.0 + 0.02j) * I2, {}, "K: found complex numbers, expected real ones"),
        (np.diag([1.0, 0.0]), np.diag([1.0, 0.0]), {}, "neither mass nor stiffness at 2.x, the first of 1 such dofs"),
        (I2, I2, {"C": np.diag([0.1, -0.1])}, "C: found negative damping in mode"),
        (I2, I2, {"dofs": [(1, "x"), (1, "x")]}, "dofs: found 1.x twice"),
        (I2, I2, {"G": np.eye(3)}, r"G: found shape \(3, 3\), expected \(2, 2\)"),
        (I2, I2, {"dofs": [(1, "x"), (1, "w")]}, "direction 'w' at node 1"),
        (I2, I2, {"contact": [3]}, "contact: found node 3"),
        (I2, I2, {"contact": [(1, "y")]}, "contact: found 1.y, which is not a dof"),
        (I2, I2, {"contact": []}, "contact: found"),
        (I2, I2, {"contact": {"tip": [1.0]}}, "contact: found rows of 1 entries, expected 2"),
        (I2, I2, {"units": "mm-t"}, "units: found 'mm-t', expected length"),
        (I2, I2, {"units": "mm-stone-s"}, "units: found 'mm-stone-s'"),
        (I2, I2, {"modes": 3}, "modes: found 3, expected 1 to 2,"),
        (I2, I2, {"points": {1: (0.0, 0.0)}}, "points: found .* for node 1"),
    ],
)
def test_what_cannot_be_a_body_is_named(M, K, change, message):
    with pytest.raises(ct.InputError, match=message):
        ct.ModalBody.from_matrices(M, K, **{**TWO, "modes": 2, **change})


SLOW = np.r_[np.full(6, 1e-3), np.ones(8)]  # the shift, a millionth of the median, is large beside the seventh mode


@pytest.mark.parametrize(
    ("K", "message"),
    [
        (np.diag([-0.9e-9, *SLOW]), None),
        (
            np.diag([-1.1e-9, *SLOW]),
            "K: found omega.2 = -1.1e-09 rad.2/s.2, expected a stiffness without negative",
        ),
    ],
)
def test_a_stiffness_may_be_negative_by_a_millionth_of_its_elastic_modes(K, message):
    size = len(K)

    def made():
        return ct.ModalBody.from_matrices(np.eye(size), K, dofs=[(k, "x") for k in range(size)], contact=[1])

    if message is None:
        np.testing.assert_allclose(
            made().omega ** 2, np.maximum(np.sort(np.diag(K)), 0.0)[: made().omega.size], rtol=1e-9
        )
        return
    with pytest.raises(ct.InputError, match=message):
        made()


def test_no_rigid_mode_is_left_out():
    """Two pairs of masses that nothing holds: two rigid modes, and two of omega^2 = 2 k/m."""
    K = np.kron(I2, [[3.0, -3.0], [-3.0, 3.0]])
    given = {"dofs": [(k, "x") for k in range(4)], "contact": [0]}
    np.testing.assert_allclose(ct.ModalBody.from_matrices(np.eye(4), K, modes=2, **given).omega, 0.0, atol=0.0)
    np.testing.assert_allclose(ct.ModalBody.from_matrices(np.eye(4), K, **given).omega[2:] ** 2, 6.0, rtol=1e-9)
    with pytest.raises(ct.InputError, match="modes: found 1, expected at least the 2 rigid modes of these matrices"):
        ct.ModalBody.from_matrices(np.eye(4), K, modes=1, **given)


def test_channels_of_ones_own():
    M, K, dofs, _ = rod(4, {5})
    mean = {"mean": [0.5, 0.5, 0.0, 0.0]}
    body = ct.ModalBody.from_matrices(M, K, dofs=dofs, contact=mean, modes=2)
    assert body.channels == ("mean",)
    G = np.linalg.inv(K.toarray())
    assert compliance(body).item() == pytest.approx(0.25 * G[:2, :2].sum(), rel=1e-9)


def test_a_missing_half_shows_beside_a_support_fixed_by_a_large_penalty():
    """The penalty 1e20 is no measure for the springs of the other dofs."""
    M, K, dofs, _ = rod(6, set())
    held = K.toarray()
    held[-1, -1] += 1e20
    free = ct.ModalBody.from_matrices(M, held, dofs=dofs, contact=[1], modes=4)
    assert free.omega[0] > 0.0
    with pytest.raises(ct.InputError, match="K: found asymmetry of"):
        ct.ModalBody.from_matrices(M, np.triu(held), dofs=dofs, contact=[1], modes=4)


def test_round_off_in_rows_without_stiffness_is_no_asymmetry():
    """A free Craig-Bampton set: the stiffness at its boundary is round-off, of any sign and symmetry."""
    K = np.diag([0.0, 0.0, 1e6, 4e6, 9e6])
    K[:2, :2] = [[1e-9, 2e-9], [-1e-9, 2e-9]]
    dofs = [(1, "x"), (1, "y"), *((100 + k, "q") for k in range(3))]
    _, facts = ct.bodies.body_of(ct.bodies.Matrices.of(np.eye(5), K, dofs=dofs), [1], modes=5)
    assert facts.rigid == 2


def test_parts_that_nothing_joins_have_their_rigid_modes_each():
    """Nine free rods: nine rigid modes, and the compliance of one rod at its end."""
    M, K, dofs, _ = rod(6, set())
    one = ct.ModalBody.from_matrices(M, K, dofs=dofs, contact=[1], modes=3)
    many = [(node + 100 * k, axis) for k in range(9) for node, axis in dofs]
    body, facts = ct.bodies.body_of(
        ct.bodies.Matrices.of(block_diag([M] * 9), block_diag([K] * 9), dofs=many), [1], modes=20
    )
    assert facts.rigid == 9
    np.testing.assert_allclose(body.omega[9:18], one.omega[1], rtol=1e-6)
    elastic = body.rows[:, 9:] / body.omega[9:]
    alone = one.rows[:, 1:] / one.omega[1:]
    np.testing.assert_allclose(elastic @ elastic.T + body.S, alone @ alone.T + one.S, rtol=1e-6)


def test_few_masses_among_many_dofs_are_named():
    """Lanczos finds no more modes than there are masses."""
    _, K, dofs, _ = rod(1600, {1601})
    M = np.zeros(1600)
    M[0] = 1.0
    with pytest.raises(ct.InputError, match=r"M, K: found fewer than .* modes of 1600 dofs, of which 1 have mass"):
        ct.ModalBody.from_matrices(diags_array(M), K, dofs=dofs, contact=[1], modes=4)


def test_dashpot_on_a_rigid_mode_is_kept_as_a_matrix():
    """A free rod of mass m with a dashpot d at its end slows down at d/m, whatever its modes."""
    M, K, dofs, _ = rod(6, set())
    C = np.zeros(K.shape)
    C[0, 0] = 1.0
    body = ct.ModalBody.from_matrices(M, K, C, dofs=dofs, contact=[1], modes=3)
    assert body.zeta[0] == 0.0
    assert body.damping[0, 0] == pytest.approx(1.0 / (7800 * 1e-4), rel=1e-9)
    assert ct.ModalBody.from_matrices(M, K, 1e-6 * K, dofs=dofs, contact=[1], modes=3).damping is None


def jeffcott(units="m-kg-s"):
    """A disk on a massless shaft between a rigid and a cross-coupled bearing, 6 dofs: x, y, tilts, the bearing's x, y.

    M, K, C, G of G. Genta, Dynamics of Rotating Systems, 2005, ch. 4: 10 kg, polar inertia 0.2, 0.12 across.
    """
    k, c, a = 4e6, 1.2e5, 0.03  # N/m; N, shaft's coupling of deflection and tilt; m, polar over diametral
    M = np.diag([10.0, 10.0, 0.12, 0.12, 0.5, 0.5])
    K = np.zeros((6, 6))
    for x, tilt, end, sign in ((0, 3, 4, 1.0), (1, 2, 5, -1.0)):
        s = np.zeros((1, 6))
        s[0, [x, end]] = 1.0, -0.5
        t = np.zeros((1, 6))
        t[0, [tilt, x]] = 1.0, sign * a
        K += k * s.T @ s + c * t.T @ t
    C, cross, own = np.zeros((6, 6)), 3e5, 2e6
    K[4:, 4:] += [[own, cross], [-cross, own]]
    C[4:, 4:] += [[900.0, 200.0], [-150.0, 1100.0]]
    G = np.zeros((6, 6))
    G[2, 3], G[3, 2] = 0.2, -0.2
    dofs = [(1, d) for d in ("x", "y", "rx", "ry")] + [(2, "x"), (2, "y")]
    mass, length, time = UNITS[units]
    scale = np.diag([1.0, 1.0, 1.0 / length, 1.0 / length, 1.0, 1.0])
    units_each = (mass, mass / time**2, mass / time, mass)
    return [scale @ A @ scale / unit for A, unit in zip((M, K, C, G), units_each, strict=True)], dofs


@pytest.mark.parametrize("units", ["m-kg-s", "mm-t-s"])
@pytest.mark.parametrize("speed", [0.0, 250.0, -900.0])
def test_rotor_with_gyroscopic_disk_and_cross_coupled_bearing_has_its_own_poles(speed, units):
    (M, K, C, G), dofs = jeffcott()
    n = len(M)
    dense = np.linalg.eigvals(
        np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C + speed * G)]])
    )
    (M, K, C, G), dofs = jeffcott(units)
    given = {"dofs": dofs, "contact": [(1, "x"), (1, "y")], "units": units, "nonsymmetric": True}
    body = ct.ModalBody.from_matrices(M, K, C, G=G, **given)
    damping, stiffness = body.matrices(speed)
    m = body.omega.size
    found = np.linalg.eigvals(np.block([[np.zeros((m, m)), np.eye(m)], [-stiffness, -damping]]))
    for pole in dense:
        assert np.abs(found - pole).min() < 1e-9 * np.abs(dense).max()
    assert np.abs(body.stiffness + body.stiffness.T).max() == 0.0
    still = ct.ModalBody.from_matrices(M, 0.5 * (K + K.T), 0.5 * (C + C.T), **given)
    assert still.stiffness is still.gyroscopic is None
    assert np.abs(np.linalg.eigvals(stiffness) - np.linalg.eigvals(still.matrices(0.0)[1])).max() > 1e3


def test_matrices_of_a_rotor_are_refused_where_they_are_not_what_they_should_be():
    (M, K, C, G), dofs = jeffcott()
    given = {"dofs": dofs, "contact": [1]}
    with pytest.raises(ct.InputError, match=r"K: found asymmetry of .*; for cross-coupled bearings pass nonsymmetric"):
        ct.ModalBody.from_matrices(M, K, **given)
    with pytest.raises(ct.InputError, match=r"C: found asymmetry of .*; for cross-coupled bearings pass nonsymmetric"):
        ct.ModalBody.from_matrices(M, 0.5 * (K + K.T), C, **given)
    with pytest.raises(
        ct.InputError, match=r"G: found 0\.2 at \(3, 2\) and 0\.2 at \(2, 3\), expected a skew-symmetric matrix"
    ):
        ct.ModalBody.from_matrices(M, 0.5 * (K + K.T), G=np.abs(G), **given)
    with pytest.raises(
        ct.InputError,
        match=r"M: found asymmetry of [\d.e-]+ of its entries, expected a symmetric matrix: write both triangles$",
    ):
        ct.ModalBody.from_matrices(M + G, K, nonsymmetric=True, **given)


def test_gyroscopic_disk_whirls_at_its_closed_form():
    """A rigid disk in tilting springs: omega^2 -+ (p/d) Omega omega - k/d = 0 (Genta 2005)."""
    d, p, k, speed = 0.12, 0.2, 3e4, 400.0
    G = [[0.0, p], [-p, 0.0]]
    body = ct.ModalBody.from_matrices(
        d * np.eye(2), k * np.eye(2), G=G, dofs=[(1, "rx"), (1, "ry")], contact=[(1, "rx")]
    )
    C, K = body.matrices(speed)
    found = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-K, -C]])).imag
    b = 0.5 * p / d * speed
    exact = np.hypot(b, np.sqrt(k / d)) + np.array([-b, b])
    np.testing.assert_allclose(np.sort(found), [*-exact[::-1], *exact], rtol=1e-12)


def beam(count, lengths=None, *, clamped=False):
    """Euler-Bernoulli beam along x, 1 m, 20 mm square, steel: nodes from 0, six dofs each, and its points."""
    E, G, rho, side = 2.1e11, 8e10, 7850.0, 0.02
    area, bending, torsion = side**2, side**4 / 12, 0.1406 * side**4
    h = np.full(count, 1.0 / count) if lengths is None else lengths
    M, K = np.zeros((2, 6 * count + 6, 6 * count + 6))
    for e, L in enumerate(h.tolist()):
        bars = {0: (E * area, rho * area), 3: (G * torsion, rho * 2 * bending)}
        for first, (stiff, mass) in bars.items():
            rows = np.ix_(*2 * [[6 * e + first, 6 * e + 6 + first]])
            K[rows] += stiff / L * np.array([[1.0, -1.0], [-1.0, 1.0]])
            M[rows] += mass * L / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
        k = [[12, 6 * L, -12, 6 * L], [6 * L, 4 * L**2, -6 * L, 2 * L**2], [-12, -6 * L, 12, -6 * L]]
        m = [[156, 22 * L, 54, -13 * L], [22 * L, 4 * L**2, 13 * L, -3 * L**2], [54, 13 * L, 156, -22 * L]]
        k, m = [*k, [6 * L, 2 * L**2, -6 * L, 4 * L**2]], [*m, [-13 * L, -3 * L**2, -22 * L, 4 * L**2]]
        for move, turn, sign in ((1, 5, 1.0), (2, 4, -1.0)):
            rows = np.ix_(*2 * [[6 * e + move, 6 * e + turn, 6 * e + 6 + move, 6 * e + 6 + turn]])
            signs = np.outer([1, sign, 1, sign], [1, sign, 1, sign])
            K[rows] += E * bending / L**3 * signs * np.array(k)
            M[rows] += rho * area * L / 420 * signs * np.array(m)
    start = 6 if clamped else 0
    dofs = [(node, d) for node in range(count + 1) for d in ("x", "y", "z", "rx", "ry", "rz")][start:]
    x = np.r_[0.0, np.cumsum(h)]
    return M[start:, start:], K[start:, start:], dofs, {node: (v, 0.0, 0.0) for node, v in enumerate(x.tolist())}


def eight_digits(A):
    rounded = A.copy()
    rounded[A != 0.0] = [float(f"{a:.7e}") for a in A[A != 0.0]]
    return rounded


STORED = [np.float32, eight_digits]


@pytest.mark.parametrize("stored", STORED)
@pytest.mark.parametrize("lengths", ["equal", "unequal"])
def test_round_off_of_the_precision_of_a_free_beam_is_no_negative_mode(stored, lengths):
    """37 elements; the lowest elastic frequency is (4.730)^2 / (2 pi) sqrt(EI / (rho A))."""
    h = np.random.default_rng(5).uniform(0.5, 1.5, 37)
    M, K, dofs, points = beam(37, None if lengths == "equal" else h / h.sum())
    M, K = (stored(A).astype(float) for A in (M, K))
    body, facts = ct.bodies.body_of(ct.bodies.Matrices.of(M, K, dofs=dofs, points=points), [0, 20], modes=10)
    assert facts.rigid == 6
    exact = 4.730041**2 * np.sqrt(2.1e11 * 0.02**2 / 12 / 7850)
    np.testing.assert_allclose(body.omega[6:8], exact, rtol=2e-4)


@pytest.mark.parametrize("stored", STORED)
def test_a_stiffness_that_is_negative_beyond_its_precision_is_refused(stored):
    M, K, dofs, points = beam(37)
    K[1, 1] -= 1e4  # a ground spring of -10 N/mm at the first node: omega^2 about -4 k / m = -1.3e4
    with pytest.raises(ct.InputError, match="without negative modes; rounding errors of K explain"):
        ct.bodies.body_of(ct.bodies.Matrices.of(stored(M), stored(K), dofs=dofs, points=points), [0], modes=10)


def test_rigid_modes_that_the_precision_does_not_separate_from_elastic_ones_are_refused():
    """A free beam of 80 unequal elements in single precision: round-off reaches 0.1 of its lowest frequency."""
    h = np.random.default_rng(0).uniform(0.5, 1.5, 80)
    M, K, dofs, points = beam(80, h / h.sum())
    assert ct.bodies.body_of(ct.bodies.Matrices.of(M, K, dofs=dofs, points=points), [0], modes=10)[1].rigid == 6
    given = [np.float32(A) for A in (M, K)]
    with pytest.raises(ct.InputError, match=r"K: found omega\^2 = -.* and .*: give K in double precision"):
        ct.bodies.body_of(ct.bodies.Matrices.of(*given, dofs=dofs, points=points), [0], modes=10)
