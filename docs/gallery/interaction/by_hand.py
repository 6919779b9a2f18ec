"""
The hand calculation
====================

One pair of a turning casing against one mode of a fixed blade, held closed by a contact stiffness. If n f is the sum of
the two frequencies, the contact transfers energy to both: the motion grows even without friction.
"""

import numpy as np

import contact as ct
from casingfem.plot.interaction import figure_stability

pair = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4),
    compliance=1e-4,  # m/N
)
found = ct.stability.of_contact(pair.contact(), np.linspace(52.0, 54.0, 201))
print(found.words)
figure = figure_stability(found)

# %%
# Without contact the coincidence is at 420/8 = 52.5 Hz (3150 rpm). The stiffness of the contact shifts it. First-order
# theory gives, in rad/s of n times the speed, with c of the casing and b of the blade: a shift of (c + b)/S and half a
# width of the band of 2 sqrt(bc)/S. The largest growth is sqrt(bc)/S.

S, c, b = 1e-4, 1.0 / (4.0 * 1.5 * 2.0 * np.pi * 300.0), 1.0 / (0.4 * 2.0 * 2.0 * np.pi * 120.0)
(band,) = found.bands_hz
assert abs(found.peak_speed_hz - 52.5 - (b + c) / S / (2.0 * np.pi * 8)) < 0.01
assert abs(0.5 * (band[1] - band[0]) - 2.0 * np.sqrt(b * c) / S / (2.0 * np.pi * 8)) < 0.01
assert abs(found.peak_growth / (np.sqrt(b * c) / S) - 1.0) < 0.02
