"""The loads and channels through which contact acts on a structure: a chart's shell or an imported part."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.modal.interface import mesh_rows
from casingfem.modal.interface.chart_rows import interface_rows, rim_lines, rim_shape, rim_thickness, tip_directions
from casingfem.modal.interface.kinds import AtNodes, Interface, Rim
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.shell.system import System


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class View:
    """An interface on an assembled structure.

    Attributes
    ----------
    loads
        Unit forces on the channels, (free, channels).
    channels
        Names of the channels.
    axes
        Directions of the participation factors: x, y and the axis of a rim, span, flap, chord of a tip, (3, 3).
    lines, line_thickness, out_of_roundness
        Data of a rim, as in `ModalBasis`.
    facts
        Facts about it for the provenance.
    """

    loads: FloatArray
    channels: tuple[str, ...]
    axes: FloatArray
    lines: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    line_thickness: FloatArray = field(default_factory=lambda: np.zeros(0))
    out_of_roundness: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    facts: dict[str, Any] = field(default_factory=dict)

    @property
    def radius(self) -> float:
        """Mean radius of the lines of a rim [m], 0 for a tip."""
        return float(self.lines[:, 1].mean()) if len(self.lines) else 0.0

    @property
    def thickness(self) -> float:
        """Least thickness of the wall on the lines of a rim [m], 0 if unknown."""
        return float(self.line_thickness.min(initial=np.inf)) if self.line_thickness.size else 0.0


def view(system: System | MeshSystem, interface: Interface) -> View:
    """An interface on a structure.

    Raises
    ------
    ModelError
        If the structure has no such edge, group or node.
    """
    return of_chart(system, interface) if isinstance(system, System) else of_mesh(system, interface)


def of_chart(system: System, interface: Interface) -> View:
    """The interface of a shell on a chart."""
    rows, channels = interface_rows(system, interface)
    loads = load_columns(system, rows)
    if isinstance(interface, Rim):
        return View(
            loads=loads,
            channels=channels,
            axes=np.eye(3),
            lines=rim_lines(system.shell, interface),
            line_thickness=rim_thickness(system.shell, interface),
            out_of_roundness=rim_shape(system.shell, interface),
        )
    assert not isinstance(interface, AtNodes)  # refused with the rows
    return View(loads=loads, channels=channels, axes=tip_directions(system, interface))


def of_mesh(system: MeshSystem, interface: Interface) -> View:
    """The interface of an imported part."""
    if isinstance(interface, Rim):
        rim = mesh_rows.rim_rows(system, interface)
        return View(
            loads=load_columns(system, rim.rows),
            channels=interface.channels,
            axes=rim.axes,
            lines=rim.line,
            out_of_roundness=rim.shape,
        )
    if isinstance(interface, AtNodes):
        rows = mesh_rows.node_rows(system, interface)
        return View(loads=load_columns(system, rows), channels=interface.channels, axes=np.eye(3))
    rows, axes, places = mesh_rows.tip_rows(system, interface)
    facts = places | {"directions": dict(zip(("span", "flap", "chord"), axes.round(12).tolist(), strict=True))}
    return View(loads=load_columns(system, rows), channels=interface.channels, axes=axes, facts=facts)


def load_columns(system: System | MeshSystem, rows: FloatArray) -> FloatArray:
    """Load columns on the free dofs, (free, rows), from rows over nodal fields, which may omit the rotations."""
    nodes = len(system.points)
    given = rows.reshape(len(rows), nodes, -1)
    nodal = np.zeros((nodes, system.dofs, len(rows)))
    nodal[:, : given.shape[2]] = given.transpose(1, 2, 0)
    return np.asarray(system.restrict(nodal))
