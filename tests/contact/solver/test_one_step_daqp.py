"""The one-step solvers beside a quadratic programming code that shares nothing with them (daqp, a dual active set).

Frictionless: min |y|^2/2 over A y + b >= 0. With friction, de Saxce's change of variable makes the law that of
a convex programme, min f.W f/2 + f.(b + mu |u_T| e_N) over the cones |f_T| <= mu f_N, once the slips u_T are known
(Bipotential method, de Saxce & Feng, Math. Comput. Modelling 28, 1998, 225): the programme with the slips that the
solver found must give back its forces.
"""

import daqp
import numpy as np
import pytest

import contact as ct
from contact import solver

pytestmark = pytest.mark.slow  # they compile loops for seconds


def motion(A, b):
    """Argument y of the least |y| with A y + b >= 0."""
    y, _, flag, _ = daqp.solve(np.eye(A.shape[1]), np.zeros(A.shape[1]), -A, b.copy(), primal_tol=1e-12)
    assert flag == 1
    return y


def problem(rng, contacts, size, kind):
    """Rows, gaps and a motion that opens all; degenerate ones have gaps of exactly zero at the answer."""
    A = rng.standard_normal((contacts, size))
    if kind == "duplicate":
        A[contacts // 2 :] = A[: contacts - contacts // 2]
    y = rng.standard_normal(size)
    slack = np.maximum(rng.standard_normal(contacts), 0.0)
    if kind == "degenerate":
        y = A[:2].T @ np.ones(2)
        slack[:4] = 0.0
    return A, slack, y


def first_step(A, slack, y, **how):
    """Forces of the first step of masses of 1 kg that move by -y in it, h = 1 s: the gaps would be slack - A y."""
    body = ct.LinearBody(M=np.ones(len(y)), K=np.zeros(len(y)), Q=A, gap0=slack, velocity=-y)
    return ct.run(body, t_end=1.0, dt=1.0, **how).force[0]


@pytest.mark.parametrize("kind", ["random", "degenerate", "duplicate"])
@pytest.mark.parametrize(("contacts", "size"), [(4, 9), (12, 5), (40, 8)])
def test_the_active_set_finds_the_least_motion(kind, contacts, size):
    """12 and 40 contacts on 5 and 8 coordinates: W is singular."""
    rng = np.random.default_rng(contacts)
    for _ in range(60):
        A, slack, opens = problem(rng, contacts, size, kind)
        b = slack - A @ opens
        y = motion(A, b)
        found = solver.unilateral(A, b)
        np.testing.assert_allclose(found.y, y, atol=1e-9 * max(np.abs(y).max(), 1.0))
        np.testing.assert_allclose(found.gap, A @ y + b, atol=1e-9 * np.abs(b).max())
        assert found.force @ found.gap <= 1e-9 * np.abs(b).max() * found.force.sum() + 1e-300


@pytest.mark.parametrize("kind", ["random", "duplicate"])
def test_the_first_step_of_a_scheme_with_rigid_contacts_finds_it_too(kind):
    """By central differences the forces of a step move the gaps by h^2 A A^T."""
    rng = np.random.default_rng(44)
    for _ in range(100):
        A, slack, y = problem(rng, 6, 8, kind)
        lam = first_step(A, slack, y, law=ct.Unilateral(), scheme=ct.CentralDifference())
        np.testing.assert_allclose(A.T @ lam, motion(A, slack - A @ y), atol=1e-8)


def test_the_first_step_of_a_scheme_with_penalty_springs_is_a_programme_in_the_forces():
    """By the average acceleration, beta = 1/4; the spring is not compressed before the step."""
    rng = np.random.default_rng(45)
    for _ in range(100):
        A, slack, y = problem(rng, 5, 3, "random")
        law = ct.Penalty(stiffness=4.0)
        lam = first_step(A, slack, y, law=law, scheme=ct.scheme.Newmark(), on_limit="flag")
        W = 0.25 * A @ A.T + 0.25 * np.eye(5)
        force, _, flag, _ = daqp.solve(W, slack - A @ y, np.zeros((0, 5)), np.full(5, 1e30), np.zeros(5))
        assert flag == 1
        np.testing.assert_allclose(lam, force, atol=1e-9 * max(force.max(), 1.0))


def least_distance(W, b, mu, found):
    """Forces of the programme above; the cone is cut by planes, one of them against the solver's slip."""
    contacts, dim = b.shape
    slips = np.linalg.norm(found.motion[:, 1:], axis=1)
    shifted = b.copy()
    shifted[:, 0] += mu * slips
    planes = []
    for k in range(contacts):
        directions = [[1.0], [-1.0]]
        if dim == 3:
            own = [-found.motion[k, 1:] / slips[k]] if slips[k] > 1e-12 else []
            angles = np.arange(12) * np.pi / 6.0
            directions = [*np.stack([np.cos(angles), np.sin(angles)], axis=1), *own]
        for direction in directions:
            plane = np.zeros((contacts, dim))
            plane[k, 0], plane[k, 1:] = -mu, direction
            planes.append(plane.ravel())
    normal = np.kron(np.eye(contacts), -np.eye(dim)[:1])
    cuts = np.vstack([planes, normal])
    force, _, flag, _ = daqp.solve(W, shifted.ravel(), cuts, np.zeros(len(cuts)), primal_tol=1e-12)
    assert flag == 1
    return force.reshape(b.shape)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("mu", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("kind", ["open", "closed", "mixed"])
def test_friction_solves_the_programme_that_its_slips_make(dim, mu, kind):
    rng = np.random.default_rng(46)
    slipped = stuck = 0
    for _ in range(25):
        A, b = np.eye(4 * dim) + 0.15 * rng.standard_normal((4 * dim, 4 * dim)), rng.standard_normal((4, dim))
        if kind != "mixed":
            b[:, 0] = np.abs(b[:, 0]) * (1.0 if kind == "open" else -1.0)
        W = A @ A.T
        found = solver.coulomb(W, b, mu)
        np.testing.assert_allclose(least_distance(W, b, mu, found), found.force, atol=1e-8 * np.abs(b).max())
        pressing = found.force[:, 0] > 1e-9
        moving = np.linalg.norm(found.motion[:, 1:], axis=1) > 1e-9
        slipped, stuck = slipped + np.sum(pressing & moving), stuck + np.sum(pressing & ~moving)
    assert slipped + stuck == 0 if kind == "open" else slipped > 0
    assert stuck > 0 or mu < 2.0 or kind == "open"


def test_without_friction_it_is_the_least_motion_of_the_normals():
    rng = np.random.default_rng(47)
    for _ in range(50):
        A, b = rng.standard_normal((6, 9)), rng.standard_normal((3, 2))
        found = solver.coulomb(A @ A.T, b, 0.0)
        np.testing.assert_allclose(A[::2].T @ found.force[:, 0], motion(A[::2], b[:, 0]), atol=1e-8)
