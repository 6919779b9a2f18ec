"""
Where the energy goes
=====================

Every run keeps a ledger: what was there at the start and at the end, and what contact, friction, damping and rotation
took or gave. What is left over shows how exact the run is.
"""

import matplotlib.pyplot as plt

import contact as ct

mass = ct.PointMass(mass=0.1, x=0.01, velocity=-1.0, stiffness=500.0, anchor=0.01, damping=0.5)
result = ct.run([ct.Wall(), mass], law=ct.Unilateral(), scheme=ct.MoreauJean(restitution=0.6), t_end=0.2, dt=1e-5)
ledger = result.energy
print(ledger)

parts = {"start": ledger.start.total, "contact": ledger.contact, "damping": ledger.damping, "end": ledger.end.total}
figure, axes = plt.subplots(layout="constrained")
axes.bar(list(parts), [1e3 * part for part in parts.values()])
axes.axhline(0.0, color="0.4", linewidth=1)
axes.set_ylabel("energy [mJ]")

assert abs(ledger.unaccounted) < 1e-3 * ledger.start.total
assert ledger.contact < 0.0
