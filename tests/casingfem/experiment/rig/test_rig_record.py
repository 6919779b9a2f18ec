"""Time records of the virtual test rig: exact steps, agreement with the frequency domain, estimates, leakage."""

import numpy as np
import pytest

import casingfem as cf

SEED = 8123
FS = 2048.0
RIG = cf.rig.Rig.of(
    omega=2.0 * np.pi * np.array([151.3, 153.0, 402.7]),
    zeta=[0.004, 0.006, 0.01],
    rows=[[1.0, 0.2, 0.7], [-0.4, 0.9, 0.5], [0.3, 0.3, -1.1]],
    S=1e-7 * np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 2.0]]),
)


@pytest.mark.slow
@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
@pytest.mark.parametrize(
    "excitation", [cf.rig.BurstRandom(rms=1.0, band=(60.0, 700.0), part=0.25), cf.rig.Impact(peak=10.0, width=4e-3)]
)
def test_records_that_die_out_give_the_analytic_responses(quantity, excitation):
    test = cf.rig.record(RIG, [excitation], drives=[0], sensors=[0, 1, 2], fs=FS, block=8192, blocks=4, seed=SEED,
                  quantity=quantity)  # fmt: skip
    high = 700.0 if isinstance(excitation, cf.rig.BurstRandom) else 420.0
    found = cf.rig.estimate(test, window="rectangular", overlap=0.0, band=(80.0, high))
    exact = RIG.frfs(found.frfs.x, sensors=[0, 1, 2], drives=[0], quantity=quantity)
    scale = np.abs(exact.responses).max(axis=1, keepdims=True)
    assert np.max(np.abs(found.frfs.responses - exact.responses) / scale) < 2e-3
    assert np.abs(found.coherence.responses.real - 1.0).max() < 1e-3


@pytest.mark.slow
def test_two_shakers_at_once_are_distinguished():
    forces = [cf.rig.BurstRandom(rms=1.0, band=(60.0, 700.0), part=0.25)] * 2
    test = cf.rig.record(RIG, forces, drives=[0, 2], sensors=[1], fs=FS, block=8192, blocks=6, seed=SEED)
    found = cf.rig.estimate(test, window="rectangular", overlap=0.0, band=(80.0, 600.0)).frfs
    exact = RIG.frfs(found.x, sensors=[1], drives=[0, 2])
    assert found.reference_point.tolist() == [1, 3]
    for channel in (0, 1):
        scale = np.abs(exact.responses[channel]).max()
        assert np.abs(found.responses[channel] - exact.responses[channel]).max() < 5e-3 * scale


def test_one_estimator_over_the_other_is_the_coherence():
    """|G_xf|^2/(G_ff G_xx) with one drive; the averages are the blocks that fit, half of each shared."""
    test = cf.rig.measured(
        cf.rig.record(
            RIG,
            [cf.rig.Random(rms=1.0, band=(20.0, 780.0))],
            drives=[0],
            sensors=[1, 2],
            fs=FS,
            block=1024,
            blocks=6,
            seed=SEED,
        ),
        snr_db=10.0,
        seed=SEED,
    )
    first, second = (cf.rig.estimate(test, estimator=which, band=(60.0, 700.0)) for which in ("H1", "H2"))
    assert first.averages == second.averages == 11
    assert first.frfs.x[[0, -1]].tolist() == [60.0, 700.0]
    np.testing.assert_allclose(first.frfs.responses / second.frfs.responses, first.coherence.responses, rtol=1e-9)
    assert first.coherence.responses.real.min() < 0.9


def test_a_channel_without_signal_passes_its_converter():
    rig = cf.rig.Rig.of(omega=[900.0], zeta=[0.01], rows=[[1.0], [0.0]])
    test = cf.rig.record(
        rig, [cf.rig.Impact(peak=10.0, width=8e-3)], drives=[0], sensors=[0, 1], fs=FS, block=128, blocks=1, seed=SEED
    )
    seen = cf.rig.measured(test, seed=SEED, bits=12).response
    assert np.abs(seen[1]).max() == 0.0 < np.abs(seen[0]).max()


@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
def test_what_is_left_out_answers_as_a_spring(quantity):
    """S f, S f', S f'' of a pulse whose derivatives are known, at a probe that no mode of the rig reaches."""
    rig = cf.rig.Rig.of(omega=[900.0], zeta=[0.01], rows=[[1.0], [0.0]], S=[[2e-7, 5e-7], [5e-7, 3e-7]])
    width, delay = 8e-3, 0.01
    test = cf.rig.record(
        rig,
        [cf.rig.Impact(peak=10.0, width=width, delay=delay)],
        drives=[0],
        sensors=[1],
        fs=FS,
        block=128,
        blocks=1,
        seed=SEED,
        quantity=quantity,
    )
    w, inside = 2.0 * np.pi / width, (test.time > delay) & (test.time < delay + width)
    turn = w * (test.time - delay)
    exact = {"receptance": 1.0 - np.cos(turn), "mobility": w * np.sin(turn), "accelerance": w**2 * np.cos(turn)}
    seen = test.response[0] / (5e-7 * 5.0)
    order = ("receptance", "mobility", "accelerance").index(quantity)
    away = np.abs(np.abs(turn - np.pi) - np.pi) > (0.0, 0.3, 2.0)[order]  # the band ends where corners would be
    off = np.abs(seen - np.where(inside, exact[quantity], 0.0))[away]
    assert off.max() < (4e-3, 1e-2, 5e-2)[order] * w**order


def test_noise_of_a_record_has_its_size_and_leaves_the_forces_alone():
    clean = cf.rig.record(
        RIG,
        [cf.rig.Random(rms=2.0, band=(60.0, 700.0))],
        drives=[0],
        sensors=[0, 1],
        fs=FS,
        block=4096,
        blocks=8,
        seed=SEED,
    )
    assert np.std(clean.force) == pytest.approx(2.0, rel=0.01)
    dirty = cf.rig.measured(clean, seed=SEED, snr_db=14.0)
    assert np.array_equal(dirty.force, clean.force)
    ratio = np.std(dirty.response - clean.response, axis=1) / np.std(clean.response, axis=1)
    np.testing.assert_allclose(20.0 * np.log10(ratio), -14.0, atol=0.1)
    clipped = cf.rig.measured(clean, seed=SEED, bits=12, full_scale=1.0)
    assert clipped.force.min() == -1.0
    assert clipped.force.max() == 1.0 - 2.0**-11
    own = cf.rig.measured(clean, seed=SEED, bits=12)
    for now, before in ((own.force[0], clean.force[0]), (own.response[1], clean.response[1])):
        lsb = 2.5 * np.abs(before).max() / 2**12
        assert np.abs(now - before).max() <= 0.5 * lsb * (1.0 + 1e-9)


def test_forces_are_what_their_names_state():
    time, rng = np.arange(4000) / 4000.0, np.random.default_rng(SEED)
    pulse = cf.rig.Impact(peak=8.0, width=0.05, delay=0.03).force(time, 0.25, rng).reshape(4, 1000)
    np.testing.assert_allclose(pulse[1:], pulse[:1].repeat(3, axis=0), atol=1e-9)  # one in every block
    assert time[pulse[0].argmax()] == pytest.approx(0.03 + 0.025, abs=1e-12)
    assert pulse[0].max() == pytest.approx(8.0, rel=1e-12)
    assert pulse[0].sum() / 4000.0 == pytest.approx(8.0 * 0.05 / 2.0, rel=1e-9)  # peak width/2
    noise = cf.rig.Random(rms=3.0, band=(200.0, 500.0)).force(time, 0.25, rng)
    lines = np.abs(np.fft.rfft(noise)) > 1e-6
    assert np.sqrt(np.mean(noise**2)) == pytest.approx(3.0, rel=1e-12)
    assert np.flatnonzero(lines)[[0, -1]].tolist() == [200, 500]
    burst = cf.rig.BurstRandom(rms=1.0, band=(200.0, 500.0), part=0.4).force(time, 0.25, rng).reshape(4, 1000)
    assert np.abs(burst[:, 400:]).max() == 0.0
    assert np.abs(burst[:, :400]).max(axis=1).min() > 1.0
    sine = cf.rig.StepSine(amplitude=2.0, freq=(40.0, 60.0)).force(time, 0.5, rng)
    np.testing.assert_allclose(sine[100:2000], 2.0 * np.sin(2.0 * np.pi * 40.0 * time[100:2000]), atol=1e-9)
    np.testing.assert_allclose(sine[2000:], 2.0 * np.sin(2.0 * np.pi * 60.0 * (time[2000:] - 0.5)), atol=1e-9)


@pytest.mark.slow
def test_leakage_of_a_windowed_random_record_falls_with_its_length():
    errors = []
    for block in (2048, 8192):
        test = cf.rig.record(
            RIG,
            [cf.rig.Random(rms=1.0, band=(20.0, 780.0))],
            drives=[0],
            sensors=[0],
            fs=FS,
            block=block,
            blocks=40,
            seed=SEED,
        )
        found = cf.rig.estimate(test, band=(140.0, 165.0)).frfs
        exact = RIG.frfs(found.x, sensors=[0], drives=[0])
        errors.append(np.abs(found.responses - exact.responses).max() / np.abs(exact.responses).max())
    assert errors[1] < 0.35 * errors[0]  # the bias goes with the square of the resolution


@pytest.mark.slow
def test_coherence_shows_the_noise():
    clean = cf.rig.record(
        RIG,
        [cf.rig.BurstRandom(rms=1.0, band=(60.0, 700.0), part=0.25)],
        drives=[0],
        sensors=[0, 1],
        fs=FS,
        block=4096,
        blocks=60,
        seed=SEED,
    )
    dirty = cf.rig.measured(clean, snr_db=6.0, seed=SEED)
    found = cf.rig.estimate(dirty, window="rectangular", overlap=0.0, band=(100.0, 600.0))
    noise = np.mean(np.abs(np.fft.rfft((dirty.response - clean.response)[0].reshape(-1, 4096))) ** 2, axis=0)
    signal = np.mean(np.abs(np.fft.rfft(clean.response[0].reshape(-1, 4096))) ** 2, axis=0)
    lines = np.isin(np.fft.rfftfreq(4096, 1.0 / FS), found.frfs.x)
    expected = (signal / (signal + noise))[lines]
    assert np.abs(found.coherence.responses[0].real - expected).mean() < 0.05
    assert expected.min() < 0.7


@pytest.mark.slow
def test_converters_and_noise_leave_their_mark_and_seeds_decide():
    clean = cf.rig.record(
        RIG,
        [cf.rig.Random(rms=1.0, band=(60.0, 700.0))],
        drives=[0],
        sensors=[0],
        fs=FS,
        block=4096,
        blocks=8,
        seed=SEED,
    )
    again = cf.rig.record(
        RIG,
        [cf.rig.Random(rms=1.0, band=(60.0, 700.0))],
        drives=[0],
        sensors=[0],
        fs=FS,
        block=4096,
        blocks=8,
        seed=SEED,
    )
    assert np.array_equal(clean.response, again.response)
    coarse = cf.rig.measured(clean, seed=SEED, bits=10)
    lsb = 2.5 * np.abs(clean.response).max() / 2**10
    assert np.var(coarse.response - clean.response) == pytest.approx(lsb**2 / 12.0, rel=0.05)
    assert "10 bits" in coarse.card[-1]
    assert clean.card[0].startswith("SYNTHETIC")


def test_stepped_sine_settles_on_the_phasor():
    freq = (152.0, 400.0)
    test = cf.rig.record(
        RIG,
        [cf.rig.StepSine(amplitude=2.0, freq=freq)],
        drives=[0],
        sensors=[1],
        fs=FS,
        block=8192,
        blocks=2,
        seed=SEED,
        quantity="mobility",
    )
    exact = RIG.frfs(freq, sensors=[1], drives=[0], quantity="mobility").responses[0]
    for k, f in enumerate(freq):
        part = slice((k + 1) * 8192 - 2048, (k + 1) * 8192)
        turn = np.exp(-2j * np.pi * f * test.time[part])
        assert (test.response[0, part] @ turn) / (test.force[0, part] @ turn) == pytest.approx(exact[k], rel=5e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"fs": 500.0}, "expected 2.56 times the highest"),
        ({"excitations": []}, "one for each of 1 drives"),
        ({"block": 4}, "16 samples or more"),
        ({"drives": [7]}, "each from 0 to 2"),
        ({"excitations": [cf.rig.Random(rms=1.0, band=(700.01, 700.02))]}, "no line of a record"),
    ],
)
def test_what_cannot_be_recorded_is_refused(change, words):
    asked = {"excitations": [cf.rig.Random(rms=1.0, band=(60.0, 700.0))], "drives": [0], "sensors": [0], "fs": FS,
             "block": 256, "blocks": 1, "seed": SEED} | change  # fmt: skip
    with pytest.raises(cf.errors.InputError, match=words):
        cf.rig.record(RIG, asked.pop("excitations"), **asked)


def test_what_cannot_be_estimated_is_refused():
    test = cf.rig.record(
        RIG,
        [cf.rig.Random(rms=1.0, band=(60.0, 700.0))] * 2,
        drives=[0, 1],
        sensors=[0],
        fs=FS,
        block=256,
        blocks=1,
        seed=SEED,
    )
    for keys, words in (
        ({"window": "flat"}, "window: found 'flat'"),
        ({"estimator": "H3"}, "estimator: found 'H3'"),
        ({"estimator": "H2"}, "H2 with 2 drives"),
        ({"overlap": 1.0}, "overlap"),
        ({}, "1 averages"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.rig.estimate(test, **keys)
    with pytest.raises(cf.errors.InputError, match="width"):
        cf.rig.Impact(peak=1.0, width=0.0)
    with pytest.raises(cf.errors.InputError, match="peak"):
        cf.rig.Impact(peak=-1.0, width=1e-3)
    with pytest.raises(cf.errors.InputError, match="freq"):
        cf.rig.StepSine(amplitude=1.0, freq=())
    with pytest.raises(cf.errors.InputError, match="part"):
        cf.rig.BurstRandom(rms=1.0, band=(1.0, 2.0), part=1.0)
    with pytest.raises(cf.errors.InputError, match="band"):
        cf.rig.Random(rms=1.0, band=(3.0, 2.0))
