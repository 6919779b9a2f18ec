"""Runs of a beam in a circle at their start, and their energies and momenta in any state; uncompiled."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.scheme.beam.beam_stepper import beam_step
from tests.contact.plain import plain

GIVEN = {"length": 0.5, "width": 0.02, "height": 0.005, "E": 210e9, "rho": 7800.0, "elements": 4}
TURNING = {"torque": 3.0, "angle_deg": 25.0, "spin": 7.0}
AREA, MOMENT, CELL = 1e-4, 0.02 * 0.005**3 / 12.0, 0.125
MASS = 7800.0 * CELL * np.array([0.5, 1.0, 1.0, 1.0, 0.5])[:, None] * [AREA, AREA, MOMENT]
ALONG = np.array([math.cos(math.radians(25.0)), math.sin(math.radians(25.0))])
PLACES = np.hstack([np.outer(CELL * np.arange(5), ALONG), np.full((5, 1), math.radians(25.0))])
SPIN = 7.0 * np.stack([-PLACES[:, 1], PLACES[:, 0], np.ones(5)], axis=1)
LIMIT = 2.0 / ct.bodies.HingedBeam(**GIVEN).omega_max()


def circle(module, *, ring=False, **more):
    ct = module("contact")
    beam = ct.bodies.HingedBeam(**GIVEN, **TURNING | more)
    around = None
    if ring:
        thin = ct.bodies.ThinRing(radius=0.502, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6, zeta=0.01)
        around = module("contact.model.bodies.ring_modes").ring_modes(thin, 3)
    return ct.bodies.BeamInCircle(beam, radius=0.502, offset=6e-3, ring=around)


def explicit(module, **more):
    return module("contact.scheme.beam.beam_stepper").prepare_beam(circle(module, **more), None, 0.5)


def implicit(module, dt=1e-4, **more):
    return module("contact.scheme.beam.beam_stepper").prepare_beam_newmark(circle(module, **more), 0.5, 0.55, dt)


def test_the_step_is_the_one_given_or_a_share_of_the_largest_stable_one():
    problem = ct.bodies.BeamInCircle(ct.bodies.HingedBeam(**GIVEN), radius=0.502)
    assert beam_step(problem, None, 0.3) == pytest.approx(0.3 * LIMIT, rel=1e-14)
    assert beam_step(problem, LIMIT, None) == LIMIT
    for given in ((None, None), (1e-9, 0.5)):
        with pytest.raises(ct.InputError, match="both or neither of dt and courant"):
            beam_step(problem, *given)
    for given, name in (
        ((0.0, None), "dt"),
        ((-1e-9, None), "dt"),
        ((None, 0.0), "courant"),
        ((None, -0.5), "courant"),
    ):
        with pytest.raises(ct.InputError, match=f"^{name}: found"):
            beam_step(problem, *given)
    words = r"dt \* omega_max = 2\.002\d*, expected <= 2 .*take dt <= "
    with pytest.raises(ct.LimitError, match=words) as caught:
        beam_step(problem, 1.001 * LIMIT, None)
    told = float(str(caught.value).rpartition("<= ")[2].removesuffix(" s"))
    assert LIMIT * (1.0 - 1e-9) < told <= LIMIT


def test_an_explicit_run_starts_with_the_increment_of_one_step_before():
    with plain() as module:
        run = explicit(module)
    s, h = run.state, 0.5 * LIMIT
    rate = h * h / MASS
    rate[0, :2] = 0.0  # the hinge
    load = np.zeros((5, 3))
    load[0, 2] = 3.0
    np.testing.assert_allclose(s.x, PLACES, rtol=1e-13)
    np.testing.assert_allclose(s.rate, rate, rtol=1e-12)
    np.testing.assert_allclose(s.d, h * SPIN - 0.5 * rate * load, rtol=1e-12)
    assert s.load.tolist() == load.tolist()
    assert (s.rest, s.EA, s.EI) == pytest.approx((CELL, 210e9 * AREA, 210e9 * MOMENT), rel=1e-13)
    gaps = 0.502 - np.hypot(PLACES[1:, 0] - 6e-3, PLACES[1:, 1])
    for found in (s.free[1:], s.before, s.gap):
        np.testing.assert_allclose(found, gaps, rtol=1e-12)
    assert s.scale.tolist() == rate[1:, 0].tolist()
    assert run.label == "central difference + forward Lagrange, dt omega_max = 1 (limit 2)"
    assert run.window == pytest.approx(math.pi * LIMIT, rel=1e-13)
    assert (run.size, run.blocks, run.dt, run.sums.work.size) == (15, (("beam 1", 0, 15),), h, 4)
    assert run.why() == "the motion is not a number: reduce dt [motion-overflow]"


def test_an_implicit_run_starts_with_the_acceleration_of_its_torque():
    with plain() as module:
        run = implicit(module)
        slow = implicit(module, dt=0.5)
    s, load = run.state, np.zeros((5, 3))
    load[0, 2] = 3.0
    np.testing.assert_allclose(s.x, PLACES, rtol=1e-13)
    np.testing.assert_allclose(s.v, SPIN, rtol=1e-13)
    np.testing.assert_allclose(s.a, load / MASS, rtol=1e-13)
    assert (s.rest, s.EA, s.EI) == pytest.approx((CELL, 210e9 * AREA, 210e9 * MOMENT), rel=1e-13)
    assert (s.beta, s.gamma, s.radius, s.offset) == (0.5, 0.55, 0.502, 6e-3)
    gaps = 0.502 - np.hypot(PLACES[1:, 0] - 6e-3, PLACES[1:, 1])
    for found in (s.gap, s.before):
        np.testing.assert_allclose(found, gaps, rtol=1e-12)
    assert s.force.tolist() == s.last.tolist() == [0.0] * 4
    assert f"dt omega_max = {2e-4 / LIMIT:.3g} (no limit)" in run.label
    assert run.window == pytest.approx(max(math.pi * LIMIT, 1e-4), rel=1e-13)
    assert slow.window == 0.5
    assert (run.sums.work.size, run.dt) == (4, 1e-4)
    assert "reduce dt" in run.why()


def test_an_implicit_run_has_a_positive_step_and_a_rigid_circle():
    with plain() as module:
        errors = module("contact.base.errors")
        for make, words in (
            (lambda: implicit(module, dt=None), "dt: found none"), (lambda: implicit(module, dt=0.0), "dt: found 0"),
            (lambda: implicit(module, ring=True), "ring: found a flexible ring with Newmark"),
        ):  # fmt: skip
            with pytest.raises(errors.InputError, match=words):
                make()


def test_momenta_are_those_of_all_nodes_along_x_and_about_the_hinge():
    rng = np.random.default_rng(8)
    x, v = rng.standard_normal((2, 5, 3))
    with plain() as module:
        runs = explicit(module), implicit(module)
    runs[0].state.d[:], runs[1].state.v[:] = v * runs[0].dt, v
    runs[0].state.ledger[:], runs[1].state.ledger[:] = (3.0, 4.0), (3.0, 4.0, 5.0)
    momentum = MASS[:, 0] @ v[:, 0]
    about = np.sum(MASS[:, 0] * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) + MASS[:, 2] * v[:, 2])
    for run, impulse in zip(runs, (4.0 * runs[0].dt, 4.0), strict=True):
        run.state.x[:] = x
        (motion,) = run.motions()
        assert (motion.kind, motion.number) == ("beam", 0)
        assert (motion.momentum, motion.mean_velocity) == pytest.approx((momentum, momentum / 0.39), rel=1e-12)
        spin, pushed = run.angular_momentum()
        assert spin == pytest.approx(about, rel=1e-12)
        assert pushed == impulse


def test_energies_of_a_turned_and_stretched_beam():
    """Every node 1 % further out and turned by 0.3 rad: 2 EA L (stretch)^2/2 of membrane energy alone."""
    turn = math.radians(25.0) + 0.3
    x = np.stack(
        [*(1.01 * CELL * np.arange(5) * f for f in (math.cos(turn), math.sin(turn))), np.full(5, turn)], axis=1
    )
    v = np.random.default_rng(8).standard_normal((5, 3))
    stretch = 0.5 * 210e9 * AREA * 0.5 * 0.01**2
    kinetic = 0.5 * np.sum(MASS * v**2)
    with plain() as module:
        run = implicit(module)
        run.state.x[:], run.state.v[:], run.state.ledger[0] = x, v, 0.7
        found = run.stored()
        assert (found.kinetic, found.strain) == pytest.approx((kinetic, stretch), rel=1e-9)
        assert (found.potential, found.residual) == (pytest.approx(-3.0 * turn, rel=1e-13), 0.0)
        assert found.discrete == pytest.approx(kinetic + stretch - 3.0 * turn - 0.7, rel=1e-9)
        run, beam = explicit(module), module("contact.loop.beam.beam")
        s = run.state
        s.d[:] = run.dt * v
        s.x[:] = x + 0.5 * s.d
        s.ledger[beam.INTERNAL] = 0.7
        found = run.stored()
        assert (found.kinetic, found.strain) == pytest.approx((kinetic, stretch), rel=1e-9)
        assert (found.potential, found.residual) == (pytest.approx(-3.0 * turn, rel=1e-12), 0.0)
        assert found.discrete == pytest.approx(kinetic + 0.7 - 3.0 * turn, rel=1e-9)


def test_energies_of_a_ring_are_those_of_its_modes_under_the_contacts():
    rng = np.random.default_rng(9)
    with plain() as module:
        run = explicit(module, ring=True)
        half = rng.standard_normal((7, 7))
        run = replace(run, state=run.state._replace(S=half @ half.T))
        s, m = run.state, run.state.q.size
        assert s.rows.shape == (7, m)
        bare = run.stored()
        s.q[:], s.dq[:], s.phi[:], s.force[:] = (rng.standard_normal(shape) for shape in (m, m, (5, m), 4))
        s.waves[:] = rng.standard_normal((5, 7))
        found = run.stored()
        pressed = s.waves[1:].T @ s.force
        residual = 0.5 * pressed @ s.S @ pressed
        ring = run.ring.stored(s.q, s.dq, s.phi[1:].T @ s.force, residual, 0.0)
    assert found.residual == pytest.approx(residual, rel=1e-12)
    assert found.kinetic == pytest.approx(bare.kinetic + ring.kinetic, rel=1e-12)
    assert found.strain == pytest.approx(bare.strain + ring.strain, rel=1e-12)
    assert found.discrete == pytest.approx(bare.discrete + ring.discrete, rel=1e-12)
    omega = run.problem.ring.omega
    np.testing.assert_allclose(
        s.be, 1.0 + s.al - 2.0 * np.sqrt(s.al) * np.cos(omega * math.sqrt(1 - 1e-4) * run.dt), rtol=1e-6
    )
    np.testing.assert_allclose(s.al, np.exp(-0.02 * omega * run.dt), rtol=1e-12)
