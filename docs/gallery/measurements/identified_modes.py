"""
Modes in frequency responses
============================

Poles are computed for increasing model orders; a pole that recurs is a mode. Each mode has its uncertainty, nodal
diameters and orientation. The responses are SYNTHETIC.
"""

import numpy as np

import casingfem as cf
from casingfem import rig
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.identify import figure_stabilisation

casing = cf.Shell(
    chart=cf.Cylinder(radius=0.10, height=0.25),
    thickness=1.5e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.Clamped()},
    radius_defect=cf.FourierField.of({6: 1e-3}),
    mesh=cf.ShellMesh(order=6, rows=1, around=9),
)
modes = cf.modes(casing, count=8)
figure = figure_shapes(modes, [0, 1])

# %%
# The two modes in the band. They are identified from noisy responses:

bench = rig.rig_of(modes, [rig.Place(at=(0.25, 0.3)), *rig.circle(0.25, 16)], zeta=0.002)
low, high = modes.freq[0] - 60.0, modes.freq[1] + 60.0
frfs = rig.noisy(bench.frfs(np.arange(low, high, 0.5), sensors=range(1, 17), drives=[0]), 40.0, seed=20261)
found = cf.identify(frfs, angles=rig.rig_angles(bench))
print(found)
figure = figure_stabilisation(found)

# %%
# The pair of three nodal diameters is found, with its frequencies to a few parts in a hundred thousand.

assert found.n.tolist() == [3, 3]
assert np.allclose(found.freq, modes.freq[:2], rtol=1e-4)
