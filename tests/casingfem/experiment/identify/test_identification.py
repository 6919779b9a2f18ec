"""Identification from responses whose modes are known."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.held_modes import numbers_of_modes

SEED = 1917


def ring_rig(pairs, *, theta, drives, zeta=0.002):
    """Rig with pairs (n, freq, relative split, angle [deg]) of pure shapes; probes at theta, then at the drives."""
    at = np.r_[theta, drives]
    modes = []
    for n, freq, split, angle in pairs:
        for k, side in enumerate((-0.5, 0.5) if n else (0.0,)):
            place = np.radians(angle) + k * np.pi / (2 * n) if n else 0.0
            modes.append((freq * (1 + side * split), np.cos(n * (at - place))))
    modes.sort(key=lambda mode: mode[0])
    probes = [cf.rig.Probe(k + 1, 1, (0.0, 0.0, 0.0), angle) for k, angle in enumerate(at)]
    freq, rows = zip(*modes, strict=True)
    return cf.rig.Rig.of(omega=2 * np.pi * np.array(freq), zeta=zeta, rows=np.array(rows).T, probes=probes)


def measured(rig, lines, sensors, drives, snr=40.0, seed=SEED):
    frfs = rig.frfs(lines, sensors=range(sensors), drives=range(sensors, sensors + drives))
    return cf.rig.noisy(frfs, snr, seed=seed) if snr else frfs


THETA = np.radians([0, 14, 31, 44, 62, 76, 88, 107, 119, 135, 152, 166, 181, 194, 212, 224, 241, 256, 271, 286])
ANGLES = {k + 1: float(np.degrees(angle)) for k, angle in enumerate(THETA)}


@pytest.mark.slow
@pytest.mark.parametrize("drives", [[0.3], [0.3, 2.0]])
def test_finds_every_member_of_split_pairs_and_nothing_else(drives, held):
    pairs = [(6, 330.0, 0.004, 11.0), (7, 345.0, 0.01, 3.0), (5, 352.0, 0.0025, 20.0)]
    rig = ring_rig(pairs, theta=THETA, drives=drives)
    found = cf.identify(measured(rig, np.arange(320.0, 362.0, 0.1), len(THETA), len(drives)), angles=ANGLES)
    assert found.n.tolist() == [6, 6, 7, 7, 5, 5]
    assert found.doublets == ((0, 1), (2, 3), (4, 5))
    assert np.abs(found.freq / rig.freq - 1).max() < 5e-5
    assert np.abs(found.zeta / 0.002 - 1).max() < 0.03
    want = np.array([11, 26, 3, 3 + 90 / 7, 20, 2])
    quarter = 90.0 / found.n
    error = (found.angle_deg - want + quarter) % (2 * quarter) - quarter
    assert np.abs(error).max() < 1.0
    assert np.all(np.abs(error) < 5 * found.sigma_angle)
    assert np.all(np.abs(found.freq - rig.freq) < 5 * found.sigma_freq)
    held(1e-4, **numbers_of_modes(found))


def mixed(near):
    """Modes of a ring with 16 even sensors, of 7, 9, 5 and 4 waves with a few per cent of others; 9 waves at `near`."""
    theta, waves = np.r_[np.arange(16) * np.pi / 8, 0.3], (7, 9, 5, 4)
    rows = [
        np.cos(n * (theta - 0.1) - k * np.pi / 2) + 0.02 * np.cos((n - 2) * theta - 1.3 * k)
        for n in waves
        for k in range(2)
    ]
    freq = np.outer([300.0, near, 400.0, 480.0], [1.0, 1.004]).ravel()
    probes = [cf.rig.Probe(k + 1, 1, (0.0, 0.0, 0.0), angle) for k, angle in enumerate(theta)]
    rig = cf.rig.Rig.of(omega=2 * np.pi * freq, zeta=np.full(8, 1e-3), rows=np.array(rows).T, probes=probes)
    return cf.identify(
        measured(rig, np.arange(280.0, 500.0, 0.2), 16, 1), angles=dict(enumerate(np.degrees(theta[:16]), start=1))
    )


@pytest.mark.slow
def test_a_near_pair_that_looks_alike_at_the_sensors_makes_an_orientation_uncertain(held):
    near, far = mixed(306.0), mixed(360.0)
    assert near.n[:4].tolist() == far.n[:4].tolist() == [7] * 4  # 9 waves look like 7 at 16 even sensors
    assert near.sigma_angle[0] > 3.0 * far.sigma_angle[0] > 0.05
    held(1e-4, **numbers_of_modes(near))


@pytest.mark.campaign
def test_intervals_of_frequency_and_damping_keep():
    """64 members of pairs .5 to 3 bandwidths apart: at 95 % fewer than 53 hold, of either, in 1 of 1000 runs.

    Nor may they be too wide: the rms of 64 deviations over sigma lies outside 1 +- .29 in 1 of 1000 runs.
    """
    rng, sigmas = np.random.default_rng(SEED), []
    for seed in range(8):
        splits, angles = 0.004 * rng.uniform(0.5, 3.0, 4), rng.uniform(0, 20, 4)
        pairs = list(zip((6, 7, 5, 8), 300.0 * 1.03 ** np.arange(4), splits, angles, strict=True))
        rig = ring_rig(pairs, theta=THETA, drives=rng.uniform(0, 2 * np.pi, 2))
        found = cf.identify(measured(rig, np.arange(292.0, 336.0, 0.125), len(THETA), 2, seed=seed), angles=ANGLES)
        assert len(found) == 8
        sigmas.append([(found.freq - rig.freq) / found.sigma_freq, (found.zeta - 0.002) / found.sigma_zeta])
    hold = np.sum(np.abs(sigmas) < 1.96, axis=(0, 2))
    assert np.all(hold >= 53)
    assert np.sqrt(np.mean(np.square(sigmas), axis=(0, 2))) == pytest.approx(np.ones(2), abs=0.29)


@pytest.mark.slow
def test_a_pair_half_a_bandwidth_apart_is_resolved_and_one_far_below_is_given_as_one(held):
    bandwidth = 2 * 0.002
    pairs = [(6, 330.0, 0.5 * bandwidth, 11.0), (5, 350.0, 0.002 * bandwidth, 4.0)]
    rig = ring_rig(pairs, theta=THETA, drives=[0.3, 2.0])
    found = cf.identify(measured(rig, np.arange(315.0, 365.0, 0.1), len(THETA), 2), angles=ANGLES)
    assert found.n.tolist() == [6, 6, 5]
    assert found.doublets == ((0, 1),)
    assert found.unresolved == (2,)
    assert 0.002 * bandwidth < found.split_bound[2] < 0.5 * bandwidth
    assert "pair at 350.0" in found.notes[0]
    assert np.isnan(found.split_bound[:2]).all()
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.slow
def test_a_single_mode_is_not_split():
    rig = ring_rig([(0, 340.0, 0.0, 0.0)], theta=THETA, drives=[0.3, 2.0])
    found = cf.identify(measured(rig, np.arange(320.0, 360.0, 0.1), len(THETA), 2, snr=25.0), angles=ANGLES)
    assert len(found) == 1
    assert found.n.tolist() == [0]
    assert not found.unresolved
    assert not found.notes


@pytest.mark.slow
def test_responses_without_noise_have_no_spurious_modes():
    rig = ring_rig([(6, 330.0, 0.004, 11.0), (4, 410.0, 0.02, 5.0)], theta=THETA, drives=[0.3])
    found = cf.identify(measured(rig, np.arange(300.0, 450.0, 0.1), len(THETA), 1, snr=None), angles=ANGLES)
    assert len(found) == 4
    assert np.abs(found.freq / rig.freq - 1).max() < 1e-6
    assert found.deviation < 1e-3


@pytest.mark.slow
def test_noise_alone_has_no_modes():
    rng = np.random.default_rng(SEED)
    H = rng.standard_normal((8, 900)) + 1j * rng.standard_normal((8, 900))
    x = 100 + 0.1 * np.arange(900)
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=range(8))
    found = cf.identify(frfs)
    assert len(found) == 0
    with pytest.raises(ValueError, match="no identified modes"):
        found.table()


@pytest.mark.slow
def test_the_table_has_sigma_and_states_synthetic():
    rig = ring_rig([(6, 330.0, 0.004, 11.0)], theta=THETA, drives=[0.3])
    found = cf.identify(measured(rig, np.arange(320.0, 340.0, 0.1), len(THETA), 1), angles=ANGLES)
    table = found.table()
    assert table.synthetic
    assert table.n.tolist() == [6, 6]
    np.testing.assert_array_equal(table.sigma_hz, found.sigma_freq)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("angles", "n", "told"),
    [
        (np.arange(9) * 40.0, 4, "n = 4 is the largest that 9 sensors resolve"),  # it is 5
        (np.radians(np.arange(9) * 40.0), -1, "no n is stated: the 9 sensors have 9 angles from 0 to 5.585 deg"),
        (np.zeros(9), -1, "no n is stated: the 9 sensors have 1 angles from 0 to 0 deg"),
    ],
)
def test_sensors_that_do_not_show_n_apart_state_so(angles, n, told):
    rig = ring_rig([(5, 330.0, 0.01, 11.0)], theta=np.radians(np.arange(9) * 40.0), drives=[0.3])
    found = cf.identify(measured(rig, np.arange(320.0, 340.0, 0.1), 9, 1), angles=dict(enumerate(angles, start=1)))
    assert found.n.tolist() == [n, n]
    assert found.notes[0].startswith(told)


def _frfs(**changes):
    values = {"kind": "frf", "x": 100 + 0.1 * np.arange(90), "responses": np.full((2, 90), 1 + 1j), "unit": "m/N"}
    values |= {"response_point": [1, 2]}
    return cf.frf.FrfSet.from_arrays(**(values | changes))


@pytest.mark.parametrize(
    ("frfs", "options", "words"),
    [
        (_frfs(kind="spectrum"), {}, "spectrum"),
        (_frfs(unit="furlong"), {}, "furlong"),
        (_frfs(), {"form": "inertance"}, "inertance"),
        (_frfs(), {"band": (100.0, 101.0)}, "lines in the band"),
        (_frfs(), {"band": (9.0, 1.0)}, "from < to"),
        (_frfs(x=np.geomspace(100, 200, 90)), {}, "even steps"),
        (_frfs(responses=np.zeros((2, 90))), {}, "zero on every line: channel 1, 2"),
        (_frfs(responses=np.ones((2, 90))), {}, "imaginary parts are all zero: magnitudes without phase"),
        (_frfs(response_point=[1, 1]), {}, "channels 1 and 2"),
        (_frfs(reference_point=[5, 6]), {}, "no channel from point 1 to reference 6"),
        (_frfs(), {"angles": {1: 0.0}}, "no angle for point 2"),
        (_frfs(), {"angles": {1: 0.0, 2: float("nan")}}, "no angle for point 2"),
    ],
)
def test_refuses_what_cannot_be_identified(frfs, options, words):
    with pytest.raises(cf.errors.InputError, match=words):
        cf.identify(frfs, **options)


@pytest.mark.slow
def test_responses_estimated_from_random_forces_of_two_shakers(held):
    """Noise on the peaks, alike on neighbouring lines: no spurious modes, and sigma knows."""
    pairs = [(6, 130.0, 0.012, 11.0), (7, 145.0, 0.02, 3.0), (5, 152.0, 0.008, 20.0)]
    rig = ring_rig(pairs, theta=THETA, drives=[0.3, 2.0], zeta=0.004)
    force = cf.rig.Random(rms=1.0, band=(90.0, 190.0))
    sensors, drives = range(len(THETA)), range(len(THETA), len(THETA) + 2)
    clean = cf.rig.record(
        rig, [force, force], drives=drives, sensors=sensors, fs=500.0, block=4096, blocks=16, seed=SEED
    )
    frfs = cf.rig.estimate(cf.rig.measured(clean, seed=SEED, snr_db=40.0, bits=16), band=(110.0, 175.0)).frfs
    found = cf.identify(frfs, angles=ANGLES)
    assert found.n.tolist() == [6, 6, 7, 7, 5, 5]
    errors = (found.freq - rig.freq) / found.sigma_freq
    assert np.abs(found.freq / rig.freq - 1).max() < 2e-4
    assert np.abs(errors).max() < 5.0
    white = fit_of_white_noise(found)
    assert np.median(found.sigma_freq / white) > 2.0
    held(1e-4, **numbers_of_modes(found))


def fit_of_white_noise(found):
    """Standard deviation [Hz] that white noise of the overall deviation would give a frequency, roughly.

    sigma(f)/(zeta f) = 2 sqrt(2/pi) (noise of a line over the peak, rms) sqrt(step/(channels zeta f)) for one mode.
    """
    width = found.zeta * found.freq
    step = found.lines[1] - found.lines[0]
    return width * 2 * np.sqrt(2 / np.pi) / found.signal * np.sqrt(step / (len(found.measured) * width))
