"""Modes of a perfect casing: one dense meridian problem for each number of nodal diameters, with exact doublets."""

import time
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh, eigvalsh_tridiagonal, ldl

from casingfem.errors import NumericsError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.eigen import gap_after
from casingfem.linalg.pencil import clear_of_eigenvalues, round_off, warn_of_count
from casingfem.linalg.slicing import CLEAR
from casingfem.modal.mode_set import Modes, frequency_scale, labelled
from casingfem.structure.edge.ring import Ring
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.mesh.shell_mesh import Grid, make_grid
from casingfem.structure.shell.axisymmetric import HOOP, Meridian, harmonic_matrices
from casingfem.structure.shell.edges import outward, ties
from casingfem.structure.shell.parts import sampled_geometry
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.wall import section
from contact.io.progress import tell

SHIFT = 0.5  # shift-invert about minus the square of this part of `frequency_scale`
DROWNED = 0.1  # round-off of more than this part of an eigenvalue that no rigid motion has


class Found(NamedTuple):
    """One mode.

    Omega^2, nodal diameters, cosine or sine member, meridian shape, rotations of rings, round-off of omega^2.
    """

    value: float
    n: int
    sine: bool
    shape: FloatArray
    turns: FloatArray
    noise: float


def fourier_modes(shell: Shell, count: int) -> Modes:
    """Lowest modes of a perfect casing, by one dense meridian problem for each n, with exact doublets.

    n increases until `harmonic_floor` alone is above the band, since frequencies decrease with n before they increase,
    and a low n = 0 or 1 may precede a higher minimum. Then the inertia of every harmonic at one shift checks the count.

    Raises
    ------
    NumericsError
        If the inertia disagrees with what was found.

    Warns
    -----
    ModelWarning
        `modes-round-off` if the inertia cannot show it.
    """
    started = time.perf_counter()
    shift = (SHIFT * frequency_scale(shell)) ** 2
    meridians: list[Meridian] = []
    found: list[Found] = []
    limit = np.inf
    while len(found) < count or harmonic_floor(shell, len(meridians)) <= limit:
        tell_harmonic(shell, len(meridians), limit)
        meridian = harmonic_matrices(shell, len(meridians))
        meridians.append(meridian)
        values, vectors = lowest(meridian, count + 1, shift)
        found += members(meridian, values, vectors)
        found.sort(key=lambda item: item[:3])
        found = found[: count + 4]
        limit = max(found[min(count, len(found)) - 1].value, 0.0)  # rigid motions may come out just below zero
    values, noise = np.array([(mode.value, mode.noise) for mode in found]).T
    last = min(count, len(found) - 1)
    below, sigma = gap_after(values, last, noise=noise[last - 1 :].max())
    drowned = [mode.value for mode in found[:below] if mode.n > 1 and mode.noise > DROWNED * mode.value]
    if drowned or not clear_of_eigenvalues(sigma, values, noise):
        warn_of_count(drowned[-1] if drowned else sigma, values, noise)
        return revolved(shell, meridians, found[:below], count, None, started)
    counted = sum((1 + (m.n > 0)) * inertia_below(m, sigma) for m in meridians)
    if counted != below:
        raise NumericsError(f"{counted} modes lie below {np.sqrt(sigma) / 2 / np.pi:.6g} Hz, {below} were found")
    return revolved(shell, meridians, found[:below], count, counted, started)


def fourier_band(shell: Shell, band: tuple[float, float]) -> Modes:
    """Every mode of a perfect casing in a band [Hz]; the inertia at both ends counts those of each harmonic.

    Raises
    ------
    NumericsError
        If the number of modes found in a harmonic differs from its count.

    Warns
    -----
    ModelWarning
        `modes-round-off` if the inertia cannot show it.
    """
    started = time.perf_counter()
    shift = (SHIFT * frequency_scale(shell)) ** 2
    low, high = ((2.0 * np.pi * f) ** 2 * (1.0 + way * CLEAR) for f, way in zip(band, (-1.0, 1.0), strict=True))
    low = low if band[0] > 0.0 else -shift
    meridians: list[Meridian] = []
    found: list[Found] = []
    counted = True
    while harmonic_floor(shell, len(meridians)) <= high:
        tell_harmonic(shell, len(meridians), high)
        meridian = harmonic_matrices(shell, len(meridians))
        meridians.append(meridian)
        start, end = (inertia_below(meridian, sigma) for sigma in (low, high))
        values, vectors = lowest(meridian, end + 1, shift)  # the next above the band too: it may reach the end
        inside = (values > low) & (values < high)
        noise = round_off(meridian.K, vectors)
        above = (place for place in (low, high) if place > 0.0)
        reached = [place for place in above if not clear_of_eigenvalues(place, values, noise)]
        if reached and counted:
            warn_of_count(reached[-1], values, noise)
        counted = counted and not reached
        if not reached and np.count_nonzero(inside) != end - start:
            raise NumericsError(f"n = {meridian.n}: {end - start} modes lie in the band, {inside.sum()} were found")
        found += members(meridian, values[inside], vectors[:, inside])
    found.sort(key=lambda item: item[:3])
    return revolved(shell, meridians, found, len(found), len(found) if counted else None, started)


def tell_harmonic(shell: Shell, n: int, limit: float) -> None:
    """Report n and its share of the last n to the progress listener: the floor rises as n^4 up to `limit`."""
    share = (harmonic_floor(shell, n) / limit) ** 0.25 if 0.0 < limit < np.inf else None
    tell(f"n = {n}", None if share is None else min(share, 0.99))


def members(meridian: Meridian, values: FloatArray, vectors: FloatArray) -> list[Found]:
    """The modes of one harmonic, cosine and sine if n > 0."""
    n, both = meridian.n, (False, True) if meridian.n else (False,)
    shapes, own, noise = meridian.expand(vectors), meridian.expand_own(vectors), round_off(meridian.K, vectors)
    return [
        Found(float(value), n, sine, shapes[:, :, k], own[:, k], float(noise[k]))
        for k, value in enumerate(values)
        for sine in both
    ]


def revolved(
    shell: Shell, meridians: list[Meridian], found: list[Found], count: int, counted: int | None, started: float
) -> Modes:
    """Spread meridian shapes around and label them."""
    shell = resolving(shell, max((mode.n for mode in found), default=0))
    grid = make_grid(shell.chart, shell.mesh, shell.stations)
    freq = np.sqrt(np.maximum([mode.value for mode in found], 0.0)) / (2.0 * np.pi)
    fields = np.empty((grid.nodes.shape[1], DOFS, len(found)))
    own = np.empty((ring_nodes(shell, grid).size, len(found)))
    for k, mode in enumerate(found):
        fields[:, :, k] = revolve_shape(grid, mode.shape, mode.n, sine=mode.sine)
        own[:, k] = revolve_own(grid, shell, mode.turns, mode.n, sine=mode.sine)
    dofs = sum(len(m.free) for m in meridians)
    seconds = {"solve": time.perf_counter() - started}
    return labelled(shell, grid, freq, fields, own, count=count, sturm=counted, dofs=dofs, seconds=seconds)


def harmonic_floor(shell: Shell, n: int) -> float:
    """Lower bound of omega^2 at n nodal diameters.

    .7 of the inextensional bending of a free ring, in series with shear.

    omega_b^2 = E t^2/(12 rho R^4) n^2 (n^2 - 1)^2/(n^2 + 1) (Rayleigh), omega_s^2 = k G n^2/(rho R^2), R the largest
    radius; supports and the meridian's curvature only increase it. For a casing of several strips the lowest of its
    rings counts, since a ratio of sums of energies is not below the least of the ratios.
    """
    if n < 2:
        return 0.0
    at = sampled_geometry(shell, 1)
    radius = float(np.linalg.norm(at.surface.x[:2], axis=0).max())
    wall = section(shell, at, way=1)
    bending = wall.bending / (12.0 * wall.mass * radius**4) * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)
    shear = wall.shear * n**2 / (wall.mass * radius**2)
    lowest = float(np.min(0.7 * bending * shear / (bending + shear)))
    return min([lowest, *(ring_floor(shell, name, ring, n) for name, ring in shell.rings.items())])


def ring_floor(shell: Shell, name: str, ring: Ring, n: int) -> float:
    """Lower bound for a ring's beam: its weaker bending, out of plane with torsion (Love), in series with shear.

    R is the radius of its own centre line, which an offset separates from the edge.
    """
    material, section = ring.material or shell.material, ring.section
    end = np.array([shell.line_at(name)])
    points = ties(shell, end, np.zeros(1), ring.centre(outward(shell, name)))[1]
    radius, G = float(np.linalg.norm(points[0, :2])), material.shear_modulus
    weak = material.E * min(section.I_r, section.I_z)
    inertia = material.rho * section.area
    ratio = max(1.0, weak / (G * section.J))
    bending = weak / (inertia * radius**4) * n**2 * (n**2 - 1) ** 2 / (n**2 + ratio)
    shear = section.shear * G * n**2 / (material.rho * radius**2)
    return float(0.5 * bending * shear / (bending + shear))


def resolving(shell: Shell, n: int) -> Shell:
    """The shell on a mesh with at least six nodes in a wave of n around."""
    mesh = shell.mesh
    elements = max(mesh.columns, int(np.ceil(6.0 * n / mesh.order)))
    return shell if elements == mesh.columns else replace(shell, mesh=replace(mesh, around=elements))


def inertia_below(meridian: Meridian, sigma: float) -> int:
    """Number of eigenvalues of one harmonic below sigma."""
    root = 1.0 / np.sqrt(meridian.mass)
    return negative(root[:, None] * meridian.K * root - sigma * np.eye(len(root)))


def negative(matrix: FloatArray) -> int:
    """Number of negative eigenvalues of a symmetric matrix: the negative pivots of L D L^T (Sylvester)."""
    _, D, _ = ldl(matrix)
    pivots = eigvalsh_tridiagonal(np.diag(D), np.diag(D, -1))
    return int(np.count_nonzero(pivots < 0.0))


def lowest(meridian: Meridian, count: int, shift: float) -> tuple[FloatArray, FloatArray]:
    """Lowest eigenvalues and mass-normalised vectors of one harmonic: inverse of K + shift M, then Rayleigh-Ritz.

    Small eigenvalues (rigid motions, thin free rings) would be lost in the round-off of K's large ones. If round-off of
    a rigid motion exceeds the shift, on the thinnest walls, the shift is a hundred times larger. Values come from the
    vectors' strain energies, exact to round-off relative to themselves.

    Raises
    ------
    NumericsError
        If K + shift M is still indefinite.
    """
    root = 1.0 / np.sqrt(meridian.mass)
    size = len(root)
    A = root[:, None] * meridian.K * root
    for far in (shift, 1e2 * shift, 1e4 * shift):
        try:
            factor = cho_factor(A + far * np.eye(size))
        except LinAlgError:
            continue
        flexibility = cho_solve(factor, np.eye(size))
        start = max(0, size - count)
        _, vectors = eigh(0.5 * (flexibility + flexibility.T), subset_by_index=[start, size - 1])
        vectors = root[:, None] * vectors
        values, turn = eigh(meridian.energies(vectors), vectors.T @ (meridian.mass[:, None] * vectors))
        return values, vectors @ turn
    raise NumericsError(f"n = {meridian.n}: round-off exceeds the stiffness: the wall is too thin for double precision")


def revolve_shape(grid: Grid, shape: FloatArray, n: int, *, sine: bool) -> FloatArray:
    """Spread a meridian shape (nodes on the meridian, 5) around as a nodal field (nodes, 5), mass-normalised."""
    z, theta = grid.nodes
    _, row = np.unique(np.round(z / np.ptp(z), 9), return_inverse=True)
    wave = (shape * HOOP)[row] * np.exp(1j * n * theta)[:, None]
    part = shown(wave, n, sine=sine)
    c, s = np.cos(theta), np.sin(theta)
    field = part.copy()
    field[:, 0] = part[:, 0] * c - part[:, 1] * s
    field[:, 1] = part[:, 0] * s + part[:, 1] * c
    return np.asarray(field / np.sqrt(2.0 * np.pi if n == 0 else np.pi))


def shown(wave: Array, n: int, *, sine: bool) -> FloatArray:
    """The part of a wave that a mode shows: its cosine or its sine part.

    At n = 0 it is the sum of both. A torsional mode (sine) may there have the frequency of another one (cosine); the
    rigid motions of a free casing, with frequency zero, always do, and the solver returns mixtures of them.
    """
    if n == 0:
        return np.asarray(wave.real + wave.imag)
    return np.asarray(wave.imag if sine else wave.real)


def ring_nodes(shell: Shell, grid: Grid) -> IntArray:
    """Nodes of the lines with rings, in the order of the rings' own dofs."""
    ringed = [grid.edges[name].nodes for name in shell.rings]
    return np.concatenate([np.zeros(0, dtype=np.int64), *ringed])


def revolve_own(grid: Grid, shell: Shell, turns: FloatArray, n: int, *, sine: bool) -> FloatArray:
    """Spread the rings' rotations about the normal (rings,) around: (own,), as `revolve_shape` for shapes."""
    nodes = ring_nodes(shell, grid)
    wave = 1j * np.exp(1j * n * grid.nodes[1, nodes]) * np.repeat(turns, len(nodes) // max(1, len(turns)))
    part = shown(wave, n, sine=sine)
    return np.asarray(part / np.sqrt(2.0 * np.pi if n == 0 else np.pi))
