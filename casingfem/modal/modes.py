"""Modes of a shell: `modes(shell, count)` and the table an engineer wants."""

import time
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh

from casingfem.arrays import FloatArray, IntArray, frozen
from casingfem.modal.eigen import EigenError, scaled, solve_modes, sturm_count
from casingfem.modal.harmonics import DOUBLE, Rings, align_pair, find_doublets, orientation, ring_content
from casingfem.structure.assembly import System, assemble
from casingfem.structure.axisymmetric import HOOP, Meridian, harmonic_matrices
from casingfem.structure.mesh import Grid, make_grid
from casingfem.structure.shell import Shell

RIGID = 0.05  # modes below this part of `frequency_scale` are rigid motions
SHIFT = 0.5  # shift-invert about minus the square of this part of `frequency_scale`


@dataclass(frozen=True, eq=False, kw_only=True)
class Modes:
    """Modes of a shell, ascending, mass-normalised.

    Attributes
    ----------
    freq
        Frequencies [Hz], (modes,).
    fields
        Shapes at the nodes of `grid`: u_x, u_y, u_z, w_1, w_2, (nodes, 5, modes), phi^T M phi = 1.
    nodal_diameters
        Dominant circumferential order n, -1 on open shells, (modes,).
    purity
        Share of the dominant order in the shape's circumferential energy, nan on open shells.
    meridional
        Rank m = 1, 2, ... among the modes of the same n, a doublet counted once.
    doublets
        Index pairs (lower, upper).
    angle_deg
        Orientation: an antinode of the radial displacement, in [0, 180/n); nan where it means nothing,
        as for a perfect double mode.
    rigid
        Number of rigid motions, which come first.
    sturm_count
        Modes up to the last one returned, by inertia: equal to len(modes) unless the cut splits a pair.
    dofs
        Unknowns of the eigenproblem (over all harmonics for a perfect casing).
    rings
        Circumferential Fourier amplitudes of the shapes, None on open shells.
    seconds
        Run time by part.
    """

    shell: Shell
    grid: Grid
    freq: FloatArray
    fields: FloatArray
    nodal_diameters: IntArray
    purity: FloatArray
    meridional: IntArray
    doublets: tuple[tuple[int, int], ...]
    angle_deg: FloatArray
    rigid: int
    sturm_count: int
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

    def records(self) -> list[dict[str, object]]:
        """One plain dictionary a mode: mode, freq_hz, n, n_purity, m, doublet, split_rel, angle_deg."""
        splits = self.splits
        rows: list[dict[str, object]] = []
        for k, freq in enumerate(self.freq):
            pair = self.doublet_of(k)
            rows.append(
                {
                    "mode": k + 1,
                    "freq_hz": float(freq),
                    "n": int(self.nodal_diameters[k]),
                    "n_purity": _number(self.purity[k]),
                    "m": int(self.meridional[k]),
                    "doublet": pair + 1 if pair >= 0 else None,
                    "split_rel": float(splits[pair]) if pair >= 0 else None,
                    "angle_deg": _number(self.angle_deg[k]),
                    "rigid": k < self.rigid,
                }
            )
        return rows

    def __repr__(self) -> str:
        """Table: mode, frequency, n, purity, m, split, orientation."""
        lines = [f"{'mode':>4} {'freq [Hz]':>11} {'n':>3} {'pure':>5} {'m':>2} {'split [%]':>9} {'angle [deg]':>11}"]
        for row in self.records():
            n = row["n"] if row["n"] != -1 else "-"
            purity = "-" if row["n_purity"] is None else f"{row['n_purity']:.2f}"
            split = "-" if row["split_rel"] is None else f"{100.0 * float(str(row['split_rel'])):.4f}"
            angle = "-" if row["angle_deg"] is None else f"{row['angle_deg']:.2f}"
            if row["rigid"]:
                n, split, angle, purity = "-", "rigid", "-", "-"
            lines.append(
                f"{row['mode']:>4} {row['freq_hz']:>11.3f} {n:>3} {purity:>5} {row['m']:>2} {split:>9} {angle:>11}"
            )
        lines.append(
            f"{len(self)} modes, {self.dofs} dofs, Sturm count {self.sturm_count}, {sum(self.seconds.values()):.2f} s"
        )
        return "\n".join(lines)


def _number(value: float) -> float | None:
    """A float, or None where it is not a number."""
    return None if np.isnan(value) else float(value)


def frequency_scale(shell: Shell) -> float:
    """Bending frequency c t / size^2 [rad/s] of the shell taken as flat: a floor for its elastic modes."""
    (a0, a1), (b0, b1) = shell.chart.bounds
    a, b = np.meshgrid(np.linspace(a0, a1, 9), np.linspace(b0, b1, 33), indexing="ij")
    x = shell.chart.surface(a.ravel(), b.ravel(), None).x
    size = float(np.linalg.norm(np.ptp(x, axis=1)))
    return float(np.sqrt(shell.material.E / shell.material.rho) * shell.thickness / size**2)


def modes(shell: Shell, count: int = 40, *, method: str = "auto", system: System | None = None) -> Modes:
    """Lowest `count` modes of a shell, labelled, complete by a Sturm count.

    K phi = omega^2 M phi, phi^T M phi = 1.

    Parameters
    ----------
    shell
        The structure. Without supports the rigid motions come first and are marked as such.
    count
        Number of modes.
    method
        "shell": the two-dimensional model. "fourier": one meridian problem per n, for perfect casings.
        "auto": "fourier" where nothing varies around, else "shell".
    system
        The assembled shell, if there is one already.

    Raises
    ------
    ValueError
        Unknown method, count below 1, or "fourier" asked of a casing that is not axisymmetric.
    EigenError
        If the modes cannot be computed or certified.

    Examples
    --------
    >>> from casingfem.structure.chart import Frustum
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.support import Clamped
    >>> casing = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3,
    ...                material=Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": Clamped()})
    >>> low = modes(casing, 4)
    >>> low.freq.round(1).tolist(), low.nodal_diameters.tolist()
    ([367.9, 367.9, 382.8, 382.8], [8, 8, 7, 7])
    """
    if method not in ("auto", "shell", "fourier"):
        raise ValueError(f'method must be "auto", "shell" or "fourier", found {method!r}')
    if count < 1:
        raise ValueError(f"count must be at least 1, found {count}")
    if method == "fourier" or (method == "auto" and shell.axisymmetric and system is None):
        return fourier_modes(shell, count)
    started = time.perf_counter()
    system = system or assemble(shell)
    assembled = time.perf_counter()
    shift = -((SHIFT * frequency_scale(shell)) ** 2)
    found = solve_modes(system.K, system.mass, count, shift=shift)
    solved = time.perf_counter()
    freq = np.sqrt(np.maximum(found.eigenvalues, 0.0)) / (2.0 * np.pi)
    fields = system.expand(found.vectors)
    return labelled(
        shell,
        system.grid,
        freq,
        fields,
        count=count,
        sturm=found.sturm_count,
        dofs=system.size,
        seconds={"assemble": assembled - started, "solve": solved - assembled},
    )


def labelled(
    shell: Shell,
    grid: Grid,
    freq: FloatArray,
    fields: FloatArray,
    *,
    count: int,
    sturm: int,
    dofs: int,
    seconds: dict[str, float],
) -> Modes:
    """Label modes computed up to a clear gap, align perfect pairs, and keep the first `count`."""
    started = time.perf_counter()
    rigid = int(np.count_nonzero(2.0 * np.pi * freq < RIGID * frequency_scale(shell)))
    total = len(freq)
    rings: Rings | None = None
    n, purity = np.full(total, -1), np.full(total, np.nan)
    angle = np.full(total, np.nan)
    pairs: list[tuple[int, int]] = []
    if shell.chart.periodic:
        nodes_around = grid.mesh.order * grid.mesh.around
        rings = ring_content(shell.chart, grid, fields, n_max=max(2, nodes_around // 3))
        n, purity = rings.label()
        n[:rigid], purity[:rigid] = -1, np.nan
        pairs = find_doublets(rings, n)
        angle = np.array([orientation(rings.profile(k, n[k]), n[k]) if n[k] > 0 else np.nan for k in range(total)])
        fields = align_doubles(rings, n, freq, fields, angle, pairs)
    fields *= peak_signs(fields)
    kept = min(count, total)
    if shell.chart.periodic:
        rings = ring_content(shell.chart, grid, fields[:, :, :kept], n_max=max(2, nodes_around // 3))
    return Modes(
        shell=shell,
        grid=grid,
        freq=frozen(freq[:kept]),
        fields=frozen(fields[:, :, :kept]),
        nodal_diameters=frozen(n[:kept]),
        purity=frozen(purity[:kept]),
        meridional=frozen(ranks(n, pairs)[:kept]),
        doublets=tuple(pair for pair in pairs if max(pair) < kept),
        angle_deg=frozen(np.degrees(angle[:kept])),
        rigid=rigid,
        sturm_count=sturm,
        dofs=dofs,
        rings=rings,
        seconds=seconds | {"label": time.perf_counter() - started},
    )


def align_doubles(
    rings: Rings,
    n: IntArray,
    freq: FloatArray,
    fields: FloatArray,
    angle: FloatArray,
    pairs: list[tuple[int, int]],
) -> FloatArray:
    """Turn perfect double modes into cosine and sine, and clear their angles: they have none of their own."""
    fields = fields.copy()
    for low, high in pairs:
        if freq[high] - freq[low] <= DOUBLE * freq[high]:
            turn = align_pair(rings.profile(low, n[low]), rings.profile(high, n[low]))
            fields[:, :, [low, high]] = fields[:, :, [low, high]] @ turn
            angle[[low, high]] = np.nan
    return fields


def peak_signs(fields: FloatArray) -> FloatArray:
    """Signs (modes,) that make the first of the largest displacements of each mode positive."""
    displacements = fields[:, :3].reshape(-1, fields.shape[2])
    large = np.abs(displacements) > (1.0 - 1e-6) * np.abs(displacements).max(axis=0)
    return np.asarray(np.sign(displacements[large.argmax(axis=0), np.arange(fields.shape[2])]))


def ranks(n: IntArray, pairs: list[tuple[int, int]]) -> IntArray:
    """Meridional rank of each mode among those of its n, a doublet counted once."""
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


def count_below(shell: Shell, freq: float) -> int:
    """Number of modes below a frequency [Hz], by one factorisation and its inertia."""
    system = assemble(shell)
    return sturm_count(scaled(system.K, system.mass), (2.0 * np.pi * freq) ** 2)


def fourier_modes(shell: Shell, count: int) -> Modes:
    """Lowest modes of a perfect casing, one dense meridian problem for each n, doublets exact.

    Harmonics are added until four in a row start above the band; every eigenvalue of each is known, so the
    count is complete.
    """
    started = time.perf_counter()
    grid = make_grid(shell.chart, shell.mesh)
    found: list[tuple[float, int, FloatArray]] = []
    shift = (SHIFT * frequency_scale(shell)) ** 2
    above, n, limit = 0, 0, np.inf
    while above < 4:
        meridian = harmonic_matrices(shell, n)
        values, vectors = lowest(meridian, count, shift)
        shapes = meridian.expand(vectors)
        for k in np.flatnonzero(values <= limit):
            found += [(float(values[k]), n, shapes[:, :, k])] * (1 if n == 0 else 2)
        if len(found) >= count:
            found.sort(key=lambda item: (item[0], item[1]))
            limit = found[count - 1][0] * (1.0 + 1e-12)
            found = [item for item in found if item[0] <= limit]
        above = above + 1 if values[0] > limit else 0
        n += 1
        if n > 400:
            raise EigenError(f"{count} modes reach beyond 400 nodal diameters: refine the question")
    freq = np.sqrt(np.maximum([value for value, _, _ in found], 0.0)) / (2.0 * np.pi)
    fields = np.stack(
        [
            revolve_shape(grid, shape, n, sine=n > 0 and k > 0 and found[k - 1][2] is shape)
            for k, (_, n, shape) in enumerate(found)
        ],
        axis=-1,
    )
    seconds = {"solve": time.perf_counter() - started}
    return labelled(
        shell, grid, freq, fields, count=count, sturm=len(found), dofs=n * len(meridian.free), seconds=seconds
    )


def lowest(meridian: Meridian, count: int, shift: float) -> tuple[FloatArray, FloatArray]:
    """Lowest eigenvalues and mass-normalised vectors of one harmonic, by the inverse of K + shift M.

    Small eigenvalues (rigid motions, thin free rings) would drown in the round-off of K's large ones.
    """
    root = 1.0 / np.sqrt(meridian.mass)
    size = len(root)
    factor = cho_factor(root[:, None] * meridian.K * root + shift * np.eye(size))
    flexibility = cho_solve(factor, np.eye(size))
    start = max(0, size - count)
    values, vectors = eigh(0.5 * (flexibility + flexibility.T), subset_by_index=[start, size - 1])
    return 1.0 / values[::-1] - shift, root[:, None] * vectors[:, ::-1]


def revolve_shape(grid: Grid, shape: FloatArray, n: int, *, sine: bool) -> FloatArray:
    """Spread a meridian shape (nodes on the meridian, 5) around: nodal field (nodes, 5), mass-normalised."""
    z, theta = grid.nodes
    _, row = np.unique(np.round(z / np.ptp(z), 9), return_inverse=True)
    wave = (shape * HOOP)[row] * np.exp(1j * n * theta)[:, None]
    hoop_only = np.abs(shape[:, [1, 4]]).max() > np.abs(shape[:, [0, 2, 3]]).max()
    part = wave.imag if sine or (n == 0 and hoop_only) else wave.real
    c, s = np.cos(theta), np.sin(theta)
    field = part.copy()
    field[:, 0] = part[:, 0] * c - part[:, 1] * s
    field[:, 1] = part[:, 0] * s + part[:, 1] * c
    return np.asarray(field / np.sqrt(2.0 * np.pi if n == 0 else np.pi))
