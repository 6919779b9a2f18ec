"""One-step problems: the active set and the friction solver against pivoting, closed forms and degenerate cases.

These tests call the solvers themselves: the coupling that makes a problem hard is drawn, which no body offers.
"""

import re

import numpy as np
import pytest

import contact as ct
from contact import solver
from contact.solver.friction.all_sliding import all_sliding_start
from contact.solver.friction.room import friction_room
from tests.contact.solver.lemke import lemke

pytestmark = pytest.mark.slow  # they compile loops for seconds


def random_rows(rng, contacts, size, digits=4.0):
    """Rows whose Delassus matrix is conditioned up to 10^(2 digits), half of them repeated half of the time."""
    u, _, v = np.linalg.svd(rng.standard_normal((contacts, size)), full_matrices=False)
    A = u * 10.0 ** (-digits * rng.random() * np.linspace(0.0, 1.0, min(contacts, size))) @ v
    if contacts > 2 and rng.random() < 0.5:
        A[contacts // 2 :] = A[: contacts - contacts // 2]
    return A


def residual(A, b, force):
    """max|min(W_ii force_i, gap_i)| of its scale."""
    own = np.sum(A**2, axis=1) * force
    return np.abs(np.minimum(own, A @ (A.T @ force) + b)).max() / max(np.abs(b).max(), own.max())


def test_random_and_degenerate_problems_are_all_solved():
    rng = np.random.default_rng(20)
    for _ in range(500):
        A = random_rows(rng, int(rng.integers(1, 13)), int(rng.integers(1, 9)))
        slack = np.maximum(rng.standard_normal(len(A)), 0.0) * (rng.random(len(A)) < rng.random())
        b = slack - A @ rng.standard_normal(A.shape[1])
        force = solver.unilateral(A, b).force
        assert force.min() >= 0.0
        assert residual(A, b, force) <= 1e-10


def test_forces_equal_pivoting_where_they_are_unique():
    rng = np.random.default_rng(21)
    for _ in range(200):
        A = rng.standard_normal((5, 7))
        b = rng.standard_normal(5)
        np.testing.assert_allclose(solver.unilateral(A, b).force, lemke(A @ A.T, b), atol=1e-9)


def test_five_thousand_candidates_on_a_hundred_modes():
    rng = np.random.default_rng(22)
    A = rng.standard_normal((5000, 100))
    b = np.maximum(rng.standard_normal(5000), 0.0) - A @ rng.standard_normal(100)
    found = solver.unilateral(A, b)
    assert residual(A, b, found.force) <= 1e-12
    assert 20 < np.count_nonzero(found.force) <= 100
    np.testing.assert_allclose(found.y, A.T @ found.force, atol=1e-12)


def test_contacts_wedged_without_compliance_are_refused():
    with pytest.raises(ct.NumericsError, match="press against each other"):
        solver.unilateral(np.array([[1.0], [-1.0]]), np.array([-1.0, 0.5]))


@pytest.mark.parametrize(
    ("A", "b", "word"),
    [
        (np.eye(2), np.zeros(3), "shapes"),
        (np.ones(2), np.zeros(2), "shapes"),
        (np.array([[np.nan, 1.0], [1.0, 0.0]]), np.zeros(2), "finite"),
        (np.eye(2), np.array([0.0, np.inf]), "finite"),
    ],
)
def test_bad_arrays_are_named(A, b, word):
    with pytest.raises(ct.InputError, match=word):
        solver.unilateral(A, b)


def test_states_of_contacts_with_friction_along_one_line_are_found():
    """The path finds open, slipping and sticking contacts from none, and stays where it is right."""
    rng, states = np.random.default_rng(23), np.zeros(3, dtype=int)
    for _ in range(100):
        k = int(rng.integers(2, 30))
        rows, mu, b = (
            rng.standard_normal((2 * k, 2 * k)),
            np.full(k, rng.uniform(0.05, 0.8)),
            rng.standard_normal(2 * k),
        )
        W, force, room = rows @ rows.T + 0.5 * np.eye(2 * k), np.zeros(2 * k), friction_room(k, 2)
        assert all_sliding_start(W, b, mu, 2, k, force, room)
        scale = np.abs(force).max() + 1.0
        u, found = (W @ force + b).reshape(k, 2), force.reshape(k, 2)
        radius, slips = mu * found[:, 0], np.abs(u[:, 1]) > 1e-9
        assert np.abs(np.minimum(found[:, 0], u[:, 0])).max() <= 1e-10 * scale
        assert (np.abs(found[:, 1]) - radius).max() <= 1e-10 * scale
        assert np.abs(found[slips, 1] + radius[slips] * np.sign(u[slips, 1])).max(initial=0.0) <= 1e-10 * scale
        closed = found[:, 0] > 0.0
        states += [(~closed).sum(), (closed & slips).sum(), (closed & ~slips).sum()]
        again = force.copy()
        assert all_sliding_start(W, b, mu, 2, k, again, room)
        np.testing.assert_allclose(again, force, rtol=0.0, atol=1e-10 * scale)
    assert states.min() > 100


def coulomb_law_holds(found, mu, scale):
    normal, tangent = found.force[:, 0], found.force[:, 1:]
    assert normal.min() >= -1e-10 * scale
    assert np.abs(np.minimum(normal, found.motion[:, 0])).max() <= 1e-10 * scale
    length = np.linalg.norm(tangent, axis=1)
    assert (length - mu * normal).max() <= 1e-10 * scale
    sliding = np.linalg.norm(found.motion[:, 1:], axis=1) > 1e-8 * scale
    slip = found.motion[sliding, 1:]
    against = -mu * normal[sliding, None] * slip / np.linalg.norm(slip, axis=1, keepdims=True)
    np.testing.assert_allclose(tangent[sliding], against, atol=1e-8 * scale)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("mu", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("kind", ["open", "closed", "mixed", "duplicate"])
def test_friction_in_every_state(dim, mu, kind):
    rng = np.random.default_rng(int(100 * mu) + 7 * dim)
    worst = 0
    for _ in range(50):
        A = np.eye(4 * dim) + 0.15 * rng.standard_normal((4 * dim, 4 * dim))
        b = rng.standard_normal((4, dim))
        if kind == "open":
            b[:, 0] = np.abs(b[:, 0])
        elif kind == "closed":
            b[:, 0] = -np.abs(b[:, 0])
        elif kind == "duplicate":
            A[2 * dim :], b[2:] = A[: 2 * dim], b[:2]
        found = solver.coulomb(A @ A.T, b, mu)
        scale = np.abs(b).max()
        coulomb_law_holds(found, mu, scale)
        assert not (kind == "open" and found.force.any())
        worst = max(worst, found.iterations)
    assert worst <= 20


def test_without_friction_it_is_the_unilateral_problem():
    rng = np.random.default_rng(24)
    A, b = rng.standard_normal((9, 12)), rng.standard_normal((3, 3))
    found = solver.coulomb(A @ A.T, b, 0.0)
    np.testing.assert_allclose(found.force[:, 0], solver.unilateral(A[::3], b[:, 0]).force, atol=1e-10)
    assert not found.force[:, 1:].any()


def test_a_warm_start_at_the_solution_takes_no_iteration():
    rng = np.random.default_rng(25)
    A = np.eye(9) + 0.2 * rng.standard_normal((9, 9))
    b = -np.abs(rng.standard_normal((3, 3)))
    first = solver.coulomb(A @ A.T, b, 0.4)
    assert first.iterations > 0
    assert solver.coulomb(A @ A.T, b, 0.4, start=first.force).iterations == 0


def test_a_single_contact_is_solved_however_badly_conditioned():
    rng = np.random.default_rng(26)
    for _ in range(500):
        u, _, v = np.linalg.svd(rng.standard_normal((3, 3)))
        A = u * np.array([1.0, 10.0 ** -(2.0 * rng.random()), 10.0 ** -(2.0 + 2.0 * rng.random())]) @ v
        b = rng.standard_normal((1, 3))
        found = solver.coulomb(A @ A.T, b, rng.choice([0.3, 1.0, 2.0]))
        assert found.residual <= 1e-12


def close_contacts(rng):
    """Friction problems whose contacts are coupled so closely that W is conditioned to 1e8."""
    contacts, dim = int(rng.integers(2, 7)), int(rng.integers(2, 4))
    u, _, v = np.linalg.svd(rng.standard_normal((contacts * dim, contacts * dim)))
    A = u * 10.0 ** (-4.0 * rng.random() * np.linspace(0.0, 1.0, contacts * dim)) @ v
    return A @ A.T, rng.standard_normal((contacts, dim))


def test_where_newton_ends_at_a_kink_pivoting_finds_the_way():
    rng = np.random.default_rng(27)
    for _ in range(400):
        W, b = close_contacts(rng)
        found = solver.coulomb(W, b, 2.0)
        rho = np.repeat(1.0 / W.diagonal()[:: b.shape[1]], b.shape[1]).reshape(b.shape)
        scale = max(np.abs(found.force).max(), np.abs(rho * b).max())
        normal, tangent = found.force[:, 0], found.force[:, 1:]
        assert np.abs(np.minimum(normal, rho[:, 0] * found.motion[:, 0])).max() <= 1e-11 * scale
        assert (np.linalg.norm(tangent, axis=1) - 2.0 * normal).max() <= 1e-11 * scale


def test_a_contact_without_free_motion_that_others_press_is_solved():
    rng, pressed = np.random.default_rng(30), 0
    for _ in range(50):
        A = np.eye(6) + 0.3 * rng.standard_normal((6, 6))
        found = solver.coulomb(A @ A.T, [[0.0, 0.0], [-1.0, 0.5], [-2.0, 0.0]], 0.3)
        assert found.left <= 1e-10
        pressed += found.force[0, 0] > 0.0
    assert pressed > 5


@pytest.mark.parametrize(
    ("W", "b", "mu", "word"),
    [
        (np.eye(4), np.zeros((1, 4)), 0.1, "d = 2 or 3"),
        (np.eye(2), np.zeros((1, 2)), -0.1, "mu"),
        (np.diag([1.0, 0.0]), np.zeros((1, 2)), 0.1, "diagonal"),
        (np.eye(2), np.array([[np.inf, 0.0]]), 0.1, "finite"),
    ],
)
def test_bad_friction_problems_are_named(W, b, mu, word):
    with pytest.raises(ct.InputError, match=word):
        solver.coulomb(W, b, mu)


@pytest.mark.parametrize("c", [1.0, 1.5])
def test_where_contacts_that_close_each_other_have_no_forces_it_is_reported_that_there_may_be_none(c):
    W = np.kron(np.array([[1.0, -c], [-c, 1.0]]), np.eye(2))
    with pytest.raises(ct.NumericsError, match=r"friction: found residual .*: contacts that close each"):
        solver.coulomb(W, np.array([[-1.0, 0.0], [-1.0, 0.0]]), 0.1)


@pytest.mark.parametrize("dim", [2, 3])
def test_contacts_that_close_each_other_have_forces_until_they_do_it_more_than_they_open(dim):
    """Each of two opens by its own force, is closed by a part c of the other's: 1/(1 - c), and none from c = 1 on."""
    b = np.zeros((2, dim))
    b[:, 0] = -1.0
    for c in (0.5, 0.99, 1.0, 1.01):
        W = np.eye(2 * dim)
        W[0, dim] = W[dim, 0] = -c
        if c < 1.0:
            assert solver.coulomb(W, b, 0.0).force[:, 0] == pytest.approx(1.0 / (1.0 - c), rel=1e-12)
            continue
        with pytest.raises(
            ct.NumericsError,
            match=r"^friction: found residual .* after \d+ iterations, expected at "
            r"most 1e-12:",
        ):
            solver.coulomb(W, b, 0.0)


def motion_error(W, b, mu, force):
    """Largest distance from the law as a motion, over the free motion of its contact, independent of the solver's."""
    sums = W.astype(np.longdouble) @ force.ravel()  # forces nearly cancel: rounding of these sums is not the solver's
    u, d, worst = np.asarray(sums.reshape(b.shape) + b, float), b.shape[1], 0.0
    for k in range(len(b)):
        i, own = k * d, np.abs(b[k]).max()
        normal = W[i, i]
        tangent = np.linalg.eigvalsh(W[i + 1 : i + d, i + 1 : i + d]).max()
        pressed = max(force[k, 0] - u[k, 0] / normal, 0.0)
        aim = force[k, 1:] - u[k, 1:] / tangent
        held = aim * min(1.0, mu * pressed / max(np.linalg.norm(aim), 1e-300))
        worst = max(worst, abs(force[k, 0] - pressed) * normal / own, np.abs(force[k, 1:] - held).max() * tangent / own)
    return worst


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("cond", [1e6, 1e10, 1e12])
def test_closely_coupled_contacts_are_solved_in_motion_too_or_it_is_reported(cond, dim):
    """Few modes behind many contacts: forces nearly cancel, and 1e-12 of the largest was up to 0.4 of the motion."""
    rng, solved, said = np.random.default_rng(7), 0, []
    for _ in range(30):
        c = int(rng.integers(2, 7))
        A = rng.standard_normal((c * dim, max(3, c * dim // 3)))
        W = A @ A.T / (c * dim) + np.eye(c * dim) / cond
        b = rng.standard_normal((c, dim)) - np.eye(dim)[0]
        try:
            found = solver.coulomb(W, b, 0.3)
        except ct.NumericsError as error:
            said.append(str(error))
            continue
        solved += 1
        assert found.left <= 1e-6
        assert motion_error(W, b, 0.3, found.force) <= 1.5 * max(found.left, 1e-10)  # `left` counts its sums' round-off
    assert solved >= (30 if cond == 1e6 else 20)
    words = (
        r"friction: (found residual .* at most 1e-12: .*|the contact forces have an error of (\S*) of a contact's .*)"
    )
    left = [re.fullmatch(words, one)[2] for one in said]
    assert all(one is None or float(one) >= 1e-6 for one in left)
    assert any(left) == (cond > 1e6)


@pytest.mark.parametrize("dim", [2, 3])
def test_contacts_that_yield_by_powers_of_ten_more_are_as_exact_as_the_others(dim):
    rng = np.random.default_rng(11)
    for _ in range(60):
        c = int(rng.integers(2, 7))
        U, _ = np.linalg.qr(rng.standard_normal((c * dim, c * dim)))
        yields = np.repeat(np.geomspace(1.0, 1e6, c), dim)
        W = (U * np.geomspace(1.0, 0.1, c * dim)) @ U.T * yields[:, None] * yields
        b = (rng.standard_normal((c, dim)) - np.eye(dim)[0]) * np.geomspace(1.0, 1e6, c)[:, None]
        assert motion_error(W, b, 0.3, solver.coulomb(W, b, 0.3).force) <= 1e-9
