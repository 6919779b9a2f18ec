"""Numbers held: laws of contact that give way, patches in three dimensions, rotors, and what is computed from a run."""

import numpy as np
import pytest

import contact as ct
from tests.contact.held_runs import numbers_of
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips
from tests.probed import numbers_in, probed

R = ct.rotor
pytestmark = pytest.mark.slow  # they run compiled loops
OFTEN = ct.Record(every=7, state_every=14)
WAVES = [{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]
LAWS = {
    "hertz": ct.laws.Hertz(k=4e9, exponent=1.5, dissipation=0.3, mu=0.15),
    "table": ct.laws.ForceTable(depth=[0.0, 1e-6, 3e-6, 1e-5], force=[0.0, 2.0, 11.0, 90.0], mu=0.1),
    "spring": ct.laws.Hertz(k=2e7, exponent=1.0),
}


def rim(**more):
    given = {"clearance": -1e-5, "speed_hz": 5.0, "lean_deg": 25.0, "out_of_roundness": WAVES, "angle_deg": 13.0}
    return ct.RotatingRim(ring(imperfect=0.05), blade(S=2e-8), **(given | more))


def rub(**more):
    blades = (nodes(2), nodes(1, seed=6))
    given = {"clearance": -3e-5, "speed": ct.Speed.constant(5.0), "profile": ct.gaps.RimProfile.fourier(WAVES)}
    return ct.Rub(rim3(), blades, [*tips(2), *tips(1, blade=1, angle=190.0, axial=True)], **(given | more))


@pytest.mark.parametrize("name", LAWS)
def test_numbers_of_laws_that_give_way(name, held):
    of_rim = ct.run(rim(), law=LAWS[name], t_end=0.02, dt=1e-5, record=OFTEN, on_limit="flag")
    of_tips = ct.run(rub(), law=LAWS[name], t_end=0.01, dt=2e-5, record=OFTEN, on_limit="flag")
    held(1e-5, **numbers_of(of_rim), **{f"tips {name}": column for name, column in numbers_of(of_tips).items()})


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_numbers_of_a_patch_of_four_points_in_three_dimensions(mu, held):
    """A plate on four points that slides, is pressed and rocks; friction along both directions of the ground."""
    rng = np.random.default_rng(8)
    channels = [f"p{k}.{name}" for k in range(4) for name in "xyz"]
    mixing = 1e-4 * rng.standard_normal((12, 12))
    body = ct.ModalBody(
        omega=[0.0, 40.0, 90.0, 130.0, 300.0], zeta=[0.0, 0.01, 0.02, 0.01, 0.005], channels=channels,
        rows=rng.standard_normal((12, 5)), S=mixing @ mixing.T + 1e-7 * np.eye(12),
    )  # fmt: skip
    patch = ct.Patch(
        body=body, normal=tuple(channels[2::3]), tangent=tuple(zip(channels[::3], channels[1::3], strict=True)),
        load=[0.0, -9.0, 2.0, 0.0, 1.0], velocity=[0.0, 0.02, 0.0, 0.01, 0.0],
    )  # fmt: skip
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    result = ct.run(patch, law=law, scheme=ct.ExactModal(), t_end=0.3, dt=5e-4, record=OFTEN, on_limit="flag")
    assert np.count_nonzero(result.contact_steps) >= 3
    held(1e-5, **numbers_of(result))


def test_numbers_of_what_is_computed_from_a_run(held):
    scene = rim(clearance=4e-6)
    result = ct.run(scene, law=ct.Coulomb(mu=0.2), t_end=0.05, dt=1e-5, record=ct.Record(every=5, state_every=5))
    grown = ct.stability.of_run(scene, result)
    tips_run = rub(), ct.run(rub(), law=ct.Coulomb(mu=0.2), t_end=0.01, dt=2e-5, record=OFTEN, on_limit="flag")
    casing, bearer = (ct.recovery.rub_forces(scene, result, name) for name in ("casing", "blade"))
    held(
        1e-5,
        growth=[x for x in numbers_in(grown) if np.isfinite(x)],
        casing=probed(casing[1]),
        blade=probed(bearer[1]),
        tips=[probed(ct.recovery.rub_forces(tips_run[0], tips_run[1], name)[1]) for name in ("casing", "blade 2")],
    )


def shaft():
    return R.Shaft(
        pieces=[
            R.Piece(length=0.3, diameter=0.05, elements=3, loss_time=1e-6),
            R.Piece(length=0.4, diameter=0.07, inner_diameter=0.03, elements=4),
        ],
        disks=[
            R.Disk(at=0.3, mass=12.0, polar=0.2, diametral=0.11),
            R.Disk(at=0.7, mass=4.0, polar=0.05, diametral=0.03),
        ],
        bearings=[
            R.Bearing(at=0.0, kxx=2e7, kyy=3e7, kxy=4e6, kyx=-4e6, cxx=2e3, cyy=1e3, cxy=3e2, cyx=-1e2),
            R.Bearing(at=0.5, kxx=5e7, cxx=1e3),
        ],
    )


def test_numbers_of_a_shaft_over_speed(held):
    speeds = [-120.0, 0.0, 35.0, 150.0, 400.0]
    weight = R.Unbalance(moment=1e-3, angle_deg=25.0)
    rotor = R.Rotor.of(shaft(), 60.0, unbalance=weight, modes=14, gravity=9.80665)
    held(
        1e-5,
        rotor=[x for x in numbers_in(rotor) if np.isfinite(x)],
        whirl=[x for x in numbers_in(R.campbell(rotor, speeds)) if np.isfinite(x)],
        critical=[x for x in numbers_in(R.critical_speeds(rotor)) if np.isfinite(x)],
        answer=[x for x in numbers_in(R.unbalance_response(rotor, [20.0, 60.0, 110.0])) if np.isfinite(x)],
    )


def test_numbers_of_a_lost_blade(held):
    """Three tips, one of them elastic, on a shaft that slows down; forces at the bearings and the casing's supports."""
    lost = R.Unbalance(moment=1e-3, angle_deg=-20.0, release=R.Release(time=0.01, moment=3e-2, angle_deg=40.0))
    rotor = R.Rotor.of(R.Jeffcott(mass=10.0, stiffness=4e6, zeta=0.05), 60.0, unbalance=lost)
    casing = R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1)
    places = [ct.ContactPoint(blade=j, angle_deg=a) for j, a in enumerate((0.0, 130.0, 260.0))]
    scene = R.rotor_rub(rotor, casing, [R.rigid_tip()] * 3, places, clearance=4e-4, spin=R.Spin(inertia=0.3))
    result = ct.run(scene, law=ct.Coulomb(mu=0.15), t_end=0.1, dt=2e-5, record=OFTEN, on_limit="flag")
    assert result.contact_steps.sum() > 100
    supports = ct.recovery.support_forces(scene, result)
    numbers = {f"support {name}": column for name, column in supports.items() if np.asarray(column).dtype.kind == "f"}
    held(
        1e-5,
        **numbers_of(result),
        **{name: probed(np.atleast_2d(column)) for name, column in numbers.items()},
        turned=-scene.turned(result.state_time, result.state_of("casing"))[::40],
        orbit=[x for x in numbers_in(result.notes.orbit) if np.isfinite(x)],
    )


def test_numbers_of_a_rotor_that_rubs_over_speed(held):
    """Growth of the free rotor, synchronous rub and its growth, dry whirl."""
    lost = R.Unbalance(moment=2.5e-2, angle_deg=15.0)
    rotor = R.Rotor.of(R.Jeffcott(mass=10.0, stiffness=4e6, zeta=0.03, zeta_internal=0.01), 70.0, unbalance=lost)
    casing = R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1)
    scene = R.rotor_rub(rotor, casing, [R.rigid_tip()], clearance=5e-4)
    found = ct.stability.rotor_stability(scene, np.linspace(20.0, 160.0, 8), mu=0.12)
    held(1e-5, found=[x for x in numbers_in(found) if np.isfinite(x)])


def test_numbers_of_varied_contacts(held):
    """Growth of closed contact where casing, blade and friction vary, and of one on the springs of its law."""
    scene = ct.RotatingRim(ring(), blade(), clearance=-1e-5, speed_hz=5.0, lean_deg=10.0)
    modes = len(ring().omega)
    cases = ct.stability.Cases(
        casing=1.0 + 0.01 * np.cos(np.outer(np.arange(5), 1 + np.arange(modes) // 2)),  # pairs remain pairs
        blade=1.0 + 0.02 * np.sin(np.arange(5)), mu=np.linspace(0.0, 0.3, 5),
    )  # fmt: skip
    speeds = np.linspace(3.0, 40.0, 9)
    soft = ct.stability.on_springs(scene, ct.stability.slope_of(LAWS["hertz"], 2e-6))
    held(
        1e-5,
        growth=ct.stability.growth_of_cases(scene, speeds, cases),
        soft=ct.stability.growth_of_cases(soft, speeds, cases),
        slopes=[ct.stability.slope_of(law, depth) for law in LAWS.values() for depth in (5e-7, 2e-6, 5e-6)],
    )


def test_numbers_of_a_driven_mass_on_a_stop(held):
    """A branch over frequency with its orbits, the motion along one of them, and what runs from random starts reach."""
    mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    family = driven.over("freq_hz", freq_hz=0.1)
    (branch, *_) = ct.cycles.follow(family, (0.12, 0.17), longest=0.3).branches
    along = ct.cycles.traced(family, ct.cycles.orbit(family, 0.16))
    reached = ct.cycles.basins(family, 0.18, np.array([0.05, 0.05]), starts=4, seed=1, settle=80)
    held(
        1e-4,
        branch=[x for orbit in branch.points for x in (orbit.value, orbit.amplitude["x"], orbit.period)],
        special=[one.orbit.value for one in branch.specials],
        trace=along.displacement["x"][::20],
        shares=[x for one in reached.attractors for x in (one.share, one.periods, one.amplitude["x"])],
    )
