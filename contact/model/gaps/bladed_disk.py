"""A lumped bladed disk: one mode for each blade, coupled to its neighbours, perhaps mistuned; as one modal body."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from contact.base.arrays import (
    Array,
    keep_readonly,
    readonly,
    require_count,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
)
from contact.base.errors import InputError
from contact.io.brief import brief
from contact.io.keys import Key
from contact.model.bodies.channels import rim_channels
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.permanent import ModalPair, require_waves
from contact.model.gaps.rub import ContactPoint, Rub, Start
from contact.model.speed import Speed

FEWEST = 2  # blades: one has no neighbour
MOST_DIAMETERS = 1000  # the compliance of a rim is a full matrix of 4 n + 2 rows


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BladedDisk:
    """N blades of one flap mode each, joined by springs: m x_j'' + k_j x_j + k_c (2 x_j - x_(j-1) - x_(j+1)) = f_j.

    k_j = m (2 pi freq_hz (1 + mistuning_j))^2, k_c = coupling m (2 pi freq_hz)^2. Tuned, the modes are waves of n
    nodal diameters, omega_n^2 = omega_b^2 (1 + 4 coupling sin^2(pi n/N)), each n between 0 and N/2 twice
    (D. L. Thomas, Int. J. Numer. Meth. Eng. 14, 1979, 81).

    `modal_mass` [kg] for unit motion of the tip; `mistuning` (blades,) relative deviations of the blades' frequencies;
    `compliance` [m/N] of each tip, along span and flap: that of the omitted modes; `lean_deg` is the lean into the
    motion.

    Raises InputError for values that are not physical.

    >>> disk = BladedDisk(blades=12, freq_hz=100.0, modal_mass=0.4, coupling=0.1)
    >>> disk.tuned_hz()[[0, 6]].round(3).tolist()
    [100.0, 118.322]
    """

    blades: Annotated[int, Key("number of blades", least=FEWEST, most=1000)]
    freq_hz: Annotated[float, Key("frequency of one blade alone [Hz]", "positive", "frequency")]
    modal_mass: Annotated[
        float, Key("modal mass of one blade for unit motion along the contact normal [kg]", "positive", "mass")
    ]
    coupling: Annotated[
        float, Key("coupling stiffness of neighbouring blades over the stiffness of a blade [-]", least=0.0, most=100.0)
    ] = 0.0
    mistuning: Array | None = None
    zeta: Annotated[float, Key("damping ratio of all modes [-]", "ratio", "zeta")] = 0.0
    compliance: Annotated[float, Key("residual compliance of a tip [m/N]", "not negative", "compliance or 0")] = 0.0
    lean_deg: Annotated[
        float,
        Key("lean of the blade from the radius, positive in the direction of its motion [degrees]", "lean", "lean"),
    ] = 0.0

    __repr__ = brief

    def __post_init__(self) -> None:
        require_positive(freq_hz=self.freq_hz, modal_mass=self.modal_mass)
        require_not_negative(coupling=self.coupling, compliance=self.compliance, zeta=self.zeta)
        require_finite(lean_deg=self.lean_deg)
        require_count(FEWEST, blades=self.blades)
        if self.mistuning is not None:
            keep_readonly(self, "mistuning")
            require_shape("mistuning", self.mistuning, (self.blades,))
            if self.mistuning.min() <= -1.0:
                raise InputError(f"mistuning: found {self.mistuning.min():g}, expected every one above -1")

    @property
    def stiffness(self) -> Array:
        """K/m [1/s^2], (blades, blades)."""
        square = (2.0 * math.pi * self.freq_hz) ** 2
        own = np.ones(self.blades) if self.mistuning is None else (1.0 + self.mistuning) ** 2
        ring = np.eye(self.blades) - np.roll(np.eye(self.blades), 1, axis=0)
        return np.asarray(square * (np.diag(own) + self.coupling * ring.T @ ring))

    def tuned_hz(self) -> Array:
        """Frequencies [Hz] of the tuned disk by nodal diameters 0 .. blades/2, closed form."""
        n = np.arange(self.blades // 2 + 1)
        return np.asarray(self.freq_hz * np.sqrt(1.0 + 4.0 * self.coupling * np.sin(np.pi * n / self.blades) ** 2))

    def body(self) -> ModalBody:
        """Its modes, and for each blade the channels span0, flap0, span1, ... of the tip."""
        squares, shapes = np.linalg.eigh(self.stiffness)
        N = self.blades
        rows = np.zeros((2 * N, N))
        rows[1::2] = shapes / math.sqrt(self.modal_mass)
        return ModalBody(
            omega=np.sqrt(squares), zeta=np.full(N, self.zeta), channels=tip_channels(N), rows=rows,
            S=self.compliance * np.eye(2 * N),
        )  # fmt: skip

    def tips(self) -> tuple[ContactPoint, ...]:
        """A contact at the tip of every blade, evenly around the disk."""
        return tuple(
            ContactPoint(
                span=f"span{j}", flap=f"flap{j}", angle_deg=360.0 * j / self.blades, lean_deg=self.lean_deg, track=0
            )
            for j in range(self.blades)
        )


def tip_channels(blades: int) -> tuple[str, ...]:
    """Channel names of a disk's tips.

    >>> tip_channels(2)
    ('span0', 'flap0', 'span1', 'flap1')
    """
    return tuple(f"{direction}{j}" for j in range(blades) for direction in ("span", "flap"))


def pair_rim(pair: ModalPair, *, radius: float) -> ModalBody:
    """A casing reduced to its pair of n diameters: cos and sin n theta, inextensional (tangential over radial 1/n).

    Raises InputError unless n is from 1 to 1000: a rim stores every harmonic up to n.

    >>> casing = pair_rim(ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> casing.kind, casing.n_max, (casing.omega / (2.0 * np.pi)).round(6).tolist()
    ('rim', 2, [100.0, 100.0])
    """
    if not 1 <= pair.n <= MOST_DIAMETERS:
        found = pair.n if pair.n < 1e18 else "over 1e18"
        raise InputError(f"n: found {found}, expected 1 to {MOST_DIAMETERS} nodal diameters of a rim")
    n = int(pair.n)
    size = 2 * n + 1
    x = pair.modal_mass**-0.5
    rows = np.zeros((2 * size, 2))
    rows[n, 0] = rows[2 * n, 1] = x
    rows[size + 2 * n, 0], rows[size + n, 1] = -x / n, x / n
    return ModalBody(
        omega=np.full(2, pair.omega), zeta=np.full(2, pair.zeta), channels=rim_channels(n), rows=rows,
        S=np.zeros((2 * size, 2 * size)), kind="rim", n_max=n, radius=radius,
    )  # fmt: skip


def two_dimensional(
    casing: ModalPair, disk: ModalPair, *, blades: int, stiffness: float, press: float, speed_hz: float,
    velocity: float, radius: float = 0.5,
) -> Rub:  # fmt: skip
    """A disk of blades in a casing, each body by its two n-diameter modes, in the disk's frame.

    P. Schmiechen (thesis, Imperial College, 1997); M. Legrand, C. Pierre, P. Cartraud, J.-P. Lombard (J. Sound Vib.
    319, 2009, 366). Every tip presses with `stiffness` [N/m], by `press` [m] at rest; `velocity` [m/s] is the initial
    velocity of the casing's cosine. The disk moves radially; modal masses are those of unit amplitude of cos n theta.

    Raises InputError unless both have the same n >= 1 and `blades` > 2 n, so that the tips distinguish cosine from
    sine.
    """
    require_waves(casing, disk, stiffness=stiffness, blades=blades)
    angle = 2.0 * math.pi * np.arange(blades) / blades
    rows = np.zeros((2 * blades, 2))
    rows[::2] = np.stack([np.cos(disk.n * angle), np.sin(disk.n * angle)], axis=1) / math.sqrt(disk.modal_mass)
    body = ModalBody(
        omega=np.full(2, disk.omega), zeta=np.full(2, disk.zeta), channels=tip_channels(blades), rows=rows,
        S=np.eye(2 * blades) / stiffness,
    )  # fmt: skip
    tips = tuple(
        ContactPoint(span=f"span{j}", flap=f"flap{j}", angle_deg=math.degrees(angle[j]), track=0) for j in range(blades)
    )
    start = Start(velocity=readonly([velocity * math.sqrt(casing.modal_mass), 0.0]))
    return Rub(
        pair_rim(casing, radius=radius), (body,), tips, clearance=-press, speed=Speed.constant(speed_hz),
        casing_start=start,
    )  # fmt: skip
