"""One measure of a rim's deflection: in the loop, in slots, in the growth of a run and on pages."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.deflection import around, deflection, sizes
from contact.model.gaps.rub import rub_of
from contact.recovery.around_rim import rim_motion
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

EVERY = ct.Record(every=1, state_every=1)
WALL = 2e-6  # thin enough that the motions below pass half of it


def rubbing(kind, wall=WALL):
    """A scene whose rim deflects by more than half its wall, its waves mixed and its compliance large."""
    if kind == "rim":
        what = ct.RotatingRim(
            replace(ring(S=4e-7, imperfect=0.1), thickness=wall), blade(S=1e-6), clearance=-1e-5, speed_hz=20.0,
            lean_deg=25.0,
        )  # fmt: skip
    else:
        what = ct.Rub(
            replace(rim3(S=2e-7), thickness=wall), (nodes(3),), tips(3), clearance=-1e-5, speed=ct.Speed.constant(20.0)
        )
    return ct.Scene(what=what, law=ct.Coulomb(mu=0.2), t_end=0.03, dt=2e-5, record=EVERY, on_limit="flag")


def measured(what, result):
    """The deflection at 6,720 points of every line, from modes and compliance written out."""
    rub, theta = rub_of(what), (np.arange(6720) + 0.5) * (2.0 * np.pi / 6720)
    N, D = rub.casing.n_max, rub.casing.directions
    h = np.concatenate([np.cos(np.outer(theta, np.arange(N + 1))), np.sin(np.outer(theta, np.arange(1, N + 1)))], 1)
    found = []
    for t, q, lam in zip(result.state_time, result.state_of("casing"), result.tip_force, strict=True):
        pressed = np.zeros(len(rub.casing.channels)).reshape(-1, D, 2 * N + 1)
        for j, tip in enumerate(rub.tips):
            phi = np.radians(tip.angle_deg) - 2.0 * np.pi * 20.0 * t
            waves = np.concatenate([np.cos(phi * np.arange(N + 1)), np.sin(phi * np.arange(1, N + 1))])
            for i, force in enumerate(lam.reshape(len(rub.tips), -1)[j]):
                pressed[tip.line, i] += force * waves
        u = (rub.casing.rows @ q + rub.casing.S @ pressed.ravel()).reshape(-1, D, 2 * N + 1)[:, 0]
        found.append(np.abs(u @ h.T).max())
    return np.array(found)


def test_the_largest_deflection_around_is_that_of_the_sum_over_all_angles():
    z, theta = np.random.default_rng(53).normal(size=(7, 17)), np.linspace(0.0, 2.0 * np.pi, 20_000)
    waves = [np.cos(n * theta) for n in range(9)] + [np.sin(n * theta) for n in range(1, 9)]
    exact = np.abs(z @ np.array(waves)).max(axis=1)
    np.testing.assert_allclose(around(z), exact, rtol=0.005)


@pytest.mark.parametrize("kind", ["rim", "rub"])
@pytest.mark.slow
def test_deflection_is_the_largest_around_all_lines_with_residual_compliance(kind):
    scene = rubbing(kind)
    result = ct.run(scene)
    exact, motion = measured(scene.what, result), rim_motion(scene.what, result)
    assert np.all(motion.deflection <= exact * (1.0 + 1e-5))
    np.testing.assert_allclose(motion.deflection, exact, rtol=0.005, atol=1e-3 * exact.max())
    modes = deflection(rub_of(scene.what), result.state_time, result.state_of("casing"), 0.0 * result.tip_force)
    assert np.abs(modes / motion.deflection - 1.0)[10:].max() > 0.1  # compliance counts


@pytest.mark.parametrize("kind", ["rim", "rub"])
@pytest.mark.slow
def test_loop_states_growth_flag_and_page_have_one_largest_deflection(kind):
    scene = rubbing(kind)
    result = ct.run(scene)
    motion = rim_motion(scene.what, result)
    assert motion.largest > motion.allowed
    assert result.notes.deflection == pytest.approx(motion.deflection.max(), rel=1e-9)  # of loop and states
    assert f"rim deflected by {motion.largest:.3g} m" in " ".join(map(str, result.flags))
    late = motion.deflection[result.state_time >= result.growth.since]
    assert result.growth.amplitude == pytest.approx(late.max(), rel=1e-12)
    below = ct.run(rubbing(kind, wall=1.0))
    assert below.notes.deflection == 0.0
    assert rim_motion(scene.what, below).largest == motion.deflection.max()


@pytest.mark.parametrize("kind", ["rim", "rub"])
@pytest.mark.slow
def test_the_largest_deflections_of_parts_are_those_of_all_instants(kind):
    scene = rubbing(kind)
    result = ct.run(scene)
    given = rub_of(scene.what), result.state_time, result.state_of("casing"), result.tip_force
    every, few = deflection(*given), sizes(*given)
    assert np.all(few.bound >= every)
    for starts in ([0], [3, 200, 201, 700], [0, 10, 10, every.size - 1], list(range(0, every.size, 7))):
        expected = np.maximum.reduceat(every, starts)
        np.testing.assert_allclose(few.largest(np.array(starts)), expected, rtol=1e-12)
    for limit in (0.0, 0.5 * every.max(), 0.999999 * every.max()):
        assert few.first_above(limit) == np.flatnonzero(every > limit)[0]
    assert few.first_above(1.000001 * every.max()) is None


@pytest.mark.slow
def test_the_growth_of_a_run_within_its_limits_counts_the_residual_compliance():
    scene = replace(rubbing("rim", wall=1.0), t_end=0.1)
    result = ct.run(scene)
    late = result.state_time >= result.growth.since
    assert result.growth.amplitude == pytest.approx(rim_motion(scene.what, result).deflection[late].max(), rel=1e-12)
    modes = deflection(rub_of(scene.what), result.state_time, result.state_of("casing"), 0.0 * result.tip_force)
    assert abs(result.growth.amplitude / modes[late].max() - 1.0) > 0.004  # which is less than the modes alone, here


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
