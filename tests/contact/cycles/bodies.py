"""A body that the tests of periodic orbits share; others are those of reports.verification.schemes.cycles."""

import math

import numpy as np

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
    return ct.cycles.DrivenBody(
        patch=patch, channel="d", amplitude=1.0, stiffness=stiffness, restitution=restitution, shown=("d",)
    )
