"""Tests unlike a bench's: peaks shifted from channel to channel, modes that one cannot be sure of."""

import numpy as np
import pytest

import casingfem as cf

X = np.arange(645.0, 685.0, 0.1)
THETA = np.linspace(0.0, np.pi, 12, endpoint=False)
COS, SIN = 0.8 * np.cos(2 * THETA - 0.3), 0.6 * np.sin(2 * THETA - 0.3)


def mode(freq, zeta, shape, shift=0.0):
    """Accelerance of one mode, each channel's frequency shifted by a factor of its own."""
    own = freq * (1.0 + shift * np.ones(len(shape)))[:, None]
    return -shape[:, None] * X**2 / (own**2 - X**2 + 2j * zeta * own * X)


def measured(H, snr_db, seed):
    rng = np.random.default_rng(seed)
    size = 10 ** (-snr_db / 20) * np.sqrt(np.mean(np.abs(H) ** 2, axis=1, keepdims=True) / 2)
    H = H + size * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    return cf.frf.FrfSet.from_arrays(kind="frf", x=X, responses=H, unit="(m/s^2)/N", response_point=range(len(H)))


@pytest.mark.parametrize(
    "bandwidths", [pytest.param(0.1, marks=pytest.mark.slow), 0.5, pytest.param(2.0, marks=pytest.mark.slow)]
)
def test_one_mode_whose_peak_is_shifted_between_channels_is_one(bandwidths):
    rng = np.random.default_rng(31)
    shift = 0.002 * bandwidths * rng.uniform(-1, 1, 12)
    phases = np.exp(0.1j * rng.standard_normal(12))
    found = cf.identify(measured(mode(665.0, 1e-3, COS * phases, shift), 40.0, 5))
    assert len(found) == 1
    assert found.notes[0].startswith("peaks lie at different frequencies")
    assert found.zeta[0] == pytest.approx(1e-3, rel=0.02)  # not broadened
    assert abs(found.freq[0] - 665.0 * (1 + shift.mean())) < 4 * found.sigma_freq[0]
    said = float(found.notes[0].split("differ by ")[1].split(" %")[0])
    assert said == pytest.approx(100.0 * shift.std(ddof=1), rel=0.05)


@pytest.mark.slow
def test_a_pair_with_shifts_is_a_pair_and_a_pair_without_knows_of_none():
    shift = 2e-4 * np.random.default_rng(101).uniform(-1, 1, 12)
    for by, noted, seed in ((shift, True, 101), (0.0, False, 6)):
        H = mode(665.0, 1e-3, COS, by) + mode(665.7, 1e-3, SIN, by)
        found = cf.identify(measured(H, 40.0, seed))
        assert len(found) == 2
        assert any(note.startswith("peaks lie at") for note in found.notes) == noted
        np.testing.assert_allclose(found.zeta, 1e-3, rtol=0.02)


@pytest.mark.slow
def test_a_well_damped_mode_beside_narrow_shifted_ones_is_kept():
    shift = 8e-4 * np.random.default_rng(33).uniform(-1, 1, (3, 12))
    H = sum(
        mode(f, z, shape, by)
        for f, z, shape, by in zip((650.0, 657.0, 675.0), (4e-4, 5e-4, 6e-3), (COS, SIN, COS), shift, strict=True)
    )
    found = cf.identify(measured(H, 45.0, 8))
    assert found.freq[found.sure].round().tolist() == [650.0, 657.0, 675.0]
    np.testing.assert_allclose(found.zeta[found.sure], [4e-4, 5e-4, 6e-3], rtol=0.05)


@pytest.mark.slow
def test_a_clear_mode_is_sure_and_a_faint_local_one_is_not(tmp_path):
    local = np.zeros(12)
    local[4] = 0.05
    found = cf.identify(measured(mode(660.0, 1e-3, COS) + mode(672.0, 4e-3, local), 35.0, 7))
    assert found.freq.round().tolist() == [660.0, 672.0]
    assert found.sure.tolist() == [True, False]
    assert "seen by 1 of 12 channels" in found.doubts[1]
    assert [row["verdict"] for row in found.records()] == ["sure", "doubtful"]
    assert "mode 2 is doubtful: " in repr(found)
    assert any(line.startswith("mode 2 is doubtful") for line in found.table().card)
    assert cf.Identified.load(found.save(tmp_path / "found.npz")).doubts == found.doubts


@pytest.mark.slow
def test_a_file_of_before_has_no_doubts(tmp_path):
    found = cf.identify(measured(mode(660.0, 1e-3, COS), 35.0, 7))
    with np.load(found.save(tmp_path / "found.npz")) as archive:
        np.savez(tmp_path / "old.npz", **{name: archive[name] for name in archive.files if name != "doubts"})
    assert cf.Identified.load(tmp_path / "old.npz").sure.tolist() == [True]
    with np.load(tmp_path / "found.npz") as archive:
        np.savez(tmp_path / "bad.npz", **{**archive, "doubts": np.array(["a", "b"])})
    with pytest.raises(cf.errors.InputError, match="2 doubts"):
        cf.Identified.load(tmp_path / "bad.npz")


@pytest.mark.slow
def test_a_peak_narrower_than_the_lines_is_found_and_its_damping_doubted():
    found = cf.identify(measured(mode(665.0, 6e-5, COS), 60.0, 3))
    assert found.freq.round(2).tolist() == [665.0]
    assert "lines" in found.doubts[0]


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "rising"), [pytest.param(4, 0.0, marks=pytest.mark.campaign), (2, 0.007)])
def test_a_roving_mass_makes_no_modes_though_channels_agree_and_noise_rises_on_the_peaks(seed, rising):
    """Every channel is a set-up of its own; some agree in three modes of five, and are none."""
    own, drift = -8e-4 * (COS / 0.8) ** 2, 5e-5 * np.random.default_rng(seed).standard_normal(12)
    shapes = (COS, own), (SIN, -8e-4 - own), *[(np.ones(12), 0.0 * own)] * 3
    at = 652.0, 653.2, 661.0, 669.0, 677.0
    H = sum(mode(f, 1e-3, shape, by + drift) for f, (shape, by) in zip(at, shapes, strict=True))
    rng = np.random.default_rng(seed + 1)
    H = H * (1.0 + rising * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)))
    found = cf.identify(measured(H, 45.0, 9))
    assert found.sure.tolist() == [True] * 5
    mean = [f * (1.0 + np.mean(by + drift)) for f, (_, by) in zip(at, shapes, strict=True)]
    np.testing.assert_allclose(found.freq, mean, rtol=1e-4)


@pytest.mark.slow
def test_a_peak_between_two_lines_is_a_mode_known_to_a_line_and_a_wrong_line_is_none():
    """Noise that rises with the peak leaves nothing that tells its damping; hum is one line, without skirts."""
    H, rng = mode(660.03, 5e-6, np.ones(1)), np.random.default_rng(5)
    H = H * (1.0 + 0.3 * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)))
    H[0, np.searchsorted(X, 675.0)] *= 12.0
    found = cf.identify(cf.frf.FrfSet.from_arrays(kind="frf", x=X, responses=H, unit="(m/s^2)/N", response_point=[1]))
    assert len(found) == 1
    assert abs(found.freq[0] - 660.03) < 3.0 * found.sigma_freq[0] < 0.15
    assert found.doubts[0].startswith("damping: narrower than the lines")
    assert found.zeta[0] + 2.0 * found.sigma_zeta[0] == pytest.approx(0.1 / 660.0, rel=0.5)  # a line's width


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_a_peak_that_bends_with_its_amplitude_is_one_mode_in_one_channel(seed):
    """The frequency falls by a tenth of the bandwidth where the response is largest: no pole fits that."""
    H, zeta = np.zeros(len(X), complex), 1e-3
    for _ in range(60):
        own = 660.0 * (1.0 - 0.2 * zeta * np.abs(2.0 * zeta * H) ** 2)
        H = -(X**2) / (own**2 - X**2 + 2j * zeta * own * X)
    rng = np.random.default_rng(seed)
    H = H + 0.3 * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    found = cf.identify(
        cf.frf.FrfSet.from_arrays(kind="frf", x=X, responses=H[None], unit="(m/s^2)/N", response_point=[1])
    )
    assert len(found) == 1
    assert abs(found.freq[0] - 660.0) < 0.2


@pytest.mark.slow
def test_damped_peaks_are_seen_over_their_bandwidth_below_a_response_that_explodes_at_low_frequencies():
    """Receptances integrated from accelerations, as of a machine tool: 3 % of damping, 1e5 times the peaks at 1 Hz."""
    rng = np.random.default_rng(61)
    x = np.arange(1.0, 2801.0, 4.0)
    shapes, at = rng.standard_normal((4, 2)), ((1100.0, 0.03), (2000.0, 0.02))
    H = sum(s[:, None] / (f**2 - x**2 + 2j * z * f * x) for s, (f, z) in zip(shapes.T, at, strict=True))
    drift = rng.standard_normal((4, 1)) * 1e5 * np.abs(H).max() / x**4
    noise = 1e-3 * np.abs(H).max() * rng.standard_normal((2, *H.shape))
    frfs = cf.frf.FrfSet.from_arrays(
        kind="frf", x=x, responses=H + drift + noise[0] + 1j * noise[1], unit="m/N", response_point=range(4)
    )
    found = cf.identify(frfs)
    best = [int(np.abs(found.freq - f).argmin()) for f, _ in at]
    assert found.sure[best].all()
    np.testing.assert_allclose(found.freq[best], [f for f, _ in at], rtol=2e-3)
    np.testing.assert_allclose(found.zeta[best], [z for _, z in at], rtol=0.05)
    assert not any("Hann" in note for note in found.notes)
    assert found.shift == 0.0
