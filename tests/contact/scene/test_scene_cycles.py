"""Scene files of casingfem cycles: the shipped ones run, the broken ones say what is wrong."""

import math
from pathlib import Path

import pytest

import contact as ct

SCENES = Path(__file__).parents[3] / "data" / "scenes" / "cycles"
TEXT = """
[scene]
kind = "patch"
[body]
omega = [1.0]
zeta = [0.025]
channels = ["x", "stop"]
rows = [[1.0], [-1.0]]
[[contact]]
normal = "stop"
clearance = 0.1
stiffness = 100.0
[drive]
channel = "x"
amplitude = 0.02
from_hz = 0.15
to_hz = 0.2
[continuation]
channels = ["x"]
"""


def written(folder, text):
    file = folder / "scene.toml"
    file.write_text(text)
    return file


def test_a_scene_is_its_body_contacts_and_range(tmp_path):
    scene = ct.scene.load_cycles(written(tmp_path, TEXT))
    assert scene.between == (0.15, 0.2)
    assert scene.family.channels == ("x",)
    assert scene.family.body.stiffness.tolist() == [100.0]
    assert scene.family.plant.S.tolist() == [[0.01]]
    rigid = ct.scene.load_cycles(written(tmp_path, TEXT.replace("stiffness = 100.0", "restitution = 0.7")))
    assert rigid.family.plant.S.tolist() == [[0.0]]
    assert rigid.family.plant.restitution.tolist() == [0.7]


@pytest.mark.slow
def test_the_shipped_ball_bounces_high_and_low_in_turn_beyond_its_flip():
    found = ct.scene.load_cycles(SCENES / "bouncing_ball.toml").solve()
    w, e, g = 20.0, 0.5, 9.81
    flip = math.hypot(math.pi * g * (1.0 - e) / (1.0 + e), 2.0 * g * (1.0 + e**2) / (1.0 + e) ** 2)
    assert w == pytest.approx(2.0 * math.pi * found.branches[0].points[0].period ** -1)
    assert [branch.points[0].periods for branch in found.branches] == [1, 2, 4]
    assert [branch.specials[0].kind for branch in found.branches] == ["flip"] * 3
    assert found.branches[0].specials[0].orbit.value == pytest.approx(flip, rel=1e-6)
    assert [branch.stretches[0][0] for branch in found.branches] == [True] * 3
    assert [branch.stretches[-1][0] for branch in found.branches] == [False] * 3


@pytest.mark.campaign
def test_the_shipped_rod_goes_round_two_folds():
    found = ct.scene.load_cycles(SCENES / "rod_on_obstacle.toml").solve()
    kinds = [special.kind for special in found.branches[0].specials]
    assert kinds == ["grazing", "Neimark-Sacker", "Neimark-Sacker", "fold", "fold", "grazing"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("to_hz = 0.2\n", "", "drive: amplitude, from_hz found, expected amplitude, from_hz and to_hz, or freq_hz"),
        ("to_hz = 0.2\n", "to_hz = 0.15\n", "drive: two equal ends of the range found"),
        ('channel = "x"\n', 'channel = "y"\n', "channel: found 'y', expected one of x, stop"),
        ("stiffness = 100.0", "stiffness = -1.0", r"contact\[1\].stiffness: found -1.0"),
        ("amplitude = 0.02", "amplitude = 0.02\nforce = 3.0", "drive.force: unknown key"),
        ('kind = "patch"', 'kind = "rods"', "scene.kind: found 'rods', expected 'patch'"),
        ("[drive]", "[scheme]", "drive: missing"),
    ],
)
def test_broken_scenes_name_file_and_key(tmp_path, old, new, words):
    assert old in TEXT
    file = written(tmp_path, TEXT.replace(old, new))
    with pytest.raises(ct.scene.SceneError, match=words) as raised:
        ct.scene.load_cycles(file)
    assert all(str(file) in problem for problem in raised.value.problems)


def test_a_scene_of_a_run_is_refused_with_what_to_change():
    file = SCENES.parent / "bladed_disk.toml"
    with pytest.raises(ct.scene.SceneError, match=r"found a scene of a time simulation.* give speed\.from_hz and"):
        ct.scene.load_cycles(file)


@pytest.mark.parametrize("ends", ["from_hz = 0.15\nto_hz = 0.2", "from_hz = 0.2\nto_hz = 0.15"])
def test_random_starts_are_asked_for_between_the_ends_of_the_range(tmp_path, ends):
    text = TEXT.replace("from_hz = 0.15\nto_hz = 0.2", ends) + "[basins]\nseed = 1\nat = {}\n"
    for at in (0.15, 0.2):
        assert ct.scene.load_cycles(written(tmp_path, text.format(at))).ask.at == at
    for at in (0.1499, 0.2001):
        words = rf"basins\.at: found {at}, expected a value from 0\.15 to 0\.2$"
        with pytest.raises(ct.scene.SceneError, match=words):
            ct.scene.load_cycles(written(tmp_path, text.format(at)))
