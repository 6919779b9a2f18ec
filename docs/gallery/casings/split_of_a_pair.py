r"""
A harmonic 2n splits the pair of n nodal diameters
==================================================

A radius :math:`R(1 + \epsilon\cos 2n\theta)` acts on the pair of n in first order: the split grows with
:math:`\epsilon`. A harmonic that is not 2n acts in second order only. Here n = 3.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes


def split(p, epsilon):
    """Relative split of the pair of three nodal diameters under epsilon cos(p theta)."""
    casing = cf.Shell(
        chart=cf.Cylinder(radius=0.10, height=0.25),
        thickness=1.5e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": cf.Clamped()},
        radius_defect=cf.FourierField.of({p: epsilon}),
        mesh=cf.ShellMesh(order=6, rows=1, around=9),
    )
    modes = cf.modes(casing, count=4)
    pair = next(k for k, (low, _) in enumerate(modes.doublets) if modes.nodal_diameters[low] == 3)
    return modes, modes.splits[pair]


sizes = np.array([2.5e-4, 5e-4, 1e-3])
modes = split(6, sizes[-1])[0]
low, high = next(pair for pair in modes.doublets if modes.nodal_diameters[pair[0]] == 3)
figure = figure_shapes(modes, [low, high])

# %%
# The two members of the pair: antinodes of one are nodes of the other. Their split over the size of the harmonic:

first = np.array([split(6, size)[1] for size in sizes])
second = np.array([split(3, size)[1] for size in sizes])

figure, axes = plt.subplots(layout="constrained")
axes.loglog(100 * sizes, 100 * first, "o-", label="cos 6θ: 2n")
axes.loglog(100 * sizes, 100 * second, "s-", label="cos 3θ: n")
axes.set(xlabel="size of the harmonic [% of the radius]", ylabel="split of n = 3 [%]")
axes.legend()

# %%
# Twice the harmonic, twice the split; or four times, in second order.

assert np.allclose(first[1:] / first[:-1], 2.0, rtol=0.02)
assert np.allclose(second[1:] / second[:-1], 4.0, rtol=0.05)
