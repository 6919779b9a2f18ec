"""What study.toml says of edges: bolts, rings and masses become objects, or problems with their key."""

import tomllib

import numpy as np
import pytest

from casingfem.study.load import load_study
from casingfem.study.problems import StudyError
from casingfem.study.updated import perfect, updated_toml
from casingfem.updating.parameters import get_value

CASING = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
[chart]
kind = "frustum"
r_base = 0.50
r_top = 0.45
height = 0.25
[shell]
thickness = 3.0e-3
"""
BOLTS = """
[support.base]
kind = "bolts"
count = 24
k = 2e8
k_rot = 1e3
first_angle_deg = 7.5
width_m = 0.05
loose = [{bolt = 3, factor = 0.3}, {bolt = 7, factor = 0.0}]
"""


@pytest.fixture
def study(tmp_path):
    """Load a study from the casing and more tables."""

    def load(more):
        path = tmp_path / "study.toml"
        path.write_text(CASING + more, encoding="utf-8")
        return load_study(path)

    return load


def test_bolts_of_a_study(study):
    bolts = study(BOLTS).shell.supports["base"]
    assert (bolts.count, bolts.k, bolts.k_rot, dict(bolts.loose)) == (24, 2e8, 1e3, {3: 0.3, 7: 0.0})
    np.testing.assert_allclose([bolts.first_angle, bolts.patch], [np.radians(7.5), 0.1], rtol=1e-14)
    three = study(BOLTS.replace("k = 2e8", "k_r = 1e8\nk_z = 3e8").replace("width_m = 0.05", "width_deg = 5.0"))
    assert three.shell.supports["base"].k == (1e8, 0.0, 3e8)
    assert dict(perfect(three.shell).supports["base"].loose) == {}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("k = 2e8", "", r"support\.base: found neither k nor k_r"),
        ("k = 2e8", "k = 2e8\nk_r = 1e8", r"support\.base: found k beside k_r"),
        ("bolt = 7", "bolt = 3", r"support\.base: loose: found bolts \[3, 3\]"),
        ("bolt = 7", "bolt = 25", r"support\.base: loose bolt 25 .*bolt-number"),
        ("width_m = 0.05", "width_m = 0.5", r"support\.base: patches .*bolt-overlap"),
        ("count = 24", "counts = 24", r"support\.base\.counts: found an unknown key"),
    ],
)
def test_problems_of_bolts_name_their_key(study, old, new, message):
    with pytest.raises(StudyError, match=message):
        study(BOLTS.replace(old, new))


@pytest.mark.parametrize("k", ["k = 2e8", "k_r = 1e8\nk_z = 2e8"])
def test_an_updated_study_says_what_was_found(study, tmp_path, k):
    given = study(BOLTS.replace("k = 2e8", k))
    values = {"support.base.k": 4e8, "bolts.3.k": 1e8, "support.base.bolts.5.k": 2e8, "support.base.k_rot": 7.0}
    text = updated_toml(given, values, tmp_path)
    tomllib.loads(text)
    again = study(text[text.index("[support.base]") :])
    for name, value in values.items():
        assert get_value(again.shell, name) == pytest.approx(value, rel=1e-12)
