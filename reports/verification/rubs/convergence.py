"""Convergence of a rub with modes, time step, pieces of the blade's tip, and points of the rim's profile.

`python -m reports.verification.rubs.convergence [--quick] [--out DIR]`. The episode of reports.verification.rubs.bases
(a frustum at 5 Hz, a blade near 380 Hz, one touch in .12 s), errors of the contact impulse and L2 errors of the tip's
motion against the finest of each table; modes against 984 of them (12 meridional orders of every n up to 40). Each
table changes one thing.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.io.arrays import FloatArray
from reports.tables import Row, command_line, show, write
from reports.verification.rubs.bases import ADVANCE, DT, RIM, ROUGH, SPEED, T_END, blade, casing, steel_strip
from reports.verification.rubs.harmonic_basis import harmonic_basis

LEAN, MU = 10.0, 0.3
INSTANTS = np.linspace(0.0, T_END, 6001)[1:-1]  # where tips are compared


def main(out: Path, quick: bool = False) -> dict[str, list[Row]]:
    """Print and write the tables; returns them by name."""
    folder = out / "rub_convergence"
    strip = ct.ModalBody.load(blade().save(folder / "blade.npz"))
    rich = rim_body(folder, 6 if quick else 12)
    plain = rim_body(folder, 2)
    tables = {
        "modes": by_modes(folder, rich, strip, quick),
        "steps": by_steps(plain, strip, quick),
        "pieces": by_pieces(folder, plain, quick),
        "surface": by_surface(plain, strip, quick),
    }
    for name, rows in tables.items():
        show(TITLES[name].format(modes=len(rich.omega), plain=len(plain.omega)), rows)
        write(folder / f"{name}.csv", rows)
    return tables


TITLES = {
    "modes": "Modes of the casing, with their residual compliance, against {modes}",
    "steps": "Time step, {plain} modes",
    "pieces": "Pieces of the blade's tip, all before the rim's edge, {plain} modes",
    "surface": "The rim's profile from a table of points, against its two cosines, {plain} modes",
}


def by_modes(folder: Path, rich: ct.ModalBody, strip: ct.ModalBody, quick: bool) -> list[Row]:
    """Meridional orders and harmonics kept."""
    reference = run(one_tip(rich, strip))
    rows: list[Row] = []
    for n_max, orders in ((20, 1), (40, 1)) if quick else ((10, 1), (20, 1), (40, 1), (40, 2), (40, 4), (40, 8)):
        body = rim_body(folder, lambda n, n_max=n_max, orders=orders: orders if n <= n_max else 0)
        rows.append(
            {"n up to": n_max, "orders": orders, "modes": len(body.omega), **off(run(one_tip(body, strip)), reference)}
        )
    return rows


def by_steps(body: ct.ModalBody, strip: ct.ModalBody, quick: bool) -> list[Row]:
    """Step, and the order by which errors fall from the row before."""
    fine = 1e-6 if quick else 2.5e-7
    reference = run(one_tip(body, strip), dt=fine)
    rows: list[Row] = []
    for dt in (8e-6, 4e-6) if quick else (1.6e-5, 8e-6, 4e-6, 2e-6, 1e-6):
        found = off(run(one_tip(body, strip), dt=dt), reference)
        order = None if not rows else float(np.log2(float(str(rows[-1]["tip error"])) / float(str(found["tip error"]))))
        rows.append({"dt [us]": 1e6 * dt, **found, "order, tip": order})
    return rows


def by_pieces(folder: Path, body: ct.ModalBody, quick: bool) -> list[Row]:
    """Equal pieces of the tip's edge, each a contact."""
    counts = (1, 2) if quick else (1, 2, 4, 8)
    runs = {count: run(pieces(body, tip_pieces(folder, count), count)) for count in (*counts, 2 * counts[-1])}
    reference = runs.pop(2 * counts[-1])
    return [{"pieces": count, "against": 2 * counts[-1], **off(found, reference)} for count, found in runs.items()]


def by_surface(body: ct.ModalBody, strip: ct.ModalBody, quick: bool) -> list[Row]:
    """Points of the surveyed profile, by the cubic with continuous slope and by straight lines."""
    exact = run(one_tip(body, strip))
    rows: list[Row] = []
    for points in (24, 96) if quick else (12, 24, 48, 96, 192, 384):
        theta = 2.0 * np.pi * np.arange(points) / points
        row: Row = {"points": points}
        for name, profile in (
            ("cubic", ct.gaps.RimProfile(theta=theta, depth=depth(theta))),
            ("straight", straight(theta)),
        ):
            found = off(run(replace(one_tip(body, strip), profile=profile)), exact)
            row |= {f"{name}: {key}": value for key, value in found.items() if key != "run [s]"}
        rows.append(row)
    return rows


def run(scene: ct.Rub, dt: float = DT) -> ct.Result:
    """One episode; the static compliance of modes above the limit of the step becomes part of the residual."""
    body = scene.casing
    if body.omega.max() > 2.5 / dt:
        scene = replace(scene, casing=body.truncated(2.5 / dt))
    record = ct.Record(every=4, state_every=4)
    return ct.run(scene, law=ct.Coulomb(mu=MU), t_end=T_END, dt=dt, record=record)


def off(found: ct.Result, reference: ct.Result) -> Row:
    """Relative errors of the impulse of all contacts and of the tip's motion."""
    a, b = (tip(result) for result in (found, reference))
    return {
        "impulse error": abs(float(found.impulse.sum() / reference.impulse.sum()) - 1.0),
        "tip error": float(np.linalg.norm(a - b) / np.linalg.norm(b)), "run [s]": found.seconds,
    }  # fmt: skip


def tip(result: ct.Result) -> FloatArray:
    """First coordinate of the blade, which is its first bending mode, at the same instants."""
    motion = result.state_of("blade")[:, 0]
    return np.asarray(np.interp(INSTANTS, result.state_time, motion * np.sign(motion[np.abs(motion).argmax()])))


def one_tip(body: ct.ModalBody, strip: ct.ModalBody) -> ct.Rub:
    """The episode of reports.verification.rubs.bases."""
    return episode(body, strip, (ct.ContactPoint(lean_deg=LEAN),))


def pieces(body: ct.ModalBody, strip: ct.ModalBody, count: int) -> ct.Rub:
    """The same with a contact at every piece of the tip."""
    tips = (ct.ContactPoint(span=f"node{k}.span", flap=f"node{k}.flap", lean_deg=LEAN) for k in range(count))
    return episode(body, strip, tuple(tips))


def episode(body: ct.ModalBody, strip: ct.ModalBody, tips: tuple[ct.ContactPoint, ...]) -> ct.Rub:
    """A blade advanced past its first touch."""
    lowest = float(depth(np.linspace(0.0, 2.0 * np.pi, 3601)).min())
    return ct.Rub(
        body, (strip,), tips, clearance=-lowest - ADVANCE, speed=ct.Speed.constant(SPEED),
        profile=ct.gaps.RimProfile.fourier(ROUGH),
    )  # fmt: skip


def depth(theta: FloatArray) -> FloatArray:
    """The out-of-roundness at angles [m]."""
    return np.sum([term["cos"] * np.cos(term["p"] * theta) for term in ROUGH], axis=0)


def straight(theta: FloatArray, parts: int = 64) -> ct.gaps.RimProfile:
    """Straight lines between the points: a table of `parts` more points on each."""
    dense = 2.0 * np.pi * np.arange(parts * len(theta)) / (parts * len(theta))
    ends = np.append(theta, 2.0 * np.pi)
    return ct.gaps.RimProfile(theta=dense, depth=np.interp(dense, ends, depth(ends)))


def rim_body(folder: Path, orders: Callable[[int], int] | int) -> ct.ModalBody:
    """The frustum by harmonics."""
    basis = harmonic_basis(casing(), RIM, orders=orders, zeta=0.002)
    return ct.ModalBody.load(basis.save(folder / "casing.npz"))


def tip_pieces(folder: Path, count: int) -> ct.ModalBody:
    """The blade seen at the pieces of its tip."""
    basis = cf.reduce(steel_strip(), cf.TipNodes(count=count), modes=4, zeta=0.002)
    return ct.ModalBody.load(basis.save(folder / "pieces.npz"))


if __name__ == "__main__":
    command_line(__doc__, main)
