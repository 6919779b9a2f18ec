"""
One impact, five schemes
========================

A bar hits a rigid wall. Schemes differ at the step in which the contact closes: in energy, in the first force, and in
the oscillation after it.
"""

import matplotlib.pyplot as plt

import contact as ct

bar = ct.Rod(length=0.5, area=1e-4, E=210e9, rho=7800.0, elements=50, x=0.0005, velocity=-2.0)
schemes = {
    "central difference, Lagrange": ct.CentralDifference(),
    "massless boundary": ct.scheme.MasslessBoundary(),
    "Moreau-Jean": ct.MoreauJean(),
    "exact modal": ct.ExactModal(),
    "CD-Lagrange": ct.scheme.CDLagrange(),
}
exact = 2.0 * bar.mass * 2.0  # N s: the bar leaves as fast as it came
figure, axes = plt.subplots(layout="constrained")
lost = {}
for name, scheme in schemes.items():
    result = ct.run([ct.Wall(), bar], law=ct.Unilateral(), scheme=scheme, t_end=7e-4, dt=5e-7)
    axes.plot(1e3 * result.time, 1e-3 * result.windowed_force()[:, 0], linewidth=1, label=name)
    lost[name] = result.impulse[0] / exact - 1.0
axes.axhline(1e-3 * bar.impedance * 2.0, color="0.6")
axes.set(xlabel="time [ms]", ylabel="force over a window [kN]", ylim=(0.0, 12.0))
axes.legend()
for name, part in lost.items():
    print(f"{name:30} impulse {part:+.2%}")

assert all(abs(part) < 0.03 for part in lost.values())
