"""Errors and warnings about a model; each has a code, a cause and a remedy.

A message states the finding and its place. Remedy and code come from the catalogue (`casingfem.faults`), so that users
can find a code there and programs can react to it.
"""

import re
import warnings

from casingfem.faults import CATALOGUE

CODE = re.compile(r"\[([a-z0-9-]+)\]$")


class InputError(ValueError):
    """Input that cannot be used: place, finding and expectation, each an attribute if known.

    >>> str(InputError("rig.csv", line=7, column="n", found="'x'", expected="a whole number"))
    "rig.csv, line 7, column 'n': found 'x'; expected a whole number"
    """

    def __init__(
        self,
        path: str,
        *,
        found: str = "",
        expected: str = "",
        line: int | None = None,
        column: str | None = None,
        where: str = "",
        sheet: str = "",
    ) -> None:
        self.path, self.line, self.column, self.where, self.found, self.expected = (
            path, line, column, where, found, expected
        )  # fmt: skip
        number = f"{'row' if sheet else 'line'} {line}" if line else ""
        named = f"column {column!r}" if column is not None else ""
        place = [path, f"sheet {sheet!r}" if sheet else "", number, named, where]
        super().__init__(
            ", ".join(filter(None, place)) + (f": found {found}; expected {expected}" if found or expected else "")
        )


class MissingExtraError(InputError):
    """A package that an optional part needs is not installed; the message states how to install it.

    >>> raised = MissingExtraError("", found="no package emcee", expected="pip install 'casingfem[sampling]'")
    >>> str(raised)
    ": found no package emcee; expected pip install 'casingfem[sampling]'"
    """


class NumericsError(RuntimeError):
    """A computation that failed: a matrix that cannot be factorised, modes that cannot be found or certified.

    >>> issubclass(NumericsError, Exception)
    True
    """


class ModelError(InputError):
    """A model that is refused: `code` names the fault in the catalogue, the message ends with remedy and code.

    >>> str(ModelError("shell-thickness", "shell.thickness must be above 0, found -3.0"))
    'shell.thickness must be above 0, found -3.0; give the thickness in metres, 3 mm as 3e-3 [shell-thickness]'
    """

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(sentence(code, message))


class ModelWarning(UserWarning):
    """A model that is computed although its result may mislead; same form as `ModelError`.

    >>> raised = ModelWarning("mesh-coarse", "rows: found 1 row")
    >>> raised.code
    'mesh-coarse'
    """

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(sentence(code, message))


def warn(code: str, message: str, *, stacklevel: int = 3) -> None:
    """Warn of a catalogued fault that does not stop the computation.

    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     warn("mesh-coarse", "rows: found 1 row")
    >>> caught[0].message.code
    'mesh-coarse'
    """
    warnings.warn(ModelWarning(code, message), stacklevel=stacklevel)


def sentence(code: str, message: str) -> str:
    """The finding, the remedy, and the code.

    >>> print(sentence("mesh-coarse", "rows: found 1 row"))
    rows: found 1 row; use more elements or a higher order, ask for fewer modes, or leave [mesh] out [mesh-coarse]
    """
    return f"{message}; {CATALOGUE[code].remedy} [{code}]"


def with_code(code: str, message: str) -> str:
    """A message with its own remedy, and its code; a message that already ends with a code keeps it.

    >>> with_code("study-value", "material.nu: found 0.7, expected less than 0.5")
    'material.nu: found 0.7, expected less than 0.5 [study-value]'
    """
    return message if code_of(message) else f"{message} [{code}]"


def code_of(message: str) -> str:
    """The code at the end of a message, "" if there is none.

    >>> code_of("a wall of -3 m [shell-thickness]"), code_of("no code here")
    ('shell-thickness', '')
    """
    found = CODE.search(message)
    return found[1] if found and found[1] in CATALOGUE else ""
