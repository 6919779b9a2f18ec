"""Sections of a blade: tables of points on both surfaces, and the curves along the chord that go through them.

A section is a table as manufacturers and test cases publish it. At stations along the chord it gives the axial position
z, the radius r and the angles theta_1 and theta_2 of the two surfaces about the axis z,

    x = r cos theta,   y = r sin theta.

A sharp or round edge is closed: both surfaces end there in one point. Tables often begin at the smallest z, which is
not the nose of a staggered blade. The mesher therefore divides a closed section at the two points with the largest
distance.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray, IntArray, frozen
from casingfem.io.columns import SECTIONS, named
from casingfem.io.strict_csv import StrictCsv, read
from casingfem.io.together import together
from casingfem.structure.imported.mesh.mesh_data import MeshData
from casingfem.structure.imported.sector_mesh import DiskRing

COLUMNS = {
    "z": {"z_m": 1.0, "z_mm": 1e-3},
    "r": {"r_m": 1.0, "r_mm": 1e-3},
    "theta_1": {"theta_1_rad": 1.0, "theta_1_deg": np.pi / 180.0},
    "theta_2": {"theta_2_rad": 1.0, "theta_2_deg": np.pi / 180.0},
}
CLOSED = 1e-4  # of a section's thickness: surfaces closer than this meet
LEAST_STATIONS, LEAST_SECTIONS = 5, 2
RADII = (2e-3, 20.0)  # m, between which the mean radius of a blade lies
TURN = 2.0 * np.pi


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BladeSections:
    """Sections of a blade from root to tip, about the axis z.

    Attributes
    ----------
    surfaces
        Points of both surfaces of each section [m], (2, stations, 3), from one edge to the other.
    closed
        Whether both surfaces meet at the first and at the last station.
    card
        The comment lines of the file.
    source
        Name of the file, for messages.

    Raises
    ------
    InputError
        For fewer than two sections or five stations, repeated stations, surfaces that cross, or an edge that is closed
        in some sections only.

    Examples
    --------
    >>> import casingfem as cf
    >>> along = np.linspace(0.0, 1.0, 9)
    >>> z, r = np.meshgrid(0.04 * along, np.array([0.20, 0.23, 0.26]))
    >>> camber, half = 0.1 * z / 0.04, 0.02 * np.sqrt(along - along**2)
    >>> sections = cf.imported.BladeSections.cylindrical(z, r, camber - half, camber + half)
    >>> sections
    BladeSections(3 sections of 9 stations, radius 0.2 to 0.26 m, closed at both edges)
    >>> sections.mesh(cells=(8, 6, 1))
    MeshData(sections: 48 hexahedron20, 12 of them collapsed, 369 nodes, 0.061 x 0.02596 x 0.04 m; groups root, tip)
    """

    surfaces: tuple[FloatArray, ...]
    closed: tuple[bool, bool]
    card: tuple[str, ...] = ()
    source: str = "sections"

    @classmethod
    def from_csv(cls, path: str | os.PathLike[str]) -> BladeSections:
        """Read a CSV with the columns section, z_m, r_m, theta_1_rad, theta_2_rad, one row a station.

        Sections follow one another from root to tip, stations from one edge to the other. Lengths may be in mm, angles
        in degrees, as the names of the columns say; # begins a comment.

        Raises
        ------
        InputError
            Every problem of the table with its line, and those of `BladeSections`.
        OSError
            If there is no such file.

        Examples
        --------
        >>> import casingfem as cf
        >>> from casingfem.examples import DATA
        >>> cf.imported.BladeSections.from_csv(DATA / "scenes" / "rotor37" / "sections.csv")
        BladeSections(12 sections of 100 stations, radius 0.1779 to 0.252 m, closed at both edges)
        """
        table = named(read(path), SECTIONS)
        columns = numbers(table)
        rows = sections_of(table)
        check_units(table, columns)
        parts = [tuple(columns[name][own] for name in COLUMNS) for own in rows]
        whole = built(parts, [table.lines[own] for own in rows], table.card, table.path)
        return replace(whole, source=Path(table.path).name)

    @classmethod
    def cylindrical(cls, z: ArrayLike, r: ArrayLike, theta_1: ArrayLike, theta_2: ArrayLike) -> BladeSections:
        """Sections from arrays (sections, stations): z and r [m], angles of both surfaces [rad]."""
        arrays = [np.atleast_2d(np.asarray(values, dtype=float)) for values in (z, r, theta_1, theta_2)]
        shapes = {array.shape for array in arrays}
        if len(shapes) != 1 or arrays[0].ndim != 2:
            found = ", ".join(f"{name} {array.shape}" for name, array in zip(COLUMNS, arrays, strict=True))
            raise InputError("sections", found=found, expected="four arrays (sections, stations) of one shape")
        if bad := [name for name, array in zip(COLUMNS, arrays, strict=True) if not np.isfinite(array).all()]:
            raise InputError("sections", found=f"nan or inf in {bad[0]}", expected="finite numbers")
        parts = list(zip(*arrays, strict=True))
        return built(parts, [np.zeros(len(part[0]), dtype=np.int64) for part in parts], (), "sections")

    def __repr__(self) -> str:
        stations = sorted({surface.shape[1] for surface in self.surfaces})
        count = f"{stations[0]}" if len(stations) == 1 else f"{stations[0]} to {stations[-1]}"
        radii = [np.hypot(*ends.reshape(-1, 3)[:, :2].T) for ends in (self.surfaces[0], self.surfaces[-1])]
        edges = {(True, True): "closed at both edges", (False, False): "open at both edges"}
        words = edges.get(self.closed, f"closed at the {'first' if self.closed[0] else 'last'} edge alone")
        spread = f"radius {radii[0].min():.4g} to {radii[1].max():.4g} m"
        return f"BladeSections({len(self.surfaces)} sections of {count} stations, {spread}, {words})"

    def mesh(self, cells: Sequence[int] = (24, 20, 1)) -> MeshData:
        """Bricks of 20 nodes: `cells` along chord, span and thickness; wedges at closed edges; groups root and tip.

        Parameters
        ----------
        cells
            Numbers of cells along the chord (2 or more), the span and the thickness. Cells along the chord are smaller
            towards both edges, as the cosine of equal angles.

        Raises
        ------
        ModelError
            `sections-cells` for numbers of cells that are out of range.
        """
        from casingfem.structure.imported.section_mesh import section_mesh

        return section_mesh(self, cells)

    def sector(self, sectors: int, disk: DiskRing, cells: Sequence[int] = (24, 20, 1)) -> MeshData:
        """One sector of a wheel: the blade on the ring of a disk, in bricks of 20 nodes; wedges at both edges.

        The faces of the sector follow the camber of the root section, so the root may be wider around than the pitch.
        The groups are low and high (the faces), front, rear, bore and tip, and blade, the cells outside the ring.

        Parameters
        ----------
        sectors
            Number of blades of the wheel.
        disk
            The ring: its bore, its length before and behind the blade, and its cells.
        cells
            Numbers of cells of the blade along chord, span and thickness, as in `mesh`.

        Raises
        ------
        ModelError
            `sections-cells` for numbers of cells that are out of range; `sections-disk` for a bore that does not lie
            below the root, for a root thicker than the pitch, and for an open edge.

        Examples
        --------
        >>> import casingfem as cf
        >>> from casingfem.examples import DATA
        >>> blade = cf.imported.BladeSections.from_csv(DATA / "scenes" / "rotor37" / "sections.csv")
        >>> disk = cf.imported.DiskRing(bore=0.12, front=0.004, rear=0.004)
        >>> mesh = blade.sector(36, disk, cells=(8, 6, 1))
        >>> mesh.groups["low"].nodes.size, mesh.groups["high"].nodes.size
        (117, 117)
        """
        from casingfem.structure.imported.sector_mesh import sector_mesh

        return sector_mesh(self, cells, sectors, disk)


def numbers(table: StrictCsv) -> dict[str, FloatArray]:
    """Columns by quantity, in metres and radians; one error lists every problem."""
    found, wrong = dict[str, FloatArray](), list[InputError]()
    for quantity, names in COLUMNS.items():
        here = [name for name in table.header if name in names]
        try:
            if len(here) != 1:
                what = f"{' and '.join(here)}" if here else f"no such column among {','.join(table.header)}"
                raise table.refuse_header(found=what, expected=f"one column {' or '.join(names)}")
            found[quantity] = table.numbers(here[0]) * names[here[0]]
        except InputError as error:
            wrong.append(error)
    if "section" not in table.header:
        among = f"no such column among {','.join(table.header)}"
        wrong.append(table.refuse_header(found=among, expected="a column section, the number of each row's section"))
    if wrong:
        raise together(wrong)
    return found


def sections_of(table: StrictCsv) -> list[IntArray]:
    """Rows of each section in the order of the file, from root to tip."""
    number = table.integers("section")
    starts = np.flatnonzero(np.diff(number, prepend=number[0] - 1))
    back = starts[1:][np.diff(number[starts]) <= 0]
    if len(back):
        row = int(back[0])
        found, expected = f"section {number[row]} after section {number[row - 1]}", "sections in ascending order"
        raise table.refuse(row=row, column="section", found=found, expected=expected)
    return np.split(np.arange(len(number)), starts[1:])


def check_units(table: StrictCsv, columns: dict[str, FloatArray]) -> None:
    """Refuse radii and angles whose size suggests another unit."""
    written = {quantity: next(name for name in table.header if name in names) for quantity, names in COLUMNS.items()}
    wrong = []
    mean = float(np.abs(columns["r"]).mean())
    if not RADII[0] <= mean <= RADII[1]:
        other = "r_mm" if written["r"] == "r_m" else "r_m"
        expected = f"{RADII[0]:g} to {RADII[1]:g} m; are these values those of a column {other}?"
        wrong.append(
            table.refuse_header(column=written["r"], found=f"a mean radius of {mean:.4g} m", expected=expected)
        )
    for quantity in ("theta_1", "theta_2"):
        far = np.flatnonzero(np.abs(columns[quantity]) > TURN)
        if len(far):
            found = f"{columns[quantity][far[0]]:g} rad"
            expected = f"at most 2 pi rad; are these degrees (a column {quantity}_deg)?"
            wrong.append(table.refuse(row=int(far[0]), column=written[quantity], found=found, expected=expected))
    if wrong:
        raise together(wrong)


def built(
    parts: Sequence[Sequence[FloatArray]], lines: Sequence[IntArray], card: tuple[str, ...], source: str
) -> BladeSections:
    """Sections from their columns z, r, theta_1, theta_2, after checks; `lines` of the file, or 0."""
    wrong = list[InputError]()
    if len(parts) < LEAST_SECTIONS:
        found = f"{len(parts)} section{'s'[: len(parts) != 1]}"
        wrong.append(InputError(source, found=found, expected=f"at least {LEAST_SECTIONS}, from root to tip"))
    for number, (part, at) in enumerate(zip(parts, lines, strict=True), 1):
        wrong += problems(number, part, at, source)
    if wrong:
        raise together(wrong)
    meets = np.array([closed_ends(part) for part in parts])
    for end, name in enumerate(("first", "last")):
        if meets[:, end].any() and not meets[:, end].all():
            open_ones = ", ".join(str(k + 1) for k in np.flatnonzero(~meets[:, end]))
            found = f"surfaces that meet at the {name} station of some sections, but not of {open_ones}"
            wrong.append(
                InputError(source, found=found, expected="surfaces that meet there in all sections, or in none")
            )
    if wrong:
        raise together(wrong)
    closed = (bool(meets[0, 0]), bool(meets[0, 1]))
    forward = sum(float((part[3] - part[2]).sum()) for part in parts) > 0.0
    surfaces = tuple(frozen(oriented(placed(part, closed), forward)) for part in parts)
    return BladeSections(surfaces=surfaces, closed=closed, card=card, source=source)


def problems(number: int, part: Sequence[FloatArray], lines: IntArray, source: str) -> list[InputError]:
    """Faults of one section."""
    z, r, first, second = part
    where = f"section {number}"

    def wrong(row: int, found: str, expected: str) -> InputError:
        return InputError(source, line=int(lines[row]) or None, where=where, found=found, expected=expected)

    if len(z) < LEAST_STATIONS:
        return [wrong(0, f"{len(z)} stations", f"at least {LEAST_STATIONS} stations, from one edge to the other")]
    found = [wrong(int(row), f"a radius of {r[row]:g} m", "a radius above 0") for row in np.flatnonzero(r <= 0.0)[:1]]
    middle = np.stack([z, r, r * 0.5 * (first + second)], axis=1)
    step = np.linalg.norm(np.diff(middle, axis=0), axis=1)
    for row in np.flatnonzero(step <= 1e-9 * step.sum())[:1]:
        found.append(wrong(int(row) + 1, "the place of the station before", "a station farther along the chord"))
    thick = r * (second - first)
    size = np.abs(thick).max()
    sign = np.sign(thick.sum())
    for row in np.flatnonzero(sign * thick < -CLOSED * size)[:1]:
        cross = f"surfaces that cross, with a thickness of {1e3 * sign * thick[row]:.4g} mm"
        found.append(wrong(int(row), cross, "each surface on the same side at all stations"))
    inner = np.abs(thick[1:-1]) <= CLOSED * size
    for row in np.flatnonzero(inner)[:1]:
        found.append(wrong(int(row) + 1, "surfaces that meet between the edges", "a thickness above 0 there"))
    return found


def closed_ends(part: Sequence[FloatArray]) -> tuple[bool, bool]:
    """Whether the surfaces of a section meet at its ends."""
    thick = np.abs(part[1] * (part[3] - part[2]))
    return bool(thick[0] <= CLOSED * thick.max()), bool(thick[-1] <= CLOSED * thick.max())


def placed(part: Sequence[FloatArray], closed: tuple[bool, bool]) -> FloatArray:
    """Points of both surfaces, (2, stations, 3); at a closed edge both surfaces get the same point."""
    z, r = part[:2]
    surfaces = np.array([np.stack([r * np.cos(theta), r * np.sin(theta), z], axis=1) for theta in part[2:]])
    for end, meets in ((0, closed[0]), (-1, closed[1])):
        if meets:
            surfaces[:, end] = surfaces[:, end].mean(axis=0)
    return surfaces


def oriented(surfaces: FloatArray, forward: bool) -> FloatArray:
    """The two surfaces in the order of growing angle."""
    return surfaces if forward else surfaces[::-1]
