"""Numbers held: every scheme on coupled, damped, driven coordinates between stops, on rods, rims and rubs."""

import math

import numpy as np
import pytest

import contact as ct
from tests.contact.held_runs import numbers_of
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

pytestmark = pytest.mark.slow  # they run compiled loops
WAVES = [{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]
OFTEN = ct.Record(every=7, state_every=14)
SCHEMES = [
    ct.CentralDifference(),
    ct.scheme.CDLagrange(),
    ct.scheme.PaoliSchatzman(restitution=0.3),
    ct.scheme.MasslessBoundary(),
    ct.scheme.Newmark(beta=0.5, gamma=0.55),
    ct.scheme.HHT(alpha=-0.3),
    ct.MoreauJean(theta=0.7, restitution=0.5),
    ct.scheme.StabilisedNewmark(),
    ct.scheme.NonsmoothAlpha(rho_inf=0.6),
    ct.scheme.ProjectedAlpha(rho_inf=0.6),
]
SOFT = {"E": 1e9, "yield_stress": 2e4, "hardening": 1e6, "thickness": 1e-3, "width": 0.02, "tip": 6e-3, "bars": 2}


def frame():
    K = np.array([[30.0, -10.0, 0.0], [-10.0, 30.0, -20.0], [0.0, -20.0, 20.0]])
    return ct.LinearBody(
        M=np.array([1.0, 2.0, 0.5]),
        K=K,
        C=np.diag([0.3, 0.0, 0.1]),
        load=np.array([0.0, -1.0, 0.5]),
        Q=np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]),
        gap0=np.array([0.05, 0.1]),
        velocity=np.array([1.0, 0.0, 2.0]),
        forcing=(ct.bodies.Forcing(shape=np.array([0.0, 3.0, 0.0]), amplitude=lambda t: np.sin(4.0 * t)),),
    )


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
def test_numbers_of_a_frame(scheme, held):
    held(**numbers_of(ct.run(frame(), scheme=scheme, t_end=2.0, dt=0.01, record=OFTEN)))


@pytest.mark.parametrize("law", ["penalty", "penalty of a spring", "augmented"])
def test_numbers_of_springs(law, held):
    spring = ct.Penalty(stiffness=2e3)
    scheme, kind = {
        "penalty": (ct.scheme.PenaltyDifference(), spring),
        "penalty of a spring": (ct.scheme.HHT(alpha=-0.2), spring),
        "augmented": (ct.scheme.HHT(alpha=-0.2), ct.laws.AugmentedLagrangian(stiffness=2e4)),
    }[law]
    held(**numbers_of(ct.run(frame(), scheme=scheme, law=kind, t_end=2.0, dt=0.005, record=OFTEN, on_limit="flag")))


RODS = {
    "damped": lambda: (
        [
            ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20, x=-1.1, velocity=1.0, damping=0.02, end_mass=0.1),
            ct.Rod(length=2.0, area=0.7, E=1.5, rho=1.2, elements=30, fixed="right"),
        ],
        0.0,
    ),
    "between stops": lambda: (
        [
            ct.Wall(x=-0.5),
            ct.PointMass(mass=1.0, x=0.0, velocity=-1.0, stiffness=3.0, damping=0.1, force=0.5, force_hz=0.7),
            ct.Wall(x=0.4),
        ],
        0.0,
    ),
    "falling": lambda: ([ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=30, x=5.0), ct.Wall()], 10.0),
}


@pytest.mark.parametrize(
    "scheme", [ct.CentralDifference(), ct.scheme.NonsmoothAlpha(rho_inf=0.8)], ids=["explicit", "implicit"]
)
@pytest.mark.parametrize("name", RODS)
def test_numbers_of_rods(name, scheme, held):
    bodies, gravity = RODS[name]()
    step = {"dt": 0.01} if name == "between stops" else {"courant": 0.7}
    held(**numbers_of(ct.run(bodies, scheme=scheme, t_end=2.0, gravity=gravity, record=OFTEN, **step)))


def turning_rim(*, imperfect=0.05, S=1e-8, speed=5.0, clearance=-1e-5):
    return ct.RotatingRim(
        ring(S=S, imperfect=imperfect),
        blade(S=2.0 * S),
        clearance=clearance,
        speed_hz=speed,
        lean_deg=25.0,
        out_of_roundness=WAVES,
        angle_deg=13.0,
    )


def rub(*, whirl=(), closing=None, **parts):
    given = {
        "clearance": -3e-5,
        "speed": ct.Speed(time=[0.0, 0.1], hz=[3.0, 5.0]),
        "profile": ct.gaps.RimProfile.fourier(WAVES),
    }
    more = {} if closing is None else {"closing": closing}
    return ct.Rub(
        rim3(),
        (nodes(2), nodes(1, seed=6)),
        [*tips(2), *tips(1, blade=1, angle=190.0, axial=True)],
        whirl=whirl,
        **{**given, **more, **parts},
    )


def oscillator():
    block = ct.ModalBody(omega=[1.0, 0.0], zeta=[0.01, 0.0], channels=("x", "y"), rows=np.eye(2), S=np.diag([0.0, 0.2]))
    return ct.Patch(body=block, normal=("y",), tangent=(("x",),), load=[0.0, -1.0], displacement=[1.0, 0.0])


MODAL = {
    "rim": lambda: (turning_rim(), ct.Unilateral(), 1e-5, 0.02),
    "rim with friction": lambda: (turning_rim(), ct.Coulomb(mu=0.2), 1e-5, 0.02),
    "rim slow": lambda: (turning_rim(speed=-0.05, clearance=-1e-4), ct.Coulomb(mu=0.4), 1e-5, 0.02),
    "rim mostly free": lambda: (turning_rim(clearance=4e-6), ct.Coulomb(mu=0.2), 1e-5, 0.03),
    "rim without residual": lambda: (turning_rim(S=0.0), ct.Coulomb(mu=0.2), 1e-5, 0.02),
    "rim with a coating": lambda: (turning_rim(), ct.Abradable(**SOFT, mu=0.1), 1e-5, 0.03),
    "rub": lambda: (rub(), ct.Coulomb(mu=0.2), 2e-5, 0.02),
    "rub without friction": lambda: (rub(), ct.Unilateral(), 2e-5, 0.02),
    "rub with a coating": lambda: (rub(), ct.Abradable(**SOFT, mu=0.1), 2e-5, 0.02),
    "rub that whirls": lambda: (
        rub(whirl=(ct.gaps.Whirl(amplitude=3e-6, per_rev=-3.0, phase_deg=40.0),)),
        ct.Coulomb(mu=0.1),
        2e-5,
        0.02,
    ),
    "patch": lambda: (oscillator(), ct.Coulomb(mu=0.1), 1e-2, 6.0),
}


@pytest.mark.parametrize("name", MODAL)
def test_numbers_of_modal_contacts(name, held):
    scene, law, dt, t_end = MODAL[name]()
    held(
        **numbers_of(ct.run(scene, law=law, scheme=ct.ExactModal(), t_end=t_end, dt=dt, record=OFTEN, on_limit="flag"))
    )


@pytest.mark.parametrize("law", ["averaged", "forward"])
def test_numbers_of_a_modal_rod(law, held):
    bar = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=5.0, velocity=-10.0)
    scheme = ct.ExactModal(law=law, modes=20, omega_h_limit=3.05)
    held(
        **numbers_of(
            ct.run([bar, ct.Wall()], t_end=2.0, dt=0.6 / (19 * math.pi * 3.0), scheme=scheme, gravity=1.0, record=OFTEN)
        )
    )


@pytest.mark.parametrize("ring", [False, True], ids=["rigid", "ring"])
def test_numbers_of_a_beam(ring, held):
    beam = ct.bodies.HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, torque=1.0, elements=8)
    around = ct.bodies.ThinRing(radius=0.502, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6, k_t=1e5)
    circle = ct.bodies.BeamInCircle(
        beam, radius=0.502, offset=6e-3, ring=ct.bodies.ring_modes(around, 8) if ring else None
    )
    held(
        1e-5,
        **numbers_of(ct.run(circle, t_end=1.05 * circle.first_contact_time, courant=0.5, record=ct.Record(every=200))),
    )


def test_numbers_of_a_beam_in_implicit_steps(held):
    beam = ct.bodies.HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, torque=1.0, elements=6)
    circle = ct.bodies.BeamInCircle(beam, radius=0.502, offset=6e-3)
    run = ct.run(
        circle,
        scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55),
        t_end=1.02 * circle.first_contact_time,
        dt=1e-4,
        record=ct.Record(every=100),
    )
    held(1e-5, **numbers_of(run))


def test_numbers_of_a_disk(held):
    disk = ct.gaps.BladedDisk(
        blades=5,
        freq_hz=100.0,
        modal_mass=0.2,
        coupling=0.03,
        mistuning=np.linspace(-0.003, 0.003, 5),
        compliance=1e-4,
        lean_deg=30.0,
        zeta=1e-3,
    )
    casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=300.0, modal_mass=1.5), radius=0.5)
    scene = ct.Rub(
        casing,
        (disk.body(),),
        disk.tips(),
        clearance=-1e-5,
        speed=ct.Speed.constant(60.0),
        profile=ct.gaps.RimProfile.fourier([{"p": 2, "cos": 3e-5}]),
    )
    held(1e-5, **numbers_of(ct.run(scene, law=ct.Coulomb(mu=0.1), t_end=0.02, dt=5e-5, record=OFTEN, on_limit="flag")))
