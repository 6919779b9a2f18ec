"""Many runs: sweep varies keys of one scene; mistune draws a casing's random fields."""

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from casingfem.cli.contact import SCENE
from casingfem.cli.progress import ProgressMessage
from casingfem.cli.read_study import chart_study
from casingfem.cli.running import NUMERICS_FAILED, deliver, fail, options
from casingfem.cli.study import STUDY
from casingfem.cli.tables import csv_text
from casingfem.io.side_by_side import usable_cores
from contact.io.outfiles import Content, json_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from casingfem.modal.mistuning import Mistuning
    from casingfem.study.mistuning import MistuneRun
    from contact.sweep.sweep import SweepResult


@click.command()
@SCENE
@click.option(
    "--jobs",
    type=click.IntRange(1, 1024),
    help="Number of worker processes; one for each core, or one with a scheduler, if left out.",
)
@click.option("--scheduler", metavar="ADDRESS", help="A Dask scheduler, tcp://host:port, instead of processes.")
@options
def sweep(file: Path, jobs: int | None, scheduler: str | None, as_json: bool, out: Path | None) -> None:
    """Run SCENE over the keys that its [sweep] varies: one table, one picture, one page.

    With --out DIR every finished run is stored in DIR/store, so the same command continues an interrupted sweep. Runs
    that are refused, fail or diverge are rows with the reason, counted on stderr. The exit code is 0 if at least one
    run succeeds, else 3.
    """
    from contact.sweep.plan import load_sweep
    from contact.sweep.sweep import run_sweep

    with ProgressMessage(f"sweep {file.name}: its runs and their files") as working:
        plan = load_sweep(file)
        working.say(f"sweep {file.name}")

        def progress(done: int) -> None:
            working.say(f"sweep {file.name}, {done} of {len(plan.runs)} runs", done / len(plan.runs))

        store = None if out is None else out / "store"
        found = run_sweep(plan, folder=store, jobs=jobs or usable_cores(), scheduler=scheduler, progress=progress)
    rows = [dict(zip(plan.keys, run.values, strict=True)) | row for run, row in zip(plan.runs, found.rows, strict=True)]
    document = {
        "runs": rows, "keys": list(plan.keys), "failed": found.failed, "diverged": found.diverged,
        "resumed": found.resumed, "seconds": working.seconds, "source": plan.source,
    }  # fmt: skip
    files: dict[str, Content] = {} if out is None else result_files(found, document)
    deliver(document, words(found, working.seconds), as_json=as_json, out=out, files=files)
    if found.failed + found.diverged == len(rows):
        became = "failed, diverged or were" if found.diverged else "failed or were"
        all_of = "the only run" if len(rows) == 1 else f"all {len(rows)} runs"
        why = f"{all_of} {became} refused, the first: {found.why}"
        fail(f"sweep {file}: the numerics failed: {why}", NUMERICS_FAILED)
    if lost := found.failed + found.diverged:
        click.echo(f"sweep {file}: {lost} of {len(rows)} runs did not finish; the first: {found.why}", err=True)


def words(found: "SweepResult", seconds: float) -> str:
    """Lines on the number of runs, their outcomes, and the largest growth."""
    from contact.sweep.sweep import counted

    plan, rows = found.plan, found.rows
    lines = [f"{counted(len(rows))} over {', '.join(plan.keys)} in {seconds:.3g} s"]
    if found.resumed:
        lines.append(f"{counted(found.resumed)} {'was' if found.resumed == 1 else 'were'} there already")
    lines += motion_words(plan.keys, rows, [run.values for run in plan.runs])
    if any(key.startswith("speed.") for key in plan.keys):
        lines.append("`casingfem interactions` lists the dangerous speeds and the growing motion at each")
    for status in ("refused", "failed", "diverged"):
        reasons = [row["why"] for row in rows if row["status"] == status]
        if reasons:
            lines.append(f"{len(reasons)} of {counted(len(rows))} {status}, the first: {reasons[0]}")
    flagged = sum(bool(row["flags"]) for row in rows)
    if flagged:
        lines.append(f"{counted(flagged)} {'has' if flagged == 1 else 'have'} flags: see the column flags")
    return "\n".join(lines)


def motion_words(
    keys: "Sequence[str]", rows: "Sequence[Mapping[str, Any]]", values: "Sequence[Sequence[object]]"
) -> list[str]:
    """Lines on growing, bounded and decaying motions; the fastest growth with its interval, wave and source."""
    count = Counter(str(row["motion"]) for row in rows if row.get("motion"))
    if not count:
        return []
    lines = ["motion of the runs: " + ", ".join(f"{number} {state}" for state, number in count.most_common())]
    growing = [(row["growth_1_s"], k) for k, row in enumerate(rows) if row.get("motion") == "grows"]
    if growing:
        most, k = max(growing)
        row, at = rows[k], ", ".join(f"{key} = {value}" for key, value in zip(keys, values[k], strict=True))
        wave = f"the {row['body']}" if row["n"] is None else f"n = {row['n']} of the {row['body']}"
        between = f"95 %: {row['growth_low_1_s']:.3g} to {row['growth_high_1_s']:.3g}"
        line = f"fastest growth {most:.4g} 1/s ({between}) at {at}: {wave}"
        line += f", energy from {row['source']}" if row["source"] else ""
        wall = row["half_wall_at_s"]
        lines.append(line if wall is None else f"{line}; half the wall at {wall:.3g} s")
    return lines


def result_files(found: "SweepResult", document: dict[str, Any]) -> dict[str, Content]:
    """The table, the document, the page, and a picture if numbers were varied."""
    from casingfem.plot.pages.sweep import sweep_page
    from contact.sweep.columns import MEASURED
    from contact.sweep.sweep import table

    files: dict[str, Content] = {"sweep.csv": table(found), "sweep.json": json_text(document, indent=1)}
    plan, drawn = found.plan, None
    numbers = [k for k in range(len(plan.keys)) if all(isinstance(run.values[k], int | float) for run in plan.runs)][:2]
    if numbers and len(plan.runs) > 1:
        import numpy as np

        from casingfem.plot.style import Drawn
        from casingfem.plot.sweep import figure_sweep

        values = np.array([[float(run.values[k]) for k in numbers] for run in plan.runs])
        drawn = Drawn(figure_sweep([plan.labels[k] for k in numbers], values, found.rows))
        files["sweep.png"] = drawn.png
    files["sweep.html"] = sweep_page(
        plan.file.stem, plan.labels, plan.keys, document["runs"], plan.source, drawn, MEASURED
    )
    return files


@click.command()
@STUDY
@click.option("--draws", type=click.IntRange(1, 1_000_000), default=200, show_default=True, help="How many.")
@click.option(
    "--processes",
    type=click.IntRange(1, 256),
    default=None,
    help="Number of worker processes; one for each core if left out.",
)
@options
def mistune(file: Path, draws: int, processes: int | None, as_json: bool, out: Path | None) -> None:
    """Splits and orientations of the pairs of STUDY over draws of its random imperfections.

    With --out DIR finished draws are stored in DIR/draws, so the same command continues an interrupted run.
    """
    from casingfem.study.mistuning import run_mistune

    study = chart_study(file)
    with ProgressMessage(f"mistuning of {file.name}") as working:

        def progress(done: int) -> None:
            working.say(f"mistuning of {file.name}, {done} of {draws} draws", done / draws)

        folder = None if out is None else out / "draws"
        run = run_mistune(study, draws, processes=processes, folder=folder, progress=progress)
    document = {
        "doublets": run.found.summary(),
        "draws": draws,
        "resumed": run.resumed,
        "checked": {str(draw): each._asdict() for draw, each in run.checked.items()},
        "solved_in_full": list(run.in_full),
        "estimated_error": run.estimate,
        "seconds": working.seconds,
        "source": study.source,
    }
    files: dict[str, Content] = {} if out is None else files_of_draws(run.found, document)
    deliver(document, f"{run.found!r}\n{words_of_draws(run)}", as_json=as_json, out=out, files=files)


def words_of_draws(run: "MistuneRun") -> str:
    """Lines on the accuracy of the frequencies, and on draws that were stored before."""
    lines = []
    if run.estimate is not None:
        near = run.found.draws - len(run.in_full)
        lines.append(f"{near} draws from the perfect casing's modes: estimated error of a frequency {run.estimate:.1e}")
    if run.checked:
        freq, split = (max(part) for part in zip(*run.checked.values(), strict=True))
        differ = f"frequencies differ by {freq:.1e} at most, splits by {split:.1e} of the draw's largest"
        lines.append(f"{len(run.checked)} of them also solved in full: {differ}")
    if run.in_full:
        lines.append(f"{len(run.in_full)} draws solved in full, each checked by a Sturm count")
    if run.resumed:
        lines.append(f"{run.resumed} draws were read from earlier results")
    return "\n".join(lines)


def files_of_draws(found: "Mistuning", document: dict[str, Any]) -> dict[str, Content]:
    """The draws, the summary, the picture and the document."""
    from casingfem.modal.mistuning import DRAWS, SUMMARY
    from casingfem.plot.modes import figure_splits
    from casingfem.plot.style import png
    from contact.io.columns import records_of

    source = document["source"]
    versions = ", ".join(f"{name} {number}" for name, number in source["versions"].items())
    card = f"COMPUTED: random mistuning of {source['study']} (sha256 {source['sha256']})\nby {versions}"
    rows = records_of(DRAWS, found)
    summary = document["doublets"]
    return {
        "mistune.csv": csv_text(rows, card, [column.name for column in DRAWS]),
        "mistune_summary.csv": csv_text(summary, card, [column.name for column in SUMMARY]),
        "mistune.json": json_text(document, indent=1),
        "mistune.png": png(figure_splits(found)),
    }
