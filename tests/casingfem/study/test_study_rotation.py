"""[rotation], symmetry planes and domes in study files."""

from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.study.study_texts import written

STUDY = Path(__file__).parents[3] / "data" / "studies" / "rotating_blade.toml"
BLADE = STUDY.read_text()
HUB = "hub_radius = 0.3\nstagger_deg = 30.0\n"


def loaded(tmp_path, text):
    return cf.load_study(written(tmp_path, text))


def domed(start, end):
    dome = f'kind = "dome"\nradius = 0.2\nstart_deg = {start}\nend_deg = {end}\n'
    text = BLADE.replace('kind = "plate"\nlength = 0.11\nwidth = 0.04\n', dome).replace(HUB, "")
    return text.replace("[support.root]", "[support.base]").replace('"clamped"', '"symmetry"').partition("[reduce]")[0]


@pytest.mark.slow
def test_the_blade_of_the_data_turns(tmp_path):
    study = cf.load_study(STUDY)
    assert study.shell.rotation.omega == pytest.approx(200.0 * np.pi)
    np.testing.assert_allclose(study.shell.rotation.axis, [0.0, np.sqrt(0.75), 0.5], atol=1e-15)
    still = loaded(tmp_path, BLADE.partition("[rotation]")[0])
    turning, resting = (cf.modes(shell, 1).freq[0] for shell in (study.shell, still.shell))
    assert [round(float(freq)) for freq in (resting, turning)] == [141, 258]


def test_an_axis_by_name_and_place(tmp_path):
    placed = loaded(tmp_path, BLADE.replace(HUB, 'axis = "y"\ncentre = [-0.3, 0.0, 0.0]\n'))
    on_hub = loaded(tmp_path, BLADE.replace(HUB, "hub_radius = 0.3\n"))
    assert placed.shell.rotation == on_hub.shell.rotation


def test_a_casing_turns_about_z_and_a_dome_is_on_a_plane_of_symmetry(tmp_path):
    shell = loaded(tmp_path, domed(0.0, 60.0)).shell
    assert shell.rotation.axis == (0.0, 0.0, 1.0)
    assert shell.supports["base"] == cf.edge.Symmetry()
    assert shell.chart.profile.length == pytest.approx(0.2 * np.pi / 3)


def test_the_angles_of_a_dome_stay_within_one_turn(tmp_path):
    assert loaded(tmp_path, domed(360.0, 300.0)).shell.chart.profile.length == pytest.approx(0.2 * np.pi / 3)
    for ends, message in (
        ((360.5, 300.0), "chart.start_deg: found 360.5"),
        ((-360.5, -300.0), "chart.start_deg: found -360.5"),
        ((300.0, 360.5), "chart.end_deg: found 360.5"),
        ((-300.0, -360.5), "chart.end_deg: found -360.5"),
        ((30.0, 30.0), "start_deg = 30 and end_deg = 30, expected two different angles"),
    ):
        with pytest.raises(cf.errors.InputError, match=message):
            loaded(tmp_path, domed(*ends))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ((HUB, ""), "rotation: found neither hub_radius nor axis"),
        (("hub_radius = 0.3", 'axis = "x"'), "rotation: found hub_radius or stagger_deg, and axis"),
        (("speed_hz = 100.0", "speed_hz = -1.0"), "rotation.speed_hz"),
        ((HUB, "axis = [0.0, 0.0, 0.0]\n"), "rotation-axis"),
        ((HUB, 'axis = "w"\n'), "rotation.axis"),
        (("[modes]", '[update]\ntable = "none.csv"\nparameter = []\n[modes]'), "update"),
    ],
)
def test_refused_by_key(tmp_path, change, message):
    with pytest.raises(cf.errors.InputError) as caught:
        loaded(tmp_path, BLADE.replace(*change))
    assert message in str(caught.value)


def test_a_rotating_part_is_not_updated(tmp_path):
    (tmp_path / "table.csv").write_text("# SYNTHETIC\nmode,n,freq_hz,sigma_hz,angle_deg,zeta\n1,,140.0,1.0,,\n")
    update = '[update]\ntable = "table.csv"\n[[update.parameter]]\nname = "material.E"\nlower = 1e11\nupper = 3e11\n'
    with pytest.raises(cf.errors.InputError, match="a test at rest"):
        loaded(tmp_path, BLADE + update)
