"""
A defect fixes where the antinodes are
======================================

The modes of a perfect casing may be at any angle. A defect fixes this angle: if the defect is turned, the modes turn
with it.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes

defect = cf.FourierField.of({6: 1e-3})
turns = np.radians([0.0, 10.0, 20.0])
angles, freq = [], []
for turn in turns:
    casing = cf.Shell(
        chart=cf.Cylinder(radius=0.10, height=0.25),
        thickness=1.5e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": cf.Clamped()},
        radius_defect=defect.rotated(turn),
        mesh=cf.ShellMesh(order=6, rows=1, around=9),
    )
    modes = cf.modes(casing, count=4)
    mode = int(np.flatnonzero(modes.nodal_diameters == 3)[0])
    angles.append(modes.angle_deg[mode])
    freq.append(modes.freq[mode])

figure = figure_shapes(modes, [mode, mode + 1])

# %%
# The pair of three nodal diameters, for the defect turned by 20 degrees. The antinode follows the defect:

figure, axes = plt.subplots(layout="constrained")
axes.plot(np.degrees(turns), angles, "o-")
axes.set(xlabel="the defect is turned by [deg]", ylabel="antinode of the lower mode of n = 3 [deg]")

# %%
# An antinode of n = 3 repeats every 60 degrees. Frequencies do not change.

turned = (np.array(angles) - angles[0]) % 60.0
assert np.allclose(turned, np.degrees(turns), atol=1e-3)
assert np.ptp(freq) < 1e-4 * freq[0]  # as far as the mesh sees alike at all angles
