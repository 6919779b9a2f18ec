"""The whole chain: measured blade, mistuned casing, updated model, reduced bases, a rub, one report.

`python -m reports.studies.rig [--quick] [--out DIR]` (`make study`) reads data/studies/rig.toml and writes report.html.
"""

import time
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import casingfem as cf
from casingfem.plot.page import origin, render_page
from casingfem.plot.pages.study import SYNTHETIC, Clock
from casingfem.study import Study, load_shell_study, perfect
from casingfem.study.tasks import run_update
from contact.io.outfiles import write_atomic
from reports.studies.rig import blade as rig_blade
from reports.studies.rig import page as rig_page
from reports.studies.rig import rub as rig_rub
from reports.studies.rig import tuning as rig_tuning
from reports.tables import DATA, Row, show, write

COARSE, SMALL = cf.ShellMesh(order=6, rows=1, around=23), cf.ShellMesh(order=8, rows=1, around=1)
CHAIN = DATA / "studies" / "rig.toml"


def read_chain(path: Path) -> tuple[dict[str, Study], rig_tuning.RubPlan]:
    """The studies and the rub named in rig.toml."""
    tables: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
    studies = {key: load_shell_study(path.parent / name) for key, name in tables["chain"].items()}
    return studies, rig_tuning.RubPlan(**tables["tuning"], **tables["rub"])


def main(out: Path, quick: bool = False) -> dict[str, float]:
    """Run the chain; returns the figures that the report leads with."""
    started = time.perf_counter()
    out.mkdir(parents=True, exist_ok=True)
    clock = Clock(lambda words: print(f"[{time.perf_counter() - started:6.1f} s] {words}", flush=True))
    studies, plan = read_chain(CHAIN)
    casing = studies["casing"]
    if quick:
        plan = rig_page.shortened(plan)
        casing = replace(casing, start=replace(casing.start, mesh=COARSE))
        studies |= {
            name: replace(one, shell=replace(one.shell, mesh=SMALL), start=replace(one.start, mesh=SMALL))
            for name, one in studies.items() if "blade" in name
        }  # fmt: skip

    blade_fit = clock("measured blade: update and leave-one-out", lambda: rig_blade.run(studies["measured_blade"]))
    print(blade_fit.fit)
    fit = clock(
        "casing: update",
        lambda: run_update(casing, lambda k, rms: print(f"  evaluation {k}: {rms:.3f} sigma", flush=True)),
    )
    print(fit)
    ideal = clock("casing: perfect model", lambda: cf.modes(perfect(casing.start), len(fit.before)))

    target = rig_rub.casing_target(fit.after, plan.n)
    blade = studies["blade"]
    files, tuning = clock(
        "tuning and reduction", lambda: rig_rub.bodies(casing, fit.structure, target, blade, plan, out)
    )
    terms = cf.modal.out_of_roundness(fit.structure, cf.Rim("top", n_max=26))
    rubs = [
        clock("rub, as built", lambda: rig_rub.run("as built", files, plan, terms)),
        clock("rub, defect machined away", lambda: rig_rub.run("defect machined away", files, plan, [])),
    ]
    controls = clock("rubs with a cause taken away", lambda: rig_rub.controls(files, plan))
    levels = [rub.excess_db(plan.n) for rub in rubs]
    columns = ("as built [dB]", "defect machined away [dB]")
    alone: list[Row] = [{"blade": words, columns[0]: None, columns[1]: level} for words, level in controls.items()]
    rows: list[Row] = [{"blade": "digging blade"} | dict(zip(columns, levels, strict=True)), *alone]
    show(f"Level of n = {plan.n} over the next nodal diameter", rows)

    sections = [
        rig_page.overview(blade_fit, fit, rubs, plan),
        rig_blade.section(blade_fit),
        rig_page.casing_section(casing, fit, ideal),
        rig_page.reduction(files, tuning, plan),
        rig_page.causes(rows, rubs, plan),
        *(rig_page.rub_section(rub, plan) for rub in rubs),
        rig_page.provenance(casing, clock.seconds),
    ]
    page = render_page(
        "The rig, from test bench to rub", sections, notice=SYNTHETIC + rig_page.WHAT_IS_REAL,
        verdict=rig_page.verdict(blade_fit, fit, rubs, plan.speed_hz), source=origin(casing.source),
    )  # fmt: skip
    write_atomic(out / "report.html", page)
    left = blade_fit.left_out.rms
    summary: list[Row] = [
        {"case": "fan blade", "RMS before": rig_blade.rms(blade_fit.errors_nominal),
         "RMS after": blade_fit.fit.rms_after, "left out": left},
        {"case": "rig casing", "RMS before": fit.rms_before, "RMS after": fit.rms_after, "left out": None},
    ]  # fmt: skip
    write(out / "rig_summary.csv", summary)
    write(out / "rig_rubs.csv", rows)
    print(f"{out / 'report.html'} after {time.perf_counter() - started:.0f} s")
    return {
        "blade_rms_before": rig_blade.rms(blade_fit.errors_nominal),
        "blade_rms_after": blade_fit.fit.rms_after,
        "blade_rms_left_out": left,
        "casing_rms_before": fit.rms_before,
        "casing_rms_after": fit.rms_after,
        "as_built_db": levels[0],
        "machined_db": levels[1],
    }
