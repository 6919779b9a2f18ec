"""Contacts that stay closed: the linear system of modal bodies and a rim, without time stepping."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from contact.base.arrays import (
    Array,
    Indices,
    keep_readonly,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
)
from contact.base.errors import InputError
from contact.io.keys import Key
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import Rub, rub_of
from contact.model.gaps.rub_system import RubSystem, matrices_of, rub_system

Turning = Literal["casing", "blades"]
SQUARES = ("damping", "gyroscopic", "stiffness", "stiffness_by_speed")
HIGHER = ("gyroscopic_higher", "stiffness_higher")
PERFECT = 1e-8  # relative: modes closer than this are one group, and turn into each other on a perfect casing
TURNS = 1e-3  # of the rows' derivative may be left by turns: a mesh adds harmonics of its own, such as 2e-4


class SplitError(InputError):
    """A casing whose pairs are split, so that no frame has constant coefficients."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ClosedContact:
    """Modes joined by r closed contacts, in the frame in which the contact points do not change.

    (D + Omega G)^2 q + C (D + Omega G) q + K q = (Q - mu s T)^T lam, Q q + (S_nn - mu s S_nt) lam = 0, s = sgn Omega;
    C = diag(2 zeta omega) + damping + Omega gyroscopic, K = diag(omega^2) + stiffness + Omega^2 stiffness_by_speed;
    C + Omega^(2 j + 1) gyroscopic_higher[j - 1] and K + Omega^(2 j + 2) stiffness_higher[j - 1], j = 1, 2, ...
    G^T = -G, dQ/dphi = Q G: G rotates the modes as the contact point moves. C and K commute with G.

    `omega` [rad/s], `zeta` (m,); `G` (m, m); `Q`, `T` (r, m) normal and tangential rows [1/sqrt(kg)]; `S_nn`, `S_nt`
    (r, r) [m/N]; `mu` friction. The first `casing` modes are those of the body over which the contact points move, the
    others are those of the bodies with the points. `damping` [1/s], `gyroscopic` [1/s per rad/s], `stiffness` [1/s^2]
    and `stiffness_by_speed` [1/s^2 per (rad/s)^2], (m, m), and their higher powers (k, m, m) are zero where they are
    left out. Matrices by speed are zero for a body at rest; `turns` is true if the casing rotates, false if its blades
    do. `known` are the rotating bodies whose matrices are valid in a range of speeds (`ModalBody.known_speeds`).

    Raises InputError for shapes that do not fit, or a compliance that cannot be inverted.
    """

    omega: Array
    zeta: Array
    G: Array
    Q: Array
    T: Array
    S_nn: Array
    S_nt: Array
    casing: int
    mu: float = 0.0
    damping: Array | None = None
    gyroscopic: Array | None = None
    stiffness: Array | None = None
    stiffness_by_speed: Array | None = None
    gyroscopic_higher: Array | None = None
    stiffness_higher: Array | None = None
    turns: Turning = "casing"
    known: tuple[ModalBody, ...] = ()

    def __post_init__(self) -> None:
        keep_readonly(self, "omega", "zeta", "G", "Q", "T", "S_nn", "S_nt", *SQUARES, *HIGHER)
        m, r = self.omega.size, len(self.Q)
        if not r:
            raise InputError("Q: found no contact, expected a row for each contact")
        shapes = {"omega": (m,), "zeta": (m,), "G": (m, m), "Q": (r, m), "T": (r, m), "S_nn": (r, r), "S_nt": (r, r)}
        shapes |= {name: (m, m) for name in SQUARES if getattr(self, name) is not None}
        shapes |= {name: (len(part), m, m) for name in HIGHER if (part := getattr(self, name)) is not None}
        for name, shape in shapes.items():
            require_shape(name, getattr(self, name), shape)
        require_not_negative(mu=self.mu)
        lowest = float(np.linalg.eigvalsh(0.5 * (self.S_nn + self.S_nn.T))[0])
        if not lowest > 0.0:
            raise InputError(
                f"S: found {lowest:g} m/N as the smallest eigenvalue, expected > 0: give each contact a compliance"
            )

    def parts(self) -> tuple[Array, Array]:
        """Coefficients of 1, Omega, Omega^3, ... in C and of 1, Omega^2, Omega^4, ... in K, (powers, m, m) each."""
        none = np.zeros((self.omega.size,) * 2)
        C, c_by_speed, K, k_by_speed = (
            none if getattr(self, name) is None else np.asarray(getattr(self, name)) for name in SQUARES
        )
        more = [() if getattr(self, name) is None else getattr(self, name) for name in HIGHER]
        return (
            np.array([C + np.diag(2.0 * self.zeta * self.omega), c_by_speed, *more[0]]),
            np.array([K + np.diag(self.omega**2), k_by_speed, *more[1]]),
        )

    def matrices(self, speed: float) -> tuple[Array, Array]:
        """C and K at a speed [rad/s], (m, m). Raises InputError at a speed for which those of a body are not known."""
        self.require_known(speed)
        C, K = self.parts()
        odd, even = powers(speed, len(C), len(K))
        return np.tensordot(odd, C, 1), np.tensordot(even, K, 1)

    def require_known(self, speed: Array | float) -> None:
        """Raise InputError at speeds [rad/s] for which the matrices of a rotating body are not known."""
        for body in self.known:
            body.require_known(speed)

    @property
    def known_speeds(self) -> tuple[float, float]:
        """Lowest and highest magnitude of the speed [rad/s] at which the matrices of all bodies are known."""
        ranges = [body.known_speeds for body in self.known if body.known_speeds is not None]
        low, high = (np.array([one[end] for one in ranges]) for end in (0, 1))
        return float(low.max(initial=0.0)), float(high.min(initial=math.inf))

    @property
    def rates(self) -> Array:
        """Scale of each mode's velocity [rad/s], (m,): its own frequency; for a rigid mode the highest one."""
        highest = float(self.omega.max(initial=0.0)) or 1.0
        return np.where(self.omega > 0.0, self.omega, highest)

    def pushes(self, sense: float) -> Array:
        """W = Q - mu s T, (r, m): modal forces of unit contact forces, with the sense of rotation s."""
        return np.asarray(self.Q - self.mu * sense * self.T)

    def compliance(self, sense: float) -> Array:
        """S = S_nn - mu s S_nt, (r, r)."""
        return np.asarray(self.S_nn - self.mu * sense * self.S_nt)


def powers(speed: Array | float, odd: int, even: int) -> tuple[Array, Array]:
    """1, Omega, Omega^3, ... and 1, Omega^2, Omega^4, ..., (..., odd) and (..., even).

    >>> powers(2.0, 3, 4)
    (array([1., 2., 8.]), array([ 1.,  4., 16., 64.]))
    """
    at = np.asarray(speed, dtype=float)[..., None]
    return at ** np.maximum(2.0 * np.arange(odd) - 1.0, 0.0), at ** (2.0 * np.arange(even))


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalPair:
    """Two equal modes cos n theta and sin n theta of a body of revolution, or (n = 0) one mode of a blade.

    `freq_hz` [Hz]; `modal_mass` [kg] for unit motion along the contact's normal; `zeta` damping ratio.

    >>> ModalPair(n=8, freq_hz=300.0, modal_mass=1.5).omega
    1884.9555921538758
    """

    freq_hz: Annotated[float, Key("frequency [Hz]", "positive", "frequency")]
    modal_mass: Annotated[float, Key("modal mass for unit motion along the contact normal [kg]", "positive", "mass")]
    n: int = 0
    zeta: Annotated[float, Key("damping ratio [-]", "ratio", "zeta")] = 0.0

    def __post_init__(self) -> None:
        require_positive(freq_hz=self.freq_hz, modal_mass=self.modal_mass)
        if not (0 <= self.n < math.inf and self.n % 1 == 0):
            raise InputError(f"n: found {self.n!r}, expected a whole number of nodal diameters >= 0")
        if not 0.0 <= self.zeta < 1.0:
            raise InputError(f"zeta: found {self.zeta!r}, expected 0 <= zeta < 1")

    @property
    def omega(self) -> float:
        """Angular frequency [rad/s]."""
        return 2.0 * math.pi * self.freq_hz


@dataclass(frozen=True, slots=True, kw_only=True)
class HandPair:
    """Hand calculation: a pair of n diameters of a casing at rest and one mode of a blade that moves around it.

    `compliance` S [m/N] of the contact, 1/stiffness; `friction` mu; `lean_deg` the lean a of the blade into the motion.
    The blade's mode is a bending across its span: unit motion along the normal comes with cot a along the rim, so the
    contact drives it with kappa = (1 - mu cot a)/modal_mass, negative (the blade digs) where mu > tan a > 0. At a = 0
    it moves along the normal alone. The casing's pair is inextensional: tangential over radial motion is 1/n.

    >>> pair = HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                 blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> pair.kappa
    2.5
    """

    casing: ModalPair
    blade: ModalPair
    compliance: float
    friction: float = 0.0
    lean_deg: float = 0.0

    def __post_init__(self) -> None:
        require_positive(compliance=self.compliance)
        require_not_negative(friction=self.friction)
        require_finite(lean_deg=self.lean_deg)
        if self.casing.n < 1:
            raise InputError(f"casing.n: found {self.casing.n!r}, expected at least 1 nodal diameter")
        if self.blade.n != 0:
            raise InputError(f"blade.n: found {self.blade.n!r}, expected 0: one blade has no nodal diameters")
        if not -90.0 < self.lean_deg < 90.0:
            raise InputError(f"lean_deg: found {self.lean_deg!r}, expected an angle between -90 and 90")

    @property
    def slip(self) -> float:
        """Motion of the blade along the rim for unit motion along the normal, cot a; 0 without lean."""
        return 1.0 / math.tan(math.radians(self.lean_deg)) if self.lean_deg else 0.0

    @property
    def kappa(self) -> float:
        """(1 - mu cot a)/modal_mass [1/kg]; negative if friction drives the blade into the casing."""
        return (1.0 - self.friction * self.slip) / self.blade.modal_mass

    def contact(self) -> ClosedContact:
        """Three modes and one contact: the system of 6 states."""
        casing, blade = self.casing, self.blade
        x, y = 1.0 / math.sqrt(casing.modal_mass), 1.0 / math.sqrt(blade.modal_mass)
        return ClosedContact(
            omega=np.array([casing.omega, casing.omega, blade.omega]),
            zeta=np.array([casing.zeta, casing.zeta, blade.zeta]), G=turning([casing.n], 3),
            Q=np.array([[x, 0.0, -y]]), T=np.array([[0.0, x / casing.n, -y * self.slip]]),
            S_nn=np.array([[self.compliance]]), S_nt=np.zeros((1, 1)), casing=2, mu=self.friction, turns="blades",
        )  # fmt: skip


def disk_contact(casing: ModalPair, disk: ModalPair, *, stiffness: float, blades: int) -> ClosedContact:
    """A bladed disk in a casing, each by its pair of n diameters, every blade tip in contact by `stiffness` [N/m].

    The two-dimensional model of M. Legrand, C. Pierre, P. Cartraud, J.-P. Lombard (J. Sound Vib. 319, 2009, 366) with
    the contact closed, frictionless, in the disk's frame: sum over the tips of k (u_c - u_b)^2/2 = (k blades/4)
    |z_c - z_b|^2, so two contacts of stiffness k blades/2 join cosine to cosine and sine to sine.

    Raises InputError unless both have the same n >= 1 and `blades` > 2 n, so that the tips distinguish cosine from
    sine.

    >>> import contact as ct
    >>> casing, disk = ModalPair(n=5, freq_hz=300.0, modal_mass=2.0), ModalPair(n=5, freq_hz=120.0, modal_mass=1.0)
    >>> contact = disk_contact(casing, disk, stiffness=1e3, blades=22)
    >>> found = ct.stability.of_contact(contact, np.linspace(80.0, 88.0, 9))
    >>> round(found.peak_speed_hz, 2)  # (300 + 120)/5 = 84 without contact
    84.28
    """
    require_waves(casing, disk, stiffness=stiffness, blades=blades)
    omega, zeta = ([getattr(body, name) for body in (casing, disk) for _ in range(2)] for name in ("omega", "zeta"))
    x, y = 1.0 / math.sqrt(casing.modal_mass), 1.0 / math.sqrt(disk.modal_mass)
    return ClosedContact(
        omega=np.array(omega), zeta=np.array(zeta), G=turning([casing.n], 4),
        Q=np.hstack([x * np.eye(2), -y * np.eye(2)]), T=np.zeros((2, 4)),
        S_nn=np.eye(2) * 2.0 / (stiffness * blades), S_nt=np.zeros((2, 2)), casing=2, turns="blades",
    )  # fmt: skip


def require_waves(casing: ModalPair, disk: ModalPair, *, stiffness: float, blades: int) -> None:
    """Raise InputError unless both have the same n >= 1 and there are more than 2 n blades."""
    require_positive(stiffness=stiffness)
    if casing.n != disk.n or casing.n < 1 or blades <= 2 * casing.n:
        found = f"casing {casing.n}, disk {disk.n}, {blades} blades"
        raise InputError(f"n: found {found}, expected the same n >= 1 for both pairs and more than 2 n blades")


def turning(n: list[int], size: int) -> Array:
    """G of leading pairs (cos, sin) of n diameters: d/dphi of (cos n phi, sin n phi), (size, size)."""
    G = np.zeros((size, size))
    for k, order in enumerate(n):
        G[2 * k, 2 * k + 1], G[2 * k + 1, 2 * k] = order, -order
    return G


def rim_contact(rim: RotatingRim, *, mu: float = 0.0) -> ClosedContact:
    """A perfect casing against its blade in permanent contact, in the form of `rub_contact`.

    >>> import numpy as np
    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> seen = {"channels": ("span", "flap"), "rows": [[0.0], [1.0]], "S": 1e-8 * np.eye(2)}
    >>> blade = ct.ModalBody(omega=[900.0], zeta=[0.0], **seen)
    >>> closed = rim_contact(ct.RotatingRim(casing, blade, clearance=0.0, speed_hz=5.0, lean_deg=10.0), mu=0.1)
    >>> ct.stability.poles(closed, [20.0]).shape  # two bodies of two modes and one
    (1, 6)
    """
    return rub_contact(rim, mu=mu)


def rub_contact(what: Rub | RotatingRim, *, mu: float = 0.0) -> ClosedContact:
    """A perfect casing with every tip of a rub in permanent sliding contact, in the tips' frame.

    Profile, closing and whirl only force the vibration and are left out. The frequencies of each pair must agree to
    1e-8 and its shapes rotate into each other to 1e-3. Damping, stiffness, rotation and S must be the same at all
    angles. Raises SplitError if not: the coefficients are then periodic in time (`contact.stability.split_casing`).
    """
    rub: Rub = rub_of(what)
    system = rub_system(rub, 2)
    rim, m, K = system.rim, rub.casing.omega.size, system.contacts
    seen = [int(line) * system.directions + i for line in np.unique(system.line) for i in (0, 1)]
    G = np.zeros((system.omega.size,) * 2)
    tables = [table[b] for b in seen for table in (rim.cos, rim.sin)]
    G[:m, :m], left = _generator(rub.casing.omega, rub.casing.zeta, tables)
    S, varies = mean_compliance(system, rub.casing.n_max)
    squares: dict[str, Any] = bodies_squares(rub)
    each = [part[..., :m, :m].reshape(-1, m, m) for part in squares.values()]
    left = max([left, *(_varies(part, G[:m, :m]) for parts in each for part in parts)])
    if left > TURNS or varies > TURNS:
        found = f"split mode pairs (residual {left:.1e} of their rows) or S that depends on the angle"
        expected = "a perfect casing; a casing with split pairs needs Floquet's theory"
        raise SplitError(f"casing: found {found}, expected {expected}")
    rows = np.zeros((2, K, system.omega.size))
    for j in range(K):
        for i in (0, 1):
            rows[i, j, :m] = rim.rows(int(system.line[j]) * system.directions + i, float(system.angle[j]))
            begin, end = system.own[j]
            rows[i, j, begin:end] = system.blade_rows[2 * j + i, : end - begin]
    return ClosedContact(
        omega=system.omega, zeta=system.zeta, G=G, Q=rows[0], T=rows[1], S_nn=S[::2, ::2], S_nt=S[::2, 1::2], casing=m,
        mu=mu, turns=rub.turning, known=_limited(rub), **squares,
    )  # fmt: skip


def _limited(rub: Rub) -> tuple[ModalBody, ...]:
    """Rotating bodies whose matrices are valid in a range of speeds."""
    seen = matrices_of(rub)
    found = zip(seen.bodies, seen.senses, strict=True)
    return tuple(body for body, sense in found if sense and body.known_speeds is not None)


def bodies_squares(rub: Rub) -> dict[str, Array]:
    """The matrices of `ClosedContact` of all bodies at the speed of the rub, (m, m) or (k, m, m) each."""
    parts: dict[str, list[Array]] = {name: [] for name in (*SQUARES, *HIGHER)}
    seen = matrices_of(rub)
    given = {1 + stiff.blade: stiff for stiff in rub.stiffening}
    bodies = [body.powers_of_speed() for body in seen.bodies]
    odd, even = (max(len(body[k]) for body in bodies) for k in (0, 1))
    for k, (body, turns) in enumerate(zip(seen.bodies, seen.senses, strict=True)):
        m = body.omega.size
        C, K = np.zeros((odd, m, m)), np.zeros((even, m, m))
        C[: len(bodies[k][0])], K[: len(bodies[k][1])] = bodies[k]
        C, K[1:] = turns * C, turns**2 * K[1:]
        if k in given:
            by_speed = given[k].stiffness_by_speed
            K[0] -= (2.0 * math.pi * given[k].at_hz) ** 2 * by_speed
            K[1] += by_speed
        rest = [np.zeros((m, m)) if part is None else part for part in (body.damping, body.stiffness)]
        own = rest[0], C[0], rest[1] + K[0], K[1], C[1:], K[2:]
        for name, part in zip(parts, own, strict=True):
            parts[name].append(part)
    return {name: _block_diagonal(found) for name, found in parts.items() if any(part.any() for part in found)}


def _block_diagonal(blocks: list[Array]) -> Array:
    """Blocks (..., m, m) along the diagonal."""
    size = sum(block.shape[-1] for block in blocks)
    whole, first = np.zeros((*blocks[0].shape[:-2], size, size)), 0
    for block in blocks:
        here = slice(first, first + block.shape[-1])
        whole[..., here, here] = block
        first = here.stop
    return whole


def _varies(part: Array, G: Array) -> float:
    """Relative dependence of a matrix of the casing's modes on the angle: |G X - X G| over |G X|."""
    size = float(np.linalg.norm(G @ part))
    return float(np.linalg.norm(G @ part - part @ G)) / size if size else 0.0


def mean_compliance(system: RubSystem, n_max: int) -> tuple[Array, float]:
    """Residual compliance between the tips, averaged over a turn, (K d, K d), and its relative deviation."""
    if not system.turns:
        return system.compliance(0.0), 0.0
    count = 4 * n_max + 1  # more than twice its highest wave: the mean is exact
    around = np.array([system.compliance(turn) for turn in np.arange(count) * (2.0 * np.pi / count)])
    mean = around.mean(axis=0)
    return mean, float(np.abs(around - mean).max() / np.abs(mean).max())


def equal_modes(omega: Array, zeta: Array) -> list[Indices]:
    """Groups of modes of equal frequency and damping, by index."""
    ascending = np.argsort(omega, kind="stable")
    apart = (np.diff(omega[ascending]) > PERFECT * omega[ascending][1:]) | (np.diff(zeta[ascending]) != 0.0)
    return [group for group in np.split(ascending, np.flatnonzero(apart) + 1) if group.size]


def _generator(omega: Array, zeta: Array, tables: list[Array]) -> tuple[Array, float]:
    """G with dQ/dphi = Q G within groups of equal modes, and the residual of the derivative."""
    order = np.arange(len(tables[0]))[:, None]
    rows = np.vstack(tables)
    pairs = zip(tables[::2], tables[1::2], strict=True)
    slope = np.vstack([part for cos, sin in pairs for part in (order * sin, -order * cos)])
    G = np.zeros((omega.size, omega.size))
    for group in equal_modes(omega, zeta):
        block = np.linalg.lstsq(rows[:, group], slope[:, group], rcond=1e-9)[0]
        G[np.ix_(group, group)] = 0.5 * (block - block.T)
    size = float(np.linalg.norm(slope))
    return G, float(np.linalg.norm(slope - rows @ G)) / size if size else 0.0
