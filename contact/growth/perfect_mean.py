"""The perfect casing nearest to one whose pairs are split: each pair's mean, seen as cos and sin of its own n."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contact.base.arrays import Array
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact, SplitError, rub_contact
from contact.model.gaps.rub import Rub, Start, rub_of


def perfect_mean(casing: ModalBody) -> ModalBody:
    """A rim whose pairs are equal and turn into themselves; what has no partner is left to the compliance.

    Modes belong to the n that most of their radial and tangential motion has; those of one n are paired in order of
    frequency. Of a perfect casing it is the casing itself but for the turn of its pairs.

    >>> from contact.model.gaps.bladed_disk import pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> split = pair_rim(ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5).detuned(1e-3, seed=3)
    >>> np.ptp(split.omega) > 0.0, np.ptp(perfect_mean(split).omega)
    (np.True_, np.float64(0.0))
    """
    N, size = casing.n_max, 2 * casing.n_max + 1
    rows = casing.rows.reshape(-1, size, casing.omega.size)  # blocks of lines and directions
    content = _by_order(np.sum(rows**2, axis=0), N)
    order = content.argmax(axis=0)
    kept: list[tuple[float, float, Array]] = []
    gone = []
    for n in range(N + 1):
        own = np.flatnonzero(order == n)
        if n == 0:
            alone = [np.where(np.arange(size)[:, None] == 0, rows[:, :, i].T, 0.0).T.ravel() for i in own]
            kept += [(casing.omega[i], casing.zeta[i], row) for i, row in zip(own, alone, strict=True)]
            continue
        own = own[np.argsort(casing.omega[own], kind="stable")]
        gone += own[own.size - own.size % 2 :].tolist()
        for i, j in zip(own[: own.size - own.size % 2 : 2], own[1::2], strict=True):
            omega, zeta = float(casing.omega[[i, j]].mean()), float(casing.zeta[[i, j]].mean())
            kept += [(omega, zeta, row) for row in _pair(rows[:, :, i], rows[:, :, j], n, N)]
    S = casing.S + sum((np.outer(casing.rows[:, i], casing.rows[:, i]) / casing.omega[i] ** 2 for i in gone), 0.0)
    kept.sort(key=lambda mode: mode[0])
    return replace(
        casing, omega=np.array([mode[0] for mode in kept]), zeta=np.array([mode[1] for mode in kept]),
        rows=np.array([mode[2] for mode in kept]).reshape(len(kept), -1).T, S=_mean_compliance(np.asarray(S), size, N),
        recovery=None, recovery_S=None, recovery_points=None, recovery_cells=None, outputs=(), output_rows=None,
        output_S=None, K_omega=None, participation=None, out_of_roundness=None,
    )  # fmt: skip


def mean_contact(rub: RotatingRim | Rub, *, mu: float = 0.0) -> tuple[ClosedContact, bool]:
    """What stays of a rim or rub with every contact closed, and whether its pairs had to be averaged for that."""
    try:
        return rub_contact(rub, mu=mu), False
    except SplitError:
        # neither how it starts nor what loads it matters to growth, and both belong to the casing's own modes
        mean = replace(rub_of(rub), casing=perfect_mean(rub.casing), casing_start=Start(), forces=())
        return rub_contact(mean, mu=mu), True


def _by_order(values: Array, N: int) -> Array:
    """Cosine and sine of each n added up, (N + 1, ...)."""
    found = values[: N + 1].copy()
    found[1:] += values[N + 1 :]
    return found


def _pair(first: Array, second: Array, n: int, N: int) -> tuple[Array, Array]:
    """Rows of cos n and sin n whose complex amplitudes in every block are the two modes' mean, seen from the first's.

    A wave of the pair moves block b by z_b: first z_b e^{-i alpha}, second -+i times that. alpha is taken from the
    radial motion, which is then real: what a perfect pair has.
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
    """S averaged over the angle: between cos n and sin n of equal n alone, the same for both but for a quarter turn."""
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
