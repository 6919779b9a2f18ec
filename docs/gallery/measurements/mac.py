"""
Measured shapes compared with computed ones
===========================================

The modal assurance criterion compares every measured shape with every computed one. Members of a nearly perfect pair
mix, so that only the pair as a whole can be compared. The shapes are SYNTHETIC: those of a slightly different casing.
"""

from dataclasses import replace

import numpy as np

import casingfem as cf
from casingfem import rig
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.correlation import figure_mac

model = cf.Shell(
    chart=cf.Cylinder(radius=0.10, height=0.25),
    thickness=1.5e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.Clamped()},
    radius_defect=cf.FourierField.of({4: 1e-3, 6: 1e-3, 8: 1e-3}),
    mesh=cf.ShellMesh(order=6, rows=1, around=9),
)
real = replace(model, thickness=1.53e-3, supports={"base": cf.ElasticEdge(k_face=1e13)})
truth = cf.modes(real, count=6)
figure = figure_shapes(truth, [0, 2, 4])

# %%
# The shapes that are measured at 24 points of the rim:

bench = rig.rig_of(truth, rig.circle(0.25, 24), zeta=0.002)
points = np.array([probe.point for probe in bench.probes])
radial = points * [1.0, 1.0, 0.0]
measured = cf.correlation.MeasuredShapes.from_arrays(
    freq_hz=truth.freq, values=bench.rows, points=points, directions=radial
)
found = cf.correlate(cf.modes(model, count=6), measured)
figure = figure_mac(found)

assert np.diag(found.mac).min() > 0.95
