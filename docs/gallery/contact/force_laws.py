r"""
A mass on a Hertz contact, a bumper and your own law
====================================================

A ball that touches a flat surface meets the force :math:`F = k\,d^{3/2}` at the depth :math:`d` (Hertz 1881; Johnson,
Contact Mechanics, 1985, section 4.2). A mass of 2 kg arrives with 1.5 m/s.
"""

import math

import matplotlib.pyplot as plt

import contact as ct

mass, speed = 2.0, 1.5
body = ct.ModalBody(omega=[0.0], zeta=[0.0], channels=("x",), rows=[[1.0 / math.sqrt(mass)]], S=[[0.0]])
side = ct.gaps.Side(body=body, channel="x", sign=1, velocity=[-speed * math.sqrt(mass)])
gap = ct.PointGap(sides=(side,), clearance=1e-5)
record = ct.Record(every=1, state_every=1)

# %%
# The energy of the mass gives the greatest depth and force in closed form; the time of contact is
# :math:`2.9432\,d_{max}/v`.

hertz = ct.laws.Hertz(k=1e9)
depth = (5.0 / 4.0 * mass * speed**2 / hertz.k) ** 0.4
force = hertz.k * depth**1.5
time = 2.9432 * depth / speed

# %%
# A bumper is known as a table of depths and forces. The third law is a user's function: Hertz's force with a loss that
# grows with the rate (Hunt and Crossley 1975).


def lossy(depth, rate, values):
    """Force and slope of k depth^1.5 (1 + a rate)."""
    k, a = values
    return k * depth**1.5 * (1.0 + a * rate), 1.5 * k * depth**0.5 * (1.0 + a * rate)


laws = {
    "Hertz": hertz,
    "bumper, a table": ct.laws.ForceTable(depth=[0.0, 2e-4, 4e-4, 6e-4], force=[0.0, 2e3, 1e4, 4e4]),
    "own law with loss": ct.laws.ForceLaw(ct.laws.Response(lossy, (1e9, 0.2))),
}
results = {
    name: ct.run(gap, law=law, scheme=ct.ExactModal(), dt=time / 2000.0, t_end=2.0 * time, record=record)
    for name, law in laws.items()
}

figure, (over_time, over_depth) = plt.subplots(1, 2, figsize=(9.0, 3.8), layout="constrained")
for name, result in results.items():
    over_time.plot(1e3 * result.time, 1e-3 * result.force[:, 0], label=name)
    over_depth.plot(-1e3 * result.gap[:, 0], 1e-3 * result.force[:, 0], label=name)
over_time.set(xlabel="time [ms]", ylabel="force [kN]")
over_depth.set(xlabel="depth [mm]", ylabel="force [kN]", xlim=(0.0, None))
over_time.legend()

# %%
# Peak and depth agree with the closed form to 1e-4. With the two laws without loss the mass rebounds with its initial
# speed.

assert abs(results["Hertz"].peak_force[0] / force - 1.0) < 1e-4
assert abs(results["Hertz"].max_penetration[0] / depth - 1.0) < 1e-4
for name, result in results.items():
    back = result.impulse[0] / mass - speed
    print(f"{name}: {1e-3 * result.peak_force[0]:.2f} kN, back at {back:.3f} m/s")
assert abs(results["bumper, a table"].impulse[0] / (2.0 * mass * speed) - 1.0) < 1e-3
assert results["own law with loss"].energy.lost_in_contact > 0.1 * 0.5 * mass * speed**2
