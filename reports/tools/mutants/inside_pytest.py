"""Inside pytest, for `reports.tools.mutants`: run chosen tests in their order within limits, write down how they went.

A pytest plugin; the environment variable MUTANTS_JOB names the file with its task.
"""

import json
import os
import resource
import time
from collections.abc import Generator
from dataclasses import asdict, dataclass, field
from pathlib import Path

import pytest

JOB = "MUTANTS_JOB"
WORST_FIRST = ("failed", "left out", "skipped")
Line = tuple[str, str]  # outcome and test


@dataclass(frozen=True, slots=True)
class Job:
    """Task of a pytest process.

    `tests`, named without their parameters, run in this order until `budget` processor seconds are spent, those of one
    file until `share` are; a test that takes longer than `limit` is ended with its process. If `record` is a path, the
    functions of `packages` that each test runs are written there.
    """

    journal: str
    tests: tuple[str, ...]
    budget: float
    share: float
    limit: float
    record: str = ""
    packages: tuple[str, ...] = ()

    def write(self, path: Path) -> None:
        """Write the task for the plugin."""
        path.write_text(json.dumps(asdict(self)), encoding="utf-8")

    @classmethod
    def read(cls, path: Path) -> "Job":
        """Read the task."""
        fields = json.loads(path.read_text(encoding="utf-8"))
        return cls(**{**fields, "tests": tuple(fields["tests"]), "packages": tuple(fields["packages"])})

    def lines(self) -> list[Line]:
        """The journal so far; "begun" is the outcome of a test that did not end."""
        path = Path(self.journal)
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        found = [json.loads(line) for line in text.splitlines()]
        ended = {test for outcome, test in found if outcome != "begun"}
        return [(outcome, test) for outcome, test in found if outcome != "begun" or test not in ended]


def spent() -> float:
    """Processor seconds of this process and its finished children."""
    now = os.times()
    return now.user + now.system + now.children_user + now.children_system


@dataclass(frozen=True, slots=True, eq=False)
class Runner:
    """The plugin."""

    job: Job
    of_file: dict[Path, float] = field(default_factory=dict)
    outcomes: set[str] = field(default_factory=set)

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Only the tests asked for, in their order."""
        place = {name: k for k, name in enumerate(self.job.tests)}
        chosen = [item for item in items if item.nodeid.partition("[")[0] in place]
        items[:] = sorted(chosen, key=lambda item: place[item.nodeid.partition("[")[0]])

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Record the outcome of one test, and end it if it takes too long."""
        began = spent()
        self.outcomes.clear()
        self.note("begun", item.nodeid)
        _, most = resource.getrlimit(resource.RLIMIT_CPU)
        resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time() + self.job.limit) + 1, most))
        result = yield
        self.note(next((name for name in WORST_FIRST if name in self.outcomes), "passed"), item.nodeid)
        self.of_file[item.path] = self.of_file.get(item.path, 0.0) + spent() - began
        return result

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Skip tests after the time is used up."""
        if spent() > self.job.budget or self.of_file.get(item.path, 0.0) > self.job.share:
            self.outcomes.add("left out")
            pytest.skip("the time for this mutant is spent")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note the outcome of setting up, calling and tearing down."""
        self.outcomes.add(report.outcome)

    def note(self, outcome: str, test: str) -> None:
        """A line of the journal."""
        with Path(self.job.journal).open("a", encoding="utf-8") as journal:
            journal.write(json.dumps([outcome, test]) + "\n")


def pytest_configure(config: pytest.Config) -> None:
    """Register the plugin with its task."""
    job = Job.read(Path(os.environ[JOB]))
    config.pluginmanager.register(Runner(job))
    if job.record:
        from reports.tools.mutants.executed import Recorder

        config.pluginmanager.register(Recorder(Path(job.record), job.packages))
