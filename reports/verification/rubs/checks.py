"""The rub of several tip nodes with stick: speed, bases, the energy identity of the moving contact.

`python -m reports.verification.rubs.checks [--quick] [--out DIR]`. Casing: the frustum of
`reports.verification.rubs.bases` (R .50 -> .45 m, t 3 mm, clamped), free edge seen radially, around and along the axis;
blade: its strip, the tip cut into pieces. Errors against 12 meridional orders of every n up to 40 with residual
compliance.
"""

import time
from pathlib import Path
from typing import Literal

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.io.arrays import FloatArray
from contact import recovery
from reports.tables import Row, command_line, show_all
from reports.verification.rubs.bases import ADVANCE, ROUGH, SPEED, casing
from reports.verification.rubs.harmonic_basis import harmonic_basis

RIM = cf.Rim("top", n_max=40, axial=True)
COARSE = cf.Rim("top", n_max=20, axial=True)
ORDER = 10  # the rim's harmonic that is compared
MU = 0.3
LEAN = 10.0


def strip(nodes: int) -> ct.ModalBody:
    """The blade of `reports.verification.rubs.bases`, its tip in `nodes` pieces."""
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    shell = cf.Shell(
        chart=cf.Plate(length=0.110, width=0.040), thickness=5.4e-3, material=steel, supports={"root": cf.Clamped()}
    )
    return body(cf.reduce(shell, cf.TipNodes(count=nodes), modes=4, zeta=0.002))


def body(basis: cf.ModalBasis) -> ct.ModalBody:
    """A basis as a body of `contact`."""
    return ct.ModalBody(
        omega=basis.omega, zeta=basis.zeta, channels=basis.channels, rows=basis.rows, S=basis.S, kind=basis.kind,
        n_max=basis.n_max, radius=basis.radius,
    )  # fmt: skip


def rub(rim: ct.ModalBody, blade: ct.ModalBody, nodes: int, *, advance: float = ADVANCE) -> ct.Rub:
    """One blade, its chord along the axis, `advance` past the first touch of the defect."""
    theta = np.linspace(0.0, 2.0 * np.pi, 3601)
    depth = sum(term["cos"] * np.cos(term["p"] * theta) for term in ROUGH)
    tips = [
        ct.ContactPoint(span=f"node{k}.span", flap=f"node{k}.flap", axial=f"node{k}.chord", lean_deg=LEAN)
        for k in range(nodes)
    ]
    return ct.Rub(
        rim, (blade,), tuple(tips), clearance=-float(np.min(depth)) - advance, speed=ct.Speed.constant(SPEED),
        profile=ct.gaps.RimProfile.fourier(ROUGH), thickness=3e-3,
    )  # fmt: skip


def speed_rows(quick: bool) -> list[Row]:
    """50 revolutions of 1,000 steps, 16 nodes in three directions; processor time, which others' work does not move."""
    nodes, turns = 16, 2 if quick else 50
    dt = 1.0 / SPEED / 1000
    rim = body(cf.reduce(casing(), COARSE, modes=48, zeta=0.002))
    blade = strip(nodes)
    blade = blade.truncated(min(2.5 / dt, float(blade.omega[1]) * 1.01))
    rows: list[Row] = []
    for advance in (2e-5, 1e-4) if quick else (2e-5, 1e-4, 4e-4):
        scene = rub(rim, blade, nodes, advance=advance)
        ct.run(scene, law=ct.Coulomb(mu=MU), t_end=10 * dt, dt=dt)  # compiles
        began = time.process_time()
        result = ct.run(
            scene, law=ct.Coulomb(mu=MU), t_end=turns / SPEED, dt=dt, record=ct.Record(every=100), on_limit="flag"
        )  # its time is wanted, also where the rim passes half its wall
        seconds = time.process_time() - began
        rows.append(
            {
                "advance [mm]": 1e3 * advance,
                "modes": rim.omega.size + blade.omega.size,
                "tips": nodes,
                "steps": result.steps,
                "time in contact": float(result.contact_steps.max()) / result.steps,
                "processor [s]": seconds,
                "us per step": 1e6 * seconds / result.steps,
                "s per 50,000 steps": 5e4 * seconds / result.steps,
                "wall [s]": result.seconds,
            }
        )
    return rows


def motions(scene: ct.Rub, result: ct.Result, *, residual: bool) -> tuple[FloatArray, FloatArray]:
    """Amplitudes of the rim's n = 10 (ns, 2) and flap of the blade's middle node (ns,)."""
    found = []
    for name, part in zip(scene.names, scene.bodies, strict=True):
        _, forces = recovery.rub_forces(scene, result, name)
        found.append(recovery.at_channels(part, result.state_of(name), forces * residual))
    rim = found[0][:, [scene.casing.channel(f"radial.{wave}{ORDER}") for wave in ("cos", "sin")]]
    return rim, found[1][:, scene.blades[0].channel(f"node{len(scene.tips) // 2}.flap")]


def basis_rows(quick: bool) -> list[Row]:
    """One rubbing episode by basis of the casing: impulse, blade and rim."""
    dt, t_end, shell = 2e-6, 0.12, casing()
    cases = {
        "reference: n <= 40, 12 orders, S": harmonic_basis(shell, RIM, orders=4 if quick else 12, zeta=0.002),
        "n <= 20, 1 order, S": harmonic_basis(shell, RIM, orders=lambda n: int(n <= 20), zeta=0.002),
        "n <= 20, 1 order, no S": harmonic_basis(shell, RIM, orders=lambda n: int(n <= 20), zeta=0.002, residual=False),
    }
    rows: list[Row] = []
    for nodes in (1,) if quick else (1, 5):
        blade, reference = strip(nodes), None
        for name, basis in cases.items():
            rim = body(basis)
            scene = rub(rim.truncated(2.5 / dt), blade, nodes)
            result = ct.run(scene, law=ct.Coulomb(mu=MU), t_end=t_end, dt=dt, record=ct.Record(every=5, state_every=5))
            full, bare = motions(scene, result, residual=True), motions(scene, result, residual=False)
            reference = reference or (float(result.impulse.sum()), full)
            rows.append(
                {
                    "nodes": nodes,
                    "basis": name,
                    "modes": rim.omega.size + blade.omega.size,
                    "impulse error": abs(float(result.impulse.sum()) / reference[0] - 1.0),
                    "blade error": distance(full[1], reference[1][1]),
                    "rim n = 10 error": distance(full[0], reference[1][0]),
                    "the same without R lam": distance(bare[0], reference[1][0]),
                    "run [s]": result.seconds,
                }
            )
    return rows


def distance(found: FloatArray, reference: FloatArray) -> float:
    """L2 distance over time, relative."""
    return float(np.linalg.norm(found - reference) / np.linalg.norm(reference))


def energy_rows(quick: bool) -> list[Row]:
    """Energy balance, rotation + drive = heat + damping + stored energy: its remainder decreases with the step.

    Rotation is the work of the moving contact point along the gap, drive the work against friction. The rotation of the
    rim supplies both; most of it becomes heat.
    """
    nodes, t_end = 5, 0.05 if quick else 0.4
    rim, blade = body(cf.reduce(casing(), COARSE, modes=43, zeta=0.002)), strip(5)
    scene = rub(rim, blade, nodes)
    default = 0.8 / max(float(rim.omega[-1]), float(blade.omega[-1]))  # what a run takes without dt
    rows: list[Row] = []
    laws: tuple[Literal["auto", "forward"], ...] = ("auto", "forward")
    for law in laws:
        for part in (1.0, 0.5, 0.25):
            scheme = ct.ExactModal(law=law)
            result = ct.run(scene, law=ct.Coulomb(mu=MU), scheme=scheme, t_end=t_end, dt=part * default,
                            record=ct.Record(every=1000))  # fmt: skip
            energy, heat, drive = result.energy, float(result.notes.heat.sum()), float(result.notes.drive.sum())
            fed = energy.rotation + drive
            left = fed - heat + energy.damping - (energy.end.total - energy.start.total) + energy.numerical
            rows.append(
                {
                    "law": law,
                    "chosen": "averaged" if "averaged" in result.scheme else "forward",
                    "dt/default": part,
                    "dt [s]": result.dt,
                    "rotation [J]": energy.rotation,
                    "friction on bodies [J]": energy.friction,
                    "drive [J]": drive,
                    "heat [J]": heat,
                    "left of all fed in": abs(left) / fed,
                    "left of the work into the bodies": abs(left) / (abs(energy.rotation) + abs(energy.friction)),
                    "unaccounted": energy.unaccounted / energy.scale,
                }
            )
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the tables; returns all rows."""
    tables = {
        "rub_speed": ("16 tip nodes, friction in two directions", speed_rows(quick)),
        "rub_bases": ("One rubbing episode by basis of the casing, three directions", basis_rows(quick)),
        "rub_energy": ("Energy identity of the moving contact, 5 nodes", energy_rows(quick)),
    }
    return show_all(out, "", tables)


if __name__ == "__main__":
    command_line(__doc__, main)
