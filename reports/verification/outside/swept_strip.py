"""A turning strip with a swept tip, measured: Epps and Chandra, J. Am. Helicopter Soc. 41, 1996, 29.

An aluminium strip, 1 in wide and 0.063 in thick, clamped 2.5 in from the axis; 31.5 in straight, then a tip of 6 in
swept in its plane. The values are those of data/experiments/swept_tip_rotor.csv; modes in the plane are left out. The
steady state is linear: a swept tip turns into the plane of rotation, and the program warns of it (`rotation-large`).
"""

import warnings

import numpy as np
import pandas as pd

from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.mesh.mesh_data import Group, MeshData
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.material import Material
from reports.tables import DATA, Row
from reports.verification.modes import branching
from reports.verification.outside.columns import row

TABLE = DATA / "experiments" / "swept_tip_rotor.csv"
SOURCE = "Epps and Chandra 1996"
INCH, PSI = 0.0254, 6894.757293168
STRAIGHT, TIP, WIDTH, THICKNESS, ROOT = (inches * INCH for inches in (31.5, 6.0, 1.0, 0.063, 2.5))
ALUMINIUM = Material(E=1.06e7 * PSI, nu=0.325, rho=2.51e-4 * PSI / INCH**2)
SWEEPS = (0, 15, 30, 45)  # deg
PLACES = {"1B": 0, "2B": 1, "3B": 2, "1T/5B": 3, "5B/1T": 4, "4B/1T": 5}  # among the modes out of the plane
OPEN = "the spread of the test, and how stiff the clamp was"
REASON = (
    "beam theory gives ours within 1 % for the straight strip at rest: strip or clamp of the test are not as stated"
)


def strip(sweep_deg: float, rpm: float, cells: tuple[int, int, int] = (24, 6, 1)) -> MeshShell:
    """The strip: cells along the straight part, along the tip and across; its sections turn evenly over two widths."""
    along = np.concatenate([np.linspace(0.0, 1.0, cells[0] + 1), 1.0 + np.linspace(0.0, 1.0, cells[1] + 1)[1:]])
    u, v = np.moveaxis(branching.grid("quad8", along, np.linspace(-0.5, 0.5, cells[2] + 1)), 2, 0)
    v = WIDTH * v
    beyond = np.where(u < 1.0, (u - 1.0) * STRAIGHT, (u - 1.0) * TIP)  # from the corner, along the axis
    sweep = np.radians(sweep_deg)
    mitre = np.tan(0.5 * sweep) * v * np.clip(1.0 - np.abs(beyond) / (2.0 * WIDTH), 0.0, 1.0)
    of_tip = (u.mean(axis=1) > 1.0)[:, None]
    m = beyond - mitre
    x = np.where(of_tip, m * np.cos(sweep) + v * np.sin(sweep), beyond + mitre) + ROOT + STRAIGHT
    y = np.where(of_tip, -m * np.sin(sweep) + v * np.cos(sweep), v)
    mesh = branching.joined("quad8", [np.stack([x, y, np.zeros_like(x)], axis=-1)], 0)
    base = Group(nodes=np.flatnonzero(mesh.points[:, 0] < ROOT + 1e-9))
    held = MeshData(kind="quad8", points=mesh.points, cells=mesh.cells, groups={"base": base}, source="strip")
    turning = Rotation(omega=rpm * np.pi / 30.0, axis=(0.0, 0.0, 1.0)) if rpm else None
    supports = {"base": Clamped()}
    return MeshShell(mesh=held, thickness=THICKNESS, material=ALUMINIUM, supports=supports, rotation=turning)


def out_of_plane(part: MeshShell) -> list[float]:
    """Frequencies [Hz] of the modes that move out of the strip's plane."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*rotation-large")
        found = modes(part, 9)
    largest = np.abs(found.fields[:, :3]).max(axis=0)
    share = largest[2] / largest[:2].max(axis=0)
    return found.freq[share > 1.0].tolist()


def rows() -> list[Row]:
    """Every measured frequency."""
    table = pd.read_csv(TABLE, comment="#")
    result = []
    for sweep in SWEEPS:
        for rpm, part in table.groupby("rpm"):
            found = out_of_plane(strip(sweep, float(rpm)))
            for name, measured in part[["mode", f"tip_{sweep}_hz"]].itertuples(index=False):
                case = f"strip, tip swept by {sweep} deg, {rpm} rpm, mode {name}"
                ours = found[PLACES[str(name)]]
                result.append(row("measured", case, SOURCE, measured, ours, 2.0, gap=18.0, reason=REASON, open_=OPEN))
    return result
