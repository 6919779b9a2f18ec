"""Contact targets of every scheme: order in smooth motion, convergence in dt of an impact, the energy ledger."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

import contact as ct
from reports.tables import Row
from reports.verification.schemes.cases import BAR, Method, cases, methods, run, spring
from reports.verification.schemes.targets.rods import target

Array = NDArray[np.float64]
STIFFNESS = np.array([[30.0, -10.0, 0.0], [-10.0, 30.0, -20.0], [0.0, -20.0, 20.0]])
MASS, LOAD, VELOCITY = np.array([1.0, 2.0, 0.5]), np.array([0.0, -1.0, 0.5]), np.array([1.0, 0.0, 2.0])
FIRST_ORDER = ("Newmark (.5, .55)", "Newmark (.25, .55)")
CHATTERS = "known: the contact opens and closes again and again, more often as the step falls"
SCATTERS = "known: below 0.2 % from the first step on, by where in a step it closes"
KNOWN = {
    "CD-Lagrange": SCATTERS, "HHT (-.3), penalty": SCATTERS, "HHT (-.3)": CHATTERS, "HHT (-.3), augmented": CHATTERS,
    "Newmark (.5, .55)": CHATTERS, "Newmark (.25, .55)": CHATTERS, "Newmark (.25, .5)": CHATTERS,
}  # fmt: skip


def rows(quick: bool) -> list[Row]:
    """All lines; `quick` uses fewer scenes."""
    return [*_orders(), *_impacts(), *_ledgers(quick)]


def _orders() -> list[Row]:
    """Distance of the fitted order from theory, three coupled masses out of reach of their stops, at t = 1."""
    lines, steps = [], 1.0 / np.array([128, 256, 512, 1024])
    for method in methods(1.0):
        exact = _exact()
        if isinstance(method.scheme, ct.scheme.MasslessBoundary):  # it moves the masses: another structure
            exact = _free(method, 1.0 / 8192)
        errors = [float(np.abs(_free(method, float(dt)) - exact).max()) for dt in steps]
        slope = float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
        order = 1.0 if method.name in FIRST_ORDER else 2.0
        lines.append(target(f"order {order:g} in smooth motion, {method.name}: distance", 0.2, abs(slope - order)))
    return lines


def _exact() -> Array:
    A = np.zeros((7, 7))
    A[:3, 3:6] = np.eye(3)
    A[3:6, :3], A[3:6, 6] = -STIFFNESS / MASS[:, None], LOAD / MASS
    return np.asarray((expm(A) @ np.concatenate([np.zeros(3), VELOCITY, [1.0]]))[:3])


def _free(method: Method, dt: float) -> Array:
    body = ct.LinearBody(
        M=MASS, K=STIFFNESS, Q=np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]), gap0=np.array([50.0, 50.0]),
        load=LOAD, velocity=VELOCITY,
    )  # fmt: skip
    record = ct.Record(at=[1.0])
    result = ct.run(body, law=method.law, scheme=method.scheme, t_end=1.0 + 2 * dt, dt=dt, record=record)
    return np.asarray(result.state[0])


def _impacts() -> list[Row]:
    """Rates at which impulse and closing time of a dropped bar of 20 elements converge with the step."""
    lines = []
    steps = 0.77 * 0.6 ** np.arange(9)  # no divisors of the closing time
    for method in methods(60.0):
        fine = _drop(method, 0.77 * 0.6**15)
        errors = np.array([np.abs(_drop(method, float(courant)) - fine) for courant in steps])
        for k, name in enumerate(("impulse", "closing time")):
            slope = float(np.polyfit(np.log(steps), np.log(np.maximum(errors[:, k], 1e-15)), 1)[0])
            word = KNOWN.get(method.name, "MISSED") if name == "impulse" else "MISSED"
            lines.append(target(f"rate in dt, {method.name}: {name}", 0.9, slope, at_least=True, missed=word))
    return lines


def _drop(method: Method, courant: float) -> Array:
    result = ct.run([ct.Rod(**BAR, elements=20), ct.Wall()], law=method.law, scheme=method.scheme, t_end=2.5,
                    courant=courant, gravity=10.0, record=ct.Record(every=1000), on_limit="flag")  # fmt: skip
    return np.array([result.impulse[0], result.intervals[0][0][0]])


def _ledgers(quick: bool) -> list[Row]:
    """Largest unaccounted energy of each scheme over all scenes with an exact solution, and the scene."""
    worst: dict[str, tuple[float, str]] = {}
    for case in cases()[:3] if quick else cases():
        for method in methods(spring(case, 25)):
            energy = run(case, method, 25, 0.5, every=100).energy
            found = abs(energy.unaccounted) / energy.scale
            if found >= worst.get(method.name, (0.0, ""))[0]:
                worst[method.name] = (found, case.name)
    return [
        target(f"ledger unaccounted, {name}, worst of all scenes ({scene})", 1e-10, value)
        for name, (value, scene) in worst.items()
    ]
