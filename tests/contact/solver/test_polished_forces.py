"""Forces that are polished as motions, and what needs no pivot, as plain Python."""

import numpy as np
import pytest

from tests.contact.plain import names

N = names("solver.friction.newton", "solver.friction.coulomb")
PIVOTING = names("solver.friction.coulomb")


@pytest.mark.parametrize("off", [0.0, 1e-4, 3e-2])
def test_newton_steps_without_a_hair_take_the_error_as_motion_to_round_off(off):
    """One contact slips in a plane, so that several steps are needed, one sticks."""
    rng = np.random.default_rng(9)
    half = rng.standard_normal((6, 6))
    W, mu = half @ half.T / 6.0 + np.eye(6), np.array([0.3, 0.9])
    b = np.array([-1.0, 2.0, -1.0, -2.0, 0.1, -0.2])
    exact, room = N.coulomb(W, b.reshape(2, 3), mu).force.ravel(), N.solver_room(2, 3)
    force, rho = exact * (1.0 + off * np.linspace(-1.0, 1.0, 6)), room.pairs
    N.steps_in(W, 3, 2, rho)
    N.law_residual(W, b, mu, rho, 3, 2, force, room.vectors[N.U], room.vectors[N.MISS])
    N.polish(W, b, mu, 3, 2, force, room)
    assert room.left[0] <= 1e-10
    np.testing.assert_allclose(force, exact, rtol=0.0, atol=1e-9 * np.abs(exact).max())
    assert np.hypot(*force[1:3]) == pytest.approx(0.3 * force[0], rel=1e-9)
    assert np.hypot(*force[4:]) < 0.8 * force[3]


def test_gaps_that_are_all_open_need_no_pivot():
    M = np.array([[1.0, -3.0], [2.0, 0.5]])
    for q in ([0.2, 0.0], [0.0, 0.0], [3.0, 0.1]):
        assert PIVOTING.lemke(M, np.array(q), np.array([1.0, 1.5])).tolist() == [0.0, 0.0]
