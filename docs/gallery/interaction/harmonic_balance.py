"""
Shooting and harmonic balance: error against processor time
===========================================================

A bar under a harmonic force meets an elastic obstacle. Each Newton step of shooting squares the error; each harmonic
adds to the accuracy of harmonic balance, for which modes cost nothing. Both start from their motion at a frequency
that is 0.1 % lower. A short series is another system: its branch may turn back where the orbits have no fold.
"""

import time
from functools import partial

import matplotlib.pyplot as plt
import numpy as np

import contact as ct
from contact.cycles.shooting import map_of

length, area, modulus, rho = 0.13, 15.6e-4, 210e9, 7800.0  # m, m^2, Pa, kg/m^3
value = 10.1e3  # Hz


def bar(modes):
    """Motions of the clamped-free bar by its first modes, before an obstacle of 4 E A/L at its end."""
    k = np.arange(modes)
    tip = (-1.0) ** k * np.sqrt(2.0 / (rho * area * length))
    body = ct.ModalBody(omega=(k + 0.5) * np.pi * np.sqrt(modulus / rho) / length, zeta=np.full(modes, 0.0075),
                        channels=("x", "stop"), rows=np.array([tip, -tip]), S=np.zeros((2, 2)))  # fmt: skip
    patch = ct.Patch(body=body, normal=("stop",), clearance=2e-4)
    stiffness = 4.0 * modulus * area / length
    driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=25e3, stiffness=stiffness, shown=("x",))
    return driven.over("freq_hz", freq_hz=value)


def quickest(work, times=3):
    """Result, and the least processor time [ms]."""
    spent = []
    for _ in range(times):
        begun = time.process_time()
        found = work()
        spent.append(1e3 * (time.process_time() - begun))
    return found, min(spent)


def shot(family, x, steps):
    """Amplitude after some Newton steps from a state [m]."""
    period = map_of(family, value)
    for _ in range(steps):
        found = period(x)
        x = x + np.linalg.solve(found.M - np.eye(x.size), x - found.x)
    return float(period(x).amplitude[0])


figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.0), layout="constrained")
best = {}
for modes, colour in ((2, "C0"), (20, "C1")):
    family = bar(modes)
    exact = ct.cycles.orbit(family, value)
    near = np.array(ct.cycles.orbit(family, 0.999 * value, guess=np.array(exact.x)).x)
    truth = shot(family, np.array(exact.x), 3)
    shots = [quickest(partial(shot, family, near, steps)) for steps in (1, 2, 3)]
    series = []
    for harmonics in (5, 10, 20, 30, 60):
        beside = ct.cycles.balance(family, 0.999 * value, harmonics=harmonics)
        found, spent = quickest(partial(ct.cycles.balance, family, value, harmonics=harmonics, guess=beside))
        series.append((found.amplitude["x"], spent))
    for name, results, mark in (("shooting", shots, "o-"), ("harmonic balance", series, "s--")):
        error = [max(abs(amplitude / truth - 1.0), 1e-15) for amplitude, _ in results]
        left.plot([spent for _, spent in results], error, mark, color=colour, label=f"{name}, {modes} modes")
        best[name, modes] = error[-1]
        print(f"{name:16} {modes:3d} modes: error {error[-1]:.1e} in {results[-1][1]:.1f} ms")
left.set(
    xscale="log", yscale="log", xlim=(0.1, 10.0), xlabel="processor time [ms]", ylabel="error of the amplitude [-]"
)
left.legend(fontsize=7, loc="lower right")

mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=1e5, shown=("x",))
family = driven.over("freq_hz", freq_hz=0.2)
orbits = ct.cycles.follow(family, (0.16, 0.26), longest=0.1)
short = ct.cycles.balance_branch(family, (0.16, 0.26), harmonics=3, longest=0.1)
(branch,) = orbits.branches
right.plot(branch.value, branch.amplitude("x"), label="shooting")
right.plot([one.value for one in short], [one.amplitude["x"] for one in short], "--", label="3 harmonics")
right.set(xlabel="frequency of the force [Hz]", ylabel="amplitude [m]", title="A false turning point, at 0.2543 Hz")
right.legend(fontsize=8)

assert best["shooting", 2] < 1e-10
assert best["shooting", 20] < 1e-8
assert max(best["harmonic balance", modes] for modes in (2, 20)) < 1e-5
assert not branch.of("fold")
assert max(one.value for one in short) < 0.2544  # Hz: the branch turns back
