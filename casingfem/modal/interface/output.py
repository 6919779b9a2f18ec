"""Outputs of a reduced shell: displacement or surface strain at named places, as rows over its nodal fields.

With u the nodal fields, an output is row u = (row Phi) q + (row R) lam: modes and residual, so that it holds where
contact is, and a strain comes from the shell's own kinematics (`structure.kinematics`).
"""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.mesh.kinematics import DOFS, frame, strain_slots
from casingfem.structure.mesh.place import place_jets
from casingfem.structure.shell.system import System
from casingfem.structure.shell.wall import curvature, strain_rows

DIRECTIONS = ("x", "y", "z", "normal", "radial", "tangential")
STRAINS = {"11": 0, "22": 1, "12": 2}


@dataclass(frozen=True, slots=True, kw_only=True)
class Displacement:
    """Displacement [m] at parameters `at` of the chart: along x, y, z, the surface's normal, or around the z axis.

    >>> Displacement(name="tip", at=(0.1, 0.0), direction="normal").name
    'tip'
    """

    name: str
    at: tuple[float, float]
    direction: str = "normal"

    def row(self, system: System) -> FloatArray:
        """Row over the nodal fields, (nodes, 5)."""
        if self.direction not in DIRECTIONS:
            raise ModelError("output-direction", f"output {self.name!r}: found direction {self.direction!r}")
        nodes, jets = jets_at(system, self.name, self.at)
        surface = system.shell.geometry(*(np.array([v]) for v in self.at)).surface
        x, y, _ = surface.x[:, 0]
        r = np.hypot(x, y)
        around = {"radial": (x, y, 0.0), "tangential": (-y, x, 0.0)}
        if self.direction in around and r == 0.0:
            raise ModelError("output-direction", f"output {self.name!r}: found {self.direction} on the axis")
        unit = frame(surface).normal[:, 0] if self.direction == "normal" else np.zeros(3)
        if self.direction in around:
            unit = np.array(around[self.direction]) / r
        elif self.direction != "normal":
            unit["xyz".index(self.direction)] = 1.0
        row = np.zeros((system.grid.nodes.shape[1], DOFS))
        row[nodes, :3] = jets[0][:, None] * unit
        return row


@dataclass(frozen=True, slots=True, kw_only=True)
class Strain:
    """Strain [-] at parameters `at` and z = side t/2: component "11" (along the span), "22", "12" (2 eps_12).

    eps + z chi, on a curved wall with the metric there (`structure.shell.wall.strain_rows`). `side` +1 on the face the
    normal points to, -1 on the other, 0 at mid-surface.

    >>> Strain(name="root", at=(0.0, 0.0)).component
    '11'
    """

    name: str
    at: tuple[float, float]
    component: str = "11"
    side: float = 1.0

    def row(self, system: System) -> FloatArray:
        """Row over the nodal fields, (nodes, 5)."""
        if self.component not in STRAINS or not -1.0 <= self.side <= 1.0:
            found = f"component {self.component!r}, side {self.side!r}"
            raise ModelError("output-direction", f"output {self.name!r}: found {found}")
        nodes, jets = jets_at(system, self.name, self.at)
        geometry = system.shell.geometry(*(np.array([v]) for v in self.at))
        L, rates = strain_slots(geometry.surface)
        b = curvature(rates) if system.shell.wall == "curved" else np.zeros((3, 1))
        rows = strain_rows(b, 0.5 * self.side * geometry.thickness)[0, STRAINS[self.component]]
        slots = np.einsum("r,krc->kc", rows, L[:, :6, :, 0])
        row = np.zeros((system.grid.nodes.shape[1], DOFS))
        row[nodes] = jets.T @ slots
        return row


class Output(Protocol):
    """What can be stored with a basis: a name, and a row over the nodal fields of the structure."""

    @property
    def name(self) -> str:
        """What it is called in a run."""

    def row(self, system: Any) -> FloatArray:
        """Row over the nodal fields, (nodes, dofs of a node)."""


def output_rows(system: System | MeshSystem, outputs: tuple[Output, ...]) -> FloatArray:
    """Rows of all outputs, (outputs, dofs * nodes)."""
    names = [output.name for output in outputs]
    if len(set(names)) < len(names):
        raise ModelError("output-name", f"outputs: found the names {', '.join(names)}, expected each once")
    rows = [output.row(system).ravel() for output in outputs]
    return np.array(rows).reshape(len(rows), len(system.points) * system.dofs)


def jets_at(system: System, name: str, at: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
    """Nodes (functions,) and weights of value and slopes (3, functions) at one place."""
    if not isinstance(system, System):
        raise ModelError("output-place", f"output {name!r}: found parameters of a chart on an imported part")
    try:
        nodes, jets = place_jets(system.grid, np.array([at[0]]), np.array([at[1]]))
    except ValueError as error:
        raise ModelError("output-place", f"output {name!r}: {error}") from error
    return nodes[0], jets[:, 0]
