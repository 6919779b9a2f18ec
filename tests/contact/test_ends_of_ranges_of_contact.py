"""Numbers at the ends of what is allowed: the last one that is taken, and the next one that is not."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.cycles.bodies import random_body
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

BELOW, ABOVE = np.nextafter(1.0, 0.0), np.nextafter(1.0, 2.0)
PAIR = ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5)
ONE = ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4)
BODY = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)))
ROD = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0)
RING = ct.bodies.ThinRing(radius=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)
BEAM = ct.bodies.HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)
COATING = ct.Abradable(E=1e9, yield_stress=2e4, hardening=1e6, thickness=1e-3, width=0.02, tip=6e-3, bars=2)


def rub(**changes):
    return ct.Rub(rim3(), (nodes(1),), tips(1), **changes)


def shaft(elements):
    """Of one piece; between its ends are one node fewer than elements."""
    bearings = [ct.rotor.Bearing(at=at, kxx=2e7) for at in (0.0, 0.6)]
    disk = ct.rotor.Disk(at=0.0, mass=2.0, polar=0.04, diametral=0.02)
    piece = ct.rotor.Piece(length=0.6, diameter=0.06, elements=elements)
    return ct.rotor.Shaft(pieces=[piece], disks=[disk], bearings=bearings)


def shaken(degrees):
    """A blade with two tips this far apart, shaken with its casing."""
    two = [replace(tip, angle_deg=angle) for tip, angle in zip(tips(2), (0.0, degrees), strict=True)]
    bearers = {"on": "blades", "acceleration": 1.0, "radius": 0.4}
    what = ct.Rub(rim3(), (replace(nodes(2), participation=np.ones((3, 3))),), two, clearance=1e-4,
                  forces=[ct.gaps.BodyForce(**bearers)])  # fmt: skip
    return ct.run(what, t_end=1e-4, dt=1e-5)


def coated(**changes):
    """A rim of 0.45 m radius with a coating."""
    what = ct.RotatingRim(ring(), blade(), clearance=1e-4, speed_hz=5.0)
    return ct.run(what, law=replace(COATING, **changes), t_end=1e-4, dt=1e-5)


def consistent(size):
    """Equal masses with a mass matrix that is not lumped, by central differences."""
    M = np.diag(np.full(size, 2.0)) + np.diag(np.full(size - 1, 0.5), 1) + np.diag(np.full(size - 1, 0.5), -1)
    body = ct.LinearBody(M=M, K=np.diag(np.arange(1.0, size + 1.0)), Q=np.eye(1, size), gap0=np.array([0.1]))
    return ct.run(body, scheme=ct.CentralDifference(), t_end=1e-3, dt=1e-4)


def disk(**changes):
    return ct.gaps.BladedDisk(**{"blades": 5, "freq_hz": 100.0, "modal_mass": 0.4, "coupling": 0.05, **changes})


TAKEN_REFUSED = {
    "length of a rod": (lambda x: replace(ROD, length=x), 1e-9, 0.0),
    "damping of a rod": (lambda x: replace(ROD, damping=x), 0.0, -1e-9),
    "elements": (lambda x: replace(ROD, elements=x), 1, 0),
    "mass": (lambda x: ct.PointMass(mass=x), 1e-9, 0.0),
    "frequency of a mode": (lambda x: replace(BODY, omega=[x, 2.0]), 0.0, -1e-9),
    "damping of a mode": (lambda x: replace(BODY, zeta=[0.0, x]), BELOW, 1.0),
    "least damping of a mode": (lambda x: replace(BODY, zeta=[0.0, x]), 0.0, -1e-9),
    "height of a ring": (lambda x: replace(RING, height=x), 0.5 * BELOW, 0.5),
    "radius of a circle": (lambda x: ct.bodies.BeamInCircle(BEAM, radius=x), 0.5, 0.4999),
    "lean of a tip": (lambda x: ct.ContactPoint(lean_deg=x), 90.0 * BELOW, 90.0),
    "least lean of a tip": (lambda x: ct.ContactPoint(lean_deg=x), -90.0 * BELOW, -90.0),
    "lean of a rim": (
        lambda x: ct.RotatingRim(ring(), blade(), speed_hz=1.0, clearance=1e-4, lean_deg=x),
        90.0 * BELOW,
        90.0,
    ),
    "wave of a rim": (
        lambda x: ct.RotatingRim(
            ring(), blade(), speed_hz=1.0, clearance=1e-4, out_of_roundness=[{"p": x, "cos": 1e-6}]
        ),
        0,
        -1,
    ),
    "thickness of a casing": (lambda x: rub(thickness=x), 1e-9, 0.0),
    "blade of a tip": (lambda x: ct.Rub(rim3(), (nodes(1),), tips(1, blade=x)), 0, 1),
    "times of a speed": (lambda x: ct.Speed(time=[0.0, x], hz=[1.0, 2.0]), 1e-9, 0.0),
    "time of a closing": (lambda x: ct.gaps.Closing.exponential(1e-5, x), 1e-9, 0.0),
    "mistuning": (lambda x: disk(mistuning=np.r_[x, np.zeros(4)]), -BELOW, -1.0),
    "diameters of a pair": (lambda x: ct.gaps.HandPair(casing=replace(PAIR, n=x), blade=ONE, compliance=1e-4), 1, 0),
    "damping of a pair": (lambda x: replace(PAIR, zeta=x), BELOW, 1.0),
    "least damping of a pair": (lambda x: replace(PAIR, zeta=x), 0.0, -1e-9),
    "steps of a sample": (lambda x: ct.Record(every=x), 1, 0),
    "states": (lambda x: ct.Record(every=2, state_every=x), 4, 3),
    "least states": (lambda x: ct.Record(every=1, state_every=x), 0, -1),
    "instants": (lambda x: ct.Record(at=[x]), 0.0, -1e-9),
    "friction": (lambda x: ct.Coulomb(mu=x), 1e-9, -1e-9),
    "spring": (lambda x: ct.Penalty(stiffness=x), 1e-9, 0.0),
    "machined coating": (lambda x: replace(COATING, machined=x), 1e-3, 1e-3 * ABOVE),
    "bars": (lambda x: replace(COATING, bars=x), 1, 0),
    "alpha": (lambda x: ct.scheme.HHT(alpha=x), -1.0 / 3.0, -0.3334),
    "largest alpha": (lambda x: ct.scheme.HHT(alpha=x), 0.0, 1e-9),
    "theta": (lambda x: ct.MoreauJean(theta=x), 0.5, 0.5 * BELOW),
    "largest theta": (lambda x: ct.MoreauJean(theta=x), 1.0, ABOVE),
    "restitution": (lambda x: ct.MoreauJean(restitution=x), 1.0, ABOVE),
    "least restitution": (lambda x: ct.MoreauJean(restitution=x), 0.0, -1e-9),
    "beta": (lambda x: ct.scheme.Newmark(beta=x), 1.0, ABOVE),
    "gamma": (lambda x: ct.scheme.Newmark(gamma=x), 1.0, ABOVE),
    "least gamma": (lambda x: ct.scheme.Newmark(gamma=x), 0.5, 0.5 * BELOW),
    "rho": (lambda x: ct.scheme.NonsmoothAlpha(rho_inf=x), 1.0, ABOVE),
    "least rho": (lambda x: ct.scheme.NonsmoothAlpha(rho_inf=x), 0.0, -1e-9),
    "phase of a step": (lambda x: ct.ExactModal(omega_h_limit=x), 3.1 * BELOW, 3.1),
    "least phase of a step": (lambda x: ct.ExactModal(omega_h_limit=x), 1e-9, 0.0),
    "stiffness of a stop": (lambda x: random_body(1, 1, stiffness=x), 1e-9, 0.0),
    "restitution of a stop": (lambda x: random_body(1, 1, restitution=x), 1.0, ABOVE),
    "least restitution of a stop": (lambda x: random_body(1, 1, restitution=x), 0.0, -1e-9),
    "diameters of a rim": (lambda x: ct.gaps.pair_rim(replace(PAIR, n=x), radius=0.5), 1, 0),
    "bars under a tip": (lambda x: replace(COATING, bars=x), 10_000, 10_001),
    "least frequency of a mode": (lambda x: replace(BODY, omega=[x, 2.0]), 1e-50, 0.99e-50),
    "clearance of a rim": (lambda x: ct.RotatingRim(ring(), blade(), speed_hz=1.0, clearance=x), 0.045 * BELOW, 0.0451),
    "interference of a rim": (
        lambda x: ct.RotatingRim(ring(), blade(), speed_hz=1.0, clearance=x),
        -0.045 * BELOW,
        -0.0451,
    ),
    "unit": (lambda x: replace(ROD, E=x), 1e60, 1.01e60),
    "small unit": (lambda x: replace(ROD, E=x), 1.01e-60, 0.99e-60),
    "samples": (lambda x: ct.Record(every=x), 10_000_000, 10_000_001),
    "nodes of a shaft": (lambda x: shaft(x), 399, 400),
    "gyroscopic matrix": (lambda x: replace(BODY, gyroscopic=np.array([[0.0, 1.0], [-1.0 + x, 0.0]])), 0.9e-8, 1.1e-8),
    "spread of tips": (shaken, 10.0, 10.1),
    "spread of tips the other way": (shaken, 350.0, 349.9),
    "length of a tip": (lambda x: coated(tip=x), 0.5 * np.pi * 0.45 * BELOW, 0.5 * np.pi * 0.45 * 1.0001),
    "bars around a rim": (
        lambda x: coated(tip=x, bars=10),
        2.0 * np.pi * 0.45e-5 * 1.001,
        2.0 * np.pi * 0.45e-5 * 0.999,
    ),
    "consistent masses": (consistent, 200, 201),
    "speeds": (
        lambda x: ct.stability.peaks(ct.gaps.HandPair(casing=PAIR, blade=ONE, compliance=1e-4), [x, 60.0]),
        1e-3,
        0.0,
    ),
    "order of speeds": (
        lambda x: ct.stability.peaks(ct.gaps.HandPair(casing=PAIR, blade=ONE, compliance=1e-4), [50.0, x]),
        50.1,
        50.0,
    ),
}


@pytest.mark.parametrize("name", TAKEN_REFUSED)
def test_the_last_number_is_taken_and_the_next_is_not(name):
    make, taken, refused = TAKEN_REFUSED[name]
    make(taken)
    with pytest.raises((ct.InputError, ct.LimitError, ValueError)):
        make(refused)
