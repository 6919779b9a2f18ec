"""Convergence of the examples of NASA rotors, run small."""

import pytest

from reports.studies import rotors


@pytest.mark.campaign
def test_frequencies_and_impulses_of_rotor_37_converge(tmp_path):
    rows = rotors.main(tmp_path, quick=True)
    assert [row["worst [%]"] for row in rows if "worst [%]" in row] == sorted(
        (row["worst [%]"] for row in rows if "worst [%]" in row), reverse=True
    )
    steps = [abs(row["from the last [%]"]) for row in rows if "step [s]" in row]
    assert steps[1] < 0.1 < steps[0] < 2.0
