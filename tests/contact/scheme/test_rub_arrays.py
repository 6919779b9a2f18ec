"""Arrays of a rub: residual compliance by angle, Delassus numbers and limits against matrices of all tips."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.limits import motion_limits
from contact.model.gaps.rub_system import rub_system
from contact.model.trig import fourier
from contact.scheme.modal import rub_arrays, rub_delassus, rub_stepper
from contact.scheme.modal.propagator import propagator
from tests.contact.synthetic_rub import nodes, rim3, tips

H = 2e-5


def scene(*, hz=4.0, **more):
    """Two blades of different sizes before a rim of two lines, five modes seen in three directions."""
    given = {"clearance": -3e-5, "speed": ct.Speed.constant(hz)} | more
    places = [*tips(2, angle=33.0), *tips(1, blade=1, angle=190.0, lean=-20.0)]
    return ct.Rub(rim3(), (nodes(2), nodes(1, seed=6)), places, **given)


def arrays(rub, dimensions):
    system = rub_system(rub, dimensions)
    return system, propagator(system.omega, system.zeta, system.load, H)


def waves(blocks, harmonic, cos, sin, phi):
    """Sum over harmonics of what `blocks` name, at an angle."""
    return np.tensordot(np.cos(harmonic * phi), cos[blocks], axes=1) + np.tensordot(
        np.sin(harmonic * phi), sin[blocks], axes=1
    )


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_waves_between_tips_sum_to_their_compliance_at_every_angle(dimensions):
    system, _ = arrays(scene(), dimensions)
    harmonic, cos, sin = rub_arrays._between_tips(system.S, system.still, system.angle, system.line)
    size = system.contacts * dimensions
    assert cos.shape == sin.shape == (system.contacts, harmonic.size, dimensions * size)
    assert sorted(set(harmonic.tolist())) == harmonic.tolist()
    for turned in (0.0, 0.7, -2.0):
        whole = system.compliance(turned) - system.still
        for j, angle in enumerate(system.angle):
            found = waves(j, harmonic, cos, sin, angle - turned).reshape(dimensions, size)
            exact = whole[j * dimensions : (j + 1) * dimensions]
            np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-13 * np.abs(whole).max())


def test_waves_that_compliance_can_make_are_sums_and_differences_of_those_it_couples():
    S = np.zeros((2, 9, 2, 9))  # waves 1, cos 1 .. cos 4, sin 1 .. sin 4
    S[0, 2, 1, 8] = S[1, 1, 1, 1] = S[1, 5, 0, 3] = S[0, 4, 0, 4] = 1.0
    # cos 2 with sin 4, cos 1 with cos 1, sin 1 with cos 3, cos 4 with cos 4
    assert rub_arrays._products(S).tolist() == [0, 2, 4, 6, 8]


def test_rows_of_compliance_between_waves_are_those_of_the_matrix():
    rng = np.random.default_rng(3)
    S = rng.standard_normal((2, 7, 2, 7))
    harmonic, cos, sin = rub_arrays._between_waves(S, 8)
    assert harmonic.tolist() == [0, 1, 2, 3]
    phi = 0.37
    h = np.concatenate([np.cos(phi * np.arange(4)), np.sin(phi * np.arange(1, 4))])
    for block in range(2):
        found = waves(block, harmonic, cos, sin, phi).reshape(2, 2, 8)
        exact = np.tensordot(h, S[block], axes=1)  # (block, wave)
        np.testing.assert_allclose(found[:, 0, :4], exact[:, :4], rtol=1e-12)
        np.testing.assert_allclose(found[:, 1, 1:4], exact[:, 4:], rtol=1e-12)
        assert not found[:, :, 4:].any()
        assert not found[:, 1, 0].any()


def dense_delassus(rub, system, parts, mu):
    """H_d and S of every tip at every sampled angle, from the rows of all bodies."""
    d, found = len(system.blade_rows) // system.contacts, []
    pull = math.copysign(mu, rub.speed.hz[np.abs(rub.speed.hz).argmax()])
    for step in range(rub_delassus.ANGLES):
        turned = step * 2.0 * math.pi / rub_delassus.ANGLES
        S = system.compliance(turned)
        for j in range(system.contacts):
            rows = np.zeros((2, system.omega.size))
            begin, end = system.own[j]
            for i in range(min(2, d)):
                block = int(system.line[j]) * system.directions + i
                rim = system.rim.rows(block, float(system.angle[j]) - turned)
                rows[i, : rim.size] = rim
                rows[i, begin:end] = system.blade_rows[j * d + i, : end - begin]
            across = S[j * d, j * d + 1] if d > 1 else 0.0
            found.append((float(rows[0] * parts.c @ (rows[0] - pull * rows[1])), S[j * d, j * d] - pull * across, j))
    return found


@pytest.mark.parametrize(("mu", "hz", "dimensions"), [(0.0, 4.0, 1), (0.02, 4.0, 2), (0.02, -4.0, 3), (0.0, 4.0, 2)])
def test_delassus_numbers_are_those_of_the_tip_and_angle_with_the_largest_ratio(mu, hz, dimensions):
    rub = scene(hz=hz)
    system, parts = arrays(rub, dimensions)
    exact = max(dense_delassus(rub, system, parts, mu), key=lambda pair: abs(pair[0]) / pair[1])
    found = rub_delassus.rub_delassus(rub, system, parts, mu)
    assert found == pytest.approx((*exact[:2], abs(exact[0]) / exact[1]), rel=1e-9)


def test_a_tip_that_jams_is_named_with_its_angle_and_numbers():
    rub = scene()
    system, parts = arrays(rub, 2)
    H_d, S, tip = next(each for each in dense_delassus(rub, system, parts, 30.0) if each[0] + each[1] <= 0.0)
    words = rf"found H_d \+ S = {H_d + S:.4g} m/N at tip {tip}, .* deg, mu = 30, expected > 0"
    with pytest.raises(ct.LimitError, match=words):
        rub_delassus.rub_delassus(rub, system, parts, 30.0)


def test_delassus_numbers_without_a_turn_or_residual_compliance():
    still = scene(hz=0.0)
    system, parts = arrays(still, 2)
    assert rub_delassus.rub_delassus(still, system, parts, 0.3) == rub_delassus.rub_delassus(still, system, parts, 0.0)
    hard = replace(system, still=0.0 * system.still, S=np.zeros((0, 0, 0, 0)))
    assert rub_delassus.rub_delassus(still, hard, parts, 0.0)[1:] == (0.0, math.inf)


def test_speed_stiffens_the_modes_of_each_blade_by_its_own_basis():
    K, hz = np.array([[3.0, 1.0, 0.5], [1.0, 2.0, 0.0], [0.5, 0.0, 1.0]]), 7.0
    rub = scene()
    system, _ = arrays(rub, 1)
    assert [part.shape for part in rub_arrays._stiffening(rub, system)] == [(0, 0), (0, 0)]
    rub = replace(rub, stiffening=(ct.gaps.Stiffening(blade=1, stiffness_by_speed=K, at_hz=hz),))
    plain, squared = rub_arrays._stiffening(rub, system)
    exact = np.zeros((6, 6))
    exact[3:, 3:] = K
    assert plain.tolist() == exact.tolist()
    np.testing.assert_allclose(squared, exact * (2.0 * np.pi * 7.0) ** 2, rtol=1e-14)


def test_a_rub_is_measured_by_its_largest_gap_law():
    def play(own=0.0, **parts):
        places = [replace(tips(1)[0], clearance=own)]
        return rub_stepper._play(
            ct.Rub(rim3(), (nodes(1),), places, **{"clearance": 0.0, "speed": ct.Speed.constant(1.0)} | parts)
        )

    assert play() == 1e-9
    assert play(clearance=-3e-5) == 3e-5
    assert play(5e-5, clearance=-2e-5) == pytest.approx(3e-5, rel=1e-12)
    assert play(whirl=(ct.gaps.Whirl(amplitude=4e-5, per_rev=1.0),)) == 4e-5
    assert play(closing=ct.gaps.Closing([0.0, 1.0], [0.0, -6e-5])) == 6e-5
    assert play(profile=ct.RimProfile.fourier([{"p": 2, "cos": 7e-5}])) == pytest.approx(7e-5, rel=1e-3)


def test_a_tip_that_moves_far_along_the_rim_is_flagged():
    rub = ct.Rub(rim3(), (nodes(1),), tips(1), clearance=-3e-5, speed=ct.Speed.constant(1.0))
    system, _ = arrays(rub, 1)
    edge = math.sqrt(0.1 * 3e-5 * 2.0 * 0.4)  # curvature changes the gap by a tenth of 3e-5 m
    assert rub_stepper._flags(rub, system, 0.999 * edge) == ()
    (said,) = rub_stepper._flags(rub, system, 1.001 * edge)
    assert said.startswith("a tip moved 0.00155 m along the rim")
    assert f"by {3.0e-6 * 1.001**2:.3g} m" in said


def test_the_overlap_at_the_start_is_that_of_the_deepest_tip():
    q = np.array([2e-6, -1e-6, 3e-6])
    whirl = ct.gaps.Whirl(amplitude=4e-6, per_rev=1.0, phase_deg=25.0)
    waviness = [{"p": 2, "cos": 2e-5, "sin": -1e-5}]
    more = {
        "profile": ct.RimProfile.fourier(waviness), "whirl": (whirl,),
        "closing": ct.gaps.Closing([0.0, 1.0], [2e-6, 0.0]),
        "blade_starts": (ct.gaps.Start(displacement=q), ct.gaps.Start(displacement=-q)),
        "casing_start": ct.gaps.Start(displacement=1e-6 * np.arange(10.0)),
    }  # fmt: skip
    rub = scene(**more)
    run = ct.ExactModal().prepare(rub, ct.Unilateral(), dt=H, courant=None)
    gaps, profile = [], fourier([(2, 2e-5, -1e-5)])
    for tip in rub.tips:
        phi, line = math.radians(tip.angle_deg), tip.line * 3 * 11
        h = np.concatenate([np.cos(phi * np.arange(6)), np.sin(phi * np.arange(1, 6))])
        rim = h @ rub.casing.rows[line : line + 11] @ (1e-6 * np.arange(10.0))
        blade = rub.blades[tip.blade]
        normal = tip.directions(blade)[0] @ blade.rows @ (q if tip.blade == 0 else -q)
        shift = 4e-6 * math.cos(phi - math.radians(25.0)) - 2e-6
        gaps.append(rub.clearance + tip.clearance + profile(phi) + shift + rim - normal)
    assert min(gaps) < 0.0
    assert run.overlap == pytest.approx(-min(gaps), rel=1e-10)
    free = ct.ExactModal().prepare(scene(clearance=1e-3), ct.Unilateral(), dt=H, courant=None)
    assert free.overlap == 0.0


def test_energy_of_forces_at_rest_is_that_of_the_compliance_of_the_last_angle():
    run = ct.ExactModal().prepare(scene(), ct.Coulomb(mu=0.1), dt=H, courant=None)
    lam = np.arange(1.0, 1.0 + run.state.lam.size)
    run.state.lam[:] = lam
    run.steps[0] = 1000
    S = run.system.compliance(2.0 * np.pi * 4.0 * 999 * H)
    assert run.stored().residual == pytest.approx(0.5 * lam @ S @ lam, rel=1e-10)


def test_a_rub_names_its_bodies_and_their_coordinates():
    run = ct.ExactModal().prepare(scene(), ct.Coulomb(mu=0.1), dt=H, courant=None)
    assert [block[1:] for block in run.blocks] == [(0, 10), (10, 13), (13, 16), (16, 25)]
    assert run.blocks[-1][0] == "tips"
    assert [(motion.kind, motion.number) for motion in run.motions()] == [("casing", 0), ("blade", 1), ("blade", 2)]
    assert run.size == 25
    assert ct.ExactModal().prepare(scene(), ct.Unilateral(), dt=H, courant=None).size == 19
    assert run.window == pytest.approx(2.0 * np.pi / 9000.0, rel=1e-12)


def test_a_rub_starts_with_weights_of_damping_and_the_limit_of_its_smaller_rim():
    load = np.arange(10.0)
    rub = scene(casing_start=ct.gaps.Start(load=load))
    system, parts = arrays(rub, 1)
    narrow = replace(system, radius=np.array([0.5, 0.4, 0.45]))
    s = rub_arrays.rub_state(rub, narrow, parts, 0.3, 1)
    np.testing.assert_allclose(s.kick[:10], parts.c[:10] * load, rtol=1e-13)
    np.testing.assert_allclose(s.weight, (1.0 - parts.al) / (2.0 * parts.c), rtol=1e-13)
    np.testing.assert_allclose(s.d, parts.backward(np.zeros(16), np.zeros(16)), rtol=1e-13)
    assert s.limits.tolist() == motion_limits(0.4, rub.wall).tolist()
    assert (s.mu.tolist(), s.lam.size, s.seen.size) == ([0.3] * 3, 3, 19)


def test_turning_terms_whirl_and_closing_are_tables_of_the_loop():
    whirl = ct.gaps.Whirl(amplitude=4e-6, per_rev=-2.0, hz=3.0, phase_deg=25.0)
    profile = ct.RimProfile.fourier([{"p": 2, "cos": 2e-5, "sin": -1e-5}])
    rub = scene(whirl=(whirl,), closing=ct.gaps.Closing([0.0, 1.0], [2e-6, 5e-6]), profile=profile)
    laws = rub_arrays.rub_laws(rub, arrays(rub, 1)[0], 1e-5)
    np.testing.assert_allclose(laws.whirl, [[4e-6, -2.0, 6.0 * math.pi, math.radians(25.0)]], rtol=1e-13)
    assert laws.closing.tolist() == [[0.0, 2e-6], [1.0, 5e-6]]
    assert (laws.terms.harmonic.tolist(), laws.terms.cos.tolist(), laws.terms.sin.tolist()) == ([2], [2e-5], [-1e-5])
    assert laws.pulls.laws.shape == (0, 8)
    assert rub_arrays.rub_laws(scene(), arrays(scene(), 1)[0]).whirl.shape == (0, 4)
