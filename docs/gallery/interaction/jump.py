"""
A jump of a mass between stops
==============================

A driven mass between soft stops has two motions at one frequency. The continuation of the periodic motions shows that
the large one ends in a fold; a run in time would only jump there.
"""

import matplotlib.pyplot as plt
import numpy as np

import contact as ct

mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=3.0, shown=("x",))
family = driven.over("freq_hz", freq_hz=0.15)
found = ct.cycles.follow(family, (0.15, 0.26), longest=0.05)
(branch, *_) = found.branches

figure, axes = plt.subplots(layout="constrained")
amplitude = np.array([point.amplitude["x"] for point in branch.points])
kept = np.array(branch.stable)
value = np.array(branch.value)
axes.plot(value, amplitude, color="0.7")
axes.plot(value[kept], amplitude[kept], ".", label="kept")
axes.plot(value[~kept], amplitude[~kept], "x", label="left")
for special in branch.of("fold"):
    axes.axvline(special.orbit.value, color="0.6", linestyle=":")
axes.set(xlabel="frequency of the force [Hz]", ylabel="amplitude [m]")
axes.legend()

assert len(branch.of("fold")) == 2
