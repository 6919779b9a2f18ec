"""Interfaces of a shell on a chart: rows over its nodal fields."""

from itertools import pairwise

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.modal.interface.kinds import AtNodes, Interface, Rim, Tip, TipNodes
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.mesh.place import interpolation, ring_transform
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System


def interface_rows(system: System, interface: Interface) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (channels, 5 nodes) of any interface, and its channel names."""
    if isinstance(interface, AtNodes):
        found = f"nodes {', '.join(map(str, interface.nodes))} of a chart, whose nodes have no numbers"
        raise ModelError("interface-nodes", f"at: found {found}")
    if isinstance(interface, Rim):
        if (interface.axis, interface.point) != ((0.0, 0.0, 1.0), (0.0, 0.0, 0.0)):
            raise ModelError("interface-edge", "a Rim of a chart turns about z, found another axis")
        return rim_rows(system, interface)
    return tip_rows(system, interface) if isinstance(interface, Tip) else node_rows(system, interface)


def rim_rows(system: System, rim: Rim) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (channels, 5 nodes) of a rim, and the channel names: radial, then tangential."""
    grid, chart = system.grid, system.shell.chart
    if not chart.periodic or rim.edge not in grid.edges:
        raise ModelError("interface-edge", f"a Rim needs a closed casing with an edge {rim.edge!r}")
    around = grid.mesh.order * grid.mesh.around
    if not 0 < rim.n_max <= around // 3:
        raise ModelError(
            "interface-harmonics", f"rim.n_max must lie between 1 and {around // 3} on this mesh, found {rim.n_max}"
        )
    theta = grid.nodes[1]
    c, s, one, none = np.cos(theta), np.sin(theta), np.ones_like(theta), np.zeros_like(theta)
    unit = np.array([[c, s, none], [-s, c, none], [none, none, one]])[: len(rim.directions)]
    rows = np.zeros((max(len(rim.lines), 1), len(unit), 2 * rim.n_max + 1, theta.size, DOFS))
    for line, transform in zip(rows, line_transforms(system, rim), strict=True):
        real = np.concatenate([transform.real, -transform.imag[1:]])
        line[..., :3] = np.einsum("hn,din->dhni", real, unit)
    return rows.reshape(-1, theta.size * DOFS), rim.channels


def line_transforms(system: System, rim: Rim) -> list[Array]:
    """Transforms (n_max + 1, nodes) of nodal values to Fourier amplitudes, on the edge or on each of the lines."""
    grid, chart = system.grid, system.shell.chart
    if not rim.lines:
        _, transform = ring_transform(chart, grid, rim.n_max)
        full = np.zeros((rim.n_max + 1, grid.nodes.shape[1]), dtype=complex)
        full[:, grid.edges[rim.edge].nodes] = transform
        return [full]
    low, high = chart.bounds[0]
    if min(rim.lines) < low or max(rim.lines) > high:
        raise ModelError("interface-lines", f"rim.lines: found {rim.lines}, expected places from {low:g} to {high:g}")
    samples = 8 * grid.mesh.order * grid.mesh.around
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


def rim_places(shell: Shell, rim: Rim) -> tuple[float, ...]:
    """The first parameter of the chart on each line of a rim."""
    if rim.lines:
        return rim.lines
    held, side = shell.chart.edges[rim.edge]
    return (shell.chart.bounds[held][side],)


def rim_lines(system: System, rim: Rim) -> FloatArray:
    """Axial place and mean radius of each line of a rim [m], (lines, 2)."""
    theta = 2.0 * np.pi * np.arange(64) / 64
    found = []
    for place in rim_places(system.shell, rim):
        x = system.shell.geometry(np.full(64, place), theta).surface.x
        found.append([float(x[2].mean()), float(np.hypot(x[0], x[1]).mean())])
    return np.array(found)


def tip_rows(system: System, tip: Tip) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (2, 5 nodes) of a blade tip: span and flap, averaged over the edge's length."""
    grid, (span, flap, _) = system.grid, tip_directions(system, tip)
    edge = grid.edges[tip.edge]
    weights = edge.arc(system.shell.geometry(*grid.nodes[:, edge.nodes]).surface)
    weights = weights / weights.sum()
    rows = np.zeros((2, grid.nodes.shape[1], DOFS))
    rows[0, edge.nodes, :3] = weights[:, None] * span
    rows[1, edge.nodes, :3] = weights[:, None] * flap
    return rows.reshape(2, -1), ("span", "flap")


def tip_directions(system: System, tip: Tip | TipNodes) -> FloatArray:
    """Span, flap and chord at the middle of a tip edge, (3, 3) unit rows; chord along the edge, square to the others.

    Raises ModelError where there is no such edge.
    """
    grid, shell = system.grid, system.shell
    if shell.chart.periodic or tip.edge not in grid.edges:
        raise ModelError("interface-edge", f"a Tip needs an open panel or plate with an edge {tip.edge!r}")
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
