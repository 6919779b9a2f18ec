"""Bounds of what is taken: the value just inside is, the one just outside is refused in words."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

BODY = {"omega": [2.0], "zeta": [0.0], "channels": ("x",), "rows": [[1.0]], "S": [[1e-3]]}
ROD = {"length": 1.0, "area": 1.0, "E": 1.0, "rho": 1.0, "elements": 4}
BEAM = ct.bodies.HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, torque=1.0, elements=4)
STABLE = 2.0 / BEAM.omega_max()
COATING = ct.Abradable(E=1e9, yield_stress=2e4, hardening=1e6, thickness=1e-3, width=0.02, tip=6e-3)
THIN = {"width": 0.02, "height": 0.005, "E": 210e9, "rho": 7800.0, "k_r": 1e6, "k_t": 1e5}


def body(**changes):
    return ct.ModalBody(**BODY | changes)


def side(**changes):
    return ct.gaps.Side(body=body(**changes), channel="x", sign=1)


def rod(**changes):
    return ct.Rod(**ROD | changes)


def mass(**changes):
    return ct.PointMass(**{"mass": 1.0, "x": -0.1, "velocity": 1.0} | changes)


def beam(**changes):
    return ct.bodies.BeamInCircle(BEAM, **{"radius": 0.51} | changes)


def rim(radius):
    return ct.bodies.ring_modes(ct.bodies.ThinRing(radius=radius, **THIN), 2)


def rim_elements(elements, n_max):
    return ct.bodies.ring_elements(ct.bodies.ThinRing(radius=0.51, **THIN), elements, n_max)


def linear_body(skew=0.0, gap=0.1, row=1.0):
    K = np.array([[2.0, 1.0 + skew], [1.0, 2.0]])
    return ct.LinearBody(M=np.ones(2), K=K, Q=np.array([[row, 0.0]]), gap0=np.array([gap]))


def patch(normal=("x", "y"), tangent=()):
    return ct.Patch(body=body(channels=("x", "y"), rows=[[1.0], [0.5]], S=np.eye(2)), normal=normal, tangent=tangent)


def modal(*bodies, scheme=ct.ExactModal, law=None, t_end=0.2, **changes):
    return ct.run(bodies, scheme=scheme(modes=3), t_end=t_end, law=law, **changes)


def linear(*bodies, scheme=ct.CentralDifference, **changes):
    return ct.run(bodies, scheme=scheme(), t_end=0.2, **changes)


def gap(scheme=ct.ExactModal, dt=None, t_end=0.2, **changes):
    return ct.run(ct.PointGap(sides=(side(**changes),), clearance=1.0), scheme=scheme(), t_end=t_end, dt=dt)


def prepared(scheme, problem, law=None, dt=0.1, courant=None):
    return scheme.prepare(problem, law or ct.Unilateral(), dt=dt, courant=courant)


def one_gap(law=None, **step):
    return prepared(ct.ExactModal(), ct.PointGap(sides=(side(),), clearance=1.0), law, **step)


def orbit(**changes):
    given = {"omega": 1.0, "drive": 1.0, "drive_omega": 2.0, "gap": 0.0, "restitution": 0.5}
    return ct.reference.driven_orbit(**given | changes)


def driven(S, stiffness=math.inf, **changes):
    two = body(channels=("x", "y"), rows=[[1.0], [0.5]], S=S)
    patch = ct.Patch(body=two, normal=("x", "y"), clearance=0.1)
    return ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.1, **{"stiffness": stiffness} | changes)


def pair(n=2, of_blade=0, lean_deg=0.0):
    casing = ct.gaps.ModalPair(n=n, freq_hz=300.0, modal_mass=1.5)
    return ct.gaps.HandPair(
        casing=casing,
        blade=ct.gaps.ModalPair(n=of_blade, freq_hz=120.0, modal_mass=0.4),
        compliance=1e-4,
        lean_deg=lean_deg,
    )


def turning(S):
    rim = ct.RotatingRim(ring(S=S), blade(S=0.0), clearance=0.0, speed_hz=5.0)
    return ct.stability.of_rim(rim, np.array([5.0, 6.0]))


def characteristics(**changes):
    return ct.reference.impact_by_characteristics(mass(x=0.0, **changes), rod(), dt=0.25, t_end=1.0)


def ends(**changes):
    return ct.reference.impact_by_characteristics(rod(x=-1.0, velocity=1.0), rod(**changes), dt=0.25, t_end=1.0)


def beam_step(circle, dt, courant):
    return ct.CentralDifference().prepare(circle, ct.Unilateral(), dt=dt, courant=courant)


def require_term(term):
    return ct.gaps.RimProfile.fourier([term])


TAKEN, REFUSED = 0, 1
BOUNDS = {
    "beam.offset": (lambda k: beam(radius=0.51, offset=(0.01, 0.51)[k]), r"offset: found 0\.51 m, expected less than"),
    "beam.start": (lambda k: beam(radius=(0.5, 0.499)[k]), r"beam: node \d starts 0\.001 m outside the circle"),
    "ring.above": (lambda k: beam(ring=rim((0.56, 0.562)[k])), r"ring: found radius 0\.562 m, expected about 0\.51"),
    "ring.below": (lambda k: beam(ring=rim((0.46, 0.458)[k])), r"ring: found radius 0\.458 m, expected about 0\.51"),
    "beam.implicit": (
        lambda k: ct.scheme.Newmark().prepare(beam(), ct.Unilateral(), dt=(1e-4, None)[k], courant=None),
        "dt: found none, expected a time step in seconds",
    ),
    "rod.fixed": (lambda k: rod(fixed=("left", "middle")[k]), "fixed: found 'middle', expected 'none', 'left' or"),
    "rod.end_mass": (
        lambda k: linear(*[ct.Wall(x=-1.0)] * k, rod(end_mass=1.0), ct.Wall(x=2.0), courant=0.5),
        "end_mass: found one on a free rod between two bodies",
    ),
    "retuned": (lambda k: body(omega=[(2.0, 0.0)[k]]).retuned(1.0), "freq_hz: found a body of rigid modes only"),
    "term.key": (lambda k: require_term({"p": 2, ("cos", "cosine")[k]: 0.1}), "found keys .'cosine', 'p'., expected p"),
    "term.p": (lambda k: require_term({"p": (0, -1)[k], "cos": 0.1}), "out_of_roundness"),
    "term.none": (lambda k: require_term([{"p": 1}, {"cos": 1.0}][k]), "expected p and cos and/or sin"),
    "term.whole": (lambda k: require_term({"p": (2.0, 2.5)[k]}), "out_of_roundness"),
    "sides.none": (lambda k: ct.PointGap(sides=(side(),) * (1, 0)[k]), "sides: found 0, expected one"),
    "sides.many": (lambda k: ct.PointGap(sides=(side(),) * (2, 3)[k]), "sides: found 3, expected one"),
    "modal.damping": (lambda k: modal(mass(damping=(0.0, 0.1)[k]), rod()), "damping: found viscous damping of a body"),
    "modal.rod": (lambda k: modal(mass(), rod(damping=(0.0, 0.1)[k])), "damping: found viscous damping of a body"),
    "modal.force": (
        lambda k: modal(mass(force=(0.0, 0.1)[k]), rod()),
        "force: found a varying force, expected a constant",
    ),
    "modal.fixed": (
        lambda k: modal(mass(), rod(fixed=("right", "left")[k])),
        "fixed: found 'left' on the rod's contact end",
    ),
    "closing": (
        lambda k: ct.gaps.Closing.exponential(1e-4, (1e-3, 0.0)[k]),
        r"time_constant: found 0\.0, expected seconds",
    ),
    "closing.inf": (lambda k: ct.gaps.Closing.exponential(1e-4, (1e3, math.inf)[k]), "time_constant: found inf"),
    "closing.sizes": (
        lambda k: ct.gaps.Closing([0.0, 1.0], ([0.0, 1.0], [0.0])[k]),
        "closing: found .2,. places and .1,.",
    ),
    "closing.order": (
        lambda k: ct.gaps.Closing([0.0, (0.1, 0.0)[k]], [0.0, 1.0]),
        "closing: found 0 after 0, expected asc",
    ),
    "closing.nan": (
        lambda k: ct.gaps.Closing([0.0, 1.0], [0.0, (1.0, math.nan)[k]]),
        "closing: found values that are NaN",
    ),
    "whirl": (
        lambda k: ct.gaps.Whirl(amplitude=(0.0, -1e-9)[k]),
        "amplitude: found -1e-09, expected a finite number >= 0",
    ),
    "profile": (
        lambda k: ct.gaps.RimProfile((), [0.0, 1.0, 2.0], ([0.0] * 3, None)[k]),
        "found one of theta and depth",
    ),
    "profile.few": (
        lambda k: ct.gaps.RimProfile((), [0.0, 1.0, 2.0][: 3 - k], [0.0] * (3 - k)),
        "found 2 angles over 1 rad, expected th",
    ),
    "profile.turn": (
        lambda k: ct.gaps.RimProfile((), [0.0, 1.0, (6.28, 6.29)[k]], [0.0] * 3),
        "found 3 angles over 6.29",
    ),
    "stop": (
        lambda k: ct.reference.stopped_period(1.0, (-1.0, -1.01)[k], 1.0),
        "gap: found -1.01 m with amplitude 1 m",
    ),
    "waves.spring": (lambda k: characteristics(stiffness=(0.0, 1.0)[k]), "mass: found a spring, dashpot or force"),
    "waves.dashpot": (lambda k: characteristics(damping=(0.0, 1.0)[k]), "mass: found a spring, dashpot or force"),
    "waves.force": (lambda k: characteristics(force=(0.0, 1.0)[k]), "mass: found a spring, dashpot or force"),
    "waves.end": (lambda k: ends(end_mass=(0.0, 1.0)[k]), "rod: found an end mass or damping"),
    "waves.damping": (lambda k: ends(damping=(0.0, 1.0)[k]), "rod: found an end mass or damping"),
    "waves.whole": (lambda k: ends(length=(2.0, 2.1)[k]), "whole"),
    "courant.rods": (lambda k: linear(mass(), (rod(), ct.Wall())[k], courant=0.5), "courant: found a scene without"),
    "courant.rigid": (lambda k: modal(mass(), (rod(), ct.Wall())[k]), "dt: found none with rigid bodies only"),
    "energy.zeta": (
        lambda k: gap(lambda: ct.ExactModal(law="energy"), 0.1, zeta=[(0.0, 1e-9)[k]]),
        "'energy' with damped modes",
    ),
    "slow": (
        lambda k: gap(lambda: ct.ExactModal(law="forward"), (1.25, 1.2501)[k], t_end=3.0),
        r"dt = 2.5002, .*use dt <= 1.249 s",
    ),
    "linear": (
        lambda k: gap((ct.ExactModal, ct.MoreauJean)[k], 0.01),
        "scheme: found MoreauJean for PointGap, expected Exact",
    ),
    "cycles.coupled": (
        lambda k: driven([[1e-3, (0.0, 1e-12)[k]], [(0.0, 1e-12)[k], 0.0]]),
        "S: found a zero on the diagonal",
    ),
    "cycles.depend": (
        lambda k: driven([[1e-3, 1e-3], [1e-3, 1e-3 * (1.01, 1.0)[k]]]),
        "S: found a singular compliance",
    ),
    "cycles.stiffness": (lambda k: driven(np.eye(2), (1e-9, 0.0)[k]), "stiffness: found 0 N/m, expected > 0"),
    "cycles.above": (lambda k: driven(np.eye(2), restitution=(1.0, 1.01)[k]), "restitution: found .* expected 0 to 1"),
    "cycles.below": (lambda k: driven(np.eye(2), restitution=(0.0, -0.01)[k]), "restitution: found .* expected 0 to 1"),
    "cycles.looks": (
        lambda k: driven(np.eye(2)).over("freq_hz", freq_hz=1.0, looks=(8, 7)[k]),
        "looks: found 7, expected a whole",
    ),
    "pair.n": (lambda k: pair(n=(1, 0)[k]), "casing.n: found 0, expected at least 1"),
    "pair.blade": (lambda k: pair(of_blade=(0, 1)[k]), "blade.n: found 1, expected 0"),
    "pair.lean": (lambda k: pair(lean_deg=(89.9, 90.0)[k]), "lean_deg: found 90.0, expected an angle between"),
    "pair.back": (lambda k: pair(lean_deg=(-89.9, -90.0)[k]), "lean_deg: found -90.0, expected an angle between"),
    "floquet": (lambda k: turning((1e-8, 0.0)[k]), "S: found 0 m/N"),
    "beam.torque": (lambda k: replace(BEAM, torque=(-1.0, math.nan)[k]), "torque: found nan, expected a finite numb"),
    "beam.angle": (lambda k: replace(BEAM, angle_deg=(-400.0, -math.inf)[k]), "angle_deg: found -inf, expected a fini"),
    "beam.spin": (lambda k: replace(BEAM, spin=(-1.0, math.inf)[k]), "spin: found inf, expected a finite number$"),
    "beam.never": (
        lambda k: beam(radius=0.5 + (0.99, 1.0)[k] / 128, offset=1 / 128).first_contact_angle,
        r"radius: found 0.507812 m, expected between 0\.492188 and 0\.507812 m for the tip to meet it",
    ),
    "beam.always": (
        lambda k: beam(radius=0.5 - (0.99, 1.0)[k] / 128, offset=1 / 128).first_contact_angle,
        r"radius: found 0.492188 m, expected between 0\.492188 and 0\.507812 m for the tip to meet it",
    ),
    "beam.centred": (
        lambda k: beam(radius=0.505, offset=(0.01, 0.0)[k]).first_contact_angle,
        r"expected between 0\.5 and 0\.5 m for",
    ),
    "beam.neither": (lambda k: beam_step(beam(), (1e-6, None)[k], None), "dt: found both or neither of dt and courant"),
    "beam.both": (lambda k: beam_step(beam(), (None, 1e-6)[k], 0.5), "dt: found both or neither of dt and courant"),
    "beam.dt": (
        lambda k: beam_step(beam(), STABLE * (1.0 + (0.9e-9, 1.1e-9)[k]), None),
        r"dt \* omega_max = 2\.0000000022, expected <= 2 .*: use dt <= 1\.3905\d+e-05",
    ),
    "beam.courant": (lambda k: beam_step(beam(), None, (1.0, 1.01)[k]), r"dt \* omega_max = 2\.02, expected <= 2"),
    "beam.friction": (
        lambda k: prepared(ct.CentralDifference(), beam(), (ct.Unilateral(), ct.Coulomb(mu=0.1))[k], 1e-6),
        r"law: found Coulomb\(mu=0\.1\), expected Unilateral\(\) for a beam in a circle$",
    ),
    "elements.waves": (
        lambda k: rim_elements(4, (4, 5)[k]),
        "elements: found 4 for n_max = 5, expected at least n_max, and 3$",
    ),
    "elements.few": (lambda k: rim_elements((3, 2)[k], 1), "elements: found 2 for n_max = 1, expected at least n_max"),
    "linear.skew": (
        lambda k: linear_body(skew=(1.9e-9, 2.2e-9)[k]),
        "K: found an asymmetry of 1.1e-09 of the largest entry, expect",
    ),
    "linear.gap": (
        lambda k: linear_body(gap=-(0.9e-12, 1.1e-12)[k]),
        "gap0: contact 1 penetrates by 1.1e-12 m at t = 0, expected",
    ),
    "linear.rows": (
        lambda k: linear_body(row=(-1.0, -math.inf)[k]),
        "Q: found entries that are NaN or infinite, expected finite",
    ),
    "patch.none": (lambda k: patch(("x",)[k:]), "normal: found no channel, expected one for each contact$"),
    "patch.few": (lambda k: patch(tangent=(("y",), ("x",))[k:]), "tangent: found 1 entries of 1 channels, exp"),
    "patch.no_each": (lambda k: patch(tangent=(("y",)[k:],) * 2), "found 2 entries of 0, 0 channels, exp"),
    "patch.three_each": (
        lambda k: patch(tangent=(("y", "x") + ("x",) * k,) * 2),
        "tangent: found 2 entries of 3, 3 channels, exp",
    ),
    "patch.mixed": (
        lambda k: patch(tangent=(("y",), (("x",), ("x", "y"))[k])),
        "tangent: found 2 entries of 1, 2 channels, exp",
    ),
    "bars": (
        lambda k: replace(COATING, bars=10000 + k),
        r"bars: found 10001, expected a whole number from 1 to 10,000",
    ),
    "bouncing": (lambda k: ct.reference.bouncing_bar(1 - k), "contacts: found 0, expected a whole number >= 1$"),
    "orbit": (
        lambda k: orbit(drive_omega=2.7, gap=1.0 / (2.7**2 - 1.0) - (1e-9, -1e-9)[k]),
        r"drive: found 1 m/s\^2, expected a drive that reaches the stop in every period$",
    ),
    "orbit.never": (lambda k: orbit(gap=(0.0, 9.0)[k]), r"drive: found 1 m/s\^2, expected a drive that reaches"),
    "run.end": (
        lambda k: ct.run([mass(x=0.5, velocity=0.0), ct.Wall()], dt=0.1, **({"t_end": 0.1}, {})[k]),
        "t_end: found none, expected the end of the run in seconds$",
    ),
    "modal.law": (
        lambda k: ct.ExactModal(law=("energy", "midpoint")[k]),
        "law: found 'midpoint', expected one of 'auto', 'forward', 'averaged', 'energy'$",
    ),
    "modal.dt": (
        lambda k: one_gap(dt=(None, 0.1)[k], courant=0.1),
        "dt: found both dt and courant, expected one of them$",
    ),
    "modal.friction": (
        lambda k: one_gap(ct.Coulomb(mu=(0.0, 1e-9)[k])),
        "law: found Coulomb friction on a scene without tangential motion, expected a rim$",
    ),
    "modal.energy": (
        lambda k: prepared(ct.ExactModal(law=("forward", "energy")[k]), ct.Rub(rim3(), (nodes(1),), tips(1)), dt=1e-5),
        "law: found 'energy' on a rotating rim, expected 'auto', 'forward' or 'averaged'$",
    ),
}


@pytest.mark.parametrize("name", BOUNDS)
def test_just_inside_is_taken_and_just_outside_refused(name):
    made, words = BOUNDS[name]
    made(TAKEN)
    with pytest.raises(ct.InputError, match=words):
        made(REFUSED)


def test_a_circle_is_met_at_a_right_angle_where_its_radius_is_a_hypotenuse():
    """The tip is above the hinge, as far from the centre as Pythagoras says."""
    assert beam(radius=math.hypot(0.5, 0.12), offset=0.12).first_contact_angle == pytest.approx(math.pi / 2, rel=1e-12)


def test_the_stops_of_a_drive_at_twice_the_frequency_are_met_by_a_closed_form():
    """tan(omega T/2) is infinite: V = 2 drive_omega |G| / (1 - e) at a stop where the spring is at rest."""
    assert orbit().speed == pytest.approx(2.0 * 2.0 / 3.0 / 0.5, rel=1e-12)
