"""
The zigzag of a bladed disk
===========================

A disk of N blades has nodal diameters up to N/2, and shows higher ones as aliases. In the folded diagram the line of a
speed crosses the modes with which it may coincide.
"""

import casingfem as cf
from casingfem.plot.interaction import figure_zzenf

casing = {3: [410.0], 4: [380.0], 5: [400.0], 6: [455.0], 7: [530.0]}  # Hz by nodal diameters, from a test say
disk = cf.modal.DiskFrequencies(blades=24, freq={k: [300.0 + 4.0 * k] for k in range(13)})
found = cf.interactions(casing, disk, speed_hz=(10.0, 250.0))
print(found)
figure = figure_zzenf(found, disk, speed_hz=174.0)

# %%
# The casing's pair of four nodal diameters, 380 Hz, coincides with that of the disk, 316 Hz, at (380 + 316)/4 = 174
# turns a second (10,440 rpm).

assert any(abs(meeting.speed_hz - 174.0) < 1e-9 for meeting in found.meetings)
