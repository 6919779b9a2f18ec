"""Problems in a study file, all reported together: file, key, what was found, what was expected."""

from collections.abc import Callable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from casingfem.errors import InputError, code_of, with_code
from casingfem.study.tables.tasks import StudyFile
from contact.io.plausible import question
from contact.io.tables import keys, kinds, models_at, resolved, unknown, value_of, wanted
from contact.io.toml import written

T = TypeVar("T")
KEYS = {  # the code of a value that the schema refuses, by table and key, or by table
    ("material", "E"): "material-modulus",
    ("material", "nu"): "material-poisson",
    ("material", "rho"): "material-density",
    ("shell", "thickness"): "shell-thickness",
    ("strip", "thickness"): "shell-thickness",
    ("chart",): "chart-dimension",
    ("mesh", "order"): "mesh-order",
    ("mesh", "rows"): "mesh-rows",
    ("mesh", "around"): "mesh-around",
    ("modes", "count"): "modes-count",
    ("imperfection", "p"): "field-harmonics",
    ("imperfection", "cos"): "field-range",
    ("imperfection", "sin"): "field-range",
} | {("support", spring): "support-springs" for spring in ("k_r", "k_theta", "k_z", "k_rot", "k_face")}
KINDS = {"extra_forbidden": "study-key", "missing": "study-missing", "too_short": "study-missing"}


class StudyError(InputError):
    """A study that cannot be used: `problems` lists them all, one line each, with file, key and code.

    >>> StudyError(["study.toml: shell.thickness: found -3, expected a number above 0 [study-value]"]).codes
    ('study-value',)
    """

    def __init__(self, problems: Sequence[str]) -> None:
        self.problems = tuple(problems)
        self.codes = tuple(map(code_of, problems))
        super().__init__("\n".join(self.problems))


class Problems(list[str]):
    """The problems found so far in one file.

    >>> found = Problems(Path("study.toml"))
    >>> found.add("shell.thickness", "-3", "a number above 0")
    >>> found
    ['study.toml: shell.thickness: found -3, expected a number above 0 [study-value]']
    """

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.file = file

    def add(self, key: str, found: str, expected: str, code: str = "study-value") -> None:
        """Record one problem."""
        self.append(with_code(code, f"{self.file}: {key}: found {found}, expected {expected}"))

    def at(self, key: str) -> "Attempt":
        """Record a ValueError or OSError raised inside as a problem of this key, and continue."""
        return Attempt(self, key)

    def made(self, key: str, kind: Callable[..., T], table: BaseModel | None) -> T | None:
        """The object of a table, None without a table; problems are collected."""
        if table is not None:
            with self.at(key):
                return value_of(table, kind)
        return None

    def add_invalid(self, error: ValidationError, data: Mapping[str, Any]) -> set[str]:
        """Record all problems of a validation; returns the top-level tables that have some."""
        for _, together in groupby(error.errors(), lambda detail: alternative(detail, data)):
            detail, *others = together
            self.append(with_code(code_at(detail, data), f"{self.file}: {sentence(detail, data, others)}"))
        return {str(detail["loc"][0]) for detail in error.errors()}


class Attempt:
    """A part that may fail: its error becomes a problem, and the rest of the file is still examined."""

    def __init__(self, problems: Problems, key: str) -> None:
        self.problems, self.key = problems, key

    def __enter__(self) -> None:
        """Begin."""

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> bool:
        """Record an error of the input; other errors are raised."""
        if isinstance(error, OSError):
            sentence = f"{self.problems.file}: {self.key}: {error.filename}: {error.strerror}"
            self.problems.append(with_code("study-file", sentence))
        elif isinstance(error, ValueError):
            key = table_of(error, self.key)
            for line in str(error).splitlines():
                line = line.removeprefix(f"{key} ").removeprefix(f"{key}: ")
                code = "survey-table" if self.key.endswith("survey") else "study-value"
                self.problems.append(with_code(code, f"{self.problems.file}: {key}: {line}"))
        return isinstance(error, OSError | ValueError)


class FromFile:
    """An object read from a file, which can report problems with its keys."""

    __slots__ = ()
    path: Path

    def error(self, key: str, found: str, expected: str) -> StudyError:
        """An error that names this file and one of its keys, ready to be raised."""
        problems = Problems(self.path)
        problems.add(key, found, expected)
        return StudyError(problems)


def table_of(error: ValueError, key: str) -> str:
    """The key to name: another table's if the error's code states that it is at fault."""
    code = getattr(error, "code", "")
    head = "" if code.startswith(("mesh-no-group", "mesh-group", "mesh-support")) else code.partition("-")[0]
    return key if head not in ("material", "chart", "shell", "mesh") or key.startswith(head) else head


def alternative(detail: Any, data: Mapping[str, Any]) -> tuple[str, str]:
    """Key and value of a pydantic error: equal for the errors of a value that may be of one kind or another."""
    return written(resolved(detail["loc"], detail["type"], data)), repr(detail["input"])


def sentence(detail: Any, data: Mapping[str, Any], others: Sequence[Any] = ()) -> str:
    """One pydantic error as `key: found X, expected Y`, or `expected Y or Z` with others of the same value."""
    loc, kind, message = resolved(detail["loc"], detail["type"], data), detail["type"], detail["msg"]
    key = written(loc)
    models = models_at([StudyFile], loc[:-1], data)
    meaning = next((keys(m)[str(loc[-1])].description or "" for m in models if str(loc[-1]) in keys(m)), "")
    if kind == "extra_forbidden":
        return f"{key}: found an unknown key, {unknown(str(loc[-1]), models)}"
    if kind == "missing":
        return f"{key}: found nothing, expected {wanted(str(loc[-1]), models)}"
    if kind == "union_tag_not_found":
        known = [name for m in models_at([StudyFile], loc, data) for name in kinds(m)]
        return f"{key}.kind: found nothing, expected one of {', '.join(known)}"
    if kind == "too_short":
        return f"{key}: found {shown(detail['input'])}, expected {meaning or 'at least one entry'}"
    if kind == "union_tag_invalid":
        tags = detail["ctx"]["expected_tags"].replace("'", "")
        return f"{key}.kind: found {detail['ctx']['tag']!r}, expected one of {tags}"
    if kind == "value_error":
        return f"{key}: {message.removeprefix('Value error, ')}"
    if kind == "string_pattern_mismatch" and meaning:
        return f"{key}: found {detail['input']!r}, expected {meaning}"
    expected = " or ".join(dict.fromkeys(map(expectation, (detail, *others))))
    asked = question([keys(m)[str(loc[-1])] for m in models if str(loc[-1]) in keys(m)], detail["input"])
    return f"{key}: found {shown(detail['input'])}, expected {expected}{f' ({meaning})' if meaning else ''}{asked}"


def expectation(detail: Any) -> str:
    """What a pydantic error says was expected, in the words of a file."""
    if detail["type"] == "string_too_short":
        return "a name that is not empty"
    if detail["type"] in ("model_type", "model_attributes_type", "dict_type"):
        return "a table of keys"
    words = {"a valid integer": "a whole number", "a valid ": "a ", "string": "text in quotes", "a text": "text",
             "a boolean": "true or false"}  # fmt: skip
    expected = str(detail["msg"]).removeprefix("Input should be ")
    for theirs, ours in words.items():
        expected = expected.replace(theirs, ours)
    return expected


def code_at(detail: Any, data: Mapping[str, Any]) -> str:
    """The code of a pydantic error, from its kind or its place."""
    path = [str(part) for part in resolved(detail["loc"], detail["type"], data)]
    if detail["type"] in KINDS:
        return KINDS[detail["type"]]
    if detail["type"].startswith("union_tag"):
        return "study-value"
    return KEYS.get((path[0], path[-1]), KEYS.get((path[0],), "study-value"))


def shown(value: object) -> str:
    """A value as in the file, shortened."""
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
