"""
Outliers of a survey
====================

A few wrong points change every harmonic. A plain fit uses them and warns; a robust fit leaves out points that
contradict all others, and lists them.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf

rng = np.random.default_rng(20261)
theta = np.tile(np.arange(0.0, 360.0, 5.0), 3)
z = np.repeat([0.02, 0.12, 0.22], 72)
radius = 0.5 + 2e-4 * np.cos(2.0 * np.radians(theta)) + rng.normal(0.0, 8e-6, theta.size)
radius[[30, 100]] += 3e-3  # dust under the probe


figure, axes = plt.subplots(subplot_kw={"projection": "3d"}, layout="constrained")
place = np.radians(theta)
far = 0.5 + 30.0 * (radius - 0.5)
points = axes.scatter(far * np.cos(place), far * np.sin(place), z, c=1e3 * (radius - 0.5), cmap="coolwarm", s=12)
figure.colorbar(points, label="radius - 500 mm [mm]", shrink=0.6)
axes.set_box_aspect((3, 3, 1))
axes.set_axis_off()

# %%
# The measured points with 30 times their deviation. Two points are outliers.

with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    plain = cf.SurveyField.from_points(np.radians(theta), z, radius, n_max=8)
    robust = cf.SurveyField.from_points(np.radians(theta), z, radius, n_max=8, robust=True)
for warning in caught:
    print(warning.message)
print("set aside:", robust.set_aside)

figure, axes = plt.subplots(layout="constrained")
for shift, (name, survey) in enumerate({"plain": plain, "robust": robust}.items()):
    microns = [1e6 * survey.fit.amplitude(p) * survey.mean_radius(0.12) for p in range(2, 9)]
    axes.bar(np.arange(2, 9) + 0.4 * (shift - 0.5), microns, 0.4, label=name)
axes.set(xlabel="harmonic around", ylabel="amplitude [µm]")
axes.legend()

assert len(robust.set_aside) == 2
assert abs(robust.fit.amplitude(2) * robust.mean_radius(0.12) - 2e-4) < 3e-6
