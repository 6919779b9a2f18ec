"""Modes of a wheel by nodal diameter, from one sector; and on the mesh of the whole wheel for pictures and tests."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray, frozen
from casingfem.linalg.eigen import Band, EigenResult, solve
from casingfem.modal.mesh_modes import SHIFT, MeshModes, require_stable
from casingfem.modal.mode_columns import COLUMNS, ModeRows
from casingfem.modal.mode_set import RIGID, ranks
from casingfem.structure.imported.cyclic.sector import CyclicSector, CyclicSystem, assemble_cyclic
from casingfem.structure.imported.cyclic.wheel import wheel_fields, wheel_structure
from contact.io.columns import records_of
from contact.io.progress import each

ACROSS = 6  # frequencies on a line of the table


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class CyclicModes:
    """Modes of a wheel, by nodal diameter and then by frequency; each mode with 0 < n < N/2 represents a pair.

    Attributes
    ----------
    sector
        The wheel.
    freq
        Frequencies [Hz], (modes,).
    nodal_diameters, rank
        n, and m = 1, 2, ... among the modes of the same n, (modes,).
    fields
        Shapes z of sector 0 at its nodes, (nodes, 3 or 5, modes). The wheel's mass-normalised modes are Re and Im of
        z e^(2 pi i n j/N) in axes rotated with sector j; for n = 0 and N/2 only the real part.
    rigid
        Whether each is a rigid motion of the wheel, (modes,).
    sturm_counts
        n -> modes up to the last one returned, by inertia; None if round-off is too large for a count.
    unknowns
        Number of unknowns of the largest eigenproblem.
    seconds
        Run time by part.

    Examples
    --------
    >>> import casingfem as cf
    >>> wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = cf.imported.grid_mesh("hexahedron20", (1, 3, 1), lambda u: wall(u * [1.0, 0.125, 1.0]),
    ...                              groups={"base": (2, 0.0), "top": (2, 1.0)})
    >>> held = cf.Solid(mesh=part, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> sector = cf.imported.CyclicSector(structure=held, sectors=8)
    >>> found = cf.modal.cyclic_modes(sector, 1, diameters=[2])
    >>> found.nodal_diameters.tolist(), found.rank.tolist()
    ([2], [1])
    """

    sector: CyclicSector
    freq: FloatArray
    nodal_diameters: IntArray
    rank: IntArray
    fields: Array
    rigid: BoolArray
    sturm_counts: dict[int, int | None]
    unknowns: int
    seconds: dict[str, float]

    def __len__(self) -> int:
        """Number of modes, with a pair counted once."""
        return len(self.freq)

    def rows(self) -> ModeRows:
        """Columns of a table of modes with one row for each mode of the wheel; pairs are perfect."""
        count = np.array([self.sector.count(n) for n in self.nodal_diameters.tolist()], dtype=int)
        double = count == 2
        doublet, split = np.where(double, np.cumsum(double), -1), np.where(double, 0.0, np.nan)
        of = np.repeat(np.arange(len(self)), count)
        return ModeRows(
            freq=self.freq[of], n=self.nodal_diameters[of], purity=np.ones(len(of)), m=self.rank[of],
            doublet=doublet[of], split=split[of], angle_deg=np.full(len(of), np.nan), rigid=self.rigid[of],
        )  # fmt: skip

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each mode of the wheel, with the keys of `ModeSet.records`."""
        return records_of(COLUMNS, self.rows())

    def __repr__(self) -> str:
        """Table of the frequencies of each nodal diameter."""
        lines = [f"{'n':>4} {'':6} freq [Hz]"]
        for n in sorted(set(self.nodal_diameters.tolist())):
            cells = [f"{freq:11.3f}" for freq in self.freq[self.nodal_diameters == n]]
            heads = [f"{n:>4} {'pairs' if self.sector.count(n) == 2 else 'single':6}"]
            parts = ["".join(cells[k : k + ACROSS]) for k in range(0, len(cells), ACROSS)]
            lines += [f"{head:11}{part}" for head, part in zip(heads + [""] * (len(parts) - 1), parts, strict=True)]
        counted = "counted (Sturm)" if None not in self.sturm_counts.values() else "not all counted"
        size = f"{self.unknowns} unknowns of a sector"
        lines.append(f"{self.sector.sectors} sectors, {size}, {counted}, {sum(self.seconds.values()):.2f} s")
        return "\n".join(lines)


def cyclic_modes(
    sector: CyclicSector, wanted: int | Band = 12, *, diameters: Sequence[int] | None = None
) -> CyclicModes:
    """A number of modes of each nodal diameter of a wheel, or the modes of a band [Hz], complete by Sturm counts.

    Parameters
    ----------
    sector
        One sector. With a `rotation` its stiffness is that at the speed; for Coriolis forces use `cyclic_whirl`.
    wanted
        Number of modes of each diameter, with a pair counted once, or a band [Hz].
    diameters
        Some of 0 .. N/2; by default all.

    Raises
    ------
    ModelError
        `cyclic-diameters` for diameters that the wheel does not have; `rotation-unstable` if K(Omega) is not positive
        definite.
    NumericsError
        If the modes cannot be computed or verified.

    Examples
    --------
    >>> import casingfem as cf
    >>> wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = cf.imported.grid_mesh("hexahedron20", (1, 3, 2), lambda u: wall(u * [1.0, 0.125, 1.0]),
    ...                              groups={"base": (2, 0.0)})
    >>> held = cf.Solid(mesh=part, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> sector = cf.imported.CyclicSector(structure=held, sectors=8)
    >>> cf.modal.cyclic_modes(sector, 1, diameters=[2, 3]).freq.round(1).tolist()
    [2054.6, 2296.4]
    """
    started = time.perf_counter()
    chosen = checked_diameters(sector, diameters)
    system = assemble_cyclic(sector)
    assembled = time.perf_counter()
    found = {n: solved(system, n, wanted) for n in each(chosen, "nodal diameter")}
    count = wanted if isinstance(wanted, int) else None
    freq = [found[n].freq[:count] for n in chosen]
    fields = [wheel_shapes(system, n, found[n].vectors[:, :count]) for n in chosen]
    values = np.concatenate(freq)
    return CyclicModes(
        sector=sector,
        freq=frozen(values),
        nodal_diameters=frozen(np.repeat(chosen, [len(part) for part in freq])),
        rank=frozen(np.concatenate([np.arange(1, 1 + len(part)) for part in freq])),
        fields=frozen(np.concatenate(fields, axis=2)),
        rigid=frozen(2.0 * np.pi * values < RIGID * system.frequency_scale),
        sturm_counts={n: found[n].sturm_count for n in chosen},
        unknowns=max(len(found[n].vectors) for n in chosen),
        seconds={"assemble": assembled - started, "solve": time.perf_counter() - assembled},
    )


def checked_diameters(sector: CyclicSector, diameters: Sequence[int] | None) -> tuple[int, ...]:
    """The requested nodal diameters, ascending, each once."""
    chosen = tuple(sorted(set(sector.diameters if diameters is None else diameters)))
    if not chosen or not set(chosen) <= set(sector.diameters):
        found = f"cyclic.nodal_diameters: found {list(diameters or [])}, expected some of 0 to {sector.sectors // 2}"
        raise ModelError("cyclic-diameters", found)
    return chosen


def solved(system: CyclicSystem, n: int, wanted: int | Band) -> EigenResult:
    """The eigenpairs of one nodal diameter, vectors on the free dofs of the sector with x^H M x = 1."""
    K, M, T = system.matrices(n)
    found = solve(K, M, wanted, shift=-((SHIFT * system.frequency_scale) ** 2))
    if system.spin is not None:
        require_stable(K, found, f", n = {n}")
    vectors = T @ found.vectors
    return EigenResult(found.eigenvalues, vectors, found.sturm_count, found.products)


def wheel_shapes(system: CyclicSystem, n: int, vectors: Array) -> Array:
    """Vectors of one diameter as shapes, mass-normalised over the wheel, with real largest displacement."""
    shapes = system.system.expand(vectors * np.sqrt(system.sector.count(n) / system.sector.sectors))
    flat = shapes[:, :3].reshape(3 * len(shapes), -1)
    peak = flat[np.abs(flat).argmax(axis=0), np.arange(shapes.shape[2])]
    return np.asarray(shapes * (np.conj(peak) / np.abs(peak)))


def wheel_modes(found: CyclicModes) -> MeshModes:
    """The modes of all sectors, ascending, with pairs as cos and sin.

    With `count` modes of each diameter, the list is complete up to the lowest of their highest frequencies.

    >>> import casingfem as cf
    >>> wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = cf.imported.grid_mesh("hexahedron20", (1, 3, 1), lambda u: wall(u * [1.0, 0.125, 1.0]),
    ...                              groups={"base": (2, 0.0), "top": (2, 1.0)})
    >>> held = cf.Solid(mesh=part, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> sector = cf.imported.CyclicSector(structure=held, sectors=8)
    >>> found = wheel_modes(cf.modal.cyclic_modes(sector, 1))
    >>> found.freq.size, bool((np.diff(found.freq) >= 0.0).all())
    (8, True)
    """
    whole = wheel_structure(found.sector)
    c, s = wheel_fields(found.sector, found.fields, found.nodal_diameters, whole.mesh)
    double = np.array([found.sector.count(n) == 2 for n in found.nodal_diameters.tolist()], dtype=bool)
    freq = np.concatenate([found.freq, found.freq[double]])
    order = np.argsort(freq, kind="stable")
    n = np.concatenate([found.nodal_diameters, found.nodal_diameters[double]])[order]
    place = np.argsort(order)
    pairs = sorted((int(place[k]), int(place[len(found) + i])) for i, k in enumerate(np.flatnonzero(double)))
    return MeshModes(
        structure=whole,
        freq=frozen(freq[order]),
        fields=frozen(np.concatenate([c, s[:, :, double]], axis=2)[:, :, order]),
        nodal_diameters=frozen(n),
        purity=frozen(np.ones(len(n))),
        meridional=frozen(ranks(n, pairs)),
        doublets=tuple(pairs),
        angle_deg=frozen(np.full(len(n), np.nan)),
        rigid=int(np.count_nonzero(found.rigid) + np.count_nonzero(found.rigid & double)),
        sturm_count=None,
        dofs=found.unknowns,
        seconds=found.seconds,
    )
