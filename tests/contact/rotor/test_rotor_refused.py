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


def test_forces_of_supports_and_growth_of_rotors_need_participations_states_and_speeds():
    rotor = R.Rotor.of(R.Jeffcott(mass=1.0, stiffness=1e4, zeta=0.1), 10.0)
    casing = R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e8)
    rub = R.rotor_rub(rotor, casing, [R.rigid_tip()], clearance=0.02)
    bare, dense = replace(rub, casing=replace(rub.casing, participation=None)), ct.Record(state_every=1)
    some, none = (ct.run(rub, t_end=1e-3, dt=1e-4, record=record) for record in (dense, ct.Record()))
    still = ct.Scene(what=replace(rotor, speed=ct.Speed.constant(0.0)), t_end=1.0)
    assert len(ct.recovery.support_forces(rub, some)["bearings"]) == len(some.state)
    for made, words in (
        (lambda: ct.recovery.support_forces(bare, some), "participation: found none in the bases of rotor and casing"),
        (lambda: ct.recovery.support_forces(rub, none), "state: found none in the result"),
        (lambda: ct.interactions(still), "speed_hz: found none for a scene at rest"),
        (
            lambda: ct.interactions(replace(still, what=rotor), [0.0, 10.0]),
            "speed_hz: found 0 Hz, expected speeds above",
        ),
    ):
        with pytest.raises(ct.InputError, match=words):
            made()


def test_states_are_stored_by_default_of_rotors_and_rubs_alone():
    rotor = R.Rotor.of(R.Jeffcott(mass=1.0, stiffness=1e4, zeta=0.1), 10.0)
    patch = ct.Patch(body=BODY, normal=("disk.x",), clearance=0.1)
    assert len(ct.run(patch, t_end=0.1, dt=1e-3).state) == 0
    assert len(ct.run([ct.PointMass(mass=1.0, x=1.0), ct.Wall()], t_end=0.1, dt=1e-3).state) == 0
    assert len(ct.run(rotor, t_end=0.1, dt=1e-3).state) > 10


@pytest.mark.parametrize(("mass", "taken"), [(1e60, True), (1.01e60, False), (1.01e-60, True), (0.99e-60, False)])
def test_positive_numbers_are_small_and_large_enough_to_multiply(mass, taken):
    if taken:
        assert ct.PointMass(mass=mass, x=0.0).mass == mass
        return
    with pytest.raises(ct.InputError, match=r"mass: found .*, expected a number between 1e-60 and 1e\+60"):
        ct.PointMass(mass=mass, x=0.0)
