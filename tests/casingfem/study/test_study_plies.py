"""[[shell.plies]] of a study: the same casing as in Python, and what does not fit."""

import pytest

import casingfem as cf

STUDY = """
[material]
E = 70e9
nu = 0.33
rho = 2700.0
[chart]
kind = "cylinder"
radius = 0.45
height = 0.25
[shell]
thickness = 6e-3
wall = "linear"
[[shell.plies]]
thickness = 2e-3
[[shell.plies]]
thickness = 4e-3
angle_deg = 30.0
lamina = "aramid"
[shell.lamina.aramid]
E1 = 76e9
E2 = 5.5e9
nu12 = 0.34
G12 = 2.3e9
G13 = 2.4e9
G23 = 1.8e9
rho = 1380.0
[support.base]
kind = "clamped"
[mesh]
order = 4
rows = 1
around = 7
"""


def test_plies_of_a_study_are_those_of_python(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    aramid = cf.shell.Lamina(E1=76e9, E2=5.5e9, nu12=0.34, G12=2.3e9, G13=2.4e9, G23=1.8e9, rho=1380.0)
    assert cf.load_study(path).shell.plies == (
        cf.shell.Ply(thickness=2e-3), cf.shell.Ply(thickness=4e-3, angle_deg=30.0, lamina=aramid)
    )  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("thickness = 4e-3", "thickness = 3e-3", r"plies of 0.005 m in a wall of 0.006 m"),
        ('lamina = "aramid"', 'lamina = "carbon"', "lamina 'carbon', expected one of: aramid"),
        ('wall = "linear"\n', "", "expected \"linear\""),
        ("nu12 = 0.34", "nu12 = 4.0", "nu12"),
        ("E1 = 76e9", "E1 = -76e9", "E1"),
    ],
)  # fmt: skip
def test_plies_that_do_not_fit_are_named(old, new, told, tmp_path):
    assert STUDY.count(old) == 1
    path = tmp_path / "study.toml"
    path.write_text(STUDY.replace(old, new))
    with pytest.raises(cf.errors.InputError, match=told):
        cf.load_study(path)


MESH = """*NODE
1, 0.0, 0.0, 0.0
2, 1.0, 0.0, 0.0
3, 1.0, 1.0, 0.0
4, 0.0, 1.0, 0.0
*ELEMENT, TYPE=S4, ELSET=wall
1, 1, 2, 3, 4
*NSET, NSET=root
1, 4
"""
ON_MESH = STUDY.partition("[chart]")[0] + "[shell]" + STUDY.partition("[shell]")[2].partition("[support.base]")[0]


def test_plies_on_a_mesh_count_from_a_direction(tmp_path):
    (tmp_path / "wall.inp").write_text(MESH)
    path = tmp_path / "study.toml"
    held = '[support.root]\nkind = "clamped"\n'
    path.write_text(ON_MESH.replace("[shell]", '[shell]\nmesh = "wall.inp"\nangle_from = [0.0, 2.0, 0.0]', 1) + held)
    wall = cf.load_study(path).structure
    assert (wall.wall, wall.angle_from, [ply.angle_deg for ply in wall.plies]) == (
        "linear",
        (0.0, 2.0, 0.0),
        [0.0, 30.0],
    )
    assert wall.density().tolist() == pytest.approx([2e-3 * 2700.0 + 4e-3 * 1380.0])
    path.write_text(ON_MESH.replace("[shell]", '[shell]\nmesh = "wall.inp"', 1) + held)
    with pytest.raises(
        cf.errors.InputError, match=r"angle_from: found \(0.0, 0.0, 1.0\), which is normal to 1 cell.*shell-plies"
    ):
        cf.load_study(path)
    path.write_text(STUDY.replace("[shell]", '[shell]\nangle_from = "x"', 1))
    with pytest.raises(cf.errors.InputError, match="or angle_from without mesh"):
        cf.load_study(path)
