"""
A surveyed radius becomes a field
=================================

A table of points (angle, height, radius) is fitted by a Fourier series around and a polynomial along the axis. The
field says up to which harmonic the points resolve it. The survey is SYNTHETIC.
"""

import matplotlib.pyplot as plt

import casingfem as cf
from casingfem.examples import DATA

survey = cf.SurveyField.from_csv(DATA / "surveys" / "rig_casing.csv", n_max=26, degree=2)
print(survey)

radius = float(survey.mean_radius(0.125))  # of the mean cone, half way up
orders = range(2, 27)
amplitude = [1e6 * survey.fit.amplitude(p) * radius for p in orders]

figure, axes = plt.subplots(layout="constrained")
axes.bar(orders, amplitude)
axes.set(xlabel="harmonic around", ylabel="amplitude [µm]", yscale="log")

# %%
# What the series does not carry is the noise of the points, 8 µm.

assert survey.n_resolved >= 26
assert abs(survey.residual_rms_m - 8e-6) < 2e-6
