"""Rigid motion of a body: steady rotation about a fixed axis, and rigid motions that its supports allow."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.geometry.chart import Chart, Surface

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rotation:
    """Steady rotation of a shell and its supports.

    Parameters
    ----------
    omega
        Speed [rad/s].
    axis
        Direction of the axis in the chart's Cartesian axes, any length; by default z, the axis of every casing.
    centre
        A point on the axis [m].

    Raises
    ------
    ModelError
        `rotation-axis` for an axis without direction; `rotation-speed` for a speed that is not finite.

    Examples
    --------
    >>> Rotation(omega=2 * np.pi * 50.0).direction.tolist()
    [0.0, 0.0, 1.0]
    """

    omega: float
    axis: Vector = (0.0, 0.0, 1.0)
    centre: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not np.isfinite(self.omega):
            raise ModelError("rotation-speed", f"rotation.omega: found {self.omega!r}")
        values = np.array([self.axis, self.centre], dtype=float)
        if values.shape != (2, 3) or not np.all(np.isfinite(values)) or not np.any(values[0]):
            raise ModelError("rotation-axis", f"rotation: found axis {self.axis!r} through {self.centre!r}")

    @property
    def direction(self) -> FloatArray:
        """Unit vector along the axis, (3,)."""
        axis = np.asarray(self.axis) / np.abs(self.axis).max()  # squares of very large or small lengths are no numbers
        return np.asarray(axis / np.linalg.norm(axis))

    @property
    def plane(self) -> FloatArray:
        """Projection onto the plane of rotation P = I - a a^T, (3, 3)."""
        return np.asarray(np.eye(3) - np.outer(self.direction, self.direction))

    def at(self, omega: float) -> "Rotation":
        """The same axis at another speed [rad/s]."""
        return replace(self, omega=omega)

    @classmethod
    def of_blade(cls, chart: Chart, *, omega: float, hub_radius: float, stagger: float = 0.0) -> "Rotation":
        """Rotation of a blade on a hub: its span is radial at the middle of its root.

        The axis is `hub_radius` [m] below the root and makes the angle `stagger` [rad] with the root's chord, towards
        the surface normal: at 0 the chord is along the axis and the blade flaps in the plane of rotation, at pi/2 it
        flaps out of it.

        >>> from casingfem.structure.geometry.chart import Plate
        >>> rotation = Rotation.of_blade(Plate(length=0.3, width=0.1), omega=100.0, hub_radius=0.2)
        >>> rotation.axis, rotation.centre
        ((0.0, 1.0, 0.0), (-0.2, 0.0, 0.0))
        """
        if chart.periodic:
            raise ModelError("rotation-blade", "rotation: found a hub radius or a stagger on a closed casing")
        if not (np.isfinite(hub_radius) and hub_radius >= 0.0 and np.isfinite(stagger)):
            raise ModelError("rotation-blade", f"rotation: found hub_radius {hub_radius!r}, stagger {stagger!r}")
        root, span, chord, normal = blade_frame(chart)
        axis = np.cos(stagger) * chord + np.sin(stagger) * normal
        x, y, z = (axis + 0.0).tolist()
        a, b, c = (root - hub_radius * span + 0.0).tolist()
        return cls(omega=omega, axis=(x, y, z), centre=(a, b, c))


def skew(v: Array) -> Array:
    """Matrices (..., 3, 3) of the cross product v x, v (..., 3).

    >>> (skew(np.array([1.0, 2.0, 3.0])) @ np.array([0.0, 0.0, 1.0])).tolist()
    [2.0, -1.0, 0.0]
    """
    x, y, z = np.moveaxis(np.asarray(v), -1, 0)
    zero = np.zeros_like(x)
    return np.stack([np.stack(row, axis=-1) for row in ([zero, -z, y], [z, zero, -x], [-y, x, zero])], axis=-2)


def axis_frame(axis: Vector) -> FloatArray:
    """Right-handed unit rows (e1, e2, a) for an axis a, (3, 3): e1 closest to x, or to y for an axis along x.

    >>> axis_frame((0.0, 0.0, 2.0)).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    a = Rotation(omega=0.0, axis=axis).direction
    start = np.eye(3)[int(abs(a[0]) > abs(a[1]) and abs(a[0]) > abs(a[2]))]
    e1 = start - (start @ a) * a
    e1 /= np.linalg.norm(e1)
    return np.array([e1, np.cross(a, e1), a])


def blade_frame(chart: Chart) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Middle of the root, span, chord and surface normal there, (3,) each; span = chord x normal."""
    (a, _), (b0, b1) = chart.bounds
    surface = Surface(*(part[:, 0] for part in chart.surface(np.array([a]), np.array([0.5 * (b0 + b1)]), None)))
    chord = surface.x2 / np.linalg.norm(surface.x2)
    span = surface.x1 - chord * (chord @ surface.x1)
    span = span / np.linalg.norm(span)
    return surface.x, span, chord, np.cross(span, chord)


STILL = 1e-12  # share of the largest reaction below which a support is not felt


def rigid_motions(x: FloatArray, normals: FloatArray | None = None, frames: FloatArray | None = None) -> FloatArray:
    """Three translations and three rotations about the centre as columns (dofs, 6), for a scale of one.

    With nodal normals (nodes, 3) and tangents (nodes, 2, 3), the rotations of the normals are appended to each node.
    """
    arms = x - x.mean(axis=0)
    arms = arms / np.abs(arms).max()
    turns = np.stack([np.cross(axis, arms) for axis in np.eye(3)], axis=-1)  # (nodes, 3, 3)
    motions = np.concatenate([np.broadcast_to(np.eye(3), turns.shape), turns], axis=2)
    if normals is not None and frames is not None:
        size = np.abs(x - x.mean(axis=0)).max()
        tilts = np.stack([np.cross(axis, normals) for axis in np.eye(3)], axis=-1) / size
        rotations = np.einsum("nic,nck->nik", frames, tilts)
        motions = np.concatenate([motions, np.concatenate([np.zeros_like(rotations), rotations], axis=2)], axis=1)
    return motions.reshape(-1, 6)


def unfelt(reactions: Iterable[FloatArray]) -> FloatArray:
    """Combinations of the six rigid motions that no support resists, orthonormal columns (6, k), k from 0 to 6.

    Reactions are the work (6, 6) of each support under the motions; soft supports count like stiff ones.

    >>> unfelt([np.diag([1e16, 1e16, 0, 0, 0, 0]), np.diag([0, 0, 1e-3, 0, 0, 0])]).shape
    (6, 3)
    """
    size, shares = np.linalg.eigh(sum((R / np.trace(R) for R in reactions if np.trace(R) > 0.0), np.zeros((6, 6))))
    return np.asarray(shares[:, size <= STILL])


def rigid_left(motions: FloatArray, held: IntArray, springs: Iterable[csc_array]) -> int:
    """Number of combinations of rigid motions (dofs, 6) that neither move a fixed dof nor strain a spring."""
    moved = motions[held]
    return int(unfelt([moved.T @ moved, *(motions.T @ (spring @ motions) for spring in springs)]).shape[1])
