r"""
One casing and one blade
========================

From a survey and a hammer test to the dangerous speeds, in one script. It takes about a minute. A virtual test rig
replaces the laboratory, and all its data are marked SYNTHETIC. If you have measured data, leave out the parts headed
*the laboratory* and read your files.
"""

import tempfile
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
import contact as ct
from casingfem import rig
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.identify import figure_fit
from casingfem.plot.interaction import figure_interactions
from casingfem.plot.modes import figure_frequencies
from casingfem.plot.update import Paired, figure_comparison

folder = tempfile.TemporaryDirectory()
here = Path(folder.name)
rng = np.random.default_rng(20261)

# %%
# The laboratory: a survey
# ------------------------
# A probe moves around the casing at three heights and writes angle, height and radius of each point.

theta = np.tile(np.arange(0.0, 360.0, 7.5), 3)
height = np.repeat([20.0, 120.0, 230.0], 48)
around = np.radians(theta)
radius = 100.0 + 0.10 * np.cos(6.0 * around) + 0.08 * np.cos(2.0 * around - 0.7) + 0.05 * np.sin(8.0 * around)
radius += rng.normal(0.0, 0.004, theta.size)
rows = [f"{t},{z},{r:.4f}" for t, z, r in zip(theta, height, radius)]
card = "# SYNTHETIC: made by the tutorial, not measured"
(here / "survey.csv").write_text("\n".join([card, "theta_deg,z_mm,radius_mm", *rows, ""]))

figure, axes = plt.subplots(subplot_kw={"projection": "3d"}, layout="constrained")
far = 100.0 + 100.0 * (radius - 100.0)
points = axes.scatter(far * np.cos(around), far * np.sin(around), height, c=radius - 100.0, cmap="viridis", s=12)
figure.colorbar(points, label="radius - 100 mm [mm]", shrink=0.6)
axes.set_box_aspect((2, 2, 2.5))
axes.set_axis_off()

# %%
# The measured points, with 100 times their deviation.

# %%
# The survey becomes a field
# --------------------------
# The program needs a file of points with units in its header. The printout has the resolved harmonics and the residual.

survey = cf.SurveyField.from_csv(here / "survey.csv", n_max=12, degree=1)
print(survey)

theta, z = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 181), np.linspace(0.0, 0.25, 9))
deviation = survey.derivatives(z, theta).value * survey.mean_radius(z)
r = survey.mean_radius(z) + 100.0 * deviation
figure, axes = plt.subplots(subplot_kw={"projection": "3d"}, layout="constrained")
colours = plt.cm.RdBu_r(0.5 + 0.5 * deviation / np.abs(deviation).max())
axes.plot_surface(r * np.cos(theta), r * np.sin(theta), z, facecolors=colours, rcount=9, ccount=90)
axes.set_box_aspect((2, 2, 2.5))
axes.set_axis_off()

# %%
# The fitted radius, with 100 times its deviation: red is outside the mean, blue is inside.

assert abs(survey.residual_rms_m - 4e-6) < 1e-6

# %%
# A model from the drawing
# ------------------------
# The chart is the nominal shape, the survey its defect. The stiffness of the base is unknown; 1e13 N/m³ is a guess. The
# mesh is coarse, so that this page is quick. Without `mesh` the default is finer.

casing = cf.Shell(
    chart=cf.Cylinder(radius=0.10, height=0.25),  # m
    thickness=1.5e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.ElasticEdge(k_face=1e13)},
    radius_defect=survey,
    mesh=cf.ShellMesh(order=6, rows=1, around=13),
)
drawn = cf.modes(casing, count=8)
print(drawn)
figure = figure_shapes(drawn, [0, 2, 4])

# %%
# One member of each of the lowest three pairs. The next picture compares the frequencies with those of the perfect
# casing:

figure = figure_frequencies(drawn, cf.modes(replace(casing, radius_defect=None), count=8))

# %%
# The pairs of n = 3 and n = 4 are split by the harmonics 6 and 8 of the radius.
#
# The laboratory: a hammer test
# -----------------------------
# The real casing differs from the drawing: its steel and its base are softer. Sixteen accelerometers are on the rim,
# and a hammer strikes it at one point. The analyser writes a universal file.

real = replace(
    casing, material=cf.Material(E=205e9, nu=0.3, rho=7800.0), supports={"base": cf.ElasticEdge(k_face=3e12)}
)
bench = rig.rig_of(cf.modes(real, count=12), [rig.Place(at=(0.25, 0.35)), *rig.circle(0.25, 16)], zeta=0.003)
lines = np.arange(350.0, 700.0, 0.5)
frfs = rig.noisy(bench.frfs(lines, sensors=range(1, 17), drives=[0]), 40.0, seed=20261)
rig.write_rig_uff(here / "hammer.uff", bench, [frfs])

turn = np.linspace(0.0, 2.0 * np.pi, 181)
struck, *sensors = np.array([probe.point for probe in bench.probes])
figure, axes = plt.subplots(subplot_kw={"projection": "3d"}, layout="constrained")
for level in np.linspace(0.0, 0.25, 6):
    axes.plot(0.1 * np.cos(turn), 0.1 * np.sin(turn), level, color="0.75", linewidth=0.8)
axes.scatter(*np.transpose(sensors), color="tab:blue", label="accelerometers")
axes.scatter(*struck, color="tab:red", s=60, label="hammer")
axes.set_box_aspect((2, 2, 2.5))
axes.set_axis_off()
axes.legend(loc="upper left")

# %%
# From responses to a table
# -------------------------
# The nodal diameters of a mode follow from the angles of the sensors. These are points 2 to 17 of the file; point 1 is
# that of the hammer. The result is the frequency table for the update. Each mode has its uncertainty.

measured = cf.frf.FrfSet.from_uff(here / "hammer.uff")
angles = {1: np.degrees(0.35)} | {point: 22.5 * (point - 2) for point in range(2, 18)}
found = cf.identify(measured, angles=angles)
print(found)
table = found.table()
table.to_csv(here / "table.csv")
figure = figure_fit(found)

# %%
# Responses and fit. The identified shapes at the rim:

figure, panels = plt.subplots(1, 4, subplot_kw={"projection": "polar"}, figsize=(8.4, 2.6), layout="constrained")
ring = np.radians([angles[point] for point in range(2, 18)])
for axes, mode in zip(panels, range(4)):
    shape = np.real(found.shapes[:, mode] / found.shapes[np.abs(found.shapes[:, mode]).argmax(), mode])[-16:]
    axes.plot(np.append(ring, ring[0]), 3.0 + np.append(shape, shape[0]), "o-", markersize=3)
    axes.plot(turn, np.full(turn.size, 3.0), color="0.6", linewidth=0.8)
    axes.set(rticks=[], ylim=(0.0, 4.2), title=f"{found.freq[mode]:.1f} Hz, n = {found.n[mode]}")
    axes.set_xticklabels([])
assert found.n.tolist() == [3, 3, 4, 4, 2]
assert found.unresolved == (4,)

# %%
# The pair of two nodal diameters at 628 Hz is given as one mode. Its split is 0.1 Hz, less than the line spacing and a
# twentieth of its bandwidth, and the hammer struck only one point. A note gives the bound on its split.

# %%
# The model is updated
# --------------------
# Two parameters vary: Young's modulus and the stiffness of the base. The model's own error, from its coarse mesh, is
# 0.01 % of each frequency. The result has the standard deviation of each parameter.

fit = cf.update(
    casing,
    cf.FrequencyTable.from_csv(here / "table.csv"),
    vary=[
        cf.Parameter(name="material.E", lower=180e9, upper=230e9),
        cf.Parameter(name="support.base.k_face", lower=1e11, upper=1e15, log=True),
    ],
    model_error=1e-4,
)
print(fit)
models = {"imperfect": Paired(fit.before, fit.pairing_before), "updated": Paired(fit.after, fit.pairing)}
figure = figure_comparison(fit.table, models)

# %%
# Frequencies, splits and orientations before and after. Modes of the updated casing:

figure = figure_shapes(fit.after, [0, 2, 4])
assert abs(fit.value[0] - 205e9) < 3.0 * fit.sigma[0] + 0.5e9
assert fit.rms_after < 1e-3 < fit.rms_before

# %%
# The blade
# ---------
# The blade is a strip of steel. A tap at its tip gave 338 Hz for the first bending mode. The update varies the
# thickness.

blade = cf.Shell(
    chart=cf.Plate(length=0.08, width=0.03),
    thickness=2.5e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"root": cf.Clamped()},
    mesh=cf.ShellMesh(order=6, rows=2, around=2),
)
tap = cf.FrequencyTable.from_arrays(freq_hz=[338.0], sigma_hz=[0.5])
tuned = cf.update(blade, tap, vary=[cf.Parameter(name="shell.thickness", lower=2.3e-3, upper=2.8e-3)])
print(f"{1e3 * tuned.value[0]:.3f} mm")
figure = figure_shapes(cf.modes(tuned.structure, count=3), [0, 1, 2])
assert abs(tuned.after.freq[0] - 338.0) < 0.1

# %%
# Both are reduced
# ----------------
# A basis has a few modes, and the static compliance of all other modes. The files contain only arrays. From here on the
# package `contact` works alone.

cf.reduce(fit.structure, cf.Rim("top", n_max=8), modes=16, zeta=0.003).save(here / "casing.npz")
cf.reduce(tuned.structure, cf.Tip(), modes=3, zeta=0.003).save(here / "blade.npz")
bodies = [ct.ModalBody.load(here / name) for name in ("casing.npz", "blade.npz")]
print(*bodies, sep="\n")

figure, axes = plt.subplots(subplot_kw={"projection": "polar"}, layout="constrained")
axes.plot(turn, np.full(turn.size, 0.1), color="tab:blue", label="rim of the casing")
axes.plot([0.0, 0.0], [0.02, 0.1], color="tab:red", linewidth=4, label="blade, 80 mm")
axes.set(rticks=[], ylim=(0.0, 0.11))
axes.set_xticklabels([])
axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

# %%
# The interface of the casing is its rim, described by harmonics; that of the blade is its tip.

# %%
# The dangerous speeds
# --------------------
# The blade rotates in the casing and is 0.05 mm too long. At speeds f where n f is the sum of a frequency of the casing
# and one of the blade, permanent contact can excite both. The poles of permanent contact give the speeds to examine.
# Short runs at these speeds, and at speeds between, show whether the motion grows.

rub = ct.RotatingRim(*bodies, clearance=-5e-5, speed_hz=100.0, lean_deg=15.0)
scene = ct.Scene(what=rub, law=ct.Coulomb(mu=0.1), t_end=0.03, dt=1e-5)
interactions = ct.interactions(scene, np.linspace(30.0, 170.0, 141), runs=16)
print(interactions)
figure = figure_interactions(interactions)
worst = interactions.rows[0].at.speed_hz
assert interactions.rows[0].at.verdict == "unstable"

# %%
# Two runs in time
# ----------------
# One run is at the worst speed, one at a speed without growth. Both begin with the blade pressed against the rim.

histories = {}
for speed in (worst, 30.0):
    run = ct.run(
        replace(rub, speed_hz=speed), law=ct.Coulomb(mu=0.1), t_end=0.05, dt=5e-6, on_limit="flag",
        record=ct.Record(every=10, state_every=10),
    )  # fmt: skip
    histories[speed] = run
    print(f"{speed:.1f} turns/s: {', '.join(run.flags) or 'no flag'}")

figure, axes = plt.subplots(layout="constrained")
for speed, run in histories.items():
    axes.semilogy(1e3 * run.state_time[1:], np.abs(run.state[1:]).max(axis=1), label=f"{speed:.1f} turns/s")
axes.set(xlabel="time [ms]", ylabel="largest modal coordinate [m kg$^{1/2}$]")
axes.legend()

# %%
# The motion at the worst speed grows exponentially. The run stops at a tenth of the radius, beyond the range of the
# linear model. The rim at the end of that run, its largest deflection drawn as 20 mm:

casing_part = bodies[0].rows @ histories[worst].state[-1][: bodies[0].omega.size]
waves = {"cos": np.cos, "sin": np.sin}
deflection = np.zeros(turn.size)
for channel, amplitude in zip(bodies[0].channels, casing_part):
    direction, wave = channel.split(".")
    if direction == "radial":
        deflection += amplitude * waves[wave[:3]](int(wave[3:]) * turn)
figure, axes = plt.subplots(subplot_kw={"projection": "polar"}, layout="constrained")
axes.plot(turn, 0.1 + 0.02 * deflection / np.abs(deflection).max(), color="tab:red")
axes.plot(turn, np.full(turn.size, 0.1), color="0.6", linewidth=0.8)
axes.set(
    rticks=[],
    ylim=(0.0, 0.13),
    title=f"{worst:.1f} turns/s: largest deflection {1e6 * np.abs(deflection).max():.0f} µm",
)
axes.set_xticklabels([])

sizes = {speed: np.abs(run.state[-200:]).max() for speed, run in histories.items()}
assert sizes[worst] > 10.0 * sizes[30.0]
folder.cleanup()
