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
WAVE = ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0)
ROD = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="right")
RUNS = {"t_end": 1e-3, "dt": 1e-5}


def consistent():
    """A body too large for its mass matrix to be factored at every step."""
    size = 201
    M = diags_array([np.full(size, 2.0), np.ones(size - 1), np.ones(size - 1)], offsets=[0, 1, -1], format="csr")
    return ct.LinearBody(M=M, K=M, Q=csr_array(([1.0], ([0], [0])), shape=(1, size)), gap0=np.array([0.1]))


def matrices(**more):
    return ct.ModalBody.from_matrices(PAIR, PAIR, **({"dofs": [(1, "x"), (2, "x")], "contact": [1]} | more))


R = ct.rotor
XYZ = [(1, "x"), (1, "y"), (1, "z")]
RUB = R.rotor_rub(
    R.Rotor.of(R.Jeffcott(mass=10.0, stiffness=4e6), 60.0, unbalance=R.Unbalance(moment=1e-3)),
    R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1), [R.rigid_tip()], clearance=5e-4,
)  # fmt: skip
TWO_TIPS = ct.Rub(
    ring(), (blade(), blade()), [ct.ContactPoint(), ct.ContactPoint(blade=1, angle_deg=90.0)], clearance=-1e-5
)


def shaft(**more):
    ends = [R.Bearing(at=at, kxx=2e7) for at in (0.0, 0.6)]
    disk = R.Disk(at=0.4, mass=2.0, polar=0.04, diametral=0.02)
    piece = R.Piece(length=0.6, diameter=0.06, elements=3)
    return R.Shaft(**({"pieces": [piece], "disks": [disk], "bearings": ends} | more))


def implicit(K, size=2):
    """A step of a body whose stiffness matrix cannot be that of a structure."""
    body = ct.LinearBody(
        M=np.ones(size), K=K, Q=csr_array(([1.0], ([0], [0])), shape=(1, size)), gap0=np.array([0.1])
    )  # fmt: skip
    return ct.run(body, scheme=ct.scheme.HHT(alpha=-0.1), t_end=2e-3, dt=1e-3)


def spread(size=700):
    """A stiffness with entries all over, so that it is factored by entries; two of them attract each other."""
    K = diags_array([np.full(size, 2.0), -np.ones(size - 1), -np.ones(size - 1)], offsets=[0, 1, -1], format="lil")
    for a, b in np.random.default_rng(3).integers(size, size=(900, 2)).tolist():
        K[a, a], K[b, b] = K[a, a] + 0.4, K[b, b] + 0.4
        K[a, b], K[b, a] = K[a, b] - 0.3, K[b, a] - 0.3
    K[5, 6], K[6, 5] = -1e9, -1e9
    return K.tocsr()


def full(values):
    return csc_array(np.asarray(values, dtype=float))


def by_events(S):
    patch = ct.Patch(body=replace(BODY, S=S), normal=("x", "y"))
    return ct.run(patch, scheme=ct.scheme.EventDriven(), t_end=1e-2, dt=1e-3)


def one_case(what, speeds):
    cases = ct.stability.Cases(casing=np.ones((1, len(ring().omega))), blade=np.ones(1), mu=np.zeros(1))
    return ct.stability.growth_of_cases(what, np.array(speeds), cases)


REFUSED = {
    "a stiffness too large to multiply": (
        lambda: replace(ROD, E=1e200),
        "E: found 1e+200, expected a number between 1e-60 and 1e+60",
    ),
    "a stiffness too small to multiply": (lambda: replace(ROD, E=1e-200), "E: found 1e-200, expected a number between"),
    "a negative stiffness": (
        lambda: implicit(np.diag([2.0, -1e9])),
        "M + h C + h^2 K: found -271.25 on the diagonal, expected entries > 0",
    ),
    "an indefinite stiffness of a band": (
        lambda: implicit(np.array([[2.0, 5e9], [5e9, 2.0]])),
        "M + h C + h^2 K: found a matrix that is not positive definite (2-th leading minor",
    ),
    "an indefinite stiffness by entries": (
        lambda: implicit(spread(), 700),
        "M + h C + h^2 K: found a matrix that is not positive definite, pivot -",
    ),
    "axes that are no unit vectors": (
        lambda: matrices(axes={1: 2.0 * np.eye(3)}),
        "axes: found [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]] at node 1, expected three unit vectors",
    ),
    "left-handed axes": (lambda: matrices(axes={2: np.diag([1.0, 1.0, -1.0])}), "at node 2, expected three unit"),
    "a mass between dofs beyond theirs": (
        lambda: ct.ModalBody.from_matrices(full([[1.0, 2.0], [2.0, 1.0]]), PAIR, dofs=XYZ[:2], contact=[1]),
        "M: found 2 between 1.y and 1.x, more than the diagonal entries allow",
    ),
    "masses of which a motion has none": (
        lambda: ct.ModalBody.from_matrices(full(1.9 * np.eye(3) - 0.9), csc_array(np.eye(3)), dofs=XYZ, contact=[1]),
        "M: found negative modal masses, expected a mass matrix without negative eigenvalues",
    ),
    "structural damping beyond all": (
        lambda: matrices(K4=3.0 * PAIR),
        "K4: found a damping ratio of 1.5 in mode 1, expected less than 1",
    ),
    "structural damping that drives": (
        lambda: matrices(K4=-0.01 * PAIR),
        "K4: found negative damping in mode 2, expected damping that dissipates energy",
    ),
    "a stiffness of matrices that is negative": (
        lambda: ct.ModalBody.from_matrices(PAIR, full(np.diag([1.0, -2.0])), dofs=XYZ[:2], contact=[1]),
        "K: found an indefinite or singular stiffness, expected one without negative modes",
    ),
    "a frequency that underflows": (
        lambda: replace(BODY, omega=[1e-200, 2.0]),
        "omega: found 1e-200 rad/s, expected 0, a rigid motion, or >= 1e-50",
    ),
    "contacts of one compliance by events": (
        lambda: by_events(np.ones((2, 2))),
        "S: found a singular compliance of the contacts, expected a positive definite one",
    ),
    "a rotor of channels without a node": (
        lambda: R.Rotor.of(BODY, 60.0, unbalance=R.Unbalance(moment=1e-3)),
        "channels: found x, y, expected x and y of a node, such as 6.x and 6.y",
    ),
    "a shaft of too many elements": (
        lambda: shaft(pieces=[R.Piece(length=0.6, diameter=0.06, elements=9999)]),
        "pieces: found 10000 nodes, expected at most 400; use fewer elements",
    ),
    "a place between nodes": (
        lambda: shaft().node(0.123),
        "at: found 0.123 m, expected a node: 0, 0.2, 0.4, 0.6 m",
    ),
    "more modes than a shaft has": (
        lambda: R.Rotor.of(shaft(), 60.0, modes=99),
        "modes: found 99, expected 1 to 16, the modes of the shaft",
    ),
    "gravity on a rotor that tips over": (
        lambda: ct.run(
            R.Rotor.of(shaft(bearings=[R.Bearing(at=0.0, kxx=1.0, kyy=1.0)]), 60.0, gravity=9.8), t_end=1e-3, dt=1e-4
        ),
        "gravity: found a rotor without support, expected a bearing, or gravity = 0",
    ),
    "speeds of whirl in two rows": (
        lambda: R.campbell(RUB.rotor, [[1.0], [2.0]]),
        "speed_hz: found [[1.0], [2.0]], expected a list of finite speeds",
    ),
    "forces of supports without states": (
        lambda: ct.recovery.support_forces(RUB, ct.run(RUB, t_end=1e-3, dt=1e-4, record=ct.Record(every=1))),
        "state: found none in the result, expected a record with state_every",
    ),
    "forces of supports without participation": (
        lambda: ct.recovery.support_forces(replace(RUB, casing=replace(RUB.casing, participation=None)), None),
        "participation: found none in the bases of rotor and casing, expected one in each",
    ),
    "stability of a rotor at rest": (
        lambda: ct.stability.rotor_stability(RUB.rotor, [0.0, 1.0]),
        "speed_hz: found 0 turns/s, expected speeds above 0",
    ),
    "stability of no rotor": (
        lambda: ct.stability.rotor_stability(ct.Rub(rim3(), (nodes(1),), tips(1)), [1.0, 2.0]),
        "rub: found one without a rotor, expected one of ct.rotor.rotor_rub",
    ),
    "dangerous speeds of a rotor at rest": (
        lambda: ct.interactions(ct.Scene(what=RUB.rotor, t_end=1.0, dt=1e-4), [0.0, 10.0], runs=2),
        "speed_hz: found 0 Hz, expected speeds above 0",
    ),
    "the slope of a law without one": (
        lambda: ct.stability.slope_of(ct.Unilateral()),
        "law: found Lagrange, expected a law with a response: Hertz, ForceTable, ForceLaw or Penalty",
    ),
    "varied contacts of two tips": (lambda: one_case(TWO_TIPS, [1.0, 2.0]), "tips: found 2 contacts, expected one"),
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
    "values of a law of no number": (
        lambda: ct.laws.Response(ct.Penalty(stiffness=1e6).response.function, [1.0, np.nan, 2.0]),
        "expected a list of finite numbers",
    ),
    "pairs of other waves": (
        lambda: ct.gaps.disk_contact(WAVE, replace(WAVE, n=3), stiffness=1e5, blades=9),
        "n: found casing 2, disk 3, 9 blades, expected the same n >= 1 for both pairs and more than 2 n blades",
    ),
    "waves that the blades do not distinguish": (
        lambda: ct.gaps.disk_contact(WAVE, WAVE, stiffness=1e5, blades=4),
        "n: found casing 2, disk 2, 4 blades, expected the same n >= 1",
    ),
    "pairs without waves": (
        lambda: ct.gaps.disk_contact(replace(WAVE, n=0), replace(WAVE, n=0), stiffness=1e5, blades=4),
        "n: found casing 0, disk 0, 4 blades",
    ),
    "a contact that attracts": (
        lambda: ct.gaps.disk_contact(WAVE, WAVE, stiffness=-1e5, blades=9),
        "stiffness: found -100000.0",
    ),
    "a force on what turns in a rub where it is at rest": (
        lambda: ct.Rub(
            replace(ring(), participation=np.ones((3, 10))),
            (blade(),),
            [ct.ContactPoint()],
            clearance=1e-4,
            forces=[ct.gaps.BodyForce(on="casing", acceleration=1.0, casing_turns=True)],
        ),
        "forces: found a force with turning = 'casing', expected turning = 'blades' as in the rub",
    ),
    "so slow a turn": (
        lambda: ct.stability.floquet_growth(RIM, np.array([1e-7]), mu=0.1),
        "steps a turn, expected at most",
    ),
    "a rotor in a casing that does not move to the side": (
        lambda: ct.stability.rotor_stability(
            R.rotor_rub(RUB.rotor, ring(), [R.rigid_tip()], clearance=5e-4), [10.0, 20.0]
        ),
        "casing: found no pair of modes of one nodal diameter, expected one: keep more modes",
    ),
    "rigid contacts that overlap by events": (
        lambda: ct.run(
            ct.Patch(body=replace(BODY, S=np.zeros((2, 2))), normal=("x", "y"), clearance=0.5, pressed=[0.0, -1.0]),
            scheme=ct.scheme.EventDriven(),
            t_end=1e-2,
            dt=1e-3,
        ),
        "clearance: found -0.5 m at a rigid contact, expected >= 0",
    ),
    "damping of a rigid motion by events": (
        lambda: ct.run(
            ct.Patch(
                body=replace(BODY, omega=[0.0, 2.0], damping=np.array([[0.5, 0.0], [0.0, 0.0]]), S=1e-6 * np.eye(2)),
                normal=("x", "y"),
                clearance=1.0,
            ),
            scheme=ct.scheme.EventDriven(),
            t_end=1e-2,
            dt=1e-3,
        ),
        "damping: found damping of a rigid motion, expected none",
    ),
    "a damping by events that is not symmetric": (
        lambda: ct.run(
            ct.Patch(
                body=replace(BODY, damping=np.array([[0.5, 0.1], [0.0, 0.5]]), S=1e-6 * np.eye(2)),
                normal=("x", "y"),
                clearance=1.0,
            ),
            scheme=ct.scheme.EventDriven(),
            t_end=1e-2,
            dt=1e-3,
        ),
        "damping: found a matrix that is not symmetric, expected a symmetric one for EventDriven",
    ),
    "rigid contacts by events that depend on each other": (
        lambda: ct.run(
            ct.Patch(body=replace(BODY, rows=np.ones((2, 2)), S=np.zeros((2, 2))), normal=("x", "y"), clearance=1.0),
            scheme=ct.scheme.EventDriven(),
            t_end=1e-2,
            dt=1e-3,
        ),
        "contact: found linearly dependent rigid contacts, expected a compliance",
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
