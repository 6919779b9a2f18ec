"""Broken meshes: each is refused or doubted, the cell or node named; none gives a plausible frequency silently."""

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
SOUND = cf.imported.grid_mesh("hexahedron20", (4, 2, 1), lambda u: u * [0.2, 0.1, 0.03], groups={"root": (0, 0.0)})


def changed(mesh=SOUND, *, points=None, cells=None, groups=None, kind=None):
    """The mesh with a part replaced; cells are numbered from 101."""
    cells = mesh.cells if cells is None else cells
    return cf.imported.MeshData(
        kind=kind or mesh.kind,
        points=mesh.points if points is None else points,
        cells=cells,
        groups=mesh.groups if groups is None else groups,
        cell_numbers=np.arange(101, 101 + len(cells)),
        source="part.msh",
    )


def edited(array, place, value):
    copy = array.copy()
    copy[place] = value
    return copy


def swapped(row, *pairs, mesh=SOUND):
    """The cells with nodes of one of them exchanged."""
    cells = mesh.cells.copy()
    for a, b in pairs:
        cells[row, [a, b]] = cells[row, [b, a]]
    return cells


def torn():
    """Two halves with nodes of their own at the seam, at the same place."""
    right = np.arange(4, 8)
    nodes = np.unique(SOUND.cells[right])
    copies = np.full(len(SOUND.points), -1)
    copies[nodes] = len(SOUND.points) + np.arange(len(nodes))
    cells = SOUND.cells.copy()
    cells[right] = copies[cells[right]]
    points = np.vstack([SOUND.points, SOUND.points[nodes]])
    used, flat = np.unique(cells, return_inverse=True)
    return points[used], flat.reshape(cells.shape)


def two_parts():
    points = np.vstack([SOUND.points, SOUND.points + np.array([1.0, 0, 0])])
    return {"points": points, "cells": np.vstack([SOUND.cells, SOUND.cells + len(SOUND.points)])}


def hanging():
    """A corner of two small bricks in the middle of a long edge of a large one."""
    big = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: u * [0.1, 0.1, 0.1])
    small = cf.imported.grid_mesh("hexahedron20", (1, 2, 1), lambda u: u * [0.1, 0.1, 0.1] + [0.1, 0, 0])
    points = np.round(np.vstack([big.points, small.points]), 12)
    unique, place = np.unique(points, axis=0, return_inverse=True)
    cells = np.vstack([big.cells, small.cells + len(big.points)])
    return {"points": unique, "cells": place.ravel()[cells], "groups": {}}


NASTRAN_ORDER = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]
REFUSED = {
    "nan": ({"points": edited(SOUND.points, (7, 1), np.nan)}, "1 node (8) without finite coordinates", "not-finite"),
    "infinite": ({"points": edited(SOUND.points, (7, 2), np.inf)}, "1 node (8) without", "not-finite"),
    "inside out": ({"cells": swapped(3, *zip(range(4), range(4, 8), strict=True), *zip(range(8, 12), range(12, 16),
                   strict=True))}, "1 cell (104) with", "inverted-cell"),
    "mirrored": ({"points": SOUND.points * [-1, 1, 1]}, "8 cells (101, 102, 103, 104, 105, ...) with", "inverted"),
    "corners scrambled": ({"cells": swapped(2, (0, 1))}, "1 cell (103) folded", "scrambled-cell"),
    "middles scrambled": ({"cells": swapped(2, (8, 9))}, "1 cell (103) folded", "scrambled-cell"),
    "another format's order": ({"cells": SOUND.cells[:, NASTRAN_ORDER]}, "8 cells (101, 102", "scrambled-cell"),
    "flat": ({"points": SOUND.points * [1, 1, 0]}, "8 cells", "flat-cell|open-seam"),
    "collapsed": ({"cells": edited(SOUND.cells, (5, 1), SOUND.cells[5, 0])}, "1 cell (106) that contain a node twice",
                  "collapsed-cell"),
    "seam": (dict(zip(("points", "cells"), torn(), strict=True)) | {"groups": {}}, "coincide with another node",
             "open-seam"),
    "parts": (two_parts(), "2 parts that do not touch, of 8, 8 cells; not in the largest: 8 cells (109", "mesh-parts"),
    "twice": ({"cells": np.vstack([SOUND.cells, SOUND.cells[1:2]])}, "1 cell (109) with the same nodes as another",
              "overlap"),
    "hanging": (hanging(), "use a corner of another cell as a middle node", "hanging-node"),
    "node moved away": ({"points": edited(SOUND.points, (20, 0), 5.0)}, "folded", "scrambled-cell"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused_with_cell_and_remedy(name):
    parts, found, code = REFUSED[name]
    with pytest.raises(cf.errors.ModelError, match=code) as caught:
        cf.Solid(mesh=changed(**parts), material=STEEL)
    assert found in str(caught.value)
    assert "part.msh: " in str(caught.value)


def test_a_slit_of_a_micrometre_is_seen():
    points, cells = torn()
    right = np.unique(cells[4:])
    points = edited(points, (right, 0), points[right, 0] + 1e-6)
    with pytest.raises(cf.errors.ModelError, match="mesh-open-seam"):
        cf.Solid(mesh=changed(points=points, cells=cells, groups={}), material=STEEL)


def test_all_faults_are_reported_at_once():
    parts = two_parts()
    parts["cells"][2, [0, 1]] = parts["cells"][2, [1, 0]]
    with pytest.raises(cf.errors.ModelError) as caught:
        cf.Solid(mesh=changed(**parts), material=STEEL)
    assert "[mesh-scrambled-cell]" in str(caught.value)
    assert "[mesh-parts]" in str(caught.value)
    assert caught.value.code == "mesh-parts"


def test_orphan_nodes_are_doubted_and_left_out():
    mesh = changed(points=np.vstack([SOUND.points, [[9.0, 9.0, 9.0]]]))
    with pytest.warns(cf.errors.ModelWarning, match=r"1 node \(\d+\) without a cell.*mesh-orphan-nodes"):
        solid = cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()})
    whole = cf.Solid(mesh=SOUND, material=STEEL, supports={"root": cf.Clamped()})
    np.testing.assert_array_equal(cf.modes(solid, 3).freq, cf.modes(whole, 3).freq)


def test_needles_are_doubted():
    needle = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: u * [1.0, 1.0, 0.005])
    with pytest.warns(cf.errors.ModelWarning, match="longest to shortest edge up to 200"):
        cf.Solid(mesh=needle, material=STEEL)


def test_nearly_folded_cells_are_doubted():
    """A corner pushed almost onto the one below: the local volume there is a sixtieth of the largest."""
    points, cell = SOUND.points.copy(), SOUND.cells[7]
    points[cell[6], 2] = 0.0005
    for middle, ends in ((13, [5, 6]), (14, [6, 7]), (18, [2, 6])):
        points[cell[middle]] = points[cell[ends]].mean(axis=0)
    with (
        pytest.warns(cf.errors.ModelWarning, match="mesh-aspect"),
        pytest.warns(cf.errors.ModelWarning, match=r"\(108\) nearly folded"),
    ):
        cf.Solid(mesh=changed(points=points), material=STEEL)


def test_millimetres_resemble_a_very_large_part():
    with pytest.warns(cf.errors.ModelWarning, match=r"225\.\d m across.*scale = 1e-3.*mesh-units"):
        cf.Solid(mesh=changed(points=1e3 * SOUND.points), material=STEEL)


@pytest.mark.parametrize("changes", [{"E": 210e3}, {"rho": 7.8e-9}])
def test_materials_in_other_units_are_doubted(changes):
    material = cf.Material(**({"E": 210e9, "nu": 0.3, "rho": 7800.0} | changes))
    with pytest.warns(cf.errors.ModelWarning, match="material-units"):
        cf.Solid(mesh=SOUND, material=material)


@pytest.mark.parametrize(("asked", "hint"), [("rott", "did you mean 'root'"), ("flange", "its groups: 'root'")])
def test_groups_that_match_nothing_show_close_ones(asked, hint):
    with pytest.raises(cf.errors.ModelError, match=hint):
        cf.Solid(mesh=SOUND, material=STEEL, supports={asked: cf.Clamped()})


def test_empty_groups_are_refused():
    mesh = changed(groups={"root": cf.imported.Group(nodes=np.zeros(0, dtype=int))})
    with pytest.raises(cf.errors.ModelError, match="mesh-group-empty"):
        cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()})
