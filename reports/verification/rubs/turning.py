"""Rubs of bodies that turn against plain NumPy: growth of closed contact, a run in time, the energy ledger.

`python -m reports.verification.rubs.turning [--quick] [--out DIR]`. A reduced cylinder and a reduced blade, both with
their matrices of rotation; the casing turns or the blade does. The plain models take arrays of the bodies alone.

Growth at twenty speeds, with and without friction, is compared with the eigenvalues of a dense model. In the frame of
the contact point the motion z satisfies

    (D + Omega N)^2 z + C (D + Omega N) z + K z = W lam,   lam = -Q z/S,   W = Q - mu T,

C and K of the speed, Q and T the rows at the contact point, N (cos n, sin n) -> n (sin n, -cos n) of each pair. The
impulse of a run with closed contact is compared with a Runge-Kutta solution with 1/50 of the step. The difference falls
with the square of the step. The impulse of a shorter run is much smaller and its relative difference larger, so --quick
takes fewer speeds and the same run.
"""

import math
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.io.arrays import FloatArray
from contact.stability.closed_contact import growth
from reports.tables import Row, command_line, show, write

LEAN_DEG, FRICTION = 10.0, 0.3
SIDES: tuple[Literal["casing", "blades"], ...] = ("casing", "blades")
RUN_HZ, DEPTH, STEP, STEPS, PARTS = 100.0, 2e-5, 5e-7, 1600, 50
IMPULSE, LEDGER = 1e-6, 1e-11  # of the impulse, of the energy that passes through the ledger
ALLOWED = 1e-3  # of the growth, or of the largest growth of the twenty speeds where it is small
SPEEDS = np.array([*np.linspace(2.0, 150.0, 16), -5.0, -20.0, -60.0, -110.0])  # turns/s
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


def bodies() -> tuple[ct.ModalBody, ct.ModalBody]:
    """A cylinder of 2 mm and a strip on a hub, reduced at rest."""
    wall = cf.Shell(
        chart=cf.Cylinder(radius=0.2, height=0.1), thickness=2e-3, material=STEEL, supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=7, rows=2, around=23),
    )  # fmt: skip
    chart = cf.Plate(length=0.11, width=0.04)
    strip = cf.Shell(
        chart=chart, thickness=4e-3, material=STEEL, supports={"root": cf.Clamped()},
        rotation=cf.Rotation.of_blade(chart, omega=0.0, hub_radius=0.09), mesh=cf.ShellMesh(order=6, rows=2, around=1),
    )  # fmt: skip
    casing = cf.reduce(wall, cf.Rim("top", n_max=10), modes=16, zeta=1e-3)
    return ct.ModalBody.of(casing), ct.ModalBody.of(cf.reduce(strip, cf.Tip(), modes=4, zeta=1e-3))


def turned_pairs(casing: ct.ModalBody) -> FloatArray:
    """N of the module: each pair of modes by its effect on the cosine and the sine of its own n."""
    m, size = casing.omega.size, 2 * casing.n_max + 1
    cos, sin = casing.rows[1 : casing.n_max + 1], casing.rows[casing.n_max + 1 : size]
    order = np.argmax(cos**2 + sin**2, axis=0)
    N = np.zeros((m, m))
    for k in range(0, m, 2):
        n, pair = order[k], slice(k, k + 2)
        if order[k + 1] != n:
            raise ValueError(f"modes {k + 1} and {k + 2}: found n = {n + 1} and {order[k + 1] + 1}, expected a pair")
        waves = np.array([cos[n, pair], sin[n, pair]])
        N[pair, pair] = np.linalg.solve(waves, (n + 1) * np.array([[0.0, 1.0], [-1.0, 0.0]]) @ waves)
    return N


def across(casing: ct.ModalBody, angle: float) -> FloatArray:
    """Radial and tangential motion at an angle over the channels of the rim, (2, channels)."""
    N, size = casing.n_max, 2 * casing.n_max + 1
    waves = np.concatenate([np.cos(np.arange(N + 1) * angle), np.sin(np.arange(1, N + 1) * angle)])
    seen = np.zeros((2, len(casing.channels)))
    seen[0, :size] = seen[1, size : 2 * size] = waves
    return seen


def at_tip(blade: ct.ModalBody) -> FloatArray:
    """Normal and tangential motion of the tip over the channels of the blade, (2, channels)."""
    a, tip = math.radians(LEAN_DEG), np.zeros((2, len(blade.channels)))
    for name, along in (("span", (math.cos(a), -math.sin(a))), ("flap", (math.sin(a), math.cos(a)))):
        tip[:, blade.channels.index(name)] = along
    return tip


def matrices(casing: ct.ModalBody, blade: ct.ModalBody, hz: float, turning: str) -> tuple[FloatArray, FloatArray]:
    """C and K of both bodies at a speed [turns/s]; blades rotate in the opposite sense."""
    omega, own = 2.0 * math.pi * hz, casing.omega.size
    m = own + blade.omega.size
    C, K = np.zeros((2, m, m))
    speeds = (omega, 0.0) if turning == "casing" else (0.0, -omega)
    for body, here, speed in zip((casing, blade), (slice(0, own), slice(own, m)), speeds, strict=True):
        C[here, here], K[here, here] = body.matrices(speed)
    return C, K


def dense_growth(casing: ct.ModalBody, blade: ct.ModalBody, hz: float, mu: float, turning: str) -> float:
    """Largest real part [1/s] of the eigenvalues at a speed [turns/s]."""
    omega, own, pull = 2.0 * math.pi * hz, casing.omega.size, math.copysign(mu, hz)
    C, K = matrices(casing, blade, hz, turning)
    m, N = len(C), np.zeros_like(C)
    N[:own, :own] = turned_pairs(casing)
    rim, tip = across(casing, 0.0), at_tip(blade)
    Q, T = np.hstack([rim @ casing.rows, -tip @ blade.rows])
    soft = rim @ casing.S @ rim.T + tip @ blade.S @ tip.T
    contact = np.outer(Q - pull * T, Q) / (soft[0, 0] - pull * soft[0, 1])
    turn, scale = omega * N, float(casing.omega.max())
    state = np.block([
        [np.zeros((m, m)), scale * np.eye(m)],
        [-(turn @ turn + C @ turn + K + contact) / scale, -(2.0 * turn + C)],
    ])  # fmt: skip
    return float(np.linalg.eigvals(state).real.max())


def growths(casing: ct.ModalBody, blade: ct.ModalBody, speeds: FloatArray, folder: Path) -> list[Row]:
    """One row a case; all speeds in a file."""
    every, rows = [], []
    for turning in SIDES:
        for mu in (0.0, FRICTION):
            what = pressed(casing, blade, turning, 1.0, 1e-5)
            found = growth(ct.gaps.rim_contact(what, mu=mu), speeds)
            dense = np.array([dense_growth(casing, blade, hz, mu, turning) for hz in speeds.tolist()])
            plain = replace(what, casing=casing.without_rotation(), blade=blade.without_rotation())
            still = growth(ct.gaps.rim_contact(plain, mu=mu), speeds)
            off = np.abs(found - dense) / np.maximum(np.abs(dense), ALLOWED * np.abs(dense).max())
            every += [
                {"turning": turning, "friction": mu, "speed Hz": hz, "growth 1/s": one, "dense 1/s": other}
                for hz, one, other in zip(speeds.tolist(), found.tolist(), dense.tolist(), strict=True)
            ]
            rows.append({
                "turning": turning, "friction": mu, "speeds": len(speeds), "growth 1/s": float(dense.max()),
                "without rotation 1/s": float(still.max()), "off at most": float(off.max()),
                "allowed": ALLOWED, "verdict": verdict(float(off.max()), ALLOWED),
            })  # fmt: skip
    write(folder / "rub_turning_growth.csv", every)
    return rows


def pressed(
    casing: ct.ModalBody, blade: ct.ModalBody, turning: Literal["casing", "blades"], hz: float, depth: float
) -> ct.RotatingRim:
    """Bodies pressed together by up to twice a depth [m], twice a turn."""
    return ct.RotatingRim(
        casing, blade, clearance=-depth, speed_hz=hz, lean_deg=LEAN_DEG, turning=turning,
        out_of_roundness=[{"p": 2, "cos": depth}],
    )  # fmt: skip


def runge_kutta(
    casing: ct.ModalBody, blade: ct.ModalBody, hz: float, turning: str, steps: int, step_s: float
) -> FloatArray:  # fmt: skip
    """Normal force [N] at the beginning of each step of a contact that stays closed and slides."""
    omega, tip = 2.0 * math.pi * hz, at_tip(blade)
    C, K = matrices(casing, blade, hz, turning)
    m, k = len(C), step_s / PARTS

    def rows(t: float) -> tuple[FloatArray, FloatArray, float, float]:
        rim = across(casing, -omega * t)
        Q, T = np.hstack([rim @ casing.rows, -tip @ blade.rows])
        soft = rim @ casing.S @ rim.T + tip @ blade.S @ tip.T
        gap = -DEPTH * (1.0 - math.cos(2.0 * omega * t))
        return Q, Q - FRICTION * T, float(soft[0, 0] - FRICTION * soft[0, 1]), gap

    def rate(at: tuple[FloatArray, FloatArray, float, float], z: FloatArray) -> FloatArray:
        Q, W, soft, gap = at
        force = -(gap + Q @ z[:m]) / soft
        return np.concatenate([z[m:], W * force - C @ z[m:] - K @ z[:m]])

    z, found, now = np.zeros(2 * m), np.zeros(steps), rows(0.0)
    for step in range(steps):
        found[step] = -(now[3] + now[0] @ z[:m]) / now[2]
        for part in range(PARTS):
            t = step * step_s + part * k
            middle, then = rows(t + 0.5 * k), rows(t + k)
            a = rate(now, z)
            b = rate(middle, z + 0.5 * k * a)
            c = rate(middle, z + 0.5 * k * b)
            z = z + k / 6.0 * (a + 2.0 * b + 2.0 * c + rate(then, z + k * c))
            now = then
    return found


def runs(casing: ct.ModalBody, blade: ct.ModalBody, steps: int, step_s: float = STEP) -> list[Row]:
    """Impulse of a run and of Runge-Kutta, and the remainder of its energy balance over the energy exchanged."""
    rows: list[Row] = []
    scheme = ct.ExactModal(law="averaged")
    for turning in SIDES:
        what = pressed(casing, blade, turning, RUN_HZ, DEPTH)
        found = ct.run(what, law=ct.Coulomb(mu=FRICTION), scheme=scheme, dt=step_s, t_end=(steps - 0.5) * step_s)
        wanted = runge_kutta(casing, blade, RUN_HZ, turning, steps, step_s)
        off = abs(float(found.force[:, 0].sum() / wanted.sum()) - 1.0)
        left = abs(found.energy.unaccounted) / found.energy.scale
        rows.append({
            "turning": turning, "least force N": float(wanted[1:].min()), "impulse N s": float(wanted.sum()) * step_s,
            "off": off, "allowed": IMPULSE, "ledger leaves": left,
            "verdict": verdict(max(off, left * IMPULSE / LEDGER), IMPULSE),
        })  # fmt: skip
    return rows


def verdict(error: float, allowed: float) -> str:
    """The verdict of a row."""
    return "pass" if error <= allowed else "FAIL"


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print one row a case, and write them."""
    casing, blade = bodies()
    found = growths(casing, blade, SPEEDS[::4] if quick else SPEEDS, out)
    show("Growth of closed contact against a dense model", found)
    timed = runs(casing, blade, STEPS)
    show(f"Runs in time against Runge-Kutta's steps of 1/{PARTS}", timed)
    write(out / "rub_turning.csv", found)
    write(out / "rub_turning_runs.csv", timed)
    return found + timed


if __name__ == "__main__":
    command_line(__doc__, main)
