"""Compile the machine code of all step loops before it is needed: one very short run of each kind, several at a time.

The types of a loop's arguments depend on the kind of the run, not on its size. So a run of a few steps of the smallest
bodies compiles the code that every later run of its kind reads from disk.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import as_completed
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from contact.base.errors import InputError
from contact.cycles.driven import DrivenBody
from contact.cycles.follow import follow
from contact.cycles.shooting import orbit
from contact.cycles.traced import traced
from contact.io.names import hint
from contact.io.workers import worker_pool
from contact.model.bodies.beam import BeamInCircle, HingedBeam
from contact.model.bodies.body import Rod, Wall
from contact.model.bodies.modal_body import ModalBody
from contact.model.bodies.patch import Patch
from contact.model.gaps.bladed_disk import pair_rim
from contact.model.gaps.gap import PointGap, RotatingRim, Side
from contact.model.gaps.permanent import ModalPair
from contact.model.gaps.rub import ContactPoint, Rub
from contact.model.law import Coulomb, Law
from contact.model.laws.force_law import Hertz
from contact.model.rotor.jeffcott import Jeffcott
from contact.model.rotor.rotor import Rotor
from contact.model.speed import Speed
from contact.prepared import Scene
from contact.run import run
from contact.run_many import run_many
from contact.scheme.linear.alpha import Newmark, StabilisedNewmark
from contact.scheme.linear.central_difference import CentralDifference
from contact.scheme.linear.massless_boundary import MasslessBoundary
from contact.scheme.linear.nonsmooth_alpha import MoreauJean, NonsmoothAlpha, ProjectedAlpha
from contact.scheme.modal.exact_modal import ExactModal
from contact.scheme.protocol import Scheme
from contact.stability.split_casing import floquet_growth
from contact.stability.varied import Cases, growth_of_cases

FEW = 4  # steps of a tiny run


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """A kind of run whose loops are now on disk, the seconds that took, and the finished share of all kinds."""

    kind: str
    seconds: float
    done: float


def _rods(scheme: Scheme, law: Law | None = None) -> None:
    rod = Rod(length=1.0, area=1e-4, E=2e11, rho=7800.0, elements=4, x=1.0)
    run([rod, Wall()], scheme=scheme, law=law, dt=1e-6, t_end=FEW * 1e-6)


def _body(*omega: float, channels: tuple[str, ...], S: float = 0.0, zeta: float = 0.0) -> ModalBody:
    m, K = len(omega), len(channels)
    return ModalBody(
        omega=np.array(omega), zeta=np.full(m, zeta), channels=channels, rows=np.eye(K, m), S=S * np.eye(K)
    )  # fmt: skip


def _point(scheme: Scheme, law: Law | None = None) -> None:
    mass = _body(10.0, channels=("x",), S=1e-3)
    gap = PointGap(sides=(Side(body=mass, channel="x", sign=1, velocity=np.array([-1.0])),), clearance=1e-9)
    run(gap, scheme=scheme, law=law, dt=1e-3, t_end=FEW * 1e-3)


def _bodies() -> tuple[ModalBody, ModalBody]:
    casing = pair_rim(ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    casing = replace(casing, S=1e-7 * np.eye(len(casing.channels)))
    return casing, _body(900.0, channels=("flap", "span"))


def _rim() -> None:
    rim = RotatingRim(*_bodies(), clearance=-1e-6, speed_hz=1.0, lean_deg=10.0)
    run(rim, law=Coulomb(mu=0.1), dt=1e-5, t_end=FEW * 1e-5, on_limit="flag")


def _rub() -> None:
    """The loop of several tips, patches, coatings and coupled modes; what laws and coatings, and patches, add to it."""
    casing, blade = _bodies()
    tips = (ContactPoint(), ContactPoint(angle_deg=90.0))
    rub = Rub(casing, (blade,), tips, clearance=-1e-6, speed=Speed.constant(1.0), turning="casing")
    for law in (Coulomb(mu=0.1), Hertz(k=1e9, mu=0.1)):
        run(rub, law=law, dt=1e-5, t_end=FEW * 1e-5, on_limit="flag")
    patch = Patch(body=_body(1.0, channels=("x",)), normal=("x",), velocity=[-1e-3])
    run(patch, dt=1e-3, t_end=FEW * 1e-3)


def _batch() -> None:
    rims = [RotatingRim(*_bodies(), clearance=-1e-6, speed_hz=hz, lean_deg=10.0) for hz in (1.0, 2.0)]
    run_many([Scene(what=rim, law=Coulomb(mu=0.1), dt=1e-5, t_end=FEW * 1e-5, on_limit="flag") for rim in rims])


def _beam(scheme: Scheme | None) -> None:
    beam = HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, elements=4, torque=1.0)
    run(BeamInCircle(beam, radius=0.502, offset=0.006), scheme=scheme, dt=1e-6, t_end=FEW * 1e-6)


def _cycles() -> None:
    mass = _body(1.0, channels=("x",), zeta=0.1)
    patch = Patch(body=mass, normal=("x",), clearance=1.0)
    body = DrivenBody(patch=patch, channel="x", amplitude=0.1, stiffness=10.0)
    family = body.over("freq_hz", freq_hz=0.1)
    one = orbit(family, 0.1)
    follow(family, (0.1, 0.11), first=one, longest=0.5)  # slopes
    traced(family, one, samples=1)  # a phase by itself
    family.at(0.1)[0].closed_at(one.x, 0.0)


def _floquet() -> None:
    casing, blade = _bodies()
    floquet_growth(RotatingRim(casing, blade, clearance=0.0, speed_hz=1.0), np.array([1.0]))


def _chance() -> None:
    casing, blade = _bodies()
    cases = Cases(casing=np.ones((1, casing.omega.size)), blade=np.ones(1), mu=np.zeros(1))
    growth_of_cases(RotatingRim(casing, blade, clearance=0.0, speed_hz=1.0), np.array([1.0]), cases)


def _rotor() -> None:
    run(Rotor.of(Jeffcott(mass=1.0, stiffness=100.0), 1.0), dt=1e-3, t_end=FEW * 1e-3)


KINDS: Mapping[str, Callable[[], None]] = {
    "rub": _rub,
    "rim": _rim,
    "sweep": _batch,
    "point": partial(_point, ExactModal(law="averaged")),
    "point-law": partial(_point, ExactModal(), Hertz(k=1e6)),
    "point-energy": partial(_point, ExactModal(law="energy")),
    "rotor": _rotor,
    "beam": partial(_beam, None),
    "beam-newmark": partial(_beam, Newmark()),
    "cycles": _cycles,
    "stability": _floquet,
    "chance": _chance,
    "rods-forward-lagrange": partial(_rods, CentralDifference()),
    "rods-massless-boundary": partial(_rods, MasslessBoundary()),
    "rods-newmark": partial(_rods, Newmark()),
    "rods-stabilised-newmark": partial(_rods, StabilisedNewmark()),
    "rods-moreau-jean": partial(_rods, MoreauJean()),
    "rods-nonsmooth-alpha": partial(_rods, NonsmoothAlpha()),
    "rods-projected-alpha": partial(_rods, ProjectedAlpha()),
}


def compiled_ahead(kinds: tuple[str, ...] = tuple(KINDS), *, workers: int = 1) -> Iterator[Made]:
    """Compile the loops of these kinds of run, `workers` at a time, and yield each kind as it is done.

    Code that is already on disk is only read. `ct.ahead.KINDS` names the kinds. Raises InputError for an unknown kind.

    >>> [made.kind for made in compiled_ahead(("rods-massless-boundary",))]
    ['rods-massless-boundary']
    """
    for kind in kinds:
        if kind not in KINDS:
            raise InputError(f"kind: found {kind!r}, expected one of {', '.join(KINDS)}{hint(kind, KINDS)}")
    if workers <= 1:
        for i, kind in enumerate(kinds, 1):
            yield Made(kind=kind, seconds=_seconds(kind), done=i / len(kinds))
        return
    with worker_pool(min(workers, len(kinds))) as pool:
        waiting = {pool.submit(_seconds, kind): kind for kind in kinds}
        for i, future in enumerate(as_completed(waiting), 1):
            yield Made(kind=waiting[future], seconds=future.result(), done=i / len(kinds))


def _seconds(kind: str) -> float:
    started = time.perf_counter()
    KINDS[kind]()
    return time.perf_counter() - started
