"""What study.toml says of edges: bolts, rings and masses become objects, or problems with their key."""

from pathlib import Path

import pytest

import casingfem as cf
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


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("k = 2e8", "", r"support\.base: found neither k nor k_r"),
        ("k = 2e8", "k = 2e8\nk_r = 1e8", r"support\.base: found k beside k_r"),
        ("bolt = 7", "bolt = 3", r"support\.base: loose: found bolts \[3, 3\]"),
        ("bolt = 7", "bolt = 25", r"support\.base: .*found bolt 25, .*bolt-number"),
        ("width_m = 0.05", "width_m = 0.5", r"support\.base: .*patches overlap.*bolt-overlap"),
        ("count = 24", "counts = 24", r"support\.base\.counts: found an unknown key"),
    ],
)
def test_problems_of_bolts_name_their_key(study, old, new, message):
    with pytest.raises(cf.errors.InputError, match=message):
        study(BOLTS.replace(old, new))


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
