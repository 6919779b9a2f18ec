"""Bodies that the tests of periodic orbits share."""

import math

import numpy as np
from scipy.linalg import eigh

import contact as ct


def random_body(seed, contacts, *, stiffness=math.inf, restitution=0.0, modes=6, compliance=0.0):
    """Modes from 0.5 to 6 rad/s before as many stops, driven at a channel of its own."""
    rng = np.random.default_rng(seed)
    omega, rows = np.sort(rng.uniform(0.5, 6.0, modes)), rng.standard_normal((contacts + 1, modes))
    zeta, clearance = rng.uniform(0.01, 0.05, modes), rng.uniform(0.05, 0.3, contacts)
    stops = tuple(f"stop{i}" for i in range(contacts))
    S = compliance * np.eye(contacts + 1)
    body = ct.ModalBody(omega=omega, zeta=zeta, channels=("d", *stops), rows=rows, S=S)
    patch = ct.Patch(body=body, normal=stops, clearance=clearance)
    return ct.growth.cycles.DrivenBody(
        patch=patch, channel="d", amplitude=1.0, stiffness=stiffness, restitution=restitution, shown=("d",)
    )


def rod(ratio, *, elements=20, length=0.13, area=15.6e-4, E=210e9, rho=7800.0, zeta=0.0075, gap=0.2e-3, force=25e3):
    """Clamped-free bar of two-node elements with consistent mass before an obstacle of stiffness `ratio` E A/L."""
    h = length / elements
    K, M = np.zeros((elements + 1, elements + 1)), np.zeros((elements + 1, elements + 1))
    for e in range(elements):
        K[e : e + 2, e : e + 2] += E * area / h * np.array([[1.0, -1.0], [-1.0, 1.0]])
        M[e : e + 2, e : e + 2] += rho * area * h / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    square, shapes = eigh(K[1:, 1:], M[1:, 1:])
    tip = shapes[-1]
    body = ct.ModalBody(
        omega=np.sqrt(square), zeta=np.full(elements, zeta), channels=("x", "stop"), rows=np.array([tip, -tip]),
        S=np.zeros((2, 2)),
    )  # fmt: skip
    patch = ct.Patch(body=body, normal=("stop",), clearance=gap)
    return ct.growth.cycles.DrivenBody(
        patch=patch, channel="x", amplitude=force, stiffness=ratio * E * area / length, shown=("x",)
    )


def mass_on_stop(stiffness=math.inf, amplitude=0.02, **given):
    """E2: m = 1, c = .05, k = 1, F = .02, gap .1."""
    body = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("stop",), clearance=0.1)
    return ct.growth.cycles.DrivenBody(
        patch=patch, channel="x", amplitude=amplitude, stiffness=stiffness, shown=("x",), **given
    )
