"""Validation cases of code_aster: a pipe with five pairs of ends, a rubbing pad, a mass on a stop.

- V2.02.153: a thin pipe, 1 m long; its reference values are those of thin-shell theory (Goldenveizer and Novozhilov) by
  Haar wavelets. m = 1, n = 1 to 6 waves around.
- V5.01.100, SDND100: a mass on a spring and a rubbing plane. Turning points in closed form: each half swing ends
  2 mu N/k nearer, until the spring is weaker than friction.
- V5.01.101, SDND101: a mass on a spring flies against an elastic stop. Closed form: half a period of both springs.
"""

import math

import numpy as np

import contact as ct
from casingfem.modal.modes import modes
from casingfem.structure.edge.support import Clamped, ShearDiaphragm
from casingfem.structure.geometry.chart import Cylinder
from casingfem.structure.material import Material
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.shell import Shell
from reports.tables import Row
from reports.verification.outside.columns import row

PIPE = "code_aster V2.02.153, thin-shell theory"
STEEL = Material(E=200e9, nu=0.3, rho=7800.0)
ENDS = {
    "free, free": ({}, (598.846, 654.216, 1850.287, 3547.660, 5737.228, 8416.323)),
    "supported, free": ({"base": ShearDiaphragm()}, (415.756, 657.308, 1851.807, 3549.113, 5738.698, 8417.793)),
    "supported, supported": (
        {"base": ShearDiaphragm(), "top": ShearDiaphragm()},
        (272.118, 663.543, 1855.440, 3552.948, 5742.737, 8421.966),
    ),
    "clamped, supported": (
        {"base": Clamped(), "top": ShearDiaphragm()}, (391.746, 671.113, 1856.454, 3553.286, 5742.872, 8422.000)
    ),
    "clamped, clamped": (
        {"base": Clamped(), "top": Clamped()}, (559.562, 687.249, 1858.296, 3553.911, 5743.210, 8422.237)
    ),
}  # fmt: skip
WIDTH = 0.04  # of a frequency: its mode is searched within it on both sides
MESH = ShellMesh(order=8, rows=10, around=9)
ALLOWED, APART = 0.3, 3.5  # %
BEAM = "a Timoshenko beam of this section has ours within 0.3 % (271.6, 404.4, 418.3, 555.5, 598.8 Hz)"
FREE = "not explained: both ends free differ by 0.2 %"
THIN = "thin-shell theory has neither shear nor rotary inertia: its error grows with n"
PAD, STOP = "code_aster V5.01.100, closed form", "code_aster V5.01.101, closed form"


def pipe() -> list[Row]:
    """Frequencies of the pipe with each pair of ends."""
    found = []
    for ends, (supports, values) in ENDS.items():
        shell = Shell(
            chart=Cylinder(radius=0.05, height=1.0), thickness=2.5e-3, material=STEEL, supports=supports, mesh=MESH
        )
        for n, value in enumerate(values, 1):
            near = modes(shell, band=((1.0 - WIDTH) * value, (1.0 + WIDTH) * value))
            ours = float(near.freq[np.array(near.nodal_diameters) == n][0])
            why = BEAM if n == 1 else FREE if n == 2 else THIN
            found.append(row("published", f"pipe, {ends}, n = {n}", PIPE, value, ours, ALLOWED, gap=APART, reason=why))
    return found


def pad() -> list[Row]:
    """Turning points of 1 kg on 10 kN/m, released at 0.85 mm on a plane with mu N = 1 N: 0.2 mm nearer each."""
    omega, start, loss = 100.0, 0.85e-3, 2e-4
    body = ct.ModalBody(
        omega=np.array([omega, 0.0]),
        zeta=np.zeros(2),
        channels=("x", "y"),
        rows=np.eye(2),
        S=np.zeros((2, 2)),
        kind="point",
    )
    patch = ct.Patch(
        body=body,
        normal=("y",),
        tangent=(("x",),),
        clearance=0.0,
        load=np.array([0.0, -10.0]),
        displacement=np.array([start, 0.0]),
    )
    half = math.pi / omega
    run = ct.run(patch, law=ct.Coulomb(mu=0.1), scheme=ct.ExactModal(), t_end=5.0 * half, dt=half / 2000.0,
                 record=ct.Record(state_every=1))  # fmt: skip
    return [
        row("published", f"rubbing pad, turning point {k} [mm]", PAD, 1e3 * (-1.0) ** k * (start - k * loss),
            1e3 * float(np.interp(k * half, run.state_time, run.state[:, 0])), 0.05)
        for k in range(1, 5)
    ]  # fmt: skip


def stop() -> list[Row]:
    """100 kg on 10 kN/m at 1 m/s against a stop of 1 MN/m: force, duration and impulse of the shock."""
    mass, spring, bumper = 100.0, 1e4, 1e6
    body = ct.ModalBody(
        omega=np.array([math.sqrt(spring / mass)]), zeta=np.zeros(1), channels=("gap",),
        rows=np.array([[-1.0 / math.sqrt(mass)]]), S=np.array([[1.0 / bumper]]), kind="point",
    )  # fmt: skip
    patch = ct.Patch(body=body, normal=("gap",), clearance=0.0, velocity=np.array([math.sqrt(mass)]))
    omega = math.sqrt((spring + bumper) / mass)
    run = ct.run(patch, scheme=ct.ExactModal(), t_end=2.0 * math.pi / omega, dt=math.pi / omega / 20000.0)
    values = {
        "largest force [N]": (bumper / omega, float(run.peak_force.max())),
        "duration [ms]": (1e3 * math.pi / omega, 1e3 * float(run.contact_steps.max()) * run.dt),
        "impulse [N s]": (2.0 * mass * bumper / (spring + bumper), float(run.impulse.sum())),
    }
    return [
        row("published", f"mass on a stop, {name}", STOP, value, ours, 0.1) for name, (value, ours) in values.items()
    ]


def rows() -> list[Row]:
    """All rows of code_aster's validation manual."""
    return [*pipe(), *pad(), *stop()]
