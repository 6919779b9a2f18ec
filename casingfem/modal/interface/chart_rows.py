"""Interfaces of a shell on a chart: rows over its nodal fields, and the out-of-roundness and thickness of a rim."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.modal.interface.kinds import AtNodes, Interface, Rim, Tip, TipNodes
from casingfem.structure.geometry.chart import Chart
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.mesh.place import interpolation, ring_transform
from casingfem.structure.shell.parts import ShellGeometry
from casingfem.structure.shell.shell import Shell, require_shell
from casingfem.structure.shell.system import System

LEAST = 64  # angles at which the radius is read
CIRCLE = 1e-6  # rad, and parts of the radius: how far a rim may leave a plane circle about z
ROUND_OFF = 1e-14  # of the radius


def interface_rows(system: System, interface: Interface) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (channels, 5 nodes) of any interface, and its channel names."""
    if isinstance(interface, AtNodes):
        found = f"nodes {', '.join(map(str, interface.nodes))} of a chart, whose nodes have no numbers"
        raise ModelError("interface-nodes", f"at: found {found}")
    if isinstance(interface, Rim):
        if (interface.axis, interface.point) != ((0.0, 0.0, 1.0), (0.0, 0.0, 0.0)):
            raise ModelError(
                "interface-edge",
                f"rim: found the axis {interface.axis} through {interface.point}, expected z on a chart",
            )
        return rim_rows(system, interface)
    return tip_rows(system, interface) if isinstance(interface, Tip) else node_rows(system, interface)


def rim_rows(system: System, rim: Rim) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (channels, 5 nodes) of a rim, and the channel names: radial, then tangential."""
    grid, chart = system.grid, system.shell.chart
    if not chart.periodic or not (rim.lines or rim.edge in chart.edges):
        raise ModelError("interface-edge", f"rim: expected a closed casing with {rim.where}{found_edges(chart)}")
    around = grid.mesh.order * grid.mesh.columns
    if not 0 < rim.n_max <= around // 3:
        found = f"rim.n_max must lie between 1 and {around // 3} on this mesh, found {rim.n_max}"
        raise ModelError("interface-harmonics", found)
    require_circles(system.shell, rim)
    theta = grid.nodes[1]
    c, s, one, none = np.cos(theta), np.sin(theta), np.ones_like(theta), np.zeros_like(theta)
    unit = np.array([[c, s, none], [-s, c, none], [none, none, one]])[: len(rim.directions)]
    rows = np.zeros((max(len(rim.lines), 1), len(unit), 2 * rim.n_max + 1, theta.size, DOFS))
    for line, transform in zip(rows, line_transforms(system, rim), strict=True):
        real = np.concatenate([transform.real, -transform.imag[1:]])
        line[..., :3] = np.einsum("hn,din->dhni", real, unit)
    return rows.reshape(-1, theta.size * DOFS), rim.channels


def require_lines(chart: Chart, lines: Sequence[float]) -> None:
    """Refuse lines outside a chart, or given twice.

    Raises
    ------
    ModelError
        `interface-lines`.
    """
    low, high = np.real(chart.bounds[0])
    off = [at for at in lines if not low <= at <= high]
    if off or len(set(lines)) < len(lines):
        found = ", ".join(f"{at:g}" for at in off or lines)
        expected = f"places from {low:g} to {high:g} m, once each"
        raise ModelError("interface-lines", f"lines: found {found} m, expected {expected}")


def found_edges(chart: Chart) -> str:
    """Edges of a chart that is not a closed casing, in words."""
    return f", found one with {', '.join(chart.edges)}" if chart.periodic else ", found an open chart"


def require_circles(shell: Shell, rim: Rim) -> None:
    """Refuse lines of a chart that are not circles around z with the second parameter as angle.

    Raises
    ------
    ModelError
        `interface-circle`.
    """
    theta = 2.0 * np.pi * np.arange(LEAST) / LEAST
    turn = np.exp(-1j * theta)
    for on in rim_geometry(shell, rim, LEAST):
        x, y, z = np.real(on.surface.x)
        off = float(np.abs(np.angle((x + 1j * y) * turn)).max())
        height = float(np.ptp(z) / np.hypot(x, y).mean())
        if max(off, height) > CIRCLE:
            found = f"found angles {off:.2g} rad from the chart's second parameter, heights {height:.2g} radii apart"
            raise ModelError("interface-circle", f"rim: {rim.where}: {found}, expected a plane circle about z")


def line_transforms(system: System, rim: Rim) -> list[Array]:
    """Transforms (n_max + 1, nodes) from nodal values to Fourier amplitudes, on the edge or on each of the lines."""
    grid, chart = system.grid, system.shell.chart
    if not rim.lines:
        _, transform = ring_transform(chart, grid, rim.n_max)
        full = np.zeros((rim.n_max + 1, grid.nodes.shape[1]), dtype=complex)
        full[:, grid.edges[rim.edge].nodes] = transform
        return [full]
    require_lines(chart, rim.lines)
    samples = 8 * grid.mesh.order * grid.mesh.columns
    theta = 2.0 * np.pi * np.arange(samples) / samples
    kernel = np.exp(-1j * np.outer(np.arange(rim.n_max + 1), theta)) / samples
    kernel[1:] *= 2.0
    found = []
    for place in rim.lines:
        nodes, weights = interpolation(grid, np.full(samples, place), theta)
        spread = np.zeros((samples, grid.nodes.shape[1]))
        np.add.at(spread, (np.arange(samples)[:, None], nodes), weights)
        found.append(kernel @ spread)
    return found


def rim_geometry(shell: Shell, rim: Rim, count: int) -> list[ShellGeometry]:
    """The wall on each line of a rim, at `count` angles evenly around."""
    places, theta = rim.lines, 2.0 * np.pi * np.arange(count) / count
    if not places:
        held, side = shell.chart.edges[rim.edge]
        places = (shell.chart.bounds[held][side],)
    return [shell.geometry(np.full(count, place), theta) for place in places]


def rim_lines(shell: Shell, rim: Rim) -> FloatArray:
    """Axial position and mean radius of each line of a rim [m], (lines, 2)."""
    on_lines = [on.surface.x for on in rim_geometry(shell, rim, LEAST)]
    return np.array([[float(x[2].mean()), float(np.hypot(x[0], x[1]).mean())] for x in on_lines])


def tip_rows(system: System, tip: Tip) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (2, 5 nodes) of a blade tip: span and flap, averaged over the edge's length."""
    grid, directions = system.grid, tip_directions(system, tip)
    edge = grid.edges[tip.edge]
    weights = edge.arc(system.shell.geometry(*grid.nodes[:, edge.nodes]).surface)
    weights = weights / weights.sum()
    rows = np.zeros((2, grid.nodes.shape[1], DOFS))
    rows[:, edge.nodes, :3] = weights[:, None] * directions[:2, None]
    return rows.reshape(2, -1), ("span", "flap")


def tip_directions(system: System, tip: Tip | TipNodes) -> FloatArray:
    """Span, flap and chord at the middle of a tip edge, (3, 3) unit rows; chord along the edge, normal to the others.

    Raises ModelError if there is no such edge.
    """
    grid, shell = system.grid, system.shell
    if shell.chart.periodic or tip.edge not in grid.edges:
        raise ModelError(
            "interface-edge", f"tip: found no edge {tip.edge!r}, expected an edge of an open panel or blade"
        )
    edge = grid.edges[tip.edge]
    surface = shell.geometry(*grid.nodes[:, edge.nodes]).surface
    middle = len(edge.nodes) // 2
    across, along = (surface.x1, surface.x2) if edge.along == 1 else (surface.x2, surface.x1)
    span, flap = across[:, middle] / np.linalg.norm(across[:, middle]), frame(surface).normal[:, middle]
    chord = np.cross(flap, span)
    return np.array([span, flap, chord * np.sign(chord @ along[:, middle])])


def node_rows(system: System, tip: TipNodes) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (3 count, 5 nodes) of the pieces of a blade's tip, averaged over equal lengths of the edge."""
    if not 1 <= tip.count <= 100:
        raise ModelError("interface-nodes", f"TipNodes.count must lie between 1 and 100, found {tip.count!r}")
    if tip.axis is not None:
        found = f"TipNodes: found axis = {tip.axis} on a chart, expected it on an imported part"
        raise ModelError("interface-axis", found)
    directions, grid, shell = tip_directions(system, tip), system.grid, system.shell
    edge, (held, side) = grid.edges[tip.edge], shell.chart.edges[tip.edge]

    def places(along: FloatArray) -> tuple[FloatArray, FloatArray]:
        at = np.full(along.size, shell.chart.bounds[held][side])
        return (at, along) if edge.along == 1 else (along, at)

    def speed(along: FloatArray) -> FloatArray:
        surface = shell.geometry(*places(along)).surface
        return np.asarray(np.linalg.norm(surface.x2 if edge.along == 1 else surface.x1, axis=0))

    fine = np.linspace(*shell.chart.bounds[edge.along], 2001)
    length = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(fine) * (speed(fine)[1:] + speed(fine)[:-1]))))
    ends = np.interp(np.linspace(0.0, length[-1], tip.count + 1), length, fine)
    x, w = np.polynomial.legendre.leggauss(2 * grid.mesh.order + 8)
    rows = np.zeros((tip.count, 3, grid.nodes.shape[1], DOFS))
    for k, (a, b) in enumerate(pairwise(ends)):
        along = 0.5 * (a + b) + 0.5 * (b - a) * x
        weights = w * speed(along)
        nodes, values = interpolation(grid, *places(along))
        mean = np.zeros(grid.nodes.shape[1])
        np.add.at(mean, nodes, (weights / weights.sum())[:, None] * values)
        rows[k, :, :, :3] = directions[:, None, :] * mean[None, :, None]
    return rows.reshape(3 * tip.count, -1), tip.channels


def rim_shape(shell: Shell, rim: Rim) -> FloatArray:
    """Deviation of each line's radius from its mean [m], d(theta) = sum_n c_n cos n theta + s_n sin n theta.

    Columns as the channels of a rim: cos0 .. cosN, sin1 .. sinN, N = `rim.n_max`; (lines, 2 N + 1). Round-off is zero.
    """
    N = rim.n_max
    count = max(LEAST, 4 * N)
    found = []
    for on in rim_geometry(shell, rim, count):
        radius = np.hypot(*on.surface.x[:2])
        waves = 2.0 * np.fft.rfft(radius - radius.mean())[: N + 1] / count
        waves[np.abs(waves) < ROUND_OFF * radius.mean()] = 0.0
        waves[0] = 0.0
        found.append(np.concatenate([waves.real, -waves.imag[1:]]))
    return np.array(found)


def rim_thickness(shell: Shell, rim: Rim) -> FloatArray:
    """Least thickness of the wall on each line of a rim [m], (lines,), which limits the linear model."""
    return np.array([float(np.real(on.thickness).min()) for on in rim_geometry(shell, rim, LEAST)])


def out_of_roundness(casing: Shell, rim: Rim, *, line: int = 0) -> list[dict[str, float]]:
    """The rim's deviation from a circle in the form for contact: terms {p, cos, sin} [m], p from 1 to n_max.

    It is positive where the radius is larger. `cf.reduce` stores the same in the basis, for scenes with
    `out_of_roundness = "basis"`.

    Parameters
    ----------
    casing
        A shell whose radius field comes from a survey, harmonics, or a draw.
    rim
        Edge or lines, and the highest harmonic `n_max`.
    line
        Index of the rim's line.

    Raises
    ------
    ModelError
        If the rim has no such line.

    Examples
    --------
    >>> import casingfem as cf
    >>> steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.2), thickness=3e-3, material=steel,
    ...                   supports={"base": cf.Clamped()}, radius_defect=cf.FourierField.of({3: 1e-3}))
    >>> terms = cf.modal.out_of_roundness(casing, cf.Rim("top", n_max=4))
    >>> [(term["p"], round(term["cos"], 9)) for term in terms]
    [(3, 0.0005)]
    """
    require_shell(casing, "out_of_roundness")
    shapes = rim_shape(casing, rim)
    if not 0 <= line < len(shapes):
        raise ModelError("interface-lines", f"line must lie between 0 and {len(shapes) - 1} here, found {line!r}")
    c, N = shapes[line], rim.n_max
    return [{"p": p, "cos": float(c[p]), "sin": float(c[N + p])} for p in range(1, N + 1) if c[p] or c[N + p]]
