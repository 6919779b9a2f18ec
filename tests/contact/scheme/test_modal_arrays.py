"""Modal runs at their start and at rest: coefficients, energies, limits and labels against written-out formulas."""

import math
from inspect import getclosurevars

import numpy as np
import pytest
from scipy.linalg import expm

import contact as ct
from contact.model.bodies.chain import assemble
from contact.scheme.modal.exact_modal import _require_slow_turn, _step
from contact.scheme.modal.modal_stepper import modal_stepper
from contact.scheme.modal.propagator import propagator, window

OMEGA, ZETA, LOAD, H = np.array([0.0, 3.0, 70.0]), np.array([0.0, 0.1, 0.4]), np.array([0.5, 4.0, -90.0]), 0.02


def exact(i, h):
    """Map of (q, q', 1) over h."""
    return expm(h * np.array([[0, 1, 0], [-(OMEGA[i] ** 2), -2 * ZETA[i] * OMEGA[i], LOAD[i]], [0, 0, 0]]))


def test_coefficients_make_the_motion_exact_with_and_without_rigid_modes():
    p = propagator(OMEGA, ZETA, LOAD, H)
    q, v = np.array([0.3, -0.2, 0.1]), np.array([1.0, -2.0, 5.0])
    past, now, later = (np.array([exact(i, t) @ [q[i], v[i], 1.0] for i in range(3)])[:, 0] for t in (-H, 0.0, H))
    d = p.backward(q, v)
    np.testing.assert_allclose(d, now - past, rtol=1e-11)
    np.testing.assert_allclose(p.al * d - p.be * now + p.c * LOAD, later - now, rtol=1e-11)
    np.testing.assert_allclose(p.velocity(now, d, LOAD), v, rtol=1e-11)
    assert p.rigid
    some = propagator(OMEGA[1:], ZETA[1:], LOAD[1:], H)
    assert not some.rigid
    np.testing.assert_allclose(some.backward(q[1:], v[1:]), d[1:], rtol=1e-13)
    np.testing.assert_allclose(some.velocity(q[1:], d[1:], LOAD[1:]), v[1:], rtol=1e-11)


def test_energies_of_modes_are_kinetic_strain_and_potential_and_their_form_between_two_steps():
    p, push = propagator(OMEGA, ZETA, LOAD, H), np.array([2.0, -1.0, 7.0])
    q, d = np.array([0.3, -0.2, 0.1]), np.array([0.01, 0.02, -0.03])
    found = p.stored(q, d, push, 0.7, 11.0)
    v = p.velocity(q, d, LOAD + push)
    assert found.kinetic == pytest.approx(0.5 * v @ v, rel=1e-13)
    assert found.strain == pytest.approx(0.5 * (9.0 * 0.04 + 4900.0 * 0.01), rel=1e-13)
    assert found.potential == pytest.approx(11.0 - (0.15 - 0.8 - 9.0), rel=1e-13)
    assert found.residual == 0.7
    inertia = 0.5 * np.sum(d**2 / p.c)
    between = 0.5 * (9.0 * -0.2 * -0.22 + 4900.0 * 0.1 * 0.13)
    loads = 0.5 * (0.5 * (0.3 + 0.29) + 4.0 * (-0.2 - 0.22) - 90.0 * (0.1 + 0.13))
    assert found.discrete == pytest.approx(11.0 + inertia + between - loads, rel=1e-12)


def test_the_window_is_the_period_of_the_highest_mode_or_the_step():
    assert window(70.0, 1e-3) == pytest.approx(2.0 * math.pi / 70.0, rel=1e-14)
    assert window(70.0, 0.5) == 0.5
    assert window(0.0, 0.25) == 0.25


def test_the_step_is_the_one_given_or_a_share_of_the_highest_mode():
    omega = 50.0
    assert _step(omega, 0.3, None) == 0.3
    assert _step(omega, None, 0.5) == 1.0 / 50.0
    assert _step(omega, None, None) == 0.8 / 50.0
    for given, words in (
        ((omega, 0.1, 0.1), "both dt and courant"), ((omega, 0.0, None), "dt: found 0"),
        ((0.0, None, None), "rigid bodies only"), ((0.0, None, 0.5), "rigid bodies only"),
        ((omega, None, 0.0), "courant: found 0"),
    ):  # fmt: skip
        with pytest.raises(ct.InputError, match=words):
            _step(*given)


def test_steps_that_turn_too_far_are_refused_at_their_bound():
    _require_slow_turn(3, -10.0, 0.01)
    with pytest.raises(ct.LimitError, match=r"found n_max Omega dt = 0.6 rad with n_max = 3, .*take dt <= 0.00999 s"):
        _require_slow_turn(3, -10.0, 0.02)


def point(*, zeta=0.0, S=0.2, sign=-1, **more):
    body = ct.ModalBody(
        omega=OMEGA, zeta=[0.0, zeta, zeta], channels=("x",), rows=[[0.5, -1.0, 2.0]], S=[[S]]
    )  # fmt: skip
    side = ct.gaps.Side(body=body, channel="x", sign=sign, **more)
    return ct.PointGap(sides=(side,), clearance=0.25)


@pytest.mark.parametrize(("rho", "law"), [(0.0999, "averaged"), (0.101, "forward")])
def test_auto_takes_the_averaged_law_up_to_a_tenth(rho, law):
    parts = propagator(OMEGA, np.zeros(3), np.zeros(3), H)
    H_d = parts.c @ np.array([0.25, 1.0, 4.0])
    run = ct.ExactModal().prepare(point(S=H_d / rho), ct.Unilateral(), dt=H, courant=None)
    assert f"exact modal, {law} law, dt omega_max = 1.4 (limit 2.5), rho = {rho}" in run.label
    assert law in ct.ExactModal(law=law).prepare(point(S=H_d / rho), ct.Unilateral(), dt=H, courant=None).label
    ct.ExactModal(law="averaged").prepare(point(S=1.001 * H_d), ct.Unilateral(), dt=H, courant=None)
    with pytest.raises(ct.LimitError, match=r"rho = H_d/S = 1\.001 .*expected <= 1 for the"):
        ct.ExactModal(law="averaged").prepare(point(S=H_d / 1.001), ct.Unilateral(), dt=H, courant=None)


def test_options_of_the_scheme_are_taken_up_to_their_bounds():
    assert ct.ExactModal(omega_h_limit=3.0999, modes=1).skip
    for given in ({"omega_h_limit": 3.1}, {"omega_h_limit": 0.0}, {"modes": 0}, {"law": "other"}):
        with pytest.raises(ct.InputError, match=next(iter(given))):
            ct.ExactModal(**given)
    ct.ExactModal(omega_h_limit=1.4).prepare(point(), ct.Unilateral(), dt=H, courant=None)
    with pytest.raises(
        ct.LimitError, match=r"omega_max dt = 1.4, expected <= 1.39 .*take dt <= 0.01985 s.* 69.499 rad"
    ):
        ct.ExactModal(omega_h_limit=1.39).prepare(point(), ct.Unilateral(), dt=H, courant=None)
    with pytest.raises(ct.InputError, match="friction on a scene without tangential motion"):
        ct.ExactModal().prepare(point(), ct.Coulomb(mu=0.1), dt=H, courant=None)


def test_a_point_starts_with_its_gap_now_and_one_step_before_and_weights_of_damping():
    velocity = np.array([1.0, -2.0, 5.0])
    system = ct.gaps.point_system(point(zeta=0.1, velocity=velocity, load=LOAD))
    parts = propagator(system.omega, system.zeta, system.load, H)
    run = modal_stepper(system, parts, averaged=False, law=ct.Unilateral(), label="")
    state, d = getclosurevars(run.velocity).nonlocals["state"], parts.backward(np.zeros(3), velocity)
    row = -np.array([0.5, -1.0, 2.0])
    np.testing.assert_allclose(state.memory, [0.25, 0.25 - row @ d, 0.0], rtol=1e-13)
    np.testing.assert_allclose(state.weight, (1.0 - parts.al) / (2.0 * parts.c), rtol=1e-13)
    np.testing.assert_allclose(state.kick, parts.c * LOAD, rtol=1e-13)
    np.testing.assert_allclose(run.velocity(), d / H, rtol=1e-13)
    assert (run.size, run.blocks[0][1:]) == (3, (0, 3))
    assert run.notes().flags == ()
    state.q[:], state.memory[2] = (0.1, 0.2, 0.3), 4.0
    found, free = run.stored(), parts.stored(state.q, d, 4.0 * row, 0.5 * 16.0 * 0.2, system.potential)
    assert (found.kinetic, found.residual) == pytest.approx((free.kinetic, 1.6), rel=1e-13)
    state.memory[2] = 0.0
    assert run.stored() == parts.stored(state.q, d, np.zeros(3), 0.0, system.potential)
    assert "no force found that opens the gap" in run.why()
    state.d[1] = math.nan
    assert run.why() == "the motion is not a number [motion-overflow]"


def test_the_energy_law_starts_from_the_exact_motion_and_counts_what_the_overlap_stores():
    system = ct.gaps.point_system(point(velocity=np.array([1.0, -2.0, 5.0]), load=LOAD))
    run = ct.ExactModal(law="energy").prepare(
        point(velocity=[1.0, -2.0, 5.0], load=LOAD), ct.Unilateral(), dt=H, courant=None
    )
    state = getclosurevars(run.velocity).nonlocals["state"]
    c = propagator(OMEGA, np.zeros(3), LOAD, H).c
    turned = OMEGA * H
    np.testing.assert_allclose(state.cos, np.cos(turned), rtol=1e-13)
    np.testing.assert_allclose(state.drift, [H, *np.sin(turned[1:]) / OMEGA[1:]], rtol=1e-13)
    np.testing.assert_allclose(state.pull, -OMEGA * np.sin(turned), rtol=1e-13)
    np.testing.assert_allclose(state.lift, 0.5 * c, rtol=1e-13)
    assert state.memory.tolist() == [0.25]
    assert run.label == "exact modal, energy law, dt omega_max = 1.4 (no limit)"
    assert run.velocity().tolist() == [1.0, -2.0, 5.0]
    state.q[:], state.memory[0] = (0.1, 0.2, 0.3), -0.4
    found = run.stored()
    kinetic, strain = 0.5 * 30.0, 0.5 * (9.0 * 0.04 + 4900.0 * 0.09)
    potential = system.potential - (0.05 + 0.8 - 27.0)
    assert (found.kinetic, found.strain, found.potential) == pytest.approx((kinetic, strain, potential), rel=1e-13)
    assert found.residual == pytest.approx(0.5 * 0.16 / 0.2, rel=1e-13)
    assert found.discrete == pytest.approx(kinetic + strain + potential, rel=1e-13)
    state.memory[0] = 0.3
    assert run.stored().residual == 0.0


def test_a_mean_velocity_is_that_of_the_one_rigid_mode_of_a_body():
    rod = ct.Rod(length=2.0, area=0.5, E=8.0, rho=3.0, x=-2.0, velocity=0.7)
    held = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="right")
    run = ct.ExactModal(modes=5).prepare(assemble([rod, held]), ct.Unilateral(), dt=1e-3, courant=None)
    free, fixed = run.motions()
    assert (free.mean_velocity, free.momentum) == pytest.approx((0.7, 0.7 * 3.0), rel=1e-12)
    assert (free.number, fixed.number) == (0, 1)
    assert math.isnan(fixed.mean_velocity)
    assert [block[1:] for block in run.blocks] == [(0, 5), (5, 10)]
