"""Shells of triangles with middle nodes: frequencies of plates and of a curved panel beside those of squares."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.parts import STEEL
from tests.casingfem.structure.imported.readers.test_unv import elements, group, nodes

HALVES = ((0, 1, 2, 4, 5, 8), (0, 2, 3, 8, 6, 7))  # corners and middles of the two triangles in a square of nine nodes
PLACES = {
    "plate": lambda u: np.pad(u * [0.4, 0.3], ((0, 0), (0, 1))),
    "skewed plate": lambda u: np.pad(u * [0.4, 0.3] + 0.15 * u[:, ::-1] * [1.0, 0.0], ((0, 0), (0, 1))),
    "panel": lambda u: np.column_stack([0.4 * u[:, 0], 0.5 * np.sin(0.6 * u[:, 1]), 0.5 * np.cos(0.6 * u[:, 1])]),
}


def cut(squares, folder):
    """The same nodes with every square cut in two triangles, through a universal file."""
    cells = [
        [int(cell[k]) + 1 for k in (a, ab, b, bc, c, ca)] for cell in squares.cells for a, b, c, ab, bc, ca in HALVES
    ]
    root = [int(node) + 1 for node in squares.groups["root"].nodes]
    (folder / "part.unv").write_text(nodes(squares.points) + elements(92, cells) + group("root", root, 7))
    return cf.read_mesh(folder / "part.unv")


def frequencies(mesh):
    return cf.modes(cf.MeshShell(mesh=mesh, thickness=0.01, material=STEEL, supports={"root": cf.Clamped()}), 6).freq


@pytest.mark.slow
@pytest.mark.parametrize("name", PLACES)
def test_triangles_have_the_frequencies_of_squares_and_converge_to_them(name, tmp_path, held):
    """Bending, torsion, motion in the plane: at most 4 % apart with five squares a side, half of what three leave."""
    found = {}
    for count in (3, 5):
        squares = cf.imported.grid_mesh("quad9", (count, count), PLACES[name], groups={"root": (0, 0.0)})
        found[count] = np.array([frequencies(mesh) for mesh in (squares, cut(squares, tmp_path))])
    exact = found[5][0]
    apart = {count: np.abs(both[1] / exact - 1.0) for count, both in found.items()}
    assert apart[5].max() < 0.04
    assert np.linalg.norm(apart[5]) < 0.5 * np.linalg.norm(apart[3])
    held(1e-6, **{f"{count}": both for count, both in found.items()})
