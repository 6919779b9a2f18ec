"""Contacts that give way: Hertz, dissipation, tables and a law of one's own against closed forms and each other."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import gamma

import contact as ct
from contact import laws
from tests.contact.synthetic_rim import blade, ring

MASS, SPEED = 2.0, 1.5


def body(S=0.0, omega=0.0):
    """A mass of 2 kg, free or on a spring, with residual compliance."""
    row = np.array([[1.0 / math.sqrt(MASS)]])
    return ct.ModalBody(
        omega=np.array([omega]), zeta=np.zeros(1), channels=("x",), rows=row, S=np.array([[S]])
    )  # fmt: skip


def impact(law, dt, t_end, *, S=0.0, scheme="auto", clearance=1e-5, omega=0.0, **how):
    """The mass flies against a wall."""
    velocity = np.array([-SPEED * math.sqrt(MASS)])
    side = ct.gaps.Side(body=body(S, omega), channel="x", sign=1, velocity=velocity)
    gap = ct.PointGap(sides=(side,), clearance=clearance)
    return ct.run(gap, law=law, scheme=ct.ExactModal(law=scheme), dt=dt, t_end=t_end, **how)


def closed_forms(k, p):
    """Depth, force and duration of an impact on force = k depth^p, by its energy."""
    depth = ((p + 1.0) * MASS * SPEED**2 / (2.0 * k)) ** (1.0 / (p + 1.0))
    n = 1.0 / (p + 1.0)
    time = 2.0 * depth / SPEED * math.sqrt(math.pi) * gamma(1.0 + n) / gamma(0.5 + n)
    return depth, k * depth**p, time


def duration(result):
    ((begin, end),) = result.intervals[0]
    return end - begin


@pytest.mark.parametrize(("k", "p"), [(1e9, 1.5), (1e6, 1.0), (1e12, 2.0), (1e14, 3.0)])
def test_a_mass_on_a_hertz_contact_has_the_depth_force_and_time_of_its_energy(k, p):
    depth, force, time = closed_forms(k, p)
    result = impact(laws.Hertz(k=k, exponent=p), dt=time / 2000.0, t_end=1.3 * time)
    assert float(result.peak_force[0]) == pytest.approx(force, rel=1e-4)
    assert float(result.max_penetration[0]) == pytest.approx(depth, rel=1e-4)
    assert float(result.impulse[0]) == pytest.approx(2.0 * MASS * SPEED, rel=1e-4)
    assert duration(result) == pytest.approx(time, rel=1e-3)
    assert abs(result.energy.lost_in_contact) <= 1e-4 * 0.5 * MASS * SPEED**2
    assert abs(result.energy.unaccounted) <= 1e-12 * result.energy.scale
    assert result.flags == ()


def test_the_error_falls_with_the_square_of_the_step():
    _, force, time = closed_forms(1e9, 1.5)
    errors = [
        abs(float(impact(laws.Hertz(k=1e9), dt=time / n, t_end=1.3 * time).impulse[0]) / (2.0 * MASS * SPEED) - 1.0)
        for n in (50, 200, 800)
    ]
    assert errors[1] < errors[0] / 12.0
    assert errors[2] < errors[1] / 12.0
    forward = impact(laws.Hertz(k=1e9), dt=time / 800, t_end=1.3 * time, scheme="forward")
    assert 0.0 < 1.0 - float(forward.peak_force[0]) / force < 0.02  # of first order, loses energy


@pytest.mark.parametrize("dissipation", [0.05, 0.2, 0.6])
def test_dissipation_leaves_the_speed_that_integrating_its_law_over_the_depth_gives(dissipation):
    """v dv/d depth = -k/m depth^p (1 + a v): G(v) = v/a - ln(1 + a v)/a^2 is the same before and after."""

    def G(v):
        return v / dissipation - math.log1p(dissipation * v) / dissipation**2

    back = brentq(lambda v: G(-v) - G(SPEED), 1e-9, 0.999 / dissipation)
    _, _, time = closed_forms(1e9, 1.5)
    result = impact(laws.Hertz(k=1e9, dissipation=dissipation), dt=time / 2000.0, t_end=1.6 * time)
    assert float(result.impulse[0]) == pytest.approx(MASS * (SPEED + back), rel=1e-4)
    lost = 0.5 * MASS * (SPEED**2 - back**2)
    assert result.energy.lost_in_contact == pytest.approx(lost, rel=1e-4)


def test_a_spring_in_the_contact_is_the_residual_compliance_of_a_rigid_contact():
    """1/k in the law and 1/k in S are one spring in series with the body: the same run to round-off."""
    k, S = 4e7, 1e-8
    _, _, time = closed_forms(1.0 / (S + 1.0 / k), 1.0)
    dt, end = time / 300.0, 1.5 * time
    rigid = impact(ct.Unilateral(), dt, end, S=S + 1.0 / k, scheme="averaged")
    for law in (
        ct.Penalty(stiffness=k),
        laws.ForceLaw(lambda d, r, v: (4e7 * d, 4e7)),
        laws.Hertz(k=k, exponent=1.0),
    ):
        soft = impact(law, dt, end, S=S)
        np.testing.assert_allclose(soft.force, rigid.force, rtol=0.0, atol=1e-10 * float(rigid.force.max()))
        assert soft.energy.end.residual == pytest.approx(rigid.energy.end.residual, abs=1e-10)


def test_a_table_is_the_law_that_its_points_are_of():
    """A parabola by many points, and two springs by three points against the law written out."""
    depth = np.linspace(0.0, 2e-3, 2001)
    by_points = impact(laws.ForceTable(depth=depth, force=1e9 * depth**2), 1e-7, 8e-3, omega=10.0)
    by_law = impact(laws.Hertz(k=1e9, exponent=2.0), 1e-7, 8e-3, omega=10.0)
    assert float(by_points.impulse[0]) == pytest.approx(float(by_law.impulse[0]), rel=1e-5)

    def bumper(depth, rate, values):
        soft, stiff, end = values[0], values[1], values[2]
        if depth < end:
            return soft * depth, soft
        return soft * end + stiff * (depth - end), stiff

    own = laws.ForceLaw(laws.Response(bumper, (1e6, 5e7, 5e-4)))
    table = laws.ForceTable(depth=[0.0, 5e-4, 1e-3], force=[0.0, 500.0, 25500.0])
    first, second = (impact(law, 1e-6, 8e-3) for law in (own, table))
    np.testing.assert_allclose(first.force, second.force, rtol=1e-9, atol=1e-6)
    assert first.energy.end.residual == pytest.approx(0.0, abs=1e-9)


def block(k, *, mu, height=0.0, speed=0.0, fall=0.0):
    """A block of 2 kg on k contacts in a row, under its weight; it moves along x and z, and tilts."""
    at = np.linspace(-0.5, 0.5, k) if k > 1 else np.zeros(1)
    root, inertia = math.sqrt(MASS), math.sqrt(0.2 * MASS)
    rows = np.zeros((2 * k, 3))
    rows[::2, 0] = 1.0 / root
    rows[1::2, 1] = 1.0 / root
    rows[1::2, 2] = at / inertia
    body = ct.ModalBody(
        omega=np.zeros(3), zeta=np.zeros(3), channels=tuple(f"{i}.{axis}" for i in range(k) for axis in "xz"),
        rows=rows, S=np.zeros((2 * k, 2 * k)),
    )  # fmt: skip
    return ct.Patch(
        body=body, normal=tuple(f"{i}.z" for i in range(k)),
        tangent=tuple((f"{i}.x",) for i in range(k)) if mu > 0.0 else (), clearance=height,
        load=[0.0, -9.81 * root, 0.0], velocity=[speed * root, -fall * root, 0.0],
    )  # fmt: skip


def test_one_contact_of_a_patch_is_a_point_gap():
    """The same equations in the loop of several contacts, with the rate in the law."""
    law = laws.Hertz(k=1e9, dissipation=0.2)
    _, _, time = closed_forms(1e9, 1.5)
    dt = time / 300.0
    alone = impact(law, dt, 1.5 * time)
    mass = ct.Patch(body=body(), normal=("x",), clearance=1e-5, velocity=[-SPEED * math.sqrt(MASS)])
    several = ct.run(mass, law=law, dt=dt, t_end=1.5 * time)
    np.testing.assert_allclose(several.force, alone.force, rtol=0.0, atol=1e-9 * float(alone.force.max()))
    assert several.energy.lost_in_contact == pytest.approx(alone.energy.lost_in_contact, rel=1e-9)


def test_springs_in_the_law_are_springs_in_the_residual_compliance():
    """Four contacts that the tilt couples: force by force the run with 1/k on the diagonal of S."""
    k = 3e5
    patch = block(4, mu=0.0, height=[1e-4, 2e-4, 0.0, 3e-4], fall=0.3)
    rows = [patch.body.channels.index(name) for name in patch.normal]
    S = np.zeros_like(patch.body.S)
    S[rows, rows] = 1.0 / k
    rigid = ct.run(replace(patch, body=replace(patch.body, S=S)), law=ct.Unilateral(), dt=1e-5, t_end=0.02)
    soft = ct.run(patch, law=ct.Penalty(stiffness=k), scheme=ct.ExactModal(law="forward"), dt=1e-5, t_end=0.02)
    assert int(np.count_nonzero(rigid.force.max(axis=0))) == 4
    np.testing.assert_allclose(soft.force, rigid.force, rtol=0.0, atol=1e-9 * float(rigid.force.max()))


@pytest.mark.parametrize("count", [1, 3])
def test_a_block_slides_on_hertz_contacts_as_coulomb_states(count):
    """It rests where the contacts bear its weight, slows down by mu g, and what friction takes is in the ledger."""
    k, mu, g = 1e8, 0.2, 9.81
    sunk = (MASS * g / count / k) ** (2.0 / 3.0)
    patch = block(count, mu=mu, speed=1.0)
    law = laws.ForceLaw(laws.Hertz(k=k, dissipation=5.0).response, mu=mu)
    result = ct.run(patch, law=law, dt=1e-5, t_end=0.4, record=ct.Record(every=100, state_every=100))
    late = result.time > 0.3
    np.testing.assert_allclose(result.force[late], MASS * g / count, rtol=2e-2)
    np.testing.assert_allclose(result.gap[late], -sunk, rtol=2e-2)
    t = float(result.state_time[-1])
    assert result.state[-1, 0] / math.sqrt(MASS) == pytest.approx(t - 0.5 * mu * g * t**2, rel=1e-2)
    assert abs(result.energy.unaccounted) <= 1e-10 * result.energy.scale


def rub_with(law, S, *, count, scheme="averaged", **how):
    """Blades that stand radially before a turning ring and vibrate into it; S of the tips along the radius."""
    tip = ct.ModalBody(
        omega=2.0 * np.pi * np.array([300.0, 900.0]), zeta=np.full(2, 0.002), channels=("span", "flap"),
        rows=np.array([[0.8, 0.3], [1.0, -0.5]]), S=np.diag([S, 2e-8]),
    )  # fmt: skip
    places = tuple(ct.ContactPoint(blade=j, angle_deg=100.0 * j) for j in range(count))
    starts = tuple(ct.gaps.Start(velocity=np.array([0.3 + 0.1 * j, 0.0])) for j in range(count))
    rub = ct.Rub(
        ring(S=2e-8), (tip,) * count, places, clearance=5e-6, speed=ct.Speed.constant(20.0), blade_starts=starts
    )  # fmt: skip
    return ct.run(rub, law=law, scheme=ct.ExactModal(law=scheme), dt=2e-6, t_end=0.02, **how)


@pytest.mark.parametrize(("count", "mu"), [(1, 0.0), (1, 0.2), (3, 0.0), (3, 0.2)])
def test_a_spring_at_the_tips_of_a_rub_is_the_residual_compliance_of_the_blades(count, mu):
    """Force by force the rub on a rigid rim whose blades have 1/k more compliance along the contact normal."""
    k = 2e7
    law = laws.ForceLaw(ct.Penalty(stiffness=k).response, mu=mu)
    soft = rub_with(law, 1e-8, count=count)
    rigid = rub_with(ct.Coulomb(mu=mu), 1e-8 + 1.0 / k, count=count)
    assert rigid.force.max(axis=0).min() > 0.0
    np.testing.assert_allclose(soft.force, rigid.force, rtol=0.0, atol=1e-8 * float(rigid.force.max()))
    assert soft.energy.lost_in_contact == pytest.approx(rigid.energy.lost_in_contact, rel=1e-6, abs=1e-12)
    assert abs(soft.energy.unaccounted) <= 1e-11 * soft.energy.scale
    if mu > 0.0:
        np.testing.assert_allclose(soft.tip_force, rigid.tip_force)
        assert soft.energy.friction == pytest.approx(rigid.energy.friction, rel=1e-6)


def test_hertz_at_the_tip_before_a_rim_converges_and_gives_back_its_energy():
    """The impulse so far, whose last step counts whole, closes in with the step; over many impacts nothing is lost."""
    casing, tip = ring(S=1e-8), blade(S=1e-8)
    rim = ct.RotatingRim(
        casing, tip, clearance=1e-5, speed_hz=0.0, lean_deg=20.0, blade_velocity=[0.4, 0.0]
    )  # fmt: skip
    runs = [ct.run(rim, law=laws.Hertz(k=1e10), dt=dt, t_end=0.01) for dt in (4e-6, 2e-6, 1e-6)]
    a, b, c = (float(run.impulse[0]) for run in runs)
    assert abs(b - c) < abs(a - b) / 1.9
    assert abs(b - c) < 3e-4 * c
    energy = runs[-1].energy
    assert abs(energy.lost_in_contact) < 1e-4 * energy.scale
    assert abs(energy.unaccounted) < 1e-11 * energy.scale


def test_a_step_that_is_long_for_the_stiffest_moment_is_flagged_with_one_that_fits():
    _, _, time = closed_forms(1e9, 1.5)
    result = impact(laws.Hertz(k=1e9), dt=time / 3.0, t_end=3.0 * time)
    (flag,) = (flag for flag in result.flags if flag.code == "step-too-long")
    assert "of the contact at its largest stiffness" in flag
    assert "use dt <=" in flag


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (lambda: laws.ForceLaw(3.0), r"response: found 3.0, expected a function of depth, rate and values"),
        (lambda: laws.ForceLaw(lambda d: d), r"response: found TypeError: .*expected \(force, slope\) from"),
        (lambda: laws.ForceLaw(lambda d, r, v: (-1e6 * d, -1e6)), r"slope -1e\+06 N/m .*a force that does not fall"),
        (lambda: laws.ForceLaw(lambda d, r, v: (float(str(d)), 1.0)), r"which does not compile .*math and the array"),
        (lambda: laws.Hertz(k=-1.0), r"k: found -1"),
        (lambda: laws.Hertz(k=1.0, exponent=0.5), r"exponent: found 0.5, expected 1 to 10"),
        (lambda: laws.ForceTable(depth=[0.0, 1.0], force=[0.0, 1.0, 2.0]), r"found shapes \(2,\), \(3,\)"),
        (lambda: laws.ForceTable(depth=[0.0, 1.0, 1.0], force=[0.0, 1.0, 2.0]), r"depth: found 1 at point 3.*than 1"),
        (lambda: laws.ForceTable(depth=[0.0, 1.0, 2.0], force=[0.0, 2.0, 1.0]), r"force: found 1 at point 3.*least 2"),
        (lambda: laws.ForceTable(depth=[0.1, 1.0], force=[0.0, 1.0]), r"depth: found .*begin with 0"),
    ],
)  # fmt: skip
def test_laws_that_cannot_be_used_are_refused(law, words):
    with pytest.raises(ct.InputError, match=words):
        impact(law(), 1e-6, 1e-4)


def test_schemes_that_do_not_take_a_force_law_refuse_it():
    rods = [ct.Rod(length=1.0, area=1e-4, E=2e11, rho=7800.0, elements=4, x=1.0), ct.Wall()]
    for scheme in (ct.CentralDifference(), ct.scheme.Newmark(), ct.MoreauJean()):
        with pytest.raises(ct.InputError, match="law: found"):
            ct.run(rods, law=laws.Hertz(k=1e9), scheme=scheme, dt=1e-6, t_end=1e-5)
    with pytest.raises(ct.InputError, match="law = 'energy'"):
        impact(laws.Hertz(k=1e9), 1e-6, 1e-4, scheme="energy")
