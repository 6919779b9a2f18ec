"""Modes of a neighbour and adjoints of readings: the space they grow in, when it ends, and what is counted."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.linalg.factor import factorise
from casingfem.linalg.pencil import make_pencil
from casingfem.modal.adjoint import AdjointSpace, adjoint_space
from casingfem.modal.modes import RitzModes
from casingfem.modal.neighbour import (
    FAR,
    GUARD,
    TOL,
    OldFactor,
    Space,
    counted,
    davidson,
    factored,
    shift_of,
    solved,
    solved_near,
)

RNG = np.random.default_rng(21)
SIZE, WIDTH, COUNT = 60, 8, 4
MASS = np.linspace(0.5, 2.0, SIZE)
TURN, _ = np.linalg.qr(RNG.standard_normal((SIZE, SIZE)))
STIFF = TURN @ np.diag(np.linspace(1.0, 8.0, SIZE) ** 3) @ TURN.T
OTHER = STIFF + 0.3 * TURN[:, :3] @ TURN[:, 3:6].T + 0.3 * TURN[:, 3:6] @ TURN[:, :3].T


def pencil(K=STIFF, mass=MASS):
    return make_pencil(csc_array(K), mass)


def lowest(given, count):
    values, vectors = eigh(given.A.toarray())
    return values[:count], vectors[:, :count]


def test_a_factor_answers_in_the_scaling_of_another_pencil():
    """F = (K - s M)^-1 between loads and motions, whatever mass scales them: u = R y, f = R^-1 g."""
    first, second = pencil(), pencil(mass=MASS[::-1].copy())
    old, seconds = factored(first, -0.7)
    assert list(seconds) == ["factor"]
    assert 0.0 <= seconds["factor"] < 100.0
    g = RNG.standard_normal((SIZE, 2))
    R = second.scale[:, None]
    flexible = np.linalg.inv(STIFF + 0.7 * np.diag(MASS))
    np.testing.assert_allclose(old.apply(second, g), (flexible @ (g / R)) / R, rtol=1e-9)
    np.testing.assert_allclose(old.apply(first, g), factorise(first.shifted(-0.7)).solve(g), rtol=1e-12)


def test_a_space_is_orthonormal_and_keeps_its_products():
    """Columns that it has already add nothing."""
    given = pencil()
    space = Space(given, 4, RNG.standard_normal((SIZE, 3)))
    first = space.V.copy()
    fresh = RNG.standard_normal((SIZE, 2))
    space.grow(np.column_stack([first[:, :1] - 2.0 * first[:, 1:2], fresh]))
    assert space.count == 5
    np.testing.assert_array_equal(space.V[:, :3], first)
    np.testing.assert_allclose(space.V.T @ space.V, np.eye(5), atol=1e-12)
    np.testing.assert_allclose(space.images, given.A @ space.V, atol=1e-9)
    np.testing.assert_allclose(np.tril(space.H), np.tril(space.V.T @ (given.A @ space.V)), atol=1e-9)
    left = fresh - space.V @ (space.V.T @ fresh)
    assert np.abs(left).max() < 1e-12


def fall(given, old, start, count=COUNT):
    """What the lowest values have yet to fall, relative, by the factor: r^T F r over the value."""
    values, y = eigh(start.T @ (given.A @ start))
    x = start @ y
    r = given.A @ x - x * values
    return np.abs(np.einsum("ij,ij->j", r, old.apply(given, r)) / values)[:count].max()


def test_modes_of_the_structure_itself_take_one_block_and_no_factor():
    given = pencil()
    old, _ = factored(given, -0.5)
    vectors, same, blocks, seconds = davidson(given, lowest(given, WIDTH)[1], old, -0.5, COUNT)
    assert same is old
    assert (blocks, seconds) == (1, {})
    np.testing.assert_allclose(np.abs(vectors.T @ lowest(given, WIDTH)[1]), np.eye(WIDTH), atol=1e-7)


@pytest.mark.parametrize("step", [1e-4, 1e-2, 1.0])
def test_a_neighbours_modes_are_right_to_a_hundredth_of_what_is_left(step):
    """A short step needs no factor of its own, a long one takes it at once."""
    near = pencil(STIFF + step * (OTHER - STIFF))
    old, _ = factored(pencil(), -0.5)
    start = lowest(pencil(), WIDTH)[1]
    vectors, used, blocks, seconds = davidson(near, start, old, -0.5, COUNT)
    exact, _ = lowest(near, WIDTH)
    np.testing.assert_allclose(np.diag(vectors.T @ (near.A @ vectors))[:COUNT], exact[:COUNT], rtol=1e-7)
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(WIDTH), atol=1e-10)
    to_fall = fall(near, old, start)
    assert (used is old) == (to_fall <= FAR) == (not seconds)
    assert (blocks == 1) == (to_fall <= TOL)


def test_a_step_that_an_old_factor_does_not_finish_in_two_blocks_takes_a_new_one():
    """The old one knows no direction from another, and is so stiff that it promises little."""
    near = pencil(STIFF + 0.03 * (OTHER - STIFF))
    start = lowest(pencil(), WIDTH)[1]
    stiff = 1e6 * fall(near, OldFactor(factorise(csc_array(np.eye(SIZE))), near.scale), start)
    old = OldFactor(factorise(csc_array(stiff * np.eye(SIZE))), near.scale)
    assert fall(near, old, start) == pytest.approx(1e-6)
    vectors, used, blocks, seconds = davidson(near, start, old, -0.5, COUNT)
    assert used is not old
    assert list(seconds) == ["factor"]
    assert blocks > 3
    np.testing.assert_allclose(np.diag(vectors.T @ (near.A @ vectors))[:COUNT], lowest(near, COUNT)[0], rtol=1e-7)


def plate(E=210e9, nu=0.3):
    return cf.Shell(
        chart=cf.Plate(length=0.2, width=0.07), thickness=3e-3, material=cf.Material(E=E, nu=nu, rho=7800.0),
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=4, rows=1, around=1),
    )  # fmt: skip


@pytest.fixture(scope="module")
def solution():
    return solved(plate(), 4)


def test_a_solution_carries_more_modes_than_it_shows(solution):
    assert len(solution.modes) == solution.modes.sturm_count == 4  # not that of those it carries
    assert solution.guard.freq.shape == (4 + GUARD,)
    assert solution.blocks == 0
    np.testing.assert_allclose(solution.modes.freq, cf.modes(plate(), 4).freq, rtol=1e-9)
    V = solution.vectors
    np.testing.assert_allclose(V.T @ V, np.eye(4 + GUARD), atol=1e-8)
    np.testing.assert_allclose(V.T @ (solution.pencil.A @ V) / (2 * np.pi * solution.guard.freq[-1]) ** 2,
                               np.diag((solution.guard.freq / solution.guard.freq[-1]) ** 2), atol=1e-8)  # fmt: skip
    assert set(solution.modes.seconds) == {"assemble", "solve", "label"}
    size = np.hypot(0.2, 0.07)
    assert shift_of(plate()) == pytest.approx(-0.25 * 210e9 / 7800.0 * 3e-3**2 / size**4, rel=1e-9)


def test_modes_of_a_neighbour_are_its_own_and_counted_when_asked(solution):
    near = solved_near(plate(nu=0.32), solution, 4)
    np.testing.assert_allclose(near.modes.freq, cf.modes(plate(nu=0.32), 4).freq, rtol=1e-7)
    assert near.modes.sturm_count is None
    assert all(0.0 <= spent < 100.0 for found in (solution, near) for spent in found.modes.seconds.values())
    assert near.blocks > 0
    whole = counted(near)
    assert whole.modes.sturm_count == 4
    assert counted(whole) is whole
    freq = near.guard.freq
    missed = RitzModes(np.delete(freq, 2), near.guard.fields, near.guard.own)
    assert counted(replace(near, guard=missed)) is None
    with pytest.raises(ValueError, match="a restart needs a shell on the same mesh"):
        solved_near(replace(plate(), mesh=cf.ShellMesh(order=3, rows=1, around=1)), solution, 4)


def test_shares_of_an_adjoint_leave_out_the_plane_of_its_mode():
    space = AdjointSpace(
        fields=np.zeros((0, 5, 4)), own=np.zeros((0, 4)), values=np.array([1.0, 1.5, 3.0, 11.0]),
        readings=np.array([[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]]),
    )  # fmt: skip
    np.testing.assert_allclose(space.weights(1, 1, (0, 1)), [0.0, 0.0, 7.0 / -1.5, 8.0 / -9.5], rtol=1e-14)
    np.testing.assert_allclose(space.weights(0, 0, (0,)), [0.0, -4.0, -1.5, -0.4], rtol=1e-14)


def test_an_adjoint_balances_what_its_reading_takes_beside_its_own_mode(solution):
    """(K - lambda M) z = -(b - M phi phi^T b), z M-orthogonal to phi; two readings, every mode."""
    loads = np.zeros((*solution.modes.fields.shape[:2], 2))
    loads[7, 2, 0], loads[11, 0, 1], loads[3, 3, 1] = 1.0, 2.0, -0.5
    space = adjoint_space(solution, loads, depth=4)
    system = solution.system
    b, X = system.restrict(loads), system.collect(space.fields, space.own)
    K, M = system.K.toarray(), system.M.toarray()
    np.testing.assert_allclose(space.readings, b.T @ X, atol=1e-9 * np.abs(space.readings).max())
    np.testing.assert_allclose(X.T @ M @ X, np.eye(X.shape[1]), atol=1e-8)
    np.testing.assert_allclose(np.diag(X.T @ K @ X), space.values, rtol=1e-6)
    for reading in (0, 1):
        for mode in range(4):
            phi, value = X[:, mode], space.values[mode]
            z = X @ space.weights(reading, mode, (mode,))
            right = -(b[:, reading] - M @ phi * (phi @ b[:, reading]))
            exact = np.linalg.lstsq(
                np.vstack([K - value * M, 1e3 * value * phi @ M]), np.append(right, 0.0), rcond=None
            )[0]
            scale = np.sqrt(np.diag(M))
            assert np.linalg.norm(scale * (z - exact)) < 1e-4 * np.linalg.norm(scale * exact)
