"""Commands that write sets of files, or single ones, each with its input in an old and a new state."""

from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

import contact as ct
from casingfem.cli import main as casingfem
from casingfem.experiment.frf.frf_set import FrfSet
from reports.verification.robustness.mesh_samples import cyclic_inp

SEED = 20261
STUDY = """[material]
E = 2e11
nu = 0.3
rho = 7800.0
[chart]
kind = "cylinder"
radius = 0.2
height = 0.2
[shell]
thickness = {t}
[[imperfection]]
of = "radius"
harmonics = [{{p = 4, cos = 1e-3}}]
[support.base]
kind = "clamped"
[modes]
count = 4
[mesh]
order = 5
rows = 1
around = 9
[update]
table = "table.csv"
[[update.parameter]]
name = "material.E"
lower = 1e11
upper = 3e11
"""
SWEEP = """[scene]
kind = "rods"
t_end = 1e-4
[[mass]]
mass = 1.0
x = 0.0
velocity = 1.0
stiffness = {k}
[wall]
x = 1e-5
[scheme]
kind = "forward-lagrange"
dt = 1e-6
[sweep]
[[sweep.vary]]
key = "mass[1].velocity"
values = [0.1, 0.2, 0.4]
"""
SPOKES = """[material]
E = 2e11
nu = 0.3
rho = {rho}
[solid]
mesh = "wheel.inp"
[cyclic]
sectors = 12
faces = ["low", "high"]
[modes]
count = 4
"""
RIM = """[scene]
kind = "rim"
t_end = 0.02
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = {gap}
friction = 0.1
out_of_roundness = [{{p = 2, cos = 2e-4}}]
[speed]
turning = "blades"
hz = 20.0
scan = {{from_hz = 5.0, to_hz = 40.0, steps = 8}}
[scheme]
kind = "exact-modal"
dt = 2e-5
"""


class Target(NamedTuple):
    """A command, with the files of an old state and a new one, and the name of its result if that is one file.

    It is killed at each of its moments, or at one in `every`: some draw pictures for seconds each time.
    """

    arguments: tuple[str, ...]
    old: Path
    new: Path
    single: str = ""
    every: int = 1

    def run(self, file: Path, out: Path) -> None:
        """The command on one of its files, in this process."""
        arguments = [self.arguments[0], str(file), *self.arguments[1:], "--out", str(out / self.single)]
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            casingfem(arguments, standalone_mode=False)


def write_inputs(folder: Path, by: float) -> None:
    """Input of the commands in one state."""
    folder.mkdir(parents=True)
    study, sweep = STUDY.format(t=2e-3 * by), SWEEP.format(k=1e4 * by)
    texts = {
        "study.toml": study, "sweep.toml": sweep, "scene.toml": sweep.partition("[sweep]")[0],
        "reduced.toml": study + '[reduce]\ninterface = "top"\nn_max = 4\nmodes = 8\n',
        "rim.toml": RIM.format(gap=1e-4 * by), "wheel.toml": SPOKES.format(rho=7800.0 * by),
        "table.csv": "# SYNTHETIC\nmode,n,freq_hz,sigma_hz\n1,,1300,20\n2,,1400,20\n",
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "wheel.inp").write_text(cyclic_inp(), encoding="utf-8")
    ring = ct.bodies.ThinRing(radius=0.25, width=0.05, height=4e-3, E=210e9, rho=7800.0, k_r=2e7, k_t=2e6, zeta=0.005)
    ct.bodies.ring_modes(ring, 2).truncated(8e4).save(folder / "casing.npz")
    ct.ModalBody(
        omega=[2400.0, 15000.0], zeta=[0.002, 0.002], channels=("span", "flap"), rows=[[0.1, 0.2], [2.0, 0.5]],
        S=[[2e-8, 0.0], [0.0, 6e-8]],
    ).save(folder / "blade.npz")  # fmt: skip
    K, M = np.array([[2.0, -1.0], [-1.0, 2.0]]) * 1e6 * by, np.eye(2)
    np.savez(folder / "part.npz", K=K, M=M, dofs=[[7, 1], [9, 1]])
    responses(by).save(folder / "frfs.npz")


def responses(by: float) -> FrfSet:
    """Two modes of a blade at three sensors, struck at one."""
    f = np.arange(50.0, 350.0, 1.0)
    shapes = np.array([[1.0, 0.6, 0.2], [1.0, -0.4, -0.7]])
    omega, s = 2.0 * np.pi * by * np.array([120.0, 260.0]), 2j * np.pi * f
    poles = s**2 + 0.02 * omega[:, None] * s + omega[:, None] ** 2
    noise = np.random.default_rng(SEED).normal(size=(2, 3, f.size)) * 1e-9
    return FrfSet.from_arrays(
        kind="frf", x=f, responses=(shapes * shapes[:, :1]).T @ (1.0 / poles) + noise[0] + 1j * noise[1],
        response_point=[1, 2, 3], response_direction=[3, 3, 3], reference_point=[1, 1, 1],
        reference_direction=[3, 3, 3], unit="m/N", card=("SYNTHETIC: two modes",),
    )  # fmt: skip


COMMANDS = {
    "modes": ("study.toml", ("modes", "--vtu", "--modes", "1,2")), "update": ("study.toml", ("update",)),
    "report": ("study.toml", ("report",)), "sweep": ("sweep.toml", ("sweep", "--jobs", "1")),
    "rub": ("rim.toml", ("rub",)), "contact": ("scene.toml", ("contact",)),
    "interactions": ("rim.toml", ("interactions",)), "wheel": ("wheel.toml", ("modes",)),
    "reduce": ("reduced.toml", ("reduce",)), "export": ("study.toml", ("export",)),
    "identify": ("frfs.npz", ("identify", "--open", "--order", "8")),
}  # fmt: skip


SPARSE = {"rub": 3, "contact": 3, "identify": 4}


def targets(folder: Path) -> dict[str, Target]:
    """Commands that write sets, or single files."""
    for state, by in {"old": 1.0, "new": 1.1}.items():
        write_inputs(folder / state, by)
    found = {
        name: Target(arguments, folder / "old" / file, folder / "new" / file, every=SPARSE.get(name, 1))
        for name, (file, arguments) in COMMANDS.items()
    }
    imported = ("import", "--contact", "7", "--modes", "2")
    return found | {"import": Target(imported, folder / "old" / "part.npz", folder / "new" / "part.npz", "basis.npz")}
