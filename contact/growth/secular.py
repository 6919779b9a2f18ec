"""Poles of one closed contact from its characteristic equation: all of them, in a hundredth of what eigenvalues take.

Waves of order n and standing modes (n = 0) are met at one point, so that their poles without contact p (N,) and
residues a give f(s) = S + sum_j a_j/(s - p_j) = 0. Aberth's iteration (Math. Comp. 27, 1973, 339) finds its N roots
together: Newton's step for f(s) prod (s - p_j), the other roots divided out.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from contact.growth.coincidence import Waves

Complex = NDArray[np.complex128]
MOST = 60  # rounds
SETTLED = 1e-12  # of the largest pole: the next step would be none, convergence is cubic
COUPLED = 1e-14  # of the largest residue: below, contact does not see a mode


def closed_poles(seen: Waves, compliance: float, speed: float) -> Complex | None:
    """All poles s [1/s, rad/s] at one speed [rad/s], (2 m,); None where the iteration does not settle, or for omega 0.

    (s + i n Omega)^2 + 2 zeta omega (s + i n Omega) + omega^2 is what stands below each product r of rows.
    """
    if seen.omega.size == 0 or float(seen.omega.min()) <= 0.0:
        return None
    damped = seen.omega * np.sqrt(1.0 - seen.zeta**2)
    centre = -seen.zeta * seen.omega - 1j * seen.order * speed
    p = np.concatenate([centre + 1j * damped, centre - 1j * damped])
    a = np.concatenate([seen.product / (2j * damped), -seen.product / (2j * damped)])
    coupled = np.abs(a) > COUPLED * float(np.abs(a).max(initial=0.0))
    roots = _roots(p[coupled], a[coupled], compliance)
    return None if roots is None else np.concatenate([roots, p[~coupled]])


def _roots(p: Complex, a: Complex, S: float) -> Complex | None:
    """Zeros of S + sum a/(s - p), (N,)."""
    size = float(np.abs(p).max(initial=1.0))
    gaps = p[:, None] - p
    np.fill_diagonal(gaps, math.inf)
    with np.errstate(all="ignore"):
        s = p - a / (S + np.sum(a / gaps, axis=1))  # what the others' share there leaves of each
        bad = ~np.isfinite(s) | (s == p)
        s[bad] = p[bad] + 1e-6 * size * np.exp(1j * np.arange(np.count_nonzero(bad)))
        active = np.arange(p.size)
        for _ in range(MOST):
            near = 1.0 / (s[active, None] - p)
            apart = s[active, None] - s
            apart[np.arange(active.size), active] = math.inf
            f = S + near @ a
            ratio = -(near**2 @ a) / f + near.sum(axis=1)  # g'/g of g = f prod (s - p)
            step = 1.0 / (ratio - np.sum(1.0 / apart, axis=1))
            if not np.isfinite(step).all():
                return None
            s[active] -= step
            active = active[np.abs(step) > SETTLED * size]
            if not active.size:
                return np.asarray(s)
    return None
