"""What may be varied of an imported part, and how its modes feel it.

material.E | nu | rho; shell.thickness; solid.material.<group>.E, shell.material.<group>.rho (groups of cells with a
material of their own); shell.thicknesses.<group>; support.<group>.k_face.

The derivatives Phi^T K_p Phi and Phi^T M_p Phi are central differences of the assembled matrices: K and M are linear in
moduli, densities and foundations and at most cubic in a thickness, so that the step of `STEP` leaves 1e-8 of them.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from casingfem.errors import InputError, ModelError
from casingfem.io.arrays import FloatArray
from casingfem.modal.mesh_modes import MeshModes
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.imported.cells.mapped import mapped_parts
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.updating.numbers import Plain

STEP = 1e-4  # of the parameter's value
CONSTANTS = ("E", "nu", "rho")


def mesh_numbers(structure: MeshStructure) -> dict[str, Plain]:
    """Every number of an imported part that may be varied, by its address."""
    if not isinstance(structure, Solid | MeshShell):
        raise ModelError("structure-chart", f"update: found {type(structure).__name__}, expected a Solid or MeshShell")
    word = "solid" if isinstance(structure, Solid) else "shell"
    found = {f"material.{name}": Plain(("material", name)) for name in CONSTANTS}
    for group in structure.materials:
        found |= {f"{word}.material.{group}.{name}": Plain(("materials", group, name)) for name in CONSTANTS}
    if isinstance(structure, MeshShell):
        found["shell.thickness"] = Plain(("thickness",))
        found |= {f"shell.thicknesses.{group}": Plain(("thicknesses", group)) for group in structure.thicknesses}
    for group, support in structure.supports.items():
        if isinstance(support, ElasticEdge):
            found[f"support.{group}.k_face"] = Plain(("supports", group, "k_face"))
    return found


def mesh_address(structure: MeshStructure, name: str) -> Plain:
    """What a name means on an imported part.

    Raises
    ------
    InputError
        If the part has no such number.
    """
    known = mesh_numbers(structure)
    if name not in known:
        raise InputError(f"{name!r}: an imported part has {', '.join(known)}")
    return known[name]


def mesh_product_derivatives(
    modes: MeshModes, values: Sequence[float], renewed: Callable[[int, float], Any], fields: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """X^T K_p X and X^T M_p X for motions X (nodes, dofs, motions), (parameters, motions, motions) [per unit].

    `renewed(k, value)` is the part with its k-th number replaced, `values` where it stands. A rotating part is refused
    (`rotation-update`).
    """
    if getattr(modes.structure, "rotation", None) is not None:
        raise ModelError("rotation-update", "update: found a rotating part")
    K, M = np.empty((2, len(values), fields.shape[2], fields.shape[2]))
    for k, value in enumerate(values):
        h = STEP * abs(value)
        ahead, behind = (renewed(k, value + step).assembled() for step in (h, -h))
        X = ahead.collect(fields)
        K[k] = (X.T @ (ahead.K @ X) - X.T @ (behind.K @ X)) / (2.0 * h)
        M[k] = (X.T @ (ahead.M @ X) - X.T @ (behind.M @ X)) / (2.0 * h)
    return K, M


def nodal_inertia(modes: MeshModes) -> FloatArray:
    """Mass of the nodes, that of every cell in equal parts, for comparing shapes, (nodes,)."""
    mesh = modes.structure.mesh
    density = modes.structure.density()
    total = np.zeros(len(mesh.points))
    for rows, nodes, on in mapped_parts(mesh):
        np.add.at(total, nodes, (on.measure.sum(axis=1) * density[rows] / nodes.shape[1])[:, None])
    return total
