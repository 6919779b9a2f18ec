"""
A wrong row is found
====================

One frequency of a table is off by 3 %. No set of parameters explains it together with all other rows: the update leaves
the row out and names it. The table is SYNTHETIC.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes


def casing(E, k_face):
    """A cylinder, elastically embedded."""
    return cf.Shell(
        chart=cf.Cylinder(radius=0.10, height=0.25),
        thickness=1.5e-3,
        material=cf.Material(E=E, nu=0.3, rho=7800.0),
        supports={"base": cf.ElasticEdge(k_face=k_face)},
        mesh=cf.ShellMesh(order=6, rows=1, around=13),
    )


truth = cf.modes(casing(203e9, 3e12), count=16)
figure = figure_shapes(truth, [0, 2, 4])

# %%
# Modes of the casing whose table is made here, with a fault of 3 % in one row:

rows = [low for low, _ in truth.doublets]
freq = truth.freq[rows] * (1.0 + 2e-4 * np.random.default_rng(20261).normal(size=len(rows)))
freq[3] *= 1.03
table = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=2e-4 * freq, n=truth.nodal_diameters[rows], synthetic=True)
vary = [
    cf.Parameter(name="material.E", lower=180e9, upper=230e9),
    cf.Parameter(name="support.base.k_face", lower=1e10, upper=1e14, log=True),
]
fit = cf.update(casing(210e9, 1e13), table, vary)
print(fit)
print(fit.outlier_words())

off = [100.0 * (measured / fit.after.freq[low] - 1.0) for measured, (low, _) in zip(table.freq_hz, fit.after.doublets)]
figure, axes = plt.subplots(layout="constrained")
axes.bar(table.mode, off)
axes.set(xlabel="row of the table", ylabel="table against the updated model [%]")

assert int(np.argmax(np.abs(off))) == 3
assert abs(fit.value[0] - 203e9) < 0.2e9
