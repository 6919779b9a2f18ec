"""A rim and its blade over speed: the closed contact's poles, a run in time, and a scene file."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.stability.test_turning_bodies import turning_ring
from tests.contact.synthetic_rim import blade, ring

pytestmark = pytest.mark.slow
WAVES = [{"p": 2, "cos": 2e-5}, {"p": 3, "cos": 3e-6, "sin": 5e-6}]


def rim(*, clearance=2e-6, zeta=0.02, speed_hz=5.0, waves=WAVES, S=2e-8, angle_deg=0.0):
    return ct.RotatingRim(
        ring(zeta=zeta), blade(zeta=zeta, S=S), clearance=clearance, speed_hz=speed_hz, lean_deg=10.0,
        out_of_roundness=waves, angle_deg=angle_deg,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("mu", "speed", "casing"), [(0.0, 5.0, ring), (0.05, 5.0, ring), (0.05, -8.0, ring), (0.05, 8.0, turning_ring)]
)
def test_a_permanent_contact_is_a_fixed_point_with_its_poles(mu, speed, casing):
    """Backwards it is left, so that no run settles on it: all begin at the rest under the pressing."""
    pressed = rim(clearance=-1e-5, waves=(), zeta=0.002, speed_hz=speed)
    pressed = replace(pressed, casing=casing(zeta=0.002))
    family = ct.cycles.RimFamily(rim=pressed, mu=mu)
    motion, _ = family.at(speed)
    plant, states = motion.plant, len(motion.plant.A)
    held = np.linalg.solve(
        np.block([[plant.A, plant.B], [plant.C, plant.S]]), np.concatenate([np.zeros(states), -motion.drive.c.rest])
    )
    found = ct.cycles.orbit(family, speed, guess=held[:states])
    assert found.force == pytest.approx(held[states:], rel=1e-9)
    poles = ct.stability.poles(ct.gaps.rim_contact(pressed, mu=mu), np.array([speed]))[0]
    expected = np.sort(np.abs(np.exp(poles * found.period)))
    assert np.sort(np.abs(found.multipliers)) == pytest.approx(expected, abs=1e-9)
    assert found.touching == (0,)
    assert found.closings == (0,)
    assert found.period == pytest.approx(1.0 / abs(speed))


def orbit_numbers(found):
    counts = [*found.closings, *found.rests, *found.touching, found.periods]
    return {
        "period": [found.period, found.value], "force": found.force, "amplitude": list(found.amplitude.values()),
        "counts": counts, "sizes": np.sort(np.abs(found.multipliers)),
    }  # fmt: skip


def settles(what, mu, speed, **search):
    """An orbit against the last turns of a run."""
    found = ct.cycles.orbit(ct.cycles.RimFamily(rim=what, mu=mu), speed, **search)
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    run = ct.run(what, law=law, scheme=ct.ExactModal(law="averaged"), t_end=3.0, dt=2e-6, record=ct.Record(every=1))
    last = run.time > 3.0 - 1.0 / abs(speed)
    assert found.stable
    assert found.force[0] == pytest.approx(run.force[last].max(), rel=1e-4)
    closed = np.concatenate([[False], run.force[last][:, 0] > 0.0])
    assert found.closings[0] == np.count_nonzero(closed[1:] & ~closed[:-1])
    return found


@pytest.mark.parametrize(("mu", "angle", "speed"), [(0.0, 0.0, 5.0), (0.05, 30.0, 5.0), (0.05, 30.0, -5.0)])
def test_a_rub_is_what_a_run_settles_on(mu, angle, speed, held):
    found = settles(rim(angle_deg=angle, speed_hz=speed), mu, speed, settle=20)
    held(1e-4, **orbit_numbers(found))


def test_growth_by_floquet_multipliers_is_that_of_a_run_beside_the_periodic_motion():
    """The contact opens twice a turn. From one turn to the next a run comes nearer to its end by the multiplier."""
    what, turn, dt = rim(zeta=0.01), 0.2, 1e-5
    found = ct.cycles.orbit(ct.cycles.RimFamily(rim=what, mu=0.05), 5.0, settle=60)
    assert found.closings[0] > 0
    steps = round(turn / dt)
    record = ct.Record(every=steps, state_every=steps)
    run = ct.run(
        what, law=ct.Coulomb(mu=0.05), scheme=ct.ExactModal(law="averaged"), t_end=32 * turn, dt=dt, record=record
    )
    moved = np.linalg.norm(np.diff(run.state[:, : what.casing.omega.size + what.blade.omega.size], axis=0), axis=1)
    late = slice(10, 30)
    rate = np.polyfit(turn * np.arange(moved.size)[late], np.log(moved[late]), 1)[0]
    assert found.growth == pytest.approx(rate, rel=0.03)
    assert found.growth < 0.0


@pytest.mark.parametrize("side", ["casing", "blades"])
def test_a_rub_of_bodies_that_turn_is_what_a_run_settles_on(side):
    turning = replace(
        rim(), casing=turning_ring(zeta=0.02), turning=side, speed_hz=8.0,
        blade=replace(blade(zeta=0.02), gyroscopic=[[0.0, 1.5], [-1.5, 0.0]], stiffness_by_speed=np.diag([30.0, 60.0])),
    )  # fmt: skip
    found = settles(turning, 0.05, 8.0, settle=20)
    still = replace(turning, casing=ring(zeta=0.02), blade=blade(zeta=0.02))
    other = ct.cycles.orbit(ct.cycles.RimFamily(rim=still, mu=0.05), 8.0, settle=20)
    assert abs(found.force[0] / other.force[0] - 1.0) > 1e-3


def test_out_of_roundness_of_two_waves_repeats_twice_a_turn():
    family = ct.cycles.RimFamily(rim=rim(waves=WAVES[:1]))
    _, period = family.at(5.0)
    assert period == pytest.approx(0.1)


COATING = {"E": 2e8, "yield_stress": 1e9, "hardening": 0.0, "thickness": 2e-3, "width": 0.02, "tip": 5e-3}


def two_blades(**given):
    tips = (ct.ContactPoint(angle_deg=20.0, lean_deg=10.0), ct.ContactPoint(blade=1, angle_deg=150.0, lean_deg=-5.0))
    profile = ct.gaps.RimProfile.fourier(WAVES)
    usual = {"tips": tips, "clearance": 2e-6, "speed": ct.Speed.constant(5.0), "profile": profile}
    return ct.Rub(ring(zeta=0.02), (blade(zeta=0.02), blade(zeta=0.02, psi=1.2)), **usual | given)


def test_two_blades_in_a_coating_are_what_a_run_settles_on(held):
    coating, rub = ct.Abradable(mu=0.05, **COATING), two_blades()
    family = ct.cycles.RimFamily(rim=rub, mu=0.05, stiffness=coating.under_tip)
    found = ct.cycles.orbit(family, 5.0, settle=20)
    run = ct.run(rub, law=coating, scheme=ct.ExactModal(law="averaged"), t_end=1.6, dt=5e-6, record=ct.Record(every=1))
    assert found.stable
    assert found.force == pytest.approx(run.force[run.time > 1.4].max(axis=0), rel=5e-4)
    assert list(found.amplitude) == ["casing_1", "span_1", "flap_1", "casing_2", "span_2", "flap_2"]
    held(1e-4, **orbit_numbers(found))


def test_a_fixed_offset_is_a_wave_of_one_lobe():
    """An offset in the casing passes once a turn; one that does not change before the blades only moves the gap."""
    waves = [{"p": 1, "cos": 3e-6, "sin": -4e-6}]
    offset = ct.gaps.Whirl(amplitude=5e-6, phase_deg=math.degrees(math.atan2(-4e-6, 3e-6)))
    none = ct.gaps.RimProfile()
    lobed, moved = two_blades(profile=ct.gaps.RimProfile.fourier(waves)), two_blades(profile=none, whirl=(offset,))
    motions = [ct.cycles.RimFamily(rim=rub).at(-7.0)[0] for rub in (lobed, moved)]
    drives, time = [motion.drive for motion in motions], 0.013
    passing = [lobed.profile(math.radians(angle) + 2.0 * math.pi * 7.0 * time) for angle in (20.0, 150.0)]
    assert drives[0].c.at(motions[0].angle(time)) == pytest.approx(2e-6 + np.array(passing), rel=1e-12)
    assert drives[1].c.wave == pytest.approx(drives[0].c.wave, abs=1e-18)
    eccentric = two_blades(profile=none, whirl=(ct.gaps.Whirl(amplitude=5e-6, per_rev=-1.0),))
    still = ct.cycles.RimFamily(rim=eccentric).at(5.0)[0].drive
    assert np.abs(still.c.wave).max() == 0.0
    assert still.c.rest == pytest.approx(2e-6 + 5e-6 * np.cos(np.radians([20.0, 150.0])), rel=1e-12)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_tip_gives_way_by_its_own_compliance_under_force_and_friction(sense):
    S, mu, lean = np.array([[2e-8, 5e-9], [5e-9, 6e-8]]), 0.3, math.radians(10.0)
    motion, _ = ct.cycles.RimFamily(rim=two_blades(), mu=mu).at(5.0 * sense)
    normal, tangent = np.array([math.cos(lean), math.sin(lean)]), np.array([-math.sin(lean), math.cos(lean)])
    assert motion.plant.E[1:3, 0] == pytest.approx(-S @ (normal - mu * sense * tangent), rel=1e-12)
    assert not motion.plant.E[4:6, 0].any()  # the other blade's


def test_a_worn_coating_is_felt_by_the_mean_over_the_tips_land():
    law, p = ct.Abradable(bars=4, **COATING), 9
    one = two_blades(tips=(ct.ContactPoint(),))
    wear = ct.run(one, law=law, t_end=1e-4, dt=1e-5).wear
    cells = wear.angle.size
    worn = 1e-5 * (1.0 + np.cos(p * (wear.angle - 0.3)))
    wear = replace(wear, made=np.zeros(cells), cut=np.zeros(cells), worn=worn)
    left, stiffness = ct.cycles.as_worn(one, law, wear, 12)
    h = math.pi / cells
    land = math.sin(4 * p * h) / (4.0 * math.sin(p * h))  # mean of a wave over four bars
    assert left.profile(0.3) == pytest.approx(1e-5 * (1.0 + land), rel=1e-9)
    assert left.profile(0.3 + math.pi / p) == pytest.approx(1e-5 * (1.0 - land), rel=1e-9)
    assert stiffness == pytest.approx(2e8 * 0.02 * 5e-3 / 2e-3)
    with pytest.raises(ct.InputError, match="expected one track of all 2 tips"):
        ct.cycles.as_worn(two_blades(), law, wear, 12)


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ({"closing": ct.gaps.Closing(time=[0.0, 1.0], by=[0.0, 1e-5])}, "closing"),
        ({"whirl": (ct.gaps.Whirl(amplitude=1e-6, hz=3.0),)}, "whirl"),
        ({"whirl": (ct.gaps.Whirl(amplitude=1e-6, per_rev=0.5),)}, "whirl"),
        ({"profile": ct.gaps.RimProfile(theta=[0.0, 2.0, 4.0], depth=[0.0, 1e-6, 0.0])}, "profile"),
        ({"casing_start": ct.gaps.Start(load=np.ones(10))}, "load"),
    ],
)
def test_what_has_no_period_of_a_turn_is_refused_with_the_way_out(given, word):
    with pytest.raises(ct.InputError, match=rf"^{word}: found one, expected none .* ct.run"):
        ct.cycles.RimFamily(rim=two_blades(**given))


def test_clearance_and_friction_may_vary():
    wide = ct.cycles.RimFamily(rim=rim(), name="clearance")
    assert ct.cycles.orbit(wide, 1e-4, settle=20).contacts == 0
    rough = ct.cycles.RimFamily(rim=rim(), name="friction")
    smooth = ct.cycles.RimFamily(rim=rim(), mu=0.05)
    one, other = ct.cycles.orbit(rough, 0.05, settle=20), ct.cycles.orbit(smooth, 5.0, settle=20)
    assert one.x == pytest.approx(other.x)


def test_what_has_no_such_frame_is_refused():
    split = ct.RotatingRim(ring(imperfect=0.01), blade(), clearance=1e-5, speed_hz=5.0)
    with pytest.raises(ct.InputError, match="perfect casing"):
        ct.cycles.RimFamily(rim=split)
    with pytest.raises(ct.InputError, match="name: found 'gap'"):
        ct.cycles.RimFamily(rim=rim(), name="gap")
    with pytest.raises(ct.InputError, match="speed_hz: found 0 Hz"):
        ct.cycles.orbit(ct.cycles.RimFamily(rim=rim()), 0.0)


def test_friction_that_would_turn_is_refused():
    """The blade begins at 80 m/s along the rim, which passes at 14 m/s."""
    struck = replace(rim(clearance=-1e-5, waves=()), blade_velocity=np.array([50.0, 0.0]))
    with pytest.raises(ct.NumericsError, match="contact 1 at the change from slip to stick"):
        ct.cycles.orbit(ct.cycles.RimFamily(rim=struck, mu=0.05), 5.0, settle=1)


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
[continuation]
longest_step = 0.1
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
        ("to_hz = 24.0", "to_hz = -1.0", "speed: from_hz = 22 and to_hz = -1 found"),
        ("friction", "fricton", "contact.fricton: unknown key"),
        ("clearance = 5e-6", "clearance = 5.0", "clearance: found 5 m"),
    ):
        (tmp_path / "scene.toml").write_text(SCENE.replace(old, new))
        with pytest.raises(ct.scene.SceneError, match=words):
            ct.scene.load_cycles(tmp_path / "scene.toml")


VARIED = """
[scene]
kind = "disk"
[casing]
basis = "casing.npz"
[disk]
blades = 2
freq_hz = 120.0
modal_mass = 0.4
zeta = 0.05
compliance = 1e-5
lean_deg = 10.0
[contact]
clearance = 5e-6
out_of_roundness = [{p = 2, cos = 2e-5}]
[coating]
E = 2e8
yield_stress = 1e6
hardening = 0.0
thickness = 2e-3
width = 0.02
tip = 5e-3
[speed]
hz = 15.0
[vary]
clearance = [1.8e-5, 1.2e-5]
[basins]
at = 1.5e-5
starts = 2
seed = 5
settle = 30
[continuation]
longest_step = 0.2
"""


def test_a_scene_of_a_disk_is_followed_over_its_clearance(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(VARIED)
    ring(zeta=0.05).save(tmp_path / "casing.npz")
    scene = ct.scene.load_cycles(file)
    assert scene.family.stiffness == pytest.approx(1e7)
    found = scene.solve()
    points = found.branches[0].points
    assert (found.name, points[0].value, points[-1].value) == ("clearance", 1.8e-5, 1.2e-5)
    assert points[-1].force[0] > points[0].force[0] > 0.0
    reached = scene.reached(found)
    assert sum(one.share for one in reached.attractors) == 1.0
    for old, new, words in (
        ("hz = 15.0", "from_hz = 15.0\nto_hz = 16.0", r"expected speed.from_hz and speed.to_hz, or"),
        ("hz = 15.0", "to_hz = 16.0", "speed: to_hz found"),
        ("[1.8e-5, 1.2e-5]", "[1.8e-5, 1.8e-5]", "two different ends"),
        ("at = 1.5e-5", "at = 1.5e-4", "basins.at: found 0.00015"),
        ("tip = 5e-3", "tip = 5e-3\nmachined = 1e-4", "coating.machined found"),
        ("compliance = 1e-5", "complance = 1e-5", "disk.complance: unknown key"),
    ):
        file.write_text(VARIED.replace(old, new))
        with pytest.raises(ct.scene.SceneError, match=words):
            ct.scene.load_cycles(file)


BLADES = """
[scene]
kind = "rub"
[casing]
basis = "casing.npz"
[[blade]]
basis = "blade.npz"
count = 3
lean_deg = 10.0
[contact]
clearance = 5e-6
friction = 0.1
out_of_roundness = [{p = 3, cos = 2e-5}]
[[whirl]]
amplitude = 2e-6
[speed]
from_hz = 22.0
to_hz = 24.0
[continuation]
longest_step = 0.1
"""


def test_a_scene_of_blades_is_read_and_what_is_not_taken_is_named(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(BLADES)
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    family = ct.scene.load_cycles(file).family
    assert (len(family.rub.tips), family.mu, family.stiffness) == (3, 0.1, math.inf)
    assert family.at(22.0)[1] == pytest.approx(1.0 / 22.0)  # whirl passes once a turn
    for old, new, words in (
        ("amplitude = 2e-6", "amplitude = 2e-6\nhz = 3.0", "whirl: found one, expected none"),
        ("lean_deg = 10.0", "lean_deg = 10.0\nstiffening = true", "stiffness_by_speed"),
        ("[speed]", "[closing]\nby = 1e-5\n[speed]", "closing: unknown key"),
    ):
        file.write_text(BLADES.replace(old, new))
        with pytest.raises(ct.scene.SceneError, match=words):
            ct.scene.load_cycles(file)
