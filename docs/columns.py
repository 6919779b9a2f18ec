"""The page of columns: `.venv/bin/python docs/columns.py` writes docs/columns.md, the tables of all results."""

from importlib import import_module
from pathlib import Path

from contact.io.columns import Columns

PAGE = Path(__file__).parent / "columns.md"
HEAD = """# Columns of results

Made by `.venv/bin/python docs/columns.py`. A result has the same columns in `records()`, JSON, CSV, notebooks, pages
and printed tables. A key holds SI units and ends in the unit where it has one; printed tables use the unit in brackets.
Columns with "-" as header are in records, JSON and CSV alone; those with an asterisk are not in printed tables.
"""
RESULTS = {
    "Modes": "casingfem.modal.mode_columns.COLUMNS",
    "Modes of a rotating structure": "casingfem.modal.whirl.COLUMNS",
    "Waves of a rotating wheel": "casingfem.modal.cyclic.whirl.COLUMNS",
    "Modes of a mistuned wheel": "casingfem.modal.cyclic.mistuned.COLUMNS",
    "Pairs of each random draw": "casingfem.modal.mistuning.DRAWS",
    "Pairs over all random draws": "casingfem.modal.mistuning.SUMMARY",
    "Identified modes": "casingfem.experiment.identify.mode_columns.COLUMNS",
    "Dangerous speeds": "contact.interacting.COLUMNS",
    "Parameters of an update": "casingfem.updating.columns.PARAMETERS",
    "Paired modes of an update": "casingfem.updating.columns.PAIRS",
    "Rows predicted by the others": "casingfem.updating.uncertainty.prediction.COLUMNS",
    "Posterior of an update": "casingfem.updating.uncertainty.posterior.COLUMNS",
    "Frequency table": "casingfem.experiment.frequency_table.TABLE_COLUMNS",
    "Rows of a table and their modes": "casingfem.experiment.correlation.matches.COLUMNS",
    "Measured shapes and their modes": "casingfem.experiment.correlation.correlate.COLUMNS",
    "Runs of a sweep": "contact.sweep.columns.MEASURED",
    "Modes of a Campbell diagram": "casingfem.modal.campbell.MODES",
    "Measured shapes before and after an update": "casingfem.updating.shape_fit.COLUMNS",
    "Directions that a table determines": "casingfem.updating.identifiability.COLUMNS",
    "Samples of a posterior": "casingfem.updating.uncertainty.sampling.COLUMNS",
    "Loose bolts": "casingfem.locate.located.BOLTS",
    "Added masses": "casingfem.locate.located.MASSES",
    "Contacts of a run": "contact.result.CONTACTS",
    "Bars of a coating": "contact.record.wear.COLUMNS",
    "Motions reached from random starts": "contact.cycles.basins.MOTIONS",
    "Growth over speed": "contact.stability.growth_map.COLUMNS",
    "Stability of a rotor": "contact.stability.whirling.COLUMNS",
    "Whirl of a rotor": "contact.model.rotor.whirl.WHIRL",
    "Unbalance response of a rotor": "contact.model.rotor.whirl.RESPONSE",
    "Engine order over speed": "casingfem.modal.cyclic.engine_orders.RESPONSE",
    "Amplification of drawn wheels": "casingfem.modal.cyclic.engine_orders.DRAWS",
    "Periodic motions": "contact.cycles.columns.POINTS",
    "Splits of random casings": "casingfem.chance.result.PAIRS",
    "Dangerous speeds of random casings": "casingfem.chance.result.SPEEDS",
}


def columns_at(place: str) -> Columns:
    """The columns at a dotted name."""
    module, _, name = place.rpartition(".")
    found: Columns = getattr(import_module(module), name)
    return found


def section(title: str, columns: Columns) -> str:
    """One table of the page."""
    heads = {"everywhere": "{}", "pages": "{} *", "files": "-"}
    rows = [f"| {one.name} | {heads[one.where].format(one.header)} | {one.text} |" for one in columns]
    return "\n".join(["", f"## {title}", "", "| key | header | meaning |", "|---|---|---|", *rows, ""])


def page() -> str:
    """The page as text."""
    return HEAD + "".join(section(title, columns_at(place)) for title, place in RESULTS.items())


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")
