"""A thin elastic ring in its plane, as a modal basis of kind "rim": in closed form, and by finite elements.

Radial w and tangential v, strains (Love; Soedel, Vibrations of Shells and Plates, 2004, ch. 5)

    eps = (v' + w)/R,  kappa = (v' - w'')/R^2,  2 U = int (EA eps^2 + EI kappa^2 + k_r w^2 + k_t v^2) R dtheta,

without strain in rigid motions. The ring rests on springs k_r, k_t [N/m per m] or floats. In its own frame, which
rotates with its springs at Omega, there are also Coriolis forces, and stiffening by the hoop tension N Omega^2 with
Green's strain minus spin softening (line mass m):

    v_i' G v_j = 2 m int (v_i w_j' - w_i v_j') R dtheta,  N = m R^2/(1 + k_r R^2/EA),
    2 U_1 = N int [3 (v' + w)^2 + (w' - v)^2]/R dtheta - m int (w^2 + v^2) R dtheta.

In 3 (v' + w)^2 one part comes from the stress and two from the strain N/EA of the steady state.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from contact.base.arrays import Array, Indices, require_count, require_positive
from contact.base.errors import InputError
from contact.base.keyed import require_keyed
from contact.io.keys import Key
from contact.model.bodies.channels import rim_channels
from contact.model.bodies.modal_body import ModalBody

RIGID = 1e-9  # of the largest eigenvalue: what round-off leaves of a rigid motion


@dataclass(frozen=True, slots=True, kw_only=True)
class ThinRing:
    """Ring of mean `radius` [m], section `width` (along the axis) times `height` (radial) [m], E [Pa], rho [kg/m^3].

    `k_r`, `k_t` [N/m per m] support it radially and tangentially; `zeta` damps every mode.

    Raises InputError for a value that is not physical.

    >>> ring = ThinRing(radius=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6)
    >>> [round(f, 2) for f in ring.frequencies(2)]
    [161.65, 3694.07]
    """

    radius: float
    width: Annotated[float, Key("width of the section along the axis [m]", "positive", "thickness")]
    height: Annotated[float, Key("height of the section along the radius [m]", "positive", "thickness")]
    E: Annotated[float, Key("Young's modulus [Pa]", "positive", "E")]
    rho: Annotated[float, Key("density [kg/m^3]", "positive", "rho")]
    k_r: Annotated[
        float, Key("stiffness of radial springs per length around [N/m^2]", "not negative", "springs around")
    ] = 0.0
    k_t: Annotated[
        float, Key("stiffness of tangential springs per length around [N/m^2]", "not negative", "springs around")
    ] = 0.0
    zeta: Annotated[float, Key("damping ratio of all modes [-]", "not negative", "zeta")] = 0.0

    def __post_init__(self) -> None:
        require_positive(radius=self.radius)
        require_keyed(self)
        if self.height >= self.radius:
            raise InputError(f"height: found {self.height:g} m, expected less than the radius {self.radius:g} m")

    @property
    def line_mass(self) -> float:
        """Mass per length [kg/m]."""
        return self.rho * self.width * self.height

    @property
    def tension(self) -> float:
        """Hoop tension at 1 rad/s [N s^2]."""
        EA = self.E * self.width * self.height
        return self.line_mass * self.radius**2 / (1.0 + self.k_r * self.radius**2 / EA)

    def stiffness(self, n: int) -> Array:
        """Stiffness per length for w = W cos n theta, v = V sin n theta, on (W, V), (2, 2) [N/m^2]."""
        EA = self.E * self.width * self.height
        EI = EA * self.height**2 / 12.0
        stretch, bend = np.array([1.0, n]), n * np.array([n, 1.0])
        return np.asarray(
            EA / self.radius**2 * np.outer(stretch, stretch)
            + EI / self.radius**4 * np.outer(bend, bend)
            + np.diag([self.k_r, self.k_t])
        )

    def frequencies(self, n: int) -> list[float]:
        """The two frequencies for n waves [Hz], the bending one first."""
        values = np.linalg.eigvalsh(self.stiffness(n) / self.line_mass)
        return [math.sqrt(max(value, 0.0)) / (2.0 * math.pi) for value in values.tolist()]


def ring_modes(ring: ThinRing, n_max: int = 20) -> ModalBody:
    """All modes of up to `n_max` waves in closed form, two for each n and orientation.

    >>> ring = ThinRing(radius=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6)
    >>> ring_modes(ring, 8)
    ModalBody(rim, 34 modes, 0 .. 1.332e+04 Hz, 34 channels)
    """
    require_count(0, n_max=n_max)
    channels = rim_channels(n_max)
    place = {name: row for row, name in enumerate(channels)}
    omega: list[float] = []
    rows: list[Array] = []
    for n in range(n_max + 1):
        values, vectors = np.linalg.eigh(ring.stiffness(n))
        length = (2.0 if n == 0 else 1.0) * math.pi * ring.radius
        shapes = vectors / math.sqrt(ring.line_mass * length)
        for k in range(2):
            W, V = shapes[:, k]
            turned = (("cos", "sin", 1.0), ("sin", "cos", -1.0))
            for radial, hoop, sign in turned if n else (("cos", "cos", 1.0),):
                row = np.zeros(len(channels))
                row[place[f"radial.{radial}{n}"]] = W
                row[place[f"tangential.{hoop}{n}"]] = sign * V
                rows.append(row)
                omega.append(_frequency(float(values[k]), float(values[-1]), ring.line_mass))
    whole = np.array(rows).T
    return _basis(ring, n_max, np.array(omega), whole, *_turning_waves(ring, n_max, whole))


def _turning_waves(ring: ThinRing, n_max: int, rows: Array) -> tuple[Array, Array]:
    """G and the stiffness by speed between motions given by waves, in the order of `rim_channels`."""
    n = np.arange(n_max + 1)
    w, v = rows.reshape(2, 2 * n_max + 1, -1)
    size = np.where(np.arange(2 * n_max + 1) == 0, 2.0, 1.0)[:, None] * math.pi * ring.radius

    def slope(waves: Array) -> Array:
        """Derivative with respect to the angle: cos n -> -n sin n, sin n -> n cos n."""
        cos, sin = waves[: n_max + 1], waves[n_max + 1 :]
        return np.vstack([np.zeros_like(cos[:1]), n[1:, None] * sin, -n[1:, None] * cos[1:]])

    half = 2.0 * ring.line_mass * v.T @ (size * w)
    stretch, turn = (slope(v) + w) / ring.radius, (slope(w) - v) / ring.radius
    stress = ring.tension * (3.0 * stretch.T @ (size * stretch) + turn.T @ (size * turn))
    return half - half.T, stress - ring.line_mass * (w.T @ (size * w) + v.T @ (size * v))


def ring_elements(ring: ThinRing, elements: int, n_max: int = 20) -> ModalBody:
    """All modes of a ring of curved elements, cubic Hermite in w and v, with channels of up to `n_max` waves.

    The contact surface is smooth: the projection of the elements' w on `n_max` waves.

    Raises InputError if the elements cannot represent `n_max` waves.

    >>> ring = ThinRing(radius=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)
    >>> basis = ring_elements(ring, 48, n_max=6)
    >>> bool(abs(basis.omega[3] / (2 * np.pi) / ring.frequencies(2)[0] - 1) < 1e-4)
    True
    """
    from scipy.linalg import eigh

    require_count(0, n_max=n_max)
    require_count(elements=elements)
    if elements < 3 or n_max > elements:
        raise InputError(f"elements: found {elements} for n_max = {n_max}, expected at least n_max, and 3")
    K, M, G, added = _assembled(ring, elements)
    values, vectors = eigh(K, M)
    omega = np.array([_frequency(value, values[-1], 1.0) for value in values.tolist()])
    turning = (vectors.T @ part @ vectors for part in (G, added))
    return _basis(ring, n_max, omega, _projection(elements, n_max) @ vectors, *turning)


def _frequency(value: float, largest: float, mass: float) -> float:
    return math.sqrt(value / mass) if value > RIGID * largest else 0.0


def _basis(ring: ThinRing, n_max: int, omega: Array, rows: Array, G: Array, added: Array) -> ModalBody:
    channels = rim_channels(n_max)
    order = np.argsort(omega, kind="stable")
    turned = np.ix_(order, order)
    return ModalBody(
        omega=omega[order], zeta=np.full(omega.size, ring.zeta), channels=channels, rows=rows[:, order],
        S=np.zeros((len(channels), len(channels))), kind="rim", n_max=n_max, radius=ring.radius,
        gyroscopic=0.5 * (G - G.T)[turned],
        stiffness_by_speed=0.5 * (added + added.T)[turned],
    )  # fmt: skip


def hermite(x: Array, span: float) -> Array:
    """Cubic Hermite functions of (value, slope) at both ends of an element, and two derivatives, (3, 4, points)."""
    x2, x3 = x * x, x * x * x
    value = [1 - 3 * x2 + 2 * x3, span * (x - 2 * x2 + x3), 3 * x2 - 2 * x3, span * (x3 - x2)]
    first = [-6 * x + 6 * x2, span * (1 - 4 * x + 3 * x2), 6 * x - 6 * x2, span * (3 * x2 - 2 * x)]
    second = [-6 + 12 * x, span * (-4 + 6 * x), 6 - 12 * x, span * (6 * x - 2)]
    return np.array([value, np.array(first) / span, np.array(second) / span**2])


def _dofs(elements: int) -> Indices:
    """Dof numbers (elements, 8): w, w' at both ends, then v, v'; four for each node."""
    first = 4 * np.arange(elements)[:, None]
    last = 4 * ((np.arange(elements) + 1) % elements)[:, None]
    w = np.hstack([first, first + 1, last, last + 1])
    return np.asarray(np.hstack([w, w + 2]), dtype=np.int64)


def _assembled(ring: ThinRing, elements: int) -> tuple[Array, Array, Array, Array]:
    """K, M, G and the stiffness by speed of the closed ring, (4 elements, 4 elements) each."""
    span, R = 2.0 * math.pi / elements, ring.radius
    x, weight = np.polynomial.legendre.leggauss(6)
    N, slope, bend = hermite(0.5 * (x + 1.0), span)
    weight = 0.5 * weight * span * R
    zero = np.zeros_like(N)
    w, v = np.vstack([N, zero]), np.vstack([zero, N])
    eps, kappa = np.vstack([N, slope]) / R, np.vstack([-bend, slope]) / R**2
    EA = ring.E * ring.width * ring.height
    terms = ((EA, eps), (EA * ring.height**2 / 12.0, kappa), (ring.k_r, w), (ring.k_t, v))
    turn = np.vstack([slope, -N]) / R

    def summed(a: Array, b: Array) -> Array:
        return np.asarray(np.einsum("ip,p,jp->ij", a, weight, b))

    M_one = ring.line_mass * (summed(w, w) + summed(v, v))
    ones = (
        sum((factor * summed(B, B) for factor, B in terms), np.zeros_like(M_one)), M_one,
        2.0 * ring.line_mass * (summed(v, w) - summed(w, v)),
        ring.tension * (3.0 * summed(eps, eps) + summed(turn, turn)) - M_one,
    )  # fmt: skip
    found, dofs = np.zeros((4, 4 * elements, 4 * elements)), _dofs(elements)
    for whole, one in zip(found, ones, strict=True):
        np.add.at(whole, (dofs[:, :, None], dofs[:, None, :]), one)
    return found[0], found[1], found[2], found[3]


def _projection(elements: int, n_max: int) -> Array:
    """Fourier coefficients of w and v of the dofs, in the order of `rim_channels`, (2 (2N + 1), dofs)."""
    span = 2.0 * math.pi / elements
    x, weight = np.polynomial.legendre.leggauss(6)
    local = 0.5 * (x + 1.0)
    theta = (np.arange(elements)[:, None] + local) * span
    N = hermite(local, span)[0]
    n = np.arange(n_max + 1)
    waves = np.concatenate([np.cos(n[:, None, None] * theta), np.sin(n[1:, None, None] * theta)])
    scale = np.where(np.arange(2 * n_max + 1) == 0, 0.5, 1.0) / math.pi
    found = np.einsum("hep,fp,p,h->hef", waves, N, 0.5 * weight * span, scale)
    dofs, out = _dofs(elements), np.zeros((2, 2 * n_max + 1, 4 * elements))
    for part, columns in enumerate((dofs[:, :4], dofs[:, 4:])):
        for h in range(2 * n_max + 1):
            np.add.at(out[part, h], columns, found[h])
    return out.reshape(2 * (2 * n_max + 1), -1)
