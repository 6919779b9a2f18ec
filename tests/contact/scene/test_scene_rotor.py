"""Scene files of kind "rotor": what they mean, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import contact as ct
from casingfem.cli import main
from tests.probed import numbers_of_document

SCENE = """
[scene]
kind = "rotor"
t_end = 1.0
[rotor]
mass = 10.0
stiffness = 4e6
zeta = 0.02
[unbalance]
moment = 1e-3
release = {time = 0.1, moment = 5e-2, angle_deg = 90.0}
[speed]
hz = 80.0
[scheme]
kind = "exact-modal"
dt = 1e-4
"""
SHAFT = """
[[shaft]]
length = 0.5
diameter = 0.05
[[disk]]
at = 0.3
mass = 12.0
[[bearing]]
at = 0.0
kxx = 2e7
[[bearing]]
at = 0.5
kxx = 5e7
"""
ROTOR = SCENE[SCENE.index("[rotor]") : SCENE.index("[unbalance]")]


def written(folder, text):
    path = folder / "rotor.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.slow
def test_the_command_gives_radius_and_lag_of_the_last_ten_turns(tmp_path):
    answer = CliRunner().invoke(main, ["rub", str(written(tmp_path, SCENE)), "--json"])
    assert answer.exit_code == 0, answer.output
    found, p = json.loads(answer.stdout)["rotor"], 80.0 * 2.0 * np.pi / np.sqrt(4e5)
    exact = abs(1e-3 + 5e-2j) / 10.0 * p**2 / (1.0 - p**2 + 0.04j * p)
    assert found["radius_end"] == pytest.approx(abs(exact), rel=1e-4)
    assert found["phase_deg_end"] == pytest.approx(-np.degrees(np.angle(exact)), rel=1e-4)


def test_rpm_is_a_sixtieth_of_hz_and_may_vary(tmp_path):
    text = SCENE.replace("hz = 80.0", "rpm = [0.0, 4800.0]\ntime = [0.0, 1.0]")
    speed = ct.load_scene(written(tmp_path, text)).what.speed
    assert speed.hz.tolist() == [0.0, 80.0]


def test_a_beam_shaft_and_its_basis_are_the_same_rotor(tmp_path):
    shaft = ct.load_scene(written(tmp_path, SCENE.replace(ROTOR, SHAFT))).what
    shaft.body.save(tmp_path / "shaft.npz")
    basis = f'[rotor]\nbasis = "shaft.npz"\nnode = "{shaft.at}"\n'
    again = ct.load_scene(written(tmp_path, SCENE.replace(ROTOR, basis))).what
    for rotor in (shaft, again):
        rotor_hz = ct.rotor.campbell(rotor, [50.0]).freq_hz
        np.testing.assert_array_equal(rotor_hz, ct.rotor.campbell(shaft, [50.0]).freq_hz)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mass = 10.0", 'mass = "ten"', "rotor.mass: found 'ten'"),
        ("mass = 10.0", "mass = -10.0", "rotor.mass: found -10.0"),
        ("mass = 10.0", "", "rotor.mass: missing, expected mass and stiffness together"),
        ("stiffness = 4e6", "stifness = 4e6", "rotor.stifness: unknown key"),
        ("zeta = 0.02", "zeta = -0.02", "rotor.zeta: found -0.02"),
        ("zeta = 0.02", "zeta_internal = 2.0", "rotor.zeta_internal: found 2.0"),
        ("moment = 1e-3", "moment = -1e-3", "unbalance.moment: found -0.001"),
        ("time = 0.1", "time = -0.1", "unbalance.release.time: found -0.1"),
        ("angle_deg = 90.0", 'angle_deg = "up"', "unbalance.release.angle_deg: found 'up'"),
        ("hz = 80.0", "hz = 4800.0", "is this rpm?"),
        ("hz = 80.0", "rpm = 1e7", "speed.rpm: found 10000000.0"),
        ("hz = 80.0", "hz = 80.0\nrpm = 4800.0", "hz and rpm both found, expected one"),
        ("hz = 80.0", "hz = [80.0, 90.0]", "2 hz and 0 time found"),
        ("zeta = 0.02", 'basis = "a.npz"', "expected one of rotor.mass with rotor.stiffness, rotor.basis"),
        ("zeta = 0.02", "modes = 3", "rotor.modes found with rotor.mass"),
        ("zeta = 0.02", 'node = "disk"', "rotor.node found with rotor.mass"),
        (ROTOR, SHAFT + "[rotor]\nzeta = 0.02\n", "rotor.zeta found with [[shaft]], expected only modes"),
        (
            "[unbalance]",
            "[[bearing]]\nat = 0.0\nkxx = 1e8\nkyy = 1e8\n[unbalance]",
            "[[bearing]] found without [[shaft]]",
        ),
        ("[unbalance]", "[unbalance]\nat = 0.1", "unbalance.at found without"),
        (ROTOR, "", "no rotor found"),
        ("[unbalance]", "[spin]\ninertia = 0.3\n[unbalance]", "[spin] found without [casing], expected both"),
        (
            "[unbalance]",
            '[law]\nkind = "spring"\nstiffness = 1e6\n[unbalance]',
            "[law] found without [casing], expected both",
        ),
        ("[unbalance]", "[[disk]]\nat = 0.1\nmass = 1.0\n[unbalance]", "[[disk]] found without [[shaft]]"),
        (ROTOR, SHAFT + "[rotor]\nmodes = 100\n", "rotor.modes: found 100, expected 1 to "),
        (ROTOR, SHAFT.replace("at = 0.5", "at = 0.7"), "found 0.7 m, expected 0 to the end of the shaft"),
        ("dt = 1e-4", "dt = 0.0", "scheme.dt: found 0.0"),
    ],
)
def test_a_wrong_key_is_named_with_what_was_found(tmp_path, old, new, words):
    assert old in SCENE
    with pytest.raises(ct.InputError) as caught:
        ct.load_scene(written(tmp_path, SCENE.replace(old, new)))
    assert words in str(caught.value)
    assert str(tmp_path / "rotor.toml") in str(caught.value)


IN_CASING = (
    SCENE.replace("t_end = 1.0", "t_end = 0.02")
    + """
[casing]
radius = 0.25
mass = 20.0
stiffness = 2e7
zeta = 0.1
[tips]
count = 12
[contact]
clearance = 5e-4
friction = 0.1
lost = [3]
[spin]
inertia = 0.3
"""
)


def test_a_rotor_in_a_casing_is_the_rub_that_python_makes(tmp_path):
    R, scene = ct.rotor, ct.load_scene(written(tmp_path, IN_CASING))
    release = R.Release(time=0.1, moment=5e-2, angle_deg=90.0)
    disk = R.Jeffcott(mass=10.0, stiffness=4e6, zeta=0.02)
    rotor = R.Rotor.of(disk, 80.0, unbalance=R.Unbalance(moment=1e-3, release=release))
    tips = [ct.ContactPoint(blade=j, angle_deg=30.0 * j) for j in range(12) if j != 3]
    rub = R.rotor_rub(
        rotor, R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1), [R.rigid_tip()] * 12, tips,
        clearance=5e-4, spin=R.Spin(inertia=0.3),
    )  # fmt: skip
    assert (scene.what.tips, scene.what.spin, scene.law.mu) == (rub.tips, rub.spin, 0.1)
    np.testing.assert_array_equal(scene.what.casing.rows, rub.casing.rows)
    assert scene.what.speed.hz[0] == -80.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[tips]\ncount = 12\n", "", r"\[casing\], \[contact\] found without \[tips\] or \[\[blade\]\]"),
        ("zeta = 0.02", "zeta = 0.02\nlimit = 1e-3", r"rotor\.limit found with \[casing\], expected none"),
        ("mass = 20.0\n", "", "radius and stiffness found, expected basis, or radius, mass and stiffness"),
        ("lost = [3]", f"lost = {list(range(12))}", r"contact\.lost: found all 12 blades, expected one or more left"),
        ("[tips]", '[[blade]]\nbasis = "a.npz"\n[tips]', r"\[tips\] found with \[\[blade\]\], expected one of them"),
        (
            "[tips]\ncount = 12",
            '[[blade]]\nbasis = "a.npz"\naxial = true',
            r"blade\.axial = true found on a rotor",
        ),
        ("lost = [3]", "lost = [12]", r"contact.lost: found blade 12, expected 0 to 11"),
        ("count = 12", "count = 1\nangle_deg = 900.0", "angle_deg"),
        ("inertia = 0.3", "inertia = 0.0", "spin.inertia"),
        ("hz = 80.0", "hz = [80.0, 90.0]\ntime = [0.0, 1.0]", "spin: found it with a speed over time"),
        ("hz = 80.0", "hz = 0.0", "spin: found it with a rotor at rest, expected one initial speed other than 0"),
        ("zeta = 0.02", "zeta = 0.02\nzeta_internal = 0.01", "found internal damping and a speed that varies"),
    ],
)
def test_rotors_in_casings_that_do_not_fit_are_refused_by_their_keys(tmp_path, old, new, message):
    assert old in IN_CASING
    with pytest.raises(ct.scene.SceneError, match=message):
        ct.load_scene(written(tmp_path, IN_CASING.replace(old, new, 1)))


@pytest.mark.slow
def test_the_example_of_a_blade_off_slows_by_friction_and_reports_its_orbit(tmp_path, held):
    text = (Path(__file__).parents[3] / "data" / "scenes" / "blade_off" / "rigid.toml").read_text(encoding="utf-8")
    answer = CliRunner().invoke(main, ["rub", str(written(tmp_path, text)), "--json"])
    assert answer.exit_code == 0, answer.output
    found = json.loads(answer.stdout)
    impulse = sum(contact["impulse"] for contact in found["contacts"])
    fallen = 2.0 * np.pi * (70.0 - found["rotor"]["speed_hz_end"])
    assert fallen == pytest.approx(0.1 * 0.25 * impulse / 0.3, rel=0.05)  # and what the unbalance takes
    assert 5e-4 < found["rotor"]["radius_end"] < 8e-4
    held(1e-4, found=numbers_of_document(found))
