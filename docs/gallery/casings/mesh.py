"""
How fine a mesh
===============

Elements are of high order: two rows along the meridian and some twenty around give forty modes. This is the default;
the picture shows the error of coarser meshes.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes


def lowest(order):
    """Eight modes of a frustum on one row of elements of some order."""
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
        thickness=3e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=order, rows=1, around=21),
    )
    return cf.modes(casing, 8)


orders = range(4, 9)
finest = lowest(11)
figure = figure_shapes(finest, [0, 2, 4])

# %%
# Three of the eight modes on elements of order 11, which are the reference for lower orders:

worst = [np.abs(lowest(order).freq / finest.freq - 1.0).max() for order in orders]

figure, axes = plt.subplots(layout="constrained")
axes.semilogy(orders, 100.0 * np.array(worst), "o-")
axes.set(xlabel="order of the elements, one row", ylabel="worst of eight modes, off by [%]", xticks=orders)

assert worst[0] > 10.0 * worst[3]
assert worst[-1] < 1e-3
