"""
Frequencies over speed
======================

Centrifugal tension stiffens a blade. Where a frequency crosses a multiple of the speed, an engine order excites it.
"""

import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.interaction import figure_speeds

strip = cf.Plate(length=0.11, width=0.04)
blade = cf.Shell(
    chart=strip,
    thickness=2e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"root": cf.Clamped()},
    mesh=cf.ShellMesh(order=6, rows=2, around=2),
    rotation=cf.Rotation.of_blade(strip, omega=0.0, hub_radius=0.3, stagger=np.radians(30.0)),
)
figure = figure_shapes(cf.modes(blade, count=3), [0, 1, 2])

# %%
# The first three modes at rest: two of bending, one of torsion. Their frequencies over the speed:

found = cf.campbell(blade, 2.0 * np.pi * np.array([0.0, 25.0, 50.0, 75.0, 100.0]), count=3)
figure = figure_speeds(found)

# %%
# Squared frequencies grow with the square of the speed (Southwell).

lowest = found.freq[:, 0]
growth = (lowest**2 - lowest[0] ** 2) / np.maximum(found.speed_hz, 1.0) ** 2
assert lowest[-1] > 1.8 * lowest[0]
assert np.ptp(growth[1:]) < 0.02 * growth[-1]
