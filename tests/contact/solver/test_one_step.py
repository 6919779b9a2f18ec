"""One-step problems: the active set and the friction solver against pivoting, closed forms and degenerate cases."""

import re

import numpy as np
import pytest

import contact as ct
from contact.jit.compiled import entry
from contact.solver.friction.all_sliding import all_sliding_start
from contact.solver.friction.coulomb import against_slip, coulomb, covering, polyhedral_cone, solver_room
from contact.solver.friction.coulomb import lemke as pivoting
from contact.solver.friction.newton import MOST_ITERATIONS
from contact.solver.friction.room import INNER, MISS, STEP, TRIAL
from contact.solver.unilateral.active_set import delassus_rows, unilateral
from tests.contact.solver.lemke import lemke

slide_all = entry(all_sliding_start)  # compiled as a whole, as loops have it

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
    for _ in range(3000):
        A = random_rows(rng, int(rng.integers(1, 13)), int(rng.integers(1, 9)))
        slack = np.maximum(rng.standard_normal(len(A)), 0.0) * (rng.random(len(A)) < rng.random())
        b = slack - A @ rng.standard_normal(A.shape[1])
        force = unilateral(A, b).force
        assert force.min() >= 0.0
        assert residual(A, b, force) <= 1e-10


def test_forces_equal_pivoting_where_they_are_unique():
    rng = np.random.default_rng(21)
    for _ in range(200):
        A = rng.standard_normal((5, 7))
        b = rng.standard_normal(5)
        np.testing.assert_allclose(unilateral(A, b).force, lemke(A @ A.T, b), atol=1e-9)


def test_five_thousand_candidates_on_a_hundred_modes():
    rng = np.random.default_rng(22)
    A = rng.standard_normal((5000, 100))
    b = np.maximum(rng.standard_normal(5000), 0.0) - A @ rng.standard_normal(100)
    found = unilateral(A, b)
    assert residual(A, b, found.force) <= 1e-12
    assert 20 < np.count_nonzero(found.force) <= 100
    np.testing.assert_allclose(found.y, A.T @ found.force, atol=1e-12)


def test_a_delassus_matrix_gives_its_rows():
    rng = np.random.default_rng(23)
    A = rng.standard_normal((6, 3))
    W, b = A @ A.T, -np.abs(rng.standard_normal(3)) @ A.T
    np.testing.assert_allclose(W @ unilateral(delassus_rows(W), b).force, W @ unilateral(A, b).force, atol=1e-12)


def test_contacts_wedged_without_compliance_are_refused():
    with pytest.raises(ct.NumericsError, match="press against each other"):
        unilateral(np.array([[1.0], [-1.0]]), np.array([-1.0, 0.5]))


def test_walls_too_close_by_round_off_alone_do_not_wedge():
    """A unit that two walls touch at once: 1e-10 of the motion and of the gap is taken for round-off."""
    wedged = np.array([[1.0], [-1.0]])
    found = unilateral(wedged, np.array([-1.0, 1.0 - 1.9e-10]))
    assert found.force.tolist() == [1.0, 0.0]
    with pytest.raises(
        ct.NumericsError, match=r"^no motion opens all gaps at once: contacts press .* without compliance$"
    ):
        unilateral(wedged, np.array([-1.0, 1.0 - 2.1e-10]))


@pytest.mark.parametrize(
    ("A", "b", "word"),
    [(np.eye(2), np.zeros(3), "shapes"), (np.array([[np.nan]]), np.zeros(1), "finite")],
)
def test_bad_arrays_are_named(A, b, word):
    with pytest.raises(ct.InputError, match=word):
        unilateral(A, b)


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
        found = coulomb(A @ A.T, b, mu)
        scale = np.abs(b).max()
        coulomb_law_holds(found, mu, scale)
        assert not (kind == "open" and found.force.any())
        worst = max(worst, found.iterations)
    assert worst <= 20


def test_without_friction_it_is_the_unilateral_problem():
    rng = np.random.default_rng(24)
    A, b = rng.standard_normal((9, 12)), rng.standard_normal((3, 3))
    found = coulomb(A @ A.T, b, 0.0)
    np.testing.assert_allclose(found.force[:, 0], unilateral(A[::3], b[:, 0]).force, atol=1e-10)
    assert not found.force[:, 1:].any()


def test_a_warm_start_at_the_solution_takes_no_iteration():
    rng = np.random.default_rng(25)
    A = np.eye(9) + 0.2 * rng.standard_normal((9, 9))
    b = -np.abs(rng.standard_normal((3, 3)))
    first = coulomb(A @ A.T, b, 0.4)
    assert first.iterations > 0
    assert coulomb(A @ A.T, b, 0.4, start=first.force).iterations == 0


def test_a_single_contact_is_solved_however_badly_conditioned():
    rng = np.random.default_rng(26)
    for _ in range(500):
        u, _, v = np.linalg.svd(rng.standard_normal((3, 3)))
        A = u * np.array([1.0, 10.0 ** -(2.0 * rng.random()), 10.0 ** -(2.0 + 2.0 * rng.random())]) @ v
        b = rng.standard_normal((1, 3))
        found = coulomb(A @ A.T, b, rng.choice([0.3, 1.0, 2.0]))
        assert found.residual <= 1e-12


def close_contacts(rng):
    """Friction problems whose contacts are coupled so closely that W is conditioned to 1e8."""
    contacts, dim = int(rng.integers(2, 7)), int(rng.integers(2, 4))
    u, _, v = np.linalg.svd(rng.standard_normal((contacts * dim, contacts * dim)))
    A = u * 10.0 ** (-4.0 * rng.random() * np.linspace(0.0, 1.0, contacts * dim)) @ v
    return A @ A.T, rng.standard_normal((contacts, dim))


def test_where_newton_ends_at_a_kink_pivoting_finds_the_way():
    rng, hard = np.random.default_rng(27), 0
    for _ in range(800):
        W, b = close_contacts(rng)
        found = coulomb(W, b, 2.0)
        rho = np.repeat(1.0 / W.diagonal()[:: b.shape[1]], b.shape[1]).reshape(b.shape)
        scale = max(np.abs(found.force).max(), np.abs(rho * b).max())
        normal, tangent = found.force[:, 0], found.force[:, 1:]
        assert np.abs(np.minimum(normal, rho[:, 0] * found.motion[:, 0])).max() <= 1e-11 * scale
        assert (np.linalg.norm(tangent, axis=1) - 2.0 * normal).max() <= 1e-11 * scale
        hard += found.iterations > MOST_ITERATIONS
    assert hard > 5


def test_a_contact_without_free_motion_that_others_press_is_solved():
    rng, pressed = np.random.default_rng(30), 0
    for _ in range(50):
        A = np.eye(6) + 0.3 * rng.standard_normal((6, 6))
        found = coulomb(A @ A.T, [[0.0, 0.0], [-1.0, 0.5], [-2.0, 0.0]], 0.3)
        assert found.left <= 1e-10
        pressed += found.force[0, 0] > 0.0
    assert pressed > 5


@pytest.mark.parametrize("mu", [0.0, 0.4, 2.0])
def test_two_facets_are_exact_in_two_dimensions(mu):
    rng = np.random.default_rng(28)
    for _ in range(50):
        A, b = np.eye(8) + 0.15 * rng.standard_normal((8, 8)), rng.standard_normal(8)
        force = polyhedral_cone(A @ A.T, b, np.full(4, mu), 2, np.zeros(4), 0.0, 0)
        np.testing.assert_allclose(force, coulomb(A @ A.T, b.reshape(4, 2), mu).force.ravel(), atol=1e-9)


def test_facets_close_to_the_slip_converge_with_the_square_of_their_distance():
    b, mu = np.array([-1.0, -2.0, 0.7]), np.array([0.5])
    W = np.array([[1.0, 0.2, 0.1], [0.2, 1.5, 0.3], [0.1, 0.3, 0.8]])
    exact = coulomb(W, b.reshape(1, 3), mu)
    slip = -exact.motion[0, 1:]
    errors = []
    for spread in (0.2, 0.1, 0.05):
        force = polyhedral_cone(W, b, mu, 3, np.array([np.arctan2(slip[1], slip[0]) + 0.5 * spread]), spread, 0)
        errors.append(np.abs(force - exact.force[0]).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.2)


def test_covering_vectors_are_ones_and_then_all_different_between_one_and_two():
    assert covering(5, 0).tolist() == [1.0] * 5
    draws = np.array([covering(5, draw) for draw in (1, 2, 3)])
    assert draws.min() > 1.0
    assert draws.max() < 2.0
    assert all(len(np.unique(draw.round(6))) == 5 for draw in draws)
    np.testing.assert_allclose((draws[0, 1:] - draws[0, :-1]) % 1.0, draws[0, 0] % 1.0, rtol=1e-12)


@pytest.mark.parametrize("draw", [0, 3])
def test_pivoting_from_any_covering_vector_is_the_reference(draw):
    rng = np.random.default_rng(29)
    for _ in range(50):
        A, q = rng.standard_normal((6, 9)), rng.standard_normal(6)
        np.testing.assert_allclose(pivoting(A @ A.T, q, covering(6, draw)), lemke(A @ A.T, q), atol=1e-9)
    assert pivoting(np.array([[-1.0]]), np.array([-1.0]), np.ones(1)) is None  # no z >= 0 has 0 <= -z - 1


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
        coulomb(W, b, mu)


@pytest.mark.parametrize("c", [1.0, 1.5])
def test_where_contacts_that_close_each_other_have_no_forces_it_is_said_that_there_may_be_none(c):
    W = np.kron(np.array([[1.0, -c], [-c, 1.0]]), np.eye(2))
    with pytest.raises(
        ct.NumericsError, match=r"friction: residual .*: there may be no solution; contacts that close each"
    ):
        coulomb(W, np.array([[-1.0, 0.0], [-1.0, 0.0]]), 0.1)


@pytest.mark.parametrize("dim", [2, 3])
def test_contacts_that_close_each_other_have_forces_until_they_do_it_more_than_they_open(dim):
    """Each of two opens by its own force, is closed by a part c of the other's: 1/(1 - c), and none from c = 1 on."""
    b = np.zeros((2, dim))
    b[:, 0] = -1.0
    for c in (0.5, 0.99, 1.0, 1.01):
        W = np.eye(2 * dim)
        W[0, dim] = W[dim, 0] = -c
        if c < 1.0:
            assert coulomb(W, b, 0.0).force[:, 0] == pytest.approx(1.0 / (1.0 - c), rel=1e-12)
            continue
        with pytest.raises(ct.NumericsError, match=r"^friction: residual .* after \d+ iterations, wanted 1e-12: there"):
            coulomb(W, b, 0.0)


@pytest.mark.parametrize("dim", [2, 3])
def test_sliding_contacts_are_solved_by_their_normals_alone(dim):
    """All slide fast: the start is the solution; something sticks: the start is left alone."""
    rng = np.random.default_rng(23)
    for _ in range(20):
        half = rng.standard_normal((8 * dim, 8 * dim))
        W = half @ half.T / (8 * dim) + 0.5 * np.eye(8 * dim)
        b = rng.standard_normal((8, dim))
        b[:, 1] += 1e5
        force = np.zeros(8 * dim)
        slide_all(W, b.ravel(), np.full(8, 0.1), dim, 8, force, solver_room(8, dim))
        exact = coulomb(W, b, 0.1)
        assert exact.force[:, 0].max() > 0.0
        assert np.allclose(force, exact.force.ravel(), rtol=0.0, atol=1e-10 * np.abs(exact.force).max())
    stuck = np.full(dim, -1.0)
    start = np.zeros(dim)
    slide_all(np.eye(dim), stuck, np.array([9.0]), dim, 1, start, solver_room(1, dim))
    assert np.array_equal(start, np.zeros(dim))


@pytest.mark.parametrize("count", [3, 7, 15])
def test_which_sliding_contacts_press_is_found_where_exchanging_all_that_is_wrong_goes_round(count):
    """Each contact opens the one before it twice as far as itself (Murty's example): exactly a third presses on each.

    From one that pressed alone, whole sets of wrong ones are exchanged in a circle.
    """
    W, b, mu = np.eye(2 * count), np.tile([-1.0, 1e3], count), np.full(count, 1e-3)
    W[::2, ::2] += 2.0 * np.roll(np.eye(count), 1, axis=1)
    force = np.zeros(2 * count)
    force[0] = 1.0
    assert slide_all(W, b, mu, 2, count, force, solver_room(count, 2))
    assert force == pytest.approx(np.tile([1.0, -1e-3], count) / 3.0, rel=1e-12)


def six_slow_tips(rng):
    """W, b and forces of another direction, of six tips that move together, and slip as slowly as friction drags."""
    rigid, own = np.tile(np.eye(3), (6, 1)), 0.02 * rng.standard_normal((18, 18))
    W = rigid @ np.diag([1.0, 2.0, 1.5]) @ rigid.T + own @ own.T + 1e-3 * np.eye(18)
    to, old = rng.uniform(0.0, 2.0 * np.pi, 2)
    b = np.array([-1.0, 0.5 * np.cos(to), 0.5 * np.sin(to)]) + 0.01 * rng.standard_normal((6, 3))
    return W, b, np.tile([0.3, -0.06 * np.cos(old), -0.06 * np.sin(old)], 6)


def test_slip_that_friction_could_turn_round_is_led_to_its_direction():
    """Six tips that move together, from forces of another direction: Newton's method takes two steps, not nine.

    The start is then within 4e-4 of the forces (2e-4 seen; 6e-4 where what friction itself takes is left out of one
    direction).
    """
    rng = np.random.default_rng(3)
    for _ in range(20):
        W, b, start = six_slow_tips(rng)
        force = start.copy()
        slide_all(W, b.ravel(), np.full(6, 0.2), 3, 6, force, solver_room(6, 3))
        led, alone = (coulomb(W, b, 0.2, one.reshape(6, 3)) for one in (force, start))
        assert led.iterations <= 2 < 3 < alone.iterations
        assert np.abs(force - led.force.ravel()).max() <= 4e-4 * led.force.max()
        assert np.abs(led.force - alone.force).max() <= 1e-9 * alone.force.max()


def test_a_start_does_not_depend_on_what_was_solved_before():
    """A loop keeps one room for all its steps; a run that is continued begins with another."""
    rng, used = np.random.default_rng(3), solver_room(6, 3)
    for _ in range(4):
        W, b, start = six_slow_tips(rng)
        again, fresh = start.copy(), start.copy()
        for force, room in ((again, used), (fresh, solver_room(6, 3))):
            assert slide_all(W, b.ravel(), np.full(6, 0.2), 3, 6, force, room)
        np.testing.assert_array_equal(again, fresh)


def test_a_fault_inside_pivoting_is_no_solution(monkeypatch):
    """Compiled loops call it by its address, where an exception would come back as a residual of zero."""

    def fails(*_):
        raise np.linalg.LinAlgError

    monkeypatch.setattr("contact.solver.friction.coulomb.pivoted", fails)
    assert np.isnan(solver_room(1, 2).otherwise.call(1, 2, 0))


@pytest.mark.parametrize(("sweeps", "part"), [(0, "coulomb.pivoted"), (3, "room.sweep")])
def test_ctrl_c_inside_a_loop_ends_it_and_is_raised_after_it(monkeypatch, sweeps, part):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"contact.solver.friction.{part}", interrupted)
    otherwise = solver_room(1, 2).otherwise
    otherwise.pass_on()
    assert np.isnan(otherwise.call(1, 2, sweeps))
    assert np.isnan(otherwise.call(1, 2, 1 - min(sweeps, 1)))
    with pytest.raises(KeyboardInterrupt):
        otherwise.pass_on()


def test_a_sweep_solves_contacts_that_do_not_feel_each_other():
    """One pressed and sticking, one slipping at its cone, one open; sweeps are called back through Python too."""
    room = solver_room(3, 2)
    room.matrices[INNER] = np.diag([2.0, 1.0, 2.0, 1.0, 2.0, 1.0])
    room.vectors[MISS] = [-2.0, 0.1, -2.0, 3.0, 1.0, 5.0]
    room.vectors[STEP, :3] = 0.5
    room.vectors[TRIAL] = 7.0
    assert room.otherwise.call(3, 2, 1) == 0.0
    np.testing.assert_allclose(room.vectors[TRIAL], [1.0, -0.1, 1.0, -0.5, 0.0, 0.0], rtol=1e-3)


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
def test_closely_coupled_contacts_are_solved_in_motion_too_or_it_is_said(cond, dim):
    """Few modes behind many contacts: forces nearly cancel, and 1e-12 of the largest was up to 0.4 of the motion."""
    rng, solved, said = np.random.default_rng(7), 0, []
    for _ in range(60):
        c = int(rng.integers(2, 7))
        A = rng.standard_normal((c * dim, max(3, c * dim // 3)))
        W = A @ A.T / (c * dim) + np.eye(c * dim) / cond
        b = rng.standard_normal((c, dim)) - np.eye(dim)[0]
        try:
            found = coulomb(W, b, 0.3)
        except ct.NumericsError as error:
            said.append(str(error))
            continue
        solved += 1
        assert found.left <= 1e-6
        assert motion_error(W, b, 0.3, found.force) <= 1.5 * max(found.left, 1e-10)  # `left` counts its sums' round-off
    assert solved >= (60 if cond == 1e6 else 40)
    words = (
        "friction: (residual .* wanted 1e-12: .*|forces leave (.*) of a contact's motion in a step: .* let contacts .*)"
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
        assert motion_error(W, b, 0.3, coulomb(W, b, 0.3).force) <= 1e-9


def test_a_singular_last_basis_is_no_solution():
    """Lemke's path ends on a basis that numpy calls singular: None, as on a ray, and no error of numpy's."""
    M = np.array([[1e179, 1e179], [2e-270, 0.0]])
    assert pivoting(M, np.array([-2.0, -1.0]), np.ones(2)) is None


def test_facets_turn_against_the_slip_of_contacts_that_slip():
    u = np.array([0.0, 3.0, -4.0, 0.0, 0.0, 0.0, 0.2, -1.0, 2.0])
    turn = against_slip(u, 3, np.array([0.1, 0.2, 0.3]))
    for k in (0, 2):
        slip = u[3 * k + 1 : 3 * k + 3]
        np.testing.assert_allclose([np.cos(turn[k]), np.sin(turn[k])], -slip / np.linalg.norm(slip), atol=1e-15)
    assert turn[1] == 0.2
