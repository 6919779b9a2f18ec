"""Forces, filters and spectra of the rig on small arrays: ramps, pulses, differences, superposition, averages."""

import numpy as np
import pytest

import casingfem as cf

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


def test_a_pulse_is_a_raised_cosine_a_hundredth_of_a_second_late_if_nothing_is_stated():
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


def test_a_chain_states_what_it_does_and_nothing_if_it_does_nothing():
    clean = recorded()
    same = cf.rig.measured(clean, seed=1)
    assert same.card == clean.card
    assert np.array_equal(same.response, clean.response)
    said = [cf.rig.measured(clean, seed=1, bits=8, full_scale=scale).card[-1] for scale in (None, 2.5)]
    assert said == ["converter: 8 bits over +-1.25 x the largest value", "converter: 8 bits over +-2.5"]
    assert cf.rig.measured(clean, seed=7, snr_db=20.0).card[-1] == "noise: 20 dB below the rms of each response, seed 7"


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
