"""Rotors and rigid casings that cannot be: each is refused with the name of what is wrong."""

from dataclasses import replace

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


ENDS = [R.Bearing(at=0.0, kxx=1e7), R.Bearing(at=0.4, kxx=2e7)]
SHAFT = R.Shaft(pieces=[R.Piece(length=0.4, diameter=0.03, elements=2)], bearings=ENDS)
UNSTABLE = replace(SHAFT, bearings=[R.Bearing(at=0.0, kxx=1e7, kxy=-3e7, kyx=-3e7)])
DISK = R.Rotor(body=BODY, speed=ct.Speed.constant(1.0), at="disk")


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: replace(DISK, gravity=9.81), "gravity: found a body without participation factors"),
        (lambda: replace(DISK, gravity=-1.0), "gravity: found -1.0"),
        (lambda: replace(DISK, limit=0.0), "limit: found 0.0"),
        (
            lambda: R.Rotor.of(replace(BODY, channels=("disk.x", "ring.y")), 1.0),
            "found disk.x, ring.y, expected x and y",
        ),
        (
            lambda: R.Shaft(pieces=[R.Piece(length=0.4, diameter=0.03, elements=400)], bearings=ENDS),
            "found 401 nodes, expected at most 400",
        ),
        (lambda: SHAFT.node(0.3), "at: found 0.3 m, expected a node: 0, 0.2, 0.4 m"),
        (lambda: R.Rotor.of(SHAFT, 1.0, modes=13), "modes: found 13, expected 1 to 12, the modes of the shaft"),
        (lambda: R.Rotor.of(SHAFT, 1.0, modes=0), "modes: found 0, expected 1 to 12, the modes of the shaft"),
        (lambda: R.Rotor.of(UNSTABLE, 1.0), "bearings: found a shaft without a positive stiffness"),
    ],
)
def test_rotors_that_cannot_be_are_refused(made, words):
    assert R.Shaft(pieces=[R.Piece(length=0.4, diameter=0.03, elements=399)], bearings=ENDS).nodes.size == 400
    with pytest.raises(ct.InputError, match=words):
        made()
