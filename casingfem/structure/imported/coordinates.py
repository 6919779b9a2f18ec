"""Nastran's coordinate systems by three points, rectangular, cylindrical and spherical, one in another."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import FloatArray

KINDS_OF_SYSTEMS = {"CORD2R": "rectangular", "CORD2C": "cylindrical", "CORD2S": "spherical"}
SMALL = 1e-10  # of the distances: points in a line


class System(NamedTuple):
    """A system: its kind, that of the system its points are given in, and the points A, B, C, (3, 3).

    A is the origin, B on the z axis, C in the half plane of positive x.
    """

    kind: str
    within: int
    points: FloatArray


def cartesian(kind: str, x: FloatArray) -> FloatArray:
    """Coordinates of a kind as rectangular ones: (r, theta, z), or (r, theta from z, phi), angles in degrees.

    >>> cartesian("cylindrical", np.array([2.0, 90.0, 1.0])).round(12).tolist()
    [0.0, 2.0, 1.0]
    """
    if kind == "rectangular":
        return x
    a = np.radians(x[1])
    if kind == "cylindrical":
        return np.array([x[0] * np.cos(a), x[0] * np.sin(a), x[2]])
    b = np.radians(x[2])
    return np.asarray(x[0] * np.array([np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)]))


def in_basic(systems: Mapping[int, System], number: int, x: FloatArray) -> FloatArray:
    """A point given in a system, in the basic one.

    Raises
    ------
    ValueError
        A system that is not there, refers to itself, or has its points in a line.
    """
    seen: list[int] = []
    while number:
        if number not in systems:
            raise ValueError(f"no system {number}")
        if number in seen:
            raise ValueError(f"system {number} refers to itself")
        seen.append(number)
        system = systems[number]
        kind = systems[system.within].kind if system.within in systems else "rectangular"
        a, b, c = (cartesian(kind, point) for point in system.points)
        z, out = b - a, c - a
        y = np.cross(z, out)
        if not np.linalg.norm(y) > SMALL * np.linalg.norm(z) * np.linalg.norm(out):
            raise ValueError(f"the points of system {number} stand in a line")
        axes = np.stack([np.cross(y, z), y, z])
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        x = a + cartesian(system.kind, x) @ axes
        number = system.within
        if number:
            x = coordinates(systems[number].kind, x) if number in systems else x
    return x


def coordinates(kind: str, x: FloatArray) -> FloatArray:
    """Rectangular coordinates as those of a kind, the inverse of `cartesian`."""
    if kind == "rectangular":
        return x
    angle = np.degrees(np.arctan2(x[1], x[0]))
    if kind == "cylindrical":
        return np.array([np.hypot(x[0], x[1]), angle, x[2]])
    return np.array([np.linalg.norm(x), np.degrees(np.arctan2(np.hypot(x[0], x[1]), x[2])), angle])
