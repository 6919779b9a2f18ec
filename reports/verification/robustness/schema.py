"""Each key of study.toml and scene.toml with wrong values: refused by its name, or accepted.

`python -m reports.verification.robustness.schema [--quick] [--out DIR]`. The keys come from the tables' models, as
those of docs/keys.md. Each table is taken once for each command, from a small valid file (`schema_bases.py`). A case
sets one key to a value of the wrong type, a negative, zero, huge, tiny or non-finite number, an empty text or list.
The command of the file runs to its end in a fork of this process with 20 s of processor time and 4 GB. A case fails if
it ends in a traceback, a stray warning, exit code 1, a number that is not finite, or not at all. It also fails if a
number of the original answer becomes null (except for labels of modes, the growth of a motion at rest, the orbit
without a whole turn). "unnamed" counts refusals whose message does not name the key, its unit aside.
`schema_accepted.csv` lists each accepted case with the rule by which it is right (`schema_accepted.py`); "unjudged"
counts those without one. Needs fork (Linux, macOS).
"""

import json
import math
import os
import re
import resource
import signal
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, suppress
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

from click.testing import CliRunner

from casingfem.cli import main as casingfem
from casingfem.cli.schema import roots
from casingfem.structure.imported import read
from contact.io.tables import Model, keys, models_at, type_words
from contact.io.toml import entries, written
from reports.tables import Row, command_line, show, write
from reports.verification.robustness.file_mutations import forked, leaves, used
from reports.verification.robustness.schema_accepted import rule
from reports.verification.robustness.schema_bases import BASES, Base, write_companions

SECONDS, WALL, BYTES = 20, 60, 4e9
EVERY = 40  # of a quick run: one case in so many
NUMBERS = {"negative": -1.0, "zero": 0.0, "huge": 1e30, "tiny": 1e-300, "nan": math.nan, "inf": math.inf}
WHOLE = NUMBERS | {"negative": -1, "zero": 0, "huge": 10**18}
OUTCOMES = ("refused", "unnamed", "numerics", "accepted", "unjudged", "failed")
LABELS = ("n", "n_purity", "m", "angle_deg", "doublet", "split_rel", "first_contact")  # null where a mode has none
UNFITTED = ("'at rest'", "'undecided'")  # states of a motion whose growth is null
UNITS = ("_deg", "_hz", "_db", "_n")
Place = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Case:
    """A base with one key changed."""

    base: Base
    path: Place
    damage: str
    value: object
    usual: tuple[object, ...]

    @property
    def command(self) -> str:
        """That of the file."""
        return self.base.command

    @property
    def key(self) -> str:
        """The key as the file writes it."""
        return written(self.path)

    @property
    def text(self) -> str:
        """The file."""
        data = deepcopy(self.base.data)
        here: Any = data
        for part in self.path[:-1]:
            here = here[part]
        here[self.path[-1]] = self.value
        return toml(data)


@dataclass(frozen=True, slots=True)
class Ended:
    """Exit code of a command, what it wrote, and the exception that it let through."""

    code: int
    out: str
    err: str
    raised: str = ""


def toml(data: Mapping[str, Any]) -> str:
    """A file of one line for each of its tables."""
    return "".join(f"{json.dumps(key)} = {inline(value)}\n" for key, value in data.items())


def inline(value: object) -> str:
    """A value in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {inline(part)}" for key, part in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    return repr(value) if isinstance(value, float) else json.dumps(value, ensure_ascii=False)


def tables(base: Base) -> Iterator[tuple[Model, Place]]:
    """Each table of a file with its model: of a list of tables the first."""
    known = roots()
    data = base.data
    starts: list[tuple[Model, Place]] = [(known[base.root], ())]
    if base.root == "sweep":
        starts = [(known["rods"], ()), (known["sweep"], ("sweep",))]
    seen = set()
    for root, start in starts:
        top: Any = data
        for part in start:
            top = top[part]
        for path in below(top):
            for model in models_at([root], path, top):
                here: Any = top
                for part in path:
                    here = here[part]
                if not set(here) <= set(keys(model)) or (model, start + path) in seen:
                    continue  # a table of names, or a member of a union that this one is not
                seen.add((model, start + path))
                yield model, start + path


def below(value: object, path: Place = ()) -> Iterator[Place]:
    """The paths of a table and of all tables in it."""
    if isinstance(value, dict):
        yield path
    for key, part in list(entries(value).items())[: None if isinstance(value, dict) else 1]:
        if isinstance(part, dict | list):
            yield from below(part, (*path, key))


def damages(words: str, present: object) -> dict[str, object]:
    """The wrong values for a key of the described type."""
    numbers: dict[str, object] = dict(WHOLE if "whole number" in words else NUMBERS)
    if words.startswith("list of") and "number" in words:
        count = len(present) if isinstance(present, list) else int((re.findall(r"\((\d+)\)", words) or ["1"])[0])
        rest = present[1:] if isinstance(present, list) else None
        numbers = {
            name: [value, *(rest if rest is not None else [value] * (count - 1))] for name, value in numbers.items()
        }
        if "list of list" in words:
            first = present[0] if isinstance(present, list) else [0.0]
            numbers = {name: [[value[0], *first[1:]], *value[1:]] for name, value in numbers.items()}  # type: ignore[index]
    wrong: object = 12.5 if words.startswith(("text", '"')) else "word"
    return {"wrong type": wrong, **numbers, "empty text": "", "empty list": []}


def cases() -> Iterator[Case]:
    """Every case, each key of a table once a command."""
    seen = set()
    for base in BASES:
        for model, path in tables(base):
            here: Any = base.data
            for part in path:
                here = here[part]
            for key, info in keys(model).items():
                if (base.command, model, key) in seen:
                    continue
                seen.add((base.command, model, key))
                default = None if info.is_required() else info.get_default(call_default_factory=True)
                for damage, value in damages(type_words(info), here.get(key)).items():
                    yield Case(base, (*path, key), damage, value, (here.get(key, default), default))


def ran(base: Base, file: Path, text: str) -> Ended:
    """The command on a file with this text, in this process."""
    file.write_text(text, encoding="utf-8")
    found = CliRunner().invoke(casingfem, [base.command, str(file), "--json"])
    raised = (
        "" if isinstance(found.exception, SystemExit | None) else f"{type(found.exception).__name__}: {found.exception}"
    )
    return Ended(found.exit_code, found.stdout, found.stderr, raised)


def in_child(case: Case, file: Path) -> Ended | None:
    """The same in a fork of this process; None if that was killed."""
    with tempfile.TemporaryFile("w+") as stream:
        child = os.fork()
        if child == 0:
            with suppress(BaseException):
                resource.setrlimit(resource.RLIMIT_AS, (int(BYTES) + used(),) * 2)
                resource.setrlimit(resource.RLIMIT_CPU, (SECONDS + spent(), SECONDS + spent() + 1))
                signal.signal(signal.SIGALRM, signal.SIG_DFL)
                signal.alarm(WALL)
                ended = ran(case.base, file, case.text)
                json.dump([ended.code, ended.out, ended.err, ended.raised], stream)
                stream.flush()
            os._exit(0)
        os.waitpid(child, 0)
        stream.seek(0)
        answer = stream.read()
    return Ended(*json.loads(answer)) if answer else None


def spent() -> int:
    """Processor time of this process [s]; a fork begins at zero."""
    return int(sum(os.times()[:2])) + 1


def judged(case: Case, ended: Ended | None, same: Mapping[str, object]) -> tuple[str, str]:
    """The outcome and the message; `same` are the parts of the base's answer that do not vary."""
    if ended is None:
        return "failed", "out of time or dead"
    if ended.raised:
        return (
            "failed",
            f"out of memory: {ended.raised}" if "MemoryError" in ended.raised else f"traceback: {ended.raised}",
        )
    if stray := re.search(r"\w+\.py:\d+: \w*Warning.*", ended.err):
        return "failed", f"stray warning: {stray[0]}"
    last = (ended.err.strip().splitlines() or [""])[-1]
    if ended.code == 2:
        key = str(case.path[-1])
        bare = next((key.removesuffix(unit) for unit in UNITS if key.endswith(unit)), key)
        named = any(re.search(rf"(?<![A-Za-z0-9]){re.escape(k)}(?![A-Za-z0-9])", ended.err) for k in (key, bare))
        return ("refused" if named else "unnamed"), last
    if ended.code == 3:
        return "numerics", last
    if ended.code != 0:
        return "failed", f"exit code {ended.code}: {last}"
    if re.search(r"\b(NaN|-?Infinity)\b", ended.out):
        return "failed", "not finite: the answer"
    found = dict(leaves(json.loads(ended.out)))
    unfitted = (".growth.",) if found.get(".growth.state") in UNFITTED else ()
    unfitted += (".rotor.",) if found.get(".rotor.turns") == "0" else ()  # no whole turn, no mean orbit
    gone = [
        name
        for name, value in same.items()
        if value != "None" and found.get(name) == "None" and name.rpartition(".")[2] not in LABELS
        and not name.startswith(unfitted)
    ]  # fmt: skip
    if gone:
        return "failed", f"null where a number is expected: {', '.join(gone[:3])}"
    return "accepted", "equal" if all(found.get(name) == value for name, value in same.items()) else "unequal"


def steady(base: Base, file: Path) -> dict[str, object]:
    """Parts of the answer that two runs of a base have in common; the first run compiles the loops."""
    answers = []
    for text in (toml(base.data), toml(base.data) + "# again\n"):
        ended = ran(base, file, text)
        if ended.code:
            raise RuntimeError(f"{base.name}: the base must run: {ended.raised or ended.err}")
        answers.append(dict(leaves(json.loads(ended.out))))
    return {name: value for name, value in answers[0].items() if answers[1].get(name) == value}


def main(out: Path, quick: bool = False, only: str = "") -> list[Row]:
    """Run the cases, count by base, and list what failed and what was accepted."""
    todo: dict[Base, list[Case]] = {}
    for number, case in enumerate(cases()):
        if (not quick or number % EVERY == 0) and only in case.base.name:
            todo.setdefault(case.base, []).append(case)
    rows: list[Row] = []
    listed: list[Row] = []
    with tempfile.TemporaryDirectory() as place, ExitStack() as stack:
        stack.enter_context(mock.patch.object(read, "fault_of", forked))
        folder = Path(place)
        write_companions(folder)
        file = folder / "case.toml"
        for base, chosen in todo.items():
            same = steady(base, file)
            counts: Counter[str] = Counter()
            answers: dict[tuple[Place, str], dict[str, object]] = {}
            for case in chosen:
                ended = in_child(case, file)
                outcome, said = judged(case, ended, same)
                why = ""
                if outcome == "accepted" and ended is not None:
                    answers[case.path, case.damage] = dict(leaves(json.loads(ended.out)))
                    why = rule(case, said == "equal", answers, same)
                    outcome = outcome if why else "unjudged"
                counts[outcome] += 1
                listed.append({"base": base.name, "command": base.command, "key": case.key,
                               "value": case.damage, "outcome": outcome, "said": said.replace(place, ""),
                               "rule": why})  # fmt: skip
            named = len({case.path for case in chosen})
            rows.append({"base": base.name, "command": base.command, "keys": named, "cases": len(chosen),
                         **{outcome: counts[outcome] for outcome in OUTCOMES}})  # fmt: skip
            print(*rows[-1].values(), flush=True)
    show("Keys with values that they should not have", rows)
    for name in ("failed", "unnamed", "unjudged", "accepted"):
        if some := [row for row in listed if row["outcome"] == name]:
            write(out / f"schema_{name}.csv", some)
            if name != "accepted":
                show(name.capitalize(), some)
    totals = {name: sum(int(str(row[name])) for row in rows) for name in ("keys", "cases", *OUTCOMES)}
    print("\n" + ", ".join(f"{count} {name}" for name, count in totals.items()))
    write(out / "schema.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
