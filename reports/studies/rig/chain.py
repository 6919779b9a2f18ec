"""The whole chain: measured blade, mistuned casing, updated model, reduced bases, a rub, one report.

`python -m reports.studies.rig [--quick] [--out DIR]` (`make study`) reads data/studies/rig.toml and writes report.html.
"""

import time
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import casingfem as cf
from casingfem.io.side_by_side import Each, side_by_side, usable_cores
from casingfem.plot.page import origin, render_page
from casingfem.plot.pages.study import SYNTHETIC, Clock
from casingfem.study import Study, load_shell_study, perfect
from casingfem.study.tasks import run_update
from contact.io.outfiles import write_atomic
from contact.io.threads import one_thread
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


def evaluated(count: int, rms: float) -> None:
    """State how far the update of the casing is."""
    print(f"  evaluation {count}: {rms:.3f} sigma", flush=True)


def together(clock: Clock, each: Each, parts: Mapping[str, Callable[[], Any]]) -> list[Any]:
    """Run independent parts, in as many processes as `each` has."""
    clock.say("; ".join(parts))
    found = list(each(timed, parts.values()))
    clock.seconds |= {name: seconds for name, (_, seconds) in zip(parts, found, strict=True)}
    return [result for result, _ in found]


def timed(part: Callable[[], Any]) -> tuple[Any, float]:
    """Result of a part and its time [s]."""
    started = time.perf_counter()
    return part(), time.perf_counter() - started


def main(out: Path, quick: bool = False) -> dict[str, float]:
    """Run the chain, independent parts beside each other; returns the figures that the report leads with."""
    with one_thread(), side_by_side(1 if quick else min(2, usable_cores())) as each:
        return chain(out, quick, each)


def chain(out: Path, quick: bool, each: Each) -> dict[str, float]:
    """The parts of the chain; `each` runs several of them."""
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

    blade_fit, fit = together(clock, each, {
        "measured blade: update and leave-one-out": partial(rig_blade.run, studies["measured_blade"]),
        "casing: update": partial(run_update, casing, evaluated),
    })  # fmt: skip
    print(blade_fit.fit, fit, sep="\n")
    ideal = clock("casing: perfect model", lambda: cf.modes(perfect(casing.start), len(fit.before)))

    target = rig_rub.casing_target(fit.after, plan.n)
    blade = studies["blade"]
    (files, tuning), on_casing = together(clock, each, {
        "tuning and reduction": partial(rig_rub.bodies, casing, fit.structure, target, blade, plan, out),
        "pictures of the casing": partial(rig_page.casing_section, casing, fit, ideal),
    })  # fmt: skip
    terms = cf.modal.out_of_roundness(fit.structure, cf.Rim("top", n_max=26))
    machined, as_built, controls = together(clock, each, {
        "rub, defect machined away": partial(rig_rub.run, files, plan, []),
        "rub, as built": partial(rig_rub.run, files, plan, terms),
        "rubs with a cause taken away": partial(rig_rub.controls, files, plan),
    })  # fmt: skip
    rubs = [
        rig_rub.shown("as built", files, plan, terms, as_built),
        rig_rub.shown("defect machined away", files, plan, [], machined),
    ]
    levels = [rub.excess_db(plan.n) for rub in rubs]
    columns = ("as built [dB]", "defect machined away [dB]")
    alone: list[Row] = [{"blade": words, columns[0]: None, columns[1]: level} for words, level in controls.items()]
    rows: list[Row] = [{"blade": "digging blade"} | dict(zip(columns, levels, strict=True)), *alone]
    show(f"Level of n = {plan.n} over the next nodal diameter", rows)

    sections = [
        rig_page.overview(blade_fit, fit, rubs, plan),
        rig_blade.section(blade_fit),
        on_casing,
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
