"""Problems in a scene file, all reported together: file, key, what was found, what is expected."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from contact.base.errors import InputError
from contact.io.toml import written
from contact.io.trust import SceneWarning as SceneWarning

if TYPE_CHECKING:
    from pydantic import BaseModel

Model = TypeVar("Model", bound="BaseModel")
LONG = re.compile(r"\b[1-9]0{8,}\b")  # a bound that pydantic writes out in all its zeros


class SceneError(InputError):
    """A scene file that cannot be run: `problems` lists them all, each with file and key.

    >>> raised = SceneError(["scene.toml: rod.elements: found 0, expected 1 or more"])
    >>> len(raised.problems), str(raised)
    (1, 'scene.toml: rod.elements: found 0, expected 1 or more')
    """

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


class Problems(list[str]):
    """The problems found so far in one file.

    >>> found = Problems(Path("scene.toml"))
    >>> with found.at("speed"):
    ...     raise InputError("hz: found nan")
    >>> found
    ['scene.toml: speed: hz: found nan']
    """

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.file = file

    @contextmanager
    def at(self, key: str = "") -> Iterator[None]:
        """Record bad input of this key, and continue."""
        try:
            yield
        except InputError as error:
            self.append(f"{self.file}: {key}: {error}" if key else f"{self.file}: {error}")

    def check(self) -> None:
        """Raise SceneError if there are any problems."""
        if self:
            raise SceneError(list(self))


def validated(model: type[Model], data: Any, file: Path, table: str = "") -> Model:
    """Validate a table of a file by its model; raises SceneError, which lists all its faults."""
    from pydantic import ValidationError

    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise SceneError([problem_text(file, detail, data, model, table) for detail in error.errors()]) from error


def problem_text(file: Path, detail: Any, data: Any, model: type[BaseModel], table: str = "") -> str:
    """Format one pydantic error of a table's `data` as file: key: found, expected."""
    from contact.io.plausible import question
    from contact.io.tables import keys, kinds, models_at, resolved, unknown, wanted

    path = resolved(detail["loc"], detail["type"], data)
    models = models_at([model], path[:-1], data)
    meaning = next((keys(m)[str(path[-1])].description for m in models if path and str(path[-1]) in keys(m)), None)
    key = written((table, *path) if table else path)
    if detail["type"] == "extra_forbidden":
        return f"{file}: {key}: unknown key, {unknown(str(path[-1]), models)}"
    if detail["type"] == "missing":
        expected = wanted(str(path[-1]), models) if path else ""
        return f"{file}: {key}: missing{f', expected {expected}' if expected else ''}"
    if detail["type"] == "union_tag_not_found":
        known = [name for m in models_at([model], path, data) for name in kinds(m)]
        return f"{file}: {key}.kind: missing, expected one of {', '.join(known)}"
    if detail["type"] == "union_tag_invalid":
        found, tags = detail["ctx"]["tag"], detail["ctx"]["expected_tags"].replace("'", "")
        return f"{file}: {key}.kind: found {found!r}, expected one of {tags}"
    message = detail["msg"].removeprefix("Value error, ")
    if isinstance(detail["input"], dict) or detail["type"] == "value_error":
        return f"{file}: {key}: {message}" if key else f"{file}: {message}"
    expected = LONG.sub(lambda digits: f"{float(digits[0]):g}", message.removeprefix("Input should be "))
    if detail["type"] == "string_too_short":
        expected = "a name that is not empty"
    asked = question([keys(m)[str(path[-1])] for m in models if path and str(path[-1]) in keys(m)], detail["input"])
    return f"{file}: {key}: found {detail['input']!r}, expected {expected}{f' ({meaning})' if meaning else ''}{asked}"
