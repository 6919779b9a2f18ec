"""Interfaces: the displacements of a structure at contact, by the names of their channels."""

from dataclasses import dataclass
from typing import TypeAlias

from casingfem.errors import ModelError


@dataclass(frozen=True, slots=True)
class Rim:
    """An edge of a casing, or lines around its wall, radial and tangential, by Fourier amplitudes up to n_max.

    u(theta) = sum_n c_n cos n theta + s_n sin n theta. A force at one angle acts on the shell through the same
    harmonics, so on an arc of about 2 pi r/(2 n_max), which keeps its compliance finite as the mesh is refined (under a
    point force the deflection of a shear-deformable edge would grow without limit).

    `axial` adds the motion along the axis. `lines`: values of the chart's first parameter (z of a frustum) for one or
    several lines around instead of the edge, for a track inside the casing or for blades with long tips; `edge` is then
    not needed. `axis` through `point`: for an imported part, whose edge is a group of facets; a chart's axis is z.

    >>> Rim("top", n_max=2).names
    ('cos0', 'cos1', 'cos2', 'sin1', 'sin2')
    >>> Rim(lines=(0.7,), n_max=2).where
    'a line at 0.7 m'
    """

    edge: str = ""
    n_max: int = 40
    axial: bool = False
    lines: tuple[float, ...] = ()
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def where(self) -> str:
        """The edge or the lines, in words.

        Raises
        ------
        ModelError
            `interface-edge` if there is neither.
        """
        if self.lines:
            return f"{'a line' if len(self.lines) == 1 else 'lines'} at {', '.join(f'{at:g}' for at in self.lines)} m"
        if not self.edge:
            raise ModelError("interface-edge", "rim: found neither an edge nor lines, expected one of them")
        return repr(self.edge)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the harmonics of one direction."""
        n = range(1, self.n_max + 1)
        return ("cos0", *(f"cos{k}" for k in n), *(f"sin{k}" for k in n))

    @property
    def directions(self) -> tuple[str, ...]:
        """Directions of motion, radial first."""
        return ("radial", "tangential", "axial") if self.axial else ("radial", "tangential")

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of all channels: direction by direction, line by line if there are several."""
        one = [f"{direction}.{name}" for direction in self.directions for name in self.names]
        count = len(self.lines)
        return tuple(one) if count < 2 else tuple(f"line{k}.{name}" for k in range(count) for name in one)


@dataclass(frozen=True, slots=True)
class Tip:
    """The tip edge of a blade as one point: mean displacement along the blade (span) and across it (flap).

    span points from the root to the tip, flap along the surface normal at mid-edge; on a group of facets of an imported
    part see `mesh_rows.tip_frame`.

    >>> Tip().edge, Tip("tip").channels
    ('tip', ('span', 'flap'))
    """

    edge: str = "tip"

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels."""
        return ("span", "flap")


@dataclass(frozen=True, slots=True)
class TipNodes:
    """The tip edge of a blade in `count` equal pieces: mean displacement of each along span, flap and chord.

    The directions are those of `Tip` at mid-edge, chord along the edge. Pieces of the edge are used, not points, since
    the deflection of a shear-deformable edge under a point force has no limit.

    `axis` through `point`, for an imported part: the directions are those of the machine at each piece, span along the
    radius, flap along growing angles about the axis, chord along the axis. Pieces are counted along the axis. A
    staggered blade needs them: its own flap is neither tangential nor axial.

    >>> TipNodes(count=2).channels[:4]
    ('node0.span', 'node0.flap', 'node0.chord', 'node1.span')
    """

    edge: str = "tip"
    count: int = 5
    axis: tuple[float, float, float] | None = None
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels, node by node."""
        return tuple(f"node{k}.{name}" for k in range(self.count) for name in ("span", "flap", "chord"))


@dataclass(frozen=True, slots=True)
class AtNodes:
    """Nodes of an imported part by their numbers in its file: displacements along x, y, z of each.

    The compliance at a node of a solid or shell grows without limit as the mesh is refined; with the pieces of
    `TipNodes` it converges.

    >>> AtNodes((6, 79)).channels
    ('6.x', '6.y', '6.z', '79.x', '79.y', '79.z')
    """

    nodes: tuple[int, ...]

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels, node by node."""
        return tuple(f"{number}.{axis}" for number in self.nodes for axis in "xyz")


Interface: TypeAlias = Rim | Tip | TipNodes | AtNodes
