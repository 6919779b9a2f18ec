"""Record of the tests that run each function and of their processor time, from one run of all tests."""

import json
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Container, Generator, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest

from contact.io.outfiles import json_text, write_atomic
from reports.tools.mutants.reach import Reach, Unit

SHORT = 1.0  # [s]


@dataclass(frozen=True, slots=True)
class Executed:
    """The tests that run a function, by its file and its dotted name, and the processor seconds of each test."""

    tests: Mapping[Unit, frozenset[str]]
    seconds: Mapping[str, float]

    @classmethod
    def of(cls, records: Iterable[Mapping[str, Mapping[str, Any]]]) -> "Executed":
        """From what was recorded of each test: its seconds, and its functions as "file::name"."""
        found: defaultdict[Unit, set[str]] = defaultdict(set)
        seconds: dict[str, float] = {}
        for record in records:
            for test, seen in record.items():
                seconds[test] = float(seen["seconds"])
                for text in seen["functions"]:
                    file, _, name = text.partition("::")
                    found[file, name].add(test)
                    found[file, name.partition(".")[0]].add(test)
        return cls({unit: frozenset(tests) for unit, tests in found.items()}, seconds)

    @property
    def known(self) -> frozenset[str]:
        """All files of tests that were examined."""
        return frozenset(test.partition("::")[0] for test in self.seconds)

    def first(self, tests: Iterable[str], running: Container[str]) -> list[str]:
        """Tests in another order: short ones that run the function, long ones that do, then the others.

        A test that is newer than the record may run it. A fixture or a cached result may run it for a test that was
        recorded without it.
        """

        def late(test: str) -> tuple[bool, bool]:
            return test in self.seconds and test not in running, self.seconds.get(test, 0.0) > SHORT

        return sorted(tests, key=late)

    def running(self, reach: Reach, file: str, function: str) -> frozenset[str]:
        """Tests that run a function or, where none was seen to, what refers to it most directly.

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
    """A pytest plugin: writes to `path` which functions of `packages` each test runs, and how long it takes."""

    path: Path
    packages: tuple[str, ...]
    seen: dict[str, set[CodeType]] = field(default_factory=dict)
    seconds: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Watch the calls of one test, and of what is made for it; a test with parameters is one test."""
        test, began = item.nodeid.partition("[")[0], time.process_time()
        codes = self.seen.setdefault(test, set())

        def note(frame: FrameType, _event: str, _value: object) -> None:
            codes.add(frame.f_code)

        threading.setprofile(note)
        sys.setprofile(note)
        try:
            return (yield)
        finally:
            sys.setprofile(None)
            threading.setprofile(None)
            self.seconds[test] += time.process_time() - began

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Write the record."""
        root = session.config.rootpath
        inside = tuple(f"{root / name}/" for name in self.packages)
        record = {
            test: {
                "seconds": round(self.seconds[test], 3),
                "functions": sorted(
                    f"{Path(code.co_filename).relative_to(root).as_posix()}::{code.co_qualname.partition('.<')[0]}"
                    for code in codes
                    if code.co_filename.startswith(inside) and not code.co_qualname.startswith("<")
                ),
            }
            for test, codes in self.seen.items()
        }
        write_atomic(self.path, json_text(record))


def read_executed(paths: Iterable[Path]) -> Executed:
    """The record as written before."""
    return Executed.of(json.loads(path.read_text(encoding="utf-8")) for path in paths)
