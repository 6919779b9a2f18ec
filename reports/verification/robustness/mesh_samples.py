"""Small meshes as each program writes them, with all items that the reader supports: ties, springs, sectors, sets."""

from pathlib import Path

import meshio
import numpy as np

from casingfem.structure.imported.grid import grid_mesh, revolved
from casingfem.structure.imported.mesh.mesh_data import MeshData

CORNERS = ((0.0, 0.0, 0.0), (0.2, 0.0, 0.1), (0.0, 0.2, 0.0), (0.0, 0.0, 0.2))  # of a tetrahedron
# two plates of S6 of nine nodes each, tied along a side; on one a mass, springs, a rigid and a mean connection
TIED_INP = """*HEADING
two plates
*PART, NAME=P
*NODE, NSET=all
1, 0., 0., 0.
2, .1, 0., 0.
3, .2, 0., 0.
4, 0., .1, 0.
5, .1, .1, 0.
6, .2, .1, 0.
7, 0., .2, 0.
8, .1, .2, 0.
9, .2, .2, 0.
*ELEMENT, TYPE=S6, ELSET=plate
1, 1, 3, 9, 2, 6, 5
2, 1, 9, 7, 5, 8, 4
*NSET, NSET=side, GENERATE
3, 9, 3
*NSET, NSET=root
1, 4, 7
*SURFACE, NAME=right, TYPE=NODE
side
*SURFACE, NAME=top
plate, SPOS
*SHELL SECTION, ELSET=plate, MATERIAL=steel
2e-3
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=one, PART=P
*END INSTANCE
*INSTANCE, NAME=two, PART=P
.2, 0., 0.
.2, 0., 0., .2, 1., 0., 0.5
*END INSTANCE
*TIE, NAME=joint, POSITION TOLERANCE=.01, ADJUST=YES
one.right, two.top
*NODE
9001, .1, .1, .05
9002, .3, .3, .05
9003, .3, -.1, .05
*NSET, NSET=middle, INSTANCE=one
5
*NSET, NSET=first, INSTANCE=one
1
*NSET, NSET=second, INSTANCE=one
2
*NSET, NSET=fourth, INSTANCE=one
4
*MPC
BEAM, middle, 9001
*ELEMENT, TYPE=MASS, ELSET=m
901, 9001
*MASS, ELSET=m
.25
*ELEMENT, TYPE=SPRING1, ELSET=s
902, 9001
*SPRING, ELSET=s
3
2e5
*ELEMENT, TYPE=SPRINGA, ELSET=a
903, 9001, 9002
*SPRING, ELSET=a
1e6
*ELEMENT, TYPE=DCOUP3D, ELSET=d
904, 9002
*DISTRIBUTING COUPLING, ELSET=d
two.root, 1.
*KINEMATIC COUPLING, REF NODE=9003
first, 1, 3
*EQUATION
3
second, 2, 1., fourth, 2, -2., 9001, 3, .5
*END ASSEMBLY
"""
# two bricks, one on the other, that share no node
UNTIED_INP = """*NODE
1, 0., 0., 0.
2, .1, 0., 0.
3, .1, .1, 0.
4, 0., .1, 0.
5, 0., 0., .1
6, .1, 0., .1
7, .1, .1, .1
8, 0., .1, .1
11, 0., 0., .1
12, .1, 0., .1
13, .1, .1, .1
14, 0., .1, .1
15, 0., 0., .2
16, .1, 0., .2
17, .1, .1, .2
18, 0., .1, .2
*ELEMENT, TYPE=C3D8, ELSET=below
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=above
2, 11, 12, 13, 14, 15, 16, 17, 18
*SURFACE, NAME=roof
below, S2
*SURFACE, NAME=floor
above, S1
"""
# six- and eight-noded shells, grids in a cylindrical system, one with its own axes, and every kind of attachment
SHELLS_BDF = """SOL 103
BEGIN BULK
$ in three forms of fields
CORD2C  2               0.      0.      0.      0.      0.      1.
        1.      0.      0.
CORD1R,3,1,3,13
GRDSET,,,,,,,6
GRID    1               0.      0.      0.
GRID    2               .1      0.      0.
GRID    3               .2      0.      0.
GRID    4               0.      .1      0.
GRID    5               .1      .1      0.
GRID    6               .2      .1      0.      2
GRID    7               0.      .2      0.
GRID    8               .1      .2      0.
GRID    9               .2      .2      0.
GRID*   10                                      .3              0.
*       0.
GRID,11,,.3,.1,0.
GRID,12,,.3,.2,0.
GRID,13,2,.25,90.,.1
GRID,14,,.25,.1,.1,3
CTRIA6,1,7,1,3,9,2,6,5
CTRIA6,2,7,1,9,7,5,8,4
CQUAD4,3,8,3,10,11,6
CQUAD4,4,8,6,11,12,9
SPC1,3,123,1,4,7
SPC1,4,12,10,THRU,12
SPC,5,2,3,0.
SPCADD,9,3,4
RBE2,901,14,123456,10,11
CONM2,902,14,,1.5,0.,0.,0.,,+
+,2.-3,,3.-3,,,4.-3
CELAS2,903,2.+5,13,3
CELAS1,906,77,13,2,14,2
PELAS,77,1.+6
CBUSH,907,78,13,14,,,,2
PBUSH,78,K,1.+5,2.+5,,1.+3
RBE3,908,,13,123,1.,123,5,6,+
+,9
MPC,5,2,2,1.,4,2,-2.,,+
+,,8,3,.5
PARAM,WTMASS,.5
ENDDATA
"""


def wedge(kind: str, counts: tuple[int, ...]) -> MeshData:
    """A twelfth of a ring."""
    place = revolved((0.5, 0.5), (0.0, 0.1), 0.05)
    shares = [1.0, 1.0 / 12.0, 1.0]
    if kind.startswith("quad"):
        return grid_mesh(kind, counts, lambda u: place(np.insert(u, 0, 0.5, axis=1) * shares), groups={})
    return grid_mesh(kind, counts, lambda u: place(u * shares), groups={})


def inp(mesh: MeshData, element: str, more: str = "*NSET, NSET=root\n1, 2, 3, 4\n") -> str:
    """A mesh as Abaqus writes it, at most 16 numbers a line."""
    nodes = "".join(f"{k}, {x:.9f}, {y:.9f}, {z:.9f}\n" for k, (x, y, z) in enumerate(mesh.points, 1))
    cells = ""
    for k, cell in enumerate(mesh.cells, 1):
        numbers = [k, *(cell + 1).tolist()]
        cells += ",\n".join(", ".join(map(str, numbers[j : j + 16])) for j in range(0, len(numbers), 16)) + "\n"
    return f"*NODE\n{nodes}*ELEMENT, TYPE={element}, ELSET=body\n{cells}{more}"


def cyclic_inp() -> str:
    """A sector of twelve, its faces tied as Abaqus ties sectors."""
    mesh = wedge("hexahedron20", (1, 1, 1))
    angle = np.arctan2(mesh.points[:, 1], mesh.points[:, 0])
    more = ""
    for name, side in (("low", angle < 0.01), ("high", angle > angle.max() - 0.01)):
        numbers = ", ".join(map(str, (np.flatnonzero(side) + 1).tolist()))
        more += f"*NSET, NSET={name}\n{numbers}\n*SURFACE, NAME=s_{name}, TYPE=NODE\n{name}\n"
    return inp(mesh, "C3D20R", f"{more}*TIE, NAME=t, CYCLIC SYMMETRY\ns_low, s_high\n")


def bdf() -> str:
    """One tetrahedron in large and free fields."""
    return (
        "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID*   2                               0.2             0.\n*       0.1\n"
        "GRID,3,,0.,.2,0.\nGRID,4,,0.,0.,.2\nCTETRA,7,5,1,2,3,4\nSPC1,3,123,1,2\nENDDATA\n"
    )


def msh() -> str:
    """The same for Gmsh."""
    nodes = "1 0 0 0\n2 0.2 0 0.1\n3 0 0.2 0\n4 0 0 0.2\n"
    return (
        '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 "body"\n$EndPhysicalNames\n'
        f"$Nodes\n4\n{nodes}$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"
    )


def cdb(points: np.ndarray, elements: list[tuple[int, list[int]]], types: dict[int, int], more: str) -> str:
    """Elements (type, nodes from 1) as Ansys writes them: blocks of fixed columns."""
    nodes = "".join(
        f"{k:9d}{0:9d}{0:9d}" + "".join(f"{x:21.13E}" for x in row) + "\n" for k, row in enumerate(points, 1)
    )
    cells = ""
    for k, (kind, corners) in enumerate(elements, 1):
        numbers = [kind, kind, 1, 1, 0, 0, 0, 0, len(corners), 0, k, *corners]
        lines = (numbers[j : j + 19] for j in range(0, len(numbers), 19))
        cells += "".join("".join(f"{n:9d}" for n in line) + "\n" for line in lines)
    named = "".join(f"ET,{kind},{number}\n" for kind, number in types.items())
    count, size = len(points), len(elements)
    return (
        f"/PREP7\n{named}NBLOCK,6,SOLID,{count:9d},{count:9d}\n(3i9,6e21.13e2)\n{nodes}N,R5.3,LOC,       -1,\n"
        f"EBLOCK,19,SOLID,{size:9d},{size:9d}\n(19i9)\n{cells}       -1\n{more}"
    )


def tetra_cdb() -> str:
    """One tetrahedron, a component."""
    more = "CMBLOCK,ROOT    ,NODE,       2\n(8i10)\n         1         2\n"
    return cdb(np.array(CORNERS), [(1, [1, 2, 3, 4])], {1: 285}, more)


def shells_cdb() -> str:
    """SHELL281 whole and as triangles, MASS21 that is left out, components with ranges."""
    grid = grid_mesh("quad9", (2, 1), lambda u: np.insert(u * [0.4, 0.2], 2, 0.0, axis=1), groups={})
    first, second = (grid.cells + 1).tolist()
    a, b, c, d, ab, bc, cd, da, middle = second
    halves = [[a, b, c, c, ab, bc, c, middle], [a, c, d, d, middle, cd, d, da]]
    elements = [(1, first[:8]), *((1, half) for half in halves), (2, [a])]
    more = (
        "CMBLOCK,ROOT    ,NODE,       3\n(8i10)\n         1         3        -5\n"
        "CMBLOCK,HALF    ,ELEM,       2\n(8i10)\n         2        -3\n"
    )
    return cdb(grid.points, elements, {1: 281, 2: 21}, more)


UNV = """    -1
   164
         1SI: METER (NEWTON)           2
  1.0000000000000000D+00  1.0000000000000000D+00  1.0000000000000000D+00
  2.7314999999999998D+02
    -1
    -1
  2411
         1         0         0        11
   0.0000000000000000D+00   0.0000000000000000D+00   0.0000000000000000D+00
         2         0         0        11
   1.0000000000000000D-01   0.0000000000000000D+00   0.0000000000000000D+00
         3         0         0        11
   1.0000000000000000D-01   1.0000000000000000D-01   0.0000000000000000D+00
         4         0         0        11
   0.0000000000000000D+00   1.0000000000000000D-01   0.0000000000000000D+00
    -1
    -1
  2412
         1        11         1         1         7         2
         0         1         1
         4         1
         2        94         1         1         7         4
         1         2         3         4
    -1
    -1
  2467
         1         0         0         0         0         0         0         1
ROOT
         8         1         0         0
    -1
"""  # a square and one of its edges


def write_meshes(folder: Path) -> None:
    """All of them."""
    bricks = grid_mesh("hexahedron", (2, 1, 1), lambda u: u * [0.2, 0.1, 0.05], groups={})
    texts = {
        "mesh.inp": inp(bricks, "C3D8"), "tied.inp": TIED_INP, "untied.inp": UNTIED_INP,
        "cyclic.inp": cyclic_inp(), "mesh.bdf": bdf(),
        "shells.bdf": SHELLS_BDF, "mesh.msh": msh(), "mesh.cdb": tetra_cdb(), "shells.cdb": shells_cdb(),
        "mesh.unv": UNV,
        "sector.inp": inp(wedge("quad8", (1, 1)), "S8R"),
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    mesh = meshio.Mesh(np.array(CORNERS), [("tetra", np.array([[0, 1, 2, 3]]))])
    meshio.write(folder / "mesh.vtu", mesh)
    meshio.gmsh.write(folder / "text41.msh", mesh, fmt_version="4.1", binary=False)
    meshio.gmsh.write(folder / "binary.msh", mesh, fmt_version="4.1", binary=True)
