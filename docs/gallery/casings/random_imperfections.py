"""
Random imperfections
====================

Imperfections that were not measured can be drawn at random. The spectrum has the usual size of each harmonic, by median
and 90th percentile. The splits of many casings are then a distribution.
"""

import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.modes import figure_splits

usual = cf.field.Spectrum(p=np.arange(2, 9), median=np.full(7, 2e-4), high=np.full(7, 5e-4))
casing = cf.Shell(
    chart=cf.Cylinder(radius=0.10, height=0.25),
    thickness=1.5e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.Clamped()},
    radius_defect=cf.field.RandomField(spectrum=usual, seed=20261),
    mesh=cf.ShellMesh(order=6, rows=1, around=9),
)
figure = figure_shapes(cf.modes(casing, count=4), [0, 1, 2])

# %%
# The modes of one drawn casing. The splits of ten of them:

batch = cf.modal.mistune(casing, draws=10, count=4)
figure = figure_splits(batch)

# %%
# Draw 2 is the same casing in every batch with this seed.

again = cf.modal.mistune(casing, draws=3, count=4)
assert np.allclose(batch.split[batch.draw == 2], again.split[again.draw == 2], rtol=1e-9)
assert 1e-4 < np.median(batch.split[batch.n == 3]) < 1e-2
