"""`casingfem modes --vtu --uff`: what readers of other programs find in the files is the model's own."""

import json
from itertools import combinations, product

import meshio
import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from reports.verification.modes.mesh_files import WRITERS
from tests.casingfem.export.played import steps_of
from tests.casingfem.study.study_texts import PLATE, THICK, written

pyuff = pytest.importorskip("pyuff")
WAVY = '[[imperfection]]\nof = "thickness"\nharmonics = [{p = 0, cos = 0.1}, {p = 2, cos = 0.3}]\n'


def run(*arguments):
    return CliRunner().invoke(main, ["modes", *map(str, arguments)])


@pytest.fixture(scope="module")
def casing(tmp_path_factory):
    """A casing whose wall varies from 12 to 28 mm, and the folder of its files."""
    folder = tmp_path_factory.mktemp("shapes")
    file = written(folder, THICK.replace("[support.base]", f"{WAVY}[support.base]"))
    done = run(file, "--vtu", "--uff", "--out", folder / "out")
    assert done.exit_code == 0, done.output
    return cf.modes(cf.load_study(file).structure, 6), folder / "out"


def surface(found):
    """Points of the nodes and unit normals outwards, (nodes, 3)."""
    at = found.shell.geometry(*found.grid.nodes).surface
    normal = np.cross(np.real(at.x1), np.real(at.x2), axis=0).T
    points = np.real(at.x).T
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    outward = np.sign(np.sum(normal[:, :2] * points[:, :2], axis=1))
    return points, normal * outward[:, None]


@pytest.mark.slow
def test_a_reader_of_vtu_finds_the_shape_as_computed(casing):
    found, out = casing
    points, normals = surface(found)
    for k in (0, 2):
        mesh = meshio.read(out / "vtu" / f"mode_{k + 1:03d}.vtu")
        data = mesh.point_data
        np.testing.assert_allclose(mesh.points, points, atol=1e-12)
        np.testing.assert_allclose(data["displacement"], found.fields[:, :3, k], atol=1e-9 * np.abs(found.fields).max())
        inward = np.einsum("ni,ni->n", normals, data["displacement"])
        np.testing.assert_allclose(data["normal_displacement"], inward, atol=1e-9 * np.abs(inward).max())
        assert (data["thickness"].min(), data["thickness"].max()) == pytest.approx((16e-3, 28e-3), rel=1e-2)
        assert mesh.field_data["freq_hz"] == pytest.approx([found.freq[k]], rel=1e-9)


@pytest.mark.slow
def test_the_cells_cover_the_surface_once_and_face_outward(casing):
    found, out = casing
    mesh = meshio.read(out / "vtu" / "mode_001.vtu")
    (cells,) = (block.data for block in mesh.cells)
    corners = mesh.points[cells]
    areas = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    slant = np.pi * (0.50 + 0.45) * np.hypot(0.05, 0.25)  # of the cone, which 4 mm of imperfection hardly lengthen
    assert np.linalg.norm(areas, axis=1).sum() == pytest.approx(slant, rel=5e-3)
    assert np.all(np.einsum("ci,ci->c", areas, surface(found)[1][cells[:, 0]]) > 0.0)
    assert np.array_equal(np.unique(cells), np.arange(len(mesh.points)))


@pytest.mark.slow
def test_the_series_swings_once_by_a_cosine(casing):
    found, out = casing
    still = surface(found)[0]
    for mode in (0, 2):
        steps = steps_of(out / "vtu" / f"mode_{mode + 1:03d}.vtkhdf")
        count, shape = len(steps), found.fields[:, :3, mode]
        reach = np.linalg.norm(steps[0].points - still, axis=1).max()
        assert 0.02 < reach / np.linalg.norm(np.ptp(still, axis=0)) < 0.2
        unit = shape / np.linalg.norm(shape, axis=1).max()
        for k, step in enumerate(steps):
            swing = np.cos(2.0 * np.pi * k / count)
            assert step.time == k / count
            np.testing.assert_allclose(step.points - still, reach * swing * unit, atol=2e-6)
            given = step.point_data["displacement"]
            np.testing.assert_allclose(given, swing * shape, atol=1e-6 * np.abs(shape).max())
            assert step.field_data["freq_hz"] == pytest.approx(found.freq[mode], rel=1e-9)
            assert step.field_data["nodal_diameters"] == found.nodal_diameters[mode]


@pytest.mark.slow
def test_two_readers_of_universal_files_find_the_modes(casing):
    found, out = casing
    own, sets = cf.uff.read_uff(out / "modes.uff", strict=True), pyuff.UFF(str(out / "modes.uff")).read_sets()
    others = [one for one in sets if one["type"] == 55]
    np.testing.assert_allclose(own.nodes.points, surface(found)[0], atol=1e-5)
    assert own.header[:2] == ("casingfem", "modes of a shell")
    assert len(own.shapes) == len(others) == 6
    for k, (shape, other) in enumerate(zip(own.shapes, others, strict=True)):
        field = found.fields[:, :3, k]
        assert shape.freq_hz == other["freq"] == pytest.approx(found.freq[k], rel=1e-5)
        assert shape.values == pytest.approx(field, rel=1e-5, abs=1e-30)
        assert np.asarray(other["r2"]) == pytest.approx(field[:, 1], rel=1e-5, abs=1e-30)
        assert shape.text[:2] == (f"mode {k + 1}", f"n = {found.nodal_diameters[k]}, m = {found.meridional[k]}")
        assert (shape.integers, shape.reals[1:]) == ((1, k + 1), (1.0, 0.0, 0.0))
        assert (shape.model, shape.analysis, shape.characteristic, shape.quantity) == (1, 2, 2, 8)
    (line,) = own.lines
    sides = np.append(line.nodes, 0).reshape(-1, 3)
    rows, around = 5, 45  # quadrilaterals along the meridian and around, each side drawn once
    assert len(np.unique(np.sort(sides[:, :2], axis=1), axis=0)) == len(sides) == rows * around + (rows + 1) * around


BLOCK = '[material]\nE = 2e11\nnu = 0.3\nrho = 7800.0\n[TABLE]\nmesh = "FILE"\n[support.root]\nkind = "clamped"\n'


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "along"), [("hexahedron20", (3, 2, 2)), ("tetra10", (2, 1, 1)), ("quad8", (3, 2, 0))])
def test_files_of_an_imported_part_have_its_cells_and_the_edges_of_its_outside_once(kind, along, tmp_path):
    """Unit cells: drawn are neighbours on the lattice of corners that lie on one face (of tetrahedra, all edges)."""
    cells = along[: 3 if along[2] else 2]
    mesh = cf.imported.grid_mesh(
        kind, cells, lambda u: np.pad(u * cells, ((0, 0), (0, 3 - len(cells)))), groups={"root": (0, 0.0)}
    )
    file, write = WRITERS["Gmsh 2.2, text"]
    write(mesh, tmp_path / file)
    text = BLOCK.replace("FILE", file).replace("TABLE", "solid" if along[2] else "shell")
    text = text.replace("[support", "thickness = 0.1\n[support") if not along[2] else text
    path = written(tmp_path, f"{text}[modes]\ncount = 2\n")
    assert run(path, "--vtu", "--uff", "--out", tmp_path / "out").exit_code == 0
    read = meshio.read(tmp_path / "out" / "vtu" / "mode_002.vtu")
    ((name, given),) = read.cells_dict.items()
    assert name == {"quad8": "quad9"}.get(kind, kind)  # a middle node is added to quadrilaterals of shells
    for ours, theirs in zip(mesh.cells, given, strict=True):
        np.testing.assert_allclose(read.points[theirs[: len(ours)]], mesh.points[ours], atol=1e-12)
    found = cf.uff.read_uff(tmp_path / "out" / "modes.uff")
    assert found.header[:2] == ("casingfem", "modes of an imported part")
    if kind == "tetra10":
        return
    (line,) = found.lines
    place = dict(zip(found.nodes.labels.tolist(), map(tuple, found.nodes.points.round(6)), strict=True))
    ends = [frozenset((place[a], place[b])) for a, b in np.append(line.nodes, 0).reshape(-1, 3)[:, :2].tolist()]
    corners = list(product(*(range(count + 1) for count in along)))
    expected = {
        frozenset((a, b))
        for a, b in combinations(corners, 2)
        if np.abs(np.subtract(a, b)).sum() == 1
        and any(x == y and x in (0, most) for x, y, most in zip(a, b, along, strict=True))
    }
    assert set(ends) == expected
    assert len(ends) == len(expected)


def test_the_command_writes_the_chosen_modes_beside_the_table(tmp_path):
    file, out = written(tmp_path, PLATE), ["--out", tmp_path / "out"]
    result = run(file, *out, "--vtu", "--uff", "--modes", "1,3")
    assert result.exit_code == 0, result.stderr
    assert f"wrote 4 files to {tmp_path / 'out' / 'vtu'}" in result.stdout
    names = sorted(path.name for path in (tmp_path / "out" / "vtu").iterdir())
    assert names == ["mode_001.vtkhdf", "mode_001.vtu", "mode_003.vtkhdf", "mode_003.vtu"]
    assert [shape.integers[1] for shape in cf.uff.read_uff(tmp_path / "out" / "modes.uff").shapes] == [1, 3]
    found = json.loads((tmp_path / "out" / "modes.json").read_text())["modes"]
    for mode in (1, 3):
        mesh = meshio.read(tmp_path / "out" / "vtu" / f"mode_00{mode}.vtu")
        assert mesh.field_data["freq_hz"][0] == found[mode - 1]["freq_hz"]
    for arguments, words in (
        ([*out, "--vtu", "--modes", "1,4"], "from 1 to 3"),
        ([*out, "--vtu", "--modes", "0"], "such as 1,2,5"),
        ([*out, "--modes", "1"], "--modes found without"),
        (["--vtu"], "found without --out"),
        (["--uff"], "found without --out"),
    ):
        refused = run(file, *arguments)
        assert refused.exit_code == 2
        assert words in refused.stderr
