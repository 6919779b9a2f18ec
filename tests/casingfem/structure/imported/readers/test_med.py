"""MED files: written by meshio, and by hand as Salome writes them."""

import h5py
import meshio
import numpy as np
import pytest

import casingfem as cf

MIRRORED = {  # the same solids seen in a mirror: hexahedra with their layers exchanged, tetrahedra with two corners
    "hexahedron": [4, 5, 6, 7, 0, 1, 2, 3],
    "hexahedron20": [4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19],
    "tetra": [0, 2, 1, 3],
    "tetra10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
}
LOWER = {"quad9": "line3", "hexahedron": "quad", "hexahedron20": "quad8", "tetra10": "triangle6"}


def grid(kind):
    dim = 2 if kind.startswith("quad") else 3
    sides = np.array([0.4, 0.2, 0.1])[:dim]
    return cf.imported.grid_mesh(
        kind, (2, 1, 1)[:dim], lambda u: np.pad(u * sides, ((0, 0), (0, 3 - dim))), groups={"root": (0, 0.0)}
    )


def written(folder, mesh, cells):
    """The mesh by meshio: nodes of the root in a group, the first cell in two groups."""
    families = np.zeros(len(cells), dtype=int)
    families[0] = -7
    tags = np.zeros(len(mesh.points), dtype=int)
    tags[mesh.groups["root"].nodes] = 2
    made = meshio.Mesh(
        mesh.points, [(mesh.kind, cells)], point_data={"point_tags": tags}, cell_data={"cell_tags": [families]}
    )
    made.point_tags, made.cell_tags = {2: ["root"]}, {-7: ["first", "tip"]}
    file = folder / "part.med"
    made.write(file)
    return file


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("kind", ["quad", "hexahedron", "hexahedron20", "tetra", "tetra10"])
def test_cells_nodes_and_groups_are_those_that_were_written(kind, mirrored, tmp_path):
    """Salome's solids have the other orientation; its shells the same."""
    mesh = grid(kind)
    cells = mesh.cells[:, MIRRORED[kind]] if mirrored and kind in MIRRORED else mesh.cells
    found = cf.read_mesh(written(tmp_path, mesh, cells))
    assert found.kind == kind
    np.testing.assert_array_equal(found.cells, mesh.cells)
    np.testing.assert_allclose(found.points, mesh.points, rtol=1e-15)
    assert set(found.groups) == {"root", "first", "tip"}
    assert found.groups["root"].nodes.tolist() == sorted(mesh.groups["root"].nodes.tolist())
    assert found.groups["first"].cells.tolist() == found.groups["tip"].cells.tolist() == [0]


def test_a_unit_family_without_groups_and_numbers_of_the_file_are_read(tmp_path):
    """Gmsh writes families without groups; Salome writes numbers and a unit."""
    file = written(tmp_path, grid("hexahedron"), grid("hexahedron").cells)
    with h5py.File(file, "r+") as stream:
        mesh = stream["ENS_MAA"]["mesh"]
        mesh.attrs["UNI"] = np.bytes_("mm".ljust(16))
        (step,) = mesh.values()
        step["NOE"]["NUM"] = np.arange(12) + 100
        family = stream["FAS"]["mesh"]["ELEME"].create_group("F_3D_1")
        family.attrs["NUM"] = -9
    found = cf.read_mesh(file)
    assert found.points.max() == pytest.approx(0.4e-3)
    assert found.node_numbers.tolist() == list(range(100, 112))
    with pytest.raises(cf.errors.ModelError, match=r"states its unit of length, 0\.001 m; expected neither"):
        cf.read_mesh(file, scale=1e-3)


@pytest.mark.parametrize(("unit", "metre"), [("m", 1.0), ("cm", 0.01), ("in", 0.0254), ("furlong", 1.0)])
def test_points_are_in_the_unit_that_the_file_states(unit, metre, tmp_path):
    mesh = grid("tetra")
    file = written(tmp_path, mesh, mesh.cells)
    with h5py.File(file, "r+") as stream:
        stream["ENS_MAA"]["mesh"].attrs["UNI"] = np.bytes_(unit.ljust(16))
    np.testing.assert_allclose(cf.read_mesh(file).points, metre * mesh.points, rtol=1e-15)


def damaged(stream):
    (step,) = stream["ENS_MAA"]["mesh"].values()
    step["MAI"]["HE8"]["NOD"][0] = 4711


def two_meshes(stream):
    stream["ENS_MAA"].create_group("other")


def no_mesh(stream):
    del stream["ENS_MAA"]


def two_steps(stream):
    stream["ENS_MAA"]["mesh"].create_group("another")


def no_cells(stream):
    (step,) = stream["ENS_MAA"]["mesh"].values()
    del step["MAI"]["HE8"]


def no_table_of_cells(stream):
    (step,) = stream["ENS_MAA"]["mesh"].values()
    del step["MAI"]


def unknown_kind(stream):
    (step,) = stream["ENS_MAA"]["mesh"].values()
    step["MAI"].move("HE8", "POE")


@pytest.mark.parametrize(
    ("change", "fault"),
    [(damaged, "a cell of kind HE8 with a node that"), (two_meshes, "found 2 meshes, expected one"),
     (unknown_kind, "found 2 cells of kind POE"), (no_mesh, "found 0 meshes, expected one"),
     (two_steps, r"found 2 steps of mesh 'mesh', expected one, with nodes \(NOE\) and cells \(MAI\)"),
     (no_table_of_cells, "found 1 steps of mesh 'mesh', expected one, with nodes"),
     (no_cells, "found 12 nodes and no cells")],
)  # fmt: skip
def test_files_that_cannot_be_read_are_named(change, fault, tmp_path):
    file = written(tmp_path, grid("hexahedron"), grid("hexahedron").cells)
    with h5py.File(file, "r+") as stream:
        change(stream)
    with pytest.raises(cf.errors.ModelError, match=rf"part\.med: .*{fault}"):
        cf.read_mesh(file)


def test_a_file_cut_short_is_refused(tmp_path):
    file = written(tmp_path, grid("tetra"), grid("tetra").cells)
    file.write_bytes(file.read_bytes()[:3000])
    with pytest.raises(cf.errors.ModelError, match="no readable MED file"):
        cf.read_mesh(file)
