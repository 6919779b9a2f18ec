"""[chart] of kind "meridian": pieces, fillets and walls of a file are those of Python."""

import pytest

import casingfem as cf
from tests.casingfem.study.study_texts import STEEL

CASING = f"""{STEEL}[chart]
kind = "meridian"
start = [0.30, 0.0]
fillet = 3e-3
[[chart.piece]]
to = [0.30, 0.15]
[[chart.piece]]
to = [0.22, 0.30]
thickness = 5e-3
fillet = 6e-3
material = {{E = 70e9, nu = 0.33, rho = 2700.0}}
[[chart.piece]]
to = [0.25, 0.34]
radius = -0.1
[shell]
thickness = 3e-3
[support.base]
kind = "clamped"
"""


def test_pieces_of_the_file_are_those_of_the_shell(tmp_path):
    (tmp_path / "casing.toml").write_text(CASING)
    shell = cf.load_study(tmp_path / "casing.toml").shell
    made = cf.geometry.PiecewiseMeridian(
        start=(0.30, 0.0),
        pieces=(
            cf.geometry.Piece(to=(0.30, 0.15)),
            cf.geometry.Piece(to=(0.22, 0.30), fillet=6e-3),
            cf.geometry.Piece(to=(0.25, 0.34), radius=-0.1),
        ),
        fillet=3e-3,
    )
    assert shell.chart.profile.lines == pytest.approx(made.lines)
    assert len(made.bends) == 5
    (wall,) = shell.strips
    assert (wall.start, wall.end) == pytest.approx(made.owners[1])
    assert (wall.thickness, wall.material) == (5e-3, cf.Material(E=70e9, nu=0.33, rho=2700.0))


@pytest.mark.parametrize(
    ("left_out", "thickness", "density"),
    [
        ("material = {E = 70e9, nu = 0.33, rho = 2700.0}\n", 5e-3, None),
        ("thickness = 5e-3\n", 3e-3, 2700.0),
    ],
)
def test_a_piece_has_a_wall_of_its_own_by_thickness_or_material_alone(tmp_path, left_out, thickness, density):
    assert left_out in CASING
    (tmp_path / "casing.toml").write_text(CASING.replace(left_out, "", 1))
    shell = cf.load_study(tmp_path / "casing.toml").shell
    (wall,) = shell.strips
    assert (wall.start, wall.end) == pytest.approx(shell.chart.profile.owners[1])
    assert (wall.thickness, wall.material and wall.material.rho) == (thickness, density)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("fillet = 3e-3\n", "", "chart.piece[3].fillet: found none at a corner of"),
        ("fillet = 6e-3", "fillet = 2.0", "chart.piece[2].fillet: found 2 m, expected a smaller radius"),
        ("radius = -0.1", "radius = -0.01", "chart.piece[3].radius: found -0.01 m"),
        ("to = [0.22, 0.30]", "to = [0.22]", "chart.piece[2].to: found [0.22]"),
        ("to = [0.22, 0.30]", "to = [0.22, 0.30]\nend = 3", "chart.piece[2].end: found an unknown key"),
        ("start = [0.30, 0.0]", "start = [0.0, 0.0]", "meridian-axis"),
        ("[shell]", "[mesh]\nrows = 3\n[shell]", "strip-off-line"),
    ],
)
def test_bad_meridians_are_named_by_key(tmp_path, old, new, words):
    assert old in CASING
    (tmp_path / "casing.toml").write_text(CASING.replace(old, new, 1))
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(tmp_path / "casing.toml")
    assert words in str(caught.value)
