r"""
Two rods that collide
=====================

Equal rods meet at v and part after two passages of the wave, 2L/c. In between the force is constant,
:math:`F = \tfrac12 v \sqrt{E\rho}A`, and the rods exchange their velocities.
"""

import matplotlib.pyplot as plt

import contact as ct

steel = {"length": 0.5, "area": 1e-4, "E": 210e9, "rho": 7800.0, "elements": 100}
rods = [ct.Rod(**steel, x=-0.5005, velocity=2.0), ct.Rod(**steel, x=0.0)]
result = ct.run(rods, law=ct.Unilateral(), scheme=ct.CentralDifference(), t_end=6e-4, courant=0.9)
print(result)

exact = 0.5 * 2.0 * rods[0].impedance
figure, axes = plt.subplots(layout="constrained")
axes.plot(1e3 * result.time, 1e-3 * result.windowed_force()[:, 0], label="computed, over a window")
axes.axhline(1e-3 * exact, color="0.6", label="exact while in contact")
axes.set(xlabel="time [ms]", ylabel="force [kN]")
axes.legend()

# %%
# The impulse is that of an exchange of velocities, m v.

assert abs(result.impulse[0] / (2.0 * rods[0].mass) - 1.0) < 0.01
