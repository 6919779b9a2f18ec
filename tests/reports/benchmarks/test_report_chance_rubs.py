"""Reports on rubs of random casings and on a device run small."""

import os
import subprocess
import sys

import pandas as pd
import pytest

from reports.benchmarks import chance_rubs


@pytest.mark.campaign
def test_rubs_of_random_casings_are_timed(tmp_path):
    (row,) = chance_rubs.main(tmp_path, quick=True)
    assert (row["runs"], row["turns"]) == (4, 100)
    assert row["mean steps"] > 1e5
    assert row["s a run"] > 0.0


@pytest.mark.campaign
def test_rubs_on_the_simulator_are_those_of_the_processor(tmp_path):
    line = [sys.executable, "-m", "reports.benchmarks.device", "--quick", "--out", str(tmp_path)]
    subprocess.run(line, env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1"}, check=True, timeout=300)
    rows = pd.read_csv(tmp_path / "device.csv")
    assert rows["where"].tolist()[1:] == ["simulator", "simulator"]
    assert rows["difference"].max() < 1e-12
