"""
The zigzag of a bladed disk
===========================

A disk of N blades has nodal diameters up to N/2, and shows higher ones as aliases. Drawn folded, a line for each speed
crosses what it may meet.
"""

import casingfem as cf
from casingfem.plot.interaction import figure_zzenf

casing = {3: [410.0], 4: [380.0], 5: [400.0], 6: [455.0], 7: [530.0]}  # Hz by nodal diameters, from a test say
disk = cf.modal.DiskFrequencies(blades=24, freq={k: [300.0 + 4.0 * k] for k in range(13)})
found = cf.interactions(casing, disk, speed_hz=(10.0, 250.0))
print(found)
figure = figure_zzenf(found, disk, speed_hz=174.0)

# %%
# The pair of four nodal diameters meets the disk's own four, 316 Hz, at (380 + 316)/4 = 174 turns a second.

assert any(abs(meeting.speed_hz - 174.0) < 1e-9 for meeting in found.meetings)
