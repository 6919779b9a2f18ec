"""Records of known pulses and known decays: blocks, windows, lines and hits against transforms in plain NumPy."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

FS, BLOCK = 1024.0, 512
START, PULSE = 30, np.array([4.0, 9.0, 7.0, 3.0])
SHORT = np.exp(-0.05 * np.arange(400)) * np.cos(0.7 * np.arange(400))  # 2e-9 of it is left after a block


def take(force, responses, unit="m", name="hit"):
    t = np.arange(len(force)) / FS
    at = {"response_direction": 3, "response_point": 1}
    return cf.frf.Take(
        force=cf.frf.FrfSet.from_arrays(kind="time", x=t, responses=[force], unit="N", **at), name=name,
        response=cf.frf.FrfSet.from_arrays(
            kind="time", x=t, responses=responses, unit=unit, response_direction=3,
            response_point=1 + np.arange(len(responses)),
        ),
    )  # fmt: skip


def hits(places, samples=4 * BLOCK, ring=SHORT, pulse=PULSE):
    """A force of equal pulses at places, and one response of as many decays."""
    force, response = np.zeros(samples), np.zeros(samples)
    for place in places:
        force[place : place + len(pulse)] += pulse
    response += np.convolve(force, ring)[:samples]
    return force, response


def of_dft(force, responses):
    """Responses over forces by plain transforms, at the lines above 0 up to 1/2.56 of the rate."""
    f, x = np.fft.rfft(force), np.fft.rfft(responses)
    kept = slice(1, int(len(force) / 2.56) + 1)
    return (x / f)[..., kept]


def test_one_hit_is_one_block_and_gives_the_ratio_of_the_transforms():
    """Lines are kept up to and at a rate of 1/2.56; the pre-trigger's mean is subtracted from a response alone."""
    samples = 2 * 256
    force, response = hits([START], samples)
    found = cf.frf.estimate(take(force + 5.0, np.array([response, 2.0 * response]) - 3.0))
    assert found.frfs.x.tolist() == (np.arange(1, 201) * FS / samples).tolist()  # 400 = 1024/2.56
    np.testing.assert_allclose(found.frfs.responses[0], of_dft(force, response), rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(found.frfs.responses[1], 2.0 * found.frfs.responses[0], rtol=1e-12)
    (hit,) = found.hits
    assert (hit.time, hit.peak, hit.width, hit.fault) == (START / FS, 9.0, 4.0 / FS, "")
    assert found.averages == 1
    assert found.coherence is None
    assert found.records() == [
        {"hit": 1, "take": "hit", "time_s": START / FS, "peak_n": 9.0, "width_s": 4.0 / FS,
         "ringing_left": found.left, "used": True, "why": ""},
    ]  # fmt: skip


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_long_record_of_either_sign_has_a_block_from_each_pre_trigger_to_the_next(sign):
    """The pre-trigger is 2 % of the distance of the hits, and the record after the last hit is long enough."""
    places = [100, 100 + BLOCK, 100 + 2 * BLOCK]
    force, response = hits(places)
    found = cf.frf.estimate(take(sign * force, [response]))
    assert [hit.time for hit in found.hits] == [place / FS for place in places]
    assert [hit.peak for hit in found.hits] == [sign * 9.0] * 3
    assert (found.averages, found.kept) == (3, found.hits)
    assert found.frfs.x[0] == FS / BLOCK
    block = slice(100 - 10, 100 - 10 + BLOCK)
    np.testing.assert_allclose(found.frfs.responses[0], sign * of_dft(force[block], response[block]), rtol=1e-6)
    np.testing.assert_allclose(found.coherence.responses.real, 1.0, rtol=1e-9)


@pytest.mark.parametrize(("before", "lead"), [(None, 4), (20.0 / FS, 20)])
def test_length_and_pre_trigger_of_a_block_may_be_given(before, lead):
    force, response = hits([100, 700, 1300], ring=SHORT[:120])
    found = cf.frf.estimate(take(force, [response]), seconds=200.0 / FS, before=before)
    block = slice(100 - lead, 300 - lead)
    assert found.frfs.x[0] == FS / 200.0
    np.testing.assert_allclose(found.frfs.responses[0], of_dft(force[block], response[block]), rtol=1e-9)


def test_a_record_too_short_for_its_last_hit_leaves_it_out_and_states_both_times():
    force, response = hits([100, 700, 1300], 1450)
    found = cf.frf.estimate(take(force, [response]), seconds=200.0 / FS, before=20.0 / FS)
    assert [hit.fault for hit in found.hits] == [
        "", "", f"the record ends {150.0 / FS:.3g} s after the hit, expected at least {200.0 / FS:.3g} s",
    ]  # fmt: skip
    assert found.averages == 2
    shown = repr(found).splitlines()
    assert shown[0].endswith(", 2 averages, 2 of 3 hits)")
    assert shown[1] == f"hit 3 is not used: {found.hits[2].fault}"


def test_without_given_lengths_the_last_hit_shortens_all_blocks_to_half_at_most():
    """Hits every 512 samples: 300 after the last one are a block of 310 with its pre-trigger; 100 are left out."""
    force, response = hits([100, 612], 912, ring=SHORT[:200])
    found = cf.frf.estimate(take(force, [response]))
    assert (found.averages, found.frfs.x[0]) == (2, FS / 310.0)
    force, response = hits([100, 612], 712, ring=SHORT[:90])
    found = cf.frf.estimate(take(force, [response]))
    assert (found.averages, found.frfs.x[0]) == (1, FS / 256.0)
    assert found.hits[1].fault.startswith("the record ends")


def test_a_record_without_a_hit_states_its_largest_force_and_its_noise():
    noise = 0.1 * np.random.default_rng(3).standard_normal(BLOCK)
    largest, deviation = np.abs(noise - np.median(noise)).max(), np.median(np.abs(noise - np.median(noise)))
    words = f"no hit: the largest force is {largest:.3g} N, the noise {1.4826 * deviation:.2g} N"
    for seconds in (None, 0.1):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.frf.estimate(take(noise, [noise]), test="hammer", seconds=seconds)


def test_a_pulse_that_swings_through_zero_within_two_widths_is_one_pulse():
    """Two samples below the level between two of five and three samples; after eleven samples it is a double hit."""
    for quiet, fault in ((9, ""), (10, "double hit: a second pulse of 50 % comes")):
        force, response = hits([START], BLOCK, pulse=np.r_[[6.0] * 4, 8.0, np.zeros(quiet), [4.0, 3.0, 2.0]])
        one = cf.frf.estimate([take(*hits([START], BLOCK)[:1], [response]), take(force, [response])])
        assert one.hits[1].fault.startswith(fault)
        assert bool(one.hits[1].fault) == bool(fault)
        assert one.hits[1].width == (8.0 + quiet if not fault else 5.0) / FS


@pytest.mark.parametrize(("gap", "one"), [(3, True), (4, False)])
def test_a_pulse_of_one_sample_counts_as_two_samples_wide(gap, one):
    force, response = hits([START], BLOCK, pulse=np.r_[9.0, np.zeros(gap), 5.0])
    found = cf.frf.estimate([take(force, [response]), take(*hits([START], BLOCK)[:1], [response])], test="hammer")
    assert (found.hits[0].width, found.hits[0].fault[:10]) == (
        ((gap + 2.0) / FS, "") if one else (1.0 / FS, "double hit")
    )


@pytest.mark.parametrize(("apart", "hit_count"), [(127, 3), (128, 4)])
def test_a_pulse_within_a_quarter_of_the_usual_distance_is_a_second_one_of_its_hit(apart, hit_count):
    force, response = hits([100, 612, 1124, 1124 + apart], 1636)
    found = cf.frf.estimate([take(force, [response]), take(*hits([START], BLOCK)[:1], [hits([START], BLOCK)[1]])],
                            seconds=120.0 / FS, test="hammer")  # fmt: skip
    assert len(found.hits) == hit_count + 1


@pytest.mark.parametrize("start", [15, 16])
def test_a_pre_trigger_of_fewer_than_sixteen_samples_states_no_rest_value(start):
    force, response = hits([start], BLOCK)
    found = cf.frf.estimate(take(force, [response + 3.0]), test="hammer")
    given = response + (3.0 if start == 15 else 0.0)
    np.testing.assert_allclose(found.frfs.responses[0], of_dft(force, given), rtol=1e-9, atol=1e-8)
    assert found.left < (1.0 if start == 15 else 1e-6)


def test_a_hit_may_begin_at_any_sample_of_the_first_half():
    for start, word in ((0, "wrong trigger: the record begins"), (1, ""), (256, ""), (257, "wrong trigger: the hit")):
        force, response = hits([start], BLOCK)
        found = cf.frf.estimate([take(force, [response]), take(*hits([START], BLOCK)[:1], [response])], test="hammer")
        assert found.hits[0].fault.startswith(word)
        assert bool(found.hits[0].fault) == bool(word)


def test_hits_of_either_sign_in_equal_numbers_are_not_called_negative():
    force, response = hits([START], BLOCK)
    for signs, noted in (((1.0, -1.0), False), ((1.0, -1.0, -1.0), True)):
        found = cf.frf.estimate([take(sign * force, [sign * response]) for sign in signs], test="hammer")
        assert any("are negative" in note for note in found.notes) == noted


@pytest.mark.parametrize(
    ("top", "clipped"),
    [
        ([0, 0, 0], True),
        ([0, 0], False),
        ([0, 0, 7, 0], False),
        ([-51, -51, 0, 0, 0], True),
        ([0, 0, 0, 6, 0, 0], True),
    ],
)
def test_a_clipped_channel_stays_at_its_extreme_for_three_samples_beside_a_large_step(top, clipped):
    """Counts of a converter: `top` are counts below 1000, and every other value is far below."""
    counts = 400.0 * np.sin(0.3 * np.arange(BLOCK))
    counts = np.round(counts)
    counts[100 : 100 + len(top)] = 1000.0 - np.array(top)
    for sign in (1.0, -1.0):
        given = take(np.random.default_rng(8).standard_normal(BLOCK), [sign * np.minimum(counts, 1000.0)])
        if clipped:
            with pytest.raises(cf.errors.InputError, match="responses at points 1;"):
                cf.frf.estimate(given, test="shaker")
        else:
            assert cf.frf.estimate(given, test="shaker").averages > 1


@pytest.mark.parametrize(("step", "clipped"), [(5.0, False), (6.0, True)])
def test_a_clipped_channel_has_more_than_five_smallest_steps_beside_its_extreme(step, clipped):
    """A slow wave in whole counts whose highest value occurs four times, with a step of some counts beside it."""
    wave = np.round(2.0 * np.sin(0.05 * np.arange(BLOCK)))
    wave[200:204] = wave[199] + step
    wave[204] = wave[203] - 1.0
    assert wave[200] == wave.max()
    given = take(np.random.default_rng(8).standard_normal(BLOCK), [wave])
    if clipped:
        with pytest.raises(cf.errors.InputError, match="responses at points 1;"):
            cf.frf.estimate(given, test="shaker")
    else:
        assert cf.frf.estimate(given, test="shaker").averages > 1


@pytest.mark.parametrize(("first", "part", "even"), [(-0.5, 0.04, True), (100.0, 0.06, False), (0.0, -0.06, False)])
def test_times_may_be_off_by_a_twentieth_of_a_step_wherever_they_begin(first, part, even):
    x = first + np.arange(100) / 64.0
    x[40] += part / 64.0
    sets = [cf.frf.FrfSet.from_arrays(kind="time", x=x, responses=[np.ones(100)], unit=unit) for unit in ("m", "N")]
    if even:
        assert cf.frf.Take(response=sets[0], force=sets[1]).fs == pytest.approx(64.0)
    else:
        low, high = sorted((1.0 / 64.0, (1.0 + part) / 64.0, (1.0 - part) / 64.0))[::2]
        with pytest.raises(cf.errors.InputError, match=f"found steps from {low:g} to {high:g} s; expected even steps"):
            cf.frf.Take(response=sets[0], force=sets[1])


def test_a_hit_whose_responses_are_all_clipped_is_left_out():
    force, response = hits([START], BLOCK)
    flat = np.clip(response, -0.4 * response.max(), 0.4 * response.max())
    found = cf.frf.estimate([take(force, [response, response]), take(force, [flat, flat])], test="hammer")
    assert found.hits[1].fault == "every response is clipped: reduce the sensitivity, or hit with less force"
    found = cf.frf.estimate([take(force, [response, response]), take(force, [response, flat])], test="hammer")
    assert [hit.fault for hit in found.hits] == ["", ""]
    np.testing.assert_allclose(found.frfs.responses[1], of_dft(force, response), rtol=1e-9, atol=1e-8)


def test_blocks_of_fewer_than_sixteen_samples_are_refused():
    force, response = hits([100, 115, 130], 160, ring=SHORT[:5])
    with pytest.raises(cf.errors.InputError, match="found 14 samples a hit; expected 16 or more"):
        cf.frf.estimate(take(force, [response]), test="hammer", seconds=15.0 / FS, before=4.0 / FS)


@pytest.mark.parametrize(
    ("window", "overlap", "averages"), [("hann", 0.5, 7), ("rectangular", 0.0, 4), ("hann", 0.75, 13)]
)
def test_a_shaker_test_is_welch_s_average_of_its_blocks(window, overlap, averages):
    rng = np.random.default_rng(8)
    force = rng.standard_normal(4 * BLOCK)
    x = np.convolve(force, SHORT)[: len(force)] + 0.1 * rng.standard_normal(len(force))
    found = cf.frf.estimate(take(force, [x]), seconds=BLOCK / FS, window=window, overlap=overlap, band=(10.0, 100.0))
    assert found.averages == averages
    step = round(BLOCK * (1.0 - overlap))
    shape = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(BLOCK) / BLOCK) if window == "hann" else 1.0
    f, r = (
        np.array([np.fft.rfft(part[k * step : k * step + BLOCK] * shape) for k in range(averages)])
        for part in (force, x)
    )
    lines = slice(5, 51)  # 2 Hz apart
    assert found.frfs.x.tolist() == (2.0 * np.arange(5, 51)).tolist()
    cross, own = (r * f.conj()).sum(axis=0), (np.abs(f) ** 2).sum(axis=0)
    np.testing.assert_allclose(found.frfs.responses[0], (cross / own)[lines], rtol=1e-9)
    coherence = np.abs(cross) ** 2 / own / (np.abs(r) ** 2).sum(axis=0)
    np.testing.assert_allclose(found.coherence.responses[0].real, coherence[lines], rtol=1e-9)
    (row,) = found.records()
    assert (row["channel"], row["point"], row["reference"]) == (1, 1, 1)
    assert "multiple coherence" not in found.coherence.card
    assert row["median_coherence"] == pytest.approx(np.sort(coherence[lines])[23])


def test_two_forces_have_responses_to_each_and_one_multiple_coherence():
    """x = f_1 convolved + 3 f_2: the responses by the two-by-two system of plain spectra."""
    rng = np.random.default_rng(8)
    forces = rng.standard_normal((2, 8 * BLOCK))
    x = np.convolve(forces[0], SHORT)[: forces.shape[1]] + 3.0 * forces[1] + rng.standard_normal(forces.shape[1])
    one = take(forces[0], [x])
    at = {"response_point": np.array([1, 4]), "response_direction": np.array([3, -2])}
    at |= {name.replace("response", "reference"): np.array([0, 0]) for name in at}
    both = replace(one, force=replace(one.force, responses=forces, **at))
    found = cf.frf.estimate(both, seconds=BLOCK / FS, window="rectangular", overlap=0.0)
    f, r = (np.fft.rfft(part.reshape(*part.shape[:-1], 8, BLOCK))[..., 1:201] for part in (forces, x[None]))
    cross, own = np.einsum("xal,fal->lxf", r, f.conj()), np.einsum("xal,fal->lxf", f, f.conj())
    H = cross @ np.linalg.inv(own)
    np.testing.assert_allclose(found.frfs.responses, H[:, 0].T, rtol=1e-9)
    assert found.frfs.reference_point.tolist() == [1, 4]
    assert found.frfs.reference_direction.tolist() == [3, -2]
    assert found.frfs.response_point.tolist() == [1, 1]
    power = np.sum(np.abs(r[0]) ** 2, axis=0)
    coherence = np.einsum("lxf,lxf->l", H, cross.conj()).real / power
    np.testing.assert_allclose(found.coherence.responses.real, coherence[None], rtol=1e-9)
    assert found.coherence.card[-1] == "multiple coherence"
    assert found.averages == 8
    assert [row["median_coherence"] for row in found.records()] == [pytest.approx(np.sort(coherence)[100])] * 2


@pytest.mark.parametrize(
    ("window", "overlap", "words"),
    [
        ("hann", 0.91, "overlap: found 0.91, expected 0 to 0.9"),
        ("hann", -0.1, "overlap: found -0.1"),
        ("flat", 0.5, "window: found 'flat'"),
    ],
)
def test_windows_and_overlaps_are_refused_by_name(window, overlap, words):
    force = np.random.default_rng(8).standard_normal(4 * BLOCK)
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.estimate(take(force, [force]), test="shaker", window=window, overlap=overlap)
    assert cf.frf.estimate(take(force, [force]), test="shaker", overlap=0.9, seconds=0.5).averages == 31


def test_without_a_given_length_a_shaker_s_record_has_twenty_blocks():
    force = np.random.default_rng(8).standard_normal(20 * 64 + 19)
    found = cf.frf.estimate(take(force, [force]), overlap=0.0, window="rectangular")
    assert (found.averages, found.frfs.x[0]) == (20, FS / 64.0)
    parts = [take(force[: 65 + k], [force[: 65 + k]]) for k in range(3)]  # records of their own are one block each
    found = cf.frf.estimate(parts, test="shaker", window="rectangular")
    assert (found.averages, found.frfs.x[0]) == (3, FS / 64.0)


def test_a_shaker_s_blocks_need_four_samples_and_no_more_than_the_record():
    force = np.random.default_rng(8).standard_normal(79)
    for samples, seconds in ((2, None), (80, 80.0 / FS)):
        words = f"found blocks of {samples} samples in records of 79; expected 4 samples or more, at most"
        with pytest.raises(cf.errors.InputError, match=words):
            cf.frf.estimate(take(force, [force]), test="shaker", seconds=seconds)
    assert cf.frf.estimate(take(force, [force]), test="shaker", seconds=5.0 / FS).frfs.x[0] == FS / 4.0
    assert cf.frf.estimate(take(force, [force]), test="shaker", seconds=79.0 / FS).averages == 1


def test_clipped_channels_of_a_shaker_are_named_by_their_points():
    force = np.random.default_rng(8).standard_normal(4 * BLOCK)
    flat = np.clip(force, -1.0, 1.0)
    for forces, responses, words in (
        (flat, [force], "found clipped channels: 1 forces, none; expected channels within their range"),
        (force, [flat, force, flat], "found clipped channels: 0 forces, responses at points 1, 3; expected"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.frf.estimate(take(forces, responses))


@pytest.mark.parametrize("band", [(0.0, 1.0), (100.0, 50.0), (-1.0, 5.0), (600.0, 700.0)])
def test_a_band_without_lines_is_refused_with_the_distance_of_the_lines(band):
    force, response = hits([START], BLOCK)
    words = "expected from below to, with lines, which are 2 Hz apart up to 512 Hz"
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.estimate(take(force, [response]), band=band)
    whole = cf.frf.estimate(take(force, [response]), band=(2.0, 512.0)).frfs.x
    assert (whole[0], whole[-1]) == (2.0, 512.0)


@pytest.mark.parametrize(
    ("decay", "tau", "noted"), [(1.0, None, True), (1.0, 0.3, False), (1.4, None, True), (1.7, None, False)]
)
def test_what_is_left_of_the_ringing_is_its_decay_and_gives_the_time_to_measure(decay, tau, noted):
    """One per cent is left after log(100)/decay, which a longer record or a window reach."""
    after = (2 * BLOCK - START) / FS
    ring = np.exp(-decay * np.arange(2 * BLOCK) / FS) * np.cos(0.7 * np.arange(2 * BLOCK))
    force, response = hits([START], 2 * BLOCK, ring)
    found = cf.frf.estimate(take(force, [response]), exponential=tau, band=(20.0, 40.0))
    assert found.left == pytest.approx(np.exp(-decay * after), rel=0.03)
    words = [note for note in found.notes if "decayed only" in note]
    assert len(words) == noted
    if noted:
        left, seconds = found.left, 2 * BLOCK / FS
        longer, window = seconds * np.log(0.01) / np.log(left), seconds / np.log(left / 0.01)
        assert words[0] == (
            f"the response has decayed only to {100.0 * left:.0f} % at the end: measure {longer:.2g} s, or use an"
            f" exponential window of {window:.2g} s"
        )


def test_a_soft_hammer_is_told_from_which_frequency_on_its_force_is_weak():
    """A raised cosine gives less than one per cent of its impulse from near its first zero on."""
    force, response = hits([START], BLOCK, pulse=9.0 * np.hanning(12)[1:-1])
    spectrum, x = np.abs(np.fft.rfft(force)), np.fft.rfftfreq(BLOCK, 1.0 / FS)
    first = float(x[np.flatnonzero(spectrum < 1e-2 * spectrum.max())[0]])
    assert 100.0 < first < 300.0
    (note,) = [note for note in cf.frf.estimate(take(force, [response])).notes if "harder tip" in note]
    words = "the hammer gives less than 1 % of its largest force spectrum: use a harder tip for these lines"
    assert note == f"above {first:.5g} Hz {words}"
    for band, weak in (((10.0, first - 2.0), False), ((10.0, first), True)):
        notes = cf.frf.estimate(take(force, [response]), band=band).notes
        assert any("harder tip" in note for note in notes) == weak


@pytest.mark.parametrize("estimator", ["H1", "H2", "Hv"])
def test_a_line_without_force_has_no_response_and_no_coherence(estimator):
    """The highest line of a pulse of equal halves, such as counts of a converter, is exactly zero."""
    force, response = hits([START], BLOCK, pulse=np.array([1.0, 7.0, 7.0, 1.0]))
    both = [take(force, [response])] * 2
    found = cf.frf.estimate(both, test="hammer", estimator=estimator, band=(2.0, FS / 2.0))
    assert found.frfs.x[-1] == FS / 2.0
    assert (found.frfs.responses[0, -1], found.coherence.responses[0, -1]) == (0.0, 0.0)
    exact = np.fft.rfft(response)[1:-1] / np.fft.rfft(force)[1:-1]
    np.testing.assert_allclose(found.frfs.responses[0, :-1], exact, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(found.coherence.responses[0, :-1].real, 1.0, rtol=1e-9)


def test_a_force_whose_peak_is_nine_times_its_rms_is_a_hammer_s():
    for count, hammer in ((6, True), (7, False)):  # peak over rms of equal samples: sqrt(512/count)
        force, response = hits([START], BLOCK, pulse=9.0 + 1e-3 * np.arange(count))
        assert bool(cf.frf.estimate(take(force, [response])).hits) == hammer


def test_at_most_six_faults_of_hits_are_listed():
    silent = take(np.r_[1.0, np.zeros(BLOCK - 1)], [np.ones(BLOCK)])
    with pytest.raises(cf.errors.InputError) as refused:
        cf.frf.estimate([silent] * 7, test="hammer")
    assert "; hit 6: " in str(refused.value)
    assert "hit 7" not in str(refused.value)
