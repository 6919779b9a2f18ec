"""
From a free edge to a clamp
===========================

An elastic edge has springs per length, or a foundation per area (`k_face`, N/m³). Frequencies depend on its stiffness
only in a middle range. A test cannot determine a stiffness outside this range.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes

stiffness = np.logspace(8, 16, 9)
freq = []
for k_face in stiffness:
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
        thickness=3e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": cf.ElasticEdge(k_face=k_face)},
    )
    modes = cf.modes(casing, count=1)
    freq.append(modes.freq[0])
figure = figure_shapes(modes, [0])

# %%
# The lowest mode on the stiffest foundation. Its frequency over the stiffness of the foundation:

figure, axes = plt.subplots(layout="constrained")
axes.semilogx(stiffness, freq, "o-")
axes.axhline(367.9, color="0.6", label="clamped")
axes.set(xlabel="foundation of the base [N/m³]", ylabel="lowest frequency [Hz]")
axes.legend()

assert np.all(np.diff(freq) > 0.0)
assert abs(freq[-1] - 367.9) < 0.1
