"""Implausible numbers of a scene are refused with the unit that was probably meant, unless the file allows them."""

import re
from pathlib import Path

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

SCENES = Path(__file__).parents[3] / "data" / "scenes"
RIM = """
[scene]
kind = "rim"
t_end = 0.001
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 15.0
[contact]
clearance = 1e-4
friction = 0.15
[speed]
hz = 80.0
[scheme]
kind = "exact-modal"
dt = 1e-5
"""
RODS = """
[scene]
kind = "rods"
t_end = 1e-4
[[rod]]
length = 0.1
area = 1e-4
E = {E}
rho = {rho}
[scheme]
kind = "forward-lagrange"
courant = 0.5
[[wall]]
x = -0.01
"""
WRONG = [
    ("hz = 80.0", "hz = 4800.0", "speed", ["speed.hz: found 4800 Hz = 288,000 rpm", "4800 rpm are 80 Hz"]),
    ("hz = 80.0", "hz = 80.0\nscan = {from_hz = 1.0, to_hz = 4800.0}", "speed", ["speed.scan.to_hz", "is this rpm?"]),
    ("= 1e-4", "= 0.5", "clearance", ["contact.clearance: found 0.5 m", "in mm? 0.5 mm are 0.0005 m"]),
    (
        "= 0.15",
        "= 15.0",
        "friction",
        ["contact.friction: found 15, expected 0 to 2", "15 percent are 0.15"],
    ),
    ("= 15.0", "= 80.0", "lean", ["blade.lean_deg: found 80 degrees, expected -75 to 75"]),
]


def refused(folder, text):
    ring().save(folder / "casing.npz")
    blade().save(folder / "blade.npz")
    file = folder / "scene.toml"
    file.write_text(text)
    with pytest.raises(ct.InputError) as caught:
        ct.load_scene(file)
    return str(caught.value)


@pytest.mark.parametrize(("old", "new", "name", "words"), WRONG)
def test_a_number_in_another_unit_is_refused_with_the_slip_and_taken_where_allowed(tmp_path, old, new, name, words):
    text = RIM.replace(old, new)
    found = refused(tmp_path, text)
    assert all(part in found for part in [*words, f'write [checks] allow = ["{name}"]']), found
    (tmp_path / "scene.toml").write_text(f'{text}[checks]\nallow = ["{name}"]\n')
    if name != "clearance":  # a gap of the size of the rim is refused by the rim too
        ct.load_scene(tmp_path / "scene.toml")


def test_all_implausible_numbers_are_named_at_once_and_names_of_checks_are_listed(tmp_path):
    text = RIM
    for old, new in (("hz = 80.0", "hz = 4800.0"), ("= 1e-4", "= 0.5"), ("= 0.15", "= 15.0")):
        text = text.replace(old, new)
    assert len(refused(tmp_path, text).splitlines()) == 3
    assert "'speed'" in refused(tmp_path, f'{RIM}[checks]\nallow = ["sped"]\n')


@pytest.mark.parametrize(
    ("E", "rho", "words"),
    [
        ("210.0", "7800.0", "rod[1].E: found 210 Pa"),
        ("210e9", "7.8", "in g/cm^3? 7.8 g/cm^3 are 7800 kg/m^3"),
        ("210e9", "7.8e-9", "in t/mm^3? 7.8e-09 t/mm^3 are 7800 kg/m^3"),
    ],
)
def test_a_rod_whose_other_number_is_that_of_a_solid_is_refused(tmp_path, E, rho, words):
    assert words in refused(tmp_path, RODS.format(E=E, rho=rho))


def test_only_units_that_make_a_length_usual_are_suggested(tmp_path):
    """100 inches are 2.54 m; 500 would be 12.7 m."""
    text = (SCENES / "beam_in_ring.toml").read_text(encoding="utf-8")
    for length, words in ((100.0, "in mm? 100 mm are 0.1 m, or in inches? 100 inches are 2.54 m"), (500.0, "in mm?")):
        found = refused(tmp_path, re.sub("^length = .*", f"length = {length}", text, flags=re.MULTILINE))
        assert (words in found, "inches" in found) == (True, length < 200.0), found


def test_keys_that_may_be_left_out_and_entries_of_lists_are_checked_too(tmp_path):
    text = (SCENES / "beam_in_ring.toml").read_text(encoding="utf-8")
    head, ring_table = text.split("[ring]")
    found = refused(tmp_path, f"{head}[ring]{re.sub('^E = .*', 'E = 210.0', ring_table, flags=re.MULTILINE)}")
    assert "ring.E: found 210 Pa, expected 1e+06 to 1.3e+12 Pa" in found
    assert "in GPa? 210 GPa are 2.1e+11 Pa" in found
    text = (SCENES / "coulomb_oscillator.toml").read_text(encoding="utf-8")
    found = refused(tmp_path, text.replace("omega = [1.0, 0.0]", "omega = [1.0, 1e10]"))
    assert "body.omega[2]: found 1e+10 rad/s" in found


def test_a_bound_is_written_with_its_power_of_ten(tmp_path):
    text = RODS.format(E=1.0, rho=1.0) + "[[mass]]\nmass = 1.0\nx = 1.0\nvelocity = 1e30\n"
    assert "mass[1].velocity: found 1e+30, expected less than or equal to 1e+25" in refused(tmp_path, text)


def test_rods_in_reduced_units_are_taken(tmp_path):
    for E, rho in (("900.0", "1.0"), ("1.0", "1.0"), ("210e9", "7800.0"), ("30e6", "7.34e-4")):
        (tmp_path / "scene.toml").write_text(RODS.format(E=E, rho=rho))
        ct.load_scene(tmp_path / "scene.toml")


def test_the_page_of_limits_lists_every_check_that_a_scene_may_allow(tmp_path):
    page = (Path(__file__).parents[3] / "docs" / "limits.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| ([a-z-]+) \| [^|]+ \| [-+.e\d]+ \| [-+.e\d]+ \|", page, re.MULTILINE)
    ran = refused(tmp_path, f'{RIM}[checks]\nallow = ["sped"]\n')
    assert listed == re.findall(r"'([a-z-]+)'", ran.partition("expected")[2])
    bounds = {"friction": "| 0 | 2 |", "lean": "| -75 | 75 |"}
    for name, between in bounds.items():
        assert re.search(rf"^\| {name} \| [^|]+ {re.escape(between)}", page, re.MULTILINE)


def test_interactions_examine_no_rim_faster_than_a_run_may_be(tmp_path):
    limit = 600.0 / (2.0 * np.pi * ring().line_radius(0))
    for speed in (f"hz = {1.01 * limit}", f"hz = 80.0\nscan = {{from_hz = 1.0, to_hz = {1.01 * limit}}}"):
        assert "expected at most 600 m/s" in refused(tmp_path, RIM.replace("hz = 80.0", speed))
    scene = tmp_path / "scene.toml"
    scene.write_text(RIM.replace("hz = 80.0", f"hz = {0.8 * limit}"))
    assert ct.scene.load_interactions(scene).speed_hz[-1] == pytest.approx(limit)
    scene.write_text(RIM.replace("hz = 80.0", f"hz = {1.5 * limit}") + '[checks]\nallow = ["speed"]\n')
    assert ct.scene.load_interactions(scene).speed_hz[-1] == pytest.approx(1.5 * limit)
