"""Lists of unlike scenes give the same numbers together as alone; a sample of the campaign's 2,000 draws."""

from pathlib import Path

import pytest

from reports.verification.schemes.batches import CLOSE, drawn, save_bases


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 9, 25, 51, 2004])
def test_runs_of_a_random_list_equal_the_runs_alone(seed: int, tmp_path: Path) -> None:
    save_bases(tmp_path)
    row = drawn(seed, tmp_path)
    assert row["from alone"] <= CLOSE
    assert row["from one"] == 0.0
