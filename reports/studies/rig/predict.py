"""Identified frequencies update a model, which then predicts the frequencies left out: before and after, in sigma."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import casingfem as cf
from casingfem.io.arrays import BoolArray
from casingfem.study import load_shell_study
from reports.tables import DATA, Row

REPEATABILITY = 4e-4  # relative standard uncertainty that a test's frequencies have from one set-up to the next
MODEL_ERROR = 3e-3  # what a wrong embedding may do to a frequency
P = cf.Parameter


def with_repeatability(found: cf.Identified) -> cf.FrequencyTable:
    """The table of an identification, its sigma widened by the repeatability of tests."""
    table = found.table()
    return replace(table, sigma_hz=np.hypot(table.sigma_hz, REPEATABILITY * table.freq_hz))


def rows_of(table: cf.FrequencyTable, rows: BoolArray) -> cf.FrequencyTable:
    """Some rows of a table."""
    names = ("mode", "n", "freq_hz", "sigma_hz", "angle_deg", "zeta")
    return replace(table, **{name: getattr(table, name)[rows] for name in names})


def casing_models(quick: bool) -> dict[str, tuple[cf.Shell, list[cf.Parameter]]]:
    """Initial models of the update: the study's elastic edge, and the true embedding, a ring on bolts."""
    study = load_shell_study(DATA / "studies" / "rig_casing.toml")
    start = replace(study.start, mesh=cf.ShellMesh(order=6, rows=1, around=23)) if quick else study.start
    steel = [p for p in study.parameters if p.name in ("material.E", "shell.thickness")]
    ring = cf.Ring(
        section=cf.edge.Section.rectangle(width=0.04, depth=0.03), support=cf.Bolts(count=24, k=3e8, k_rot=2e5)
    )
    mesh = cf.ShellMesh(order=6, rows=2, around=24)
    bolts = [
        P(name="support.base.k", log=True, lower=1e7, upper=1e11),
        P(name="support.base.k_rot", log=True, lower=1e3, upper=1e8),
    ]
    if quick:  # without the clamps' harmonics, which split pairs and move few means
        even = [p for p in study.parameters if ".p8." not in p.name]
        return {"elastic edge": (start, even)}
    elastic = {"elastic edge": (start, list(study.parameters))}
    return elastic | {"ring on 24 bolts": (replace(start, supports={"base": ring}, mesh=mesh), [*steel, *bolts])}


def blade_model() -> tuple[cf.Shell, list[cf.Parameter]]:
    """The blade of rig_blade.toml: an even plate, its root's stiffness unknown."""
    shell = load_shell_study(DATA / "studies" / "rig_blade.toml").shell
    shell = replace(shell, supports={"root": cf.ElasticEdge(k_face=1e14)})
    return shell, [
        P(name="material.E", lower=190e9, upper=225e9, sigma=3e9),
        P(name="shell.thickness", lower=4.7e-3, upper=5.3e-3, sigma=5e-5),
        P(name="support.root.k_face", log=True, lower=1e12, upper=1e16),
    ]


def in_sigma(modes: cf.Modes, table: cf.FrequencyTable) -> list[tuple[int, float, float, float]]:
    """(row, measured, computed, error over sigma) of every row that finds its mode."""
    found = cf.correlation.pair(modes, table)
    return [
        (row, measured, computed, (computed - measured) / float(table.sigma_hz[row]))
        for match in found.matches
        for row, measured, computed in zip(match.rows, match.measured_hz, match.computed_hz, strict=True)
    ]


def rms(values: Sequence[float]) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def predict(
    name: str, start: cf.Shell, vary: list[cf.Parameter], table: cf.FrequencyTable, used: BoolArray, count: int
) -> tuple[list[Row], Row, cf.updating.UpdateResult]:
    """Update on some rows and predict the others: a row for each, the summary, the fit."""
    unseen = rows_of(table, ~used)
    fit = cf.update(start, rows_of(table, used), vary, count=count, model_error=MODEL_ERROR)
    before, after = in_sigma(fit.before, unseen), in_sigma(fit.after, unseen)
    earlier = {row: (computed, sigma) for row, _, computed, sigma in before}
    rows: list[Row] = [
        {
            "model": name,
            "n": int(unseen.n[row]),
            "measured Hz": measured,
            "before Hz": earlier.get(row, (None, None))[0],
            "after Hz": computed,
            "before sigma": earlier.get(row, (None, None))[1],
            "after sigma": sigma,
            "after %": 100.0 * (computed / measured - 1.0),
        }
        for row, measured, computed, sigma in after
    ]
    summary: Row = {
        "model": name,
        "used": int(used.sum()),
        "unseen": len(unseen.freq_hz),
        "predicted": len(after),
        "before sigma rms": rms([row[3] for row in before]),
        "after sigma rms": rms([row[3] for row in after]),
        "before % rms": 100.0 * rms([computed / measured - 1.0 for _, measured, computed, _ in before]),
        "after % rms": 100.0 * rms([computed / measured - 1.0 for _, measured, computed, _ in after]),
        "fitted % rms": 100.0 * fit.rms_after,
    }
    return rows, summary, fit
