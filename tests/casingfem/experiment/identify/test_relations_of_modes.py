"""Relations that identified modes obey whatever the method: units, order of channels, turned angles."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.held_modes import numbers_of_modes
from tests.casingfem.experiment.identify.test_output_only import driven

THETA = np.radians([0, 31, 62, 88, 119, 152, 181, 212, 241, 271, 300, 329])
POINTS = np.arange(1, len(THETA) + 1)
LINES = np.arange(318.0, 358.0, 0.1)
PAIRS = [(5, 326.0, 0.5, 11.0), (3, 334.0, 3.0, 3.0), (4, 347.0, 1.5, 20.0)]  # n, Hz, split [Hz], angle [deg]


def responses(setups):
    """Accelerances at twelve sensors from two drives; sensors of a second set-up have frequencies 0.1 % higher."""
    drives, H = np.radians([17.0, 131.0]), np.zeros((len(THETA), 2, len(LINES)), complex)
    for n, middle, split, angle in PAIRS:
        for k, side in enumerate((-0.5, 0.5)):
            place = np.radians(angle) + k * np.pi / (2 * n)
            freq = (middle + side * split) * (1.0 + 1e-3 * (np.arange(len(THETA)) % setups))
            pole = freq[:, None] ** 2 - LINES**2 + 2j * 0.002 * freq[:, None] * LINES
            shapes = np.cos(n * (THETA - place))[:, None] * np.cos(n * (drives - place))
            H += shapes[:, :, None] * (-(LINES**2) / pole)[:, None]
    rng = np.random.default_rng(71)
    noise = rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)
    return H + 3e-3 * np.sqrt(np.mean(np.abs(H) ** 2)) * noise


def identified(H, x=LINES, points=POINTS, turned=0.0, directions=1):
    flat = H.reshape(-1, H.shape[-1])
    frfs = cf.frf.FrfSet.from_arrays(
        kind="frf", x=x, responses=flat, unit="m/s^2/N", response_point=np.repeat(points, 2),
        response_direction=directions, reference_point=np.tile([101, 102], len(points)), reference_direction=1,
    )  # fmt: skip
    return cf.identify(frfs, angles=dict(zip(POINTS.tolist(), (np.degrees(THETA) + turned).tolist(), strict=True)))


def turn(angle, n):
    """Difference of orientations, which repeat after half a wave."""
    quarter = 90.0 / np.maximum(n, 1)
    return (angle + quarter) % (2.0 * quarter) - quarter


@pytest.fixture(scope="module", params=[1, 2], ids=["one set-up", "two set-ups"])
def measured(request):
    H = responses(request.param)
    return H, identified(H)


@pytest.mark.slow
def test_the_six_modes_are_found_within_their_intervals(measured, held):
    _, plain = measured
    assert plain.n.tolist() == [5, 5, 3, 3, 4, 4]
    wanted = np.sort([middle + side * split for _, middle, split, _ in PAIRS for side in (-0.5, 0.5)])
    shift = plain.freq / wanted - 1.0
    assert np.all(np.abs(shift - shift.mean()) * wanted < 4.0 * plain.sigma_freq)
    assert np.all(np.abs(plain.zeta - 0.002) < 4.0 * plain.sigma_zeta)
    angles = [angle + k * 90.0 / n for n, _, _, angle in PAIRS for k in range(2)]
    assert np.all(np.abs(turn(plain.angle_deg - angles, plain.n)) < 4.0 * plain.sigma_angle)
    held(1e-4, **numbers_of_modes(plain))


@pytest.mark.slow
def test_units_of_force_and_time_order_of_sensors_and_their_zero_angle_change_no_mode(measured):
    """Frequencies scale with the unit of time and orientations turn with the sensors; nothing else changes."""
    H, plain = measured
    order = np.random.default_rng(2).permutation(len(THETA))
    found = identified(1e4 * H[order], x=LINES / 1024.0, points=POINTS[order], turned=40.0)
    assert found.n.tolist() == plain.n.tolist()
    assert (found.doublets, found.unresolved, found.reasons) == (plain.doublets, plain.unresolved, plain.reasons)
    np.testing.assert_allclose(1024.0 * found.freq, plain.freq, rtol=1e-8)
    np.testing.assert_allclose(1024.0 * found.sigma_freq, plain.sigma_freq, rtol=1e-3)
    np.testing.assert_allclose(found.zeta, plain.zeta, rtol=1e-5)
    np.testing.assert_allclose(found.sigma_zeta, plain.sigma_zeta, rtol=1e-3)
    np.testing.assert_allclose(turn(found.angle_deg - plain.angle_deg - 40.0, plain.n), 0.0, atol=1e-3)
    np.testing.assert_allclose(found.sigma_angle, plain.sigma_angle, rtol=1e-3)
    np.testing.assert_allclose(found.purity, plain.purity, atol=1e-5)


@pytest.mark.slow
def test_sensors_that_face_the_other_way_state_it_by_a_negative_direction(measured):
    """Direction 0 is radial and has no sign."""
    H, plain = measured
    directions = np.array([-1, 0, 1] * 4)
    sign = np.where(directions < 0, -1.0, 1.0)
    found = identified(H * sign[:, None, None], directions=np.repeat(directions, 2))
    assert found.n.tolist() == plain.n.tolist()
    np.testing.assert_allclose(found.freq, plain.freq, rtol=1e-9)
    np.testing.assert_allclose(turn(found.angle_deg - plain.angle_deg, plain.n), 0.0, atol=1e-3)
    assert not any("wrong sign" in note for note in found.notes)


@pytest.mark.slow
def test_modes_of_responses_alone_scale_with_the_units_of_motion_and_time():
    y = driven(5, 25.0)

    def modes(y, fs):
        records = cf.frf.FrfSet.from_arrays(
            kind="time", x=np.arange(y.shape[1]) / fs, responses=y, unit="m/s^2",
            response_point=np.arange(1, len(y) + 1), response_direction=1,
        )  # fmt: skip
        return cf.identify(records, angles=dict(enumerate(np.degrees(np.arange(16) * np.pi / 8), start=1)))

    plain, found = modes(y, 640.0), modes(1e3 * y, 0.625)
    assert len(plain.freq) >= 5
    assert found.n.tolist() == plain.n.tolist()
    assert found.reasons == plain.reasons
    np.testing.assert_allclose(1024.0 * found.freq, plain.freq, rtol=1e-7)
    np.testing.assert_allclose(1024.0 * found.sigma_freq, plain.sigma_freq, rtol=1e-4)
    np.testing.assert_allclose(found.zeta, plain.zeta, rtol=1e-5)
    np.testing.assert_allclose(found.angle_deg, plain.angle_deg, atol=1e-3)
