"""Record of the files of tests that run each function, from one run of all tests."""

import json
import sys
import threading
from collections import defaultdict
from collections.abc import Generator, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import CodeType, FrameType

import pytest

from contact.io.outfiles import json_text, write_atomic
from reports.tools.mutants.reach import Reach, Unit


@dataclass(frozen=True, slots=True)
class Executed:
    """The files of tests that run a function, by its file and its dotted name, and all files that were examined."""

    tests: Mapping[Unit, frozenset[str]]
    known: frozenset[str]

    @classmethod
    def of(cls, records: Iterable[Mapping[str, Iterable[str]]]) -> "Executed":
        """From what was recorded: functions as "file::name" by file of tests."""
        found: defaultdict[Unit, set[str]] = defaultdict(set)
        known: set[str] = set()
        for record in records:
            known |= record.keys()
            for test, functions in record.items():
                for text in functions:
                    file, _, name = text.partition("::")
                    found[file, name].add(test)
                    found[file, name.partition(".")[0]].add(test)
        return cls({unit: frozenset(tests) for unit, tests in found.items()}, frozenset(known))

    def running(self, reach: Reach, file: str, function: str) -> frozenset[str]:
        """Files of tests that run a function or, where none was seen to, what refers to it most directly.

        Python does not trace compiled code, and runs statements outside of functions at import.
        """
        tests = self.tests.get((file, function), frozenset())
        edge, found = {(file, function.partition(".")[0])}, {(file, function.partition(".")[0])}
        while edge and not tests:
            edge = {user for unit in edge for user in reach.users.get(unit, frozenset())} - found
            found |= edge
            tests = frozenset().union(*(self.tests.get(unit, frozenset()) for unit in edge))
        return tests


@dataclass(frozen=True, slots=True, eq=False)
class Recorder:
    """A pytest plugin: writes to `path` which functions of `packages` each file of tests runs."""

    path: Path
    packages: tuple[str, ...]
    seen: dict[str, set[CodeType]] = field(default_factory=dict)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Watch the calls of one test, and of what is made for it."""
        codes = self.seen.setdefault(item.nodeid.partition("::")[0], set())

        def note(frame: FrameType, _event: str, _value: object) -> None:
            codes.add(frame.f_code)

        threading.setprofile(note)
        sys.setprofile(note)
        try:
            return (yield)
        finally:
            sys.setprofile(None)
            threading.setprofile(None)

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Write the record."""
        root = session.config.rootpath
        inside = tuple(f"{root / name}/" for name in self.packages)
        record = {
            test: sorted(
                f"{Path(code.co_filename).relative_to(root).as_posix()}::{code.co_qualname.partition('.<')[0]}"
                for code in codes
                if code.co_filename.startswith(inside) and not code.co_qualname.startswith("<")
            )
            for test, codes in self.seen.items()
        }
        write_atomic(self.path, json_text(record))


def read_executed(paths: Iterable[Path]) -> Executed:
    """The record as written before."""
    return Executed.of(json.loads(path.read_text(encoding="utf-8")) for path in paths)
