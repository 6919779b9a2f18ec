"""Growth of closed contact for many bodies that differ in frequencies and friction, at many speeds.

The bodies are those of one rim or rub with one contact and a perfect casing. Case d multiplies the frequencies of each
casing mode by `casing[d]`, retunes the blades by `blade[d]`, and has the friction `mu[d]`. Free poles s and residues a
of the bodies follow from those of the given bodies in closed form:

    s_d = r s - i k Omega,   a_d = (a_0 + mu a_1)/r,   S_d = S_c + S_b/r_b^2 - mu (T_c + T_b/r_b^2).

The effect of Coriolis forces on a pole is not scaled with its frequency: an error of second order in small r - 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.threads import with_one_thread
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact, rub_contact
from contact.model.gaps.rub import Rub, rub_of
from contact.stability.closed_contact import MOST, SETTLED, growth
from contact.stability.waves import waves_of

if TYPE_CHECKING:
    from contact.loop.poles import Varied

SEEN = 1e-14  # of the largest residue: below, contact does not see a pole
PART = 1e-6  # of a wave's largest mode: below, a mode is not part of the wave


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Cases:
    """Varied quantities: ratios of frequencies `casing` (cases, modes) and `blade` (cases,), friction `mu` (cases,).

    >>> Cases(casing=np.ones((2, 4)), blade=np.ones(2), mu=np.array([0.1, 0.2]))
    Cases(2 of 4 modes)
    """

    casing: Array
    blade: Array
    mu: Array

    def __post_init__(self) -> None:
        if self.casing.ndim != 2 or not self.blade.shape == self.mu.shape == self.casing.shape[:1]:
            found = f"casing {self.casing.shape}, blade {self.blade.shape}, mu {self.mu.shape}"
            raise InputError(f"cases: found {found}, expected (cases, modes), (cases,) and (cases,)")
        finite = all(np.isfinite(part).all() for part in (self.casing, self.blade, self.mu))
        if not (finite and np.all(self.casing > 0.0) and np.all(self.blade > 0.0) and np.all(self.mu >= 0.0)):
            raise InputError("cases: found ratios <= 0 or friction < 0, expected finite ratios > 0 and friction >= 0")

    def __repr__(self) -> str:
        return f"Cases({len(self.mu)} of {self.casing.shape[1]} modes)"


@with_one_thread
def growth_of_cases(what: RotatingRim | Rub, speed_hz: Array, cases: Cases) -> Array:
    """Largest growth [1/s] of closed contact of each case at speeds [turns/s] above 0, (cases, speeds).

    Raises InputError for a rub with several contacts, a split casing, speeds that are not above 0, or cases with
    another number of modes or with different ratios of the two modes of a pair.

    >>> from contact.model.bodies.modal_body import ModalBody
    >>> from contact.model.gaps.bladed_disk import pair_rim
    >>> from contact.model.gaps.permanent import ModalPair
    >>> casing = pair_rim(ModalPair(n=8, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    >>> blade = ModalBody(omega=[754.0], zeta=[0.0], channels=("span", "flap"), rows=[[1.5], [0.0]],
    ...                   S=[[1e-4, 0.0], [0.0, 0.0]])
    >>> rim = RotatingRim(casing, blade, clearance=0.0, speed_hz=5.0)
    >>> cases = Cases(casing=np.ones((1, 2)), blade=np.ones(1), mu=np.zeros(1))
    >>> (growth_of_cases(rim, np.array([40.0, 52.85]), cases) > 1.0).tolist()
    [[False, True]]
    """
    from contact.loop.poles import Work, largest_growths

    smooth, rough = (rub_contact(what, mu=mu) for mu in (0.0, 1.0))
    speeds = np.atleast_1d(np.asarray(speed_hz, dtype=float))
    _require(smooth, speeds, cases)
    S = _compliances(what, smooth, cases)
    scale = np.ascontiguousarray(np.hstack([cases.casing, cases.blade[:, None]]))
    found = np.empty((len(cases.mu), speeds.size))
    for place, hz in enumerate(speeds.tolist()):
        varied = _varied(smooth, rough, 2.0 * math.pi * hz, scale, cases.mu, S)
        work = Work(np.zeros((8, varied.real.size)), np.zeros(varied.real.size, dtype=np.int64))
        column = np.empty(len(cases.mu))
        largest_growths(varied, work, column, MOST, SETTLED)
        for case in np.flatnonzero(np.isnan(column)).tolist():
            column[case] = growth(_case(what, cases, case), np.array([hz]))[0]
        found[:, place] = column
    return found


def _require(contact: ClosedContact, speeds: Array, cases: Cases) -> None:
    if len(contact.Q) > 1:
        raise InputError(f"tips: found {len(contact.Q)} contacts, expected one")
    if not (np.all(np.isfinite(speeds)) and np.all(speeds > 0.0)):
        raise InputError("speed_hz: found speeds <= 0 Hz, expected speeds above 0 Hz")
    contact.require_known(2.0 * math.pi * speeds)
    if cases.casing.shape[1] != contact.casing:
        raise InputError(f"cases: found {cases.casing.shape[1]} modes, expected {contact.casing}, those of the casing")
    for shape in np.abs(waves_of(contact).U[: contact.casing]).T:
        pair = np.flatnonzero(shape > PART * shape.max(initial=0.0))
        if pair.size > 1 and np.any(np.ptp(cases.casing[:, pair], axis=1) > 0.0):
            modes = " and ".join(str(mode + 1) for mode in pair)
            found = f"different frequency ratios of casing modes {modes}"
            raise InputError(f"cases: found {found}, expected equal ratios: these modes are a pair")


def _varied(
    smooth: ClosedContact, rough: ClosedContact, omega: float, scale: Array, mu: Array, S: Array
) -> Varied:  # fmt: skip
    """The bodies at one speed [rad/s] by their poles with residues at the contact, without friction and with mu = 1."""
    from contact.loop.poles import Varied

    seen = waves_of(smooth)
    free, pushed = (waves_of(one).poles(np.array([omega]), 1.0) for one in (smooth, rough))
    if free is None or pushed is None:
        raise InputError("modes: found equal poles of the free bodies, expected distinct poles: change a damping ratio")
    a, with_friction = free.residues[0], pushed.residues[0]
    most = float(np.abs(a).max(initial=0.0))
    used = (np.abs(a) > SEEN * most) | (np.abs(with_friction) > SEEN * most)
    own = free.s[0] + 1j * omega * free.order
    mode = np.concatenate([np.tile(group, 2) for group in seen.groups])
    b, plain = with_friction - a, np.ascontiguousarray
    return Varied(
        real=plain(own.real[used]), imag=plain(own.imag[used]), turned=plain(omega * free.order[used]),
        a_real=plain(a.real[used]), a_imag=plain(a.imag[used]), b_real=plain(b.real[used]), b_imag=plain(b.imag[used]),
        body=np.minimum(mode, smooth.casing)[used].astype(np.int64), scale=scale, mu=plain(mu, dtype=float), S=S,
    )  # fmt: skip


def _compliances(what: RotatingRim | Rub, contact: ClosedContact, cases: Cases) -> Array:
    """S of each case."""
    soft = rub_contact(_retuned(what, 2.0), mu=0.0)
    ratio = 1.0 / cases.blade**2
    parts = []
    for stiff, other in ((contact.S_nn, soft.S_nn), (contact.S_nt, soft.S_nt)):
        blade = (float(stiff[0, 0]) - float(other[0, 0])) * 4.0 / 3.0
        parts.append(float(stiff[0, 0]) - blade + blade * ratio)
    return np.ascontiguousarray(parts[0] - cases.mu * parts[1])


def _retuned(what: RotatingRim | Rub, ratio: float) -> Rub:
    rub: Rub = rub_of(what)
    blades = tuple(
        body.retuned(ratio * float(body.omega[body.omega > 0.0].min()) / (2.0 * math.pi)) for body in rub.blades
    )
    found: Rub = replace(rub, blades=blades)
    return found


def _case(what: RotatingRim | Rub, cases: Cases, case: int) -> ClosedContact:
    """One case as a separate contact."""
    rub = _retuned(what, float(cases.blade[case]))
    casing: Any = replace(rub.casing, omega=rub.casing.omega * cases.casing[case])
    return rub_contact(replace(rub, casing=casing), mu=float(cases.mu[case]))
