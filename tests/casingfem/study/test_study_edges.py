"""What study.toml says of edges: bolts, rings and masses become objects, or problems with their key."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from casingfem.study.load import tables_of
from casingfem.study.updated import perfect, updated_toml
from tests.casingfem.study.study_texts import STEEL, THIN, written

PLATE = STEEL + "[chart]\n{}[shell]\nthickness = 3.0e-3\n"
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

    def load(more, chart=None):
        return cf.load_study(written(tmp_path, (PLATE.format(chart) if chart else THIN) + more))

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
    with pytest.raises(cf.errors.InputError, match=message):
        study(BOLTS.replace(old, new))


@pytest.mark.parametrize("k", ["k = 2e8", "k_r = 1e8\nk_z = 2e8"])
def test_an_updated_study_says_what_was_found(study, tmp_path, k):
    given = study(BOLTS.replace("k = 2e8", k))
    values = {"support.base.k": 4e8, "bolts.3.k": 1e8, "support.base.bolts.5.k": 2e8, "support.base.k_rot": 7.0}
    text = updated_toml(given, values, tmp_path)
    tomllib.loads(text)
    again = study(text[text.index("[support.base]") :])
    for name, value in values.items():
        assert cf.updating.get_value(again.shell, name) == pytest.approx(value, rel=1e-12)


RING = """
[support.base]
kind = "ring"
width = 0.04
depth = 0.03
offset = [0.004, -0.02]
[support.base.material]
E = 70e9
nu = 0.33
rho = 2700.0
[support.base.support]
kind = "bolts"
count = 24
k = 2e8
[[mass]]
edge = "base"
angle_deg = 90.0
mass = 0.25
"""


def test_a_ring_on_bolts_and_a_mass_of_a_study(study, tmp_path):
    shell = study(RING).shell
    ring = shell.supports["base"]
    assert (ring.section.width, ring.section.depth, ring.offset, ring.foot) == (0.04, 0.03, (0.004, -0.02), None)
    assert ring.material.E == 70e9
    assert ring.support.count == 24
    assert shell.mesh.around % 24 == 0
    (mass,) = shell.masses["base"]
    np.testing.assert_allclose([mass.angle, mass.mass], [np.pi / 2, 0.25], rtol=1e-14)
    text = updated_toml(study(RING), {"support.base.k": 4e8, "bolts.3.k": 1e8}, tmp_path)
    again = study(text[text.index("[[mass]]") :]).shell
    assert cf.updating.get_value(again, "bolts.3.k") == pytest.approx(1e8)
    assert cf.updating.get_value(again, "support.base.k") == pytest.approx(4e8)
    assert again.supports["base"].section == ring.section


def test_a_ring_on_an_elastic_bed_is_a_parameter_too(study, tmp_path):
    bed = RING.replace('kind = "bolts"\ncount = 24\nk = 2e8', 'kind = "elastic"\nk_face = 1e12')
    given = study(bed)
    assert cf.updating.get_value(given.shell, "support.base.k_face") == 1e12
    text = updated_toml(given, {"support.base.k_face": 3e12}, tmp_path)
    assert study(text[text.index("[[mass]]") :]).shell.supports["base"].support.k_face == 3e12


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("width = 0.04", "", r"support\.base: found depth, expected width and depth, or diameter"),
        ("width = 0.04", "width = 0.04\ndiameter = 0.1", r"expected width and depth, or diameter"),
        ("offset = [0.004, -0.02]", "offset = [0.004]", r"support\.base\.offset"),
        ('edge = "base"', 'edge = "rim"', r"mass\[1\]\.edge: found 'rim'"),
        ("mass = 0.25", "mass = -0.25", r"mass\[1\]\.mass: found -0\.25"),
        ("count = 24", "count = 0", r"support\.base\.support\.count: found 0"),
    ],
)
def test_problems_of_rings_and_masses_name_their_key(study, old, new, message):
    with pytest.raises(cf.errors.InputError, match=message):
        study(RING.replace(old, new))


def test_the_example_of_a_bolted_ring():
    shell = cf.load_study(Path(__file__).parents[3] / "data" / "studies" / "bolted_ring.toml").shell
    assert cf.updating.get_value(shell, "bolts.3.k") == pytest.approx(6e7)
    assert shell.mesh.around == 24


@pytest.mark.parametrize(
    ("more", "key"),
    [
        ('[[mass]]\nedge = "tip"\nangle_deg = 1.0\nmass = 0.02', "mass[1]"),
        ('[support.root]\nkind = "bolts"\ncount = 1\nk = 1e8\nwidth_deg = 1.0', "support.root"),
    ],
)
def test_degrees_on_the_straight_edge_of_a_plate_are_refused(study, more, key):
    """They were taken for metres times 180/pi."""
    with pytest.raises(cf.errors.InputError, match="an edge without angles") as caught:
        study(more, chart='kind = "plate"\nlength = 0.2\nwidth = 0.04\n')
    assert key in str(caught.value)


@pytest.mark.parametrize(("text", "line"), [(b"\xff", 1), (b"\n\xff", 2), (b"a = 1\n\nb = '\xe9'\n", 3)])
def test_a_byte_that_is_no_text_is_named_with_its_line(tmp_path, text, line):
    (tmp_path / "study.toml").write_bytes(text)
    with pytest.raises(cf.errors.InputError, match=rf"study\.toml: line {line}: found byte 0x\w\w, which is not UTF-8"):
        tables_of(tmp_path / "study.toml")
