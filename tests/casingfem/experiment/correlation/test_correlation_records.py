"""What a pairing and a correlation say in plain numbers, counted from 1."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.expansion import Expansion
from casingfem.experiment.correlation.matches import listed, modes_of, unpaired_words
from casingfem.experiment.correlation.sensors import Sensors
from tests.casingfem.experiment.correlation.test_correlation_parts import match


def test_a_pairing_in_numbers():
    whole = cf.correlation.Pairing(
        matches=(
            match((2, 0), (4, 5), measured_hz=(100.0, 200.0), computed_hz=(101.0, 196.0)), match((1,), (0,), n=-1),
        ),
        unpaired_rows=(), unpaired_modes=(1,),
    )  # fmt: skip
    assert whole.rms == pytest.approx(np.sqrt((0.01**2 + 0.02**2 + 0.01**2) / 3.0), rel=1e-12)
    assert len(whole) == 2
    assert [(r["row"], r["mode"], r["n"]) for r in whole.records()] == [(3, 5, 4), (1, 6, 4), (2, 1, None)]
    assert whole.records()[1]["computed_hz"] == 196.0


def test_a_correlation_in_plain_numbers_counts_from_1():
    """Three shapes at two sensors, of which two are the modes 3 and 2."""
    measured = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=[10.0, 20.0, 30.0], values=[[1.0, 2.0j, 1.0], [1.0, 1.0, 2.0]], points=np.eye(3)[:2],
        directions=np.eye(3)[1:], labels=[5, 8],
    )  # fmt: skip
    sensors = Sensors(
        a=np.zeros(2), b=np.zeros(2), distance=np.array([0.25, 0.5]), directions=measured.directions,
        labels=measured.labels, nodes=np.zeros((2, 1), int), weights=np.ones((2, 1)),
    )  # fmt: skip
    expansion = Expansion(
        modes=np.array([0, 2]), coordinates=np.zeros((2, 3)), smoothed=np.zeros((2, 3)), condition=7.0,
        outside=np.zeros(3), left_out=np.array([[3.0, 1.0, np.nan], [4.0, 7.0, 2.0]]),
    )  # fmt: skip
    pairing = cf.correlation.Pairing(matches=(match((0, 2), (2, 1)),), unpaired_rows=(1,), unpaired_modes=(0, 3))
    found = cf.correlation.Correlation(
        modes=SimpleNamespace(freq=np.array([1.0, 2.0, 3.0, 4.0])), measured=measured, sensors=sensors, pairing=pairing,
        mac=np.arange(12.0).reshape(3, 4), alike=np.array([0.75]), nco=20.0 + np.arange(12.0).reshape(3, 4),
        mass_by="Guyan", comac=np.array([0.5, 0.25]), ecomac=np.array([0.125, 0.375]), expansion=expansion,
    )  # fmt: skip
    first, second, third = found.records()
    assert first == {
        "row": 1, "measured_hz": 10.0, "mode": 3, "n": 4, "computed_hz": 3.0, "mac": 2.0, "subspace_mac": 0.75,
        "nco": 22.0, "left_out_error": np.sqrt(12.5), "collinearity": 1.0,
    }  # fmt: skip
    assert second == {
        "row": 2, "measured_hz": 20.0, "mode": None, "n": None, "computed_hz": None, "mac": None, "subspace_mac": None,
        "nco": None, "left_out_error": 5.0, "collinearity": pytest.approx(0.8),
    }  # fmt: skip
    assert (third["row"], third["mode"], third["mac"], third["nco"], third["left_out_error"]) == (3, 2, 9.0, 29.0, 2.0)
    assert found.to_json() == {
        "shapes": [first, second, third], "unpaired_modes": [1, 4], "mass_by": "Guyan",
        "channels": [
            {"sensor": 5, "direction": [0.0, 1.0, 0.0], "distance_m": 0.25, "comac": 0.5, "ecomac": 0.125},
            {"sensor": 8, "direction": [0.0, 0.0, 1.0], "distance_m": 0.5, "comac": 0.25, "ecomac": 0.375},
        ],
        "expansion": {"modes": [1, 3], "condition": 7.0},
    }  # fmt: skip


def test_lists_end_after_twelve_names():
    assert listed(range(12)) == "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11"
    assert listed(range(14)) == "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 2 more"
    assert unpaired_words([]) == []
    assert unpaired_words([3, 5]) == ["no mode pairs with table modes 3, 5: they took no part"]
    table = cf.FrequencyTable.from_arrays(freq_hz=[1.0, 2.0, 3.0], sigma_hz=0.1, mode=[7, 8, 9])
    assert modes_of(table, [2, 0]) == (9, 7)
