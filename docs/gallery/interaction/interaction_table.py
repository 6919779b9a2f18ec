"""
The dangerous speeds of a rub
=============================

Poles of closed contact give candidate speeds and the growing motion; runs of the scene decide. The blades turn in a
fixed casing, as in an engine: at f_c + f_b = n f the motion grows even without friction.
"""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.plot.interaction import figure_interactions

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
    rim = cf.reduce(casing, cf.Rim("top", n_max=8), modes=12, zeta=5e-4).save(Path(folder, "casing.npz"))
    tip = cf.reduce(blade, cf.Tip(), modes=2, zeta=5e-4).save(Path(folder, "blade.npz"))
    bodies = ct.ModalBody.load(rim), ct.ModalBody.load(tip)
rub = ct.RotatingRim(
    *bodies,
    clearance=-5e-5,
    speed_hz=100.0,
    lean_deg=20.0,
    turning="blades",
)
scene = ct.Scene(what=rub, law=ct.Coulomb(mu=0.1), t_end=0.08, dt=1e-5)
found = ct.interactions(scene, np.linspace(60.0, 220.0, 41), runs=12)
print(found)
figure = figure_interactions(found)

# %%
# In the worst range a wave grows that travels with the blade. In the run the contact opens, and the motion grows more
# slowly than with closed contact.

worst = found.rows[0]
assert (worst.at.verdict, worst.wave) == ("unstable", "with")
assert 0.0 < worst.at.growth < worst.at.closed

# %%
# On a rig whose casing turns in front of a fixed blade, Coriolis forces make every wave faster than the blade: this
# coincidence does not occur (:doc:`theory </theory/interaction>`).

rig = ct.stability.peaks(replace(rub, turning="casing"), np.linspace(60.0, 220.0, 161), mu=0.1)
assert max([row.growth for row in rig.rows], default=0.0) < 0.5 * worst.at.closed
