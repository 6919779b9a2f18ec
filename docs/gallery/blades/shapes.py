"""
The modes of a blade
====================

Chord, camber and twist of a blade vary from root to tip, and its wall tapers.
"""

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes

blade = cf.Shell(
    chart=cf.Blade(length=0.2, chord=(0.12, 0.10, 0.09), camber=(0.6, 0.2), twist=(0.1, 0.6)),  # m, rad
    thickness=4e-3,
    material=cf.Material(E=114e9, nu=0.33, rho=4430.0),
    supports={"root": cf.Clamped()},
    taper=cf.Taper(along=(1.0, 0.6), across=(0.6, 1.0, 0.6)),
)
modes = cf.modes(blade, count=4)
print(modes)
figure = figure_shapes(modes, [0, 1, 2])

assert abs(modes.freq[0] - 128.4) < 0.1
