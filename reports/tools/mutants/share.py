"""Share of random mutants of both packages that the tests kill: small faults, one at a time, and the tests near them.

`python -m reports.tools.mutants --seed N --count 120 [--jobs J] [--only PATTERN] [--out DIR] [--record]`. Plots are
left out. A rerun continues: each mutant's verdict is a file of its own, valid while packages, tests and data are
unchanged. With --record all tests run once before, to record which functions they run; the record is kept for later
calls. mutants_survivors.csv has a column `note` for the reason why a mutant survives; existing notes are kept, and
mutants whose note begins with "equivalent" are left out of the second share.
"""

import argparse
import hashlib
import itertools
import json
import os
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from queue import SimpleQueue

from contact.io.outfiles import json_text, write_atomic
from reports.tables import OUT, ROOT, Row
from reports.tools.mutants.draw import Mutant, draw, read_sources
from reports.tools.mutants.executed import read_executed
from reports.tools.mutants.judge import RECORDED, Limits, Tree, Verdict
from reports.tools.mutants.reach import Reach, read_reach
from reports.tools.mutants.table import report

PACKAGES = ("casingfem", "contact")
COMPILED = (
    "contact/loop/",
    "contact/solver/",
    "contact/jit/",
    "contact/record/record.py",
    "contact/model/bodies/band.py",
)
CONTENTS = ("casingfem", "contact", "reports", "tests", "data")


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign:
    """The mutants of a project; all files are written below `out`."""

    root: Path = ROOT
    packages: tuple[str, ...] = PACKAGES
    without: str = "casingfem/plot/*"
    seed: int = 1
    count: int = 120
    only: str = "*"
    jobs: int = 1
    out: Path = OUT
    limits: Limits = field(default_factory=Limits)
    record: bool = False

    @property
    def folder(self) -> Path:
        """Folder of copies and verdicts."""
        return (self.out / "mutants").resolve()

    def mutants(self) -> list[Mutant]:
        """The draw."""
        return draw(read_sources(self.root, self.packages, self.without), self.seed, self.count, self.only)

    @property
    def trees(self) -> list[Tree]:
        """The copies of the project, one for each worker."""
        return [Tree(self.root, self.folder / f"tree-{k}") for k in range(self.jobs)]

    def reach(self) -> Reach:
        """References between sources and tests."""
        return read_reach(self.root, self.packages, ("reports", "tests"))

    def tests(self, mutants: Iterable[Mutant]) -> dict[Mutant, list[str]]:
        """Tests for each mutant: those that run its function, then others of as many files as the limits allow.

        Among either, the nearest are first.
        """
        reach, limits = self.reach(), self.limits
        executed = read_executed(sorted(self.folder.glob(f"tree-*-{RECORDED}")))
        chosen = {}
        for mutant in mutants:
            nearest = reach.nearest(mutant.file, mutant.function, self.seed)
            order = list(dict.fromkeys(test.partition("::")[0] for test in nearest))
            running = executed.running(reach, mutant.file, mutant.function)
            files = set(order[: limits.nearest if running else limits.files])
            own = {test.partition("::")[0] for test in running}
            files.update([file for file in order if file in own][: limits.running])
            files.update(file for file in order[: limits.files] if file not in executed.known)
            chosen[mutant] = executed.first((test for test in nearest if test.partition("::")[0] in files), running)
        return chosen

    def limits_of(self, mutant: Mutant) -> Limits:
        """More time where loops are compiled again."""
        limits, more = self.limits, self.limits.compiling * mutant.file.startswith(COMPILED)
        return replace(limits, budget=limits.budget + more, share=limits.share + more, test=limits.test + more)


def contents(root: Path) -> str:
    """Digest of all inputs of a verdict."""
    files = sorted(
        path for name in CONTENTS for path in (root / name).rglob("*")
        if path.is_file() and not {"out", "__pycache__"} & set(path.relative_to(root).parts)
    )  # fmt: skip
    text = b"\0".join(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() for path in files)
    return hashlib.sha256(text).hexdigest()[:12]


def verdict_file(folder: Path, mutant: Mutant) -> Path:
    """File of a mutant's verdict."""
    name = f"{mutant.file}-{mutant.line}-{mutant.start}-{mutant.end}-{mutant.new}"
    return folder / f"{Path(mutant.file).stem}-{mutant.line}-{hashlib.sha256(name.encode()).hexdigest()[:8]}.json"


def judge(campaign: Campaign, trees: Sequence[Tree], folder: Path, tests: dict[Mutant, list[str]]) -> None:
    """Judge the mutants without a verdict, each worker in its tree."""
    idle: SimpleQueue[Tree] = SimpleQueue()
    for tree in trees:
        idle.put(tree)

    def one(mutant: Mutant) -> None:
        tree = idle.get()
        try:
            found = tree.judge(mutant, tests[mutant], campaign.limits_of(mutant))
        finally:
            idle.put(tree)
        write_atomic(verdict_file(folder, mutant), json_text({**asdict(mutant), **asdict(found)}, indent=1))
        state = f"killed by {found.by or 'import'}" if found.killed else f"SURVIVED {len(found.ran)} tests"
        print(f"{mutant.file}:{mutant.line}  {mutant.before}  ->  {mutant.after}\n    {state}", flush=True)

    with ThreadPoolExecutor(len(trees)) as pool:
        list(pool.map(one, (mutant for mutant in tests if not verdict_file(folder, mutant).exists())))


def read_verdict(folder: Path, mutant: Mutant) -> Verdict:
    """A kept verdict."""
    kept = json.loads(verdict_file(folder, mutant).read_text(encoding="utf-8"))
    return Verdict(**{name: kept[name] for name in Verdict.__slots__})


def record(campaign: Campaign, trees: Sequence[Tree]) -> None:
    """Run all tests once, each worker its files, and keep which functions they run."""
    tests = sorted(f"{file}::{name}" for file, name in campaign.reach().tests)
    files = sorted({test.partition("::")[0] for test in tests})
    unlimited = Limits(budget=1e6, share=1e6, test=1e6)

    def one(k: int) -> None:
        own = set(files[k :: len(trees)])
        trees[k].run(
            [test for test in tests if test.partition("::")[0] in own], unlimited, first_failure=False,
            record=campaign.packages,
        )  # fmt: skip

    with ThreadPoolExecutor(len(trees)) as pool:
        list(pool.map(one, range(len(trees))))


def never_passing(tree: Tree, tests: Iterable[str], limits: Limits) -> list[str]:
    """Tests that fail without a mutant as well, of those that killed one."""
    named = sorted({test.partition("[")[0] for test in tests})
    if not named:
        return []
    unlimited = Limits(budget=1e6, share=1e6, test=limits.test + limits.compiling)
    lines, _, said = tree.run(named, unlimited, first_failure=False)
    if not lines:
        raise RuntimeError(f"tests do not run without a mutant either:\n{said[-2000:]}")
    return sorted({test.partition("[")[0] for outcome, test in lines if outcome in ("failed", "begun")})


def collected(trees: Sequence[Tree], tests: Iterable[str]) -> None:
    """Collect tests without a mutant and run none, so that later import errors are caused by the mutant.

    Each tree keeps the bytecode of its sources; without it, every run would compile them all.
    """
    named = sorted(set(tests))
    if not named:
        return
    with ThreadPoolExecutor(len(trees)) as pool:
        for lines, _, said in pool.map(lambda tree: tree.run(named, Limits(budget=0.0), bytecode=True), trees):
            if not lines:
                raise RuntimeError(f"tests are not collected without a mutant either:\n{said[-2000:]}")


def main(campaign: Campaign) -> list[Row]:
    """Draw mutants, judge them, print the share killed and the survivors."""
    folder = campaign.folder / f"verdicts-{contents(campaign.root)}"
    trees = campaign.trees
    for tree in trees:
        tree.refresh()
    if campaign.record and not trees[0].recorded.exists():
        record(campaign, trees)
    tests = campaign.tests(campaign.mutants())
    collected(trees, itertools.chain.from_iterable(tests.values()))
    broken: set[str] = set()
    while True:
        judge(campaign, trees, folder, {m: [t for t in named if t not in broken] for m, named in tests.items()})
        verdicts = {mutant: read_verdict(folder, mutant) for mutant in tests}
        # where not even the packages could be imported, any test shows that they can be without the mutant
        kills = {mutant: found.by or tests[mutant][0] for mutant, found in verdicts.items() if found.killed}
        newly = set(never_passing(trees[0], kills.values(), campaign.limits)) - broken
        if not newly:
            break
        broken |= newly
        for mutant, by in kills.items():
            if by.partition("[")[0] in newly:
                verdict_file(folder, mutant).unlink()
    return report(campaign.out, campaign.seed, verdicts, broken)


def positive(text: str) -> int:
    """A number of the command line."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"found {text!r}, expected a whole number of 1 or more")
    return int(text)


def command_line(arguments: Sequence[str] | None = None) -> Campaign:
    """The campaign that a command line describes."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--count", type=positive, default=120, help="how many mutants")
    parser.add_argument("--jobs", type=positive, default=os.cpu_count() or 1, help="how many at a time")
    parser.add_argument("--only", default="*", help="pattern of the files to change, such as 'contact/scheme/*'")
    parser.add_argument("--record", action="store_true", help="first see which functions all tests run: ten minutes")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the results")
    campaign = Campaign(**vars(parser.parse_args(arguments)))
    if not campaign.mutants():
        parser.error(f"--only: found {campaign.only!r}, expected a pattern of files below {' or '.join(PACKAGES)}")
    return campaign
