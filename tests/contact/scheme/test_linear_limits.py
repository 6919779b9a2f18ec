"""Steps and numbers that schemes on linear bodies take and refuse, and what a run of them reads and says."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.model.bodies.band import band
from contact.model.bodies.chain import assemble
from contact.model.bodies.linear_system import linear_system
from contact.record.record import samples
from contact.scheme.linear.alpha import newmark_limit
from contact.scheme.linear.stepper import FAINT, linear_step, parts_of, require_stable


def test_steps_of_rods_are_shares_of_the_crossing_time_and_one_is_given():
    rods = ct.bodies.LinearBody(M=np.ones(1), K=np.eye(1), Q=np.eye(1), gap0=np.ones(1))
    for given in ((None, None), (0.1, 0.5)):
        with pytest.raises(ct.InputError, match="both or neither of dt and courant"):
            linear_step(rods, *given)
    assert linear_step(rods, 0.3, None) == 0.3
    with pytest.raises(ct.InputError, match="courant: found a scene without rods"):
        linear_step(rods, None, 0.5)
    for given, name in (((0.0, None), "dt"), ((None, 0.0), "courant")):
        with pytest.raises(ct.InputError, match=f"^{name}: found 0"):
            linear_step(rods, *given)


def test_a_step_beyond_the_limit_is_refused_with_the_largest_that_is_not():
    assert require_stable(0.5, 4.0, 2.0, "X") == "dt omega_max = 2 (limit 2)"
    assert require_stable(0.5, 4.0, math.inf, "X") == "dt omega_max = 2 (no limit)"
    assert require_stable(0.5, 4.0 * (1.0 + 9e-10), 2.0, "X")
    with pytest.raises(
        ct.LimitError, match=r"found 0.5 s, dt \* omega_max = 2, .* \(stability of X\): take dt <= 0.49"
    ):
        require_stable(0.5, 4.0 * (1.0 + 2e-9), 2.0, "X")
    with pytest.raises(ct.LimitError, match=r"dt \* omega_max = 3, expected <= 2 .* take dt <= 0.333333 s"):
        require_stable(0.5, 6.0, 2.0, "X")


def test_newmark_is_stable_without_limit_from_half_of_gamma_on():
    assert newmark_limit(0.275, 0.55) == math.inf
    assert newmark_limit(0.2, 0.6) == pytest.approx(1.0 / math.sqrt(0.1), rel=1e-14)


BOUNDS = [
    (ct.Newmark, "beta", [1.0, 1e-9], [0.0, 1.0000001]),
    (ct.Newmark, "gamma", [0.5, 1.0], [0.4999999, 1.0000001]),
    (ct.scheme.HHT, "alpha", [-1.0 / 3.0, 0.0], [-0.3333334, 1e-9]),
    (ct.MoreauJean, "theta", [0.5, 1.0], [0.4999999, 1.0000001]),
    *((scheme, "restitution", [0.0, 1.0], [-1e-9, 1.0000001])
      for scheme in (ct.MoreauJean, ct.scheme.CDLagrange, ct.scheme.PaoliSchatzman, ct.scheme.NonsmoothAlpha)),
    (ct.scheme.NonsmoothAlpha, "rho_inf", [0.0, 1.0], [-1e-9, 1.0000001]),
]  # fmt: skip


@pytest.mark.parametrize(("scheme", "name", "good", "bad"), BOUNDS)
def test_numbers_of_schemes_are_taken_up_to_their_bounds(scheme, name, good, bad):
    for value in good:
        assert getattr(scheme(**{name: value}), name) == value
    for value in bad:
        with pytest.raises(ct.InputError, match=f"^{name}: found"):
            scheme(**{name: value})


def test_schemes_have_these_numbers_where_none_are_given():
    assert (ct.Newmark().beta, ct.Newmark().gamma, ct.scheme.HHT().alpha) == (0.25, 0.5, -0.1)
    assert (ct.MoreauJean().theta, ct.MoreauJean().restitution) == (0.5, 0.0)
    assert (ct.scheme.NonsmoothAlpha().rho_inf, ct.scheme.NonsmoothAlpha().restitution) == (0.8, 0.0)
    assert ct.scheme.CDLagrange().restitution == ct.scheme.PaoliSchatzman().restitution == 0.0


def test_explicit_steps_take_a_consistent_mass_of_two_hundred_coordinates_at_most():
    for size, fine in ((200, True), (201, False)):
        mass = np.eye(size) + np.diag(np.full(size - 1, 0.1), 1) + np.diag(np.full(size - 1, 0.1), -1)
        wide = ct.LinearBody(M=mass, K=np.eye(size), Q=np.eye(size)[:1], gap0=np.ones(1))
        if fine:
            assert ct.CentralDifference().prepare(wide, ct.Unilateral(), dt=0.1, courant=None).size == 200
            continue
        with pytest.raises(ct.InputError, match="found a consistent mass matrix, expected a lumped one"):
            ct.CentralDifference().prepare(wide, ct.Unilateral(), dt=0.1, courant=None)


def frame(amplitude=lambda t: 0.0 * t):
    """Three coordinates whose band order is not their own."""
    K = np.array([[30.0, 0.0, -10.0], [0.0, 20.0, -20.0], [-10.0, -20.0, 35.0]])
    forcing = (
        ct.bodies.Forcing(shape=np.array([0.0, 0.0, 1.0]), amplitude=lambda t: 0.0 * t),
        ct.bodies.Forcing(shape=np.array([0.0, 3.0, 0.0]), amplitude=amplitude),
    )
    return ct.LinearBody(M=np.array([1.0, 2.0, 0.5]), K=K, Q=np.eye(3)[:1], gap0=np.ones(1), forcing=forcing)


def stepped(run, first, steps, *, failed=-1):
    """What a run that keeps its order of coordinates hands to its loop, and says of a step that failed."""
    calls = []

    def loop(parts, state, sums, out, amplitudes, h, start, count, *method):
        calls.append((start, count, out, amplitudes))
        sums.filled[1] = 2
        out.state[:2] = 10.0 * np.arange(2.0)[:, None] + np.arange(out.state.shape[1])
        return failed

    run = replace(run, loop=loop)
    out = samples(ct.Record(every=1, state_every=1), steps, 1, run.size)
    return run, run.advance(out, first, steps), out, calls[0]


def test_states_are_stored_in_the_order_of_the_body():
    run = ct.Newmark().prepare(frame(), ct.Unilateral(), dt=0.1, courant=None)
    run, failed, out, (first, steps, _, amplitudes) = stepped(run, 3, 4)
    assert (failed, first, steps, amplitudes.shape) == (-1, 3, 4, (5, 2))
    place = run.system.place
    assert place.tolist() != [0, 1, 2]
    assert out.state[:2].tolist() == [place.tolist(), (10 + place).tolist()]


@pytest.mark.parametrize(("bad", "good"), [(0, 0), (1, 0), (2, 1), (4, 3)])
def test_a_load_that_is_no_number_stops_before_the_step_that_needs_it(bad, good):
    """Amplitudes stand at both ends of each step."""

    def amplitude(t):
        return np.where(np.abs(t - 0.1 * (3 + bad)) < 1e-9, np.nan, t)

    run = ct.Newmark().prepare(frame(), ct.Unilateral(), dt=0.1, courant=None)
    run = replace(run, system=linear_system(frame(amplitude)))
    run, failed, _, (first, steps, *_) = stepped(run, 3, 4)
    assert (failed, first, steps) == (3 + good, 3, good)
    assert run.why() == f"forcing 2: found nan at t = {0.1 * (3 + bad):.6g} s, expected a finite force [load-unknown]"


def test_a_step_that_fails_before_a_load_is_no_number_is_the_one_told():
    run = ct.Newmark().prepare(frame(), ct.Unilateral(), dt=0.1, courant=None)
    run = replace(run, system=linear_system(frame(lambda t: np.where(t > 0.25, np.nan, t))))
    assert stepped(run, 0, 4, failed=0)[1] == 0
    assert run.why().startswith("the contacts have no common answer")


def test_a_failed_step_is_explained_by_the_motion_or_the_contacts():
    run = ct.Newmark().prepare(frame(), ct.Unilateral(), dt=0.1, courant=None)
    assert run.why() == (
        "the contacts have no common answer: their forces cycle, or a gap is not a number [unconverged]"
    )
    for part in (run.state.u, run.state.v):
        part[1] = np.nan
        assert run.why() == "the motion is not a finite number [motion-overflow]"
        part[1] = 0.0


def test_responses_that_are_round_off_are_zero():
    K = np.diag([1.0, 2.0, 4.0])
    K[0, 1] = K[1, 0] = -0.25 * FAINT
    K[1, 2] = K[2, 1] = -0.5
    system = linear_system(ct.LinearBody(M=np.ones(3), K=K, Q=np.eye(3)[:1], gap0=np.ones(1)))
    found = parts_of(system, band(K, system.order), 3.0).response[:, system.place]
    assert found.tolist() == [[3.0, 0.0, 0.0]]
    K[0, 1] = K[1, 0] = -1e-30
    faint = parts_of(system, band(K, system.order), 3.0).response[0, system.place]
    assert faint[1] == pytest.approx(3e-30 * 4.0 / (2.0 * 4.0 - 0.25), rel=1e-9)


def test_momenta_of_rods_and_masses_are_told_by_body_and_walls_left_out():
    rod = {"length": 1.0, "area": 1.0, "E": 1.0, "elements": 3}
    bodies = [
        ct.Wall(x=-9.0), ct.PointMass(mass=2.0, x=-1.0, velocity=3.0), ct.Rod(**rod, rho=5.0, velocity=-0.5),
        ct.Rod(**rod, rho=1.0, x=2.0, fixed="right"),
    ]  # fmt: skip
    for scheme in (ct.Newmark(), ct.CentralDifference()):
        run = scheme.prepare(assemble(bodies), ct.Unilateral(), dt=0.01, courant=None)
        found = [(m.kind, m.number, m.mean_velocity, m.momentum) for m in run.motions()]
        assert found[0] == ("mass", 1, pytest.approx(3.0, rel=1e-12), pytest.approx(6.0, rel=1e-12))
        assert found[1] == ("rod", 2, pytest.approx(-0.5, rel=1e-12), pytest.approx(-2.5, rel=1e-12))
        assert found[2] == ("rod", 3, 0.0, 0.0)
        assert run.blocks[-1][2] == run.size
    (motion,) = ct.Newmark().prepare(frame(), ct.Unilateral(), dt=0.1, courant=None).motions()
    assert (motion.kind, motion.number) == ("body", 0)
    assert math.isnan(motion.mean_velocity)
    assert math.isnan(motion.momentum)
