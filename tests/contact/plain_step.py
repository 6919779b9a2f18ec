"""One step of contacts in plain NumPy, of whole matrices: bodies with any C and K, any number of contacts, friction.

q'' + C q' + K q = f + R^T lam of all bodies, rows R(t) of the contacts' directions, normal first. With Phi = exp(A h),
Psi = exp(-A h), A = [0 I; -K -C]: X = Phi_12 Psi_12^-1, T = Phi_11 - X Psi_11, alpha = -X, beta = I - T - X and
c = beta K^-1. D* = alpha D - beta q + c f; gaps of q_(n+1) (or means of three) + S lam and slips
T D + S (lam - lam_old) + what slides by itself obey Coulomb's law together with Signorini's, with a force-depth law, or
with bars of a coating, which flow after each step. Forces are found by projected Gauss-Seidel sweeps.
"""

import math
from collections import Counter

import numpy as np
from scipy.linalg import block_diag, expm


class Plain:
    """Contacts whose `at(t)` gives rows, gaps of the bodies at rest and residual compliance; forces by `forces`."""

    def __init__(self, C, K, *, law, h, averaged, contacts, dimensions):
        self.law, self.mu, self.h, self.share = law, law.mu, h, 0.25 if averaged else 1.0
        self.K, self.d, m = contacts, dimensions, len(K)
        A = np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]])
        phi, psi = expm(A * h), expm(-A * h)
        X = phi[:m, m:] @ np.linalg.inv(psi[:m, m:])
        self.alpha, self.beta = -X, np.eye(m) - (phi[:m, :m] - X @ psi[:m, :m]) - X
        self.c = self.beta @ np.linalg.inv(K)
        self.psi, self.stiffness = psi, K
        self.begin, self.load = (np.zeros(m), np.zeros(m)), np.zeros(m)

    def slides(self, t):
        """What slides by itself along each direction in the step after t."""
        return np.zeros(self.K * self.d)

    def response(self, depth, past, bars):
        """Force of one contact at a depth; None of a rigid one."""
        if bars is not None:
            return bars.force(depth)
        if self.law.response is None:
            return None
        return self.law.response(depth, (1.5 * depth - 2.0 * past[0] + 0.5 * past[1]) / self.h)[0]

    def pressed(self, yields, gap, past, bars):
        """Force of one contact with a free gap."""
        if gap >= 0.0 or self.response(0.0, past, bars) is None:
            return max(0.0, -gap / yields)
        low, high = 0.0, -gap
        for _ in range(60):
            depth = 0.5 * (low + high)
            opened = depth + yields * self.response(depth, past, bars) + gap
            low, high = (low, depth) if opened > 0.0 else (depth, high)
        return max(0.0, -(gap + depth) / yields)

    def bars(self, t):
        """What is under each contact at t, None where it is not coated."""
        return [None] * self.K

    def solved(self, W, b, lam, past, bars):
        """Forces with W lam + b in the laws."""
        d = self.d
        for _ in range(5000):
            before = lam.copy()
            for j in range(self.K):
                a, tangents = j * d, slice(j * d + 1, j * d + d)
                lam[a] = self.pressed(W[a, a], W[a] @ lam + b[a] - W[a, a] * lam[a], past[j], bars[j])
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
        (q, velocity), (lam, strain) = self.begin, np.zeros((2, self.K * d))
        rest, m = np.linalg.solve(self.stiffness, self.load), q.size
        D = q - rest - self.psi[:m, :m] @ (q - rest) - self.psi[:m, m:] @ velocity
        now, last = (self.at(t)[1] + self.at(t)[0][normal] @ x for t, x in ((0.0, q), (-h, q - D)))
        found, past = np.zeros((steps, self.K * d)), -np.stack([now, last], axis=1)
        for step in range(steps):
            R, _, S = self.at(step * h)
            ahead, gaps, _ = self.at((step + 1) * h)
            free = self.alpha @ D - self.beta @ q + self.c @ self.load
            gap, W, b = gaps + ahead[normal] @ (q + free), R @ self.c @ R.T + S, R @ free - strain
            W[normal] = self.share * ahead[normal] @ self.c @ R.T + S[normal]
            b[normal] = gap if self.share == 1.0 else 0.25 * (gap + 2.0 * now + last)
            b += self.slides(step * h)
            bars = self.bars(step * h)
            lam = self.solved(W, b, lam, past, bars)
            D = free + self.c @ R.T @ lam
            q, strain, found[step] = q + D, S @ lam, lam
            last, now = now, gaps + ahead[normal] @ q
            past = np.stack([-(W @ lam + b)[normal], past[:, 0]], axis=1)
            for under, depth, force in zip(bars, past[:, 0], lam[normal], strict=True):
                if under is not None and force > 0.0:
                    under.flow(depth)
        return found


class Bars:
    """Bars of a `ct.Abradable` under one tip: `worn` of the whole track, which `flow` changes, and the cut there."""

    def __init__(self, law, worn, phi, cut, length):
        n = worn.size
        first = math.floor(phi / (2.0 * math.pi) % 1.0 * n - 0.5 * (law.bars - 1))
        self.law, self.worn, self.own = law, worn, (first + np.arange(law.bars)) % n
        self.area, self.cut = law.width * length / n, cut

    def depths(self, depth):
        """Worn depths of the bars where the tip presses to `depth`: stress E (d - w)/t <= Y + H w/t, no more than t."""
        law = self.law
        flown = (law.E * (depth - self.cut) - law.yield_stress * law.thickness) / (law.E + law.hardening)
        return np.maximum(self.worn[self.own], min(flown, law.thickness - self.cut))

    def force(self, depth):
        """Sum of the stresses by the area of one bar."""
        strain = np.maximum(depth - self.cut - self.depths(depth), 0.0) / self.law.thickness
        return self.area * self.law.E * strain.sum()

    def flow(self, depth):
        """Wear the bars."""
        self.worn[self.own] = self.depths(depth)


class PlainRub(Plain):
    """A `ct.Rub` without loads; modes that a speed couples need a constant speed.

    `worn` after `forces`: of a coating, by line and number of the track.
    """

    def __init__(self, rub, *, law, h, averaged):
        self.rub, omega = rub, rub.speed.omega(0.0)
        senses = (1, *(0 for _ in rub.blades)) if rub.turning == "casing" else (0, *(-1 for _ in rub.blades))
        pairs = [body.matrices(sense * omega) for body, sense in zip(rub.bodies, senses, strict=True)]
        C, K = (block_diag(*[pair[k] for pair in pairs]) for k in (0, 1))
        dimensions = rub.dimensions if law.mu else 1
        super().__init__(C, K, law=law, h=h, averaged=averaged, contacts=len(rub.tips), dimensions=dimensions)
        self.first = np.cumsum([0, *(body.omega.size for body in rub.bodies)])
        self.along = [tip.directions(rub.blades[tip.blade])[: self.d] for tip in rub.tips]
        self.worn, self.tracks, places = {}, [], Counter()
        for tip in rub.tips if law.coating else ():
            self.tracks.append((tip.line, places[tip.blade, tip.line]))
            places[tip.blade, tip.line] += 1
            around = 2.0 * math.pi * rub.casing.line_radius(tip.line) * law.bars / law.tip
            self.worn[self.tracks[-1]] = np.zeros(round(around))

    def bars(self, t):
        """Bars under the tips at t; they were cut to a circle `machined` beyond the rim's highest point."""
        if not self.worn:
            return super().bars(t)
        found, rub = [], self.rub
        for tip, track in zip(rub.tips, self.tracks, strict=True):
            worn, length = self.worn[track], 2.0 * math.pi * rub.casing.line_radius(tip.line)
            made = [rub.profile(2.0 * math.pi * (k + 0.5) / worn.size) for k in range(worn.size)]
            phi = math.radians(tip.angle_deg) - rub.speed.angle(t)
            cut = max(min(made) + self.law.machined - rub.profile(phi), 0.0) if self.law.machined else 0.0
            found.append(Bars(self.law, worn, phi, cut, length))
        return found

    def slides(self, t):
        """The rim turns past the tips."""
        found = np.zeros((self.K, self.d))
        found[:, 1:2] = [[self.rub.casing.line_radius(tip.line)] for tip in self.rub.tips]
        return found.ravel() * self.rub.speed.omega(t) * self.h

    def at(self, t):
        """Rows of all directions (K d, m), gaps of the bodies at rest (K,), residual compliance (K d, K d)."""
        rub, N, d = self.rub, self.rub.casing.n_max, self.d
        n, size, turned = np.arange(N + 1), 2 * N + 1, rub.speed.angle(t)
        R, gaps = np.zeros((self.K * d, self.first[-1])), np.zeros(self.K)
        E, S = np.zeros((self.K * d, len(rub.casing.channels))), np.zeros((self.K * d, self.K * d))
        for j, tip in enumerate(rub.tips):
            phi = math.radians(tip.angle_deg) - turned
            gaps[j] = rub.clearance + tip.clearance + rub.profile(phi) - rub.closing.at(t)
            for w in rub.whirl:
                beta = math.radians(w.phase_deg) + w.per_rev * turned + 2.0 * math.pi * w.hz * t
                gaps[j] += w.amplitude * math.cos(phi - beta)
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


class PlainPatch(Plain):
    """A `ct.Patch` of modes that all have a stiffness."""

    def __init__(self, patch, *, law, h, averaged):
        every = 1 if law.mu else patch.dimensions
        rows, S = patch.rows()[::every], patch.compliance()[::every, ::every]
        k, d = patch.contacts, len(rows) // patch.contacts
        super().__init__(*patch.body.matrices(0.0), law=law, h=h, averaged=averaged, contacts=k, dimensions=d)
        self.always, self.load = (rows, patch.opening, S), patch.load
        self.begin, self.ground = (patch.displacement, patch.velocity), np.zeros((k, d))
        if d > 1:
            self.ground[:, 1:] = patch.slide

    def at(self, t):
        """Rows, gaps and residual compliance."""
        return self.always

    def slides(self, t):
        """The ground moves."""
        return -self.ground.ravel() * self.h
