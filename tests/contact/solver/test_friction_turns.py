"""Where the path to a set of closed contacts turns back; forces and residuals of any size; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import names

SETS = names("solver.unilateral.complementarity")
N = names("solver.friction.all_sliding", "solver.friction.newton", "solver.friction.coulomb")


def pressed(A, gap, closed):
    """Whether normals are found from these closed contacts, and which."""
    n, room = len(gap), N.solver_room(len(gap), 2)
    room.vectors[N.NORMAL, :n], room.vectors[N.GAP, :n], room.whole[N.CLOSED, :n] = closed, gap, closed
    return N.press(np.array(A), n, room), room.vectors[N.NORMAL, :n], room.whole[N.CLOSED, :n].tolist()


@pytest.mark.parametrize("swapped", [False, True])
def test_a_path_that_turns_back_is_followed(swapped):
    """Contacts that press each other more than themselves: the one that begins closed opens on the way, at tau > 0."""
    A, gap, closed = np.array([[1.0, 1.25], [2.0, 1.0]]), np.array([-2.0, -1.5]), [0, 1]
    if swapped:
        A, gap, closed = A[::-1, ::-1], gap[::-1], closed[::-1]
    found, force, now = pressed(A, gap, closed)
    assert found
    np.testing.assert_allclose(force[:: -1 if swapped else 1], [2.0, 0.0], atol=1e-14)
    assert now == [0, 1][:: 1 if swapped else -1]


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_a_residual_is_over_the_largest_force_however_small_that_is(size):
    W, b, room = np.diag([2.0, 1.0]), size * np.array([-2.0, 0.0]), N.solver_room(1, 2)
    force = size * np.array([1.0 + 4e-13, 0.0])
    found, residual = N.newton(W, b, np.array([0.3]), 2, 1, force, room)
    assert found == 0
    assert residual == pytest.approx(4e-13, rel=2e-3, abs=0.0)
    assert N.newton(W, np.zeros(2), np.array([0.3]), 2, 1, np.zeros(2), room) == (0, 0.0)


@pytest.mark.parametrize("size", [1e-15, 1.0, 1e9])
def test_forces_without_friction_grow_with_the_gaps_however_small_these_are(size):
    """The first force closes the second contact, which is open by itself; the third opens."""
    W = np.array([[1.0, -2.0, 0.5], [-2.0, 5.0, 0.0], [0.5, 0.0, 1.0]])
    exact = np.array([*np.linalg.solve(W[:2, :2], [1.0, -0.5]), 0.0])
    law, lam = SETS.LawNumbers(0.0, 0, 0.0, SETS.Several(used=True)), np.zeros(3)
    g = size * np.array([-1.0, 0.5, -0.1])
    assert SETS.contact_forces(W, law, g, lam, np.zeros(3), np.zeros((3, 3)), np.zeros(3))
    np.testing.assert_allclose(lam, size * exact, rtol=1e-12)
