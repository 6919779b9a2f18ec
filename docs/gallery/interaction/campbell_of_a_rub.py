"""
At which speeds can casing and blade interact?
==============================================

Every speed at which a pair of the casing meets a frequency of the blade, as waves that run with or against the blade:
f_c + f_b = n f and f_b = f_c - n f.
"""

import casingfem as cf
from casingfem.plot.interaction import figure_campbell

casing = cf.Shell(
    chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
    thickness=3e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.Clamped()},
)
modes = cf.modes(casing, count=16)
found = cf.interactions(modes, [360.0], speed_hz=(1.0, 110.0))
print(found)
figure = figure_campbell(found, [360.0])

# %%
# The lowest pair has n = 8 and 367.9 Hz. The coincidence of its sum with the blade is at (367.9 + 360)/8 = 91.0 turns a
# second (5459 rpm).

assert any(abs(meeting.speed_hz - (modes.freq[0] + 360.0) / 8.0) < 1e-6 for meeting in found.meetings)
