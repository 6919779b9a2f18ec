"""Convergence of the examples of NASA rotors, run small."""

import pandas as pd
import pytest

from reports.studies import rotors

MODES = {"rotor37": 24, "rotor67": 48}  # of the blade in the examples
STEP = 2.5e-6  # s, of the wear in the examples


@pytest.mark.campaign
def test_frequencies_and_impulses_of_both_rotors_converge(tmp_path):
    rotors.main(tmp_path, quick=True)
    for name, count in MODES.items():
        mesh, modes, step = (pd.read_csv(tmp_path / f"{name}_{table}.csv") for table in ("mesh", "modes", "step"))
        assert mesh["worst [%]"].is_monotonic_decreasing
        wheel = pd.read_csv(tmp_path / f"{name}_wheel.csv")
        assert 0.0 < wheel["worst of the wheel [%]"][0] < 5.0
        of_modes = modes.set_index("modes")["from the last [%]"].abs()
        assert of_modes[count] < 0.5 < 1.0 < of_modes[8]
        of_steps = step.set_index("step [s]")["from the last [%]"].abs()
        assert of_steps.is_monotonic_decreasing
        assert of_steps[STEP] < 0.1
        assert of_steps[5e-6] < 1.0
        # second order gives 5, as the last step is a quarter of STEP
        assert of_steps[STEP] / of_steps[0.5 * STEP] == pytest.approx(5.0, rel=0.2)
