"""
What a reduced basis keeps
==========================

A few modes have only a part of the compliance of a tip. The residual compliance S adds the rest: the static compliance
of the basis is that of the blade for any number of modes.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes

strip = cf.Plate(length=0.11, width=0.04)
blade = cf.Shell(
    chart=strip,
    thickness=5e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"root": cf.Clamped()},
    mesh=cf.ShellMesh(order=6, rows=2, around=2),
)
figure = figure_shapes(cf.modes(blade, count=3), [0, 1, 2])

# %%
# The first modes of the blade. The next picture has their share of the tip's compliance:

counts = [1, 2, 4, 8]
carried, whole = [], []
for count in counts:
    basis = cf.reduce(blade, cf.Tip(), modes=count)
    flap = basis.channels.index("flap")
    whole.append(basis.compliance[flap, flap])
    carried.append(1.0 - basis.S[flap, flap] / whole[-1])

figure, axes = plt.subplots(layout="constrained")
axes.plot(counts, [100.0 * part for part in carried], "o-", label="by the modes")
axes.axhline(100.0, color="0.6", label="with S")
axes.set(xlabel="modes", ylabel="compliance across the tip [%]")
axes.legend()

assert np.ptp(whole) < 1e-9 * whole[0]
assert 0.9 < carried[0] < carried[-1] < 1.0
