"""Linear schemes once more, with whole matrices and contacts found by trying: what the step loops are compared with."""

from dataclasses import dataclass, field
from itertools import product

import numpy as np

M = np.array([[1.3, 0.2, 0.0], [0.2, 2.1, -0.1], [0.0, -0.1, 0.7]])
C = np.array([[0.5, -0.1, 0.0], [-0.1, 0.4, 0.05], [0.0, 0.05, 0.3]])
K = np.array([[31.0, -11.0, 0.0], [-11.0, 29.0, -17.0], [0.0, -17.0, 23.0]])
FULL = K + np.array([[7.0, 0.0, -6.0], [0.0, 0.0, 0.0], [-6.0, 0.0, 8.0]])  # the first dof coupled to the last
LOAD, SHAPES = np.array([0.4, -3.0, 0.7]), np.array([[0.3, 3.0, -1.0], [1.0, 0.0, 0.5]])
Q = np.array([[0.0, 0.3, -1.0], [1.0, -0.4, 0.0]])
GAP0, U0, V0 = np.array([0.05, 0.04]), np.array([0.01, 0.02, -0.01]), np.array([-1.0, 0.3, 2.0])


def amplitudes(t):
    """Of both varying loads."""
    return np.array([9.0 * np.sin(8.0 * t) + 0.5, 7.0 * t - 20.0 * np.cos(8.0 * t)])


def pressed(W, gap):
    """Forces >= 0 with gaps W force + gap >= 0, complementary, by trying every set of closed contacts; inf is open."""
    for closed in product([False, True], repeat=len(gap)):
        c, force = np.flatnonzero(closed), np.zeros(len(gap))
        if not np.isfinite(gap[c]).all():
            continue
        force[c] = np.linalg.solve(W[np.ix_(c, c)], -gap[c])
        rest = np.isfinite(gap) & ~np.array(closed)
        if (force >= 0.0).all() and ((W @ force)[rest] + gap[rest] >= 0.0).all():
            return force
    raise AssertionError("no set of closed contacts")


@dataclass
class Note:
    """What a step says of the contacts: forces, gaps, works, the line along which a gap closes, when one opens."""

    force: np.ndarray
    gap: np.ndarray
    work: np.ndarray
    line: tuple
    opened: float
    time: float


@dataclass
class Dense:
    """One run: state, sums of works, what was noted at each step. `w` = (am, af, beta, gamma)."""

    h: float
    e: float = 0.0
    w: tuple = (0.0, 0.0, 0.25, 0.5)
    theta: float = 0.5
    soft: float = 0.0
    C: np.ndarray = field(default_factory=lambda: C)
    K: np.ndarray = field(default_factory=lambda: K)
    u: np.ndarray = field(default_factory=U0.copy)
    v: np.ndarray = field(default_factory=V0.copy)
    a: np.ndarray = field(default_factory=lambda: np.zeros(3))
    last: np.ndarray = field(default_factory=lambda: np.zeros(2))
    external: float = 0.0
    damping: float = 0.0

    def __post_init__(self):
        self.a = np.linalg.solve(M, self.net(0.0, self.u, self.v))

    def net(self, t, u, v):
        return LOAD + amplitudes(t) @ SHAPES - self.C @ v - self.K @ u

    def gap(self, u):
        return GAP0 + Q @ u

    def energy(self):
        return 0.5 * self.v @ M @ self.v + 0.5 * self.u @ self.K @ self.u - LOAD @ self.u

    def works(self, t, du, rate):
        self.external += 0.5 * (amplitudes(t) + amplitudes(t + self.h)) @ SHAPES @ du
        self.damping -= du @ self.C @ rate

    def end(self, u, v, a):
        self.u, self.v, self.a = u, v, a

    def smooth(self, t, nu, jump):
        """u, v, a at the end of a step of generalised alpha with nu added to u and a jump to v."""
        am, af, beta, gamma = self.w
        h, u0, v0, a0 = self.h, self.u, self.v, self.a
        u = u0 + h * v0 + h * h * (0.5 - beta) * a0 + nu
        v = v0 + h * (1.0 - gamma) * a0 + jump
        A = (1.0 - am) * M + (1.0 - af) * (gamma * h * self.C + beta * h * h * self.K)
        a = np.linalg.solve(A, (1.0 - af) * self.net(t + h, u, v) + af * self.net(t, u0, v0) - am * M @ a0)
        return u + beta * h * h * a, v + gamma * h * a, a

    def alpha(self, t):
        am, af, beta, gamma = self.w
        h, (u, v, a) = self.h, self.smooth(t, 0.0, 0.0)
        A = (1.0 - am) * M + (1.0 - af) * (gamma * h * self.C + beta * h * h * self.K)
        push = np.linalg.solve(A, Q.T)
        free = self.gap(u)
        force = pressed(beta * h * h * Q @ push + self.soft * np.eye(2), free)
        a, u, v = a + push @ force, u + beta * h * h * push @ force, v + gamma * h * push @ force
        du, line = u - self.u, (t, self.gap(self.u), free)
        self.works(t, du, 0.5 * (self.v + v))
        found = Note(force, self.gap(u), 0.5 * (self.last + force) * (Q @ du), line, t + 0.5 * h, t + h)
        self.end(u, v, a)
        self.last = force
        return found

    def impulses(self, t, u, v, impulse):
        """What schemes note that have impulses."""
        force, du, was = impulse / self.h, u - self.u, self.gap(self.u)
        self.works(t, du, 0.5 * (self.v + v))
        line = (t, was, was + self.h * Q @ self.v)
        return Note(force, self.gap(u), force * (Q @ du), line, t, t + 0.5 * self.h)

    def moreau(self, t):
        h, theta, u0, v0 = self.h, self.theta, self.u, self.v
        A = M + h * theta * self.C + h * h * theta**2 * self.K
        load = LOAD + ((1.0 - theta) * amplitudes(t) + theta * amplitudes(t + h)) @ SHAPES
        dv = np.linalg.solve(A, h * (load - self.C @ v0 - self.K @ (u0 + theta * h * v0)))
        push = np.linalg.solve(A, Q.T)
        near = self.gap(u0 + 0.5 * h * v0) <= 0.0
        impulse = pressed(Q @ push, np.where(near, Q @ (v0 + dv) + self.e * Q @ v0, np.inf))
        dv = dv + push @ impulse
        u, v = u0 + h * (v0 + theta * dv), v0 + dv
        found = self.impulses(t, u, v, impulse)
        self.end(u, v, self.a)
        return found

    def nonsmooth(self, t):
        jumps = np.linalg.solve(M, Q.T)

        def after(impulse):
            return self.smooth(t, 0.5 * self.h * jumps @ impulse, jumps @ impulse)

        free = after(np.zeros(2))
        W = np.stack([Q @ (after(one)[1] - free[1]) for one in np.eye(2)], axis=1)
        near = self.gap(free[0]) <= 0.0
        impulse = pressed(W, np.where(near, Q @ free[1] + self.e * Q @ self.v, np.inf))
        u, v, a = after(impulse)
        found = self.impulses(t, u, v, impulse)
        self.end(u, v, a)
        return found

    def projected(self, t):
        jumps = np.linalg.solve(M, Q.T)

        def after(both):
            return self.smooth(t, jumps @ both[:2], jumps @ both[2:])

        def held(both):
            u, v, _ = after(both)
            return np.concatenate([self.gap(u), Q @ (v + self.e * self.v)])

        free = held(np.zeros(4))
        W = np.stack([held(one) - free for one in np.eye(4)], axis=1)
        for closed in product([False, True], repeat=4):
            c, both = np.flatnonzero(closed), np.zeros(4)
            if any(closed[k + 2] and not closed[k] for k in range(2)):
                continue
            both[c] = np.linalg.solve(W[np.ix_(c, c)], -free[c])
            rest = (W @ both + free)[[k for k in range(4) if not closed[k] and (k < 2 or closed[k - 2])]]
            if (both >= 0.0).all() and (rest >= 0.0).all():
                break
        else:
            raise AssertionError("no set of closed contacts")
        u, v, a = after(both)
        found = self.impulses(t, u, v, both[2:])
        self.end(u, v, a)
        return found

    def stabilised(self, t):
        h, u0, v0 = self.h, self.u, self.v
        jumps = np.linalg.solve(M, Q.T)
        ahead = u0 + h * v0 + jumps @ pressed(Q @ jumps, self.gap(u0 + h * v0))
        A = M + 0.5 * h * self.C + 0.25 * h * h * self.K
        load = LOAD + 0.5 * (amplitudes(t) + amplitudes(t + h)) @ SHAPES
        dv = np.linalg.solve(A, h * (load - self.C @ v0 - 0.5 * self.K @ (u0 + ahead)))
        push = h * np.linalg.solve(A, Q.T)
        force = pressed(0.5 * h * Q @ push, self.gap(ahead + 0.5 * h * dv))
        dv = dv + push @ force
        u, v = ahead + 0.5 * h * dv, v0 + dv
        found = self.impulses(t, u, v, h * force)
        self.end(u, v, self.a)
        return found


@dataclass
class Leapfrog(Dense):
    """The same by central differences; `v` holds the last increment."""

    rule: str = "forward"
    stiffness: float = 0.0

    def __post_init__(self):
        super().__post_init__()
        self.v = self.h * self.v - 0.5 * self.h**2 * self.a

    def energy(self):
        kinetic = 0.5 * self.v @ M @ self.v / self.h**2
        before = self.u - self.v
        return kinetic + 0.5 * before @ self.K @ self.u - 0.5 * LOAD @ (before + self.u)

    def leapfrog(self, t):
        h, u0, D, e = self.h, self.u, self.v, self.e
        A = M / h**2 + 0.5 * self.C / h
        free = D + np.linalg.solve(A, self.net(t, u0, D / h))
        push, now = np.linalg.solve(A, Q.T), self.gap(u0)
        W = Q @ push
        if self.rule == "spring":
            force = self.stiffness * np.maximum(-now, 0.0)
        elif self.rule == "impulse":
            force = pressed(W, np.where(now > 0.0, np.inf, Q @ free + e * Q @ D))
        else:
            force = pressed(W / (1.0 + e), self.gap(u0 + (free - e * D) / (1.0 + e)))
        d = free + push @ force
        mean, early = 0.5 * (D + d), self.rule in ("spring", "impulse")
        self.external += amplitudes(t) @ SHAPES @ mean
        self.damping -= mean @ self.C @ mean / h
        gap = now if early else self.gap(u0 + (d - e * D) / (1.0 + e))
        line = (t - h, self.gap(u0 - D), now) if early else (t, now, self.gap(u0 + free))
        found = Note(force, gap, force * (Q @ mean), line, t - 0.5 * h, t)
        self.end(u0 + d, d, self.a)
        self.deepest = now if early else self.gap(self.u)
        return found
