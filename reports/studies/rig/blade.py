"""The measured fan blade: converged model, comparison, update, and predictions of what an update left out."""

from dataclasses import dataclass, replace

import numpy as np

import casingfem as cf
from casingfem.io.arrays import Array, FloatArray
from casingfem.io.strict_csv import read
from casingfem.plot.page import Section, Table
from casingfem.plot.pages.fit import update_section
from casingfem.study import Study
from casingfem.study.tasks import run_update
from casingfem.updating.uncertainty.prediction import LeftOut, leave_one_out
from reports.tables import DATA


@dataclass(frozen=True, slots=True, eq=False)
class BladeFit:
    """Update of the measured blade and its leave-one-out check.

    `nominal` are the modes of the published, clamped model; `left_out` the predictions of each row by an update on
    the other rows; `thin` the thin-shell reference of each row [Hz].
    """

    nominal: cf.Modes
    fit: cf.updating.UpdateResult
    left_out: LeftOut
    thin: FloatArray

    @property
    def errors_nominal(self) -> FloatArray:
        """Relative errors of the clamped nominal model."""
        return np.asarray(self.nominal.freq[: len(self.thin)] / self.fit.table.freq_hz - 1.0)


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def run(study: Study) -> BladeFit:
    """Update the blade, then once without each row in turn."""
    table = study.table
    if table is None:
        raise ValueError(f"{study.path}: the measured blade needs [update]")
    fit = run_update(study)
    nominal = cf.modes(replace(study.shell, supports={"root": cf.Clamped()}), study.file.modes.count)
    reference = read(DATA / "reference" / "olson_lindberg_fan_blade.csv")
    thin = np.asarray(reference.numbers("computed_love_ritz_hz"))[: len(table)]
    return BladeFit(nominal=nominal, fit=fit, left_out=leave_one_out(fit), thin=thin)


def verdict(blade: BladeFit) -> str:
    """Whether the update predicts frequencies that it has not seen better than the nominal model."""
    if blade.left_out.rms < rms(blade.errors_nominal):
        return "better than the nominal model"
    return (
        "no better than the nominal model. Seven frequencies cannot determine three parameters: only mode 6 constrains "
        "the radius"
    )


def section(blade: BladeFit) -> Section:
    """The blade's part of the report."""
    fit, table = blade.fit, blade.fit.table
    off_theory = np.abs(blade.nominal.freq[: len(table)] / blade.thin - 1.0).max()
    words = (
        "The fan blade of Olson and Lindberg (AFFDL-TR-68-150, 1968) is a cantilevered cylindrical panel; its seven "
        "frequencies are MEASURED, on a real blade.",
        f"The nominal clamped model lies within {100 * off_theory:.2f} % of converged thin-shell values, so what is "
        f"left is not discretisation: the RMS error against the measurement is {100 * rms(blade.errors_nominal):.2f} % "
        f"for it, {100 * fit.rms_before:.2f} % for the elastic root where the update starts, and "
        f"{100 * fit.rms_after:.2f} % after the update. An update that has not seen a frequency predicts it "
        f"to {100 * blade.left_out.rms:.2f} % RMS (leave one out): {verdict(blade)}.",
        "Three uniform parameters cannot do more: mode 2 is measured below and mode 3 well above every model of a "
        "uniform blade, published ones included. A wall or a curvature that varies over the blade would be needed, "
        "and nothing measured says how.",
    )
    row_of = {int(mode): k for k, mode in enumerate(table.mode)}
    left_out = {row_of[found.mode]: found.error for found in blade.left_out.rows}
    rows = tuple(
        (
            int(table.mode[k]),
            float(table.freq_hz[k]),
            float(blade.thin[k]),
            float(blade.nominal.freq[k]),
            f"{100.0 * blade.errors_nominal[k]:+.2f}",
            f"{100.0 * (fit.after.freq[k] / table.freq_hz[k] - 1.0):+.2f}",
            f"{100.0 * left_out[k]:+.2f}" if k in left_out else None,
        )
        for k in range(len(table))
    )
    columns = (
        "mode",
        "measured [Hz]",
        "thin shell [Hz]",
        "nominal [Hz]",
        "nominal [%]",
        "updated [%]",
        "left out [%]",
    )
    base = update_section(fit, None)
    return Section(
        "The measured blade",
        words + base.paragraphs,
        base.figures,
        (
            Table("Measured and computed frequencies of the blade; the last column was predicted.", columns, rows),
            *base.tables[:1],
        ),
    )
