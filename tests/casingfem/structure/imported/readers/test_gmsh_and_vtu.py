"""Gmsh's and VTK's files, written out: groups of each kind, numbers, what is cut short."""

import re

import numpy as np
import pytest

import casingfem as cf

CORNERS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
MSH_41 = f"""$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
3
2 1 "floor"
3 2 "body"
3 5 "hot"
$EndPhysicalNames
$Entities
0 0 1 1
1 -1 -1 -1 1 1 1 1 1 0
1 -1 -1 -1 1 1 1 2 2 5 0
$EndEntities
$Nodes
1 4 1 4
3 1 0 4
1
2
3
4
{CORNERS}$EndNodes
$Elements
2 2 1 2
2 1 2 1
1 1 2 3
3 1 4 1
2 1 2 3 4
$EndElements
"""
MSH_22 = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 2 "body"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 2 2 2.5
$EndNodes
$Elements
7
1 15 2 3 1 2
2 1 2 4 1 1 2
3 2 2 6 1 1 2 3
4 2 2 0 1 2 3 4
5 4 2 2 1 1 2 3 4
6 4 2 9 1 2 3 4 5
7 4 2 -9 1 1 2 3 5
$EndElements
"""
VTU = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="5" NumberOfCells="3">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 0 1 0 0 0 1 2 2 2.5</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3 1 2 3 4 0 1 2</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4 8 11</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10 10 5</DataArray></Cells>
<PointData><DataArray type="Int32" Name="pin" format="ascii">0 1 0 0 1</DataArray>
<DataArray type="Int32" Name="level" format="ascii">0 1 2 0 1</DataArray></PointData>
<CellData><DataArray type="Int32" Name="hot" format="ascii">0 1 1</DataArray>
<DataArray type="Int32" Name="part" format="ascii">0 3 1</DataArray></CellData>
</Piece></UnstructuredGrid></VTKFile>
"""


def read(text, path):
    path.write_text(text)
    return cf.read_mesh(path)


def told(mesh):
    """Cells, facets by their nodes, and nodes of each group."""
    return {
        name: (
            group.cells.tolist(),
            [] if group.facets is None else [sorted(mesh.facets[tuple(f)].tolist()) for f in group.facets],
            group.nodes.tolist(),
        )
        for name, group in mesh.groups.items()
    }


def test_an_entity_of_format_41_is_in_each_of_its_groups(tmp_path):
    mesh = read(MSH_41, tmp_path / "a.msh")
    assert (mesh.kind, mesh.cells.tolist(), mesh.cell_numbers.tolist()) == ("tetra", [[0, 1, 2, 3]], [2])
    assert told(mesh) == {
        "floor": ([], [[0, 1, 2]], [0, 1, 2]), "body": ([0], [], [0, 1, 2, 3]), "hot": ([0], [], [0, 1, 2, 3]),
    }  # fmt: skip
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert mesh.node_numbers.tolist() == [1, 2, 3, 4]


def test_groups_without_a_name_are_called_by_what_they_are_made_of(tmp_path):
    """Format 2.2: number 0 is no group, a negative one is a cell turned round."""
    mesh = read(MSH_22, tmp_path / "a.msh")
    assert (mesh.kind, mesh.cell_numbers.tolist()) == ("tetra", [5, 6, 7])
    assert mesh.cells.tolist() == [[0, 1, 2, 3], [1, 2, 3, 4], [0, 1, 2, 4]]
    assert told(mesh) == {
        "point 3": ([], [], [1]), "curve 4": ([], [], [0, 1]), "surface 6": ([], [[0, 1, 2]], [0, 1, 2]),
        "body": ([0], [], [0, 1, 2, 3]), "volume 9": ([1, 2], [], [0, 1, 2, 3, 4]),
    }  # fmt: skip
    assert mesh.points[4].tolist() == [2.0, 2.0, 2.5]


@pytest.mark.parametrize(("mark", "section"), [
    ("$Nodes", "Nodes"), ("$EndNodes", "Nodes"), ("$Elements", "Elements"), ("$EndElements", "Elements"),
])  # fmt: skip
def test_sections_are_there_and_closed(mark, section, tmp_path):
    with pytest.raises(
        cf.errors.ModelError, match=rf"a\.msh: found no complete section \${section}: cut short\?.*mesh-file"
    ):
        read(MSH_22.replace(mark, "$Other"), tmp_path / "a.msh")


def test_arrays_of_0_and_1_are_groups_of_a_grid_and_it_counts_from_0(tmp_path):
    mesh = read(VTU, tmp_path / "a.vtu")
    assert (mesh.cells.tolist(), mesh.cell_numbers.tolist()) == ([[0, 1, 2, 3], [1, 2, 3, 4]], [0, 1])
    assert told(mesh) == {"hot": ([1], [[0, 1, 2]], [0, 1, 2, 3, 4]), "pin": ([], [], [1, 4])}
    assert mesh.node_numbers.tolist() == [0, 1, 2, 3, 4]
    np.testing.assert_array_equal(mesh.points, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 2, 2.5]])
    with pytest.raises(cf.errors.ModelError, match=r"a\.vtu: cannot be read"):
        read(VTU.replace('NumberOfPoints="5"', 'NumberOfPoints="6"'), tmp_path / "a.vtu")


@pytest.mark.parametrize(("given", "size", "nodes"), [
    ({}, 1.0, 8), ({"scale": 1e-3}, 1e-3, 8), ({"units": "mm-t-s"}, 1e-3, 8), ({"scale": 1e-3, "join": 1e-6}, 1e-3, 5),
    ({"join": 1e-6}, 1.0, 5), ({"join": 0.0}, 1.0, 8),
])  # fmt: skip
def test_metres_and_nodes_apart_are_what_is_taken_if_nothing_else_is_reported(given, size, nodes, tmp_path):
    """Two tetrahedra with a facet at one place, each with nodes of its own; lengths are scaled before."""
    text = VTU.replace("0 0 0 1 0 0 0 1 0 0 0 1 2 2 2.5", "0 0 0 2 0 0 0 2 0 0 0 2 2 2 2.5 2 0 0 0 2 0 0 0 2")
    text = text.replace('NumberOfPoints="5"', 'NumberOfPoints="8"').replace("1 2 3 4 0 1 2", "5 6 7 4 0 1 2")
    path = tmp_path / "A.VTU"
    path.write_text(re.sub("<PointData>.*</PointData>", "", text, flags=re.DOTALL))
    mesh = cf.read_mesh(path, **given)
    assert len(mesh.used) == nodes
    np.testing.assert_allclose(np.ptp(mesh.points[mesh.used], axis=0), size * np.array([2.0, 2.0, 2.5]), rtol=1e-14)
    assert mesh.source == "A.VTU"
