"""Shapes for ParaView: what is written is read back by another program's reader, and as the format says."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from casingfem.export.meshes import drawn_mesh, drawn_surface, mode_files, vtu
from contact.io.outfiles import write_files
from tests.casingfem.export.played import steps_of
from tests.casingfem.structure.imported.parts import added_nodes
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
    steps = steps_of(folder / "mode_001.vtkhdf")
    assert [step.time for step in steps] == [k / 8 for k in range(8)]
    still = drawn_surface(casing).points
    reach = 0.1 * np.linalg.norm(np.ptp(still, axis=0))
    shape = casing.fields[:, :3, 0]
    unit = shape / np.linalg.norm(shape, axis=1).max()
    for k, step in enumerate(steps):
        assert np.allclose(step.points - still, reach * np.cos(np.pi * k / 4) * unit, atol=1e-6)
        assert step.cells == drawn_surface(casing).cells.tolist()


def test_a_step_has_its_own_part_of_the_shape_and_the_mode_it_is_of(casing, folder):
    atol = 1e-6 * np.abs(casing.fields[:, :3, 2]).max()
    for k, found in enumerate(steps_of(folder / "mode_003.vtkhdf")):
        expected = np.cos(np.pi * k / 4) * casing.fields[:, :3, 2]
        np.testing.assert_allclose(found.point_data["displacement"], expected, atol=atol)
        np.testing.assert_allclose(found.point_data["thickness"], drawn_surface(casing).thickness, rtol=1e-6)
        assert found.field_data["freq_hz"] == casing.freq[2]
        assert found.field_data["nodal_diameters"] == casing.nodal_diameters[2]


# opposite corners between which the nodes after the corners stand: of edges, then faces and cell, by VTK's manual
SQUARE, BRICK = "01 12 23 30", "01 12 23 30 45 56 67 74 04 15 26 37"
MIDDLES = {
    "quad": "", "quad8": SQUARE, "quad9": f"{SQUARE} 02", "tetra": "", "tetra10": "01 12 20 03 13 23",
    "hexahedron": "", "hexahedron20": BRICK, "hexahedron27": f"{BRICK} 07 16 05 36 02 46 06",
}  # fmt: skip


@pytest.mark.parametrize("kind", MIDDLES)
def test_another_reader_finds_the_nodes_of_an_imported_part_where_its_cells_have_them(kind, tmp_path):
    """Middles halfway between their corners, corners counted the right way round, nodes of no cell left out."""
    dim = 2 if kind.startswith("quad") else 3
    grid = cf.imported.grid_mesh(
        kind, (2, 1, 1)[:dim], lambda u: np.pad(u * (4.0, 2.0, 1.0)[:dim], ((0, 0), (0, 3 - dim)))
    )
    mesh, _ = added_nodes(grid, [9.0, 9.0, 9.0])
    order = np.roll(np.arange(len(mesh.points)), 1)  # the node of no cell comes first
    place = np.argsort(order)
    mesh = replace(mesh, points=mesh.points[order], cells=place[mesh.cells], node_numbers=mesh.node_numbers + 100)
    part = drawn_mesh(SimpleNamespace(structure=SimpleNamespace(mesh=mesh)))
    (tmp_path / "part.vtu").write_bytes(vtu(part.points, part.cells, {"label": part.labels}, {}, part.kind))
    found = meshio.read(tmp_path / "part.vtu")
    ((name, cells),) = found.cells_dict.items()
    assert name == kind
    assert found.point_data["label"].tolist() == list(range(102, 102 + len(grid.points)))
    np.testing.assert_array_equal(found.points, grid.points)
    at = found.points[cells]
    for k, (a, b) in enumerate(MIDDLES[kind].split(), start=4 if kind[0] in "qt" else 8):
        np.testing.assert_allclose(at[:, k], (at[:, int(a)] + at[:, int(b)]) / 2.0, atol=1e-14)
    ahead, aside, above = (at[:, k] - at[:, 0] for k in {"q": (1, 3, 2), "t": (1, 2, 3), "h": (1, 3, 4)}[kind[0]])
    normal = np.cross(ahead, aside)
    size = normal[:, 2] if dim == 2 else np.einsum("ci,ci->c", normal, above) / (6.0 if kind[0] == "t" else 1.0)
    assert size.min() > 0.0
    assert size.sum() == pytest.approx(8.0)


def test_only_the_modes_chosen_are_written(folder):
    names = sorted(path.name for path in folder.iterdir())
    assert names == ["mode_001.vtkhdf", "mode_001.vtu", "mode_003.vtkhdf", "mode_003.vtu"]


def test_all_modes_are_written_if_none_are_named(casing):
    files = mode_files(casing, phases=4)
    assert list(files) == [f"mode_{k}{end}" for k in ("001", "002", "003", "004") for end in (".vtu", ".vtkhdf")]


def test_files_that_play_need_h5py(casing, monkeypatch):
    monkeypatch.setattr("casingfem.export.series.find_spec", lambda name: None)
    with pytest.raises(cf.errors.MissingExtraError, match=r"--vtu: found no package h5py; expected .*test-data"):
        mode_files(casing, [0])


def test_what_cannot_be_drawn_is_refused(casing):
    with pytest.raises(ValueError, match="phases must be an even number of at least 4, found 2"):
        mode_files(casing, phases=2)
    with pytest.raises(ValueError, match="mode 0 is not among the 4"):
        mode_files(casing, [-1])
    with pytest.raises(ValueError, match="exaggeration must be positive, found inf"):
        mode_files(casing, exaggeration=np.inf)
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
    assert f"wrote 4 files to {tmp_path / 'out' / 'vtu'}" in result.stdout
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
