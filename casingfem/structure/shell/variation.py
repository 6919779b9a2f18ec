"""Circumferential variation of a shell, its default mesh, and the effect of a mesh on bolts.

Equal bolts at N angles split n nodal diameters only if N divides 2n. If the elements around do not follow the bolts,
each bolt has another position in its element and another numerical stiffness. Then the mesh also splits other pairs.
"""

from collections.abc import Mapping
from itertools import chain, pairwise

import numpy as np
from scipy.linalg import eigh

from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import ElasticEdge, outer_support
from casingfem.structure.field.field import Field
from casingfem.structure.field.random import typical
from casingfem.structure.geometry.bend import unresolved_bend
from casingfem.structure.geometry.chart import Chart, is_axisymmetric
from casingfem.structure.geometry.lengths import Lengths, chart_lengths
from casingfem.structure.geometry.revolved import chart_lines
from casingfem.structure.geometry.strip import ON_LINE, breaks_between
from casingfem.structure.mesh.edge_form import Sprung
from casingfem.structure.mesh.element import gauss, lagrange
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.parts import ShellParts

PERIODIC, RESOLVED = 1e-3, 0.02  # of the largest harmonic: what breaks a period around, what a mesh must follow


def outer_supports(shell: ShellParts) -> dict[str, object]:
    """For each edge, its support from outside, which for a ring is the ring's own support."""
    return {edge: outer_support(support) for edge, support in shell.supports.items()}


def field_samples(defect: Field) -> int:
    """Number of points around that resolve a field: four per wave of its highest harmonic, if the field states it."""
    return 4 * max(64, 1 + int(getattr(defect, "max_harmonic", None) or 0))


def harmonic_amplitudes(shell: ShellParts, defect: Field) -> Array:
    """Largest amplitude of each harmonic 1, 2, ... around of a field over five heights; random parts are typical."""
    (a0, a1), _ = shell.chart.bounds
    points = field_samples(defect)
    theta = 2.0 * np.pi * np.arange(points) / points
    values = np.real(typical(defect).derivatives(np.linspace(a0, a1, 5)[:, None], theta[None, :]).value)
    return np.asarray(np.abs(np.fft.rfft(values, axis=1)).max(axis=0)[1 : points // 2])


def around_period(shell: ShellParts) -> int:
    """The greatest common divisor of all variations around; a mesh of as many elements has the same symmetry."""
    period = 0
    springs = [s.patterns.values() for s in outer_supports(shell).values() if isinstance(s, ElasticEdge)]
    for defect in (*shell.defects.values(), *chain.from_iterable(springs)):
        amplitude = harmonic_amplitudes(shell, defect)
        period = int(np.gcd.reduce([period, *(1 + np.flatnonzero(amplitude > PERIODIC * amplitude.max())).tolist()]))
    for support in outer_supports(shell).values():
        if isinstance(support, Bolts):
            period = int(np.gcd(period, support.period))
    return period


def finest_harmonic(shell: ShellParts, defect: Field) -> int:
    """The highest circumferential harmonic of a field above RESOLVED times its largest, by sampling."""
    amplitude = harmonic_amplitudes(shell, defect)
    above = np.flatnonzero(amplitude > RESOLVED * amplitude.max())
    return int(above[-1]) + 1 if amplitude.max() > 0.0 else 0


# Longest rows in bending lengths sqrt(R t), at most so many in an interval, and their order. A row of order 8 resolves
# 7 lengths of a plain casing to 1e-4, of order 7 to 4e-4. Corners, steps and stiffeners bend the wall more: between
# their lines, rows of 5 lengths need order 7 (7e-5); rows of 5.5 lengths leave 4.5e-4 even with order 8.
PLAIN, LINED, ROWS = 7.0, 5.0, 4
SMOOTH, KINKED = 8, 7  # order of a plain casing, and of one with lines between its ends
LAYERED = 7  # order of an open chart with layers at its edges
LEAST, LARGEST = 136, 525  # nodes around
LAYER = 2.5  # width of the row for a shear layer, in thicknesses
WIDE, NARROW, THIN = 0.1, 0.01, 1e-3  # most of a chart that it takes, least of an open chart, and of a casing
PARTS = 16  # of a row, at most, where the meridian bends irregularly
MANY = 30  # stretches between the ends of strips: more of them are too short for polynomials of high order


def default_mesh(shell: ShellParts) -> ShellMesh:
    """The mesh used when none is given; `python -m reports.verification.modes.frustum` measures the choice.

    The error target is 2e-4 of 40 frequencies, against a finer mesh. Around a casing there are 8 nodes a wave at twice
    the nodal diameters of the lowest mode, estimated as .46 R/sqrt(t h). If something varies around, there are 12.5.
    Fields get 11.5 nodes a wave, without harmonics below 2 % of their largest. A mesh splits pairs that a field of
    common period p leaves double, unless its number of elements is a multiple of p: for waves of 0.4 % by 1e-6
    (`reports.verification.modes.around`). The number of elements is odd, since even ones are less accurate for rotated
    fields. If springs vary, it is the next multiple of the common period above twice those nodal diameters, unless that
    is 1.5 times as many. With bolts it is a multiple of theirs, which preserves symmetric pairs, at 8 nodes a wave if
    nothing else varies, and nodes are a fifth of sqrt(R t) apart near bolts on the wall.

    Along the meridian the shear layer of an edge without support (free, on springs, bolts or a ring), about 2 t wide,
    gets a separate row, as on both sides of a stiffener. On an open chart, a plate or a blade, free sides get such
    columns too: without both, errors reach 2e-3. The rest is divided by the bending length sqrt(R t). Strips,
    the pieces of a meridian and stiffeners put an element line at each of their ends or places, and each interval
    between them is divided separately, more finely than a plain casing. If there are many, the order is reduced.

    Lengths are those of the surface in metres, independent of the chart's parameters. If the second parameter is not
    proportional to length, the number of elements increases by the ratio of the longest to the mean element. Rows are
    divided further where the meridian bends irregularly (`following_bends`).
    """
    t, lengths = shell.thinnest, chart_lengths(shell.chart)
    length = lengths.along
    if not shell.chart.periodic:
        around = int(np.clip(round(2.0 * lengths.across / length), 2, 8))
        around = int(np.ceil(lengths.unevenness * around - 0.05))
        rows = int(np.clip(round(2.0 * length / lengths.across), 2, 8))
        ends, sides = shear_layers(shell, length, 0, NARROW), shear_layers(shell, lengths.across, 1, NARROW)
        order = LAYERED if ends or sides else SMOOTH
        return ShellMesh(order=order, rows=divided(shell, lengths, 1.0 / rows, ends), around=between(sides, around))
    stretches = len(lines_of(shell)) - 1
    order = SMOOTH if stretches == 1 else KINKED if stretches <= MANY else max(2, KINKED * MANY // stretches)
    radius = lengths.across / (2.0 * np.pi)
    lowest = 0.46 * radius / np.sqrt(t * length)
    finest = max((finest_harmonic(shell, f) for f in shell.defects.values()), default=0)
    bolted = {edge: support.count for edge, support in outer_supports(shell).items() if isinstance(support, Bolts)}
    patterned = any(isinstance(support, ElasticEdge) and support.patterns for support in outer_supports(shell).values())
    free_of_fields = is_axisymmetric(shell.chart) and not (shell.defects or shell.masses or patterned)
    only_bolts = bool(bolted) and free_of_fields  # which the mesh follows
    nodes = max((16.0 if shell.axisymmetric or only_bolts else 25.0) * lowest, 11.5 * finest)
    around = 2 * int(np.ceil(0.5 * (np.clip(nodes, LEAST, LARGEST) / order - 1.0))) + 1
    around = 2 * int(np.ceil(0.5 * (lengths.unevenness * around - 1.0) - 1e-6)) + 1  # the longest as long as all
    springy = any(not s.uniform for s in shell.supports.values() if isinstance(s, Sprung | Ring))
    period = around_period(shell) if springy else 1
    whole = period * int(np.ceil(max(around, 4.0 * lowest) / period)) if period > 1 else 0
    if 0 < whole <= 1.5 * around:  # what symmetry forbids to split, the mesh leaves whole
        around = whole
    if bolted:
        count = int(np.lcm.reduce(list(bolted.values())))
        on_wall = any(isinstance(support, Bolts) for support in shell.supports.values())
        near = int(min(NEAR * np.sqrt(radius / t) / order, MOST)) if on_wall else 0
        around = following(max(around, near), count)
    longest = (LINED if stretches > 1 else PLAIN) * np.sqrt(radius * t) / length
    breaks = divided(shell, lengths, longest, shear_layers(shell, length, 0, THIN), most=ROWS)
    breaks = following_bends(shell.chart, breaks, order, float(np.sqrt(t / radius) / radius))
    return ShellMesh(order=order, rows=breaks, around=around)


COARSE = 6  # order of a coarse mesh
SMALL, LESS = 10_000, 4  # unknowns below which none is worth its time, and how many times fewer it must have


def coarse_mesh(shell: ShellParts) -> ShellMesh | None:
    """A mesh of fewer unknowns for a closed casing, with errors about 1e-3 of its frequencies; None if it saves little.

    It has as many elements around, a lower order, and no rows for shear layers.
    """
    if not shell.chart.periodic or shell.mesh.unknowns < SMALL:
        return None
    lengths = chart_lengths(shell.chart)
    radius = lengths.across / (2.0 * np.pi)
    longest = (LINED if len(lines_of(shell)) > 2 else PLAIN) * np.sqrt(radius * shell.thinnest) / lengths.along
    breaks = divided(shell, lengths, longest, most=ROWS)
    breaks = following_bends(shell.chart, breaks, COARSE, float(np.sqrt(shell.thinnest / radius) / radius))
    mesh = ShellMesh(order=COARSE, rows=breaks, around=shell.mesh.columns)
    return mesh if LESS * mesh.unknowns <= shell.mesh.unknowns else None


def following_bends(chart: Chart, breaks: tuple[float, ...], order: int, limit: float) -> tuple[float, ...]:
    """Rows whose displacements follow the meridian: each row is divided until its `unresolved_bend` is below a limit.

    A curvature k that they do not follow stretches the wall with a stiffness of (k R)^2 E t; the lowest modes have one
    of the order of E t t/R. Hence `limit` is sqrt(t/R)/R. Measured or published meridians bend irregularly: without
    this, the casing of NASA rotor 67 has an error of 3 % with order 7.
    """
    (a0, a1), _ = np.real(chart.bounds)
    rows = list(breaks[:1])
    for low, high in pairwise(breaks):
        for count in range(1, PARTS + 1):
            places = np.linspace(low, high, count + 1)
            ends = a0 + (a1 - a0) * places
            if all(unresolved_bend(chart, *part, order - 1) <= limit for part in pairwise(ends.tolist())):
                break
        rows += [*places[1:-1].tolist(), high]
    return tuple(rows)


def shear_layers(shell: ShellParts, length: float, along: int, least: float) -> dict[float, float]:
    """Widths of the elements for shear layers, as parts of the length, by places from 0 to 1 of a parameter.

    A layer lies at an edge that no support fixes and on both sides of a stiffener.
    """
    bounds = np.real(shell.chart.bounds)
    low, high = bounds[along]
    fixed = {shell.chart.edges[edge] for edge, support in shell.supports.items() if support.held}
    within = [] if along else [(at - low) / (high - low) for at in stations(shell)]
    places = np.array([*(k for k in (0, 1) if (along, k) not in fixed), *within])
    at = [np.full(len(places), bounds[1 - along].mean() if along else 0.0)] * 2
    at[along] = low + (high - low) * places
    thickness = np.real(shell.geometry(*at).thickness)
    return dict(zip(places.tolist(), np.clip(LAYER * thickness / length, least, WIDE).tolist(), strict=True))


def between(layers: Mapping[float, float], count: int) -> int | tuple[float, ...]:
    """Break points of `count` equal elements between layers at the ends 0 and 1; the count without layers.

    >>> between({1.0: 0.1}, 2), between({}, 2)
    ((0.0, 0.45, 0.9, 1.0), 2)
    """
    if not layers:
        return count
    inner = np.linspace(layers.get(0.0, 0.0), 1.0 - layers.get(1.0, 0.0), count + 1)
    return tuple(sorted({0.0, *inner.tolist(), 1.0}))


def stations(shell: ShellParts) -> list[float]:
    """First parameters of the stiffeners."""
    return [float(np.real(at)) for at in shell.stations.values()]


EVEN: Mapping[float, float] = {}  # no layers


def lines_of(shell: ShellParts) -> list[float]:
    """Required element lines, from 0 to 1: ends of strips and of a meridian's pieces, stiffeners."""
    return breaks_between(shell.strips, shell.chart.bounds[0], [*chart_lines(shell.chart), *shell.stations.values()])


def divided(
    shell: ShellParts,
    lengths: Lengths,
    longest: float,
    layers: Mapping[float, float] = EVEN,
    most: float = np.inf,
) -> tuple[float, ...]:
    """Breaks of the rows: rows for layers, and the rest of each interval in equal rows below `longest`, at most `most`.

    All are fractions of the chart's length in metres; breaks are fractions of its first parameter. A layer wider than
    half of its interval is omitted.
    """
    breaks = lines_of(shell)
    rows: set[float] = set()
    for start, end in pairwise(breaks):
        low, high = lengths.at(start), lengths.at(end)
        first, last = (layer_at(layers, place, 0.5 * (high - low)) for place in (start, end))
        count = int(np.clip(np.ceil((high - low - first - last) / longest - 1e-9), 1, most))
        inner = np.linspace(low + first, high - last, count + 1)
        inner = inner[(inner > low) & (inner < high)]
        rows |= {start, end, *lengths.part(inner).tolist()}
    return tuple(sorted(rows))


def layer_at(layers: Mapping[float, float], place: float, below: float) -> float:
    """Width of the layer at a place, 0 without one and if it is not below a limit."""
    width = next((width for at, width in layers.items() if abs(at - place) < ON_LINE), 0.0)
    return width if width < below else 0.0


SEEN = 1e-7  # estimated splits below this are not worth a warning
# a short wave of the edge takes some PULL E t, a tilt TILT D: fitted to reports.verification.modes.loose_bolts
PULL, TILT = 0.05, 0.5
NEAR = 30.0  # sqrt(t/radius) nodes around at bolts on the wall: a fifth of sqrt(radius t) apart, 2e-4 of a frequency
MOST = 128  # elements around up to which the default mesh follows every bolt


def following(least: int, count: int) -> int:
    """Number of elements around, at least a minimum, that follows `count` bolts: a multiple, or a divisor, of it.

    >>> following(21, 24), following(21, 16), following(21, 4), following(21, 200)
    (24, 32, 24, 100)
    """
    shares = [count // part for part in range(1, 5) if count % part == 0]
    wanted = [share * -(-least // share) for share in shares]
    return next((around for around in wanted if around <= MOST), wanted[0])


def springs_per_wave(bolts: Bolts, E: float, nu: float, thickness: float) -> float:
    """Stiffness of a bolt relative to that of the shell's edge for a short wave, the larger of translation and tilt."""
    rigidity = E * thickness**3 / (12.0 * (1.0 - nu**2))
    pull = np.max(np.real(bolts.stiffness)) / (PULL * E * thickness)
    return float(max(pull, np.real(bolts.k_rot) / (TILT * rigidity)))


def spurious_split(bolts: Bolts, mesh: ShellMesh, ratio: float, n_max: int = 12) -> float:
    """Order of magnitude of the largest relative split by the mesh alone in pairs that equal bolts keep whole.

    A model of the edge alone: waves e^(i m theta) have the stiffness |m| (that of the shell for short waves), bolts add
    `ratio` times their patches, both on the edge's own spectral elements; half the relative distance of its pairs.

    >>> follows, misses = (spurious_split(Bolts(count=24, k=1e8), ShellMesh(around=n, order=7), 3.0) for n in (24, 21))
    >>> bool(follows < 1e-10 < 1e-5 < misses)
    True
    """
    K, M, values, weights = edge_model(bolts, mesh)
    squares, waves = eigh(K, M)
    order = np.sqrt(np.maximum(squares, 0.0))
    at_points = values @ waves
    lam, shapes = eigh(np.diag(order) + ratio * at_points.T @ (weights[:, None] * at_points))
    splits = [0.0]
    for n in range(1, n_max + 1):
        own = np.round(order) == n
        if 2 * n % bolts.count and own.sum() == 2:  # else the mesh does not resolve these waves
            pair = np.argsort(-(shapes[own] ** 2).sum(axis=0), kind="stable")[:2]
            splits.append(0.5 * float(np.ptp(lam[pair]) / lam[pair].mean()))
    return max(splits)


def edge_model(bolts: Bolts, mesh: ShellMesh) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Slope and mass matrices of a closed line of spectral elements, values at the patches' points and weights."""
    p, size = mesh.order, 2.0 * np.pi / mesh.columns
    nodes = (np.arange(mesh.columns)[:, None] * p + np.arange(p + 1)) % (mesh.columns * p)
    x, w = gauss(p + 1)
    shape, slope = lagrange(p, x)
    K, M = np.zeros((2, mesh.columns * p, mesh.columns * p))
    np.add.at(K, (nodes[:, :, None], nodes[:, None, :]), (slope * w) @ slope.T / size)
    np.add.at(M, (nodes[:, :, None], nodes[:, None, :]), (shape * w) @ shape.T * size)
    places, weights, _ = bolts.points(size * np.arange(mesh.columns + 1), True, p + 4)
    along = np.mod(places, 2.0 * np.pi) / size
    cell = np.minimum(along.astype(int), mesh.columns - 1)
    values = np.zeros((len(places), len(K)))
    np.add.at(values, (np.arange(len(places))[:, None], nodes[cell]), lagrange(p, along - cell)[0].T)
    return K, M, values, weights
