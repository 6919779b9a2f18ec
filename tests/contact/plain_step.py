"""One step of a rub in plain NumPy, of whole matrices: bodies with any C and K, any number of tips, friction.

q'' + C q' + K q = R^T lam of casing and blades, rows R(t) of the tips' directions, normal first. With Phi = exp(A h),
Psi = exp(-A h), A = [0 I; -K -C]: X = Phi_12 Psi_12^-1, T = Phi_11 - X Psi_11, alpha = -X, beta = I - T - X and
c = beta K^-1. D* = alpha D - beta q; gaps of q_(n+1) (or means of three) + S lam and slips T D + S (lam - lam_old) +
R Omega h obey Signorini's and Coulomb's law together, found by projected Gauss-Seidel sweeps.
"""

import math

import numpy as np
from scipy.linalg import block_diag, expm


class PlainRub:
    """A `ct.Rub` at constant speed without loads, as it stands; `forces(steps)` are those of its tips."""

    def __init__(self, rub, *, mu, h, averaged):
        self.rub, self.h, self.mu, self.share = rub, h, mu, 0.25 if averaged else 1.0
        self.omega, self.K, self.d = rub.speed.omega(0.0), len(rub.tips), rub.dimensions if mu else 1
        senses = (1, *(0 for _ in rub.blades)) if rub.turning == "casing" else (0, *(-1 for _ in rub.blades))
        pairs = [body.matrices(sense * self.omega) for body, sense in zip(rub.bodies, senses, strict=True)]
        C, K = (block_diag(*[pair[k] for pair in pairs]) for k in (0, 1))
        m = len(K)
        A = np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]])
        phi, psi = expm(A * h), expm(-A * h)
        X = phi[:m, m:] @ np.linalg.inv(psi[:m, m:])
        self.alpha, self.beta = -X, np.eye(m) - (phi[:m, :m] - X @ psi[:m, :m]) - X
        self.c = self.beta @ np.linalg.inv(K)
        self.first = np.cumsum([0, *(body.omega.size for body in rub.bodies)])
        self.along = [tip.directions(rub.blades[tip.blade])[: self.d] for tip in rub.tips]

    def at(self, t):
        """Rows of all directions (K d, m), gaps of the bodies at rest (K,), residual compliance (K d, K d)."""
        rub, N, d = self.rub, self.rub.casing.n_max, self.d
        n, size = np.arange(N + 1), 2 * N + 1
        R, gaps = np.zeros((self.K * d, self.first[-1])), np.zeros(self.K)
        E, S = np.zeros((self.K * d, len(rub.casing.channels))), np.zeros((self.K * d, self.K * d))
        for j, tip in enumerate(rub.tips):
            phi = math.radians(tip.angle_deg) - self.omega * t
            gaps[j] = rub.clearance + tip.clearance + rub.profile(phi)
            blade, own = rub.blades[tip.blade], slice(self.first[tip.blade + 1], self.first[tip.blade + 2])
            for i in range(d):
                block = (tip.line * rub.casing.directions + i) * size
                E[j * d + i, block : block + size] = np.concatenate([np.cos(n * phi), np.sin(n[1:] * phi)])
                R[j * d + i, own] = -(self.along[j][i] @ blade.rows)
            for k, other in enumerate(rub.tips):
                if other.blade == tip.blade:
                    S[j * d : j * d + d, k * d : k * d + d] = self.along[j] @ blade.S @ self.along[k].T
        R[:, : self.first[1]] = E @ rub.casing.rows
        return R, gaps, S + E @ rub.casing.S @ E.T

    def solved(self, W, b, lam):
        """Forces with W lam + b in Signorini's and Coulomb's law."""
        d = self.d
        for _ in range(5000):
            before = lam.copy()
            for j in range(self.K):
                a, tangents = j * d, slice(j * d + 1, j * d + d)
                lam[a] = max(0.0, lam[a] - (W[a] @ lam + b[a]) / W[a, a])
                if d > 1:
                    steep = np.linalg.norm(W[tangents, tangents], 2)
                    aim = lam[tangents] - (W[tangents] @ lam + b[tangents]) / steep
                    lam[tangents] = aim * min(1.0, self.mu * lam[a] / max(np.linalg.norm(aim), 1e-300))
            if np.abs(lam - before).max() <= 1e-13 * max(1.0, np.abs(lam).max()):
                return lam
        raise AssertionError("the sweeps did not settle")

    def forces(self, steps):
        """Forces of all directions at each step, (steps, K d)."""
        d, h, normal = self.d, self.h, slice(None, None, self.d)
        q, D, lam, strain = (np.zeros(size) for size in (self.first[-1], self.first[-1], self.K * d, self.K * d))
        last, now, found = self.at(-h)[1], self.at(0.0)[1], np.zeros((steps, self.K * d))
        radius = np.array([self.rub.casing.line_radius(tip.line) for tip in self.rub.tips])
        for step in range(steps):
            R, _, S = self.at(step * h)
            ahead, gaps, _ = self.at((step + 1) * h)
            free = self.alpha @ D - self.beta @ q
            gap, W, b = gaps + ahead[normal] @ (q + free), R @ self.c @ R.T + S, R @ free - strain
            W[normal] = self.share * ahead[normal] @ self.c @ R.T + S[normal]
            b[normal] = gap if self.share == 1.0 else 0.25 * (gap + 2.0 * now + last)
            if d > 1:
                b[1::d] += radius * self.omega * h
            lam = self.solved(W, b, lam)
            D = free + self.c @ R.T @ lam
            q, strain, found[step] = q + D, S @ lam, lam
            last, now = now, gaps + ahead[normal] @ q
        return found
