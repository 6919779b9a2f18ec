"""A set of modes: frequencies, shapes, labels, and their table."""

import time
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray, IntArray, frozen
from casingfem.modal.harmonics import DOUBLE, Rings, align_pair, find_doublets, orientation, ring_content
from casingfem.modal.mode_columns import COLUMNS, ModeRows
from casingfem.structure.geometry.chart import is_axisymmetric
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.parts import sampled_geometry
from casingfem.structure.shell.rigid import rigid_modes
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.wall import section
from contact.io.columns import records_of, table_lines
from contact.io.reported import Reported

RIGID = 0.05  # below this part of `frequency_scale` nothing elastic moves


@dataclass(frozen=True, eq=False, kw_only=True)
class ModeSet(Reported):
    """Modes of a structure, ascending, mass-normalised, with labels.

    Attributes
    ----------
    freq
        Frequencies [Hz], (modes,).
    fields
        Shapes at the nodes: u_x, u_y, u_z, and w_1, w_2 on shells, (nodes, 3 or 5, modes), phi^T M phi = 1.
    nodal_diameters
        Dominant circumferential order n (waves around, by arc length on a closed chart that is not axisymmetric), -1 on
        open shells, (modes,).
    purity
        Share of the dominant order in the shape's circumferential energy, nan on open shells.
    meridional
        Rank m = 1, 2, ... among the modes of the same n in this set, a doublet counted once.
    doublets
        Index pairs (lower, upper).
    angle_deg
        Orientation: an antinode of the radial displacement, in [0, 180/n); nan if it is undefined, as for a perfect
        double mode, and on surfaces that are not of revolution.
    rigid
        Number of rigid motions that the supports allow; they come first.
    sturm_count
        Modes up to the last one returned, or in the band, by inertia: equal to len(modes) unless the list ends within a
        pair. None for solids too large to count (`mesh_modes`), and if round-off is too large for a count.
    dofs
        Unknowns of the eigenproblem (over all harmonics for a perfect casing).
    rings
        Circumferential Fourier amplitudes of the shapes, None on open shells.
    seconds
        Run time by part.
    """

    COLUMNS: ClassVar = COLUMNS

    freq: FloatArray
    fields: FloatArray
    nodal_diameters: IntArray
    purity: FloatArray
    meridional: IntArray
    doublets: tuple[tuple[int, int], ...]
    angle_deg: FloatArray
    rigid: int
    sturm_count: int | None
    dofs: int
    rings: Rings | None = field(default=None, repr=False)
    seconds: dict[str, float] = field(default_factory=dict)

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.freq)

    @property
    def omega(self) -> FloatArray:
        """Angular frequencies [rad/s]."""
        return 2.0 * np.pi * self.freq

    @property
    def splits(self) -> FloatArray:
        """Relative split (f_upper - f_lower)/mean of each doublet, in the order of `doublets`."""
        pairs = self.freq[np.array(self.doublets, dtype=int).reshape(-1, 2)]
        return np.asarray(np.diff(pairs, axis=1)[:, 0] / pairs.mean(axis=1))

    def doublet_of(self, mode: int) -> int:
        """Index into `doublets`, or -1 for a single mode."""
        return next((k for k, pair in enumerate(self.doublets) if mode in pair), -1)

    def rows(self) -> ModeRows:
        """Values of the columns."""
        members = np.array(self.doublets, dtype=int).reshape(-1, 2)
        doublet, split = np.full(len(self), -1), np.full(len(self), np.nan)
        doublet[members] = np.arange(1, 1 + len(members))[:, None]
        split[members] = self.splits[:, None]
        rigid = np.arange(len(self)) < self.rigid
        return ModeRows(
            self.freq, self.nodal_diameters, self.purity, self.meridional, doublet, split, self.angle_deg, rigid
        )

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each mode: mode, freq_hz, n, n_purity, m, doublet, split_rel, angle_deg, rigid."""
        return records_of(self.COLUMNS, self.rows())

    def __repr__(self) -> str:
        """The columns that have a value for some mode as a table, and the method of computation."""
        counted = f"Sturm count {self.sturm_count}" if self.sturm_count is not None else "not counted"
        computed = f"{len(self)} modes, {self.dofs} dofs, {counted}, {sum(self.seconds.values()):.2f} s"
        rows = self.records()
        shown = tuple(column for column in self.COLUMNS if any(row.get(column.name) is not None for row in rows))
        return "\n".join([*table_lines(shown or self.COLUMNS, rows), computed])


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Modes(ModeSet):
    """Modes of a shell on a chart: `fields` are at the nodes of `grid`.

    `own` contains the additional dofs of rings, rotations about the wall's normal, (own, modes). With `by_harmonics`
    the grid only shows the shapes, of coupled harmonics: at bolts it does not follow them closely enough for energies.

    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> found = cf.modes(plate, 2)
    >>> found.freq.round(1).tolist(), found.records()[0]["mode"]
    ([21.5, 92.5], 1)
    """

    shell: Shell
    grid: Grid
    own: FloatArray
    by_harmonics: bool = False

    @property
    def structure(self) -> Shell:
        """The shell, under the name that all structures use."""
        return self.shell


def require_energies(modes: Modes) -> None:
    """Refuse modes by coupled harmonics (`modes-harmonics`): at bolts their grid does not give energies."""
    if modes.by_harmonics:
        found = "found those of a bolted casing by harmonics, expected those of the two-dimensional model"
        raise ModelError("modes-harmonics", f"modes: {found}")


def frequency_scale(shell: Shell) -> float:
    """Bending frequency [rad/s] of the shell as a flat plate: a lower bound for its elastic modes.

    sqrt(min(E t^3)/max(rho t))/size^2, the weakest section with the heaviest wall; c t/size^2 for a uniform wall.

    >>> import casingfem as cf
    >>> steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    >>> plate = cf.Shell(chart=cf.Plate(length=0.8, width=0.6), thickness=0.01, material=steel)
    >>> round(frequency_scale(plate) / ((210e9 / 7800.0) ** 0.5 * 0.01), 6)  # the diagonal is 1 m
    1.0
    """
    at = sampled_geometry(shell, 33)
    size = float(np.linalg.norm(np.ptp(np.real(at.surface.x).reshape(3, -1), axis=1)))
    ways = [section(shell, at, way) for way in (0, 1)]
    weakest, heaviest = min(way.bending.min() for way in ways), ways[0].mass.max()
    return float(np.sqrt(weakest / heaviest) / size**2)


class Labels(NamedTuple):
    """Labels of modes from their circumferential content: n, purity, partners, antinode angles [rad], aligned fields.

    `rings` is the content of the aligned fields.
    """

    n: IntArray
    purity: FloatArray
    pairs: list[tuple[int, int]]
    angle: FloatArray
    fields: FloatArray
    rings: Rings | None


def make_labels(rings: Rings | None, freq: FloatArray, fields: FloatArray, rigid: int) -> Labels:
    """Label modes by their circumferential content, align perfect pairs, fix signs.

    Without content there are no labels.
    """
    total = len(freq)
    if rings is None:
        nothing = np.full(total, np.nan)
        return Labels(np.full(total, -1), nothing, [], nothing, fields * peak_signs(fields), None)
    n, purity = rings.label()
    n[:rigid], purity[:rigid] = -1, np.nan
    pairs = find_doublets(rings, n)
    angle = np.array([orientation(rings.profile(k, n[k]), n[k]) if n[k] > 0 else np.nan for k in range(total)])
    turns = double_turns(rings, n, freq, pairs)
    for low, high, _ in turns:  # perfect doubles have no angle of their own
        angle[[low, high]] = np.nan
    fields = turned(fields, turns)
    signs = peak_signs(fields)
    aligned = Rings(turned(rings.amplitudes, turns) * signs, rings.weights)
    return Labels(n, purity, pairs, angle, fields * signs, aligned)


def labelled(
    shell: Shell,
    grid: Grid,
    freq: FloatArray,
    fields: FloatArray,
    own: FloatArray,
    *,
    count: int,
    sturm: int | None,
    dofs: int,
    seconds: dict[str, float],
    by_harmonics: bool = False,
) -> Modes:
    """Label modes computed up to a clear gap, align perfect pairs, and keep the first `count`."""
    started = time.perf_counter()
    rigid = rigid_modes(shell, grid, fields, own)
    rings = ring_content(shell.chart, grid, fields) if shell.chart.periodic else None
    beside = np.zeros((len(own), *fields.shape[1:]))  # turned and signed together with the nodes' motions
    beside[:, 3] = own
    labels = make_labels(rings, freq, np.concatenate([fields, beside]), rigid)
    own = labels.fields[len(fields) :, 3]
    angle = labels.angle if is_axisymmetric(shell.chart) else np.full(len(freq), np.nan)
    labels = labels._replace(fields=labels.fields[: len(fields)], angle=angle)
    kept = min(count, len(freq))
    return Modes(
        shell=shell,
        grid=grid,
        own=frozen(own[:, :kept]),
        by_harmonics=by_harmonics,
        **first_modes(freq, labels, kept),
        rigid=min(rigid, kept),
        sturm_count=sturm,
        dofs=dofs,
        seconds=seconds | {"label": time.perf_counter() - started},
    )


def first_modes(freq: FloatArray, labels: Labels, kept: int) -> dict[str, Any]:
    """The fields of a `ModeSet` that depend on the mode, for the first `kept` modes."""
    return {
        "freq": frozen(freq[:kept]),
        "fields": frozen(labels.fields[:, :, :kept]),
        "nodal_diameters": frozen(labels.n[:kept]),
        "purity": frozen(labels.purity[:kept]),
        "meridional": frozen(ranks(labels.n, labels.pairs)[:kept]),
        "doublets": tuple(pair for pair in labels.pairs if max(pair) < kept),
        "angle_deg": frozen(np.degrees(labels.angle[:kept])),
        "rings": None if labels.rings is None else labels.rings.first(kept),
    }


def double_turns(
    rings: Rings, n: IntArray, freq: FloatArray, pairs: list[tuple[int, int]]
) -> list[tuple[int, int, FloatArray]]:
    """Perfect double modes, and the rotations (2, 2) into cosine and sine."""
    doubles = [pair for pair in pairs if freq[pair[1]] - freq[pair[0]] <= DOUBLE * freq[pair[1]]]
    return [(a, b, align_pair(rings.profile(a, n[a]), rings.profile(b, n[a]))) for a, b in doubles]


def turned(columns: Array, turns: list[tuple[int, int, FloatArray]]) -> Array:
    """Fields or amplitudes (..., modes) with some pairs of modes rotated."""
    T = np.eye(columns.shape[-1])
    for low, high, turn in turns:
        T[np.ix_([low, high], [low, high])] = turn
    flat = columns.reshape(-1, len(T)) if columns.size else np.zeros((0, len(T)))
    return np.asarray(flat @ T).reshape(columns.shape)


def peak_signs(fields: FloatArray) -> FloatArray:
    """Signs (modes,) that make the first of the largest displacements of each mode positive."""
    displacements = fields[:, :3].reshape(3 * len(fields), -1 if fields.size else 0)
    large = np.abs(displacements) > (1.0 - 1e-6) * np.abs(displacements).max(axis=0)
    return np.asarray(np.sign(displacements[large.argmax(axis=0), np.arange(fields.shape[2])]))


def ranks(n: IntArray, pairs: list[tuple[int, int]]) -> IntArray:
    """Meridional rank of each mode among those with its n, a doublet counted once."""
    upper = {high: low for low, high in pairs}
    m = np.zeros(len(n), dtype=np.int64)
    seen: dict[int, int] = {}
    for mode, label in enumerate(n.tolist()):
        if mode in upper:
            m[mode] = m[upper[mode]]
        else:
            seen[label] = seen.get(label, 0) + 1
            m[mode] = seen[label]
    return m
