"""Tables that commands write: CSV that others read, parquet beside it where pyarrow is installed."""

import io
import json

import pandas as pd
import pytest
from click.testing import CliRunner

from casingfem.cli import main
from tests.casingfem.study.study_texts import STEEL_PLATE
from tests.probed import numbers_of_document

STUDY = f"""{STEEL_PLATE}[update]
table = "plate.csv"
[[update.parameter]]
name = "material.E"
lower = 150e9
upper = 250e9
"""


def read(text):
    return pd.read_csv(io.StringIO(text), comment="#")


@pytest.mark.slow
def test_an_update_writes_its_parameters_and_its_pairs(tmp_path, held):
    (tmp_path / "plate.toml").write_text(STUDY, encoding="utf-8")
    (tmp_path / "plate.csv").write_text("mode,freq_hz,sigma_hz\n1,64.5,0.1\n2,420.0,0.5\n", encoding="utf-8")
    result = CliRunner().invoke(main, ["update", str(tmp_path / "plate.toml"), "--out", str(tmp_path), "--json"])
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    found, pairs = (read((tmp_path / name).read_text()) for name in ("update.csv", "update_pairs.csv"))
    assert found["value"][0] == pytest.approx(document["parameters"][0]["value"], rel=1e-12)
    assert pairs["measured_hz"].tolist() == [64.5, 420.0]
    held(1e-4, document=numbers_of_document(document))
