"""Positions of sensors on a shell: the nearest points of the surface, and the model's shapes there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray, IntArray, freeze
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import Modes
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem
from casingfem.structure.mesh.kinematics import dot
from casingfem.structure.mesh.place import interpolation
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.shell import Shell, require_shell
from casingfem.structure.shell.system import System
from contact.io.brief import brief

FAR = 0.02  # of the shell's size: a sensor further from the surface is refused
SAMPLES = 97  # places along each parameter among which the search for the nearest begins
STEPS = 12


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensors:
    """Channels on a shell.

    Attributes
    ----------
    a, b
        Chart parameters of the nearest points, (channels,); nan on imported parts, where the nearest nodes are used.
    distance
        Distance of the surface from the sensor [m], (channels,).
    directions
        Unit vectors, (channels, 3).
    labels
        Number of the point of each channel, (channels,).
    nodes, weights
        Nodes and interpolation weights, (channels, functions).
    """

    a: FloatArray
    b: FloatArray
    distance: FloatArray
    directions: FloatArray
    labels: IntArray
    nodes: IntArray
    weights: FloatArray

    __repr__ = brief

    def __post_init__(self) -> None:
        freeze(self, *self.__slots__)

    def __len__(self) -> int:
        return len(self.labels)

    def shapes(self, fields: Array) -> Array:
        """Nodal fields (nodes, 5, modes) at the channels, (channels, modes)."""
        return np.asarray(np.einsum("cf,cfim,ci->cm", self.weights, fields[self.nodes][:, :, :3], self.directions))

    def loads(self, system: System | MeshSystem) -> FloatArray:
        """Unit forces at the channels on the free dofs, (free, channels): P with u = P^T x."""
        forces = np.zeros((len(system.points), system.dofs, len(self)))
        channel = np.broadcast_to(np.arange(len(self))[:, None], self.nodes.shape)
        for axis in range(3):
            np.add.at(
                forces,
                (self.nodes, np.full_like(self.nodes, axis), channel),
                self.weights * self.directions[:, axis, None],
            )
        return np.asarray(system.restrict(forces))


def sensors_on(
    shell: Shell,
    grid: Grid,
    points: ArrayLike,
    directions: ArrayLike,
    labels: ArrayLike | None = None,
    *,
    tolerance: float | None = None,
) -> Sensors:
    """Locate sensors on a shell.

    Parameters
    ----------
    points, directions
        Positions [m] and unit vectors, (channels, 3).
    labels
        Point number of each channel; by default each channel has its own.
    tolerance
        Largest distance from the surface [m]; by default 2 % of the shell's size.

    Raises
    ------
    ModelError
        sensor-far.
    """
    require_shell(shell, "sensors_on")
    where, towards = np.asarray(points, float), np.asarray(directions, float)
    numbers = np.arange(1, len(where) + 1) if labels is None else np.asarray(labels)
    a, b, distance = on_wall(shell, where, numbers, tolerance=tolerance)
    nodes, weights = interpolation(grid, a, b)
    return Sensors(a=a, b=b, distance=distance, directions=towards, labels=numbers, nodes=nodes, weights=weights)


def on_wall(
    shell: Shell, where: FloatArray, numbers: IntArray, *, tolerance: float | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Chart parameters of the nearest points and their distances [m], each (channels,).

    Raises
    ------
    ModelError
        sensor-far.
    """
    a, b = nearest(shell, where)
    surface = np.real(shell.geometry(a, b).surface.x)
    distance = np.linalg.norm(surface.T - where, axis=1)
    size = float(np.linalg.norm(np.ptp(surface_samples(shell)[2], axis=1)))
    allowed = FAR * size if tolerance is None else tolerance
    refuse_far(where, numbers, distance, allowed, "the wall")
    return a, b, distance


def sensors_of(
    modes: Modes | MeshModes, points: ArrayLike, directions: ArrayLike, labels: ArrayLike | None = None
) -> Sensors:
    """Sensors on the structure of some modes: at the nearest points of a wall, or nodes of an imported part."""
    if isinstance(modes, MeshModes):
        return sensors_at_nodes(modes.structure, points, directions, labels)
    return sensors_on(modes.shell, modes.grid, points, directions, labels)


def sensors_at_nodes(
    structure: MeshStructure,
    points: ArrayLike,
    directions: ArrayLike,
    labels: ArrayLike | None = None,
    *,
    tolerance: float | None = None,
) -> Sensors:
    """Locate sensors on an imported part, each at the nearest node.

    Raises
    ------
    ModelError
        sensor-far, for a sensor farther than `tolerance` [m], by default 2 % of the part's size, from every node.
    """
    from scipy.spatial import cKDTree  # loaded with the first sensors, not by every study

    where, towards = np.asarray(points, float), np.asarray(directions, float)
    numbers = np.arange(1, len(where) + 1) if labels is None else np.asarray(labels)
    mesh = structure.mesh
    distance, place = cKDTree(mesh.points[mesh.used]).query(where)
    refuse_far(where, numbers, distance, FAR * mesh.size if tolerance is None else tolerance, "a node")
    none = np.full(len(where), np.nan)
    nodes = mesh.used[place][:, None]
    weights = np.ones((len(where), 1))
    return Sensors(a=none, b=none, distance=distance, directions=towards, labels=numbers, nodes=nodes, weights=weights)


def refuse_far(where: FloatArray, numbers: IntArray, distance: FloatArray, allowed: float, what: str) -> None:
    """Refuse sensors that are too far from the structure."""
    if distance.max() > allowed:
        worst = int(distance.argmax())
        place = where[worst].round(4).tolist()
        message = f"sensor {numbers[worst]} at {place} m is {distance[worst]:.4g} m from {what}"
        raise ModelError("sensor-far", f"{message}, {allowed:.4g} m is allowed")


def surface_samples(shell: Shell) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Parameters on a tensor grid of points, and the surface there (3, points)."""
    lines = [np.linspace(float(np.real(low)), float(np.real(high)), SAMPLES) for low, high in shell.chart.bounds]
    a, b = (part.ravel() for part in np.meshgrid(*lines, indexing="ij"))
    return a, b, np.real(shell.geometry(a, b).surface.x)


def nearest(shell: Shell, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Chart parameters of the points of the surface nearest to some points (k, 3).

    From samples, then Gauss-Newton steps.
    """
    a, b, x = surface_samples(shell)
    start = np.array([np.argmin(np.sum((x - point[:, None]) ** 2, axis=0)) for point in points])
    at = np.stack([a[start], b[start]])
    (low_a, high_a), (low_b, high_b) = np.real(shell.chart.bounds)
    for _ in range(STEPS):
        surface = shell.geometry(*at).surface
        x1, x2 = np.real(surface.x1), np.real(surface.x2)
        gap = points.T - np.real(surface.x)
        g11, g12, g22 = dot(x1, x1), dot(x1, x2), dot(x2, x2)
        h1, h2 = dot(x1, gap), dot(x2, gap)
        step = np.stack([g22 * h1 - g12 * h2, g11 * h2 - g12 * h1]) / (g11 * g22 - g12**2)
        moved = at + step
        moved[0] = np.clip(moved[0], low_a, high_a)
        if not shell.chart.periodic:
            moved[1] = np.clip(moved[1], low_b, high_b)
        at = moved
    return at[0], at[1]
