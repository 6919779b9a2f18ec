"""Nastran's coordinate systems by three points or grids: rectangular, cylindrical, spherical, nested."""

from collections.abc import Container, Mapping
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.readers.bdf_cards import Card, Numbers

KINDS_OF_SYSTEMS = {"CORD2R": "rectangular", "CORD2C": "cylindrical", "CORD2S": "spherical"}
BY_GRIDS = {"CORD1R": "rectangular", "CORD1C": "cylindrical", "CORD1S": "spherical"}
SMALL = 1e-10  # of the distances: points in a line


class System(NamedTuple):
    """A coordinate system: its kind, the system in which its points are given, and the points A, B, C, (3, 3).

    A is the origin, B on the z axis, C in the half plane of positive x.
    """

    kind: str
    within: int
    points: FloatArray


def cartesian(kind: str, x: FloatArray) -> FloatArray:
    """Rectangular coordinates from those of a kind: (r, theta, z), or (r, theta from z, phi), angles in degrees.

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
        For a missing system, one that refers to itself, or one whose points are on a line.
    """
    seen: list[int] = []
    while number:
        if number not in systems:
            raise ValueError(f"found no system {number}")
        if number in seen:
            raise ValueError(f"found a system {number} that refers to itself")
        seen.append(number)
        system = systems[number]
        origin, axes = within(systems, number)
        x = origin + cartesian(system.kind, x) @ axes
        number = system.within
        if number:
            x = coordinates(systems[number].kind, x) if number in systems else x
    return x


def within(systems: Mapping[int, System], number: int) -> tuple[FloatArray, FloatArray]:
    """Origin (3,) and axes (3, 3), rows, of a system, in the rectangular frame of the system in which it is given."""
    system = systems[number]
    kind = systems[system.within].kind if system.within in systems else "rectangular"
    a, b, c = (cartesian(kind, point) for point in system.points)
    z, out = b - a, c - a
    y = np.cross(z, out)
    if not np.linalg.norm(y) > SMALL * np.linalg.norm(z) * np.linalg.norm(out):
        raise ValueError(f"found the three points of system {number} in one line, expected a triangle")
    axes = np.stack([np.cross(y, z), y, z])
    return a, axes / np.linalg.norm(axes, axis=1, keepdims=True)


def axes_at(systems: Mapping[int, System], number: int, x: FloatArray) -> FloatArray:
    """Directions of a system's components at a point x of the basic system, rows (3, 3).

    Radial ones depend on the point.

    Raises
    ------
    ValueError
        As `in_basic`; a point on the axis of a cylindrical or spherical system.

    >>> polar = {3: System("cylindrical", 0, np.array([[0.0, 0, 0], [0, 0, 1], [1, 0, 0]]))}
    >>> axes_at(polar, 3, np.array([0.0, 2.0, 5.0])).round(12).tolist()
    [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    if not number:
        return np.eye(3)
    origin = in_basic(systems, number, np.zeros(3))
    kind = systems[number].kind
    units = np.eye(3) if kind == "rectangular" else [[1.0, 0, 0], [1.0, 90, 0], [0, 0, 1.0]]
    if kind == "spherical":
        units = [[1.0, 90, 0], [1.0, 90, 90], [1.0, 0, 0]]
    axes: FloatArray = np.array([in_basic(systems, number, np.asarray(unit)) - origin for unit in units])
    if kind == "rectangular":
        return axes
    _, b, c = coordinates(kind, axes @ (x - origin))
    if not np.hypot(*(axes[:2] @ (x - origin))) > SMALL * np.linalg.norm(x - origin):
        raise ValueError(f"found a point on the axis of system {number}, where its radial direction is not defined")
    cos, sin = np.cos(np.radians([b, c])), np.sin(np.radians([b, c]))
    if kind == "cylindrical":
        local = [[cos[0], sin[0], 0.0], [-sin[0], cos[0], 0.0], [0.0, 0.0, 1.0]]
    else:
        out = [cos[1], sin[1]]
        local = [[*(sin[0] * v for v in out), cos[0]], [*(cos[0] * v for v in out), -sin[0]], [-sin[1], cos[1], 0.0]]
    return np.asarray(local) @ axes


def coordinates(kind: str, x: FloatArray) -> FloatArray:
    """Rectangular coordinates as those of a kind, the inverse of `cartesian`."""
    if kind == "rectangular":
        return x
    angle = np.degrees(np.arctan2(x[1], x[0]))
    if kind == "cylindrical":
        return np.array([np.hypot(x[0], x[1]), angle, x[2]])
    return np.array([np.linalg.norm(x), np.degrees(np.arctan2(np.hypot(x[0], x[1]), x[2])), angle])


class CardSystems:
    """The coordinate systems defined by the cards of a file, by points or by grids."""

    def __init__(self, numbers: Numbers) -> None:
        self.numbers = numbers
        self.systems: dict[int, System] = {}
        self.by_grids: dict[int, tuple[str, list[int], Card]] = {}  # number -> kind, grids A, B, C, card

    def take(self, card: Card) -> None:
        """Read CORD2R, CORD2C, CORD2S: number, system of the points, origin A, B on the z axis, C in the x-z plane."""
        number, *fields = [*card.fields, *[""] * 11]
        values = np.array([self.numbers.real(card, text) for text in fields[1:10]]).reshape(3, 3)
        within = self.numbers.integer(card, fields[0] or "0")
        self.systems[self.new(card, number)] = System(KINDS_OF_SYSTEMS[card.name], within, values)

    def take_by_grids(self, card: Card) -> None:
        """Read CORD1R, CORD1C, CORD1S: number, grids at A, B, C; a second system may follow on the same card."""
        for k in range(0, len(card.fields), 4):
            number, *grids = card.fields[k : k + 4]
            if len(grids) != 3 or "" in grids:
                raise self.numbers.fault(
                    card, f"found the grids {', '.join(grids) or 'none'}, expected three, A, B and C"
                )
            given = [self.numbers.integer(card, text) for text in grids]
            self.by_grids[self.new(card, number)] = (BY_GRIDS[card.name], given, card)

    def new(self, card: Card, text: str) -> int:
        """The number of a new system; a repeated number is refused."""
        number = self.numbers.integer(card, text)
        if number in self.systems or number in self.by_grids:
            raise self.numbers.fault(card, f"found coordinate system {number} again, expected it once")
        return number

    def place(self, grids: list[tuple[int, float, float, float]], placed: list[tuple[int, int, Card]]) -> None:
        """Transform grids (number, x, y, z) to the basic system.

        `placed` are (row, system, card) of those in another system.

        A system defined by grids is known once these grids are transformed.
        """
        waiting, pending = placed, dict(self.by_grids)
        while waiting or pending:
            here = {grid[0]: grid[1:] for grid in grids}
            apart = {grids[row][0] for row, _, _ in waiting}
            ready = [n for n, (_, named, _) in pending.items() if not set(named) & apart]
            for number in ready:
                kind, named, card = pending.pop(number)
                if missing := [grid for grid in named if grid not in here]:
                    raise self.numbers.fault(card, f"found grid {missing[0]}, which the file does not define")
                self.systems[number] = System(kind, 0, np.array([here[grid] for grid in named]))
            left = [item for item in waiting if self.waits(item[1], pending)]
            for row, system, card in (item for item in waiting if not self.waits(item[1], pending)):
                try:
                    x, y, z = in_basic(self.systems, system, np.array(grids[row][1:])).tolist()
                except ValueError as error:
                    message = f"grid {grids[row][0]} in coordinate system {system}: {error}"
                    raise self.numbers.fault(card, message) from None
                grids[row] = (grids[row][0], x, y, z)
            if len(left) == len(waiting) and not ready:
                found = "found coordinate systems whose grids lie in one another's system"
                raise self.numbers.fault(left[0][2], f"{found}, expected one that starts from the basic system")
            waiting = left

    def waits(self, system: int, pending: Container[int]) -> bool:
        """Whether a system depends on grids that are not transformed yet."""
        seen = set[int]()
        while system in self.systems and system not in seen:
            seen.add(system)
            system = self.systems[system].within
        return system in pending

    def axes(self, card: Card, system: int, place: FloatArray) -> FloatArray:
        """Directions of a system at a point, rows (3, 3)."""
        try:
            return axes_at(self.systems, system, place)
        except ValueError as error:
            raise self.numbers.fault(card, f"coordinate system {system}: {error}") from None
