"""
A flange is a strip of another thickness
========================================

Strips change the wall along the axis. A perfect casing with strips is still perfect, and is solved fast: one small
problem for each number of nodal diameters.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes

parts = {
    "chart": cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
    "thickness": 3e-3,
    "material": cf.Material(E=210e9, nu=0.3, rho=7800.0),
    "supports": {"base": cf.Clamped()},
}
walls = {
    "plain": cf.Shell(**parts),
    "12 mm flange at the rim": cf.Shell(**parts, strips=(cf.Strip(start=0.24, end=0.25, thickness=12e-3),)),
}

found = {name: cf.modes(casing, count=24) for name, casing in walls.items()}
figure = figure_shapes(found["12 mm flange at the rim"], [0, 2, 4])

# %%
# Modes of the casing with the flange. The lowest frequency of each number of nodal diameters, without and with it:

figure, axes = plt.subplots(layout="constrained")
lowest = {}
for name, modes in found.items():
    lowest[name] = modes.freq[0]
    first = modes.meridional == 1
    order = np.argsort(modes.nodal_diameters[first], kind="stable")
    axes.plot(modes.nodal_diameters[first][order], modes.freq[first][order], "o-", label=name)
axes.set(xlabel="nodal diameters n", ylabel="frequency [Hz]")
axes.legend()
print({name: f"{freq:.1f} Hz" for name, freq in lowest.items()})
assert lowest["12 mm flange at the rim"] > 1.2 * lowest["plain"]
