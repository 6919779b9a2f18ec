"""What can be wrong with a model: every refusal and warning has a code, a cause and a remedy, and they stand here.

A message says what was found where; the remedy and the code come from the catalogue, so that a user can look a code
up and a program can react to it.
"""

import warnings
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class Fault(NamedTuple):
    """One entry of the catalogue: why a model is refused or doubted, and what helps."""

    cause: str
    remedy: str


CATALOGUE: Mapping[str, Fault] = MappingProxyType(
    {
        "bolt-count": Fault("there is no such number of bolts", "give the number of bolts, 1 to 1000"),
        "bolt-mesh": Fault(
            "elements around that do not follow the bolts see some bolts stiffer than others and split perfect pairs",
            "leave mesh.around out, or make it a multiple of the number of bolts",
        ),
        "bolt-number": Fault("a loose bolt is named that does not exist", "number the bolts from 1 to their count"),
        "bolt-off-edge": Fault(
            "a bolt, with the patch it acts on, does not lie on the edge",
            "change first_angle, spacing or width, or take fewer bolts",
        ),
        "bolt-overlap": Fault(
            "neighbouring bolts act on the same part of the edge", "give a smaller width, or a larger spacing"
        ),
        "bolt-stiffness": Fault(
            "a bolt without stiffness, or with an impossible one, holds nothing",
            "give k in N/m, one number or [k_r, k_theta, k_z], and factors of 0 or more",
        ),
        "load-edge": Fault("a load names an edge that the chart does not have", "name one of the chart's edges"),
        "load-none": Fault("a static solution without loads is zero", "give at least one load"),
        "load-place": Fault(
            "a point load lies off the surface", "give the two parameters of the chart, as its `bounds` have them"
        ),
        "material-units": Fault(
            "the material's speed of sound is not that of a solid",
            "give E in Pa (steel 210e9) and rho in kg/m^3 (steel 7800)",
        ),
        "meridian-arc": Fault(
            "an arc of no length or of more than a turn", "give two angles in radians, less than 2 pi apart"
        ),
        "meridian-axis": Fault(
            "the meridian reaches the axis, where a chart of revolution ends in a pole",
            "stop short of the axis and leave a small hole",
        ),
        "mesh-aspect": Fault(
            "cells are much longer than wide",
            "refine along their long side, or see that no node is misplaced",
        ),
        "mesh-collapsed-cell": Fault(
            "a cell has the same node twice, as wedges written as bricks have",
            "mesh with tetrahedra or true bricks; wedges and pyramids are not supported",
        ),
        "mesh-distorted-cell": Fault(
            "a cell is nearly folded somewhere",
            "remesh there; frequencies may still be good, compare with a finer mesh",
        ),
        "mesh-flat-cell": Fault(
            "a cell has no volume or area",
            "delete it, or see whether its nodes were merged by mistake",
        ),
        "mesh-flipped-shell": Fault(
            "neighbouring shell cells are numbered in opposite senses",
            "orient the normals alike in the mesher",
        ),
        "mesh-group-empty": Fault(
            "a group holds no node of a cell",
            "name a group on the part, or save the group's cells with the mesh",
        ),
        "mesh-group-no-cells": Fault(
            "a material is given to a group without cells",
            "give it to a physical volume (for a shell: surface) or an element set",
        ),
        "mesh-group-no-facets": Fault(
            "a foundation needs facets, and the group's nodes cover none on the boundary",
            "name a physical surface, or every node of the facets",
        ),
        "mesh-hanging-node": Fault(
            "neighbouring cells do not share all nodes of their common facet",
            "remesh so that cells meet node to node",
        ),
        "mesh-inverted-cell": Fault(
            "the nodes of a cell run round it the wrong way, its volume is negative",
            "reverse the cells' orientation in the mesher",
        ),
        "mesh-linear-cells": Fault(
            "linear cells lock: bending comes out too stiff",
            "use quadratic cells (order 2 in the mesher)",
        ),
        "mesh-material-twice": Fault(
            "a cell lies in two groups that each have a material",
            "give each cell one material: the groups must not overlap",
        ),
        "mesh-mechanism": Fault(
            "parts of the body move against each other without strain: they hang together by an edge or a node only",
            "join the parts over facets, or support each of them",
        ),
        "mesh-no-group": Fault(
            "a support or material names a group the mesh does not have",
            "name one of the groups listed, or add the physical group in the mesher",
        ),
        "mesh-not-finite": Fault(
            "coordinates are nan or infinite",
            "repair the file's node block",
        ),
        "mesh-not-solid": Fault(
            "a solid needs tetrahedra or hexahedra",
            "mesh the volume, or use the mesh as a shell",
        ),
        "mesh-open-seam": Fault(
            "coincident nodes are not joined: the body is slit there",
            "merge duplicate nodes in the mesher, or read the mesh with join = a distance in metres",
        ),
        "mesh-orphan-nodes": Fault(
            "nodes belong to no cell",
            "they are left out; see that no cell is missing",
        ),
        "mesh-overlap": Fault(
            "more than two cells share a facet: cells lie over each other, or shells meet in a T",
            "delete duplicate cells; shells that branch are not supported, mesh them as solids",
        ),
        "mesh-parts": Fault(
            "the mesh falls into parts that do not touch",
            "join them in the mesher, or compute each part alone",
        ),
        "mesh-scrambled-cell": Fault(
            "the nodes of a cell are in another order than the format's",
            "export again; check the order of the middle nodes",
        ),
        "mesh-units": Fault(
            "the part is very large for its material",
            "if the file is in millimetres, read it with scale = 1e-3",
        ),
        "shell-thickness": Fault(
            "the wall thickness is not a positive finite number", "give the thickness in metres, 3 mm as 3e-3"
        ),
        "solid-support": Fault(
            "a solid cannot have this kind of support",
            "use clamped, fixed (directions) or elastic with k_face alone",
        ),
        "springs-negative": Fault(
            "the pattern of an elastic edge falls below -1 somewhere: a spring would push",
            "reduce the harmonics of its pattern until their sum stays above -1",
        ),
        "static-loose": Fault(
            "a rigid motion is not held, or the shell is so soft that round-off hides its stiffness",
            "hold every motion that the loads drive; where they balance, a soft elastic edge is enough",
        ),
        "strip-extent": Fault(
            "the ends of a strip are not finite numbers in order", "give start below end, in metres along the axis"
        ),
        "strip-off-line": Fault(
            "a strip ends inside an element, where its jump of thickness or material would be smeared",
            "leave the mesh's rows to the program, or put a break of mesh.rows at each end of the strip",
        ),
        "strip-outside": Fault(
            "a strip reaches beyond the ends of the shell", "give start and end in metres within the chart's bounds"
        ),
        "strip-overlap": Fault("two strips claim the same part of the wall", "let one strip end where the next begins"),
    }
)


class ModelError(ValueError):
    """A model that is refused: `code` names the fault in the catalogue, the message ends with remedy and code.

    >>> str(ModelError("shell-thickness", "shell.thickness must be above 0, found -3.0"))
    'shell.thickness must be above 0, found -3.0: give the thickness in metres, 3 mm as 3e-3 [shell-thickness]'
    """

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(sentence(code, message))


class ModelWarning(UserWarning):
    """A model that is computed although its result may mislead; same form as `ModelError`."""

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(sentence(code, message))


def doubt(code: str, message: str, *, stacklevel: int = 3) -> None:
    """Warn of a catalogued fault that does not stop the computation."""
    warnings.warn(ModelWarning(code, message), stacklevel=stacklevel)


def sentence(code: str, message: str) -> str:
    """What was found, what helps, and the code."""
    return f"{message}: {CATALOGUE[code].remedy} [{code}]"
