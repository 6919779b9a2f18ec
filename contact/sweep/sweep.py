"""Many runs from one scene file: in this process, in several, or on a cluster; stored one by one, resumed after a kill.

A run's row depends only on the run: not on the order, the number of processes, kills, or earlier results. So the table
is always identical.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact.base.errors import InputError
from contact.io.columns import Column, Columns, records_of
from contact.io.notebook import notebook_progress
from contact.io.reported import Reported
from contact.io.workers import forks
from contact.prepared import Scene
from contact.run_many import Outcome, first_step, run_many
from contact.scene.load import scene_of
from contact.sweep.columns import COLUMNS, MEASURED
from contact.sweep.plan import SweepPlan, Value, changed, unit_of
from contact.sweep.row import Row, Store, read_run, row_of, run_path, sweep_record, write_run
from contact.sweep.spread import on_workers

MOST = 64  # runs a task contains at most
BATCH = 8  # runs that share one compiled loop
IN_NAMES = ("", "-", "degrees", "Hz", "turns/s", "rpm")  # units that the name of a key has itself
Rows = dict[str, Row]


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """Some runs for a worker: the scene's own tables, the varied keys, hash and values of each run.

    `folder` is that of the store to which the worker writes.
    """

    file: str
    base: dict[str, Any]
    keys: tuple[str, ...]
    runs: tuple[tuple[str, tuple[Value, ...]], ...]
    folder: str | None


@dataclass(frozen=True, eq=False, slots=True, kw_only=True, repr=False)
class SweepResult(Reported):
    """Rows of all runs, in the plan's order; `resumed` of them were stored before."""

    plan: SweepPlan
    rows: tuple[Row, ...]
    resumed: int

    def records(self) -> list[dict[str, Any]]:
        """One plain dictionary for each run: its number, the varied keys, results."""
        return records_of(self.described(), self)

    def described(self) -> Columns:
        """Columns: the number of the run, the varied keys, results."""
        number = Column("run", "Number of the run, from 1.", lambda found: range(1, 1 + len(found.rows)), format="d")
        return [number, *(varied(k, name) for k, name in enumerate(columns(self.plan)[1 : 1 + len(self.plan.keys)])),
                *MEASURED]  # fmt: skip

    def __repr__(self) -> str:
        done = len(self.rows) - self.failed - self.diverged
        return f"SweepResult({done} of {counted(len(self.rows))} done, {self.diverged} diverged, {self.failed} failed)"

    @property
    def failed(self) -> int:
        """Runs that were refused or failed."""
        return sum(row["status"] in ("refused", "failed") for row in self.rows)

    @property
    def diverged(self) -> int:
        """Runs that ended at a limit of their model."""
        return sum(row["status"] == "diverged" for row in self.rows)

    @property
    def why(self) -> str:
        """Reason why the first unfinished run was refused, failed or diverged; empty if all are done."""
        return next((str(row["why"]) for row in self.rows if row["status"] != "done"), "")


def run_sweep(
    plan: SweepPlan,
    *,
    folder: Path | None = None,
    jobs: int = 1,
    scheduler: str | None = None,
    progress: Callable[[int], None] | None = None,
) -> SweepResult:
    """Run the missing runs of a sweep.

    `folder`: the store; without one, nothing is stored. `jobs`: number of processes; or a Dask `scheduler` by its
    address, whose workers need the same files. `progress` is called with the number of finished runs.

    Raises InputError if the scheduler cannot be reached, or a task's workers died too often.
    """
    progress = progress or notebook_progress("sweep", f"{{}} of {len(plan.runs)} runs".format)
    store = None if folder is None else Store.open(folder)
    rows: Rows = {} if store is None else store.rows(run.digest for run in plan.runs)
    resumed = sum(run.digest in rows for run in plan.runs)
    for found in _workers(tasks(plan, rows, folder, jobs), jobs, scheduler):
        rows |= found
        if store is not None and scheduler is not None:  # processes here share the disk and have written them
            store.note(found)
        if progress is not None:
            progress(sum(run.digest in rows for run in plan.runs))
    return SweepResult(plan=plan, rows=tuple(rows[run.digest] for run in plan.runs), resumed=resumed)


def tasks(plan: SweepPlan, there: Rows, folder: Path | None, jobs: int) -> list[Task]:
    """The missing runs, each once, as tasks of whole batches."""
    missing = {run.digest: run.values for run in plan.runs if run.digest not in there}
    size = min(MOST, max(1, -(-len(missing) // (BATCH * max(jobs, 1)))) * BATCH)
    pending = list(missing.items())
    return [
        Task(
            file=str(plan.file), base=plan.base, keys=plan.keys, folder=None if folder is None else str(folder),
            runs=tuple(pending[first : first + size]),
        )
        for first in range(0, len(pending), size)
    ]  # fmt: skip


def run_task(task: Task) -> Rows:
    """Run a task in a worker; runs that its store already has are read."""
    folder = None if task.folder is None else Path(task.folder)
    rows: Rows = {}
    scenes: list[tuple[str, Scene]] = []
    for digest, values in task.runs:
        kept = None if folder is None else read_run(run_path(folder, digest))
        if kept is not None:
            rows[digest] = kept
            continue
        try:
            scenes.append((digest, _scene(task, values)))
        except InputError as error:
            rows[digest] = row_of(None, error)
            _keep(folder, digest, rows[digest])

    def ended(i: int, outcome: Outcome) -> None:
        digest, scene = scenes[i]
        rows[digest] = row_of(scene, outcome)
        _keep(folder, digest, rows[digest])

    run_many([scene for _, scene in scenes], record=sweep_record, ended=ended)
    return rows


def _scene(task: Task, values: tuple[Value, ...]) -> Scene:
    return scene_of(changed(task.base, task.keys, values), Path(task.file))


def _keep(folder: Path | None, digest: str, row: Row) -> None:
    if folder is not None and folder.is_dir():
        write_run(folder, digest, row)


def _workers(todo: Sequence[Task], jobs: int, scheduler: str | None) -> Iterator[Rows]:
    """Rows of the tasks in the order of completion, wherever they run."""
    if scheduler is None and not (jobs > 1 and len(todo) > 1):
        return map(run_task, todo)
    if scheduler is None and forks():  # copies of this process inherit the loops that it loads now
        _load_loop(todo[0])
    return on_workers(todo, run_task, jobs, scheduler)


def _load_loop(task: Task) -> None:
    """Load or compile the loop of a task's first run; if that run is refused, a worker reports it."""
    with suppress(InputError):
        first_step(_scene(task, task.runs[0][1]), sweep_record)


def columns(plan: SweepPlan) -> tuple[str, ...]:
    """Names of the table's columns: run, the varied keys with their units, results."""
    return ("run", *(f"{key}{ending(unit_of(plan.base, key))}" for key in plan.keys), *COLUMNS)


def ending(unit: str) -> str:
    """Suffix of a column's name for a unit; empty if the key's name contains the unit.

    >>> ending("kg/m^3"), ending("turns/s"), ending("")
    ('_kg_m3', '', '')
    """
    return "" if unit in IN_NAMES else re.sub(r"[/ ]", "_", f"_{unit}").replace("^", "")


def varied(k: int, name: str) -> Column:
    """The column of the k-th varied key."""
    return Column(name, "Value of a varied key of the scene.", lambda found: [run.values[k] for run in found.plan.runs])


def table(result: SweepResult) -> str:
    """The table as CSV: comment lines with versions, hash and seed, column names with units, one row for each run."""
    plan = result.plan
    lines = [
        f"# COMPUTED: sweep of {plan.source['scene']}, {counted(len(plan.runs))}",
        *(f"# {name}: {value}" for name, value in sorted(plan.source.items())),
        ",".join(columns(plan)),
    ]
    lines += [",".join(map(_cell, row.values())) for row in result.records()]
    return "\n".join(lines) + "\n"


def counted(runs: int) -> str:
    """A number of runs, in words.

    >>> counted(1), counted(2)
    ('1 run', '2 runs')
    """
    return f"{runs} run" if runs == 1 else f"{runs} runs"


def _cell(value: object) -> str:
    text = "" if value is None else str(value)
    if any(mark in text for mark in ',"\n'):
        return '"' + text.replace('"', '""').replace("\n", " ") + '"'
    return text
