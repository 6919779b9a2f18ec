"""`casingfem campbell` of a scene of a rotor: the Jeffcott rotor in closed form, files, other kinds refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from casingfem.cli import main
from tests.probed import numbers_of_document

SCENES = Path(__file__).parents[3] / "data" / "scenes"


def invoke(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.mark.slow
def test_campbell_of_a_jeffcott_rotor_is_its_closed_form(tmp_path, held):
    """Frequency f sqrt(1 - zeta^2) at every speed, critical speed f = sqrt(k/m)/(2 pi), orbit by its formula."""
    found = invoke("campbell", SCENES / "jeffcott.toml", "--steps", 3, "--json", "--out", tmp_path)
    assert found.exit_code == 0, found.stderr
    document = json.loads(found.stdout)
    f, zeta = np.sqrt(4e6 / 10.0) / (2.0 * np.pi), 0.02
    np.testing.assert_allclose([row["freq_hz"] for row in document["whirl"]], f * np.sqrt(1.0 - zeta**2), rtol=1e-9)
    np.testing.assert_allclose([one["speed_hz"] for one in document["critical_speeds"]], f, rtol=1e-9)
    speed, radius = (np.array([row[key] for row in document["response"]]) for key in ("speed_hz", "radius_m"))
    r, moment = speed / f, abs(1e-3 + 5e-2j)  # after the release, 90 degrees ahead
    np.testing.assert_allclose(radius, moment / 10.0 * r**2 / np.hypot(1.0 - r**2, 2.0 * zeta * r), rtol=1e-9)
    assert {file.name for file in tmp_path.iterdir()} >= {"campbell.csv", "response.csv", "campbell.png"}
    held(1e-4, document=numbers_of_document(document))


def test_campbell_refuses_scenes_of_other_kinds():
    kind = "scene.kind: found another kind, expected a study or a scene of kind 'rotor'"
    for name, words in (("two_rods", kind), ("bladed_disk", f"{kind}: casingfem interactions finds")):
        found = invoke("campbell", SCENES / f"{name}.toml")
        assert found.exit_code == 2
        assert words in found.stderr


def test_campbell_of_a_rotor_in_a_casing_is_that_of_the_rotor():
    found = invoke("campbell", SCENES / "blade_off" / "rigid.toml", "--steps", 3, "--json")
    assert found.exit_code == 0, found.stderr
    critical = json.loads(found.stdout)["critical_speeds"]
    np.testing.assert_allclose([one["speed_hz"] for one in critical], np.sqrt(4e5) / (2.0 * np.pi), rtol=1e-9)
