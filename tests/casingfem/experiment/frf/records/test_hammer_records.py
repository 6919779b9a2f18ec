"""Hammer records: exact responses within the noise, windows and their damping, hits that are left out and why."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.frf.records.held_estimate import numbers_of_estimate

FS, BLOCK, DELAY = 2048.0, 4096, 0.05
RIG = cf.rig.Rig.of(
    omega=2.0 * np.pi * np.array([61.0, 147.3, 290.2]),
    zeta=[0.009, 0.006, 0.008],
    rows=[[1.0, 0.4, 0.7], [-0.4, 0.9, 0.5], [0.3, 0.3, -1.1]],
)
TAP = cf.rig.Impact(peak=40.0, width=3e-3, delay=DELAY)


def tapped(blocks=4, rig=RIG, block=BLOCK, quantity="accelerance", drive=0):
    """A long record with a tap every two seconds; probe 1 is the drive point, too."""
    test = cf.rig.record(
        rig, [TAP], drives=[drive], sensors=[0, 1, 2], fs=FS, block=block, blocks=blocks, seed=3, quantity=quantity
    )
    return test.take()


def with_values(take, *, force=None, response=None):
    """The take with other numbers."""
    return replace(
        take,
        force=take.force if force is None else replace(take.force, responses=force),
        response=take.response if response is None else replace(take.response, responses=response),
    )


def cut(take, start, samples, name="hit"):
    """A part of a take as a record of its own."""
    part = slice(start, start + samples)
    own = {"x": take.response.x[:samples]}
    return cf.frf.Take(
        force=replace(take.force, responses=take.force.responses[:, part], **own),
        response=replace(take.response, responses=take.response.responses[:, part], **own),
        name=name,
    )


def off(frfs, rig=RIG, quantity="accelerance"):
    """Largest distance from the exact responses, of the channel's largest response."""
    exact = rig.frfs(frfs.x, sensors=[0, 1, 2], drives=[0], quantity=quantity).responses
    return np.abs(frfs.responses - exact).max(axis=1) / np.abs(exact).max(axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("quantity", ["receptance", "accelerance"])
def test_a_long_record_is_cut_at_its_hits_and_gives_the_exact_responses(quantity, held):
    found = cf.frf.estimate(tapped(quantity=quantity), band=(20.0, 400.0))
    assert [hit.fault for hit in found.kept] == [""] * 4
    assert np.diff([hit.time for hit in found.hits]) == pytest.approx(2.0)
    assert found.hits[0].peak == pytest.approx(40.0, rel=0.07)  # between two samples
    assert found.frfs.unit == cf.rig.Rig.frfs(RIG, [50.0], sensors=[0], drives=[0], quantity=quantity).unit
    assert off(found.frfs, quantity=quantity).max() < 2e-3
    assert found.coherence.responses.real.min() > 1.0 - 1e-3  # at antiresonances
    assert found.left < 0.01
    held(1e-6, **numbers_of_estimate(found))


@pytest.mark.slow
def test_noise_on_the_responses_leaves_h1_exact_and_noise_on_the_force_h2(held):
    """|H1| falls by the noise of the force, |H2| rises by that of the responses, Hv lies between them."""
    take, rng = tapped(blocks=60), np.random.default_rng(5)
    response = take.response.responses + 3.0 * rng.standard_normal(take.response.responses.shape)
    noisy = with_values(take, response=response)
    found = {name: cf.frf.estimate(noisy, estimator=name, band=(20.0, 400.0)) for name in ("H1", "H2", "Hv")}
    first, second, both = (np.abs(each.frfs.responses) for each in found.values())
    np.testing.assert_allclose(first / second, found["H1"].coherence.responses.real, rtol=1e-9)
    np.testing.assert_allclose(both**2, first * second, rtol=1e-9)
    clean = cf.frf.estimate(take, band=(20.0, 400.0)).frfs.responses
    coherence = found["H1"].coherence.responses.real
    scatter = first * np.sqrt((1.0 - coherence) / (coherence * 60))  # Bendat & Piersol, 9.2
    error = np.abs(found["H1"].frfs.responses - clean)
    assert np.mean((error / scatter) ** 2) == pytest.approx(1.0, abs=0.1)
    assert np.mean(second / np.abs(clean)) > 1.01
    columns = {}
    for name, each in found.items():
        columns |= {f"{name} {key}": column for key, column in numbers_of_estimate(each).items()}
    held(1e-6, **columns)


@pytest.mark.slow
@pytest.mark.parametrize("tau", [0.1, 0.5])
def test_identify_takes_the_damping_of_an_exponential_window_off(tau, tmp_path, held):
    """The window adds 4.3 % to the first mode's 0.2 % at 0.1 s; what is left is right to one per cent."""
    rig = replace(RIG, zeta=np.array([2e-3, 1e-3, 8e-4]))
    take = cut(tapped(blocks=1, rig=rig), 0, BLOCK)
    found = cf.frf.estimate(take, exponential=tau, band=(20.0, 400.0))
    assert found.left > 0.05
    held(1e-6, **numbers_of_estimate(found))
    modes = cf.identify(found.frfs)
    np.testing.assert_allclose(modes.freq, rig.freq, rtol=1e-5)
    np.testing.assert_allclose(modes.zeta, rig.zeta, rtol=0.01)
    assert any("exponential window" in note for note in modes.notes)


def test_responses_of_windowed_records_are_those_at_a_shifted_frequency():
    """H(i omega + 1/tau): poles move by -1/tau, residues stay."""
    tau = 0.4
    found = cf.frf.estimate(tapped(blocks=1), exponential=tau, band=(20.0, 400.0)).frfs
    s = 2j * np.pi * found.x + 1.0 / tau
    terms = 1.0 / (RIG.omega[:, None] ** 2 + 2.0 * (RIG.zeta * RIG.omega)[:, None] * s + s**2)
    exact = s**2 * ((RIG.rows * RIG.rows[0]) @ terms)
    assert (np.abs(found.responses - exact).max(axis=1) < 2e-3 * np.abs(exact).max(axis=1)).all()
    assert "exponential_window_s: 0.4" in found.card


def test_a_record_that_ends_while_it_rings_states_how_much_is_left(held):
    rig = replace(RIG, zeta=np.full(3, 1e-3), rows=RIG.rows * [1.0, 0.0, 0.0])
    take = tapped(blocks=1, rig=rig, quantity="receptance")
    found = cf.frf.estimate(take)
    seconds = BLOCK / FS - DELAY
    left = np.exp(-1e-3 * rig.omega[0] * seconds)
    assert found.left == pytest.approx(left, rel=0.05)
    assert f"the response has decayed only to {100 * found.left:.0f} %" in found.notes[1]
    longer = cf.frf.estimate(take, exponential=0.4)
    assert not any("has decayed only" in note for note in longer.notes)
    held(1e-6, **numbers_of_estimate(found))


def second_pulse(take, delay, share):
    shift = round(delay * FS)
    force, response = take.force.responses, take.response.responses

    def later(values):
        return share * np.pad(values, ((0, 0), (shift, 0)))[:, : values.shape[1]]

    return with_values(take, force=force + later(force), response=response + later(response))


@pytest.mark.slow
def test_double_hits_are_left_out_with_their_size_and_delay(held):
    whole = tapped()
    hits = [cut(whole, k * BLOCK, BLOCK, f"hit {k + 1}") for k in range(4)]
    hits[2] = second_pulse(hits[2], 0.03, 0.3)
    found = cf.frf.estimate(hits, band=(20.0, 400.0))
    assert [bool(hit.fault) for hit in found.hits] == [False, False, True, False]
    assert "double hit: a second pulse of 30 % comes 29.8 ms after the first" in found.hits[2].fault
    assert found.averages == 3
    assert off(found.frfs).max() < 2e-3
    held(1e-6, **numbers_of_estimate(found))
    far = cf.frf.estimate([hits[0], second_pulse(hits[1], 1.0, 0.5)])  # a record of its own has one hit
    assert [hit.fault.partition(":")[0] for hit in far.hits] == ["", "double hit"]
    long = second_pulse(cut(whole, 0, 2 * BLOCK), 0.03, 0.3)
    with pytest.raises(cf.errors.InputError, match=r"hit 1: double hit.*hit 2: double hit"):
        cf.frf.estimate(long)


def test_a_take_has_even_times_forces_and_responses_at_one_clock():
    take = tapped(blocks=1)
    x = take.response.x
    for given, words in (
        ({"force": replace(take.force, x=x + 0.5 / FS)}, "forces and responses at the same instants"),
        ({"response": cut(take, 0, 100).response}, f"found 100 samples of the responses, {len(x)} of the forces"),
        ({part: replace(getattr(take, part), x=x**1.001) for part in ("force", "response")}, "expected even steps"),
        ({"force": RIG.frfs(x[1:], sensors=[0], drives=[0])}, "found a set of kind 'frf'; expected time records"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            replace(take, **given)
    assert len(cut(take, 0, 16)) == 16
    with pytest.raises(cf.errors.InputError, match="found 15 samples; expected 16 or more"):
        cut(take, 0, 15)


def test_a_hammer_has_one_force_and_there_is_a_take():
    take = tapped(blocks=1)
    two = np.repeat(take.force.responses, 2, axis=0)
    force = cf.frf.FrfSet.from_arrays(kind="time", x=take.force.x, responses=two, unit="N", response_point=[1, 2])
    with pytest.raises(cf.errors.InputError, match="found 2 forces at once; expected one force channel of a hammer"):
        cf.frf.estimate(replace(take, force=force), test="hammer")
    with pytest.raises(cf.errors.InputError, match="takes: found none; expected one take or more"):
        cf.frf.estimate([])


@pytest.mark.parametrize(
    ("start", "words"),
    [(round(DELAY * FS) + 4, "the record begins after the start of the pulse"), (-BLOCK, "second half of the record"),
     (300, "no hit: the largest force is 0 N")],
)  # fmt: skip
def test_wrong_triggers_are_named(start, words, held):
    take = tapped(blocks=1)
    if start < 0:
        shifted = [np.pad(part.responses, ((0, 0), (2500, 0)))[:, :BLOCK] for part in (take.force, take.response)]
        bad = with_values(take, force=shifted[0], response=shifted[1])
    else:
        bad = cut(take, start, BLOCK - start)
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.estimate(bad, test="hammer")
    good = cf.frf.estimate([cut(take, 0, BLOCK - max(start, 0)), bad], test="hammer", band=(20.0, 400.0))
    assert words in good.hits[1].fault
    assert good.averages == 1
    held(1e-6, **numbers_of_estimate(good))


@pytest.mark.slow
def test_clipped_channels_have_no_part_in_the_averages(held):
    whole = tapped()
    hits = [cut(whole, k * BLOCK, BLOCK, f"hit {k + 1}") for k in range(4)]
    response = np.array(hits[1].response.responses)
    limit = 0.6 * np.abs(response[2]).max()
    response[2] = np.clip(response[2], -limit, limit)
    hits[1] = with_values(hits[1], response=response)
    hits[3] = with_values(hits[3], force=np.minimum(hits[3].force.responses, 20.0))
    found = cf.frf.estimate(hits, band=(20.0, 400.0))
    assert "the force is clipped at 20 N" in found.hits[3].fault
    assert "response channel 3 (point 3) is clipped in 1 of 3 hits" in "\n".join(found.notes)
    assert off(found.frfs).max() < 2e-3
    held(1e-6, **numbers_of_estimate(found))


@pytest.mark.slow
def test_peaks_of_a_coarse_converter_are_not_clipped():
    """Of 40 steps: the highest step is reached several times in a row, now and then."""
    hits = [cut(tapped(), k * BLOCK, BLOCK) for k in range(3)]
    step = np.abs(hits[0].response.responses).max() / 40.0
    coarse = [with_values(hit, response=step * np.round(np.array(hit.response.responses) / step)) for hit in hits]
    found = cf.frf.estimate(coarse, band=(20.0, 400.0))
    assert [hit.fault for hit in found.hits] == [""] * 3
    assert "clipped" not in "\n".join(found.notes)


@pytest.mark.slow
def test_a_channel_that_is_turned_over_shows_at_the_drive_point(held):
    take = tapped()
    turned = with_values(take, response=take.response.responses * [[-1.0], [1.0], [1.0]])
    assert not any("wrong sign" in note for note in cf.frf.estimate(take).notes)
    words = "channel 1: the mobility at the drive point 1 is negative"
    assert any(words in note for note in cf.frf.estimate(turned).notes)
    pulled = with_values(take, force=-take.force.responses)
    assert any("pulses of the force are negative" in note for note in cf.frf.estimate(pulled).notes)
    held(1e-6, **numbers_of_estimate(cf.frf.estimate(pulled, band=(30.0, 300.0))))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("response", "force", "noted"),
    [((1, 1), (1, 1), False), ((1, -1), (1, 1), True), ((1, 1), (1, -1), True), ((1, -1), (1, -1), False),
     ((1, 2), (1, 1), False), ((1, -2), (1, 1), False), ((2, -1), (1, 1), False)],
)  # fmt: skip
def test_the_sign_at_the_drive_point_is_that_of_both_directions(response, force, noted):
    """Point and direction of the first channel and of the hammer; the responses are those of one direction at both."""
    take = tapped(blocks=1)
    points, directions = take.response.response_point.copy(), take.response.response_direction.copy()
    points[:], directions[:], points[0], directions[0] = 9, 1, *response
    at = {"response_point": np.array([force[0]]), "response_direction": np.array([force[1]])}
    given = replace(
        take, force=replace(take.force, **at),
        response=replace(take.response, response_point=points, response_direction=directions),
    )  # fmt: skip
    assert any("channel 1: the mobility at the drive" in note for note in cf.frf.estimate(given).notes) == noted


@pytest.mark.slow
def test_a_roving_hammer_has_its_hit_points_as_sensors(held):
    hits = [replace(cut(tapped(drive=k), 0, BLOCK, f"point {k + 1}")) for k in range(3)]
    one = [
        cf.frf.Take(
            force=hit.force, name=hit.name,
            response=replace(hit.response, responses=hit.response.responses[:1], response_point=np.array([1]),
                             response_direction=np.array([0]), reference_point=np.array([0]),
                             reference_direction=np.array([0])),
        )
        for hit in hits
    ]  # fmt: skip
    found = cf.frf.estimate(one, band=(20.0, 400.0))
    assert (found.frfs.response_point.tolist(), found.frfs.reference_point.tolist()) == ([1, 2, 3], [1, 1, 1])
    assert off(found.frfs).max() < 2e-3  # H_rs = H_sr
    assert any("reciprocity" in note for note in found.notes)
    held(1e-6, **numbers_of_estimate(found))


def test_takes_that_do_not_belong_together_are_refused():
    take = tapped(blocks=1)
    fast = replace(
        take, response=replace(take.response, x=take.response.x / 2.0), force=replace(take.force, x=take.force.x / 2.0)
    )
    with pytest.raises(
        cf.errors.InputError, match="4096 samples a second, the rig's record has 2048; expected one rate"
    ):
        cf.frf.estimate([take, fast])
    for options, words in (
        ({"test": "drop"}, "test: found 'drop'"),
        ({"exponential": 0.0}, "exponential: found 0.0"),
        ({"estimator": "H4"}, "estimator: found 'H4'"),
        ({"band": (400.0, 20.0)}, "band: found 400 to 20 Hz"),
        ({"test": "shaker", "exponential": 0.5}, "it is for hammer tests"),
        ({"seconds": 1e-9}, "seconds: found 1e-09 s"),
        ({"exponential": 1e-9}, "exponential: found 1e-09 s"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.frf.estimate(take, **options)


@pytest.mark.slow
def test_a_shaker_s_record_is_taken_for_one(held):
    force = cf.rig.Random(rms=2.0, band=(20.0, 700.0))
    test = cf.rig.record(RIG, [force], drives=[0], sensors=[0, 1, 2], fs=FS, block=BLOCK, blocks=40, seed=3)
    found = cf.frf.estimate(test.take(), seconds=4.0, band=(40.0, 400.0))
    assert not found.hits
    assert found.averages == 39
    exact = RIG.frfs(found.frfs.x, sensors=[0, 1, 2], drives=[0]).responses
    assert np.median(np.abs(found.frfs.responses - exact) / np.abs(exact)) < 0.02
    assert found.records()[0]["median_coherence"] > 0.99
    held(1e-6, **numbers_of_estimate(found))


def test_forces_that_are_none_or_one_signal_and_responses_without_a_signal_are_refused():
    take = tapped(blocks=1)
    silent = with_values(take, force=np.full((1, BLOCK), 3.0))
    with pytest.raises(cf.errors.InputError, match="a force at point 1 that does not change: 3 N"):
        cf.frf.estimate(silent)
    noise = np.random.default_rng(2).standard_normal(BLOCK)
    twice = replace(
        take.force, responses=np.array([noise, 2.0 * noise]),
        **{name: np.array([1, 2]) for name in ("response_point", "response_direction", "reference_point",
                                               "reference_direction")},
    )  # fmt: skip
    with pytest.raises(cf.errors.InputError, match="2 linearly dependent forces"):
        cf.frf.estimate(replace(take, force=twice))
    flat = with_values(take, force=np.array([noise]), response=np.zeros((3, BLOCK)))
    for kind, force in (("shaker", flat.force), ("hammer", take.force)):
        with pytest.raises(cf.errors.InputError, match=r"no channel with a signal; expected a response"):
            cf.frf.estimate(replace(flat, force=force), test=kind)


def test_the_window_does_not_grow_before_the_pulse(held):
    """A short window on a record with a long pre-trigger: the noise before the hit is not raised."""
    take = tapped(blocks=1)
    rng = np.random.default_rng(4)
    response = take.response.responses + 0.05 * rng.standard_normal(take.response.responses.shape)
    late = [np.pad(part, ((0, 0), (1500, 0)))[:, :BLOCK] for part in (take.force.responses, response)]
    late[1][:, :1500] = 0.05 * rng.standard_normal((3, 1500))
    found = cf.frf.estimate(with_values(take, force=late[0], response=late[1]), exponential=0.05, band=(20.0, 400.0))
    assert found.shown.response_window.max() < 1.4
    held(1e-6, **numbers_of_estimate(found))
    clean = cf.frf.estimate(take, exponential=0.05, band=(20.0, 400.0)).frfs.responses
    assert np.abs(found.frfs.responses - clean).max() < 0.05 * np.abs(clean).max()
