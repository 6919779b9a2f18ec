"""
A casing on a ring, held by bolts
=================================

A ring is a curved beam tied to an edge. Bolts fix it at some places. If all bolts are equal, only pairs split whose 2n
is a multiple of their number. A missing bolt splits the other pairs too.
"""

import matplotlib.pyplot as plt

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes


def splits(loose):
    """Modes with some bolts loosened to a factor of their stiffness, and splits of the pairs by nodal diameters."""
    bolts = cf.Bolts(count=12, k=5e7, k_rot=5e4, loose=loose)  # N/m and N m/rad of each
    ring = cf.Ring(section=cf.edge.Section.rectangle(width=0.02, depth=0.02), support=bolts)
    casing = cf.Shell(
        chart=cf.Cylinder(radius=0.20, height=0.20),
        thickness=2e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": ring},
        mesh=cf.ShellMesh(order=6, rows=1, around=12),
    )
    modes = cf.modes(casing, count=8)
    return modes, {int(modes.nodal_diameters[low]): split for (low, _), split in zip(modes.doublets, modes.splits)}


(modes, whole), (_, broken) = splits({}), splits({3: 0.0})
figure = figure_shapes(modes, [0, 2, 4])

# %%
# Modes of the casing on twelve equal bolts. The splits of its pairs, with all bolts and without one:

figure, axes = plt.subplots(layout="constrained")
for shift, (name, found) in enumerate({"all twelve": whole, "bolt 3 missing": broken}.items()):
    axes.bar([n + 0.35 * (shift - 0.5) for n in found], [100.0 * split for split in found.values()], 0.35, label=name)
axes.set(xlabel="nodal diameters n", ylabel="split [%]", xticks=sorted(broken))
axes.legend()

# %%
# Twelve equal bolts split the pair of six nodal diameters and no other.

assert whole[6] > 0.01
assert max(split for n, split in whole.items() if n != 6) < 1e-6
assert broken[3] > 0.05
