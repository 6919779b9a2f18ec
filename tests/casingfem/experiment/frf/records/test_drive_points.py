"""A drive point gives no energy back: the sign of its mobility, for each unit and pair of directions."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.frf.records.lines import notes_of

X = np.linspace(80.0, 120.0, 200)
POWER = {"m/N": 0, "m/s/N": 1, "m/s^2/N": 2}


def drive(unit="m/N", sign=1.0, point=7, direction=3, reference=-3, at=7):
    """A mode at its drive point, or between two points, as displacement, velocity or acceleration."""
    receptance = 1.0 / (100.0**2 - X**2 + 2j * 0.01 * 100.0 * X)
    H = sign * (2j * np.pi * X) ** POWER[unit] * receptance
    return cf.frf.FrfSet.from_arrays(
        kind="frf", x=X, responses=[np.ones_like(H), H], unit=unit, response_point=[1, point], reference_point=[9, at],
        response_direction=[1, direction], reference_direction=[1, reference],
    )  # fmt: skip


@pytest.mark.parametrize("unit", POWER)
@pytest.mark.parametrize(
    ("changes", "wrong"),
    [
        ({"reference": 3}, False), ({"reference": 3, "sign": -1.0}, True),
        ({}, True), ({"sign": -1.0}, False),  # against the force
        ({"direction": -3}, False), ({"direction": -3, "sign": -1.0}, True),
        ({"reference": 3, "sign": -1.0, "at": 8}, False),  # another point
        ({"reference": 2, "sign": -1.0}, False), ({"reference": -2}, False),  # another direction
    ],
)  # fmt: skip
def test_a_negative_mobility_at_a_drive_point_is_noted(unit, changes, wrong):
    notes = list(notes_of(drive(unit, **changes), "N"))
    assert [note.partition(":")[0] for note in notes] == (["channel 2"] if wrong else [])
    assert all("the mobility at the drive point 7 is negative" in note for note in notes)


@pytest.mark.parametrize(("part", "wrong"), [(0.745, False), (0.755, True)])
def test_noise_of_either_sign_does_not_show_a_wrong_sign(part, wrong):
    """On a share of the lines the mobility is negative."""
    frfs = drive("m/s/N", reference=3)
    H = np.array(frfs.responses)
    H[1] = np.where(np.arange(X.size) < part * X.size, -1.0, 1.0)
    changed = cf.frf.FrfSet.from_arrays(
        kind="frf", x=X, responses=H, unit="m/s/N", response_point=[1, 7], reference_point=[9, 7],
        response_direction=[1, 3], reference_direction=[1, 3],
    )  # fmt: skip
    assert any("wrong sign" in note for note in notes_of(changed, "N")) is wrong


def test_missing_units_are_noted():
    assert list(notes_of(drive(reference=3), "")) == [
        "the force has no unit, so N is assumed: give the unit in the file, as `force 1 x [N]`, or by --channels"
    ]
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=X, responses=[-np.ones(200)], unit="", response_point=[1],
                                     reference_point=[1])  # fmt: skip
    assert list(notes_of(frfs, "N")) == [
        "the responses have no unit: give it with --channels, or give their kind with --form of identify"
    ]
    assert list(notes_of(frfs, "")) == list(notes_of(frfs, "N"))
