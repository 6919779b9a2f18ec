"""One contact in closed form, against the solver for many."""

import numpy as np
import pytest

from contact.solver.friction.coulomb import coulomb, friction_forces, solver_room
from contact.solver.friction.one_contact import drag_ratio, one_contact

SEED = 20263


def in_closed_form(W, b, mu):
    (nn, nt), (tn, tt) = W
    solved, *force = one_contact(nn, nt, tn, tt, b[0], b[1], mu)
    return bool(solved), np.array(force)


@pytest.mark.slow
def test_it_finds_what_newtons_method_finds():
    rng, states = np.random.default_rng(SEED), set()
    for _ in range(300):
        root = rng.standard_normal((2, 2))
        W, b, mu = root @ root.T + 0.1 * np.eye(2), rng.standard_normal(2), float(rng.uniform(0.0, 1.5))
        solved, force = in_closed_form(W, b, mu)
        if not solved:
            assert W[0, 0] <= mu * abs(W[0, 1])
            continue
        expected = coulomb(W, b[None], mu).force[0]
        assert force == pytest.approx(expected, rel=1e-9, abs=1e-11)
        sticks = abs(force[1]) < mu * force[0] * (1.0 - 1e-9)
        states.add("open" if force[0] == 0.0 else "sticks" if sticks else "slips ahead" if force[1] < 0.0 else "back")
    assert states == {"open", "sticks", "slips ahead", "back"}


def test_one_direction_is_a_division():
    W = np.diag([2.0, 0.0])
    assert in_closed_form(W, np.array([-3.0, 0.0]), 0.0) == (True, pytest.approx([1.5, 0.0]))
    assert in_closed_form(W, np.array([3.0, 0.0]), 0.0) == (True, pytest.approx([0.0, 0.0]))


@pytest.mark.slow  # compiles
@pytest.mark.parametrize(
    ("slip", "friction"),
    [([0.5], [-0.3]), ([-0.5], [0.3]), ([0.0], [0.0]), ([0.3, -0.4], [-0.18, 0.24]), ([0.0, 0.0], [0.0, 0.0])],
)
def test_a_body_that_cannot_move_along_the_tangent_rubs_by_the_slip_that_is_given(slip, friction):
    W = np.diag([2.0, *np.zeros(len(slip))])
    dim, force = len(W), np.zeros(len(W))
    _, residual = friction_forces(W, np.array([-2.0, *slip]), np.array([0.3]), dim, 1, force, solver_room(1, dim))
    assert residual <= 1e-12
    assert force == pytest.approx([1.0, *friction], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("W", "b", "mu"),
    [
        (np.array([[1.0, 0.9], [0.9, 1.0]]), [-1.0, 0.5], 1.2),  # steep: two answers there may be
        (np.array([[1.0, 0.0], [0.0, 0.0]]), [-1.0, 0.5], 0.3),  # no tangential compliance
        (np.diag([-1.0, 0.0]), [-1.0, 0.0], 0.0),
        (np.diag([np.nan, 0.0]), [-1.0, 0.0], 0.0),
        (np.diag([1.0, 0.0]), [np.nan, 0.0], 0.0),
    ],
)
def test_what_it_does_not_know_is_left_to_others(W, b, mu):
    solved, _ = in_closed_form(W, np.array(b), mu)
    assert not solved


def test_a_contact_that_would_stick_only_by_pulling_has_no_ratio():
    """W with determinant -3: sticking needs W force = -b, so force (-1, 1); and no direction of slip agrees."""
    assert np.isnan(drag_ratio(1.0, 2.0, 2.0, 1.0, -1.0, 1.0, 1.5))


@pytest.mark.parametrize("across", [2.0, -2.0])
def test_friction_that_outweighs_the_compliance_is_left_to_other_solvers(across):
    """mu |W_NT| above W_NN: one direction of slip would close the gap by its own drag."""
    assert not one_contact(1.0, across, across, 5.0, -1.0, 0.3, 0.6)[0]
    assert one_contact(1.0, across, across, 5.0, -1.0, 0.3, 0.4)[0]
