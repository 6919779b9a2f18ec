"""Two masses before a one-sided spring: example 3 of NLvib (M. Krack, J. Gross, Harmonic Balance, 2019).

Masses of 1, a spring of 1 between them and one to the ground at the second, damping 0.03 K, a force of 0.1 on the
second; a spring of 100 with a gap of 1 before the first. The folds are those of NLvib's harmonic balance, as quoted to
four digits; more digits, and the other bifurcations, come from shooting with an event at each opening and closing.
"""

import math

import numpy as np
from scipy.linalg import eigh

import contact as ct
from contact.cycles import DrivenBody
from reports.tables import Row
from reports.verification.outside.columns import row

TURN = 2.0 * math.pi
RANGE = 0.5, 0.8  # rad/s
FOLDS = (0.6534, 0.7556)
SHOOTING = {
    "fold": (0.65344, 0.75563), "flip": (0.73878, 0.75558), "Neimark-Sacker": (0.58190, 0.61861),
}  # fmt: skip


def masses() -> DrivenBody:
    """The two masses."""
    square, shapes = eigh(np.array([[1.0, -1.0], [-1.0, 2.0]]))
    omega = np.sqrt(square)
    body = ct.ModalBody(
        omega=omega, zeta=0.015 * omega, channels=("x", "driven", "stop"),
        rows=np.array([shapes[0], shapes[1], -shapes[0]]), S=np.zeros((3, 3)),
    )  # fmt: skip
    patch = ct.Patch(body=body, normal=("stop",), clearance=1.0)
    return DrivenBody(patch=patch, channel="driven", amplitude=0.1, stiffness=100.0, shown=("x", "driven"))


def rows() -> list[Row]:
    """Folds beside NLvib's; all bifurcations beside shooting."""
    family = masses().over("freq_hz", freq_hz=0.1)
    found = ct.cycles.follow(family, (RANGE[0] / TURN, RANGE[1] / TURN), longest=0.02).branches[0]
    at = {kind: sorted(TURN * special.orbit.value for special in found.of(kind)) for kind in SHOOTING}
    result = [
        row(
            "program", f"two masses, fold {k} [rad/s]", "NLvib example 3", value, ours, 0.02, open_="digits beyond four"
        )
        for k, (value, ours) in enumerate(zip(FOLDS, at["fold"], strict=True), 1)
    ]
    return result + [
        row("program", f"two masses, {kind} {k} [rad/s]", "shooting with events", value, ours, 0.002)
        for kind, values in SHOOTING.items()
        for k, (value, ours) in enumerate(zip(values, at[kind], strict=True), 1)
    ]
