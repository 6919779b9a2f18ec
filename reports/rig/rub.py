"""The rub: a blade tuned to the casing, both reduced, runs with the surveyed out-of-roundness and without."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import root_scalar

import casingfem as cf
import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.modal.interaction import wave_hz
from casingfem.modal.modes import Modes
from casingfem.study import Study
from casingfem.study.tasks import run_reduce
from contact.growth.coincidence import coincidences
from contact.histories import RubFilm, rub_film
from contact.io.outfiles import write_atomic
from reports.rub.rim_levels import excess_db, rim_levels


@dataclass(frozen=True, slots=True, kw_only=True)
class RubPlan:
    """How the rub is run: [tuning] and [rub] of rig.toml."""

    n: int
    speed_hz: float
    into_band: float
    t_end: float
    dt: float
    friction: float
    lean_deg: float
    advance: float


@dataclass(frozen=True, slots=True, eq=False)
class Rub:
    """One run: the result, the rim's radial motion by nodal diameters late in it, RMS [m], (n_max + 1,), the film."""

    name: str
    result: ct.Result
    levels: FloatArray
    film: RubFilm | None = None

    def excess_db(self, n: int) -> float:
        """Level of n over the highest other one [dB]."""
        return excess_db(self.levels, n)


def casing_target(casing: Modes, n: int) -> float:
    """Mean frequency [Hz] of the casing's lowest doublet of n nodal diameters."""
    pair = next(list(pair) for pair in casing.doublets if casing.nodal_diameters[pair[0]] == n)
    return float(casing.freq[pair].mean())


def tuned(blade: cf.Shell, target: float) -> cf.Shell:
    """The blade with the thickness that puts its first mode at `target` [Hz]."""

    def error(scale: float) -> float:
        """Frequencies grow nearly as the thickness: of their logarithms a secant meets the root in a few steps."""
        return float(np.log(cf.modes(replace(blade, thickness=scaled(scale)), 1).freq[0] / target))

    def scaled(scale: float) -> float:
        return float(blade.thickness * np.exp(np.clip(scale, -wide, wide)))

    wide = np.log(3.0)
    found = root_scalar(error, x0=0.0, x1=-error(0.0), method="secant", xtol=1e-11, maxiter=20)
    if not found.converged or abs(found.root) >= wide:
        low, high = scaled(-wide), scaled(wide)
        raise ValueError(f"no thickness from {low:.3g} to {high:.3g} m puts the blade's first mode at {target:.2f} Hz")
    return replace(blade, thickness=scaled(found.root))


def deviation(terms: list[dict[str, float]], theta: FloatArray) -> FloatArray:
    """The deviation at angles [m]."""
    total = np.zeros_like(theta)
    for term in terms:
        total += term["cos"] * np.cos(term["p"] * theta) + term["sin"] * np.sin(term["p"] * theta)
    return total


@dataclass(frozen=True, slots=True, kw_only=True)
class Tuning:
    """Where the blade's first mode was put [Hz]: the free coincidence, the growing band, and the target in it."""

    coincidence: float
    low: float
    high: float
    target: float
    thickness: float


def against(still_hz: float, plan: RubPlan) -> float:
    """Frequency [Hz] of a pair's wave against the rotation of the casing, in its frame, by ring theory."""
    return float(wave_hz(plan.n, still_hz, np.array([plan.speed_hz]), "casing", -1)[0])


def growing_band(casing: cf.ModalBasis, blade: cf.ModalBasis, plan: RubPlan) -> tuple[float, float]:
    """Blade frequencies between which a permanent contact grows, from the free coincidence f_b = f_c - n f [Hz].

    The casing's doublet of n diameters, taken as a pair of equal modes whose wave runs against the rotation, meets the
    blade's first mode; all other modes at that frequency and the residual compliance are the S between them
    (`contact.growth.coincidence`).
    """
    N, n, turning = casing.n_max, plan.n, 2.0 * np.pi * plan.speed_hz
    radial = casing.rows[: 2 * N + 1]
    order = np.r_[np.arange(N + 1), np.arange(1, N + 1)]
    mobility = np.array([np.sum(radial[order == k] ** 2, axis=0) for k in range(N + 1)])  # 1/m_k of each mode
    pair = np.flatnonzero(mobility.argmax(axis=0) == n)[:2]
    w_c = 2.0 * np.pi * against(float(casing.omega[pair].mean()) / (2.0 * np.pi), plan)
    nu = w_c - n * turning

    lean = np.radians(plan.lean_deg)
    normal = np.array([np.cos(lean), np.sin(lean)])
    pressing = normal @ blade.rows
    kappa = pressing * (pressing - plan.friction * (np.array([-np.sin(lean), np.cos(lean)]) @ blade.rows))

    k = np.arange(N + 1)[:, None]
    others = np.delete(np.arange(len(casing)), pair)
    S = sum(
        float(np.sum(0.25 * mobility[:, others] / (casing.omega[others] ** 2 - (nu + sign * k * turning) ** 2)))
        for sign in (-1, 1)
    )
    S += float(casing.S[0, 0] + 0.5 * np.trace(casing.S[1 : 2 * N + 1, 1 : 2 * N + 1]))
    S += float(np.sum(kappa[1:] / (blade.omega[1:] ** 2 - nu**2))) + float(normal @ blade.S @ normal)
    hand = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=n, freq_hz=w_c / (2.0 * np.pi), modal_mass=1.0 / float(mobility[n, pair].mean())),
        blade=ct.gaps.ModalPair(freq_hz=nu / (2.0 * np.pi), modal_mass=1.0 / float(pressing[0]) ** 2),
        compliance=S,
        friction=plan.friction,
        lean_deg=plan.lean_deg,
    )
    met = next(
        c
        for c in coincidences(hand.contact(), np.array([nu / n / np.pi]))
        if c.branch == "backward" and c.free_hz > 0.0
    )
    if not met.drives:
        raise ValueError(f"friction {plan.friction} below tan(lean): no speed of this blade grows at f_b = f_c - n f")
    centre, half = n * (met.speed_hz - met.free_hz), n * met.half_hz
    return centre - half, centre + half


def bodies(
    casing: Study, structure: cf.Shell, target: float, blade: Study, plan: RubPlan, out: Path
) -> tuple[tuple[Path, Path], Tuning]:
    """Reduce the casing, tune and reduce the blade, save both: only these files cross to contact.

    `target` is the casing's mode [Hz]. The blade is put at the free coincidence first; its basis then tells where
    the growing band lies, and it is moved into that.
    """
    rim = run_reduce(casing, structure)
    coincidence = against(target, plan) - plan.n * plan.speed_hz
    tip = run_reduce(blade, tuned(blade.shell, coincidence))
    low, high = (coincidence + shift for shift in growing_band(rim, tip, plan))
    wanted = low + plan.into_band * (high - low)
    strip = tuned(blade.shell, wanted)
    tip = run_reduce(blade, strip)
    print(rim, tip, sep="\n")
    files = rim.save(out / "rig_casing.npz"), tip.save(out / "rig_blade.npz")
    tuning = Tuning(coincidence=coincidence, low=low, high=high, target=wanted, thickness=strip.thickness)
    return files, tuning


def run(name: str, files: tuple[Path, Path], plan: RubPlan, terms: list[dict[str, float]]) -> Rub:
    """One rub: the blade is advanced past its first touch, and starts opposite to it."""
    casing, blade = (ct.ModalBody.load(file) for file in files)
    theta = np.linspace(0.0, 2.0 * np.pi, 3601)
    d = deviation(terms, theta)
    scene = ct.RotatingRim(
        casing,
        blade,
        clearance=-float(d.min()) - plan.advance,
        speed_hz=plan.speed_hz,
        lean_deg=plan.lean_deg,
        out_of_roundness=terms,
        angle_deg=float(np.degrees(theta[d.argmax()])),
        turning="casing",
    )
    write_atomic(files[0].with_name(f"rub_{name.replace(' ', '_')}.toml"), scene_toml(scene, files, plan))
    result = ct.run(
        scene,
        law=ct.Coulomb(mu=plan.friction),
        scheme=ct.ExactModal(),
        t_end=plan.t_end,
        dt=plan.dt,
        record=ct.Record(every=5, state_every=20),
        on_limit="flag",  # its levels are wanted, also where the rim passes half its wall: the page says so
    )
    print(f"\n{name}\n{result}")
    return Rub(name=name, result=result, levels=rim_levels(casing, result), film=rub_film(scene, result))


def scene_toml(scene: ct.RotatingRim, files: tuple[Path, Path], plan: RubPlan) -> str:
    """The run as a scene file beside the bases, for `casingfem rub`."""
    terms = ",\n    ".join(f"{{p = {t['p']}, cos = {t['cos']!r}, sin = {t['sin']!r}}}" for t in scene.out_of_roundness)
    return f"""[scene]
kind = "rim"
t_end = {plan.t_end!r}
on_limit = "flag"

[casing]
basis = "{files[0].name}"

[blade]
basis = "{files[1].name}"
lean_deg = {plan.lean_deg!r}

[contact]
clearance = {scene.clearance!r}
friction = {plan.friction!r}
angle_deg = {scene.angle_deg!r}
out_of_roundness = [
    {terms}
]

[speed]
hz = {plan.speed_hz!r}
turning = "{scene.turning}"

[scheme]
kind = "exact-modal"
dt = {plan.dt!r}
"""
