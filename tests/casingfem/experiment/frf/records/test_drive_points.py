"""A drive point gives no energy back: the sign of its mobility, for each unit and pair of directions."""

import numpy as np
import pytest

import casingfem as cf

FS, SAMPLES = 512.0, 1024
X = np.fft.rfftfreq(SAMPLES, 1.0 / FS)
POWER = {"m/N": 0, "m/s/N": 1, "m/s^2/N": 2}
MODE = 1.0 / (100.0**2 - X**2 + 2j * 0.01 * 100.0 * X)  # receptance


def notes(H, unit="m/N", force_unit="N", point=7, direction=3, reference=-3, at=7):
    """Notes of a shaker test of one block, whose first channel is at another place than the force."""
    force = np.random.default_rng(1).standard_normal(SAMPLES)
    responses = [force, np.fft.irfft(H * np.fft.rfft(force))]
    kept = {"kind": "time", "x": np.arange(SAMPLES) / FS}
    response = cf.frf.FrfSet.from_arrays(
        **kept, responses=responses, unit=unit.removesuffix("/N"), response_point=[1, point],
        response_direction=[1, direction],
    )  # fmt: skip
    pushed = cf.frf.FrfSet.from_arrays(
        **kept, responses=[force], unit=force_unit, response_point=[at], response_direction=[reference]
    )
    take = cf.frf.Take(response=response, force=pushed)
    found = cf.frf.estimate(take, test="shaker", seconds=SAMPLES / FS, window="rectangular", overlap=0.0)
    np.testing.assert_allclose(found.frfs.responses[1], H[(X > 0.0) & (X <= FS / 2.56)], atol=1e-9 * np.abs(H).max())
    return found.notes


def drive(unit="m/N", sign=1.0):
    """A mode at its drive point, or between two points, as displacement, velocity or acceleration."""
    return sign * (2j * np.pi * X) ** POWER[unit] * MODE


@pytest.mark.parametrize("unit", POWER)
@pytest.mark.parametrize(
    ("changes", "sign", "wrong"),
    [
        ({"reference": 3}, 1.0, False), ({"reference": 3}, -1.0, True),
        ({}, 1.0, True), ({}, -1.0, False),  # against the force
        ({"direction": -3}, 1.0, False), ({"direction": -3}, -1.0, True),
        ({"reference": 3, "at": 8}, -1.0, False),  # another point
        ({"reference": 2}, -1.0, False), ({"reference": -2}, 1.0, False),  # another direction
    ],
)  # fmt: skip
def test_a_negative_mobility_at_a_drive_point_is_noted(unit, changes, sign, wrong):
    found = notes(drive(unit, sign), unit, **changes)
    assert [note.partition(":")[0] for note in found] == (["channel 2"] if wrong else [])
    assert all("the mobility at the drive point 7 is negative" in note for note in found)


@pytest.mark.parametrize(("part", "wrong"), [(0.745, False), (0.755, True)])
def test_noise_of_either_sign_does_not_show_a_wrong_sign(part, wrong):
    """On a share of the lines the mobility is negative."""
    H = np.ones(X.size)
    lines = np.flatnonzero((X > 0.0) & (X <= FS / 2.56))
    H[lines[: int(part * lines.size)]] = -1.0
    assert any("wrong sign" in note for note in notes(H, "m/s/N", reference=3)) is wrong


def test_missing_units_are_noted():
    assert notes(drive(), force_unit="", reference=3) == (
        "the force has no unit, so N is assumed: give the unit in the file, as `force 1 x [N]`, or by --channels",
    )
    without = "the responses have no unit: give it with --channels, or give their kind with --form of identify"
    assert notes(-drive(), unit="", reference=3) == notes(drive(), unit="", force_unit="", reference=3) == (without,)
