"""Interfaces: which displacements of a structure contact sees, by the names of their channels."""

from dataclasses import dataclass
from typing import TypeAlias

from casingfem.errors import ModelError


@dataclass(frozen=True, slots=True)
class Rim:
    """An edge of a casing, or lines around its wall, radial and tangential, by Fourier amplitudes up to n_max.

    u(theta) = sum_n c_n cos n theta + s_n sin n theta. A force at one angle reaches the shell through the same
    band: it acts on an arc of about 2 pi r/(2 n_max), which keeps its compliance finite as the mesh is
    refined (a point force on a shear-deformable edge would sink in without limit).

    `axial` adds the motion along the axis. `lines`: places of the chart's first parameter (z of a frustum) of one or
    several lines around in place of the edge, for a track inside the casing or blades whose tips are long in that
    direction; `edge` is then not needed. `axis` through `point`: of an
    imported part, whose edge is a group of facets; a chart's axis is z.

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
            `interface-edge` where there is neither.
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
        """Names of all channels: direction by direction, line by line where there are several."""
        one = [f"{direction}.{name}" for direction in self.directions for name in self.names]
        count = len(self.lines)
        return tuple(one) if count < 2 else tuple(f"line{k}.{name}" for k in range(count) for name in one)


@dataclass(frozen=True, slots=True)
class Tip:
    """The tip edge of a blade as one place: mean displacement along the blade (span) and across it (flap).

    span points from the root to the tip, flap along the surface normal at mid-edge; on a group of facets of an imported
    part as `mesh_rows.tip_frame` states.

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

    The directions are those of `Tip` at mid-edge, chord along the edge. Pieces of the edge and not points: a point
    force on a shear-deformable edge would sink in without limit.

    `axis` through `point`, of an imported part: the directions are those of the machine at each piece, span along the
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
    """Nodes of an imported part by the numbers its file gives them: displacements along x, y, z of each.

    A force at a node of a solid or shell sinks in further the finer the mesh is; with the pieces of `TipNodes` the
    compliance has a limit.

    >>> AtNodes((6, 79)).channels
    ('6.x', '6.y', '6.z', '79.x', '79.y', '79.z')
    """

    nodes: tuple[int, ...]

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels, node by node."""
        return tuple(f"{number}.{axis}" for number in self.nodes for axis in "xyz")


Interface: TypeAlias = Rim | Tip | TipNodes | AtNodes
