"""Input that no other test refuses: each fault says what was found where, and what is expected."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array, diags_array

import contact as ct
from tests.contact.cycles.bodies import random_body
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

PAIR = csc_array(np.diag([1.0, 2.0]))
RIM = ct.RotatingRim(ring(), blade(), clearance=1e-5, speed_hz=5.0)
FRAME = ct.LinearBody(M=np.ones(2), K=2.0 * np.eye(2), Q=np.array([[1.0, 0.0]]), gap0=np.array([0.1]))
BODY = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)))
RING = ct.bodies.ThinRing(radius=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)
ROD = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="right")
RUNS = {"t_end": 1e-3, "dt": 1e-5}


def consistent():
    """A body too large for its mass matrix to be factored at every step."""
    size = 201
    M = diags_array([np.full(size, 2.0), np.ones(size - 1), np.ones(size - 1)], offsets=[0, 1, -1], format="csr")
    return ct.LinearBody(M=M, K=M, Q=csr_array(([1.0], ([0], [0])), shape=(1, size)), gap0=np.array([0.1]))


def matrices(**more):
    return ct.ModalBody.from_matrices(PAIR, PAIR, **({"dofs": [(1, "x"), (2, "x")], "contact": [1]} | more))


REFUSED = {
    "sectors": (
        lambda: replace(BODY, sectors=2),
        "sectors: found 2 and channels of 2 sectors, expected channels sector0.*",
    ),
    "names twice": (lambda: replace(BODY, channels=("x", "x")), "channels: found"),
    "a compliance that pushes": (lambda: replace(BODY, S=-np.eye(2)), "S: found"),
    "rows of another size": (lambda: replace(BODY, rows=np.eye(3)), "rows: found"),
    "a direction": (lambda: matrices(dofs=[(1, "up"), (2, "x")]), "dofs: found direction 'up' at node 1, expected"),
    "a contact twice": (lambda: matrices(contact=[1, 1]), "expected nodes or dofs of the matrices, each once"),
    "a node without dofs": (
        lambda: matrices(contact=[7]),
        "contact: found node 7, expected a node with a dof along x, y or z",
    ),
    "gravity on a rim": (
        lambda: ct.run(RIM, gravity=9.8, **RUNS),
        "gravity: found 9.8 m/s^2 with RotatingRim, expected",
    ),
    "what is no body": (lambda: ct.run([3.0], **RUNS), "bodies: found float, expected Rod, PointMass or Wall"),
    "instants before the start": (lambda: ct.Record(at=[-1.0]), "expected instants >= 0 [s]"),
    "instants beside steps": (lambda: ct.Record(at=[1.0], every=2), "at: found with every or state_every"),
    "places and values": (
        lambda: ct.Speed(time=[0.0, 1.0], hz=[1.0]),
        "speed: found (2,) places and (1,) values, expected equal numbers",
    ),
    "modes of a rod that gain": (lambda: ct.gaps.rod_modes(ROD, zeta=-0.01), "zeta: found -0.01, expected"),
    "no modes of a rod": (lambda: ct.gaps.rod_modes(ROD, modes=0), "modes: found 0, expected"),
    "no tips": (lambda: ct.Rub(rim3(), (nodes(1),), ()), "tips: found 0 on 1 blades, expected one or more"),
    "a thickness": (
        lambda: ct.Rub(rim3(), (nodes(1),), tips(1), thickness=-1.0),
        "thickness: found -1.0, expected metres > 0",
    ),
    "no axial channels": (
        lambda: ct.Rub(ring(), (nodes(1),), tips(1)),
        "tips[0].axial: found a casing basis without axial channels, expected Rim(axial=True)",
    ),
    "a consistent mass": (
        lambda: ct.run(consistent(), scheme=ct.CentralDifference(), **RUNS),
        "M: found a consistent mass matrix, expected a lumped one",
    ),
    "coupled damping": (
        lambda: ct.run(
            replace(FRAME, C=np.array([[1.0, 0.2], [0.2, 1.0]])), scheme=ct.scheme.MasslessBoundary(), **RUNS
        ),
        "expected lumped mass and damping",
    ),
    "a law of springs": (
        lambda: ct.run(RIM, law=ct.laws.AugmentedLagrangian(stiffness=1e6), scheme=ct.ExactModal(), **RUNS),
        "law: found AugmentedLagrangian",
    ),
    "friction on rods": (
        lambda: ct.run(FRAME, law=ct.Coulomb(mu=0.1), scheme=ct.CentralDifference(), **RUNS),
        "law: found Coulomb",
    ),
    "averages over several contacts": (
        lambda: ct.run(ct.Patch(body=BODY, normal=("x", "y")), scheme=ct.ExactModal(law="averaged"), **RUNS),
        "with several contacts, expected 'forward' or 'auto'",
    ),
    "friction without a ground": (
        lambda: ct.run(ct.Patch(body=BODY, normal=("x",)), law=ct.Coulomb(mu=0.1), scheme=ct.ExactModal(), **RUNS),
        "law: found Coulomb friction on a Patch without tangent, expected tangent channels",
    ),
    "a damped rod by its modes": (
        lambda: ct.run(
            [ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, damping=0.1, x=1.0), ct.Wall()],
            scheme=ct.ExactModal(),
            **RUNS,
        ),
        "damping: found viscous damping of a body, expected none for ExactModal",
    ),
    "a damped mass by its mode": (
        lambda: ct.run([ct.PointMass(mass=1.0, damping=0.1, x=1.0), ct.Wall()], scheme=ct.ExactModal(), **RUNS),
        "damping: found viscous damping of a body, expected none for ExactModal",
    ),
    "a driven mass by its mode": (
        lambda: ct.run([ct.PointMass(mass=1.0, force=0.1, x=1.0), ct.Wall()], scheme=ct.ExactModal(), **RUNS),
        "force: found a varying force, expected a constant",
    ),
    "a rod held where it meets": (
        lambda: ct.run(
            [ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="left", x=1.0), ct.Wall()],
            scheme=ct.ExactModal(),
            **RUNS,
        ),
        "fixed",
    ),
    "three bodies by their modes": (
        lambda: ct.run([ct.PointMass(mass=1.0, x=float(k)) for k in range(3)], scheme=ct.ExactModal(), **RUNS),
        "bodies: found 3, expected two for the exact-modal scheme",
    ),
    "a displacement that leaves the gap": (
        lambda: ct.gaps.Side(body=BODY, channel="x", sign=0),
        "sign: found 0, expected 1 (opens the gap) or -1 (closes it)",
    ),
    "a displacement that counts twice": (
        lambda: ct.gaps.Side(body=BODY, channel="x", sign=2),
        "sign: found 2, expected 1 (opens the gap) or -1 (closes it)",
    ),
    "a length of no number": (lambda: replace(ROD, length=np.nan), "length: found nan, expected a finite number > 0"),
    "a length below zero": (lambda: replace(ROD, length=-1.0), "length: found -1.0, expected a finite number > 0"),
    "a ring of fewer than no waves": (lambda: ct.bodies.ring_modes(RING, -1), "n_max: found -1, expected a whole"),
    "a ring of parts of waves": (lambda: ct.bodies.ring_modes(RING, 2.5), "n_max: found 2.5, expected a whole"),
    "elements that show fewer than no waves": (
        lambda: ct.bodies.ring_elements(RING, 10, n_max=-1),
        "n_max: found -1, expected a whole number >= 0",
    ),
    "parts of elements": (
        lambda: ct.bodies.ring_elements(RING, 3.5, n_max=2),
        "elements: found 3.5, expected a whole number >= 1",
    ),
    "what a motion varies over": (
        lambda: random_body(1, 1).over("mass", freq_hz=0.2),
        "name: found 'mass', expected 'freq_hz', 'amplitude' or 'clearance'",
    ),
    "what a rub varies over": (
        lambda: ct.cycles.RimFamily(rim=RIM, name="mass"),
        "name: found 'mass', expected 'speed_hz', 'clearance' or 'friction'",
    ),
    "dangerous speeds of a bare rim": (
        lambda: ct.interactions(ct.Scene(what=[RIM], t_end=1.0), [1.0, 2.0]),
        "scene: found list, expected a scene with a RotatingRim, a Rub or a Rotor",
    ),
    "dangerous speeds without an end": (
        lambda: ct.interactions(ct.Scene(what=RIM, dt=1e-5), [1.0, 2.0]),
        "t_end: found none, expected the end of the runs in seconds",
    ),
    "dangerous speeds of one run": (
        lambda: ct.interactions(ct.Scene(what=RIM, t_end=1.0, dt=1e-5), [1.0, 2.0], runs=1),
        "runs: found 1, expected at least 2: one at each end of the range",
    ),
    "forces on what is not there": (
        lambda: ct.recovery.rub_forces(RIM, None, "blades"),
        "name: found 'blades', expected one of casing, blade (did you mean blade?)",
    ),
    "forces on a blade too many": (
        lambda: ct.recovery.rub_forces(ct.Rub(rim3(), (nodes(1),) * 2, tips(1)), None, "blade 3"),
        "name: found 'blade 3', expected one of casing, blade 1, blade 2",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_input_is_refused(name):
    make, words = REFUSED[name]
    with pytest.raises((ct.InputError, ct.LimitError, ValueError)) as caught:
        make()
    assert words in str(caught.value)
