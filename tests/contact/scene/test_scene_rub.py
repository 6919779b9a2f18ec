"""Scenes of kind "rub": what the file says is what runs; what it cannot mean is refused with file and key."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3

SCENES = Path(__file__).parents[3] / "data" / "scenes" / "rub"

RUB = """
[scene]
kind = "rub"
t_end = 0.01
on_limit = "flag"
[casing]
basis = "casing.npz"
thickness = 1e-6
[checks]
allow = ["thickness"]
[[blade]]
basis = "blade.npz"
angle_deg = 5.0
count = 2
lean_deg = 10.0
axial = true
[[blade]]
basis = "blade.npz"
[[blade.node]]
span = "node1.span"
flap = "node1.flap"
axial = "node1.chord"
angle_deg = 0.5
line = 1
clearance = 1e-6
[contact]
clearance = -3e-5
friction = 0.2
out_of_roundness = [{p = 2, cos = 1e-5}]
profile = "round.csv"
[speed]
time = [0.0, 0.1]
hz = [3.0, 5.0]
[closing]
by = 1e-5
time_constant = 0.01
[[whirl]]
amplitude = 1e-6
per_rev = -1.0
[scheme]
kind = "exact-modal"
law = "forward"
dt = 2e-5
"""

RIM = """
[scene]
kind = "rim"
t_end = 0.01
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
[contact]
clearance = 1e-3
[speed]
hz = 5.0
[scheme]
kind = "exact-modal"
dt = 2e-5
"""

ROUND = "# by hand\ntheta_deg,depth_m\n0,0\n90,2e-5\n200,-1e-5\n"


@pytest.fixture
def write(tmp_path):
    rim3().save(tmp_path / "casing.npz")
    nodes(2).save(tmp_path / "blade.npz")

    def written(text=RUB, table=ROUND):
        (tmp_path / "round.csv").write_text(table)
        (tmp_path / "scene.toml").write_text(text)
        return tmp_path / "scene.toml"

    return written


@pytest.mark.slow
def test_the_file_is_the_rub(write):
    scene = ct.load_scene(write())
    rub = scene.what
    assert [tip.angle_deg for tip in rub.tips] == [5.0, 5.0, 185.0, 185.0, 0.5]
    assert [tip.blade for tip in rub.tips] == [0, 0, 1, 1, 2]
    assert rub.tips[-1].line == 1
    assert rub.tips[0].axial == "node0.chord"
    assert rub.speed.omega(0.05) == pytest.approx(8.0 * np.pi)
    assert rub.closing.at(0.01) == pytest.approx(1e-5 * (1.0 - np.exp(-1.0)), rel=1e-4)
    assert rub.profile(np.pi / 2.0) == pytest.approx(2e-5 - 1e-5)
    assert rub.whirl[0].per_rev == -1.0
    result = ct.run(scene)
    assert result.impulse.min() > 0.0
    assert result.flags[0].startswith("the rim deflected by")
    assert "forward law at 5 tips" in result.scheme
    assert len(result.source["sha256"]) == 64


def test_gravity_and_whirl_of_the_file_are_those_of_the_rub(write, tmp_path):
    share = np.arange(30.0).reshape(3, 10) / 30.0
    replace(rim3(), participation=share).save(tmp_path / "casing.npz")
    replace(nodes(2), participation=share[:, :3]).save(tmp_path / "blade.npz")
    text = RUB.replace("per_rev = -1.0", 'per_rev = -1.0\nhz = 2.0\nphase_deg = 30.0\nshakes = "blades"')
    text = text.replace("hz = [3.0, 5.0]", 'hz = [3.0, 5.0]\nturning = "blades"') + "[gravity]\ndown_deg = 10.0\n"
    rub = ct.load_scene(write(text)).what
    shaken, weight = rub.forces
    assert (shaken.on, shaken.radius, shaken.per_rev, shaken.hz, shaken.phase_deg) == ("blades", -1e-6, -1.0, 2.0, 30.0)
    assert (weight.on, weight.acceleration, weight.per_rev, weight.casing_turns) == ("both", 9.80665, 0.0, False)
    x, y = np.cos(np.radians(10.0)), np.sin(np.radians(10.0))
    sag = 9.80665 * (x * share[0] + y * share[1]) / rub.casing.omega**2
    assert rub.casing_start.displacement == pytest.approx(sag, rel=1e-12)
    assert rub.blade_starts[2].displacement.any()
    undeformed = ct.load_scene(write(text + "settled = false\n")).what
    assert undeformed.casing_start.displacement is None
    with pytest.warns(ct.scene.SceneWarning, match="turning-unmodelled"):
        turned = ct.load_scene(write(text.replace('turning = "blades"', 'turning = "casing"'))).what
    assert turned.forces[1].per_rev == -1.0
    with pytest.warns(
        ct.scene.SceneWarning, match=r"speed\.turning: missing in a scene with gravity or whirl, 'blades' is assumed"
    ):
        rub = ct.load_scene(write(text.replace('turning = "blades"', ""))).what
    assert (rub.turning, rub.forces[1].per_rev) == ("blades", 0.0)


@pytest.mark.parametrize("kind", ["rim", "rub"])
def test_side_that_turns_is_reported_where_a_basis_has_matrices_of_rotation(kind, write, tmp_path):
    """Left out: taken as the blades, with a warning; a casing that turns needs its own matrices."""
    skew = np.triu(np.ones((10, 10)), 1)
    casing = replace(rim3(), gyroscopic=skew - skew.T, stiffness_by_speed=np.eye(10))
    if kind == "rim":
        casing = replace(ring(), gyroscopic=skew - skew.T)
        blade().save(tmp_path / "blade.npz")
    else:
        nodes(2).save(tmp_path / "blade.npz")
    casing.save(tmp_path / "casing.npz")
    text = RUB if kind == "rub" else RIM
    speed = "hz = [3.0, 5.0]" if kind == "rub" else "hz = 5.0"
    assert speed in text
    with pytest.warns(
        ct.scene.SceneWarning, match=r"with Coriolis forces and stiffening of casing, .*turning-unstated\]$"
    ):
        scene = ct.load_scene(write(text))
    assert scene.what.turning == "blades"
    for side in ("casing", "blades"):
        assert ct.load_scene(write(text.replace(speed, f'{speed}\nturning = "{side}"'))).what.turning == side
    replace(casing, gyroscopic=None, stiffness_by_speed=None).save(tmp_path / "casing.npz")
    assert ct.load_scene(write(text)).what.turning == "blades"
    with pytest.warns(ct.scene.SceneWarning, match=r"casing: found no gyroscopic matrix .*turning-unmodelled\]$"):
        ct.load_scene(write(text.replace(speed, f'{speed}\nturning = "casing"')))
    with pytest.raises(ct.InputError, match=r"speed\.turning: found 'rim', expected 'casing' or 'blades'"):
        ct.load_scene(write(text.replace(speed, f'{speed}\nturning = "rim"')))


def wheel(blade, sectors):
    """Blades on a rigid hub as one basis."""
    eye = np.eye(sectors)
    return ct.ModalBody(
        omega=np.tile(blade.omega, sectors), zeta=np.tile(blade.zeta, sectors), rows=np.kron(eye, blade.rows),
        S=np.kron(eye, blade.S), sectors=sectors,
        channels=tuple(f"sector{j}.{name}" for j in range(sectors) for name in blade.channels),
    )  # fmt: skip


@pytest.mark.slow
def test_a_wheel_of_uncoupled_blades_rubs_as_so_many_blades(write, tmp_path):
    wheel(nodes(2), 3).save(tmp_path / "wheel.npz")
    first, _, rest = RUB.replace("count = 2", "count = 3").partition("[[blade]]")
    one_by_one = first + "[[blade]]" + rest.partition("[[blade]]")[0] + "[contact]" + rest.partition("[contact]")[2]
    as_wheel = one_by_one.replace("blade.npz", "wheel.npz").replace("count = 3\n", "")
    scenes = [ct.load_scene(write(text)) for text in (one_by_one, as_wheel)]
    blades, disk = (scene.what for scene in scenes)
    assert [tip.angle_deg for tip in disk.tips] == [tip.angle_deg for tip in blades.tips]
    assert [tip.track for tip in disk.tips] == [0, 1] * 3
    found = [ct.run(scene) for scene in scenes]
    np.testing.assert_allclose(found[1].impulse, found[0].impulse, rtol=1e-8)
    assert np.abs(found[0].impulse).max() > 0.0


def test_nodes_of_a_wheel_are_those_of_one_sector(write, tmp_path):
    wheel(nodes(2), 3).save(tmp_path / "wheel.npz")
    rub = ct.load_scene(write(RUB.replace("blade.npz", "wheel.npz").replace("count = 2\n", ""))).what
    named = [tip for tip in rub.tips if tip.blade == 1]
    assert [(tip.span, tip.line, tip.track) for tip in named] == [(f"sector{j}.node1.span", 1, 0) for j in range(3)]
    assert [tip.angle_deg for tip in named] == pytest.approx([0.5, 120.5, 240.5])
    with pytest.raises(ct.scene.SceneError, match="found 2 of a wheel, whose basis has 3 blades"):
        ct.load_scene(write(RUB.replace("blade.npz", "wheel.npz")))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("count = 2", "count = 0", r"blade\[1\].count: found 0"),
        ("axial = true", "chordwise = true", r"blade\[1\].chordwise: unknown key"),
        ('span = "node1.span"', 'span = "node7.span"', "blade.node: found 'node7.span'"),
        ("line = 1", "line = 4", "tips[4].line: found 4, expected 0 .. 1"),
        ("hz = [3.0, 5.0]", "hz = 3.0", "one hz and 2 time found"),
        ("time_constant = 0.01", "time = [0.0]", "expected one number by with time_constant"),
        ("time_constant = 0.01", "", "expected one number by with time_constant"),
        ("time_constant = 0.01", "time_constant = 0.01\ntime = [0.0]", "expected one number by with time_constant"),
        ("by = 1e-5", "by = [0.0, 1e-5]", "expected one number by with time_constant"),
        ("by = 1e-5", "by = [0.0, 1e-5]\ntime = [0.0, 0.1]", "expected one number by with time_constant"),
        ("by = 1e-5\ntime_constant = 0.01", "by = [0.0, 1e-5]", "expected one number by with time_constant"),
        ("time = [0.0, 0.1]\n", "", "2 hz and 0 time found"),
        ("hz = [3.0, 5.0]", "hz = [3.0, 5.0, 6.0]", "3 hz and 2 time found"),
        ("time = [0.0, 0.1]", "time = [0.1, 0.1]", "speed: found 0.1 after 0.1, expected ascending values"),
        ('axial = "node1.chord"', "", "axial: found"),
        ("lean_deg = 10.0", "lean_deg = 10.0\nstiffening = true", "found a basis without stiffness_by_speed"),
        ('basis = "casing.npz"', 'basis = "none.npz"', "found no such file"),
        ("amplitude = 1e-6", 'amplitude = 1e-6\nshakes = "casing"', "casing: found a basis without participation"),
        ("amplitude = 1e-6", 'amplitude = 1e-6\nshakes = "rotor"', "whirl[1].shakes: found 'rotor'"),
        ("[scheme]", "[gravity]\n[scheme]", "casing: found a basis without participation"),
        ("friction = 0.2", "friction = 0.2\ndraw = 3", "draw found without random_out_of_roundness"),
        ("amplitude = 1e-6", "amplitude = -1e-6", r"whirl[1].amplitude: found -1e-06"),
    ],
)  # fmt: skip
def test_broken_rub_scenes(write, old, new, words):
    assert old in RUB
    with pytest.raises(ct.scene.SceneError) as caught:
        ct.load_scene(write(RUB.replace(old, new, 1)))
    assert words.replace("\\", "") in str(caught.value)
    assert "scene.toml" in str(caught.value)


NAMED = 'span = "11.x"\nflap = "11.y"\naxial = "11.z"\n'


@pytest.mark.parametrize(
    ("blade", "words"),
    [
        ('basis = "other.npz"', "blade.basis: other.npz: found the channels 11.x, 11.y, 11.z, expected span, flap; or "
         "give a [[blade.node]] for each place, with its channels along span and flap"),
        ('basis = "other.npz"\naxial = true', "11.z, expected span, flap, chord; or give a [[blade.node]]"),
        (f'basis = "other.npz"\n[[blade.node]]\n{NAMED.replace("11.y", "12.y")}', "blade.node: found '12.y', expected "
         "a channel of other.npz: 11.x, 11.y, 11.z (did you mean 11.y?)"),
        ('basis = "casing.npz"', "blade.basis: casing.npz: found a basis of kind 'rim', expected 'point'"),
    ],
)  # fmt: skip
def test_a_basis_without_the_channels_of_its_places_is_named_with_what_helps(write, tmp_path, blade, words):
    """A basis of matrices has the channels 11.x, 11.y, 11.z of its nodes."""
    replace(nodes(1), channels=("11.x", "11.y", "11.z")).save(tmp_path / "other.npz")
    start, end = RUB.index("[[blade]]"), RUB.index("[contact]")
    with pytest.raises(ct.InputError) as refused:
        ct.load_scene(write(f"{RUB[:start]}[[blade]]\n{blade}\n{RUB[end:]}"))
    assert words in str(refused.value)
    named = ct.load_scene(write(f'{RUB[:start]}[[blade]]\nbasis = "other.npz"\n[[blade.node]]\n{NAMED}{RUB[end:]}'))
    assert named.what.tips[0].axial == "11.z"


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("0,0\n1,1\n2,0\n", "found no header theta_deg,depth_m"),
        ("theta_deg,depth_m\n0,0\n10,x\n", "line 3: found '10,x', expected two numbers"),
        ("theta_deg,depth_m\n0,0\n10,0,1\n", "line 3"),
        ("theta_deg,depth_m\n0,0\n90,0\n45,1e-5\n", "line 4: found 45 deg after 90, expected ascending"),
        ("theta_deg,depth_m\n0,0\n90,nan\n", "line 3: found '90,nan', expected two finite numbers"),
        ("theta_deg,depth_m\n", "found no line below the header"),
        ("theta_deg,depth_m\n0,0\n180,0\n360,0\n", "within less than 2 pi rad"),
    ],
)
def test_broken_profiles(write, table, words):
    with pytest.raises(ct.scene.SceneError, match=words):
        ct.load_scene(write(table=table))


def test_a_speed_and_a_closing_may_be_one_number_or_a_table(write):
    text = RUB.replace("time = [0.0, 0.1]\nhz = [3.0, 5.0]", "hz = 4.0")
    rub = ct.load_scene(
        write(text.replace("by = 1e-5\ntime_constant = 0.01", "by = [0.0, 1e-5]\ntime = [0.0, 0.2]"))
    ).what
    assert rub.speed.omega(0.3) == pytest.approx(8.0 * np.pi)
    assert [rub.closing.at(t) for t in (0.0, 0.1, 0.2)] == pytest.approx([0.0, 5e-6, 1e-5])


def test_a_missing_profile_is_named_once(write, tmp_path):
    with pytest.raises(ct.scene.SceneError) as caught:
        ct.load_scene(write(RUB.replace("round.csv", "gone.csv")))
    assert str(caught.value).count("gone.csv") == 1
    assert "found no such file, expected one" in str(caught.value)


COATING = """
[coating]
E = 1e9
yield_stress = 2e4
hardening = 1e6
thickness = 1e-3
width = 8e-3
tip = 6e-3
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("E = 1e9", "E = 0.0", "coating.E: found 0.0, expected greater than 0"),
        ("yield_stress = 2e4", "", "coating.yield_stress: missing"),
        ("hardening = 1e6", "hardening = -1.0", "coating.hardening: found -1.0, expected greater than or equal to 0"),
        ("thickness = 1e-3", "thickness = nan", "coating.thickness: found nan, expected a finite number"),
        ("width = 8e-3", 'width = "wide"', "coating.width: found 'wide', expected a valid number"),
        ("tip = 6e-3", "tip = -6e-3", "coating.tip: found -0.006, expected greater than 0"),
        ("tip = 6e-3", "tip = 6e-3\nbars = 0", "coating.bars: found 0, expected greater than or equal to 1"),
        ("tip = 6e-3", "tip = 6e-3\nmachined = 2e-3", "coating: machined: found 0.002 m, expected at most"),
        ("tip = 6e-3", "tip = 6e-3\nmu = 0.2", "coating.mu: unknown key"),
        ("line = 1", "line = 1\ntrack = -1", "blade[2].node[1].track: found -1, expected greater than or equal to 0"),
        ("line = 1", "track = 0", "tips[4].track: found 0.0314 m to tips[0] on the same track 0, expected at least"),
    ],
)  # fmt: skip
def test_broken_coatings(write, old, new, words):
    text = (RUB + COATING).replace("tip = 6e-3", "tip = 3.5e-2" if "0.0314" in words else "tip = 6e-3")
    assert old in text
    with pytest.raises(ct.scene.SceneError) as caught:
        ct.load_scene(write(text.replace(old, new, 1)))
    assert words in str(caught.value)
    assert "scene.toml" in str(caught.value)


@pytest.mark.slow
def test_a_coated_disk_wears_one_track(tmp_path):
    text = (SCENES.parent / "bladed_disk.toml").read_text().replace("t_end = 0.5", "t_end = 0.005")
    (tmp_path / "disk.toml").write_text(text + COATING.replace("1e-3", "2e-3"))
    result = ct.run(ct.load_scene(tmp_path / "disk.toml"))
    assert [track.tips for track in result.tracks] == [tuple(range(12))]
    assert result.wear.volume > 0.0
    assert abs(result.wear.residual) <= 1e-12


@pytest.mark.slow
def test_the_shipped_coating_prints_its_wear_and_draws_it(write, tmp_path):
    """On made-up bases of two places, which are soft; one turn."""
    import json

    from click.testing import CliRunner

    from casingfem.cli import main

    write()
    nodes(2).save(tmp_path / "blade.npz")
    text = (SCENES / "coated.toml").read_text()
    text = text.replace("t_end = 0.6", "t_end = 0.2").replace("yield_stress = 1e5", "yield_stress = 1e3")
    (tmp_path / "coated.toml").write_text(text)
    ran = CliRunner().invoke(main, ["rub", str(tmp_path / "coated.toml"), "--out", str(tmp_path / "out")])
    assert ran.exit_code == 0, ran.output
    assert "coating: worn" in ran.output
    assert "track 2 (tips 2, 4): worn" in ran.output
    pictures = sorted(tmp_path.glob("out/coating_*.png"))
    assert [file.name for file in pictures] == ["coating_1.png", "coating_2.png"]
    assert min(file.stat().st_size for file in pictures) > 10_000
    told = json.loads((tmp_path / "out" / "rub.json").read_text())["coating"]
    assert [row["contacts"] for row in told] == [[1, 3], [2, 4]]
    assert all(row["dissipated_J"] == pytest.approx(row["stated_J"], rel=1e-12) for row in told)
    assert sum(row["volume_m3"] for row in told) > 0.0


@pytest.mark.slow
def test_the_shipped_rub_runs_on_the_bases_of_its_studies(tmp_path):
    from click.testing import CliRunner

    from casingfem.cli import main

    for name in ("casing.toml", "blade.toml"):
        made = CliRunner().invoke(main, ["reduce", str(SCENES / name), "--out", str(tmp_path)])
        assert made.exit_code == 0, made.output
    for name in ("five_nodes.toml", "roundness.csv"):
        (tmp_path / name).write_bytes((SCENES / name).read_bytes())
    ran = CliRunner().invoke(main, ["rub", str(tmp_path / "five_nodes.toml"), "--out", str(tmp_path)])
    assert ran.exit_code == 0, ran.output
    result = ct.Result.load(tmp_path / "rub.npz")
    assert result.impulse.min() > 0.01
    assert result.notes.heat.sum() == pytest.approx(result.notes.drive.sum(), rel=1e-3)
    assert result.impulse[0] == pytest.approx(result.impulse[4], rel=1e-2)  # the strip is symmetric
    assert result.flags == ()


@pytest.mark.parametrize(("rpm", "warns"), [(1700.0, False), (3000.0, True)])
def test_basis_far_from_the_speed_of_its_modes_is_named(rpm, warns, write, tmp_path):
    """Its stiffness by speed changes the lowest frequency by 40 % at 1752 rpm."""
    casing = ring()
    factor = 1.25 * (casing.omega.min() / (2000.0 * np.pi / 30.0)) ** 2
    replace(casing, gyroscopic=np.zeros((10, 10)), stiffness_by_speed=factor * np.eye(10)).save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    text = write(RIM.replace("hz = 5.0", f'hz = {rpm / 60.0!r}\nturning = "casing"'))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ct.load_scene(text)
    found = [str(one.message) for one in caught if "turning-fast" in str(one.message)]
    assert bool(found) == warns
    if warns:
        words = f"casing: found a frequency of the basis that changes by 95.3 % at {rpm:g} rpm, expected at most 40 %"
        assert words in found[0]


@pytest.mark.parametrize(
    ("hz", "fault"), [(5.0, None), (7.0, "found 7 Hz (420 rpm), expected 4 to 6 Hz (240 to 360 rpm)")]
)
def test_a_scene_at_a_speed_at_which_a_basis_is_not_known_is_refused(hz, fault, write, tmp_path):
    known = 2.0 * np.pi * np.array([4.0, 6.0])
    turning = {"gyroscopic": np.zeros((10, 10)), "stiffness_by_speed": np.eye(10), "known_speeds": known}
    replace(ring(), spin=10.0 * np.pi, **turning).save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    text = write(RIM.replace("hz = 5.0", f'hz = {hz!r}\nturning = "casing"'))
    if fault is None:
        scene = ct.load_scene(text)
        assert scene.what.casing.known_speeds.tolist() == known.tolist()
        np.testing.assert_allclose(ct.scene.load_interactions(text).speed_hz[[0, -1]], [4.0, 6.0], rtol=1e-12)
        return
    with pytest.raises(ct.InputError, match="casing: speed: ") as refused:
        ct.load_scene(text)
    assert fault in str(refused.value)
