"""
A blade from a mesh
===================

A part from a mesher is used like a shell on a chart. This example writes the mesh of a strip in the format of Abaqus,
and reads it with its sets. `scale` converts millimetres to metres.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.plot.body.shapes import figure_shapes

x, y = np.meshgrid(np.linspace(0.0, 110.0, 23), np.linspace(-20.0, 20.0, 9), indexing="ij")
number = np.arange(x.size).reshape(x.shape) + 1
corners = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
lines = ["*NODE", *(f"{k}, {a}, {b}, 0.0" for k, a, b in zip(number.ravel(), x.ravel(), y.ravel()))]
lines += ["*ELEMENT, TYPE=S4, ELSET=STRIP"]
lines += [f"{k + 1}, " + ", ".join(map(str, nodes)) for k, nodes in enumerate(corners)]
lines += ["*NSET, NSET=ROOT", ", ".join(map(str, number[0])), ""]

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder, "strip.inp")
    path.write_text("\n".join(lines))
    mesh = cf.read_mesh(path, scale=1e-3)
steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
imported = cf.MeshShell(mesh=mesh, thickness=5e-3, material=steel, supports={"ROOT": cf.Clamped()})
chart = cf.Shell(
    chart=cf.Plate(length=0.11, width=0.04), thickness=5e-3, material=steel, supports={"root": cf.Clamped()}
)
modes = cf.modes(imported, 5)
figure = figure_shapes(modes, [0, 1, 2])

# %%
# Modes of the imported mesh. The frequencies of both models:

freq = {"imported": modes.freq, "on a chart": cf.modes(chart, 5).freq}

figure, axes = plt.subplots(layout="constrained")
for shift, (name, values) in enumerate(freq.items()):
    axes.bar(np.arange(1, 6) + 0.4 * (shift - 0.5), values, 0.4, label=name)
axes.set(xlabel="mode", ylabel="frequency [Hz]")
axes.legend()

# %%
# Four-node cells of this size are slightly too stiff: the error of the first bending mode is below one per cent.

assert abs(freq["imported"][0] / freq["on a chart"][0] - 1.0) < 0.01
