"""A rim and its blade over speed: the closed contact's poles, a run in time, and a scene file."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.growth.cycles.shooting import map_of
from contact.model.gaps.permanent import SplitError, rim_contact
from tests.contact.synthetic_rim import blade, ring

pytestmark = pytest.mark.slow
WAVES = [{"p": 2, "cos": 2e-5}, {"p": 3, "cos": 3e-6, "sin": 5e-6}]


def rim(*, clearance=2e-6, zeta=0.02, speed_hz=5.0, waves=WAVES, S=2e-8, angle_deg=0.0):
    return ct.RotatingRim(
        ring(zeta=zeta), blade(zeta=zeta, S=S), clearance=clearance, speed_hz=speed_hz, lean_deg=10.0,
        out_of_roundness=waves, angle_deg=angle_deg,
    )  # fmt: skip


@pytest.mark.parametrize(("mu", "speed"), [(0.0, 5.0), (0.05, 5.0), (0.05, -8.0)])
def test_a_permanent_contact_is_a_fixed_point_with_its_poles(mu, speed):
    pressed = rim(clearance=-1e-5, waves=(), zeta=0.002, speed_hz=speed)
    found = ct.growth.cycles.orbit(ct.growth.cycles.RimFamily(rim=pressed, mu=mu), speed, settle=50)
    poles = ct.growth.poles(rim_contact(pressed, mu=mu), np.array([speed]))[0]
    expected = np.sort(np.abs(np.exp(poles * found.period)))
    assert np.sort(np.abs(found.multipliers)) == pytest.approx(expected, abs=1e-9)
    assert found.touching == (0,)
    assert found.closings == (0,)
    assert found.period == pytest.approx(1.0 / abs(speed))


@pytest.mark.parametrize(("mu", "angle", "speed"), [(0.0, 0.0, 5.0), (0.05, 30.0, 5.0), (0.05, 30.0, -5.0)])
def test_a_rub_is_what_a_run_settles_on(mu, angle, speed):
    turning = rim(angle_deg=angle, speed_hz=speed)
    found = ct.growth.cycles.orbit(ct.growth.cycles.RimFamily(rim=turning, mu=mu), speed, settle=20)
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    run = ct.run(turning, law=law, scheme=ct.ExactModal(law="averaged"), t_end=3.0, dt=2e-6,
                 record=ct.Record(every=1))  # fmt: skip
    last = run.time > 2.8
    assert found.stable
    assert found.force[0] == pytest.approx(run.force[last].max(), rel=1e-4)
    closed = np.concatenate([[False], run.force[last][:, 0] > 0.0])
    assert found.closings[0] == np.count_nonzero(closed[1:] & ~closed[:-1])


def test_out_of_roundness_of_two_waves_repeats_twice_a_turn():
    family = ct.growth.cycles.RimFamily(rim=rim(waves=WAVES[:1]))
    _, period = family.at(5.0)
    assert period == pytest.approx(0.1)


def test_the_derivative_of_a_turn_is_that_of_the_motion():
    family = ct.growth.cycles.RimFamily(rim=rim(S=1e-6), mu=0.05)
    found = ct.growth.cycles.orbit(family, 5.0, settle=20)
    assert found.closings[0] > 0
    turn, x, step = map_of(family, 5.0, found.start), np.asarray(found.x), 1e-11
    columns = [(turn(x + step * e).x - turn(x - step * e).x) / (2.0 * step) for e in np.eye(x.size)]
    M = turn(x).M
    assert np.array(columns).T == pytest.approx(M, abs=1e-4 * np.abs(M).max())


def test_clearance_and_friction_may_vary():
    wide = ct.growth.cycles.RimFamily(rim=rim(), name="clearance")
    assert ct.growth.cycles.orbit(wide, 1e-4, settle=20).contacts == 0
    rough = ct.growth.cycles.RimFamily(rim=rim(), name="friction")
    smooth = ct.growth.cycles.RimFamily(rim=rim(), mu=0.05)
    one, other = ct.growth.cycles.orbit(rough, 0.05, settle=20), ct.growth.cycles.orbit(smooth, 5.0, settle=20)
    assert one.x == pytest.approx(other.x)


def test_what_has_no_such_frame_is_refused():
    split = ct.RotatingRim(ring(imperfect=0.01), blade(), clearance=1e-5, speed_hz=5.0)
    with pytest.raises(SplitError, match="perfect casing"):
        ct.growth.cycles.RimFamily(rim=split)
    with pytest.raises(ct.InputError, match="name: found 'gap'"):
        ct.growth.cycles.RimFamily(rim=rim(), name="gap")
    with pytest.raises(ct.InputError, match="expected a rim that turns"):
        ct.growth.cycles.orbit(ct.growth.cycles.RimFamily(rim=rim()), 0.0)


def test_friction_that_would_turn_is_refused():
    """The blade begins at 80 m/s along the rim, which passes at 14 m/s."""
    struck = replace(rim(clearance=-1e-5, waves=()), blade_velocity=np.array([50.0, 0.0]))
    with pytest.raises(ct.NumericsError, match="slip of contact 1 turns"):
        ct.growth.cycles.orbit(ct.growth.cycles.RimFamily(rim=struck, mu=0.05), 5.0, settle=1)


SCENE = """
[scene]
kind = "rim"
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = 5e-6
friction = 0.05
out_of_roundness = [{p = 2, cos = 2e-5}]
[speed]
from_hz = 22.0
to_hz = 24.0
"""


def test_a_scene_of_a_rim_is_followed_over_its_speeds(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    ring(zeta=0.01).save(tmp_path / "casing.npz")
    blade(zeta=0.01, S=1e-5).save(tmp_path / "blade.npz")
    scene = ct.scene.load_cycles(tmp_path / "scene.toml")
    assert scene.family.mu == 0.05
    found = scene.solve()
    assert found.name == "speed_hz"
    points = found.branches[0].points
    assert [points[0].value, points[-1].value] == [22.0, 24.0]
    assert max(point.amplitude["casing"] for point in points) > 1.3 * points[0].amplitude["casing"]
    assert found.branches[0].stable.all()
    for old, new, words in (
        ("to_hz = 24.0", "to_hz = -1.0", "speed: 22 to -1 found"),
        ("friction", "fricton", "contact.fricton: unknown key"),
        ("clearance = 5e-6", "clearance = 5.0", "clearance: found 5 m"),
    ):
        (tmp_path / "scene.toml").write_text(SCENE.replace(old, new))
        with pytest.raises(ct.scene.SceneError, match=words):
            ct.scene.load_cycles(tmp_path / "scene.toml")
