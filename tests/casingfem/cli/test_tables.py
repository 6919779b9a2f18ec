"""Tables that commands write: CSV that others read, parquet beside it where pyarrow is installed."""

import io
import json

import pandas as pd
import pytest
from click.testing import CliRunner

from casingfem.cli import main, tables
from casingfem.cli.tables import csv_text, parquets
from tests.casingfem.study.study_texts import STEEL_PLATE

STUDY = f"""{STEEL_PLATE}[update]
table = "plate.csv"
[[update.parameter]]
name = "material.E"
lower = 150e9
upper = 250e9
"""


def read(text):
    return pd.read_csv(io.StringIO(text), comment="#")


def test_none_and_nan_are_empty_cells_and_words_with_commas_stay_whole():
    rows = [{"n": 8, "freq_hz": 371.25, "why": "a, b"}, {"n": None, "freq_hz": float("nan"), "more": True}]
    text = csv_text(rows, "COMPUTED: a test")
    assert text.splitlines()[0] == "# COMPUTED: a test"
    table = read(text)
    assert list(table) == ["n", "freq_hz", "why", "more"]
    assert table["freq_hz"].tolist()[0] == 371.25
    assert table.isna().sum().tolist() == [1, 1, 1, 1]


@pytest.mark.slow
def test_an_update_writes_its_parameters_and_its_pairs(tmp_path):
    (tmp_path / "plate.toml").write_text(STUDY, encoding="utf-8")
    (tmp_path / "plate.csv").write_text("mode,freq_hz,sigma_hz\n1,64.5,0.1\n2,420.0,0.5\n", encoding="utf-8")
    result = CliRunner().invoke(main, ["update", str(tmp_path / "plate.toml"), "--out", str(tmp_path), "--json"])
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    found, pairs = (read((tmp_path / name).read_text()) for name in ("update.csv", "update_pairs.csv"))
    assert found["value"][0] == pytest.approx(document["parameters"][0]["value"], rel=1e-12)
    assert pairs["measured_hz"].tolist() == [64.5, 420.0]


def test_parquet_stands_beside_a_table_where_pyarrow_is(tmp_path, monkeypatch):
    files = {"a.csv": csv_text([{"n": 8, "freq_hz": 371.25}], "COMPUTED"), "a.json": "{}", "a.png": b""}
    monkeypatch.setattr(tables, "find_spec", lambda name: None)
    assert parquets(files) == {}
    monkeypatch.setattr(tables, "find_spec", lambda name: name)
    made = parquets(files)
    assert list(made) == ["a.parquet"]
    arrow = pytest.importorskip("pyarrow.parquet")
    made["a.parquet"](tmp_path / "a.parquet")
    assert arrow.read_table(tmp_path / "a.parquet").to_pydict() == {"n": [8], "freq_hz": [371.25]}
