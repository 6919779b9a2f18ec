"""Gauss-Seidel sweeps over contacts with friction: closed forms of contacts that do not feel each other."""

import numpy as np
import pytest

from contact.solver.friction.room import ROUGHLY, sweep

NORMAL, ACROSS = np.array([2.0, 3.0, 4.0]), np.array([0.5, 0.8, 1.6])  # m/N of each contact
FREE = np.array([-1.0, -0.6, -2.0])  # m
MU = np.array([0.2, 0.5, 0.3])


def pushed(dim, slip):
    """Three contacts, each pressed and slid (`slip`, its tangential part) alone."""
    size = 3 * dim
    W, b, force = np.zeros((size, size)), np.zeros(size), np.zeros(size)
    for k in range(3):
        at = k * dim
        W[at, at], b[at] = NORMAL[k], FREE[k]
        for j in range(1, dim):
            W[at + j, at + j], b[at + j] = ACROSS[k], slip[k][j - 1]
    sweep(W, b, MU, dim, 3, force, 2)
    return force.reshape(3, dim)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_who_slips_bears_the_limit_against_its_slip(dim):
    """N = -g/W_nn and T = -mu N along the slip, which is far beyond what friction could hold."""
    slip = np.array([[3.0, -4.0], [-5.0, 12.0], [8.0, 6.0]])[:, : dim - 1]
    found = pushed(dim, slip)
    N = -FREE / NORMAL
    np.testing.assert_allclose(found[:, 0], N, rtol=1e-12)
    if dim > 1:
        along = slip / np.linalg.norm(slip, axis=1, keepdims=True)
        np.testing.assert_allclose(found[:, 1:], -(MU * N)[:, None] * along, rtol=3.0 * ROUGHLY)


@pytest.mark.parametrize("dim", [2, 3])
def test_who_sticks_bears_what_ends_its_slip(dim):
    slip = 0.02 * np.array([[0.3, -0.4], [-0.5, 0.1], [0.2, 0.6]])[:, : dim - 1]
    np.testing.assert_allclose(pushed(dim, slip)[:, 1:], -slip / ACROSS[:, None], rtol=1e-12)


def test_who_is_open_bears_nothing():
    force = np.ones(3)
    sweep(np.eye(3), np.array([0.1, 5.0, 5.0]), np.array([0.4]), 3, 1, force, 1)
    assert force.tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("dim", [2, 3])
def test_contacts_of_unlike_compliance_that_feel_each_other_slip_at_the_limit(dim):
    """Coulomb's conditions at each of three, 1 to 16 to 256: gap closed, |T| = mu N, T against the slip."""
    size = np.repeat([1.0, 4.0, 16.0], dim)
    alike = np.kron(np.full((3, 3), -0.4) + 1.4 * np.eye(3), np.eye(dim))  # across, one pulls the others back
    W, b = size[:, None] * alike * size, -size * np.tile([1.0, 5.0, -3.0][:dim], 3)
    force = np.zeros(3 * dim)
    sweep(W, b, MU, dim, 3, force, 100)
    motion = (b + W @ force).reshape(3, dim)
    N, T, slip = force[::dim], force.reshape(3, dim)[:, 1:], motion[:, 1:]
    assert N.min() > 0.0
    np.testing.assert_allclose(motion[:, 0] / size[::dim], 0.0, atol=1e-6)
    along = slip / np.linalg.norm(slip, axis=1, keepdims=True)
    np.testing.assert_allclose(T, -(MU * N)[:, None] * along, atol=3.0 * ROUGHLY * N.max())
