"""
A blade under a force
=====================

Static solutions use the same matrices as modes. A cantilever under a force at its tip bends as beam theory says.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf

length, width, thickness, force = 0.30, 0.02, 2e-3, 1.0
steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
strip = cf.Shell(
    chart=cf.Plate(length=length, width=width), thickness=thickness, material=steel, supports={"root": cf.Clamped()}
)
bent = cf.solve_static(strip, [cf.loads.EdgeLoad(edge="tip", force=(0.0, 0.0, force / width))])

x, y = np.meshgrid(np.linspace(0.0, length, 31), np.linspace(-0.5 * width, 0.5 * width, 5), indexing="ij")
lift = np.array([[bent.at(a, b)[2] for b in row] for a, row in zip(x[:, 0], y)])
figure, axes = plt.subplots(subplot_kw={"projection": "3d"}, layout="constrained")
axes.plot_surface(x, y, lift, cmap="viridis", rcount=31, ccount=5)
axes.set_box_aspect((4, 1, 1.5))
axes.set(xticks=[0.0, 0.1, 0.2, 0.3], yticks=[-0.01, 0.01], zticks=[0.0, 0.001, 0.002, 0.003])

# %%
# The deflected strip; all lengths are in metres. The next picture compares its middle line with beam theory:

x = np.linspace(0.0, length, 31)
flap = np.array([bent.at(a, 0.0)[2] for a in x])
beam = force * x**2 * (3.0 * length - x) / (6.0 * steel.E * width * thickness**3 / 12.0)

figure, axes = plt.subplots(layout="constrained")
axes.plot(x, 1e3 * flap, label="shell")
axes.plot(x, 1e3 * beam, "--", label="beam")
axes.set(xlabel="from the root [m]", ylabel="deflection [mm]")
axes.legend()

assert abs(flap[-1] / beam[-1] - 1.0) < 0.02
