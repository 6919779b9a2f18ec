"""
How far does mistuning amplify an engine order?
===============================================

Each blade of a wheel meets the wakes before it one after the other: an engine order is a travelling wave of forces.
Blades that differ by a few per cent have different amplitudes. One of them moves more than any blade of the tuned
wheel.
"""

import numpy as np

import casingfem as cf
from casingfem.plot.engine_orders import figure_response

wheel = cf.modal.BladedWheel.chain(blades=24, freq_hz=400.0, mass=0.05, coupling=0.01)
air = cf.modal.Influence(offset=[-1, 0, 1], stiffness=[-20.0, 0.0, 20.0], damping=[0.0, 0.15, 0.0])
blades = 0.01 * np.random.default_rng(17).standard_normal(24)
found = cf.modal.engine_order_response(
    wheel, 5, np.linspace(76.0, 84.0, 801), force=2.0, zeta=5e-4, deviations=blades, influence=air
)
drawn = cf.modal.amplification(wheel, 5, sigma=0.01, draws=300, seed=17, zeta=5e-4, influence=air)
print(found.words, drawn.words, sep="\n")
figure = figure_response(found, drawn)

# %%
# No draw exceeds Whitehead's bound (1 + sqrt(N))/2.

assert 1.0 < found.amplification < found.bound
assert drawn.amplification.max() < drawn.bound == 0.5 * (1.0 + np.sqrt(24.0))
