"""
Many runs at once
=================

Eight runs of the same kind are computed at a time; each has the result of a single run. This example varies the
clearance, which changes the number of contacts a turn.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
import contact as ct

steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
casing = cf.Shell(
    chart=cf.Cylinder(radius=0.20, height=0.15),
    thickness=1.5e-3,
    material=steel,
    supports={"base": cf.Clamped()},
    mesh=cf.ShellMesh(order=6, rows=1, around=17),
)
blade = cf.Shell(
    chart=cf.Plate(length=0.08, width=0.03),
    thickness=2e-3,
    material=steel,
    supports={"root": cf.Clamped()},
    mesh=cf.ShellMesh(order=6, rows=2, around=2),
)
with tempfile.TemporaryDirectory() as folder:
    rim = cf.reduce(casing, cf.Rim("top", n_max=8), modes=12, zeta=0.01).save(Path(folder, "casing.npz"))
    tip = cf.reduce(blade, cf.Tip(), modes=2, zeta=0.01).save(Path(folder, "blade.npz"))
    bodies = ct.ModalBody.load(rim), ct.ModalBody.load(tip)
clearances = np.linspace(0.0, 3e-4, 16)
scenes = [
    ct.Scene(
        what=ct.RotatingRim(*bodies, clearance=clearance, speed_hz=20.0, out_of_roundness=[{"p": 3, "cos": 2e-4}]),
        law=ct.Unilateral(),
        scheme=ct.ExactModal(),
        t_end=0.1,
        dt=1e-5,
    )
    for clearance in clearances.tolist()
]
results = ct.run_many(scenes)
impulse = [float(result.impulse[0]) for result in results]

figure, axes = plt.subplots(layout="constrained")
axes.plot(1e3 * clearances, impulse, "o-")
axes.axvline(0.2, color="0.6", label="out-of-roundness")
axes.set(xlabel="clearance [mm]", ylabel="impulse in two turns [N s]")
axes.legend()

assert impulse[0] > 0.0
assert impulse[-1] == 0.0
