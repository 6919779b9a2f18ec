"""Random mistuning: splits of the pairs of a casing due to imperfections, over many draws of its random fields."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np

from casingfem.io.arrays import BoolArray, FloatArray, IntArray
from casingfem.modal.family.splits import SplitMap
from casingfem.modal.mode_set import ModeSet
from casingfem.modal.modes import modes
from casingfem.structure.field.field import Field
from casingfem.structure.field.random import drop_random, is_random, redrawn
from casingfem.structure.geometry.chart import is_axisymmetric
from casingfem.structure.shell.shell import Shell, require_shell
from contact.io.columns import Column, records_of, table_lines
from contact.io.notebook import notebook_progress
from contact.io.reported import Reported

LIMIT = 2e-4  # of a frequency: what default meshes are made for; the error is usually below the estimate
CHUNK = 10  # draws solved together: results do not depend on the others
BEYOND = 8  # modes past those asked for, of which imperfections may move some below
MIXED = 24  # modes past these that mix with them: with 12, errors of frequencies are three times as large
TINY = 1e-12  # a split that is none


class Drawn(NamedTuple):
    """A doublet of the mean shell, its frequency [Hz], and its rows among all draws."""

    n: int
    m: int
    freq: float
    own: BoolArray


def quantiles(what: Callable[["Mistuning", Drawn], FloatArray], level: float) -> Callable[["Mistuning"], list[Any]]:
    """A quantile of a value over the draws of each doublet; None for a doublet that occurs in no draw."""
    return lambda found: [
        float(np.quantile(what(found, one), level)) if one.own.any() else None for one in found.doublets()
    ]


def splits_of(found: "Mistuning", one: Drawn) -> FloatArray:
    """Splits of a doublet over the draws."""
    return found.split[one.own]


def shifts_of(found: "Mistuning", one: Drawn) -> FloatArray:
    """Relative shifts of a doublet's mean frequency over the draws."""
    return found.freq[one.own] / one.freq - 1.0


def quantile_column(name: str, what: str, values: Any, per_cent: int, where: Any = "everywhere") -> Column:
    """The column of one quantile."""
    text = f"{what}: {per_cent} % of the draws are below it."
    return Column(f"{name}_{per_cent}", text, quantiles(values, per_cent / 100), head=f"{name} {per_cent}", unit="%",
                  format=".4f", scale=100.0, where=where)  # fmt: skip


SPLIT, SHIFT = "Relative split of the pair", "Relative shift of the pair's mean frequency"
DRAWS = (
    Column("draw", "Number of the draw.", lambda found: found.draw, format="d"),
    Column("n", "Nodal diameters.", lambda found: found.n, format="d"),
    Column("m", "Meridional rank.", lambda found: found.m, format="d"),
    Column("freq_hz", "Mean frequency of the pair.", lambda found: found.freq, head="freq", unit="Hz", format=".3f"),
    Column("split_rel", "Difference of the two frequencies over their mean.", lambda found: found.split, head="split",
           unit="%", format=".4f", scale=100.0),
    Column("angle_deg", "Angle of an antinode of the lower member.", lambda found: found.angle_deg, head="angle",
           unit="deg", format=".2f"),
)  # fmt: skip
SUMMARY = (
    Column("n", "Nodal diameters.", lambda found: [one.n for one in found.doublets()], format="d"),
    Column("m", "Meridional rank.", lambda found: [one.m for one in found.doublets()], format="d"),
    Column("freq_hz", "Frequency without the random fields.", lambda found: [one.freq for one in found.doublets()],
           head="freq", unit="Hz", format=".3f"),
    Column("draws", "Number of draws that have this pair among their modes.",
           lambda found: [int(one.own.sum()) for one in found.doublets()], format="d"),
    quantile_column("split", SPLIT, splits_of, 50),
    quantile_column("split", SPLIT, splits_of, 90),
    quantile_column("split", SPLIT, splits_of, 99),
    quantile_column("shift", SHIFT, shifts_of, 10, "pages"),
    quantile_column("shift", SHIFT, shifts_of, 50),
    quantile_column("shift", SHIFT, shifts_of, 90, "pages"),
)  # fmt: skip


class Pair(NamedTuple):
    """One doublet of one draw: mean frequency [Hz], relative split, orientation of the lower member [deg]."""

    draw: int
    n: int
    m: int
    freq_hz: float
    split_rel: float
    angle_deg: float


def redrawn_shell(shell: Shell, draw: int) -> Shell:
    """The shell with new draws of its random fields, on the same mesh.

    Raises
    ------
    ValueError
        If it has no random fields.
    """
    if not any(map(is_random, shell.defects.values())):
        found = "found a shell without random fields, expected a RandomField ([[imperfection]] random in study.toml)"
        raise ValueError(found)
    fields: dict[str, Any] = {f"{quantity}_defect": field for quantity, field in drawn_fields(shell, draw).items()}
    return replace(shell, **fields)


def drawn_fields(shell: Shell, draw: int) -> dict[str, Field]:
    """The fields of the shell by quantity, random ones drawn anew."""
    return {name: redrawn(field, draw) if is_random(field) else field for name, field in shell.defects.items()}


def mean_shell(shell: Shell) -> Shell:
    """The shell without the random parts of its fields, on the same mesh; deterministic parts are kept."""
    fields: dict[str, Any] = {f"{quantity}_defect": drop_random(field) for quantity, field in shell.defects.items()}
    return replace(shell, **fields)


def pairs_of(found: ModeSet, draw: int) -> list[Pair]:
    """The doublets of a set of modes; angles of perfect pairs are nan."""
    rows = []
    for (low, high), split in zip(found.doublets, found.splits, strict=True):
        n, m = int(found.nodal_diameters[low]), int(found.meridional[low])
        freq = float(0.5 * (found.freq[low] + found.freq[high]))
        rows.append(Pair(draw, n, m, freq, float(split), float(found.angle_deg[low])))
    return rows


class DrawnModes(NamedTuple):
    """Modes of one draw; `estimate` is their possible relative error, None if the draw was solved in full."""

    modes: ModeSet
    estimate: float | None


def pairs_map(shell: Shell, count: int) -> SplitMap | None:
    """The map from the draws of a shell to their lowest `count` modes; None if each needs a full solution."""
    return SplitMap.of(shell, count + BEYOND, MIXED)


def drawn_modes(shell: Shell, pairs: SplitMap | None, count: int, draws: range) -> list[DrawnModes]:
    """Lowest `count` modes of some draws, from multiples of `CHUNK` on, `CHUNK` at most.

    They are those of the map `pairs`; where it is not accurate enough, and without one, a draw is solved in full.
    """
    if pairs is None:
        return [solved_in_full(shell, count, draw) for draw in draws]
    whole = range(draws.start, draws.start + CHUNK)  # sums depend on the number of draws to the last bit
    found = pairs.near(pairs.series([drawn_fields(shell, draw) for draw in whole]), count)
    return [
        DrawnModes(near.modes, near.estimate)
        if near.complete and near.estimate <= LIMIT
        else solved_in_full(shell, count, draw)
        for draw, near in zip(draws, found, strict=False)
    ]


def solved_in_full(shell: Shell, count: int, draw: int) -> DrawnModes:
    """Lowest `count` modes of one draw by a full solution."""
    return DrawnModes(modes(redrawn_shell(shell, draw), count, method="shell"), None)


def chunks_of(draws: int) -> list[range]:
    """Draws 0 to draws - 1 in chunks.

    >>> chunks_of(12)
    [range(0, 10), range(10, 12)]
    """
    return [range(first, min(first + CHUNK, draws)) for first in range(0, draws, CHUNK)]


class Difference(NamedTuple):
    """Largest relative differences of a draw's modes from the full solution: of frequencies and of splits.

    The difference of splits is relative to the largest split of the draw.
    """

    freq: float
    split: float


def difference(shell: Shell, found: ModeSet, count: int, draw: int) -> Difference:
    """Difference between a draw's modes and its full solution."""
    full = modes(redrawn_shell(shell, draw), count, method="shell")
    freq = float(np.abs(found.freq[full.rigid :] / full.freq[full.rigid :] - 1.0).max(initial=0.0))
    if found.doublets != full.doublets or not full.doublets:
        return Difference(freq, float("nan"))
    return Difference(freq, float(np.abs(found.splits - full.splits).max() / max(full.splits.max(), TINY)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mistuning(Reported):
    """Doublets over many draws.

    Attributes
    ----------
    draw, n, m : (rows,) index of the draw, nodal diameters and meridional rank
    freq : (rows,) mean frequency of the pair [Hz]
    split : (rows,) (f_upper - f_lower)/mean
    angle_deg : (rows,) orientation of the lower member
    perfect : (n, m) -> frequency [Hz] of the casing without the random fields

    Examples
    --------
    >>> one = np.array([1])
    >>> found = Mistuning(draw=one, n=8 * one, m=one, freq=np.array([367.9]), split=np.array([1e-3]),
    ...                   angle_deg=np.array([4.0]), perfect={(8, 1): 367.9})
    >>> found.draws, found.doublets()
    (1, [Drawn(n=8, m=1, freq=367.9, own=array([ True]))])
    """

    COLUMNS: ClassVar = SUMMARY

    draw: IntArray
    n: IntArray
    m: IntArray
    freq: FloatArray
    split: FloatArray
    angle_deg: FloatArray
    perfect: dict[tuple[int, int], float]

    @classmethod
    def of(cls, rows: Iterable[Pair], perfect: Sequence[Pair]) -> "Mistuning":
        """From the rows of all draws, and those of the mean shell."""
        columns = [np.array(column) for column in zip(*rows, strict=True)] or [np.zeros(0)] * 6
        arrays = dict(zip(("draw", "n", "m", "freq", "split", "angle_deg"), columns, strict=True))
        return cls(**arrays, perfect={(pair.n, pair.m): pair.freq_hz for pair in perfect})

    @property
    def draws(self) -> int:
        """Number of draws."""
        return len(np.unique(self.draw))

    def columns(self) -> dict[str, Any]:
        """One row for each doublet of each draw."""
        return {column.name: column.values(self) for column in DRAWS}

    def doublets(self) -> list[Drawn]:
        """The doublets of the mean shell, ascending, each with its draws.

        The draws are those in which a doublet of this n and m was among the modes computed: fields that mix shapes may
        change its label, or move it out of the band.
        """
        ascending = sorted(self.perfect.items(), key=lambda item: item[1])
        return [Drawn(n, m, freq, (self.n == n) & (self.m == m)) for (n, m), freq in ascending]

    def summary(self) -> list[dict[str, Any]]:
        """One row for each doublet of the mean shell: quantiles of the split and of the shift of its mean frequency."""
        return records_of(SUMMARY, self)

    def __repr__(self) -> str:
        """The summary as a table."""
        return "\n".join([*table_lines(SUMMARY, self.summary()), f"{self.draws} draws"])


def mistune(shell: Shell, draws: int, *, count: int = 40, progress: Callable[[int], None] | None = None) -> Mistuning:
    """Splits and orientations of a shell's pairs over draws 0, 1, ... of its random fields, one after the other.

    Most draws come from the waves of the perfect casing (`SplitMap`). This needs fields that are Fourier series
    around, and edges that are free, clamped or embedded. Other casings are solved in full, and so are draws with an
    estimated frequency error above 2e-4. A draw depends only on its number. `casingfem mistune study.toml` does the
    same on several cores. It checks some draws, and it can be resumed.

    Raises
    ------
    ValueError
        If nothing of the shell is random, or it is open and has no pairs.

    Examples
    --------
    >>> from casingfem import Clamped, Cylinder, Material, Shell, ShellMesh, field
    >>> lab = field.RandomField.example(thickness=0.01, radius=0.5, seed=7, scale=0.1, p_max=8)
    >>> tube = Shell(chart=Cylinder(radius=0.5, height=0.3), thickness=0.01, supports={"base": Clamped()},
    ...              material=Material(E=210e9, nu=0.3, rho=7800.0), radius_defect=lab,
    ...              mesh=ShellMesh(order=5, rows=1, around=9))
    >>> mistune(tube, 3, count=8).draws
    3
    """
    require_pairs(shell)
    progress = progress or notebook_progress("mistune", f"{{}} of {draws} draws".format)
    pairs = pairs_map(shell, count)
    rows: list[Pair] = []
    for chunk in chunks_of(draws):
        for draw, found in zip(chunk, drawn_modes(shell, pairs, count, chunk), strict=True):
            rows += pairs_of(found.modes, draw)
        if progress is not None:
            progress(chunk.stop)
    return Mistuning.of(rows, mean_pairs(shell, count))


def require_pairs(shell: Shell) -> None:
    """Refuse shells whose modes do not come in pairs, and those on which nothing is random."""
    require_shell(shell, "mistune")
    if not is_axisymmetric(shell.chart):
        raise ValueError(
            "mistune: found a chart that is not axisymmetric, expected a casing of revolution, which has pairs"
        )
    redrawn_shell(shell, 0)


def mean_pairs(shell: Shell, count: int) -> list[Pair]:
    """The doublets among the lowest `count` modes of the mean shell."""
    return pairs_of(modes(mean_shell(shell), count), -1)
