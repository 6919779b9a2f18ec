"""Broken models and their outcomes: each is refused or gives a warning by name; none is computed silently.

`python -m reports.verification.robustness.broken` prints model, outcome and code. The name is the code of the fault, or
the file and the key, column or line at fault.
"""

import warnings
from collections import Counter
from pathlib import Path

import casingfem as cf
import contact as ct
from casingfem.errors import ModelWarning, code_of
from reports.tables import Row, show, write
from reports.verification.robustness.broken import files, keys, shells, tables
from reports.verification.robustness.broken.shells import Broken

OWN = (cf.errors.InputError, cf.errors.NumericsError, ct.InputError, ct.NumericsError)


def models() -> list[Broken]:
    """All broken models."""
    return [*shells.rows(), *files.rows(), *keys.rows(), *tables.rows()]


def outcome(model: Broken) -> tuple[str, list[str]]:
    """Outcome of a model, refused, warned or silent, and the messages: warnings, then the refusal's."""
    happened, refusal = "", list[str]()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            model.make()
        except OWN as error:
            happened, refusal = "refused", str(error).splitlines()
        except Exception as error:
            named = isinstance(error, OSError) and error.filename is not None
            happened, refusal = ("refused" if named else "TRACEBACK"), [f"{type(error).__name__}: {error}"]
    said = [str(entry.message) for entry in caught if isinstance(entry.message, ModelWarning)]
    return happened or ("warned" if said else "silent"), said + refusal


def row(model: Broken) -> Row:
    """One line of the table: what happened, the codes, and whether the expected one is among them."""
    happened, messages = outcome(model)
    codes = list(dict.fromkeys(map(code_of, messages)))
    missing = [name for name in model.names if name not in "\n".join(messages)]
    if model.code and model.code not in codes:
        missing.append(model.code)
    verdict = f"expected {', '.join(missing)}" if missing or happened in ("silent", "TRACEBACK") else "as expected"
    return {"model": model.name, "outcome": happened, "codes": ", ".join(codes), "verdict": verdict}


def main(out: Path, quick: bool = False) -> list[Row]:
    """Try them all (every fifth if quick), print and write the table."""
    rows = [row(model) for model in models()[:: 5 if quick else 1]]
    show("Broken models", rows)
    counts = Counter(str(entry["outcome"]) for entry in rows)
    astray = sum(entry["verdict"] != "as expected" for entry in rows)
    print(f"\n{len(rows)} models: " + ", ".join(f"{n} {name}" for name, n in counts.items()) + f"; {astray} astray")
    write(out / "broken_models.csv", rows)
    return rows
