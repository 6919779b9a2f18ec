"""
A hammer test on the virtual rig
================================

The rig makes the data of a test: the force of a hammer and the signals of two accelerometers, in blocks, from rest. All
data are marked SYNTHETIC.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem import rig
from casingfem.plot.body.shapes import figure_shapes

casing = cf.Shell(
    chart=cf.Cylinder(radius=0.10, height=0.25),
    thickness=1.5e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.Clamped()},
    radius_defect=cf.FourierField.of({6: 1e-3}),
    mesh=cf.ShellMesh(order=6, rows=1, around=9),
)
places = [rig.Place(at=(0.25, 0.3)), rig.Place(at=(0.25, 1.4))]
modes = cf.modes(casing, count=8)
figure = figure_shapes(modes, [0, 2, 4])

# %%
# Modes of the casing that is struck. The force, and the response at the second point:

bench = rig.rig_of(modes, places, zeta=0.01)
hammer = rig.Impact(peak=200.0, width=3e-4)  # N, s
test = rig.record(bench, [hammer], drives=[0], sensors=[0, 1], fs=20480.0, block=4096, blocks=1, seed=20261)

figure, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
time = np.arange(test.force.shape[-1]) / test.fs
above.plot(1e3 * time, test.force.reshape(-1), color="0.3")
above.set_ylabel("force [N]")
below.plot(1e3 * time, test.response[1])
below.set(xlabel="time [ms]", ylabel="acceleration [m/s²]", xlim=(0.0, 60.0))

assert abs(test.force.max() - 200.0) < 20.0
