"""One measure of a rim's deflection: in the loop, in lanes, in the growth of a run and on pages."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3
from tests.contact.synthetic_rub import tips as tips_of

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
            replace(rim3(S=2e-7), thickness=wall),
            (nodes(3),),
            tips_of(3),
            clearance=-1e-5,
            speed=ct.Speed.constant(20.0),
        )
    return ct.Scene(what=what, law=ct.Coulomb(mu=0.2), t_end=0.03, dt=2e-5, record=EVERY, on_limit="flag")


def measured(what, result):
    """The deflection at 6,720 points of every line, from modes and compliance written out."""
    theta = (np.arange(6720) + 0.5) * (2.0 * np.pi / 6720)
    # angle and line of each tip
    tips = (
        [(what.angle_deg, 0)] if isinstance(what, ct.RotatingRim) else [(tip.angle_deg, tip.line) for tip in what.tips]
    )
    casing = what.casing
    N, D = casing.n_max, casing.directions
    h = np.concatenate([np.cos(np.outer(theta, np.arange(N + 1))), np.sin(np.outer(theta, np.arange(1, N + 1)))], 1)
    found = []
    for t, q, lam in zip(result.state_time, result.state_of("casing"), result.tip_force, strict=True):
        pressed = np.zeros(len(casing.channels)).reshape(-1, D, 2 * N + 1)
        for j, (angle, line) in enumerate(tips):
            phi = np.radians(angle) - 2.0 * np.pi * 20.0 * t
            waves = np.concatenate([np.cos(phi * np.arange(N + 1)), np.sin(phi * np.arange(1, N + 1))])
            for i, force in enumerate(lam.reshape(len(tips), -1)[j]):
                pressed[line, i] += force * waves
        u = (casing.rows @ q + casing.S @ pressed.ravel()).reshape(-1, D, 2 * N + 1)[:, 0]
        found.append(np.abs(u @ h.T).max())
    return np.array(found)


@pytest.mark.parametrize("kind", ["rim", "rub"])
@pytest.mark.slow
def test_the_largest_deflection_counts_all_lines_and_residual_compliance(kind):
    """Of the whole run, of the late part that the growth reads, and in the warning."""
    scene = rubbing(kind)
    result = ct.run(scene)
    exact = measured(scene.what, result)
    assert result.notes.deflection > 0.5 * WALL
    assert result.notes.deflection == pytest.approx(exact.max(), rel=0.005)
    assert f"rim deflected by {result.notes.deflection:.3g} m" in " ".join(map(str, result.flags))
    late = exact[result.state_time >= result.growth.since].max()
    assert result.growth.amplitude == pytest.approx(late, rel=0.005)
    begun = ct.run(replace(scene, t_end=2e-4))
    exact = measured(scene.what, begun)
    assert begun.notes.deflection == pytest.approx(exact.max(), rel=0.005)
    modes = measured(scene.what, replace(begun, tip_force=0.0 * begun.tip_force))
    assert modes.max() < 0.5 * exact.max()  # in the first steps the compliance counts most
    assert ct.run(rubbing(kind, wall=1.0)).notes.deflection == 0.0


@pytest.mark.slow
def test_lanes_note_the_deflection_of_a_run_alone():
    scenes = [rubbing("rim", wall) for wall in (WALL, 1.5 * WALL, 1.0)]
    scenes.append(replace(scenes[0], what=replace(scenes[0].what, casing=replace(ring(S=4e-7), thickness=WALL))))
    for scene, outcome in zip(scenes, ct.run_many(scenes), strict=True):
        assert outcome.notes.deflection == pytest.approx(ct.run(scene).notes.deflection, rel=1e-9)
