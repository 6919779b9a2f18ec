"""Modes of a casing around which its bolts alone vary: harmonics of the perfect casing, coupled by the bolts.

Without bolts each number n of nodal diameters is a problem of its own. Bolts of the density p(theta) add the energy

    1/2 int p x^T D x dtheta,   x = sum_n Re(z_n e^(i n theta)),   P(k) = int p e^(i k theta) dtheta,

which couples n and m by P(n - m) and P(n + m): equal bolts only where their number divides n - m or n + m, loose ones
all. The patches are resolved up to `WAVES` waves, whatever the mesh has around, so that nothing here depends on where a
bolt is in an element. A count at one shift by the inertia of all harmonics (Wittrick & Williams, Q. J. Mech. Appl.
Math. 24, 1971, 263) shows that no mode is missed.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from casingfem.errors import ModelError, NumericsError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.eigen import Band, gap_after
from casingfem.linalg.slicing import CLEAR
from casingfem.modal.condensed import (
    Condensed,
    Interface,
    ShortWaves,
    Split,
    Stiffness,
    condensed,
    fixed_modes,
    inertial_shapes,
    make_frame,
    short_waves,
    split,
)
from casingfem.modal.fourier import harmonic_floor, negative, ring_nodes
from casingfem.modal.mode_set import Modes, labelled
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import Support
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.mesh.shell_mesh import Grid, make_grid
from casingfem.structure.shell.axisymmetric import HOOP
from casingfem.structure.shell.edges import bolt_stiffness
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.variation import following, outer_supports
from contact.io.progress import tell

# frequencies change by up to 1e-5 with more WAVES, 2e-5 with more LONG harmonics, 1e-7 with more fixed modes
WAVES = 12.0  # n width/2 up to which the patches are resolved
LONG = 9.0  # harmonics whose first fixed mode is above this multiple follow statically
REACH = 4.0  # fixed modes up to this multiple of the highest eigenvalue, twice its frequency
COUPLED = 1e-12  # of a patch's mean: what couples two harmonics
CHUNK, FEW = 12, 10  # harmonics whose stiffness is computed at once, fixed modes of one harmonic at first
SPARE = 5  # modes beyond the requested ones, among which a gap is found
MOST = 6000  # unknowns of one coupled problem: beyond, the two-dimensional mesh is quicker


def without_bolts(shell: Shell) -> Shell:
    """The same casing with its bolted edges free."""
    supports: dict[str, Support] = {}
    for edge, support in shell.supports.items():
        if isinstance(support, Ring) and isinstance(support.support, Bolts):
            supports[edge] = replace(support, support=None)
        elif not isinstance(support, Bolts):
            supports[edge] = support
    return replace(shell, supports=supports)


def bolts_of(shell: Shell) -> dict[str, Bolts]:
    """Bolted edges and their bolts."""
    return {edge: support for edge, support in outer_supports(shell).items() if isinstance(support, Bolts)}


def highest_wave(shell: Shell) -> int:
    """Nodal diameters that resolve the narrowest patch."""
    return int(np.ceil(2.0 * WAVES / min(bolts.patch for bolts in bolts_of(shell).values())))


def require_bolts_alone(shell: Shell) -> None:
    """Refuse a casing around which something other than bolts varies, or whose bolts couple too many harmonics.

    Raises
    ------
    ModelError
        `modes-method`, with the finding.
    """
    bolts = bolts_of(shell)
    if not bolts or shell.rotation is not None or not without_bolts(shell).axisymmetric:
        found = "found a shell that rotates, has no bolts or varies around apart from them"
        raise ModelError("modes-method", f'method "bolts": {found}, expected a bolted casing at rest; use "shell"')
    period = int(np.gcd.reduce([support.period for support in bolts.values()]))
    size = 4 * DOFS * len(bolts) * highest_wave(shell) // period
    if size > MOST:
        found = f"found patches of {np.degrees(min(b.patch for b in bolts.values())):.3g} degrees, not all equal"
        raise ModelError(
            "modes-method", f'method "bolts": {found}: {size} coupled unknowns, at most {MOST}; use "shell"'
        )


class Dofs(NamedTuple):
    """Unknowns of coupled harmonics: n, motion of the edges or (from their number on) fixed mode, and the phase.

    The motion of an unknown y is Re(phase y e^(i n theta)) in each component that is in phase, Re(i phase y
    e^(i n theta)) in quadrature, and both are mass-normalised: phase is 1/sqrt(pi) or -i/sqrt(pi).
    """

    n: IntArray
    column: IntArray
    phase: Array

    def of(self, which: IntArray) -> "Dofs":
        """Some of them."""
        return Dofs(self.n[which], self.column[which], self.phase[which])


def dofs_of(n: int, columns: IntArray) -> Dofs:
    """The cosine and sine unknowns of the columns of a harmonic; at n = 0 each column once, in phase."""
    if n == 0:
        return Dofs(np.zeros(len(columns), dtype=int), columns, np.full(len(columns), 1.0 / np.sqrt(2.0 * np.pi) + 0j))
    phase = np.repeat([1.0, -1j], len(columns)) / np.sqrt(np.pi)
    return Dofs(np.full(2 * len(columns), n), np.tile(columns, 2), phase)


def joined(parts: Sequence[Dofs]) -> Dofs:
    """All unknowns in one list."""
    return Dofs(*(np.concatenate([part[k] for part in parts]) for k in range(3)))


class Coupling(NamedTuple):
    """Bolts of a casing: stiffness of one on the motions of its edge, and P(k) for k up to twice the highest n."""

    interface: Interface
    stiffness: Sequence[FloatArray]
    spectra: Array

    def matrix(self, dofs: Dofs) -> FloatArray:
        """Stiffness of all bolts on unknowns that are motions of the edges."""
        hoop = np.where(dofs.n > 0, self.interface.hoop[dofs.column], 0)
        waves, edge, part = dofs.phase * 1j**hoop, self.interface.edge[dofs.column], self.interface.part[dofs.column]
        total = np.zeros((len(waves), len(waves)))
        for number, (D, spectrum) in enumerate(zip(self.stiffness, self.spectra, strict=True)):
            on = np.flatnonzero(edge == number)
            n, wave = dofs.n[on], waves[on]
            apart, shift = n[:, None] + n, n[:, None] - n
            difference = np.where(shift < 0, spectrum[np.abs(shift)].conj(), spectrum[np.abs(shift)])
            product = wave[:, None] * (wave.conj() * difference + wave * spectrum[apart])
            total[np.ix_(on, on)] = 0.5 * D[np.ix_(part[on], part[on])] * product.real
        return total

    def groups(self, highest: int) -> list[IntArray]:
        """Harmonics from 0 to `highest` that the bolts couple, each group by itself."""
        n = np.arange(highest + 1)
        size = np.abs(self.spectra) / np.abs(self.spectra[:, :1])
        tied = np.any((size[:, np.abs(n[:, None] - n)] > COUPLED) | (size[:, n[:, None] + n] > COUPLED), axis=0)
        number, group = connected_components(csr_array(tied), directed=False)
        return [np.flatnonzero(group == k) for k in range(number)]


class Shape(NamedTuple):
    """Eigenvalue of a coupled problem, and the complex amplitudes of the columns of each harmonic: n -> (columns,)."""

    value: float
    waves: dict[int, Array]


@dataclass(frozen=True, slots=True, eq=False)
class Harmonics:
    """The casing without its bolts by harmonics: long waves with their modes, short ones statically, and the bolts."""

    shell: Shell
    coupling: Coupling
    long: Sequence[Condensed]
    parts: Sequence[Split]
    short: ShortWaves

    def shapes(self, most: float) -> list[Shape]:
        """All modes below an eigenvalue, ascending."""
        found = [shape for group in self.coupling.groups(int(self.short.n[-1])) for shape in self._coupled(group, most)]
        return sorted(found, key=lambda shape: shape.value)

    def _coupled(self, group: IntArray, most: float) -> list[Shape]:
        """Modes of the harmonics of one group, after static condensation of the short waves."""
        edges = len(self.coupling.interface.part)
        kept = [self.long[n] for n in group.tolist() if n < len(self.long)]
        long = joined([dofs_of(each.n, np.arange(len(each.K))) for each in kept]) if kept else None
        if long is None:
            return []
        K, M = (placed(long, {each.n: getattr(each, name) for each in kept}) for name in "KM")
        moving = np.flatnonzero(long.column < edges)
        above = group[group >= len(self.long)]
        short = joined([dofs_of(n, np.arange(edges)) for n in above.tolist()]) if len(above) else long.of(moving[:0])
        every = joined([long.of(moving), short])
        bolted, split_at = self.coupling.matrix(every), len(moving)
        K[np.ix_(moving, moving)] += bolted[:split_at, :split_at]
        follow = np.zeros((len(short.n), len(long.n)))
        if len(short.n):
            at = above - self.short.n[0]
            own, inert = (
                placed(short, dict(zip(above.tolist(), blocks[at], strict=True)))
                for blocks in (self.short.K, self.short.M)
            )
            factor = cho_factor(own + bolted[split_at:, split_at:])
            follow[:, moving] = -cho_solve(factor, bolted[split_at:, :split_at])
            K[np.ix_(moving, moving)] += bolted[:split_at, split_at:] @ follow[:, moving]
            M += follow.T @ inert @ follow
        values, vectors = eigh(K, M, subset_by_value=(-np.inf, most))
        unknowns, columns = joined([long, short]), np.vstack([vectors, follow @ vectors])
        return [
            Shape(float(value), waves_of(unknowns, column)) for value, column in zip(values, columns.T, strict=True)
        ]

    def amplitudes(self, n: int, wave: Array) -> Array:
        """Complex amplitudes of the motions of the meridian's nodes and rings, (5 nodes + rings,), at one n."""
        if n < len(self.long):
            each = self.long[n]
            shapes, own = each.fields[:, :, : len(wave)] @ wave, each.own[:, : len(wave)] @ wave
        else:
            parts = list(zip(self.short.weights[n - self.short.n[0]], self.short.samples, strict=True))
            shapes = sum(weight * (each.fields @ wave) for weight, each in parts)
            own = sum(weight * (each.own @ wave) for weight, each in parts)
        phase, turn = (HOOP, 1j) if n > 0 else (np.ones(DOFS), 1.0)
        return np.append(shapes * phase, own * turn)

    def dominant(self, shape: Shape) -> int:
        """The n with the largest motion."""
        return max(shape.waves, key=lambda n: float(np.linalg.norm(self.amplitudes(n, shape.waves[n]))))

    def below(self, sigma: float) -> int:
        """Number of eigenvalues below sigma: those with fixed edges, and the negative ones of the edges' stiffness."""
        edges = np.arange(len(self.coupling.interface.part))
        count, stiffness = 0, {}
        for part in self.parts:
            inside, at_edges, back = part.frame.inside, part.frame.at_edges, part.frame.back
            dynamic = part.K - sigma * np.diag(part.frame.meridian.mass)
            inner, across = dynamic[np.ix_(inside, inside)], dynamic[np.ix_(inside, at_edges)]
            count += (1 + (part.n > 0)) * negative(inner)
            outer = dynamic[np.ix_(at_edges, at_edges)] - across.T @ np.linalg.solve(inner, across)
            stiffness[part.n] = back.T @ outer @ back
        stiffness |= dict(zip(self.short.n.tolist(), self.short.K - sigma * self.short.M, strict=True))
        for group in self.coupling.groups(int(self.short.n[-1])):
            dofs = joined([dofs_of(n, edges) for n in group.tolist()])
            count += negative(placed(dofs, stiffness) + self.coupling.matrix(dofs))
        return count


def placed(dofs: Dofs, blocks: dict[int, FloatArray]) -> FloatArray:
    """The matrix that couples unknowns of the same n and phase by the blocks of their harmonics."""
    total = np.zeros((len(dofs.n), len(dofs.n)))
    for n, block in blocks.items():
        own = np.flatnonzero(dofs.n == n)
        for member in (own[dofs.phase[own].imag == 0.0], own[dofs.phase[own].imag != 0.0]):
            if len(member):
                total[np.ix_(member, member)] = block
    return total


def waves_of(dofs: Dofs, amplitudes: FloatArray) -> dict[int, Array]:
    """Complex amplitudes of the columns of each harmonic from its cosine and sine unknowns."""
    waves = {}
    for n in np.unique(dofs.n).tolist():
        own = np.flatnonzero(dofs.n == n)
        wave = np.zeros(1 + dofs.column[own].max(), dtype=complex)
        np.add.at(wave, dofs.column[own], dofs.phase[own] * amplitudes[own])
        waves[n] = wave
    return waves


def harmonics_of(shell: Shell, count: int, band: Band | None) -> tuple[Harmonics, float]:
    """The harmonics of a bolted casing for `count` modes or those of a band, and an eigenvalue below which these lie.

    Fixed edges only raise frequencies: the modes of the casing with fixed edges bound those on bolts.
    """
    free, bolts = without_bolts(shell), bolts_of(shell)
    interface = interface_of(free, list(bolts))
    frame = make_frame(free, interface)
    parts: list[Split] = []
    fixed: list[tuple[FloatArray, FloatArray]] = []
    limit = np.inf if band is None else (2.0 * np.pi * band[1]) ** 2
    least = 0.0
    while harmonic_floor(free, len(parts)) <= limit or least <= LONG * limit:
        n = len(parts)
        tell(f"n = {n}")
        if n % CHUNK == 0:
            stiffness = Stiffness(free, n, n + CHUNK - 1)
        parts.append(split(frame, n, stiffness(n)))
        fixed.append(fixed_below(parts[-1], count + SPARE, REACH * limit))
        least = fixed[-1][0][0]
        if band is None:
            ranked = np.sort(np.concatenate([np.repeat(values, 1 + (k > 0)) for k, (values, _) in enumerate(fixed)]))
            limit = ranked[count + SPARE - 1] if len(ranked) >= count + SPARE else np.inf
    long = []
    for part, (values, modes) in zip(parts, fixed, strict=True):
        if values[-1] <= REACH * limit:
            values, modes = fixed_below(part, len(values), REACH * limit)
        few = int(np.count_nonzero(values <= REACH * limit))
        more, shapes = inertial_shapes(part, modes[:, :few])
        long.append(condensed(part, np.append(values[:few], more), np.hstack([modes[:, :few], shapes])))
    highest = max(highest_wave(shell), 2 * len(long))
    short = short_waves(free, frame, len(long), highest)
    orders = np.arange(2 * highest + 1)
    spectra = np.stack([support.spectrum(orders) for support in bolts.values()])
    coupling = Coupling(interface, [np.real(bolt_stiffness(shell, edge)) for edge in bolts], spectra)
    return Harmonics(shell, coupling, long, parts, short), limit


def fixed_below(part: Split, count: int, most: float) -> tuple[FloatArray, FloatArray]:
    """At least so many of the lowest modes with the edges fixed, and all below `most` if that is known."""
    values, modes = fixed_modes(part, max(count, FEW))
    while most < np.inf and values[-1] <= most and len(values) < len(part.frame.inside):
        values, modes = fixed_modes(part, 2 * len(values))
    return values, modes


def interface_of(shell: Shell, edges: Sequence[str]) -> Interface:
    """Nodes of edges on the meridian, and the numbers of the rings on them."""
    last = (len(shell.mesh.breaks) - 1) * shell.mesh.order
    nodes = np.array([last if shell.chart.edges[edge][1] else 0 for edge in edges])
    ringed = list(shell.rings)
    return Interface(nodes, np.array([ringed.index(edge) if edge in ringed else -1 for edge in edges]))


def bolted_modes(shell: Shell, wanted: int | Band) -> Modes:
    """Lowest modes, or those of a band [Hz], of a casing around which its bolts alone vary.

    Raises
    ------
    NumericsError
        If the inertia at one shift disagrees with what was found, or round-off makes a stiffness indefinite.

    Examples
    --------
    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.2), thickness=3e-3,
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                   supports={"base": cf.Bolts(count=8, k=1e8, k_rot=1e3)})
    >>> found = bolted_modes(casing, 4)
    >>> found.nodal_diameters.tolist(), found.sturm_count
    ([4, 5, 5, 4], 4)
    """
    started = time.perf_counter()
    band = None if isinstance(wanted, int) else wanted
    low = -np.inf
    try:
        harmonics, limit = harmonics_of(shell, wanted if isinstance(wanted, int) else 0, band)
        if band is not None:
            ways = zip(band, (-1.0, 1.0), strict=True)
            low, limit = ((2.0 * np.pi * f) ** 2 * (1.0 + way * CLEAR) for f, way in ways)
        low = low if band is None or band[0] > 0.0 else -np.inf
        found = harmonics.shapes(limit)
    except LinAlgError as error:
        reason = "a stiffness is not positive in double precision"
        raise NumericsError(f'method "bolts": found a wall so thin that {reason}; use method "shell"') from error
    values = np.array([shape.value for shape in found])
    if isinstance(wanted, int):
        below, sigma = gap_after(values, min(wanted, len(found) - 1))
        found = found[:below]
        counted = below
        start = 0
    else:
        start, below, sigma = int(np.count_nonzero(values < low)), len(found), limit
        found, counted, wanted = found[start:], below - start, below - start
    inertia = harmonics.below(sigma)
    if inertia != below:
        raise NumericsError(f"{inertia} modes lie below {np.sqrt(sigma) / 2 / np.pi:.6g} Hz, {below} were found")
    shell = resolving(shell, max((harmonics.dominant(shape) for shape in found), default=0))
    grid = make_grid(shell.chart, shell.mesh, shell.stations)
    fields, own = spread(harmonics, shell, grid, found)
    freq = np.sqrt(np.maximum([shape.value for shape in found], 0.0)) / (2.0 * np.pi)
    dofs = sum(len(part.K) for part in harmonics.parts) + len(harmonics.short.n) * len(harmonics.short.K[0])
    seconds = {"solve": time.perf_counter() - started}
    return labelled(shell, grid, freq, fields, own, count=wanted, sturm=counted, dofs=dofs, seconds=seconds)


def resolving(shell: Shell, n: int) -> Shell:
    """The casing on a mesh that follows the bolts, with at least six nodes in a wave of n around."""
    mesh, least = shell.mesh, int(np.ceil(6.0 * n / shell.mesh.order))
    if mesh.around >= least:
        return shell
    count = int(np.lcm.reduce([bolts.count for bolts in bolts_of(shell).values()]))
    return replace(shell, mesh=replace(mesh, around=following(least, count)))


def spread(harmonics: Harmonics, shell: Shell, grid: Grid, found: Sequence[Shape]) -> tuple[FloatArray, FloatArray]:
    """Nodal fields (nodes, 5, modes) and the rings' own dofs (own, modes), as far as the grid resolves harmonics."""
    z, theta = grid.nodes
    _, row = np.unique(np.round(z / np.ptp(z), 9), return_inverse=True)
    angles, place = np.unique(theta, return_inverse=True)
    most = shell.mesh.order * shell.mesh.around // 2
    c, s = np.cos(theta), np.sin(theta)
    fields, turns = np.empty((len(theta), DOFS, len(found))), np.empty((len(shell.rings), len(angles), len(found)))
    for mode, shape in enumerate(found):
        orders = [n for n in shape.waves if n <= most]
        amplitudes = np.stack([harmonics.amplitudes(n, shape.waves[n]) for n in orders], axis=-1)
        around = np.exp(1j * np.outer(orders, angles))
        motions = amplitudes.real @ around.real - amplitudes.imag @ around.imag  # rows by nodes, then rings
        radial, along, *others = motions[: DOFS * (1 + row.max())].reshape(-1, DOFS, len(angles)).swapaxes(0, 1)
        radial, along, *others = (part[row, place] for part in (radial, along, *others))
        fields[:, :, mode] = np.stack([radial * c - along * s, radial * s + along * c, *others], axis=1)
        turns[:, :, mode] = motions[DOFS * (1 + row.max()) :]
    nodes = ring_nodes(shell, grid)
    ring = np.repeat(np.arange(len(turns)), len(nodes) // max(1, len(turns)))
    return fields, turns[ring, place[nodes]]
