"""For `reports.tools.mutants`: run tests in copies of the project, one a worker, with or without a mutant."""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from reports.tables import ROOT
from reports.tools.mutants.draw import Mutant
from reports.tools.mutants.inside_pytest import JOB, Job, Line

RECORDED = "executed.json"
PATIENCE = 3.0  # on a busy machine, whose cores and caches others use too, a processor second does a third of the work
NOT_COPIED = shutil.ignore_patterns(
    ".git", ".venv", "__pycache__", ".*_cache", "*.egg-info", "out", "build", "dist"
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits for one mutant: processor seconds of all tests, of those of one file, of one test; number of files.

    Without a record of executed functions, the `files` nearest files are used; else the `nearest` and up to `running`
    files that run the changed function. A changed compiled loop may take `compiling` seconds more in each test, because
    tests compile it again. Tests that these limits leave out of a survivor run once more with `PATIENCE` times as much.
    """

    budget: float = 180.0
    share: float = 40.0
    test: float = 100.0
    files: int = 16
    nearest: int = 4
    running: int = 48
    compiling: float = 100.0

    def patient(self) -> "Limits":
        """Limits of the second run of a survivor."""
        return replace(self, budget=PATIENCE * self.budget, share=PATIENCE * self.share, test=PATIENCE * self.test)


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a mutant was killed, by which test and how, and the tests that ran; "" and [] if none did."""

    killed: bool
    by: str
    how: str
    ran: list[str]
    left_out: int


@dataclass(frozen=True, slots=True)
class Tree:
    """A copy of a project at a fixed place.

    Copies beside each other share the cache of compiled loops, which is keyed on the contents of their sources.
    """

    root: Path
    copy: Path

    def refresh(self) -> None:
        """Copy the current state of the project into it."""
        shutil.rmtree(self.copy, ignore_errors=True)
        shutil.copytree(self.root, self.copy, ignore=NOT_COPIED)

    @property
    def recorded(self) -> Path:
        """File of the record of tests and the functions that they run."""
        return self.beside(RECORDED)

    def beside(self, name: str) -> Path:
        """A file or folder of this tree's own, outside it."""
        return self.copy.with_name(f"{self.copy.name}-{name}")

    def run(
        self,
        tests: Sequence[str],
        limits: Limits,
        *,
        first_failure: bool = True,
        record: tuple[str, ...] = (),
        bytecode: bool = False,
    ) -> tuple[list[Line], int, str]:
        """Run tests in their order; returns the journal, exit status and output of pytest.

        `record` names packages. With `bytecode`, later runs find the bytecode of the sources on disk.
        """
        files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
        job = Job(
            str(self.beside("journal.jsonl")), tuple(tests), limits.budget, limits.share, limits.test,
            str(self.recorded) if record else "", record,
        )  # fmt: skip
        Path(job.journal).unlink(missing_ok=True)
        job.write(self.beside("job.json"))
        settings = {
            JOB: str(self.beside("job.json")), "PYTHONPATH": os.pathsep.join([str(self.copy), str(ROOT)]),
            "NUMBA_CACHE_DIR": str(self.copy.with_name("compiled")), "MPLBACKEND": "Agg", "OPENBLAS_NUM_THREADS": "1",
            # bytecode is known by the second and the size of its source: a mutant may have both of the one before
            "PYTHONDONTWRITEBYTECODE": "" if bytecode else "1",
        }  # fmt: skip
        options = [
            "-p", "reports.tools.mutants.inside_pytest", "-p", "no:cacheprovider", "-q", "--tb=short",
            "--doctest-modules", "-m", "not campaign",  # the tests of the gate
        ]  # fmt: skip
        options += [f"--basetemp={self.beside('temporary')}", *(["-x"] if first_failure else [])]
        command = [sys.executable, "-m", "pytest", *options, *files]
        with self.beside("output.txt").open("w+b") as output:
            process = subprocess.Popen(
                command, cwd=self.copy, env={**os.environ, **settings}, stdout=output, stderr=output,
                start_new_session=True,
            )  # fmt: skip
            try:
                process.wait(20.0 * (limits.budget + limits.test))  # a test that waits forever takes no processor time
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, 9)
                process.wait()
            output.seek(0)
            return job.lines(), process.returncode, output.read().decode("utf-8", errors="replace")

    def judge(self, mutant: Mutant, tests: Sequence[str], limits: Limits) -> Verdict:
        """Whether tests kill a mutant; no tests kill none. Tests left out of a survivor run again with more time."""
        if not tests:
            return verdict([], 0, "")
        changed = self.copy / mutant.file
        changed.write_text(mutant.source((self.root / mutant.file).read_text("utf-8")), encoding="utf-8")
        try:
            lines, ended, said = self.run(tests, limits)
            found = verdict(lines, ended, said)
            waiting = list(dict.fromkeys(test.partition("[")[0] for outcome, test in lines if outcome == "left out"))
            if found.killed or not waiting:
                return found
            later = verdict(*self.run(waiting, limits.patient()))
            return replace(later, ran=list(dict.fromkeys([*found.ran, *later.ran])))
        finally:
            # with its date, at which the cache of compiled loops looks
            shutil.copy2(self.root / mutant.file, changed)


def verdict(lines: list[Line], ended: int, said: str) -> Verdict:
    """Verdict of a run of tests: a test failed, did not end, or could not be collected."""
    ran = [test for outcome, test in lines if outcome != "left out"]
    failed = [(test, outcome) for outcome, test in lines if outcome in ("failed", "begun")]
    if failed:
        test, outcome = failed[0]
        how = "failed" if outcome == "failed" else "took too long" if ended in (-24, -9) else "ended the process"
        return Verdict(True, test, how, ran, len(lines) - len(ran))
    if not lines and ended != 0:
        return Verdict(True, "", "not imported: " + said.strip()[-300:], [], 0)
    return Verdict(False, "", "", ran, len(lines) - len(ran))
