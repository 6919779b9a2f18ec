r"""
A perfect casing has its modes in pairs
=======================================

On a body of revolution the modes of :math:`n \geq 1` nodal diameters come twice, as :math:`\cos n\theta` and
:math:`\sin n\theta`, at one frequency. The lowest pair of a thin casing is not that of the smallest n.
"""

import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.modes import figure_frequencies

casing = cf.Shell(
    chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),  # m
    thickness=3e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.Clamped()},
)
modes = cf.modes(casing, count=24)
figure = figure_shapes(modes, [0, 1, 2])

# %%
# The first two shapes are one pair: the same waves, turned by a quarter of a wave.

print(modes)
figure = figure_frequencies(modes)

# %%
# Both members of each pair have the same frequency, and the lowest pair has eight nodal diameters.

low, high = np.array(modes.doublets).T
assert np.allclose(modes.freq[low], modes.freq[high], rtol=1e-9)
assert modes.nodal_diameters[0] == 8
