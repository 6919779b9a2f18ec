"""Modes for test software: what two readers find in the file is the model's own."""

from itertools import combinations, product
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from casingfem.export.meshes import drawn_surface
from casingfem.export.modes_uff import one_shape, write_modes_uff
from tests.casingfem.structure.imported.parts import STEEL, supported
from tests.casingfem.study.study_texts import PLATE, written

pyuff = pytest.importorskip("pyuff")


@pytest.fixture(scope="module")
def casing(frustum, coarse) -> cf.Modes:
    return cf.modes(frustum(mesh=coarse, radius_defect=cf.FourierField.of({8: 0.002})), 4)


@pytest.fixture(scope="module")
def path(casing, tmp_path_factory):
    return write_modes_uff(casing, tmp_path_factory.mktemp("uff") / "modes.uff", nodes_set="2411")


@pytest.mark.slow
def test_the_file_holds_the_modes(casing, path):
    found = cf.uff.read_uff(path, strict=True)
    assert np.array_equal(found.nodes.points, drawn_surface(casing).points)
    assert [shape.freq_hz for shape in found.shapes] == pytest.approx(casing.freq, rel=1e-5)
    for k, shape in enumerate(found.shapes):
        assert shape.values == pytest.approx(casing.fields[:, :3, k], rel=1e-5, abs=1e-30)
        assert shape.text[1] == f"n = {casing.nodal_diameters[k]}, m = 1"


def test_each_mode_is_told_by_its_own_numbers():
    """Of three modes and three nodes among five, all numbers different; a mode without n has no label."""
    fields = np.arange(90.0).reshape(5, 6, 3)
    modes = SimpleNamespace(nodal_diameters=[4, -1, 0], meridional=[2, 0, 3], freq=[10.0, 20.0, 30.0], fields=fields)
    surface = SimpleNamespace(rows=np.array([4, 0, 2]), labels=np.array([11, 12, 13]))
    shapes = [one_shape(modes, k, surface) for k in range(3)]
    assert [shape.text[:2] for shape in shapes] == [
        ("mode 1", "n = 4, m = 2"), ("mode 2", "NONE"), ("mode 3", "n = 0, m = 3")
    ]  # fmt: skip
    for k, shape in enumerate(shapes):
        assert shape.integers == (1, k + 1)
        assert shape.reals == (10.0 * (k + 1), 1.0, 0.0, 0.0)
        # a structure's normal mode, three translations a node, displacements
        assert (shape.model, shape.analysis, shape.characteristic, shape.quantity) == (1, 2, 2, 8)
        assert shape.nodes.tolist() == [11, 12, 13]
        assert shape.values.tolist() == [[18.0 * row + 3.0 * i + k for i in range(3)] for row in (4, 0, 2)]


def test_the_header_says_what_the_modes_are_of(path, tmp_path):
    part = supported(cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u, groups={"root": (0, 0.0)}))
    imported = write_modes_uff(cf.modes(part, 1), tmp_path / "part.uff")
    assert cf.uff.read_uff(path).header[:2] == ("casingfem", "modes of a shell")
    assert cf.uff.read_uff(imported).header[:2] == ("casingfem", "modes of an imported part")


def test_every_side_is_drawn_once(casing, path):
    (line,) = cf.uff.read_uff(path).lines
    sides = np.append(line.nodes, 0).reshape(-1, 3)
    assert np.all(sides[:, 2] == 0)
    assert len(np.unique(sides[:, :2], axis=0)) == len(sides)
    rows, around = 6, 54  # quadrilaterals along the meridian and around
    assert len(sides) == rows * around + (rows + 1) * around
    points = drawn_surface(casing).points
    assert np.linalg.norm(points[sides[:, 0] - 1] - points[sides[:, 1] - 1], axis=1).max() < 0.1


@pytest.mark.parametrize(("kind", "along"), [("hexahedron20", (3, 2, 2)), ("quad8", (3, 2, 0))])
def test_of_an_imported_part_the_edges_of_its_outside_are_drawn_once(kind, along, tmp_path):
    """A block or a plate of unit cells: neighbours on its lattice of corners that lie on one face."""
    cells = along[: 3 if along[2] else 2]
    mesh = cf.imported.grid_mesh(
        kind, cells, lambda u: np.pad(u * cells, ((0, 0), (0, 3 - len(cells)))), groups={"root": (0, 0.0)}
    )
    held = {"root": cf.Clamped()}
    part = supported(mesh) if along[2] else cf.MeshShell(mesh=mesh, thickness=0.1, material=STEEL, supports=held)
    found = cf.uff.read_uff(write_modes_uff(cf.modes(part, 1), tmp_path / "part.uff"))
    (line,) = found.lines
    place = dict(zip(found.nodes.labels.tolist(), map(tuple, found.nodes.points.round(6)), strict=True))
    ends = [(place[a], place[b]) for a, b in np.append(line.nodes, 0).reshape(-1, 3)[:, :2].tolist()]
    corners = list(product(*(range(count + 1) for count in along)))
    expected = {
        frozenset((a, b))
        for a, b in combinations(corners, 2)
        if np.abs(np.subtract(a, b)).sum() == 1
        and any(x == y and x in (0, most) for x, y, most in zip(a, b, along, strict=True))
    }
    assert set(map(frozenset, ends)) == expected
    assert len(ends) == len(expected)


def test_another_reader_finds_the_same_modes(casing, path):
    sets = pyuff.UFF(str(path)).read_sets()
    shapes = [one for one in sets if one["type"] == 55]
    assert len(shapes) == 4
    assert np.asarray(shapes[2]["r2"]) == pytest.approx(casing.fields[:, 1, 2], rel=1e-5, abs=1e-30)
    assert shapes[2]["freq"] == pytest.approx(casing.freq[2], rel=1e-5)


def test_modes_that_are_not_there_are_refused(casing, tmp_path):
    with pytest.raises(ValueError, match="mode 5 is not among the 4"):
        write_modes_uff(casing, tmp_path / "f.uff", [4])


def test_the_command_writes_the_chosen_modes(tmp_path):
    base = ["modes", str(written(tmp_path, PLATE))]
    result = CliRunner().invoke(main, [*base, "--out", str(tmp_path / "out"), "--uff", "--modes", "1,3"])
    assert result.exit_code == 0, result.stderr
    shapes = cf.uff.read_uff(tmp_path / "out" / "modes.uff").shapes
    assert [shape.integers[1] for shape in shapes] == [1, 3]
    assert not (tmp_path / "out" / "vtu").exists()
    refused = CliRunner().invoke(main, [*base, "--uff"])
    assert refused.exit_code == 2
    assert "needs --out" in refused.stderr
