"""Arrays and starts of schemes on linear bodies against whole matrices; uncompiled."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from contact.scheme.linear.nonsmooth_alpha import chung_hulbert
from tests.contact.plain import plain

M = np.diag([1.0, 2.0, 0.5, 1.5])
K = np.array([[35.0, -10.0, -3.0, -5.0], [-10.0, 30.0, -20.0, 0.0], [-3.0, -20.0, 30.0, -4.0], [-5.0, 0.0, -4.0, 9.0]])
C = np.array([[0.4, -0.1, 0.0, 0.0], [-0.1, 0.3, 0.0, 0.0], [0.0, 0.0, 0.1, 0.0], [0.0, 0.0, 0.0, 0.0]])
Q = np.array([[0.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.5, 0.0]])
U, V = np.array([0.01, -0.02, 0.03, 0.05]), np.array([1.0, -0.5, 2.0, 0.3])
LOAD, SHAPE, H = np.array([0.0, -1.0, 0.5, 2.0]), np.array([0.0, 3.0, 0.0, 1.0]), 0.01
FORCE = LOAD + 0.7 * SHAPE  # at t = 0


def body(ct, *, damping=C, **more):
    forcing = (ct.bodies.Forcing(shape=SHAPE, amplitude=lambda t: 0.7 + np.sin(4.0 * t)),)
    given = {"M": np.diag(M), "K": K, "C": damping, "load": LOAD, "forcing": forcing, "displacement": U, "velocity": V}
    return ct.LinearBody(Q=Q, gap0=np.array([0.1, 0.2]), **given | more)


def started(make, law=None, dt=H, **more):
    """A run at t = 0 of the second package, with its body's order of coordinates."""
    with plain() as module:
        ct = module("contact")
        law = ct.Unilateral() if law is None else law(ct)
        run = make(ct).prepare(body(ct, **more), law, dt=dt, courant=None)
    return run, run.system.order


def dense(band, order):
    """A band as a matrix in the body's order."""
    from contact.model.bodies.band import Band, Entries, sparse_form

    A = sparse_form(Band(*band[:3], Entries(*band.sparse))).toarray()
    found = np.zeros_like(A)
    found[np.ix_(order, order)] = A
    return found


def back(values, order):
    """Values along the last axis in the body's order."""
    found = np.zeros_like(values)
    found[..., order] = values
    return found


SCHEMES = {  # A, the factor of A^-1 Q^T, that of W, label
    "explicit": (lambda ct: ct.CentralDifference(), M / H**2 + C / (2 * H), 1.0, 1.0, "central difference + forward"),
    "newmark": (
        lambda ct: ct.Newmark(beta=0.3, gamma=0.55), M + 0.55 * H * C + 0.3 * H**2 * K, 1.0, 0.3 * H**2,
        "Newmark (0.3, 0.55) + Lagrange",
    ),
    "hht": (
        lambda ct: ct.scheme.HHT(alpha=-0.2), M + 0.8 * 0.7 * H * C + 0.8 * 0.36 * H**2 * K, 1.0, 0.36 * H**2,
        "HHT (-0.2) + Lagrange",
    ),
    "moreau": (
        lambda ct: ct.MoreauJean(theta=0.7, restitution=0.4), M + 0.7 * H * C + 0.49 * H**2 * K, 1.0, 1.0,
        "Moreau-Jean, theta = 0.7, e = 0.4",
    ),
    "stabilised": (
        lambda ct: ct.scheme.StabilisedNewmark(), M + 0.5 * H * C + 0.25 * H**2 * K, H, 0.5 * H**2,
        "contact-stabilised",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SCHEMES)
def test_parts_are_the_answers_to_unit_forces(name):
    make, A, factor, scale, label = SCHEMES[name]
    run, order = started(make)
    answers = np.linalg.solve(A, Q.T).T
    np.testing.assert_allclose(back(run.parts.response, order), factor * answers, rtol=1e-11, atol=1e-15)
    np.testing.assert_allclose(run.parts.W, scale * Q @ answers.T, rtol=1e-11)
    for found, exact in ((run.parts.M, M), (run.parts.K, K), (run.parts.C, C)):
        np.testing.assert_allclose(dense(found, order), exact, rtol=1e-13, atol=1e-13)
    assert run.label.startswith(label)
    top = math.sqrt(eigh(K, M, eigvals_only=True)[-1])
    assert f"dt omega_max = {H * top:.3g} ({'limit 2' if run.leapfrog else 'no limit'})" in run.label
    assert run.window == pytest.approx(2.0 * math.pi / top, rel=1e-9)
    acceleration = np.linalg.solve(M, FORCE - C @ V - K @ U)
    np.testing.assert_allclose(back(run.state.u, order), U, rtol=1e-13)
    np.testing.assert_allclose(back(run.state.a, order), acceleration, rtol=1e-11)
    start = H * V - 0.5 * H**2 * acceleration if run.leapfrog else V
    np.testing.assert_allclose(back(run.state.v, order), start, rtol=1e-11)
    speed = start / H if run.leapfrog else V
    old = U - start if run.leapfrog else U
    found = run.stored()
    exact = (0.5 * speed @ M @ speed, 0.5 * old @ K @ U, -0.5 * LOAD @ (U + old))
    assert (found.kinetic, found.strain, found.potential) == pytest.approx(exact, rel=1e-11)
    assert found.discrete == pytest.approx(sum(exact), rel=1e-11)
    assert found.residual == 0.0


def test_the_window_of_a_slow_body_is_its_step():
    run, _ = started(lambda ct: ct.Newmark(), dt=40.0)
    assert run.window == 40.0


def test_weights_of_chung_and_hulbert_and_of_hilber_hughes_taylor():
    for rho in (0.0, 0.6, 1.0):
        w = chung_hulbert(rho)
        am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
        assert (w.am, w.af, w.gamma) == pytest.approx((am, af, 0.5 - am + af), rel=1e-14, abs=1e-16)
        assert w.beta == pytest.approx(0.25 * (1.0 - am + af) ** 2, rel=1e-14)
    with plain() as module:
        weights = module("contact").scheme.HHT(alpha=-0.3).prepare(
            body(module("contact")), module("contact").Unilateral(), dt=H, courant=None
        ).method[1]  # fmt: skip
    assert (weights.am, weights.af, weights.beta, weights.gamma) == pytest.approx((0.0, 0.3, 0.4225, 0.8), rel=1e-14)


@pytest.mark.parametrize("projected", [False, True])
def test_corrections_of_impacts_change_positions_and_speeds_as_whole_matrices_say(projected):
    name = "ProjectedAlpha" if projected else "NonsmoothAlpha"
    run, order = started(lambda ct: getattr(ct.scheme, name)(rho_inf=0.6, restitution=0.3))
    w = chung_hulbert(0.6)
    inside = 1.0 - w.af
    A = (1.0 - w.am) * M + inside * w.gamma * H * C + inside * w.beta * H**2 * K
    jump = np.linalg.solve(M, Q.T).T
    by_speed, by_place = (-inside * np.linalg.solve(A, B @ jump.T).T for B in (C, K))
    assert "rho_inf = 0.6, e = 0.3, dt omega_max" in run.label
    assert run.method[3] == 0.3
    if not projected:
        response = by_speed + 0.5 * H * by_place
        np.testing.assert_allclose(back(run.parts.response, order), response, rtol=1e-10, atol=1e-15)
        np.testing.assert_allclose(back(run.method[2], order), jump, rtol=1e-12)
        np.testing.assert_allclose(run.parts.W, Q @ jump.T + w.gamma * H * Q @ response.T, rtol=1e-11)
        return
    c = run.method[2]
    np.testing.assert_allclose(back(c.jump, order), jump, rtol=1e-12)
    np.testing.assert_allclose(back(c.of_nu, order), by_place, rtol=1e-10, atol=1e-14)
    np.testing.assert_allclose(back(c.of_impulse, order), by_speed, rtol=1e-10, atol=1e-14)
    np.testing.assert_allclose(c.gap_nu, Q @ (jump + w.beta * H**2 * by_place).T, rtol=1e-11)
    np.testing.assert_allclose(c.gap_impulse, w.beta * H**2 * Q @ by_speed.T, rtol=1e-9)
    np.testing.assert_allclose(c.rate_nu, w.gamma * H * Q @ by_place.T, rtol=1e-9)
    np.testing.assert_allclose(c.rate_impulse, Q @ (jump + w.gamma * H * by_speed).T, rtol=1e-11)


def test_the_jump_of_the_stabilised_predictor_is_that_of_the_mass():
    run, order = started(lambda ct: ct.scheme.StabilisedNewmark())
    jump = np.linalg.solve(M, Q.T).T
    np.testing.assert_allclose(back(run.method[1], order), jump, rtol=1e-12)
    np.testing.assert_allclose(run.method[2], Q @ jump.T, rtol=1e-12)


def test_a_contact_spring_counts_in_the_limit_of_explicit_steps():
    top = math.sqrt(eigh(K + 5e3 * Q.T @ Q, M, eigvals_only=True)[-1])
    run, _ = started(lambda ct: ct.PenaltyDifference(), lambda ct: ct.Penalty(stiffness=5e3), dt=1.99 / top)
    assert "dt omega_max = 1.99 (limit 2)" in run.label
    assert run.window == pytest.approx(2.0 * math.pi / math.sqrt(eigh(K, M, eigvals_only=True)[-1]), rel=1e-9)
    with plain() as module:
        errors = module("contact.base.errors")
    with pytest.raises(errors.LimitError, match=r"dt \* omega_max = 2.01, expected <= 2 \(stability of PenaltyDiff"):
        started(lambda ct: ct.PenaltyDifference(), lambda ct: ct.Penalty(stiffness=5e3), dt=2.01 / top)


def test_massless_boundaries_give_their_mass_away_by_stiffness_and_start_at_rest():
    """Coordinate 2 is touched by both contacts, 0 by the second; both lose their mass to 1 and 3."""
    damping = np.diag([0.4, 0.3, 0.1, 0.0])
    run, order = started(lambda ct: ct.scheme.MasslessBoundary(), damping=damping)
    mass, pots = np.zeros(4), np.zeros(4)
    for moved, kept in ((mass, np.diag(M)), (pots, np.diag(damping))):
        moved[1] = kept[1] + kept[0] * 10.0 / 15.0 + kept[2] * 20.0 / 24.0
        moved[3] = kept[3] + kept[0] * 5.0 / 15.0 + kept[2] * 4.0 / 24.0
    np.testing.assert_allclose(dense(run.parts.M, order), np.diag(mass), rtol=1e-12)
    np.testing.assert_allclose(dense(run.parts.C, order), np.diag(pots), rtol=1e-12)
    bare, rest = [0, 2], [1, 3]
    solid = np.where(mass > 0.0, mass, 1.0)
    answers = np.linalg.solve(np.diag(solid / H**2 + pots / (2.0 * H)), Q.T).T
    np.testing.assert_allclose(back(run.parts.response, order), answers, rtol=1e-12)
    static = run.method[1]
    place = order[static.place]
    pick = [int(np.flatnonzero(place == i)[0]) for i in bare]
    flex = np.linalg.inv(K[np.ix_(bare, bare)])
    np.testing.assert_allclose(static.flex[np.ix_(pick, pick)], flex, rtol=1e-11, atol=1e-16)
    lift = Q[:, bare] @ flex
    np.testing.assert_allclose(static.lift[:, pick], lift, rtol=1e-11, atol=1e-16)
    np.testing.assert_allclose(static.S, lift @ Q[:, bare].T, rtol=1e-11)
    for k, i in enumerate(place):
        row = np.zeros(4)
        np.add.at(row, order[static.near[k]], static.stiff[k])
        row[i] = 0.0
        np.testing.assert_allclose(row, np.where(np.arange(4) == i, 0.0, K[i]), rtol=1e-12, atol=1e-13)
        assert static.ground[k] == pytest.approx(K[i].sum(), rel=1e-12)
    # closed contacts hold both massless coordinates: K_mm - K_mc K_cc^-1 K_cm + B^T S^-1 B is K_mm with them fixed
    B = Q[:, rest] - lift @ K[np.ix_(bare, rest)]
    closed = K[np.ix_(rest, rest)] - K[np.ix_(rest, bare)] @ flex @ K[np.ix_(bare, rest)]
    closed += B.T @ np.linalg.inv(static.S) @ B
    top = math.sqrt(eigh(closed, np.diag(mass[rest]), eigvals_only=True)[-1])
    assert f"dt omega_max = {H * top:.3g} (limit 2)" in run.label
    # open gaps: massless coordinates follow without force, the others leapfrog from one step before
    u = U.copy()
    u[bare] = flex @ (FORCE[bare] - K[np.ix_(bare, rest)] @ u[rest])
    np.testing.assert_allclose(back(run.state.u, order), u, rtol=1e-11)
    pull = FORCE - K @ u - pots * V
    before = u - H * V
    before[rest] += 0.5 * H**2 * pull[rest] / mass[rest]
    before[bare] = flex @ (FORCE[bare] - K[np.ix_(bare, rest)] @ before[rest])
    np.testing.assert_allclose(back(run.state.v, order), u - before, rtol=1e-9, atol=1e-14)
