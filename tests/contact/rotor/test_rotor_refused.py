"""Rotors and rigid casings that cannot be: each is refused with the name of what is wrong."""

import numpy as np
import pytest

import contact as ct

R = ct.rotor
BODY = ct.ModalBody(
    omega=[100.0, 100.0], zeta=[0.0, 0.0], channels=("disk.x", "disk.y"), rows=np.eye(2), S=np.zeros((2, 2))
)


@pytest.mark.parametrize("name", ["radius", "mass", "stiffness"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_a_rigid_casing_has_a_positive_radius_mass_and_stiffness(name, value):
    whole = {"radius": 0.25, "mass": 20.0, "stiffness": 2e8}
    assert R.rigid_casing(**whole).omega[0] == pytest.approx(np.sqrt(2e8 / 20.0))
    with pytest.raises(ct.InputError, match=f"{name}: found .*, expected a positive number"):
        R.rigid_casing(**whole | {name: value})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"internal": np.zeros((3, 3))}, "internal: found shape"),
        ({"internal": np.full((2, 2), np.nan)}, "internal"),
        ({"displacement": [0.0]}, "displacement"),
        ({"velocity": [0.0, 0.0, 0.0]}, "velocity"),
    ],
)
def test_arrays_of_a_rotor_fit_its_modes(given, words):
    speed = ct.Speed.constant(10.0)
    R.Rotor(body=BODY, speed=speed, at="disk", internal=np.zeros((2, 2)), displacement=[0.0, 0.0])
    with pytest.raises(ct.InputError, match=words):
        R.Rotor(body=BODY, speed=speed, at="disk", **given)
