"""Scene files of kind "rotor": what they mean, and what is refused."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import contact as ct
from casingfem.cli import main

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
        ("zeta = 0.02", "modes = 3", "rotor.modes found beside rotor.mass"),
        ("[unbalance]", "[unbalance]\nat = 0.1", "unbalance.at found without"),
        (ROTOR, "", "no rotor found"),
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
