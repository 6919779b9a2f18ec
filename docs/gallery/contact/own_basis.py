"""
A body from arrays
==================

A modal body consists of frequencies, damping, the motion of its channels in each mode, and the compliance of the
omitted modes. Any program can make one. Here a mass on a spring bounces on the floor under its own weight.
"""

import matplotlib.pyplot as plt
import numpy as np

import contact as ct

ball = ct.ModalBody(omega=[0.0], zeta=[0.0], channels=("up",), rows=[[1.0]], S=[[1e-7]])  # 1 kg, 1e7 N/m
floor = ct.PointGap(sides=(ct.gaps.Side(body=ball, channel="up", sign=1, load=[-9.81]),), clearance=0.05)
result = ct.run(floor, law=ct.Unilateral(), scheme=ct.ExactModal(law="energy"), t_end=1.0, dt=1e-4)

figure, axes = plt.subplots(layout="constrained")
axes.plot(result.time, 1e3 * result.gap[:, 0])
axes.set(xlabel="time [s]", ylabel="gap [mm]")

# %%
# The mass returns to its height after twice the time of its fall, every time: the law conserves energy.

falls = np.array([start for start, _ in result.merged_intervals()[0]])
assert np.allclose(np.diff(falls), 2.0 * np.sqrt(2.0 * 0.05 / 9.81), rtol=0.01)
