"""The cells of reports' tables that README and docs quote, and their units.

A row's name is what is in its `keys`; a figure's is its column, with "%" where a relative value is quoted in per
cent. A report that changes its columns must be changed here: the campaign fails otherwise.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from reports.tools.campaign.figures import Figures

PERCENT = 100.0


@dataclass(frozen=True, slots=True)
class Table:
    """Cells of one CSV: `columns` with the factor that makes the page's unit of them, rows whose cells are `only`.

    `title` goes before the name of each row.
    """

    file: str
    keys: tuple[str, ...]
    columns: Mapping[str, float]
    only: Mapping[str, str] = field(default_factory=dict)
    title: str = ""

    def figures(self, out: Path) -> Figures:
        """Its rows by name; an empty cell is left out."""
        with (out / self.file).open(newline="", encoding="utf-8") as stream:
            lines = [line for line in csv.DictReader(stream) if all(line[k] == v for k, v in self.only.items())]
        return {
            " ".join(filter(None, (self.title, *(line[key] for key in self.keys)))) or "all": {
                name + (" %" if factor == PERCENT and "%" not in name else ""): factor * float(line[name])
                for name, factor in self.columns.items()
                if line[name] not in ("", "-")
            }
            for line in lines
        }


def plain(*names: str) -> dict[str, float]:
    """Columns quoted as they are written."""
    return dict.fromkeys(names, 1.0)


def percent(*names: str) -> dict[str, float]:
    """Columns of relative values that are quoted in per cent."""
    return dict.fromkeys(names, PERCENT)


IMPULSE = "impulse error"
QUOTED: dict[str, tuple[Table, ...]] = {
    "verification.modes.frustum": (
        Table(
            "frustum_convergence.csv", ("method", "order", "rows", "around"),
            plain("dofs", "worst error", "rms error", "doublet gap"),
        ),
    ),
    "verification.cylinder": (
        Table(
            "cylinder_summary.csv", ("h/R",),
            plain("rows", "within 0.1 %", "worst %", "linear within", "linear worst %", "Fluegge within")
            | plain("Fluegge worst %"),
        ),
    ),
    "verification.cylinder_exact": (
        Table("cylinder_exact.csv", ("h/R", "L/R", "n", "m"), plain("linear wall %", "curved wall %")),
    ),
    "verification.modes.locking": (Table("locking.csv", ("mesh", "R/t"), plain("2-D shell")),),
    "verification": (
        Table("verification_summary.csv", (), plain("rows", "pass", "reason", "fail", "forbidden splits", "turned")),
        Table("verification.csv", ("case",), plain("error %"), only={"source": "3-D, spectral"}),
    ),
    "verification.static": (Table("verify_static.csv", ("case",), plain("error %")),),
    "verification.modes.loose_bolts": (
        Table("loose_bolts_mesh.csv", ("order", "rows", "around"), plain("unknowns", "worst", "rms")),
    ),
    "verification.modes.imported": (
        Table("imported_solids.csv", ("case", "cells"), plain("worst error")),
        Table("imported_shells.csv", ("cells", "around x along"), plain("worst error")),
    ),
    "studies.rig": (
        Table("rig_summary.csv", ("case",), percent("RMS before", "RMS after", "left out")),
        Table("rig_rubs.csv", ("blade",), plain("as built [dB]", "defect machined away [dB]")),
    ),
    "verification.updating.identification": (
        Table(
            "identification_summary.csv", (),
            plain("sets", "clear found", "clear", "spurious"),
        ),
    ),
    "studies.rig.measure": (
        Table(
            "rig_measure_summary.csv", ("model",),
            plain("used", "unseen", "before sigma rms", "before % rms", "after sigma rms", "after % rms"),
        ),
    ),
    "verification.updating.twin": (Table("update_twin_summary.csv", (), plain("least covered %", "most covered %")),),
    "verification.schemes.accuracy": (
        Table(
            "contact_accuracy.csv", ("case", "method", "size", "step"),
            plain("force L1 %", "windowed L1 %", "impulse %", "energy loss %", "penetration [m]"),
        ),
        Table("contact_accuracy_long.csv", ("law", "omega dt"), plain("energy drift", "scatter"), only={"runs": "8"}),
    ),
    "benchmarks.work_precision": (
        Table(
            "work_precision.csv", ("method",), percent("force L1", "force L2", "impulse", "energy"),
            only={"scene": "two rods", "elements": "200", "courant": "0.5"},
        ),
    ),
    "verification.schemes.targets": (Table("contact_targets_summary.csv", (), plain("met", "targets", "known")),),
    "studies.section_44": (
        Table("section_44.csv", ("rub", "blade"), plain("over next [dB]", "dt/2 [dB]", "328 modes [dB]")),
    ),
    "studies.wear": (Table("wear.csv", ("coating",), plain("last turn [%]", "worn [cm^3]")),),
    "verification.rubs.bladed_disk": (
        Table(
            "bladed_disk.csv", ("n",),
            plain("f_c + f_b = n f [Hz]", "run [Hz]", "run [1/s]", "poles [Hz]", "poles [1/s]"),
        ),
        Table("bladed_disk_summary.csv", (), plain("off [%]", "off poles [%]")),
    ),
    "verification.rubs.convergence": (
        Table("rub_convergence/modes.csv", ("modes",), plain("modes", IMPULSE), title="modes"),
        Table("rub_convergence/steps.csv", ("dt [us]",), plain("dt [us]", IMPULSE), title="dt [us]"),
        Table("rub_convergence/pieces.csv", ("pieces",), plain("pieces", IMPULSE), title="pieces"),
        Table(
            "rub_convergence/surface.csv", ("points",),
            plain("points", f"cubic: {IMPULSE}", f"straight: {IMPULSE}"), title="points",
        ),
    ),
    "verification.rubs.bases": (Table("bases.csv", ("basis",), plain("modes", IMPULSE, "tip error")),),
    "verification.rubs.checks": (
        Table(
            "rub_bases.csv", ("nodes", "basis"),
            plain("modes", IMPULSE) | percent("blade error", "rim n = 10 error", "the same without R lam"),
        ),
    ),
}  # fmt: skip


def figures(report: str, out: Path) -> Figures:
    """What a report's tables in `out` give to the pages; nothing for a report that none quotes."""
    rows: Figures = {}
    for table in QUOTED.get(report, ()):
        rows |= table.figures(out)
    return rows
