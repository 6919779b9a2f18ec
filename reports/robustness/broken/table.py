"""Broken models and what becomes of them: each is refused or warned of, with its code; none computes in silence.

`python -m reports.robustness.broken` prints model, outcome and code.
"""

import warnings
from collections import Counter
from pathlib import Path

import casingfem as cf
from casingfem.errors import ModelWarning, code_of
from reports.robustness.broken import files, shells
from reports.robustness.broken.shells import Broken
from reports.tables import Row, show, write


def models() -> list[Broken]:
    """All broken models."""
    return [*shells.rows(), *files.rows()]


def outcome(model: Broken) -> tuple[str, list[str]]:
    """What becomes of a model, refused, warned or silent, and the messages: warnings, then the refusal's."""
    happened, refusal = "", list[str]()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            model.make()
        except (ValueError, cf.errors.NumericsError) as error:
            happened, refusal = "refused", str(error).splitlines()
    said = [str(entry.message) for entry in caught if isinstance(entry.message, ModelWarning)]
    return happened or ("warned" if said else "silent"), said + refusal


def row(model: Broken) -> Row:
    """One line of the table: what happened, the codes, and whether the expected one is among them."""
    happened, messages = outcome(model)
    codes = list(dict.fromkeys(map(code_of, messages)))
    verdict = "as expected" if model.code in codes else f"expected {model.code}"
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
