"""Shapes for ParaView: what is written is read back by another program's reader, and by parsing the XML."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import meshio
import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from casingfem.export.meshes import drawn_surface, mode_files
from contact.io.outfiles import write_files
from tests.casingfem.study.study_texts import PLATE, written


@pytest.fixture(scope="module")
def casing(frustum, coarse) -> cf.Modes:
    wavy = cf.FourierField.of({0: 0.1, 2: 0.3})
    return cf.modes(frustum(thickness=20e-3, mesh=coarse, thickness_defect=wavy), 4)


@pytest.fixture(scope="module")
def blade(steel) -> cf.Modes:
    chart = cf.TwistedPlate(length=0.3, width=0.1, twist=0.5)
    mesh = cf.ShellMesh(order=4, rows=(0.0, 0.3, 1.0), around=2)
    return cf.modes(
        cf.Shell(chart=chart, thickness=3e-3, material=steel, supports={"root": cf.Clamped()}, mesh=mesh), 3
    )


@pytest.fixture(scope="module")
def folder(casing, tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("vtu")
    write_files(target, mode_files(casing, [0, 2], phases=8, exaggeration=0.1))
    return target


def quad_areas(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Vector areas of the quadrilaterals, (cells, 3)."""
    corners = points[quads]
    return 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])


def test_a_reader_finds_the_shape_as_computed(casing, folder):
    mesh = meshio.read(folder / "mode_003.vtu")
    surface = drawn_surface(casing)
    assert np.array_equal(mesh.points, surface.points)
    assert np.array_equal(mesh.point_data["displacement"], casing.fields[:, :3, 2])
    assert np.array_equal(mesh.point_data["thickness"], surface.thickness)
    assert surface.thickness.max() == pytest.approx(20e-3 * 1.4)
    assert mesh.field_data["freq_hz"].tolist() == [casing.freq[2]]


@pytest.mark.parametrize("name", ["casing", "blade"])
def test_the_cells_cover_the_surface_once_and_face_outward(name, request):
    modes = request.getfixturevalue(name)
    surface = drawn_surface(modes)
    areas = quad_areas(surface.points, surface.cells)
    exact = np.sum(modes.grid.measure * np.linalg.norm(np.cross(*tangents(modes), axis=0), axis=0))
    assert np.linalg.norm(areas, axis=1).sum() == pytest.approx(exact, rel=5e-3)
    facing = np.einsum("ci,ci->c", areas, surface.normals[surface.cells[:, 0]])
    assert np.all(facing > 0.0)
    assert np.array_equal(np.unique(surface.cells), np.arange(len(surface.points)))
    outward = modes.shell.chart.directions(*modes.grid.nodes)[0]
    assert np.all(np.einsum("ni,in->n", surface.normals, outward) > 0.8)


def tangents(modes: cf.Modes) -> tuple[np.ndarray, np.ndarray]:
    surface = modes.shell.geometry(*modes.grid.parameters).surface
    return surface.x1, surface.x2


def test_normal_displacement_is_outward_and_part_of_the_whole(casing, folder):
    data = meshio.read(folder / "mode_001.vtu").point_data
    expected = np.einsum("ni,ni->n", drawn_surface(casing).normals, data["displacement"])
    assert np.allclose(data["normal_displacement"], expected)
    assert np.abs(expected).max() > 0.9 * np.linalg.norm(data["displacement"], axis=1).max()


def test_the_series_swings_once_and_moves_the_points(casing, folder):
    entries = list(ET.parse(folder / "mode_001.pvd").getroot().iter("DataSet"))
    assert [float(e.get("timestep")) for e in entries] == [k / 8 for k in range(8)]
    still = drawn_surface(casing).points
    reach = 0.1 * np.linalg.norm(np.ptp(still, axis=0))
    shape = casing.fields[:, :3, 0]
    unit = shape / np.linalg.norm(shape, axis=1).max()
    for k, entry in enumerate(entries):
        mesh = meshio.read(folder / str(entry.get("file")))
        assert np.allclose(mesh.points - still, reach * np.cos(np.pi * k / 4) * unit, atol=1e-6)


def test_only_the_modes_chosen_are_written(folder):
    names = sorted(path.name for path in folder.iterdir())
    assert len(names) == 2 * (2 + 5)
    assert {name.split(".")[0][:8] for name in names} == {"mode_001", "mode_003"}


def test_what_cannot_be_drawn_is_refused(casing):
    with pytest.raises(ValueError, match="even number"):
        mode_files(casing, phases=7)
    with pytest.raises(ValueError, match="exaggeration"):
        mode_files(casing, exaggeration=0.0)
    with pytest.raises(ValueError, match="mode 5 is not among the 4"):
        mode_files(casing, [4])


def test_the_command_writes_the_chosen_modes_beside_the_table(tmp_path):
    base = ["modes", str(written(tmp_path, PLATE))]
    out = ["--out", str(tmp_path / "out")]
    result = CliRunner().invoke(main, [*base, *out, "--vtu", "--modes", "1,3"])
    assert result.exit_code == 0, result.stderr
    assert f"wrote 22 files to {tmp_path / 'out' / 'vtu'}" in result.stdout
    found = json.loads((tmp_path / "out" / "modes.json").read_text())["modes"]
    for mode in (1, 3):
        mesh = meshio.read(tmp_path / "out" / "vtu" / f"mode_00{mode}.vtu")
        assert mesh.field_data["freq_hz"][0] == found[mode - 1]["freq_hz"]
    for arguments, words in (
        ([*out, "--vtu", "--modes", "1,4"], "up to the 3 modes"),
        ([*out, "--vtu", "--modes", "0"], "such as 1,2,5"),
        ([*out, "--modes", "1"], "give --vtu too"),
        (["--vtu"], "needs --out"),
    ):
        refused = CliRunner().invoke(main, [*base, *arguments])
        assert refused.exit_code == 2
        assert words in refused.stderr
