"""Blades of published geometry beside another program on the same mesh, run small."""

import pytest

from reports.verification.modes import nasa_rotors


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")  # coarse on purpose
def test_frequencies_of_rotors_37_and_67_are_those_of_calculix_at_rest_and_at_speed(tmp_path):
    rows = nasa_rotors.main(tmp_path, quick=True)
    assert len(rows) == 24
    assert all(row["verdict"] == "pass" for row in rows)
