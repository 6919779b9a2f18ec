r"""
An oscillator on a rough floor
==============================

Sliding friction reduces every swing by the same amount: amplitudes fall by :math:`4\mu N/k` a period. The mass stops
when the spring force is below the friction force.
"""

import matplotlib.pyplot as plt
import numpy as np

import contact as ct

mass, k, mu, weight = 1.0, 400.0, 0.2, 9.81
body = ct.ModalBody(
    omega=[0.0, np.sqrt(k / mass)], zeta=[0.0, 0.0], channels=("up", "along"), rows=np.eye(2), S=np.zeros((2, 2))
)
floor = ct.Patch(body=body, normal=("up",), tangent=(("along",),), displacement=[0.0, 0.05], load=[-mass * weight, 0.0])
record = ct.Record(every=20, state_every=20)
result = ct.run(floor, law=ct.Coulomb(mu=mu), scheme=ct.ExactModal(), t_end=1.2, dt=1e-4, record=record)
along = result.state[:, 1]

figure, axes = plt.subplots(layout="constrained")
axes.plot(result.state_time, 1e3 * along)
axes.set(xlabel="time [s]", ylabel="displacement [mm]")

# %%
# One period after the start the amplitude is smaller by four times the dead band.

period = 2.0 * np.pi * np.sqrt(mass / k)
after = along[np.argmin(np.abs(result.state_time - period))]
assert abs(0.05 - after - 4.0 * mu * weight * mass / k) < 2e-4
