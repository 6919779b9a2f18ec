"""Compare measured shapes with the models before and after an update: MAC of shapes and of planes, by sensor."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from casingfem.experiment.correlation.correlate import alike, partners, seen_mac
from casingfem.experiment.correlation.mac import comac
from casingfem.experiment.correlation.matches import Match, Pairing
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.modal.mode_set import Modes
from casingfem.updating.result import UpdateResult
from casingfem.updating.shapes import SensorShapes
from contact.io.columns import WIDE, Column, known, present, table_lines
from contact.io.reported import Reported

WORST = 6  # sensors named


class ShapeMatch(NamedTuple):
    """A row with its shape: the paired mode, the MAC with this mode and with its plane; None and nan if unpaired."""

    mode: int | None
    mac: float
    plane: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ShapeComparison:
    """Measured shapes and a model's modes.

    Attributes
    ----------
    modes, pairing
        Modes of the model, and their pairing with the table.
    rows
        Rows of the table that have a shape, (shapes,).
    mac
        MAC of every shape with every mode, (shapes, modes).
    found
        The match of each shape, in the order of the rows.
    comac
        COMAC of each sensor over the paired shapes, (sensors,); nan if there are none.
    """

    modes: Modes
    pairing: Pairing
    rows: IntArray
    mac: FloatArray
    found: tuple[ShapeMatch, ...]
    comac: FloatArray

    @property
    def mean_plane(self) -> float:
        """Mean MAC of planes over the paired shapes; nan if there are none."""
        planes = [match.plane for match in self.found if match.mode is not None]
        return float(np.mean(planes)) if planes else float("nan")


def matched(side: str) -> tuple[Column, ...]:
    """Table columns of the comparison with the model before or after the fit."""
    when = "before the fit" if side == "before" else "after it"

    def found(fit: "ShapeFit") -> tuple[ShapeMatch, ...]:
        comparison: ShapeComparison = getattr(fit, side)
        return comparison.found

    return (
        Column(f"computed_{side}", f"Number of the mode that the shape pairs with {when}.",
               lambda fit: [None if one.mode is None else one.mode + 1 for one in found(fit)], head=f"mode {side}",
               format="d"),
        Column(f"mac_{side}", f"MAC of the shape and this mode {when}.",
               lambda fit: present(one.mac for one in found(fit)), head=f"MAC {side}", format=".3f"),
        Column(f"plane_{side}", f"MAC of the planes that the two modes of the pair span, {when}.",
               lambda fit: present(one.plane for one in found(fit)), head=f"plane {side}", format=".3f"),
    )  # fmt: skip


COLUMNS = (
    Column("mode", "Mode number of the measured table.", lambda fit: fit.fit.table.mode[fit.after.rows], format="d"),
    Column("n", "Nodal diameters of the row, where the table has them.",
           lambda fit: known(fit.fit.table.n[fit.after.rows]), format="d"),
    Column("measured_hz", "Measured frequency.", lambda fit: fit.fit.table.freq_hz[fit.after.rows], head="measured",
           unit="Hz", format=".3f"),
    *matched("before"),
    *matched("after"),
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class ShapeFit(Reported):
    """The measured shapes against the models before and after an update; made by `shape_fit`.

    A row for each shape: the mode with which it pairs, and its MAC with this mode and with its plane, before and after.
    """

    COLUMNS: ClassVar = COLUMNS

    fit: UpdateResult
    shapes: SensorShapes
    before: ShapeComparison
    after: ShapeComparison

    def worst_sensors(self, count: int = WORST) -> list[tuple[int, float, float]]:
        """Label, and COMAC before and after, of the sensors that agree least after the fit."""
        order = np.argsort(self.after.comac, kind="stable")[:count]
        columns = (self.shapes.labels, self.before.comac, self.after.comac)
        return [(int(k), float(a), float(b)) for k, a, b in zip(*(c[order] for c in columns), strict=True)]

    def to_json(self) -> dict[str, object]:
        """Plain lists and numbers."""
        return {
            "rows": list(self.records()),
            "unused_hz": list(self.shapes.unused_hz),
            "unpaired_modes": [mode + 1 for mode in self.after.pairing.unpaired_modes],
            "worst_sensors": [
                dict(zip(("sensor", "comac_before", "comac_after"), one, strict=True)) for one in self.worst_sensors()
            ],
        }

    def __repr__(self) -> str:
        """MAC of planes before and after, the least one, and the shapes that were not fitted."""
        count, total = len(self.after.rows), len(self.fit.measured)
        lines = [f"shapes of {count} of {total} rows: MAC of planes {self.before.mean_plane:.3f} -> "
                 f"{self.after.mean_plane:.3f} in the mean"]  # fmt: skip
        found = zip(self.after.found, self.after.rows.tolist(), strict=True)
        paired = [(match.plane, row) for match, row in found if match.mode is not None]
        if paired:
            plane, row = min(paired)
            lines[0] += f", least {plane:.3f} (mode {self.fit.table.mode[row]})"
        lines += table_lines(self.COLUMNS, self.records(), width=WIDE)
        if self.shapes.unused_hz:
            lines.append(
                f"shapes without a row in the table: {', '.join(f'{f:.2f}' for f in self.shapes.unused_hz)} Hz"
            )
        return "\n".join(lines)


def shape_fit(fit: UpdateResult) -> ShapeFit | None:
    """Compare the shapes of an update with both its models; return None if it has no shapes.

    >>> import casingfem as cf
    >>> ring = cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.1), thickness=2e-3, supports={"base": cf.Clamped()},
    ...                 material=cf.Material(E=200e9, nu=0.3, rho=7800.0),
    ...                 radius_defect=cf.FourierField.of({6: 1e-3}), mesh=cf.ShellMesh(order=5, rows=1, around=9))
    >>> found = cf.modes(ring, 2)
    >>> table = cf.FrequencyTable.from_arrays(freq_hz=1.01 * found.freq, sigma_hz=0.01)
    >>> theta = np.linspace(0.0, 6.0, 20)
    >>> blank = cf.updating.SensorShapes.on_edge(ring, "top", theta, np.ones((20, 1)), 0.01)
    >>> shapes = cf.updating.SensorShapes.on_edge(ring, "top", theta, blank.readings(found), 0.01)
    >>> fit = cf.update(ring, table, [cf.Parameter(name="material.E", lower=1e11, upper=3e11)], shapes=shapes)
    >>> [round(row["mac_after"], 3) for row in cf.updating.shape_fit(fit).records()]
    [1.0, 1.0]
    """
    shapes = fit.given.shapes
    if shapes is None or not (isinstance(fit.before, Modes) and isinstance(fit.after, Modes)):
        return None
    before = compared(shapes, fit.before, fit.pairing_before)
    return ShapeFit(fit=fit, shapes=shapes, before=before, after=compared(shapes, fit.after, fit.pairing))


def compared(shapes: SensorShapes, modes: Modes, pairing: Pairing) -> ShapeComparison:
    """Compare the shapes with one model."""
    rows = np.flatnonzero(~np.isnan(shapes.shapes).any(axis=0))
    computed = shapes.readings(modes)
    likeness = seen_mac(shapes.shapes[:, rows], computed)
    matches = tuple(seen for match in pairing.matches if (seen := only_seen(match, rows)) is not None)
    of = {row: (match, mode) for match in matches for row, mode in zip(match.rows, match.modes, strict=True)}
    planes = {match.rows: alike(match, modes, shapes.shapes, computed) for match in matches}
    lost = ShapeMatch(None, float("nan"), float("nan"))
    found = tuple(
        ShapeMatch(of[row][1], float(likeness[k, of[row][1]]), planes[of[row][0].rows]) if row in of else lost
        for k, row in enumerate(rows.tolist())
    )
    by_sensor = np.full(len(shapes.a), np.nan)
    if matches:
        by_sensor = comac(*partners(matches, modes, shapes.shapes, computed))
    return ShapeComparison(modes=modes, pairing=pairing, rows=rows, mac=likeness, found=found, comac=by_sensor)


def only_seen(match: Match, rows: IntArray) -> Match | None:
    """Reduce a match to its rows with shapes; return None if there are none."""
    kept = [k for k, row in enumerate(match.rows) if row in rows]
    if not kept:
        return None
    values = {
        name: tuple(getattr(match, name)[k] for k in kept) for name in ("rows", "modes", "measured_hz", "computed_hz")
    }
    return Match(n=match.n, confidence=match.confidence, **values)
