"""
Repeated impacts: error against run time
========================================

A ball falls 5 m and loses a fifth of its speed in each impact. Time stepping closes the contact at the end of a step,
so each impact is late by part of a step; the error falls in proportion to the step, and the run time grows. The
event-driven scheme locates each impact: its error is that of double precision at any interval of the samples.
"""

import matplotlib.pyplot as plt

import contact as ct

height, gravity, restitution, end = 5.0, 10.0, 0.8, 7.0  # m, m/s^2, -, s
bodies = [ct.Wall(), ct.PointMass(mass=1.0, x=height)]


def exact(time: float) -> float:
    """Height of the ball in closed form [m]."""
    speed, at = (2.0 * gravity * height) ** 0.5, (2.0 * height / gravity) ** 0.5
    while True:
        speed *= restitution
        if at + 2.0 * speed / gravity > time:
            return (time - at) * (speed - 0.5 * gravity * (time - at))
        at += 2.0 * speed / gravity


schemes = {
    "Moreau-Jean": ct.MoreauJean(restitution=restitution),
    "CD-Lagrange": ct.scheme.CDLagrange(restitution=restitution),
    "Paoli-Schatzman": ct.scheme.PaoliSchatzman(restitution=restitution),
    "event-driven": ct.scheme.EventDriven(restitution=restitution),
}
figure, axes = plt.subplots(layout="constrained")
found = {}
for (name, scheme), mark in zip(schemes.items(), "os^*", strict=True):
    seconds, errors = [], []
    for dt in (1e-1, 1e-2, 1e-3, 1e-4):
        record = ct.Record(every=10, state_every=10)
        result = ct.run(bodies, scheme=scheme, gravity=gravity, t_end=end, dt=dt, record=record)
        error = abs(height + result.state[-1, -1] - exact(result.state_time[-1])) / height
        seconds.append(result.seconds)
        errors.append(max(error, 1e-17))
    axes.plot(seconds, errors, marker=mark, label=name)
    found[name] = errors
    print(f"{name:16} error {errors[0]:.1e} at dt = 0.1 s, {errors[-1]:.1e} at dt = 0.0001 s")
axes.set(xscale="log", yscale="log", xlabel="run time [s]", ylabel="error of the height over 5 m [-]")
axes.legend()

assert max(found["event-driven"]) < 1e-13
assert all(errors[-1] < 1e-3 for errors in found.values())
