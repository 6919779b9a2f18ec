"""
The hand calculation
====================

One pair of a turning casing against one mode of a fixed blade, held closed by a contact stiffness. Where n f is the sum
of the two frequencies the contact feeds both: the motion grows, without any friction.
"""

import numpy as np

import contact as ct
from casingfem.plot.interaction import figure_stability

pair = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4),
    compliance=1e-4,  # m/N
)
found = ct.growth.stability(pair.contact(), np.linspace(52.0, 54.0, 201))
print(found.words)
figure = figure_stability(found)

# %%
# Without contact the sum is met at 420/8 = 52.5 Hz. The contact's own stiffness shifts it.

assert abs(found.peak_speed_hz - 52.844) < 0.01
assert found.peak_growth > 0.0
