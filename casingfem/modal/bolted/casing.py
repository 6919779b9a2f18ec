"""Modes of a casing around which its bolts alone vary: harmonics of the perfect casing, coupled by the bolts.

Without bolts each number n of nodal diameters is a problem of its own. Tight bolts couple some of them (`coupled`),
loose ones all: these are a change of the tight casing (`loose`). The patches are resolved up to `WAVES` waves, whatever
the mesh has around, so that nothing here depends on where a bolt is in an element. A count at one shift by the inertia
of all harmonics (Wittrick & Williams, Q. J. Mech. Appl. Math. 24, 1971, 263) shows that no mode is missed.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import LinAlgError

from casingfem.errors import ModelError, NumericsError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.eigen import Band, gap_after
from casingfem.linalg.slicing import CLEAR
from casingfem.modal.bolted.condensed import (
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
from casingfem.modal.bolted.coupled import Coupling, Group, dofs_of, group_of, joined, placed
from casingfem.modal.bolted.loose import LooseBolts, loose_bolts, loosened
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
CHUNK, FEW = 12, 10  # harmonics whose stiffness is computed at once, fixed modes of one harmonic at first
SPARE = 5  # modes beyond the requested ones, among which a gap is found
MOST = 6000  # unknowns of one coupled problem: beyond, the two-dimensional mesh is quicker
LOOSE = 24  # loose bolts: beyond, likewise


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


def obstacle(shell: Shell) -> str:
    """Why a casing is not computed by coupled harmonics, as what was found and expected; empty if it is.

    Something other than bolts varies around, or its bolts couple too many harmonics.
    """
    bolts = bolts_of(shell)
    if not bolts or shell.rotation is not None or not without_bolts(shell).axisymmetric:
        found = "found a shell that rotates, has no bolts or varies around apart from them"
        return f"{found}, expected a bolted casing at rest"
    period = int(np.gcd.reduce([replace(support, loose={}).period for support in bolts.values()]))
    size = 4 * DOFS * len(bolts) * highest_wave(shell) // period
    if size > MOST:
        narrow = np.degrees(min(b.patch for b in bolts.values()))
        found = f"found patches of {narrow:.3g} degrees, not evenly around: {size} coupled unknowns"
        return f"{found}, expected at most {MOST}"
    loose = sum(len(support.loose) for support in bolts.values())
    return f"found {loose} loose bolts, expected at most {LOOSE}" if loose > LOOSE else ""


def require_bolts_alone(shell: Shell) -> None:
    """Refuse a casing with an `obstacle`.

    Raises
    ------
    ModelError
        `modes-method`, with the finding.
    """
    found = obstacle(shell)
    if found:
        raise ModelError("modes-method", f'method "bolts": {found}; use "shell"')


class Shape(NamedTuple):
    """Eigenvalue of a coupled problem, and the complex amplitudes of the columns of each harmonic: n -> (columns,)."""

    value: float
    waves: dict[int, Array]


@dataclass(frozen=True, slots=True, eq=False)
class Harmonics:
    """The casing without its bolts by harmonics: long waves with their modes, short ones statically, and the bolts."""

    shell: Shell
    coupling: Coupling
    loose: LooseBolts
    long: Sequence[Condensed]
    parts: Sequence[Split]
    short: ShortWaves

    @property
    def groups(self) -> list[Group]:
        """The harmonics that tight bolts couple, each group by itself."""
        apart = self.coupling.groups(int(self.short.n[-1]))
        return [group_of(group, self.coupling, self.long, self.short) for group in apart]

    def shapes(self, most: float) -> list[Shape]:
        """All modes below an eigenvalue, ascending."""
        if len(self.loose.sign):
            found = loosened(self.groups, self.coupling, self.loose, most)
            return [Shape(value, waves) for value, waves in found]
        tight = []
        for group in self.groups:
            values, vectors = group.modes(most)
            waves = group.waves(vectors, np.zeros((len(group.short.n), len(values))))
            tight += [Shape(float(value), each) for value, each in zip(values, waves, strict=True)]
        return sorted(tight, key=lambda shape: shape.value)

    def amplitudes(self, waves: dict[int, Array], most: int) -> tuple[IntArray, Array]:
        """Harmonics up to `most`, and complex amplitudes of the meridian's nodes and rings, (5 nodes + rings, n)."""
        orders = np.array(sorted(n for n in waves if n <= most))
        short = orders[orders >= len(self.long)]
        low = [self.long[n].motions[:, : len(waves[n])] @ waves[n] for n in orders.tolist() if n < len(self.long)]
        found = np.stack(low, axis=1)
        if len(short):
            high = self.short.motions(short, np.array([waves[n] for n in short.tolist()]))
            found = np.hstack([found, high.T])
        rings = len(self.long[0].own)
        turned = np.append(np.tile(HOOP, (len(found) - rings) // DOFS), np.full(rings, 1j))
        found[:, orders > 0] *= turned[:, None]
        return orders, found

    def dominant(self, shape: Shape) -> int:
        """The n with the largest motion."""
        orders, amplitudes = self.amplitudes(shape.waves, len(self.long) - 1)
        return int(orders[np.argmax(np.linalg.norm(amplitudes, axis=0))])

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
        change = np.diag(self.loose.sign)
        for group in self.coupling.groups(int(self.short.n[-1])):
            dofs = joined([dofs_of(n, edges) for n in group.tolist()])
            coupled = placed(dofs, stiffness) + self.coupling.matrix(dofs)
            count += negative(coupled)
            if len(change):
                B = self.loose.on(self.coupling, dofs)
                change = change - B.T @ np.linalg.solve(coupled, B)
        if len(change):
            count += negative(change) - int(np.count_nonzero(self.loose.sign < 0.0))
        return count


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
            K = Stiffness(free, n, n + CHUNK - 1)
        parts.append(split(frame, n, K(n)))
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
    spectra = np.stack([replace(support, loose={}).spectrum(orders) for support in bolts.values()])
    stiffness = [np.real(bolt_stiffness(shell, edge)) for edge in bolts]
    coupling, loose = Coupling(interface, stiffness, spectra), loose_bolts(list(bolts.values()), stiffness, len(long))
    return Harmonics(shell, coupling, loose, long, parts, short), limit


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
    return labelled(
        shell, grid, freq, fields, own, count=wanted, sturm=counted, dofs=dofs, seconds=seconds, by_harmonics=True
    )


def resolving(shell: Shell, n: int) -> Shell:
    """The casing on a mesh that follows the bolts, with at least six nodes in a wave of n around."""
    mesh, least = shell.mesh, int(np.ceil(6.0 * n / shell.mesh.order))
    if mesh.columns >= least:
        return shell
    count = int(np.lcm.reduce([bolts.count for bolts in bolts_of(shell).values()]))
    return replace(shell, mesh=replace(mesh, around=following(least, count)))


def spread(harmonics: Harmonics, shell: Shell, grid: Grid, found: Sequence[Shape]) -> tuple[FloatArray, FloatArray]:
    """Nodal fields (nodes, 5, modes) and the rings' own dofs (own, modes), as far as the grid resolves harmonics."""
    z, theta = grid.nodes
    _, row = np.unique(np.round(z / np.ptp(z), 9), return_inverse=True)
    angles, place = np.unique(theta, return_inverse=True)
    most = shell.mesh.order * shell.mesh.columns // 2
    c, s = np.cos(theta), np.sin(theta)
    fields, turns = np.empty((len(theta), DOFS, len(found))), np.empty((len(shell.rings), len(angles), len(found)))
    for mode, shape in enumerate(found):
        orders, amplitudes = harmonics.amplitudes(shape.waves, most)
        around = np.exp(1j * np.outer(orders, angles))
        motions = amplitudes.real @ around.real - amplitudes.imag @ around.imag  # rows by nodes, then rings
        radial, along, *others = motions[: DOFS * (1 + row.max())].reshape(-1, DOFS, len(angles)).swapaxes(0, 1)
        radial, along, *others = (part[row, place] for part in (radial, along, *others))
        fields[:, :, mode] = np.stack([radial * c - along * s, radial * s + along * c, *others], axis=1)
        turns[:, :, mode] = motions[DOFS * (1 + row.max()) :]
    nodes = ring_nodes(shell, grid)
    ring = np.repeat(np.arange(len(turns)), len(nodes) // max(1, len(turns)))
    return fields, turns[ring, place[nodes]]
