"""Forces are averaged over the period of the highest mode, however slow, and over a step where nothing swings."""

import numpy as np
import pytest

import contact as ct


def body(*omega):
    """Modes of one point that is seen along two directions."""
    return ct.ModalBody(
        omega=omega, zeta=np.zeros(len(omega)), channels=("span", "flap"), rows=np.ones((2, len(omega))),
        S=np.zeros((2, 2)),
    )  # fmt: skip


def rim(*omega):
    """The same of a ring that turns, seen along its radius and its circumference by one harmonic."""
    return ct.ModalBody(
        omega=omega, zeta=np.zeros(len(omega)), channels=ct.bodies.rim_channels(1), rows=np.ones((6, len(omega))),
        S=np.zeros((6, 6)), kind="rim", n_max=1, radius=0.4,
    )  # fmt: skip


SCENES = {
    "point": lambda *omega: ct.PointGap(
        sides=(ct.gaps.Side(body=body(*omega), channel="span", sign=1),), clearance=1.0
    ),
    "patch": lambda *omega: ct.Patch(body=body(*omega), normal=("span",), tangent=(("flap",),)),
    "rub": lambda *omega: ct.Rub(
        rim(*omega), (body(*omega),), [ct.ContactPoint()], clearance=0.01, speed=ct.Speed.constant(1.0)
    ),
}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize(("omega", "dt", "window"), [((0.0, 0.4, 0.1), 0.04, 5.0 * np.pi), ((0.0,), 0.04, 0.04)])
def test_the_window_is_the_period_of_the_highest_mode(scene, omega, dt, window):
    stepper = ct.ExactModal().prepare(SCENES[scene](*omega), ct.Unilateral(), dt=dt, courant=None)
    assert stepper.window == pytest.approx(window, rel=1e-12)
