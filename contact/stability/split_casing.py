"""Closed contact of a split casing: growth per turn by Floquet theory, and the nearest perfect casing.

In their own frames the bodies vibrate freely and the contact point moves around the casing: q'' + C q' + K q =
-W(phi)^T Q(phi) q/S(phi), phi = phi_0 - Omega t, C and K of `ModalBody.matrices`. The matrix of one turn (monodromy)
has multipliers rho; growth = max log|rho|/T, T = 2 pi/|Omega|. Its coefficients are periodic in time in either frame.
The nearest perfect casing has the mean of each pair, as cos and sin of the pair's n.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from contact.base.arrays import Array, Indices, aligned
from contact.base.errors import InputError, LimitError
from contact.base.groups import joined_groups
from contact.base.remembered import remembered
from contact.io.progress import as_part, tell
from contact.io.threads import with_one_thread
from contact.model.bodies.modal_body import ModalBody
from contact.model.bodies.modal_checks import HIGHER, SQUARES
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.modal_system import ModalSystem, rim_system
from contact.model.gaps.permanent import ClosedContact, SplitError, rub_contact
from contact.model.gaps.rub import Rub, Start, rub_of
from contact.model.gaps.rub_system import matrices_of
from contact.scheme.modal.blocks import row_blocks, whole
from contact.stability.waves import COUPLED

if TYPE_CHECKING:
    from contact.loop.revolve import Drifts, TurnRows

P = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))  # five steps of order two make one of order four (Suzuki, Phys. Lett. A 146, 1990)
KICKS = np.array([P, P, 1.0 - 4.0 * P, P, P])
PHASE = 0.4  # of the fastest vibration in one step, in radians
MOST_STEPS = 5_000_000
CHUNK = 5_000  # steps between two words on how far a turn is: a second, with some hundred modes
AVERAGED = "The mode pairs of the casing are split: the poles use the mean of each pair."
WELL = 1e6  # condition of the eigenvectors up to which free motion is separated by them


@remembered
def perfect_mean(casing: ModalBody) -> ModalBody:
    """A rim with equal pairs that rotate into each other; modes without a partner become part of the compliance.

    The n of a mode is that of most of its radial and tangential motion; modes of one n are paired in order of
    frequency. Damping, stiffness and the arrays of rotation are averaged over the angle of the pairs. A perfect casing
    is unchanged except for the rotation of its pairs.

    >>> from contact.model.gaps.bladed_disk import pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> split = pair_rim(ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5).detuned(1e-3, seed=3)
    >>> np.ptp(split.omega) > 0.0, np.ptp(perfect_mean(split).omega)
    (np.True_, np.float64(0.0))
    """
    N, size = casing.n_max, 2 * casing.n_max + 1
    rows = casing.rows.reshape(-1, size, casing.omega.size)  # blocks of lines and directions
    content = np.sum(rows**2, axis=0)
    content[1 : N + 1] += content[N + 1 :]  # cosine and sine
    order = content[: N + 1].argmax(axis=0)
    kept: list[_Mean] = []
    gone = []
    unit = np.eye(casing.omega.size)
    for n in range(N + 1):
        own = np.flatnonzero(order == n)
        if n == 0:
            alone = [np.where(np.arange(size)[:, None] == 0, rows[:, :, i].T, 0.0).T.ravel() for i in own]
            kept += [_Mean(casing.omega[i], casing.zeta[i], row, unit[i], 0) for i, row in zip(own, alone, strict=True)]
            continue
        own = own[np.argsort(casing.omega[own], kind="stable")]
        gone += own[own.size - own.size % 2 :].tolist()
        for i, j in zip(own[: own.size - own.size % 2 : 2], own[1::2], strict=True):
            omega, zeta = float(casing.omega[[i, j]].mean()), float(casing.zeta[[i, j]].mean())
            pair, waves = _pair(rows[:, :, i], rows[:, :, j], n, N), _share(rows[:, :, i], rows[:, :, j], n, N)
            shapes = waves @ unit[[i, j]]
            kept += [_Mean(omega, zeta, row, shape, k) for row, shape, k in zip(pair, shapes, (n, -n), strict=True)]
    S = casing.S + sum((np.outer(casing.rows[:, i], casing.rows[:, i]) / casing.omega[i] ** 2 for i in gone), 0.0)
    kept.sort(key=lambda mode: mode.omega)
    shapes, orders = np.array([mode.shape for mode in kept]), np.array([mode.order for mode in kept], dtype=np.int64)
    squares: dict[str, Any] = {
        name: _mean_square(shapes @ given @ shapes.T, orders)
        for name in SQUARES if (given := getattr(casing, name)) is not None
    }  # fmt: skip
    for name in HIGHER:
        if (given := getattr(casing, name)) is not None:
            squares[name] = np.array([_mean_square(shapes @ part @ shapes.T, orders) for part in given])
    return replace(
        casing, omega=np.array([mode.omega for mode in kept]), zeta=np.array([mode.zeta for mode in kept]),
        rows=np.array([mode.row for mode in kept]).reshape(len(kept), -1).T, S=_mean_compliance(np.asarray(S), size, N),
        recovery=None, recovery_S=None, recovery_points=None, recovery_cells=None, outputs=(), output_rows=None,
        output_S=None, **squares, participation=None, out_of_roundness=None,
    )  # fmt: skip


class _Mean(NamedTuple):
    """A mode of the perfect rim: its row, its combination of the casing's modes, and n for a cosine, -n for a sine."""

    omega: float
    zeta: float
    row: Array
    shape: Array
    order: int


def _share(first: Array, second: Array, n: int, N: int) -> Array:
    """Cosine and sine of n as sums of two modes, (2, 2): from their radial phases, made orthogonal."""
    angle = [math.atan2(mode[0, N + n], mode[0, n]) for mode in (first, second)]
    left, _, right = np.linalg.svd(np.array([np.cos(angle), np.sin(angle)]))
    return np.asarray(left @ right)


def _mean_square(X: Array, order: Indices) -> Array:
    """A matrix of cosines (order n) and sines (-n) averaged over the angle; it couples only waves of equal n."""
    found, n = np.zeros_like(X), np.abs(order)
    found[np.ix_(n == 0, n == 0)] = X[np.ix_(n == 0, n == 0)]
    for one in np.unique(n[n > 0]):
        c, s = np.flatnonzero(order == one), np.flatnonzero(order == -one)
        even = 0.5 * (X[np.ix_(c, c)] + X[np.ix_(s, s)])
        odd = 0.5 * (X[np.ix_(c, s)] - X[np.ix_(s, c)])
        found[np.ix_(c, c)] = found[np.ix_(s, s)] = even
        found[np.ix_(c, s)], found[np.ix_(s, c)] = odd, -odd
    return found


def mean_contact(rub: RotatingRim | Rub, *, mu: float = 0.0) -> tuple[ClosedContact, bool]:
    """Rim or rub with every contact closed, averaged over time, and whether its pairs had to be averaged."""
    try:
        return rub_contact(rub, mu=mu), False
    except SplitError:
        # initial motion and loads do not affect growth, and both refer to the casing's own modes
        mean = replace(rub_of(rub), casing=perfect_mean(rub.casing), casing_start=Start(), forces=())
        return rub_contact(mean, mu=mu), True


def _pair(first: Array, second: Array, n: int, N: int) -> tuple[Array, Array]:
    """Rows of cos n and sin n with the mean complex amplitudes of both modes in every block, relative to the first.

    A wave of the pair moves block b by z_b: by z_b e^{-i alpha} for the first mode, by -+i times that for the second.
    alpha makes the radial motion real, as in a perfect pair.
    """
    waves = []
    for mode in (first, second):
        z = mode[:, n] - 1j * mode[:, N + n]  # Re z e^{i n theta}
        waves.append(z * np.exp(-1j * np.angle(z[0])))
    z = 0.5 * (waves[0] + waves[1])
    cosine, sine = np.zeros_like(first), np.zeros_like(first)
    cosine[:, n], cosine[:, N + n] = z.real, -z.imag
    sine[:, n], sine[:, N + n] = z.imag, z.real
    return cosine.ravel(), sine.ravel()


def _mean_compliance(S: Array, size: int, N: int) -> Array:
    """S averaged over the angle: only between cos n and sin n of equal n, equal except for a quarter turn."""
    blocks = S.reshape(len(S) // size, size, len(S) // size, size)
    found = np.zeros_like(blocks)
    found[:, 0, :, 0] = blocks[:, 0, :, 0]
    for n in range(1, N + 1):
        c, s = n, N + n
        even = 0.5 * (blocks[:, c, :, c] + blocks[:, s, :, s])
        odd = 0.5 * (blocks[:, c, :, s] - blocks[:, s, :, c])
        found[:, c, :, c] = found[:, s, :, s] = even
        found[:, c, :, s], found[:, s, :, c] = odd, -odd
    full = found.reshape(S.shape)
    return np.asarray(0.5 * (full + full.T))


@with_one_thread
def floquet_growth(rim: RotatingRim, speed_hz: Array, *, mu: float = 0.0, phase: float = PHASE) -> Array:
    """Growth rates [1/s] of a rim and blade in closed contact at speeds [Hz], (speeds,).

    The pairs of the casing may be split: growth is that over one turn, by Floquet's theory. A speed takes seconds.
    `phase` [rad] is the step in radians of the fastest vibration, loaded by the contact; the error falls with its
    fourth power. Raises InputError at rest, where there are no turns, LimitError beyond 5,000,000 steps a turn.

    >>> import contact as ct
    >>> pair = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> split = replace(pair, omega=pair.omega * [1.0, 1.001])
    >>> blade = ct.ModalBody(omega=[900.0], zeta=[0.01], channels=("span", "flap"), rows=[[0.0], [1.0]], S=np.eye(2))
    >>> rim = ct.RotatingRim(split, blade, clearance=0.0, speed_hz=20.0)
    >>> bool(floquet_growth(rim, np.array([20.0]), mu=0.1)[0] < 1.0)
    True
    """
    speeds = np.atleast_1d(np.asarray(speed_hz, dtype=float))
    seen = matrices_of(rub_of(rim))
    for body, sense in zip(seen.bodies, seen.senses, strict=True):
        body.require_known(2.0 * math.pi * sense * speeds)
    turns = 1.0 / np.maximum(np.abs(speeds), np.finfo(float).tiny)  # what each costs
    values = []
    for k, speed in enumerate(speeds.tolist()):
        before, own = turns[:k].sum(), turns[k]

        def whole(done: float, k: int = k, before: float = before, own: float = own) -> tuple[str, float]:
            return f"speed {k + 1} of {speeds.size}", float((before + done * own) / turns.sum())

        with as_part(whole):
            values.append(_growth(replace(rim, speed_hz=speed), mu, phase))
    return np.array(values)


def _growth(rim: RotatingRim, mu: float, phase: float) -> float:
    if rim.speed == 0.0:
        raise InputError(
            "speed_hz: found 0 Hz with a split casing, expected another speed: Floquet's theory needs a period"
        )
    C, K = matrices_of(rub_of(rim)).at(rim.speed)
    turn = monodromy(rim_system(rim), C, K, math.copysign(mu, rim.speed), phase)
    return float(np.log(np.abs(np.linalg.eigvals(turn)).max()) * abs(rim.speed) / (2.0 * math.pi))


def monodromy(system: ModalSystem, C: Array, K: Array, mu: float, phase: float = PHASE) -> Array:
    """State after one turn for each unit state at its start, (2 m, 2 m), in the coordinates of `free_motion`.

    `mu` has the sign of the speed; C [1/s] and K [1/s^2] (m, m) are those of the bodies at the speed of the system.
    """
    from contact.loop.revolve import revolve

    m, period = system.omega.size, 2.0 * math.pi / abs(system.speed)
    scale = float(system.omega.max())
    steps = math.ceil(period * fastest(system, C, K, mu) / phase)
    if steps > MOST_STEPS:
        raise LimitError(f"speed_hz: found {steps} steps a turn, expected at most {MOST_STEPS}: use a higher speed")
    h = period / steps
    q, v = np.hstack([np.eye(m), np.zeros((m, m))]), np.hstack([np.zeros((m, m)), np.eye(m)])
    times = np.cumsum(KICKS) - 0.5 * KICKS
    free = free_motion(C, K, scale)
    rows = _rows(system, mu, free.shapes, scale)
    gap, push = aligned(2, whole(2 * m + 1))
    edges = np.concatenate(([0.0], KICKS, [0.0]))
    parts = _drifts(free, np.array([0.5 * (a + b) * h for a, b in pairwise(edges)]))
    for first in range(0, steps, CHUNK):
        tell("", first / steps)
        on = rows._replace(angle=system.angle - system.speed * first * h)
        revolve(q, v, on, gap, push, np.zeros(2 * m), parts, times, KICKS, h, min(CHUNK, steps - first))
    return np.vstack([q, v])


def _rows(system: ModalSystem, mu: float, shapes: Array, scale: float) -> TurnRows:
    from contact.loop.modal.rows import RowBlocks
    from contact.loop.revolve import TurnRows

    m, (normal, tangent) = system.omega.size, system.sums()
    count = whole(max(int(part.wave.max(initial=0)) for part in (normal, tangent)) // 2 + 1)
    Q, T = (part.full(2 * count) for part in (normal, tangent))
    gap, push = np.zeros((2, 1, whole(2 * m + 1), 2 * count))
    gap[0, : 2 * m], gap[0, 2 * m] = shapes[:m].T @ Q[:m], Q[m + 1] - mu * Q[m + 2]
    push[0, : 2 * m] = np.linalg.inv(shapes)[:, m:] @ (Q[:m] - mu * T[:m]) / scale
    return TurnRows(
        RowBlocks(*row_blocks(gap)), RowBlocks(*row_blocks(push)), system.angle, system.speed, aligned(2, count)
    )


class Free(NamedTuple):
    """Free motion: (q, q'/scale) = `shapes` (2 m, 2 m) times coordinates z, and z' = A z in each of `blocks`.

    A block contains the modes whose pairs of coordinates, numbers i and m + i of z, are coupled, and their A (2 s, 2
    s).
    """

    shapes: Array
    blocks: list[tuple[Indices, Array]]


def free_motion(C: Array, K: Array, scale: float) -> Free:
    """Separate free motion into pairs of coordinates, one for each mode, if its eigenvectors allow that.

    For an eigenvalue a + i b with the vector w, z -> Re(w) z_1 + Im(w) z_2 and A = [[a, b], [-b, a]]; two real
    eigenvalues share a pair. Uncoupled modes do not change, nor do modes whose eigenvectors have a condition above
    WELL.

    >>> free = free_motion(np.array([[0.0, 6.0], [-6.0, 0.0]]), np.diag([16.0, 16.0]), 4.0)
    >>> sorted(round(float(A[0, 1]), 9) for _, A in free.blocks)  # rad/s, of the two waves
    [2.0, 8.0]
    """
    m = len(K)
    groups = joined_groups((np.abs(C) > COUPLED * np.abs(C).max()) | (np.abs(K) > COUPLED * np.abs(K).max()))
    shapes, blocks = np.eye(2 * m), list[tuple[Indices, Array]]()
    for group in groups:
        own, none = np.ix_(group, group), np.zeros((group.size, group.size))
        A = np.block([[none, scale * np.eye(group.size)], [-K[own] / scale, -C[own]]])
        W, parts = _pairs(A) if group.size > 1 else (np.eye(2), [A])
        if np.linalg.cond(W) > WELL:
            blocks.append((group, A))
            continue
        both = np.concatenate([group, m + group])
        shapes[np.ix_(both, both)] = W
        blocks += [(group[i : i + 1], part) for i, part in enumerate(parts)]
    return Free(shapes, blocks)


def _pairs(A: Array) -> tuple[Array, list[Array]]:
    """Real vectors of each complex pair or two real eigenvalues of A (2 s, 2 s): first ones, then second ones.

    And the 2 x 2 form.
    """
    values, vectors = np.linalg.eig(A)
    first, second, parts = list[Array](), list[Array](), list[Array]()
    for k in np.flatnonzero(values.imag > 0.0):
        a, b = float(values[k].real), float(values[k].imag)
        first.append(vectors[:, k].real)
        second.append(vectors[:, k].imag)
        parts.append(np.array([[a, b], [-b, a]]))
    real = np.flatnonzero(values.imag == 0.0)
    for i, j in zip(real[::2], real[1::2], strict=True):
        first.append(vectors[:, i].real)
        second.append(vectors[:, j].real)
        parts.append(np.diag(values[[i, j]].real))
    return np.array([*first, *second]).T, parts


def _drifts(free: Free, times: Array) -> Drifts:
    """Exact free motion over each of several time steps, block by block."""
    from scipy.linalg import expm

    from contact.loop.revolve import Drifts

    values = [expm(times[:, None, None] * A).reshape(times.size, -1) for _, A in free.blocks]
    sizes = np.array([modes.size for modes, _ in free.blocks])
    start = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    first = np.concatenate([[0], np.cumsum(4 * sizes**2)[:-1]]).astype(np.int64)
    work = np.zeros((2 * int(sizes.max()), len(free.shapes)))
    modes = np.concatenate([modes for modes, _ in free.blocks]).astype(np.int64)
    return Drifts(start, modes, first, np.hstack(values), work)


def fastest(system: ModalSystem, C: Array, K: Array, mu: float) -> float:
    """Bound on the angular frequencies [rad/s] of the modes on the contact's spring, over a turn."""
    assert system.table is not None  # a rim's rows always turn
    stiffest = 0.0
    for phi in np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False):
        Q, T = system.table.rows(float(phi))
        S = system.S_nn(float(phi)) - mu * system.S_nt(float(phi))
        if not S > 0.0:
            raise InputError(f"S: found compliance {S:g} m/N at the contact, expected > 0")
        stiffest = max(stiffest, float(np.linalg.norm(Q) * np.linalg.norm(Q - mu * T)) / S)
    carried = 0.25 * float(np.linalg.norm(C - C.T, 2))  # half of the shift of a pair by Coriolis forces
    return carried + math.sqrt(carried**2 + float(np.linalg.norm(K, 2)) + stiffest)
