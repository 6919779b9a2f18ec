"""Forces, filters and spectra of the rig on small arrays: ramps, pulses, differences, superposition, averages."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.frf.records.averages import block_spectra, cross
from casingfem.experiment.rig.estimate import estimate
from casingfem.experiment.rig.excitation import band_noise, bump
from casingfem.experiment.rig.record import FINER, Record, decimated, differences, measured, prefiltered, respond
from casingfem.experiment.rig.rig import noise

SEED = 6120
OMEGA, ZETA = np.array([300.0, 420.0, 950.0]), np.array([0.01, 0.03, 0.005])
ROWS = np.array([[1.0, 0.2, 0.7], [-0.4, 0.9, 0.5], [0.3, 0.3, -1.1]])
S = 1e-6 * np.array([[4.0, 1.0, 0.3], [1.0, 3.0, 0.5], [0.3, 0.5, 2.0]])
RIG = cf.rig.Rig.of(
    omega=OMEGA,
    zeta=ZETA,
    rows=ROWS,
    S=S,
    probes=[
        cf.rig.Probe(4, 1, (0.0, 0.0, 0.0), 0.0),
        cf.rig.Probe(6, -2, (0.0, 0.0, 0.0), 0.0),
        cf.rig.Probe(9, 3, (0.0, 0.0, 0.0), 0.0),
    ],
)


def rng():
    return np.random.default_rng(SEED)


def test_a_bump_rises_and_falls_as_a_cosine_over_a_twentieth():
    phase = np.array([-0.1, 0.0, 0.0125, 0.025, 0.05, 0.5, 0.95, 0.975, 1.0, 1.1])
    quarter = 0.5 - 0.5 * np.sqrt(0.5)
    np.testing.assert_allclose(bump(phase), [0.0, 0.0, quarter, 0.5, 1.0, 1.0, 1.0, 0.5, 0.0, 0.0], atol=1e-12)


def test_noise_of_a_band_has_its_lines_both_ends_and_no_mean():
    values = band_noise(400, 0.01, (0.0, 10.0), rng())
    spectrum = np.fft.rfft(values)
    assert np.flatnonzero(np.abs(spectrum) > 1e-9).tolist() == list(range(1, 41))
    assert np.mean(values**2) == pytest.approx(1.0, rel=1e-12)
    edges = np.fft.rfft(band_noise(400, 0.01, (5.0, 10.0), rng()))
    assert np.flatnonzero(np.abs(edges) > 1e-9).tolist() == list(range(20, 41))
    many = np.fft.rfft(band_noise(40_000, 0.01, (5.0, 45.0), rng()))[2000:18001]
    assert abs(np.mean(many**2)) < 0.03 * np.mean(np.abs(many) ** 2)  # real and imaginary parts independent


def test_a_burst_ramps_within_its_part_of_the_block_half_if_nothing_is_said():
    time = np.arange(4000) / 1000.0
    whole = cf.rig.Random(rms=2.0, band=(50.0, 200.0)).force(time, 2.0, rng())
    for part, more in ((0.5, {}), (0.3, {"part": 0.3})):
        burst = cf.rig.BurstRandom(rms=2.0, band=(50.0, 200.0), **more).force(time, 2.0, rng())
        np.testing.assert_allclose(burst, whole * bump((time % 2.0) / 2.0 / part), atol=1e-12)
    assert cf.rig.BurstRandom(rms=1.0, band=(50.0, 200.0)).highest == 200.0


def test_a_pulse_is_a_raised_cosine_a_hundredth_of_a_second_late_if_nothing_is_said():
    time = np.array([0.0, 0.009, 0.0105, 0.011, 0.012, 0.014, 0.0141, 0.511, 0.512])
    force = cf.rig.Impact(peak=8.0, width=0.004).force(time, 0.5, rng())
    np.testing.assert_allclose(force, [0.0, 0.0, 4.0 - np.sqrt(8.0), 4.0, 8.0, 0.0, 0.0, 4.0, 8.0], atol=1e-9)
    early = cf.rig.Impact(peak=8.0, width=0.004, delay=0.0)
    np.testing.assert_allclose(early.force(np.array([0.0, 0.001]), 0.5, rng()), [0.0, 4.0], atol=1e-9)
    assert early.highest == 500.0


def test_a_stepped_sine_rises_within_a_twentieth_of_its_first_block_and_goes_on_in_the_last():
    time = np.arange(300) / 100.0
    force = cf.rig.StepSine(amplitude=3.0, freq=(7.0, 3.0)).force(time, 1.0, rng())
    turns = np.where(time < 1.0, 7.0 * time, 7.0 + 3.0 * (time - 1.0))
    rise = np.where(time < 0.05, 0.5 - 0.5 * np.cos(np.pi * np.minimum(time / 0.05, 1.0)), 1.0)
    np.testing.assert_allclose(force, 3.0 * np.sin(2.0 * np.pi * turns) * rise, atol=1e-9)
    assert cf.rig.StepSine(amplitude=3.0, freq=(7.0, 9.0, 3.0)).highest == 9.0


@pytest.mark.parametrize("make", [
    lambda v: cf.rig.Random(rms=v, band=(1.0, 2.0)), lambda v: cf.rig.BurstRandom(rms=v, band=(1.0, 2.0)),
    lambda v: cf.rig.Impact(peak=v, width=1.0), lambda v: cf.rig.Impact(peak=1.0, width=v),
    lambda v: cf.rig.StepSine(amplitude=v, freq=(1.0,)),
])  # fmt: skip
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_sizes_of_forces_are_finite_and_above_0(make, value):
    with pytest.raises(cf.errors.InputError, match=f"found {value!r}, expected a number above 0"):
        make(value)


def test_derivatives_of_sampled_forces():
    force = np.array([[1.0, 4.0, 9.0, 25.0]])
    assert differences(force, 10.0, 0).tolist() == force.tolist()
    np.testing.assert_allclose(differences(force, 10.0, 1), [[30.0, 40.0, 105.0, 160.0]])
    np.testing.assert_allclose(differences(force, 10.0, 2), [[200.0, 200.0, 1100.0, -4100.0]])
    exact = [1.0 - 3.0 / 12, 4.0 - 2.0 / 12, 9.0 - 11.0 / 12, 25.0 + 16.0 / 12]
    np.testing.assert_allclose(prefiltered(force), [exact], rtol=1e-14)


def test_what_is_kept_is_every_eighth_sample_of_a_slow_motion():
    slow = np.cos(2.0 * np.pi * np.arange(1600) / 160.0 + 0.3)
    kept = decimated(slow)
    assert kept.shape == (200,)
    np.testing.assert_allclose(kept[20:-20], slow[::FINER][20:-20], atol=2e-3)


@pytest.mark.parametrize(("quantity", "order"), [("receptance", 0), ("mobility", 1), ("accelerance", 2)])
def test_responses_are_the_sum_of_modes_and_what_they_leave_out(quantity, order):
    force = rng().normal(size=(2, 40))
    exact = S[np.ix_([1, 0], [2, 0])] @ differences(force, 500.0, order)
    for k in range(3):
        one = cf.rig.Rig.of(omega=OMEGA[k : k + 1], zeta=ZETA[k], rows=[[1.0]])
        exact = exact + np.outer(
            ROWS[[1, 0], k], respond(one, (ROWS[[2, 0], k] @ force)[None], 500.0, [0], [0], quantity)[0]
        )
    np.testing.assert_allclose(
        respond(RIG, force, 500.0, [2, 0], [1, 0], quantity), exact, rtol=1e-9, atol=1e-12 * np.abs(exact).max()
    )


def recorded(**changes):
    asked = {"drives": [2, 0], "sensors": [1], "fs": 512.0, "block": 16, "blocks": 2, "seed": SEED} | changes
    return cf.rig.record(RIG, [cf.rig.Random(rms=1.0, band=(30.0, 200.0))] * len(asked["drives"]), **asked)


@pytest.mark.parametrize(("quantity", "unit"), [("receptance", "m"), ("mobility", "m/s"), ("accelerance", "m/s^2")])
def test_a_record_s_channels_have_their_places_units_and_instants(quantity, unit):
    test = recorded(quantity=quantity, card=["rig 3"])
    response, force = test.functions()
    assert (response.kind, response.unit, force.kind, force.unit) == ("time", unit, "time", "N")
    assert (response.response_point.tolist(), response.response_direction.tolist()) == ([6], [-2])
    assert (force.response_point.tolist(), force.response_direction.tolist()) == ([9, 4], [3, 1])
    np.testing.assert_array_equal(response.x, np.arange(32) / 512.0)
    np.testing.assert_array_equal(response.responses, test.response)
    np.testing.assert_array_equal(force.responses, test.force)
    assert response.card == force.card == test.card
    assert (test.card[0][:9], test.card[1], test.card[-1][-9:]) == ("SYNTHETIC", "rig 3", f"seed {SEED}")
    assert not np.allclose(test.force[0], test.force[1])


def test_a_record_has_a_block_of_16_samples_and_reaches_its_highest_frequency():
    assert recorded(fs=2.56 * 200.0).force.shape == (2, 32)
    assert recorded(blocks=1, block=32).force.shape == (2, 32)
    for change, words in (
        ({"fs": 511.9}, "fs: found 511.9 Hz, expected 2.56 times the highest frequency of the force, 200 Hz"),
        ({"block": 15}, "block 15, blocks 2: expected 16 samples or more, one block or more"),
        ({"blocks": 0}, "block 16, blocks 0: expected 16 samples"),
        ({"sensors": [3]}, r"probes \[3\]: expected at least one, each from 0 to 2"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            recorded(**change)


def test_a_chain_says_what_it_does_and_nothing_if_it_does_nothing():
    clean = recorded()
    same = measured(clean, seed=1)
    assert same.card == clean.card
    assert np.array_equal(same.response, clean.response)
    said = [measured(clean, seed=1, bits=8, full_scale=scale).card[-1] for scale in (None, 2.5)]
    assert said == ["converter: 8 bits over +-1.25 x the largest value", "converter: 8 bits over +-2.5"]
    assert measured(clean, seed=7, snr_db=20.0).card[-1] == "noise: 20 dB below the rms of each response, seed 7"


def test_a_converter_rounds_to_its_steps_and_ends_one_below_full_scale():
    adc = cf.rig.Converter(bits=4, full_scale=4.0)
    assert adc.lsb == 0.5
    assert adc.convert(np.array([0.24, 0.26, -0.26, 3.6, 9.0, -3.9, -9.0])).tolist() == [
        0.0,
        0.5,
        -0.5,
        3.5,
        3.5,
        -4.0,
        -4.0,
    ]


@pytest.mark.parametrize("is_complex", [False, True])
def test_noise_has_the_rms_of_its_own_row_and_independent_parts(is_complex):
    values = np.array([[3.0], [0.5]]) * np.exp(0.3j * np.arange(20_000) * is_complex)
    values = values if is_complex else values.real
    added = noise(values, 20.0, rng())
    assert np.iscomplexobj(added) == is_complex
    np.testing.assert_allclose(np.sqrt(np.mean(np.abs(added) ** 2, axis=1)), [0.3, 0.05], rtol=0.03)
    assert abs(np.mean(added[0] * added[1])) < 0.03 * 0.3 * 0.05
    if is_complex:
        assert abs(np.mean(added[0] ** 2)) < 0.03 * 0.3**2


def made(force, response, block):
    """A record of arrays given by hand."""
    return Record(fs=8.0, block=block, force=np.asarray(force), response=np.asarray(response), quantity="mobility",
                  rig=RIG, drives=tuple(range(len(force))), sensors=(0,), card=("SYNTHETIC",))  # fmt: skip


@pytest.mark.parametrize(("overlap", "starts"), [(0.0, [0, 8]), (0.5, [0, 4, 8]), (0.9, range(9)), (0.3, [0, 6])])
def test_blocks_begin_where_the_overlap_says(overlap, starts):
    values = rng().normal(size=(2, 16))
    hann = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(8) / 8)
    for window, shape in (("hann", hann), ("rectangular", np.ones(8))):
        exact = [[np.fft.rfft(row[k : k + 8] * shape) for k in starts] for row in values]
        np.testing.assert_allclose(block_spectra(values, 8, window, overlap), exact, atol=1e-12)


def test_cross_spectra_are_means_over_blocks():
    x, f = (rng().normal(size=(n, 3, 2)) + 1j * rng().normal(size=(n, 3, 2)) for n in (2, 4))
    exact = np.array(
        [[[np.mean(x[i, :, line] * f[j, :, line].conj()) for j in range(4)] for i in range(2)] for line in range(2)]
    )
    np.testing.assert_allclose(cross(x, f), exact, rtol=1e-12)


def test_an_estimate_is_least_squares_over_blocks_and_its_coherence_what_that_explains():
    values = rng().normal(size=(3, 40))
    test = made(values[:2], values[2:], 8)
    found = estimate(test, window="rectangular", overlap=0.0, band=(1.0, 3.0))
    blocks = np.fft.rfft(values.reshape(3, 5, 8), axis=2)
    assert found.averages == 5
    assert found.frfs.x.tolist() == [1.0, 2.0, 3.0]
    assert (found.frfs.unit, found.coherence.unit, found.coherence.kind) == ("(m/s)/N", "", "spectrum")
    assert found.frfs.reference_point.tolist() == [4, 6]
    assert found.coherence.reference_point.tolist() == [4]
    for k, line in enumerate((1, 2, 3)):
        f, x = blocks[:2, :, line].T, blocks[2, :, line]
        H, left = np.linalg.lstsq(f, x, rcond=None)[:2]
        np.testing.assert_allclose(found.frfs.responses[:, k], H, rtol=1e-9)
        assert found.coherence.responses[0, k].real == pytest.approx(1.0 - left[0] / np.sum(np.abs(x) ** 2), rel=1e-9)
    with pytest.raises(cf.errors.InputError, match="found 1 averages; expected 2, one for each force"):
        estimate(made(values[:2, :16], values[2:, :16], 16), window="rectangular", overlap=0.0, band=(0.5, 2.2))
    one = estimate(made(values[:1, :16], values[2:, :16], 16), window="rectangular", overlap=0.0)
    assert (one.averages, one.frfs.x.tolist()) == (1, [0.5 * k for k in range(1, 7)])  # up to fs/2.56


def test_the_second_estimator_divides_by_the_noise_of_the_force():
    values = rng().normal(size=(2, 40))
    test = made(values[:1], values[1:], 8)
    blocks = np.fft.rfft(values.reshape(2, 5, 8), axis=2)
    first, second = (
        estimate(test, window="rectangular", overlap=0.0, estimator=e).frfs.responses[0] for e in ("H1", "H2")
    )
    f, x = blocks[0, :, 1:4], blocks[1, :, 1:4]
    np.testing.assert_allclose(first, np.sum(x * f.conj(), axis=0) / np.sum(np.abs(f) ** 2, axis=0), rtol=1e-9)
    np.testing.assert_allclose(second, np.sum(np.abs(x) ** 2, axis=0) / np.sum(f * x.conj(), axis=0), rtol=1e-9)
