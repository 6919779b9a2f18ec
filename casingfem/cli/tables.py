"""Tables as files: CSV, and also parquet if pyarrow is installed."""

import csv
import io
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from contact.io.outfiles import Content


def csv_text(rows: Iterable[Mapping[str, Any]], card: str = "", columns: Iterable[str] = ()) -> str:
    r"""Rows as CSV under their names, or those of `columns`, after comment lines; None and nan become empty cells.

    >>> csv_text([{"mode": 1, "freq_hz": 371.2}, {"mode": 2, "freq_hz": float("nan")}], "COMPUTED")
    '# COMPUTED\nmode,freq_hz\n1,371.2\n2,\n'
    """
    found, text = list(rows), io.StringIO()
    text.writelines(f"# {line}\n" for line in card.splitlines())
    names = list(columns) or list(dict.fromkeys(name for row in found for name in row))
    writer = csv.DictWriter(text, names, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: "" if value is None or value != value else value for name, value in row.items()}
                     for row in found)  # fmt: skip
    return text.getvalue()


def parquets(files: Mapping[str, Content]) -> dict[str, Content]:
    """Also the tables among some files as parquet, if the optional package pyarrow is installed."""
    if find_spec("pyarrow") is None:
        return {}
    tables = {name: text for name, text in files.items() if name.endswith(".csv") and isinstance(text, str)}
    return {str(Path(name).with_suffix(".parquet")): of_csv(text) for name, text in tables.items()}


def of_csv(text: str) -> Callable[[Path], None]:
    """Writer of the table in a CSV text, without its comment lines."""
    body = "".join(line for line in text.splitlines(keepends=True) if not line.startswith("#")).encode("utf-8")

    def write(path: Path) -> None:
        table = import_module("pyarrow.csv").read_csv(io.BytesIO(body))
        import_module("pyarrow.parquet").write_table(table, str(path))

    return write


def of_columns(columns: Mapping[str, Any]) -> Callable[[Path], None]:
    """Writer of a table given by its columns."""

    def write(path: Path) -> None:
        arrow: Any = import_module("pyarrow")
        import_module("pyarrow.parquet").write_table(arrow.table(dict(columns)), str(path))

    return write
