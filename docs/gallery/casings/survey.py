"""
A surveyed radius becomes a field
=================================

A table of points (angle, height, radius) is fitted by a Fourier series around and a polynomial along the axis. The
field has the highest harmonic that the points resolve. The survey is SYNTHETIC.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
from casingfem.examples import DATA

survey = cf.SurveyField.from_csv(DATA / "surveys" / "rig_casing.csv", n_max=26, degree=2)
print(survey)

theta, z = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 361), np.linspace(0.0, 0.25, 9))
deviation = survey.derivatives(z, theta).value * survey.mean_radius(z)
r = survey.mean_radius(z) + 60.0 * deviation
figure, axes = plt.subplots(subplot_kw={"projection": "3d"}, layout="constrained")
colours = plt.cm.RdBu_r(0.5 + 0.5 * deviation / np.abs(deviation).max())
axes.plot_surface(r * np.cos(theta), r * np.sin(theta), z, facecolors=colours, rcount=9, ccount=120)
axes.set_box_aspect((4, 4, 1.2))
axes.set_axis_off()

# %%
# The fitted casing, its deviation drawn 60 times. The same by harmonics:

radius = float(survey.mean_radius(0.125))  # of the mean cone, half way up
orders = range(2, 27)
amplitude = [1e6 * survey.fit.amplitude(p) * radius for p in orders]

figure, axes = plt.subplots(layout="constrained")
axes.bar(orders, amplitude)
axes.set(xlabel="harmonic around", ylabel="amplitude [µm]", yscale="log")

# %%
# The residual of the fit is the noise of the points, 8 µm.

assert survey.n_resolved >= 26
assert abs(survey.residual_rms_m - 8e-6) < 2e-6
