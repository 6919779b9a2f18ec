"""
The energy budget of a run
==========================

Every run has an energy budget: the energy at the start and at the end, and the work of contact, friction, damping and
rotation. The remainder shows the accuracy of the run.
"""

import matplotlib.pyplot as plt

import contact as ct

mass = ct.PointMass(mass=0.1, x=0.01, velocity=-1.0, stiffness=500.0, anchor=0.01, damping=0.5)
result = ct.run([ct.Wall(), mass], law=ct.Unilateral(), scheme=ct.MoreauJean(restitution=0.6), t_end=0.2, dt=1e-5)
energy = result.energy
print(energy)

parts = {"start": energy.start.total, "contact": energy.contact, "damping": energy.damping, "end": energy.end.total}
figure, axes = plt.subplots(layout="constrained")
axes.bar(list(parts), [1e3 * part for part in parts.values()])
axes.axhline(0.0, color="0.4", linewidth=1)
axes.set_ylabel("energy [mJ]")

assert abs(energy.unaccounted) < 1e-3 * energy.start.total
assert energy.contact < 0.0
