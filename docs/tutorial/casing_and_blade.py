r"""
One casing and one blade
========================

From a survey and a hammer test to the map of interactions, in one script. It runs in some seconds. There is no casing
on the table here: a virtual test rig replaces the laboratory, and all that it makes is marked SYNTHETIC. With data of
your own, leave out the parts headed *the laboratory* and read your files instead.
"""

import tempfile
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf
import contact as ct
from casingfem import rig
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
# A probe goes round at three heights and writes angle, height and radius of each point.

theta = np.tile(np.arange(0.0, 360.0, 7.5), 3)
height = np.repeat([20.0, 120.0, 230.0], 48)
around = np.radians(theta)
radius = 100.0 + 0.10 * np.cos(6.0 * around) + 0.08 * np.cos(2.0 * around - 0.7) + 0.05 * np.sin(8.0 * around)
radius += rng.normal(0.0, 0.004, theta.size)
rows = [f"{t},{z},{r:.4f}" for t, z, r in zip(theta, height, radius)]
card = "# SYNTHETIC: made by the tutorial, not measured"
(here / "survey.csv").write_text("\n".join([card, "theta_deg,z_mm,radius_mm", *rows, ""]))

# %%
# The survey becomes a field
# --------------------------
# A file of points with units in its header is all that is needed. The fit says what it resolves, and what it leaves.

survey = cf.SurveyField.from_csv(here / "survey.csv", n_max=12, degree=1)
print(survey)
assert abs(survey.residual_rms_m - 4e-6) < 1e-6

# %%
# A model from the drawing
# ------------------------
# The chart is the nominal shape, the survey its defect. How firm the base is nobody knows; 1e13 N/m³ is a guess.
# Coarse, so that this page is quick: leave `mesh` out, and the default is finer.

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
figure = figure_frequencies(drawn, cf.modes(replace(casing, radius_defect=None), count=8))

# %%
# The pairs of n = 3 and n = 4 are split by the harmonics 6 and 8 of the radius.
#
# The laboratory: a hammer test
# -----------------------------
# The real casing differs from the drawing: softer steel, a softer base. Sixteen accelerometers around the rim, one
# place struck. Analysers write universal files.

real = replace(
    casing, material=cf.Material(E=205e9, nu=0.3, rho=7800.0), supports={"base": cf.ElasticEdge(k_face=3e12)}
)
bench = rig.rig_of(cf.modes(real, count=12), [rig.Place(at=(0.25, 0.35)), *rig.circle(0.25, 16)], zeta=0.003)
lines = np.arange(350.0, 700.0, 0.5)
frfs = rig.noisy(bench.frfs(lines, sensors=range(1, 17), drives=[0]), 40.0, seed=20261)
rig.write_rig_uff(here / "hammer.uff", bench, [frfs])

# %%
# From responses to a table
# -------------------------
# The angle of each sensor tells how many nodal diameters a mode has: points 2 to 17 of the file, and point 1 where the
# hammer struck. What comes out is the frequency table that an update reads; each mode has its uncertainty.

measured = cf.frf.FrfSet.from_uff(here / "hammer.uff")
angles = {1: np.degrees(0.35)} | {point: 22.5 * (point - 2) for point in range(2, 18)}
found = cf.identify(measured, angles=angles)
print(found)
table = found.table()
table.to_csv(here / "table.csv")
figure = figure_fit(found)
assert found.n.tolist() == [3, 3, 4, 4, 2]
assert found.unresolved == (4,)

# %%
# The pair of two nodal diameters at 628 Hz is given as one mode: it is split by 0.1 Hz, less than the lines and a
# twentieth of its bandwidth, and one place was struck. A note gives the bound on its split.

# %%
# The model is updated
# --------------------
# Two numbers may vary: Young's modulus and the base. The model's own error, of the coarse mesh, is 0.01 % of each
# frequency. The result says how sure each number is.

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
assert abs(fit.value[0] - 205e9) < 3.0 * fit.sigma[0] + 0.5e9
assert fit.rms_after < 1e-3 < fit.rms_before

# %%
# The blade
# ---------
# A strip of steel. A tap at its tip gave 338 Hz for the first bending mode; its thickness takes up the difference.

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
assert abs(tuned.after.freq[0] - 338.0) < 0.1

# %%
# Both are reduced
# ----------------
# A few modes, and the static compliance of all that they leave out. The files hold arrays and nothing else; from here
# on the package `contact` works alone.

cf.reduce(fit.structure, cf.Rim("top", n_max=8), modes=16, zeta=0.003).save(here / "casing.npz")
cf.reduce(tuned.structure, cf.Tip(), modes=3, zeta=0.003).save(here / "blade.npz")
bodies = [ct.ModalBody.load(here / name) for name in ("casing.npz", "blade.npz")]
print(*bodies, sep="\n")

# %%
# The dangerous speeds
# --------------------
# The blade turns in the casing and is 0.05 mm too long. Where n f is the sum of a casing's and the blade's frequency, a
# contact that stays closed feeds both. Its poles propose speeds; a short run at each of them, and at speeds between,
# decides.

rub = ct.RotatingRim(*bodies, clearance=-5e-5, speed_hz=100.0, lean_deg=15.0)
scene = ct.Scene(what=rub, law=ct.Coulomb(mu=0.1), t_end=0.03, dt=1e-5)
interactions = ct.interactions(scene, np.linspace(30.0, 170.0, 141), runs=16)
print(interactions)
figure = figure_interactions(interactions)
worst = interactions.rows[0].at.speed_hz
assert interactions.rows[0].at.verdict == "unstable"

# %%
# Is it so in time?
# -----------------
# One run at the worst speed and one where nothing grows, from the same start: the blade pressed against the rim.

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

sizes = {speed: np.abs(run.state[-200:]).max() for speed, run in histories.items()}
assert sizes[worst] > 10.0 * sizes[30.0]
folder.cleanup()
