"""Blades from tables of sections: exact volumes, units, and tables that make no blade."""

import warnings
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main as casingfem
from casingfem.errors import InputError, ModelError

ROTOR37 = Path(__file__).parents[4] / "data" / "scenes" / "rotor37" / "sections.csv"
HEADER = "section,z_mm,r_mm,theta_1_deg,theta_2_deg"


def volume(mesh):
    """Its mass at unit density."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        system = cf.Solid(mesh=mesh, material=cf.Material(E=1e9, nu=0.3, rho=1.0)).assembled()
    return system.M.sum() / 3.0


def rows(sections=3, stations=6, *, closed=False):
    """Cells of a table of a slab, or of a lens, from 200 to 230 mm."""
    along = np.linspace(0.0, 1.0, stations)
    half = 4.0 * along * (1.0 - along) if closed else np.ones(stations)
    return [
        [str(k + 1), f"{30.0 * s:.6f}", f"{200.0 + 15.0 * k:.6f}", f"{-h:.6f}", f"{h:.6f}"]
        for k in range(sections)
        for s, h in zip(along, half, strict=True)
    ]


def written(folder, table, header=HEADER):
    file = folder / "sections.csv"
    file.write_text("\n".join([header, *(",".join(row) for row in table)]) + "\n")
    return file


def test_a_sector_of_a_ring_has_its_exact_volume():
    theta, r = 0.02, np.array([[0.20], [0.21], [0.24]])
    z, r = np.linspace(0.0, 0.03, 7) + 0.0 * r, r + np.zeros(7)
    sections = cf.imported.BladeSections.cylindrical(z, r, 0.0 * z - theta, 0.0 * z + theta)
    exact = (0.24**2 - 0.20**2) * np.sin(theta) * np.cos(theta) * 0.03  # flat through the thickness
    mesh = sections.mesh(cells=(4, 3, 2))
    assert sections.closed == (False, False)
    assert not mesh.collapsed.any()
    assert volume(mesh) == pytest.approx(exact, rel=1e-12)
    for name, radius in (("root", 0.20), ("tip", 0.24)):
        assert np.hypot(*mesh.points[mesh.groups[name].nodes][:, :2].T) == pytest.approx(radius, rel=3e-4)
        assert len(mesh.groups[name].facets) == 8


def test_an_elliptic_section_closes_in_wedges_and_its_volume_converges():
    a, b, length = 0.02, 0.003, 0.1
    angle = np.linspace(0.0, np.pi, 61)
    r = np.array([[5.0], [5.0 + length / 2.0], [5.0 + length]]) + 0.0 * angle
    z, half = a * (1.0 - np.cos(angle)) + 0.0 * r, b * np.sin(angle) / r
    sections = cf.imported.BladeSections.cylindrical(z, r, half, -half)  # in the other order
    meshes = [sections.mesh(cells=(n, 2, 1)) for n in (6, 12, 24)]
    error = [abs(volume(mesh) / (np.pi * a * b * length) - 1.0) for mesh in meshes]
    assert sections.closed == (True, True)
    assert [int(mesh.collapsed.sum()) for mesh in meshes] == [4, 4, 4]
    assert all(fine < coarse / 4.0 for coarse, fine in pairwise(error))
    assert error[-1] < 1e-4


def test_units_and_names_of_columns_do_not_change_the_mesh(tmp_path):
    table = rows(closed=True)
    one = cf.imported.BladeSections.from_csv(written(tmp_path, table)).mesh((4, 2, 1))
    other = [
        [number, f"{float(z) / 10.0:.7f}", f"{float(r) / 1e3:.9f}", *(f"{np.radians(float(x)):.12f}" for x in angles)]
        for number, z, r, *angles in table
    ]
    text = "section,z [cm],R [m],Theta 1 [rad],theta2 [rad]"
    assert cf.imported.BladeSections.from_csv(written(tmp_path, other, text)).mesh((4, 2, 1)).points == pytest.approx(
        one.points, abs=1e-9
    )


def test_two_sections_make_a_straight_blade_and_a_mirrored_one_has_its_frequencies(tmp_path):
    table = rows(sections=2, closed=True)
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)

    def freq(table):
        mesh = cf.imported.BladeSections.from_csv(written(tmp_path, table)).mesh((6, 3, 1))
        return cf.modes(cf.Solid(mesh=mesh, material=steel, supports={"root": cf.Clamped()}), 3).freq

    mirrored = [[*row[:3], f"{-float(row[3]):.6f}", f"{-float(row[4]):.6f}"] for row in table]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert freq(mirrored) == pytest.approx(freq(table), rel=1e-9)


def change(row, column, value):
    def changed(table):
        table[row][column] = value
        return table

    return changed


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda t: t[:6], "found 1 section; expected at least 2"),
        (lambda t: [row for k, row in enumerate(t) if k % 6 < 3], r"line 2, section 1: found 3 stations; expected"),
        (change(7, 0, "1"), r"line 9, column 'section': found section 1 after section 2"),
        (change(8, 1, "6.000000"), r"line 10, section 2: found the place of the station before"),
        (change(3, 3, "9.000000"), r"line 5, section 1: found surfaces that cross"),
        (change(9, 2, "-215"), r"line 11, section 2: found a radius of -0.215 m"),
        (change(2, 4, "x"), r"line 4, column 'theta_2_deg': found 'x'; expected a finite number"),
        (change(2, 4, "400"), r"line 4, column 'theta_2_deg': found 6\.98132 rad; expected at most 2"),
        (lambda t: [[*r[:2], f"{1e3 * float(r[2])}", *r[3:]] for r in t], r"'r_mm': found a mean radius of 215 m"),
    ],
)  # fmt: skip
def test_a_table_that_makes_no_blade_is_refused_with_its_line(tmp_path, damage, message):
    with pytest.raises(InputError, match=message):
        cf.imported.BladeSections.from_csv(written(tmp_path, damage(rows())))


def test_all_problems_of_a_table_come_at_once(tmp_path):
    table = rows()
    table[3][3], table[9][2] = "9.0", "-215"
    with pytest.raises(InputError) as raised:
        cf.imported.BladeSections.from_csv(written(tmp_path, table))
    assert [f"section {k}" in str(raised.value) for k in (1, 2)] == [True, True]


def test_an_edge_that_is_closed_in_some_sections_only_is_refused(tmp_path):
    table = rows(closed=True)
    table[6][3], table[6][4] = "-0.5", "0.5"
    with pytest.raises(InputError, match="meet at the first station of some sections, but not of 2"):
        cf.imported.BladeSections.from_csv(written(tmp_path, table))


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("section,z,r_mm,theta_1_deg,theta_2_deg", "column 'z': found a column without a unit.*expected z_m"),
        ("section,z_mm,r_mm,theta_1_deg", "found no such column among section,.*; expected one column theta_2"),
        ("z_mm,r_mm,theta_1_deg,theta_2_deg", "found no such column among z_mm,.*; expected a column section"),
        ("section,z_mm,r_mm,theta_1_deg,theta_2_deg,z_m", "found z_mm and z_m; expected one column z_m or z_mm"),
    ],
)
def test_a_column_that_is_missing_or_twice_there_or_has_no_unit_is_named(tmp_path, header, words):
    table = [(*row, row[1])[: header.count(",") + 1] for row in rows()]
    with pytest.raises(InputError, match=f"line 1.*{words}"):
        cf.imported.BladeSections.from_csv(written(tmp_path, table, header))


def test_numbers_of_cells_out_of_range_are_refused():
    sections = cf.imported.BladeSections.from_csv(ROTOR37)
    for cells in ((1, 4, 1), (4, 4), (4, 0, 1), (4, 2.5, 1), (1000, 4, 1)):
        with pytest.raises(ModelError, match="sections-cells"):
            sections.mesh(cells=cells)


STUDY = """
[material]
E = 180e9
nu = 0.3
rho = 8000.0
[solid]
{solid}
[support.root]
kind = "clamped"
[modes]
count = 2
"""


def test_a_study_names_its_sections_and_cells(tmp_path):
    (tmp_path / "sections.csv").write_bytes(ROTOR37.read_bytes())
    (tmp_path / "blade.toml").write_text(STUDY.format(solid='sections = "sections.csv"\ncells = [6, 4, 1]'))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        ran = CliRunner().invoke(casingfem, ["modes", str(tmp_path / "blade.toml")])
        one = cf.load_study(tmp_path / "blade.toml")
    assert ran.exit_code == 0, ran.output
    assert len(one.structure.mesh.cells) == 24
    before = one.source["sha256"]
    (tmp_path / "sections.csv").write_text(ROTOR37.read_text().replace(",-0.1165276,", ",-0.1165275,"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert cf.load_study(tmp_path / "blade.toml").source["sha256"] != before


@pytest.mark.parametrize(
    ("solid", "message"),
    [
        ('sections = "sections.csv"\nmesh = "blade.inp"', "both mesh and sections"),
        ("scale = 1.0", "neither mesh nor sections"),
        ('sections = "sections.csv"\nscale = 1e-3', "found scale with sections, whose columns name their units"),
        ('mesh = "blade.inp"\ncells = [6, 4, 1]', "found cells with mesh"),
        (
            'sections = "sections.csv"\ncells = [1, 4, 1]',
            r"blade.toml: solid.cells: found \[1, 4, 1\] cells.*at least 2 along the chord",
        ),
        ('sections = "sections.csv"\ncells = [6, 4]', "solid.cells"),
        ('sections = "nowhere.csv"', "solid.sections.*nowhere.csv"),
    ],
)
def test_keys_that_do_not_go_together_are_refused(tmp_path, solid, message):
    (tmp_path / "sections.csv").write_bytes(ROTOR37.read_bytes())
    (tmp_path / "blade.toml").write_text(STUDY.format(solid=solid))
    with pytest.raises(ValueError, match=message):
        cf.load_study(tmp_path / "blade.toml")


def test_cells_in_the_edges_of_a_blade_are_too_small_for_a_warning():
    mesh = cf.imported.BladeSections.from_csv(ROTOR37).mesh()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cf.Solid(mesh=mesh, material=cf.Material(E=180e9, nu=0.3, rho=8000.0), supports={"root": cf.Clamped()})


@pytest.mark.parametrize(("radius", "refused"), [(1.99e-3, True), (2.01e-3, False), (19.9, False), (20.1, True)])
def test_the_mean_radius_of_a_table_is_that_of_a_blade(radius, refused, tmp_path):
    table = [[*row[:2], f"{radius * (0.96 + 0.02 * float(row[0])):.9g}", *row[3:]] for row in rows()]
    file = written(tmp_path, [[row[0], f"{float(row[1]) * radius / 215.0}", *row[2:]] for row in table],
                   HEADER.replace("r_mm", "r_m").replace("z_mm", "z_m"))  # fmt: skip
    if not refused:
        assert len(cf.imported.BladeSections.from_csv(file).surfaces) == 3
        return
    with pytest.raises(InputError, match=rf"found a mean radius of {radius:.4g} m; expected 0.002 to 20 m; are these"):
        cf.imported.BladeSections.from_csv(file)


def test_a_table_without_rows_has_no_sections(tmp_path):
    with pytest.raises(InputError, match="found no rows below the header; expected at least one row"):
        cf.imported.BladeSections.from_csv(written(tmp_path, []))


@pytest.mark.parametrize("closed", [(True, False), (False, True), (True, True), (False, False)])
def test_an_edge_is_closed_where_the_surfaces_nearly_meet_and_has_one_point_there(closed):
    r = np.array([[0.20], [0.21], [0.24]]) + np.zeros(9)
    z = np.linspace(0.0, 0.03, 9) + 0.0 * r
    half = np.full((3, 9), 0.02)
    for end, meets in zip((0, -1), closed, strict=True):
        half[:, end] = 0.02 * (0.9e-4 if meets else 1.1e-4)
    found = cf.imported.BladeSections.cylindrical(z, r, -half, half)
    assert found.closed == closed
    for surface in found.surfaces:
        assert [np.array_equal(*surface[:, end]) for end in (0, -1)] == list(closed)
