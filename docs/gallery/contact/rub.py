"""
A blade rubs in an oval casing
==============================

Two reduced bodies, a clearance and an out-of-roundness: the blade touches twice a turn.
"""

import tempfile
from pathlib import Path

import casingfem as cf
import contact as ct
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.contact import figure_contact

steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
casing = cf.Shell(
    chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
    thickness=3e-3,
    material=steel,
    supports={"base": cf.Clamped()},
    mesh=cf.ShellMesh(order=6, rows=1, around=17),
)
blade = cf.Shell(
    chart=cf.Plate(length=0.11, width=0.04),
    thickness=5e-3,
    material=steel,
    supports={"root": cf.Clamped()},
    mesh=cf.ShellMesh(order=6, rows=2, around=2),
)
figure = figure_shapes(cf.modes(casing, count=6), [0, 2, 4])

# %%
# The lowest modes of the casing. Both bodies are reduced and run:

with tempfile.TemporaryDirectory() as folder:  # only files of arrays cross from one package to the other
    rim = cf.reduce(casing, cf.Rim("top", n_max=16), modes=30, zeta=0.005).save(Path(folder, "casing.npz"))
    tip = cf.reduce(blade, cf.Tip(), modes=4, zeta=0.005).save(Path(folder, "blade.npz"))
    bodies = ct.ModalBody.load(rim), ct.ModalBody.load(tip)
rub = ct.RotatingRim(
    *bodies,
    clearance=2e-4,  # m
    speed_hz=10.0,
    out_of_roundness=[{"p": 2, "cos": 2.5e-4}],
)
result = ct.run(rub, law=ct.Unilateral(), t_end=0.2, dt=1e-5, record=ct.Record(every=5, state_every=20))
print(result)
figure = figure_contact(result)

assert len(result.merged_intervals()[0]) == 4
assert abs(result.energy.unaccounted) < 1e-6 * result.energy.scale
