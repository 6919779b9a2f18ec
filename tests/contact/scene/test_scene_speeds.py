"""Scenes over speeds: what stays in contact, where orbits are followed, random starts; and the source of a scene."""

import hashlib
import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

PAIR = """
[scene]
kind = "pair"
[casing]
n = 3
freq_hz = 200.0
modal_mass = 2.0
[blade]
freq_hz = 100.0
modal_mass = 0.5
zeta = 0.01
[contact]
stiffness = 4e6
friction = 0.2
lean_deg = 10.0
[speed]
from_hz = 10.0
to_hz = 20.0
steps = 3
"""


def test_a_pair_by_hand_is_checked_over_its_speeds(tmp_path):
    file = tmp_path / "pair.toml"
    file.write_text(PAIR)
    for load in (ct.scene.load_stability, ct.scene.load_interactions):
        scene = load(file)
        pair = scene.what if load is ct.scene.load_stability else scene.scene
        assert scene.speed_hz.tolist() == [10.0, 15.0, 20.0]
        assert (pair.compliance, pair.friction, pair.lean_deg) == (2.5e-7, 0.2, 10.0)
        assert (pair.casing.n, pair.casing.freq_hz, pair.blade.zeta) == (3, 200.0, 0.01)
    file.write_text(PAIR.replace("stiffness = 4e6", "compliance = 3e-7").replace("steps = 3\n", ""))
    assert ct.scene.load_stability(file).what.compliance == 3e-7
    assert ct.scene.load_stability(file).speed_hz.size == 401


RIM = """
[scene]
kind = "rim"
t_end = 1.0
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
[contact]
clearance = 1e-4
friction = 0.3
[speed]
hz = 5.0
[scheme]
kind = "exact-modal"
dt = 1e-5
"""


def test_a_rim_is_checked_over_its_scan_or_up_to_twice_its_speed(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    file = tmp_path / "rim.toml"
    file.write_text(RIM)
    scene = ct.scene.load_interactions(file)
    np.testing.assert_allclose(scene.speed_hz, np.linspace(1.0, 10.0, 200), rtol=1e-12)  # a turn in t_end, and more
    file.write_text(RIM.replace("t_end = 1.0", "t_end = 100.0"))
    np.testing.assert_allclose(ct.scene.load_interactions(file).speed_hz, 0.05 * np.arange(1, 201), rtol=1e-12)
    assert scene.scene.law.mu == 0.3
    with pytest.raises(ct.scene.SceneError, match=r"speed.scan: missing, expected \{from_hz"):
        ct.scene.load_stability(file)
    file.write_text(RIM.replace("hz = 5.0", "hz = 0.0"))
    with pytest.raises(ct.scene.SceneError, match=r"speed.scan: missing, .* for a scene at rest"):
        ct.scene.load_interactions(file)
    scan = "hz = 5.0\nscan = {from_hz = 1.0, to_hz = 4.0, steps = 4}"
    file.write_text(RIM.replace("hz = 5.0", scan).replace("friction = 0.3\n", ""))
    for load in (ct.scene.load_stability, ct.scene.load_interactions):
        assert load(file).speed_hz.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert ct.scene.load_stability(file).mu == 0.0
    file.write_text(RIM.replace("hz = 5.0", "hz = -5.0"))
    with pytest.raises(ct.scene.SceneError, match=r"speed.hz: found -5 Hz, expected a speed of 0 or above"):
        ct.scene.load_interactions(file)


def test_a_speed_in_rpm_is_the_same_scene_as_in_hz(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    file = tmp_path / "rim.toml"
    file.write_text(RIM.replace("hz = 5.0", "rpm = 300.0"))
    assert ct.load_scene(file).what.speed == pytest.approx(10.0 * math.pi, rel=1e-15)
    for words, expected in (
        ("hz = 5.0\nrpm = 300.0", "hz and rpm both found, expected one"),
        ("rpm = 9e9", r"speed\.rpm: found 9.*, expected .*600000"),
    ):
        file.write_text(RIM.replace("hz = 5.0", words))
        with pytest.raises(ct.scene.SceneError, match=expected):
            ct.load_scene(file)


def test_speeds_of_interactions_that_are_left_out_are_those_of_the_command(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    file = tmp_path / "rim.toml"
    file.write_text(RIM.replace("t_end = 1.0", "t_end = 0.01").replace("clearance = 1e-4", "clearance = 1e-2"))
    scene = ct.scene.load_interactions(file)
    found = ct.interactions(scene.scene, runs=2)
    np.testing.assert_array_equal(found.peaks.map.speed_hz, scene.speed_hz)
    with pytest.raises(ct.InputError, match="speed_hz: found none for a pair of modes"):
        ct.interactions(ct.scene.load_interactions("data/scenes/pair.toml").scene)


def test_the_source_of_a_scene_is_the_hash_of_its_file_and_bases_in_their_order(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    (tmp_path / "rim.toml").write_text(RIM)
    parts = [(tmp_path / name).read_bytes() for name in ("rim.toml", "casing.npz", "blade.npz")]
    scene = ct.load_scene(tmp_path / "rim.toml")
    assert scene.source == {"scene": "rim.toml", "sha256": hashlib.sha256(b"\0".join(parts)).hexdigest()}
    assert (scene.t_end, scene.dt, scene.courant, scene.on_limit, scene.record) == (1.0, 1e-5, None, "stop", None)
    assert replace(scene.what, clearance=0.0).speed_hz == 5.0


TURNING = """
[scene]
kind = "rim"
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
[contact]
clearance = 1e-4
friction = 0.3
[speed]
from_hz = 3.0
to_hz = 5.0
"""
COATING = "[coating]\nE = 8e8\nyield_stress = 2e4\nhardening = 1e6\nthickness = 2e-3\nwidth = 0.03\ntip = 0.05\n"


@pytest.fixture
def turning(tmp_path):
    """Write a scene of a turning rim, and read it."""
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")

    def read(text):
        (tmp_path / "rim.toml").write_text(text)
        return ct.scene.load_cycles(tmp_path / "rim.toml")

    return read


def test_a_turning_rim_is_followed_over_its_speed_or_what_varies(turning):
    scene = turning(TURNING)
    family = scene.family
    assert (scene.between, family.name, family.mu, family.stiffness) == ((3.0, 5.0), "speed_hz", 0.3, math.inf)
    assert (family.rim.speed_hz, scene.ask) == (3.0, None)
    assert (scene.how.longest_step, scene.how.most_points, scene.how.doublings) == (0.02, 1000, 0)
    one = TURNING.replace("from_hz = 3.0\nto_hz = 5.0", "hz = -4.0")
    for name, ends in (("clearance", (2e-4, 1e-4)), ("friction", (0.0, 0.3))):
        scene = turning(one + f"[vary]\n{name} = {list(ends)}\n")
        assert (scene.between, scene.family.name, scene.family.rim.speed_hz) == (ends, name, -4.0)
    coated = turning(TURNING + COATING).family
    area = 0.03 * 0.05  # of a tip's land
    assert coated.stiffness == pytest.approx(8e8 * area / 2e-3, rel=1e-12)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("[vary]\nfriction = [0.0, 0.3]\n", "expected speed.from_hz and speed.to_hz, or speed.hz with .vary."),
        ("[continuation]\nchannels = ['span']\n", "continuation.channels found with a rim"),
        (COATING + "machined = 1e-4\n", "coating.machined found, expected 0"),
    ],
)
def test_turning_rims_that_cannot_be_followed_are_refused(turning, more, words):
    with pytest.raises(ct.scene.SceneError, match=words):
        turning(TURNING + more)
    with pytest.raises(ct.scene.SceneError, match=r"expected speed.from_hz and speed.to_hz, or speed.hz with .vary."):
        turning(TURNING.replace("from_hz = 3.0\nto_hz = 5.0", "hz = 4.0"))
    assert turning(TURNING + COATING + "machined = 0.0\n").between == (3.0, 5.0)
