"""Error by the choice of basis: one rubbing episode with several reduced casings, compared with a large basis.

`python -m reports.verification.rubs.bases [--quick] [--out DIR]`. A perfect frustum (R .50 -> .45 m, t 3 mm, clamped)
turns at 5 Hz in front of a blade near 380 Hz; the out-of-roundness brings one contact episode. Error of the contact
impulse, and L2 error of the blade tip's motion, against 12 meridional orders of every n up to 40 with residual
compliance.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.io.arrays import FloatArray
from reports.tables import Row, command_line, show, write
from reports.verification.rubs.harmonic_basis import harmonic_basis

DT, T_END, SPEED = 2e-6, 0.12, 5.0
ROUGH = [{"p": 2, "cos": 2e-4}, {"p": 3, "cos": 5e-5}]
ADVANCE = 1e-4
RIM = cf.Rim("top", n_max=40)
ZETA = 0.002


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """Impulse [N s] and blade tip motion [m] of one run."""

    impulse: float
    tip: FloatArray
    seconds: float


def casing() -> cf.Shell:
    """The frustum, fine enough around for n = 40."""
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    mesh = cf.ShellMesh(order=7, rows=(0.0, 0.97, 1.0), around=35)
    chart = cf.Frustum(r_base=0.50, r_top=0.45, height=0.25)
    return cf.Shell(chart=chart, thickness=3e-3, material=steel, supports={"base": cf.Clamped()}, mesh=mesh)


def steel_strip(thickness: float = 5.4e-3) -> cf.Shell:
    """A blade of 110 by 40 mm; at this thickness its first mode lies near 380 Hz."""
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    plate = cf.Plate(length=0.110, width=0.040)
    return cf.Shell(chart=plate, thickness=thickness, material=steel, supports={"root": cf.Clamped()})


def blade() -> cf.ModalBasis:
    """The strip seen at its mean tip."""
    return cf.reduce(steel_strip(), cf.Tip(), modes=4, zeta=ZETA)


def make_casing(folder: Path, n_max: int, orders: int, name: str = "casing") -> ct.ModalBody:
    """The perfect frustum by harmonics, with residual compliance, as the file the scenes name."""
    basis = harmonic_basis(casing(), cf.Rim("top", n_max=n_max), orders=orders, zeta=ZETA)
    return ct.ModalBody.load(basis.save(folder / f"{name}.npz"))


def rub(basis: cf.ModalBasis, strip: cf.ModalBasis, folder: Path) -> Episode:
    """Run one episode; the bases cross to contact as files."""
    pair = [ct.ModalBody.load(b.save(folder / name)) for b, name in ((basis, "casing.npz"), (strip, "blade.npz"))]
    body = pair[0].truncated(2.5 / DT) if basis.omega[-1] > 2.5 / DT else pair[0]
    theta = np.linspace(0.0, 2.0 * np.pi, 3601)
    d = sum(term["cos"] * np.cos(term["p"] * theta) for term in ROUGH)
    scene = ct.RotatingRim(
        body, pair[1], clearance=-float(np.min(d)) - ADVANCE, speed_hz=SPEED, lean_deg=10.0, out_of_roundness=ROUGH
    )
    result = ct.run(scene, law=ct.Coulomb(mu=0.3), t_end=T_END, dt=DT, record=ct.Record(every=5, state_every=5))
    tip = result.state_of("blade") @ pair[1].rows[1]
    return Episode(impulse=float(result.impulse[0]), tip=tip, seconds=result.seconds)


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table; returns its rows."""
    shell, strip = casing(), blade()

    def free(orders: Callable[[int], int] | int, *, residual: bool) -> Callable[[], cf.ModalBasis]:
        return lambda: harmonic_basis(shell, RIM, orders=orders, zeta=ZETA, residual=residual)

    def up_to(n_max: int, orders: int) -> Callable[[int], int]:
        return lambda n: orders if n <= n_max else 0

    cases: dict[str, Callable[[], cf.ModalBasis]] = {
        "reference: free, n <= 40, 12 orders, with S": free(6 if quick else 12, residual=True),
        "free, n <= 20, 1 order, without S": free(up_to(20, 1), residual=False),
        "free, n <= 20, 1 order, with S": free(up_to(20, 1), residual=True),
        "free, n <= 40, 4 orders, without S": free(4, residual=False),
        "free, n <= 40, 4 orders, with S": free(4, residual=True),
    }
    if not quick:
        cases["Craig-Bampton, n <= 40"] = lambda: cf.reduce(shell, RIM, modes=6, method="craig-bampton", zeta=ZETA)
    rows: list[Row] = []
    reference: Episode | None = None
    folder = out / "bases"
    for name, make in cases.items():
        basis = make()
        episode = rub(basis, strip, folder)
        reference = reference or episode
        rows.append(
            {
                "basis": name,
                "modes": len(basis),
                "S share [%]": 100.0 * float(np.trace(basis.S) / np.trace(basis.compliance)),
                "impulse error": abs(episode.impulse / reference.impulse - 1.0),
                "tip error": float(np.linalg.norm(episode.tip - reference.tip) / np.linalg.norm(reference.tip)),
                "run [s]": episode.seconds,
            }
        )
    show("One rubbing episode by basis of the casing", rows)
    write(out / "bases.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
