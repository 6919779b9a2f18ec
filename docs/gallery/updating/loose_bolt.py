"""
Which bolt is loose?
====================

A loose bolt shifts and splits pairs. The search finds the fewest changes that explain a table, and lists bolts that the
table cannot distinguish. The table is SYNTHETIC.
"""

import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.correlation import figure_located


def casing(loose):
    """A cylinder on twelve bolts."""
    bolts = cf.Bolts(count=12, k=5e7, k_rot=5e4, loose=loose)
    return cf.Shell(
        chart=cf.Cylinder(radius=0.20, height=0.20),
        thickness=2e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": cf.Ring(section=cf.edge.Section.rectangle(width=0.02, depth=0.02), support=bolts)},
        radius_defect=cf.FourierField.of({6: 5e-4, 8: 5e-4, 10: 5e-4}),
        mesh=cf.ShellMesh(order=6, rows=1, around=12),
    )


truth = cf.modes(casing({4: 0.3}), count=8)
figure = figure_shapes(truth, [0, 1])

# %%
# The lowest pair of the casing with a loose bolt. Its table, and the search:

noise = 1e-4 * np.random.default_rng(20261).normal(size=8)
table = cf.FrequencyTable.from_arrays(
    freq_hz=truth.freq * (1.0 + noise),
    sigma_hz=1e-4 * truth.freq,
    n=truth.nodal_diameters,
    angle_deg=truth.angle_deg,
    synthetic=True,
)
found = cf.locate(casing({}), table)
print(found)
figure = figure_located(found)

# %%
# The result is bolt 4, or the opposite one: after half a turn a casing has the same frequencies and orientations.

assert found.found[0].place in (4, 10)
assert abs(found.found[0].value - 0.3) < 0.1
