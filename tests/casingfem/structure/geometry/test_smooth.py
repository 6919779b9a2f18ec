"""A meridian through points: a cone and a dome by their points, studies with points in a file, and bad points."""

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from tests.casingfem.study.study_texts import STEEL

MATERIAL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


def freq(chart, **parts):
    shell = cf.Shell(chart=chart, thickness=5e-3, material=MATERIAL, supports={"base": cf.Clamped()}, **parts)
    return cf.modes(shell, count=6).freq


def test_points_on_a_line_are_a_frustum():
    points = [(0.30 - 0.2 * z, z) for z in (0.0, 0.05, 0.08, 0.2)]
    smooth = cf.Revolved(profile=cf.geometry.SmoothMeridian(points=points))
    mesh = cf.ShellMesh(order=6, rows=1, around=13)
    np.testing.assert_allclose(
        freq(smooth, mesh=mesh), freq(cf.Frustum(r_base=0.30, r_top=0.26, height=0.2), mesh=mesh), rtol=1e-9
    )


@pytest.mark.slow
def test_points_on_an_arc_approach_a_dome():
    exact = freq(cf.Revolved(profile=cf.geometry.Arc(radius=0.4, start=-0.5, end=0.5)))
    errors = []
    for count in (11, 21):
        phi = np.linspace(-0.5, 0.5, count)
        points = [(0.4 * np.cos(x), 0.4 * np.sin(x)) for x in phi]
        found = freq(cf.Revolved(profile=cf.geometry.SmoothMeridian(points=points)))
        errors.append(np.abs(found / exact - 1.0).max())
    assert errors[1] < 5e-6
    assert errors[0] > 6.0 * errors[1]


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(0.3, 0.0)], r"found 1 points, expected two points \[r, z\] or more"),
        ([(0.3, 0.0), (0.3, 0.0), (0.2, 0.1)], "found points 1 and 2 at one place"),
        ([(0.3, 0.0), (0.3, 0.1), (0.2, 0.1)], "found a corner of 90 degrees at point 2, expected at most 30"),
        ([(0.3, 0.0), (0.0, 0.1)], "found a radius of 0 m on the meridian"),
        (
            [(0.3, 0.0), (float("nan"), 0.1)],
            r"expected two points \[r, z\] or more; give at least two different points",
        ),
    ],
)
def test_points_without_a_smooth_line_are_refused(points, words):
    with pytest.raises(cf.errors.ModelError, match=words):
        cf.geometry.SmoothMeridian(points=points)


STUDY = f"""{STEEL}[chart]
kind = "points"
points = "cad.csv"
[shell]
thickness = 5e-3
[support.base]
kind = "clamped"
[modes]
count = 4
"""


def test_a_study_takes_its_points_from_a_table_in_any_unit_or_from_a_list(tmp_path):
    study, table = tmp_path / "bell.toml", tmp_path / "cad.csv"
    study.write_text(STUDY)
    table.write_text("# from CAD\nz [mm];r [mm]\n0;300\n100;295,5\n200;280\n")
    from_file = cf.load_study(study).shell.chart.profile
    study.write_text(STUDY.replace('"cad.csv"', "[[0.3, 0.0], [0.2955, 0.1], [0.28, 0.2]]"))
    assert np.allclose(from_file.points, cf.load_study(study).shell.chart.profile.points, rtol=1e-15)


def test_all_that_is_wrong_with_a_table_of_points_is_named_with_its_line(tmp_path):
    study, table = tmp_path / "bell.toml", tmp_path / "cad.csv"
    study.write_text(STUDY)
    table.write_text("r_mm,z_mm\n300,0\n295,x\n,200\n")
    result = CliRunner().invoke(main, ["modes", str(study)])
    assert result.exit_code == 2
    assert "cad.csv, line 3, column 'z_mm': found 'x'" in result.stderr
    table.write_text("r_mm,height\n300,0\n")
    assert "line 1, column 'height': found a column without a unit" in CliRunner().invoke(
        main, ["modes", str(study)]
    ).stderr.replace("\n", " ")
    table.write_text("r_mm,z_mm,t_mm\n300,0,3\n300,100,3\n")
    assert "found r_mm,z_mm,t_mm; expected radius_m,z_m" in CliRunner().invoke(main, ["modes", str(study)]).stderr
