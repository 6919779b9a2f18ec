"""The page of codes: `.venv/bin/python docs/errors.py` writes docs/errors.md from the catalogue."""

from pathlib import Path

from casingfem.faults import CATALOGUE

PAGE = Path(__file__).parent / "errors.md"
HEAD = """# Errors and warnings

Made by `.venv/bin/python docs/errors.py` from `casingfem/faults/`. Every refusal and warning about a structural
model, and every flag of a contact run, ends with one of these codes; `casingfem explain shell-thickness` prints its
line.

| code | cause | remedy |
|---|---|---|
"""


def page() -> str:
    """The page as text."""
    rows = (f"| {code} | {fault.cause} | {fault.remedy} |\n" for code, fault in sorted(CATALOGUE.items()))
    return HEAD + "".join(row.replace("| |", "| – |") for row in rows)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")
