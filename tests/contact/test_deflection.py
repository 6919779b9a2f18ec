"""One measure of a rim's deflection: in the loop, in slots, in the growth of a run and on pages."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

EVERY = ct.Record(every=1, state_every=1)
WALL = 2e-6  # thin enough that the motions below pass half of it


def rubbing(kind, wall=WALL, S=4e-7):
    """A scene whose rim deflects by more than half its wall, its waves mixed and its compliance large."""
    if kind == "rim":
        what = ct.RotatingRim(
            replace(ring(S=S, imperfect=0.1), thickness=wall), blade(S=1e-6), clearance=-1e-5, speed_hz=20.0,
            lean_deg=25.0,
        )  # fmt: skip
    else:
        what = ct.Rub(
            replace(rim3(S=2e-7), thickness=wall), (nodes(3),), tips(3), clearance=-1e-5, speed=ct.Speed.constant(20.0)
        )
    return ct.Scene(what=what, law=ct.Coulomb(mu=0.2), t_end=0.03, dt=2e-5, record=EVERY, on_limit="flag")


def measured(what, result):
    """The deflection at 6,720 points of every line, from modes and compliance written out."""
    theta, casing = (np.arange(6720) + 0.5) * (2.0 * np.pi / 6720), what.casing
    tips = what.tips if isinstance(what, ct.Rub) else [ct.ContactPoint(angle_deg=what.angle_deg)]
    N, D = casing.n_max, casing.directions
    h = np.concatenate([np.cos(np.outer(theta, np.arange(N + 1))), np.sin(np.outer(theta, np.arange(1, N + 1)))], 1)
    found = []
    for t, q, lam in zip(result.state_time, result.state_of("casing"), result.tip_force, strict=True):
        pressed = np.zeros(len(casing.channels)).reshape(-1, D, 2 * N + 1)
        for j, tip in enumerate(tips):
            phi = np.radians(tip.angle_deg) - 2.0 * np.pi * 20.0 * t
            waves = np.concatenate([np.cos(phi * np.arange(N + 1)), np.sin(phi * np.arange(1, N + 1))])
            for i, force in enumerate(lam.reshape(len(tips), -1)[j]):
                pressed[tip.line, i] += force * waves
        u = (casing.rows @ q + casing.S @ pressed.ravel()).reshape(-1, D, 2 * N + 1)[:, 0]
        found.append(np.abs(u @ h.T).max())
    return np.array(found)


def without_forces(result):
    """The same states without the forces of the tips: motion of the modes alone."""
    return replace(result, tip_force=0.0 * result.tip_force)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["rim", "rub"])
def test_the_largest_deflection_around_is_that_of_the_sum_over_all_angles(kind):
    """For drawn states, whose waves are all of one size."""
    what = rubbing(kind).what
    result = ct.run(rubbing(kind), t_end=4e-3)
    drawn = replace(result, state=1e-6 * np.random.default_rng(53).standard_normal(result.state.shape))
    found = ct.recovery.rim_motion(what, drawn).deflection
    exact = measured(what, drawn)
    assert np.all(found <= exact * (1.0 + 1e-5))
    np.testing.assert_allclose(found, exact, rtol=0.005)


@pytest.mark.parametrize("kind", ["rim", "rub"])
@pytest.mark.slow
def test_deflection_is_the_largest_around_all_lines_with_residual_compliance(kind):
    scene = rubbing(kind)
    result = ct.run(scene)
    exact, motion = measured(scene.what, result), ct.recovery.rim_motion(scene.what, result)
    assert np.all(motion.deflection <= exact * (1.0 + 1e-5))
    np.testing.assert_allclose(motion.deflection, exact, rtol=0.005, atol=1e-3 * exact.max())
    modes = ct.recovery.rim_motion(scene.what, without_forces(result)).deflection
    assert np.abs(modes / motion.deflection - 1.0)[10:].max() > 0.1  # compliance counts


@pytest.mark.parametrize("kind", ["rim", "rub"])
@pytest.mark.slow
def test_loop_states_growth_flag_and_page_have_one_largest_deflection(kind):
    scene = rubbing(kind)
    result = ct.run(scene)
    motion = ct.recovery.rim_motion(scene.what, result)
    assert motion.largest > motion.allowed
    assert result.notes.deflection == pytest.approx(motion.deflection.max(), rel=1e-9)  # of loop and states
    assert f"rim deflected by {motion.largest:.3g} m" in " ".join(map(str, result.flags))
    late = motion.deflection[result.state_time >= result.growth.since]
    assert result.growth.amplitude == pytest.approx(late.max(), rel=1e-12)
    below = ct.run(rubbing(kind, wall=1.0))
    assert below.notes.deflection == 0.0
    assert ct.recovery.rim_motion(scene.what, below).largest == motion.deflection.max()


@pytest.mark.slow
@pytest.mark.parametrize("S", [4e-7, 4e-6])
def test_the_growth_of_a_run_within_its_limits_counts_the_residual_compliance(S):
    scene = replace(rubbing("rim", wall=1.0, S=S), t_end=0.1)
    result = ct.run(scene)
    late = result.state_time >= result.growth.since
    assert result.growth.amplitude == pytest.approx(
        ct.recovery.rim_motion(scene.what, result).deflection[late].max(), rel=1e-12
    )
    modes = ct.recovery.rim_motion(scene.what, without_forces(result)).deflection
    assert abs(result.growth.amplitude / modes[late].max() - 1.0) > 0.004  # which is less than the modes alone, here


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.2, 0.6])
def test_a_growing_motion_reaches_half_the_wall_at_the_first_state_beyond_it(share):
    """A pressed pair at the speed of its sum condition; the run goes on, and its deflection falls below it again."""
    pair = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5),
        blade=ct.gaps.ModalPair(freq_hz=100.0, modal_mass=0.2), compliance=1e-4,
    )  # fmt: skip
    body = ct.ModalBody(
        omega=[2.0 * np.pi * 100.0], zeta=[0.0], channels=("span", "flap"), rows=[[0.2**-0.5], [0.0]],
        S=1e-4 * np.eye(2),
    )  # fmt: skip
    speed = ct.stability.of_contact(pair.contact(), np.linspace(95.0, 110.0, 151)).peak_speed_hz
    rim = replace(ct.gaps.pair_rim(pair.casing, radius=0.5), thickness=1.0)
    rub = ct.Rub(rim, (body,), clearance=-1e-3, speed=ct.Speed.constant(speed))
    scene = ct.Scene(what=rub, t_end=0.3, dt=2e-5, record=ct.Record(state_every=10), on_limit="flag")
    size = ct.recovery.rim_motion(rub, ct.run(scene)).deflection
    thin = replace(scene, what=replace(rub, casing=replace(rim, thickness=2.0 * share * size.max())))
    result = ct.run(thin)
    beyond = np.flatnonzero(size > share * size.max())
    assert size[beyond[0] :].min() < share * size.max()
    assert result.growth.state == "grows"
    assert result.growth.time_to_half_wall == result.state_time[beyond[0]]


@pytest.mark.parametrize("kind", ["rim", "rub"])
@pytest.mark.slow
def test_the_loop_notes_the_static_deflection_of_the_first_step(kind):
    """The bodies begin at rest and inside each other: no mode has moved, and the residual compliance alone deflects."""
    scene = replace(rubbing(kind, wall=1e-12), t_end=2e-5)
    result = ct.run(scene)
    exact = measured(scene.what, result)[0]
    assert not result.state_of("casing")[0].any()
    assert exact > 1e-8
    assert result.notes.deflection == pytest.approx(exact, rel=0.005)


@pytest.mark.slow
def test_batches_note_the_deflection_of_a_run_alone():
    scenes = [rubbing("rim", wall) for wall in (WALL, 1.5 * WALL, 1.0)]
    scenes.append(replace(scenes[0], what=replace(scenes[0].what, casing=replace(ring(S=4e-7), thickness=WALL))))
    for scene, outcome in zip(scenes, ct.run_many(scenes), strict=True):
        assert outcome.notes.deflection == pytest.approx(ct.run(scene).notes.deflection, rel=1e-9)
