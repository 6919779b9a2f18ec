"""Related contact problems have related answers: units, signs, order, mirrors, far contacts, split springs, time."""

import pytest

from reports.verification.schemes.metamorphic import patch_rows, rim_rows

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", range(10, 22))
def test_a_patch_and_its_relatives_agree(seed):
    rows = patch_rows(seed)
    assert rows[0]["touches"]
    assert [row["relation"] for row in rows if not row["found"] <= row["allowed"]] == []


@pytest.mark.parametrize("seed", [3, 7])
def test_a_rim_agrees_with_its_image_in_a_mirror_and_with_an_earlier_start(seed):
    rows = rim_rows(seed)
    assert rows[0]["touches"]
    assert [row["relation"] for row in rows if not row["found"] <= row["allowed"]] == []
