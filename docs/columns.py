"""The page of columns: `.venv/bin/python docs/columns.py` writes docs/columns.md, the tables of all results."""

from importlib import import_module
from pathlib import Path

from contact.io.columns import Columns

PAGE = Path(__file__).parent / "columns.md"
HEAD = """# Columns of results

Made by `.venv/bin/python docs/columns.py`. A result has the same columns in `records()`, JSON, CSV, notebooks, pages
and printed tables. A key holds SI units and ends in the unit where it has one; printed tables use the unit in brackets.
Columns with "-" as header are left out of printed tables.
"""
RESULTS = {
    "Modes": "casingfem.modal.mode_columns.COLUMNS",
}


def columns_at(place: str) -> Columns:
    """The columns at a dotted name."""
    module, _, name = place.rpartition(".")
    found: Columns = getattr(import_module(module), name)
    return found


def section(title: str, columns: Columns) -> str:
    """One table of the page."""
    rows = [f"| {column.name} | {column.header if column.shown else '-'} | {column.text} |" for column in columns]
    return "\n".join(["", f"## {title}", "", "| key | header | meaning |", "|---|---|---|", *rows, ""])


def page() -> str:
    """The page as text."""
    return HEAD + "".join(section(title, columns_at(place)) for title, place in RESULTS.items())


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")
