"""Circle scans: lines against closed forms, noise against the Cramer-Rao bound, collisions, pairs."""

import re
from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.probed import finite

SEED = 7719
FS = 2000.0
PSI = np.array([0.13, 0.13 + np.pi / 16])  # antinodes of the members of a pair, n = 8


def turning(rate, fs, samples, first_angle=0.0):
    """Angle of a steady turn [rad], at `rate` [turns/s]."""
    return first_angle + 2.0 * np.pi * rate / fs * np.arange(samples)


def wave(n, psi, back=0.0, tone=371.3, rate=2.3, seconds=6.0, phase=0.4):
    """A record of cos n(theta - psi) and, `back` as strong, one that runs backwards."""
    count = round(seconds * FS)
    theta, t = turning(rate, FS, count, first_angle=0.3), np.arange(count) / FS
    carried = 2.0 * np.pi * tone * t + phase
    seen = np.cos(n * (theta - psi)) * np.cos(carried) + back * np.cos(carried + n * (theta - psi))
    return cf.circle.ScanRecord(fs=FS, velocity=seen, angle=theta, tones=(tone,))


@pytest.mark.parametrize("rate", [2.3, -1.7])
@pytest.mark.parametrize(("n", "psi"), [(1, 0.5), (8, 0.11), (13, 0.2)])
def test_a_standing_wave_gives_two_equal_lines_with_opposite_phases(n, psi, rate):
    found = cf.circle.demodulate(wave(n, psi, rate=rate), 15)
    up, down = (found.V[0, np.flatnonzero(found.n == k)[0]] for k in (n, -n))
    assert up == pytest.approx(0.5 * np.exp(1j * (0.4 - n * psi)), abs=1e-10)
    assert down == pytest.approx(0.5 * np.exp(1j * (0.4 + n * psi)), abs=1e-10)
    assert found.lines[0, found.n == n][0] == pytest.approx(371.3 + n * rate, abs=1e-9)
    seen = found.wave(0, n)
    assert seen.angle_deg == pytest.approx(np.degrees(psi) % (180.0 / n), abs=1e-8)
    assert [w.n for w in found.waves() if w.amplitude > 1e-9] == [n]


@pytest.mark.parametrize("back", [0.0, 0.25, 3.0])
def test_what_travels_is_reported(back):
    seen = cf.circle.demodulate(wave(6, 0.2, back=back), 8).wave(0, 6)
    assert seen.travelling == pytest.approx(-back / (1.0 + back), abs=1e-9)
    assert seen.amplitude == pytest.approx(1.0 + back, rel=1e-9)
    assert seen.angle_deg == pytest.approx(np.degrees(0.2), abs=1e-7)


def test_the_shape_is_the_wave():
    record = wave(5, 0.3, back=0.2)
    theta = np.linspace(0.0, 6.0, 50)
    V = (np.cos(5 * (theta - 0.3)) + 0.2 * np.exp(5j * (theta - 0.3))) * np.exp(0.4j)
    np.testing.assert_allclose(cf.circle.demodulate(record, 7).shape(0, theta), V, atol=1e-9)


def test_orientation_and_amplitude_err_as_the_cramer_rao_bound_allows():
    n, psi, level = 8, 0.11, 0.5
    clean = wave(n, psi, seconds=2.0)
    rng = np.random.default_rng(SEED)
    noisy = [clean.velocity + level * rng.standard_normal(clean.velocity.size) for _ in range(60)]
    waves = [
        cf.circle.demodulate(cf.circle.ScanRecord(fs=FS, velocity=v, angle=clean.angle, tones=clean.tones), [n]).wave(
            0, n
        )
        for v in noisy
    ]
    count = clean.velocity.size
    bound = np.degrees(2.0 * level / (n * np.sqrt(count)))  # of psi at amplitude 1: 4 s^2/(n^2 N)
    errors = np.array([w.angle_deg for w in waves]) - np.degrees(psi)
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(bound, rel=0.2)
    assert np.median([w.angle_sigma_deg for w in waves]) == pytest.approx(bound, rel=0.1)
    amplitude = np.array([w.amplitude for w in waves])
    assert np.std(amplitude) == pytest.approx(np.median([w.amplitude_sigma for w in waves]), rel=0.25)
    travel = np.array([w.travelling for w in waves])
    assert np.std(travel) == pytest.approx(np.median([w.travelling_sigma for w in waves]), rel=0.25)


@pytest.mark.slow
def test_orders_that_are_not_there_are_not_seen():
    clean = wave(8, 0.11, seconds=4.0)
    rng = np.random.default_rng(SEED)
    false = 0
    for _ in range(20):
        noisy = clean.velocity + 0.3 * rng.standard_normal(clean.velocity.size)
        found = cf.circle.demodulate(
            cf.circle.ScanRecord(fs=FS, velocity=noisy, angle=clean.angle, tones=clean.tones), 12
        )
        false += sum(w.seen for w in found.waves()) - 1
    assert false <= 2


def test_a_fit_states_what_it_leaves():
    clean = wave(8, 0.11, seconds=4.0)
    noisy = clean.velocity + 0.01 * np.random.default_rng(SEED).standard_normal(clean.velocity.size)
    record = cf.circle.ScanRecord(fs=FS, velocity=noisy, angle=clean.angle, tones=clean.tones)
    whole, part = cf.circle.demodulate(record, 9), cf.circle.demodulate(record, 7)
    assert whole.left == pytest.approx(1.0, abs=0.05)
    assert part.left > 10.0
    assert "orders or tones that were not fitted" in repr(part)
    assert "not fitted" not in repr(whole)


def test_a_record_of_no_whole_turns_or_periods_does_not_leak():
    found = cf.circle.demodulate(wave(8, 0.11, seconds=3.4567, rate=1.234), 12)
    others = np.abs(found.V[0, np.abs(found.n) != 8])
    assert others.max() < 1e-11
    record = wave(8, 0.11, seconds=3.4567, rate=1.234)
    spectrum = np.abs(np.fft.rfft(record.velocity)) / len(record.velocity)
    at = np.fft.rfftfreq(len(record.velocity), 1.0 / FS)
    assert spectrum[np.abs(at - 371.3) < 0.3].max() > 1e-3  # n = 0 is not there, but a bin states it


def test_a_tacho_mends_an_uneven_rate():
    rig, circle = ring_rig()
    turn = cf.rig.Turning(mirror=2.0, wander=0.01)
    made = cf.rig.scan(rig, turn, [cf.rig.Tone(370.4)], circle=circle, drive=0, fs=FS, seconds=8.0, seed=SEED)
    truth = made.V[0, made.n == 8][0]
    turns = made.record.angle / (2.0 * np.pi)
    time = np.arange(len(turns)) / FS
    pulses = np.interp(np.arange(int(16 * turns[-1]) + 1) / 16, turns, time)
    after = pulses[-1] + np.diff(pulses)[-1]
    angle = cf.circle.from_tacho(np.r_[pulses, after], FS, len(turns), per_turn=16)
    known, blind = (
        cf.circle.demodulate(
            cf.circle.ScanRecord(fs=FS, velocity=made.record.velocity, angle=a, tones=(370.4,)), [8]
        ).V[0, 1]
        for a in (angle, turning(2.0, FS, len(turns)))
    )
    assert abs(known / truth - 1.0) < 2e-3
    assert abs(blind / truth - 1.0) > 0.05


@pytest.mark.parametrize("wander", [0.01, 0.03])
def test_the_rate_of_a_spot_wanders_by_the_share_that_is_stated_at_any_speed(wander):
    rig, circle = ring_rig()
    off = []
    for mirror in (2.0, 5.0):
        turn = cf.rig.Turning(mirror=mirror, wander=wander)
        made = cf.rig.scan(rig, turn, [cf.rig.Tone(370.4)], circle=circle, drive=0, fs=FS, seconds=2.0, seed=SEED)
        off.append(np.diff(made.record.angle) * FS / (2.0 * np.pi * mirror) - 1.0)
    np.testing.assert_allclose(off[0], off[1], atol=1e-9)
    assert 0.3 * wander < np.std(off[0]) < 3.0 * wander


def ring_rig(split=0.0, psi=0.13, zeta=0.002, count=48):
    """Pairs n = 8 and n = 7 seen from a circle: cosines and sines about psi."""
    theta = 2.0 * np.pi * np.arange(count) / count
    probes = [cf.rig.Probe(k + 1, 1, (float(np.cos(a)), float(np.sin(a)), 0.0), float(a)) for k, a in enumerate(theta)]
    freq = [370.0 - split / 2.0, 370.0 + split / 2.0, 383.0, 384.0]
    shapes = [np.cos(8 * (theta - psi)), np.sin(8 * (theta - psi)), np.cos(7 * theta), np.sin(7 * theta)]
    omega = 2.0 * np.pi * np.array(freq)
    S = 1e-7 * sum(np.cos(n * np.subtract.outer(theta, theta)) for n in (5, 8, 9))
    return cf.rig.Rig.of(omega=omega, zeta=zeta, rows=np.array(shapes).T, S=S, probes=probes), range(count)


def test_the_truth_is_labelled_by_its_shapes():
    rig, circle = ring_rig(split=0.5)
    found = cf.rig.truth(rig, circle)
    assert found.n.tolist() == [8, 8, 7, 7]
    np.testing.assert_allclose(found.angle_deg, [np.degrees(0.13), np.degrees(0.13) + 11.25, 0.0, 90.0 / 7], atol=1e-9)
    assert cf.rig.truth(rig).n.tolist() == [-1] * 4
    turned = cf.rig.truth(replace(rig, rows=-rig.rows), circle)  # a shape and its negative are one
    np.testing.assert_allclose(turned.angle_deg, found.angle_deg, atol=1e-9)


def test_the_rig_makes_the_lines_of_its_modes():
    rig, circle = ring_rig(split=0.8)
    made = cf.rig.scan(
        rig,
        cf.rig.Turning(mirror=1.7),
        [cf.rig.Tone(370.2, 2.0, 0.3)],
        circle=circle,
        drive=5,
        fs=FS,
        seconds=4.0,
        seed=SEED,
    )
    H = rig.frfs([370.2], sensors=circle, drives=[5], quantity="mobility").responses[:, 0] * 2.0 * np.exp(0.3j)
    theta = np.array([p.angle for p in rig.probes])
    np.testing.assert_allclose(np.exp(1j * np.multiply.outer(theta, made.n)) @ made.V[0], H, rtol=1e-9)
    found = cf.circle.demodulate(made.record, 12)
    inside = np.abs(made.n) <= 12
    np.testing.assert_allclose(found.V[0], made.V[0, inside], atol=1e-9 * np.abs(made.V).max())


def test_a_turning_casing_runs_the_other_way():
    rig, circle = ring_rig(split=0.8)
    mirror, lathe = (
        cf.rig.scan(rig, turn, [cf.rig.Tone(370.2)], circle=circle, drive=5, fs=FS, seconds=4.0, seed=SEED)
        for turn in (cf.rig.Turning(mirror=1.7), cf.rig.Turning(casing=1.7))
    )
    assert lathe.record.rate == pytest.approx(-mirror.record.rate)
    both = [cf.circle.demodulate(made.record, 9).wave(0, 8) for made in (mirror, lathe)]
    assert both[0].angle_deg == pytest.approx(both[1].angle_deg, abs=1e-7)
    assert both[0].travelling == pytest.approx(both[1].travelling, abs=1e-9)
    assert abs(both[0].travelling) > 0.05  # two members, out of phase


def test_the_card_states_by_how_much_a_turning_ring_s_pair_splits(steel):
    """As whirl modes of a thin ring on soft springs have it, in the frame of the ring."""
    ring = cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.02), thickness=2e-3, material=steel,
                    supports={"base": cf.ElasticEdge(k_face=1e7)}, rotation=cf.Rotation(omega=2.0 * np.pi * 2.5),
                    mesh=cf.ShellMesh(order=4, rows=1, around=5))  # fmt: skip
    waves = cf.whirl_modes(ring, 8)
    split = np.ptp(waves.freq[waves.nodal_diameters == 2])
    rig, circle = ring_rig()
    asked = {"circle": circle, "drive": 5, "fs": FS, "seconds": 0.1, "seed": SEED}
    still, lathe = (
        cf.rig.scan(rig, cf.rig.Turning(mirror=1.0, casing=c), [cf.rig.Tone(370.2)], **asked) for c in (0.0, -2.5)
    )
    assert "Coriolis" not in " ".join(still.record.card)
    (told,) = re.findall(r"pair n = 2 by (\S+) Hz", " ".join(lathe.record.card))
    assert float(told) == pytest.approx(split, rel=0.01)


@pytest.mark.parametrize(("highest", "last"), [(None, 23), (8, 8)])
def test_a_force_in_space_is_felt_at_as_many_frequencies_as_shapes_have_harmonics(highest, last):
    """At omega - m W each; of a perfect pair only the wave answers that is in space, n = -m."""
    rig, circle = ring_rig(split=0.0)
    made = cf.rig.scan(
        rig,
        cf.rig.Turning(mirror=2.05, casing=0.05),
        [cf.rig.Tone(369.9)],
        circle=circle,
        drive_circle=circle,
        drive_angle=0.2,
        fs=FS,
        seconds=0.1,
        seed=SEED,
        highest=highest,
    )
    assert made.n.tolist() == list(range(-23, 24))
    np.testing.assert_allclose(made.record.tones, 369.9 + 0.05 * np.arange(-last, last + 1), atol=1e-9)
    for m in (-8, 8):
        felt = np.abs(made.V[int(np.argmin(np.abs(np.array(made.record.tones) - 369.9 + 0.05 * m)))])
        assert felt[made.n == m][0] < 1e-9 * felt[made.n == -m][0]


@pytest.mark.slow
def test_a_force_fixed_in_space_excites_a_perfect_casing_at_rest_in_space():
    rig, circle = ring_rig(split=0.0)
    made = cf.rig.scan(
        rig,
        cf.rig.Turning(mirror=2.05, casing=0.05),
        [cf.rig.Tone(369.9)],
        circle=circle,
        drive_circle=circle,
        drive_angle=0.2,
        fs=FS,
        seconds=40.0,
        seed=SEED,
        highest=8,
    )
    felt = np.array(made.record.tones)
    np.testing.assert_allclose(felt, 369.9 + 0.05 * np.arange(-8, 9), atol=1e-9)
    for k, order in enumerate(range(8, -9, -1)):  # felt at omega - m W: only n = -m answers, by symmetry
        other = made.n != -order
        if abs(order) == 8:
            assert np.abs(made.V[k, other]).max() < 1e-9 * np.abs(made.V[k, ~other]).max()
    found = cf.circle.demodulate(made.record, [7, 8])
    truth = made.V[:, np.isin(np.abs(made.n), [7, 8])]
    np.testing.assert_allclose(found.V, truth, atol=1e-6 * np.abs(truth).max())
    still = cf.rig.scan(
        rig,
        cf.rig.Turning(casing=0.5),
        [cf.rig.Tone(369.9)],
        circle=circle,
        drive_circle=circle,
        fs=FS,
        seconds=40.0,
        seed=SEED,
        highest=8,
    )
    with pytest.raises(cf.errors.InputError, match="cannot be separated"):
        cf.circle.demodulate(still.record, 8)


def test_a_force_in_space_that_hardly_turns_is_one_on_the_casing():
    rig, circle = ring_rig(split=0.8)
    asked = {"circle": circle, "fs": FS, "seconds": 2.0, "seed": SEED}
    slow = cf.rig.scan(rig, cf.rig.Turning(mirror=2.0, casing=1e-7), [cf.rig.Tone(370.2)], drive_circle=circle,
                drive_angle=rig.probes[5].angle, **asked)  # fmt: skip
    fixed = cf.rig.scan(rig, cf.rig.Turning(mirror=2.0), [cf.rig.Tone(370.2)], drive=5, **asked)
    np.testing.assert_allclose(slow.V.sum(axis=0), fixed.V[0], atol=1e-4 * np.abs(fixed.V).max())


def test_run_out_and_speckle_repeat_every_turn_and_are_reported_from_the_wave():
    rig, circle = ring_rig()
    turn = cf.rig.Turning(mirror=2.0, runout=((0.1, 0.0), (0.0, 0.05)), speckle=1e-3)
    made = cf.rig.scan(rig, turn, [cf.rig.Tone(370.41)], circle=circle, drive=5, fs=FS, seconds=8.0, seed=SEED)
    found = cf.circle.demodulate(made.record, 10, runout=3)
    truth = made.V[0, made.n == 8][0]
    assert abs(found.V[0, found.n == 8][0] / truth - 1.0) < 1e-2
    whole = made.record.velocity.reshape(8, -1)  # two turns each, the tone apart
    rest = cf.rig.Turning(mirror=2.0, speckle=1e-3)
    quiet = cf.rig.scan(
        rig, rest, [cf.rig.Tone(370.41, 0.0)], circle=circle, drive=5, fs=FS, seconds=8.0, seed=SEED
    ).record.velocity
    np.testing.assert_allclose(quiet.reshape(16, -1)[1:], quiet.reshape(16, -1)[:-1], atol=1e-12)
    assert np.std(quiet) == pytest.approx(1e-3, rel=0.1)
    assert whole.shape == (8, 2000)


def test_force_makes_mobility():
    rig, circle = ring_rig(split=0.8)
    tone = cf.rig.Tone(370.2, 2.0, 0.3)
    made = cf.rig.scan(
        rig, cf.rig.Turning(mirror=1.7), [tone], circle=circle, drive=5, fs=FS, seconds=4.0, seed=SEED
    ).record
    force = 2.0 * np.cos(2.0 * np.pi * 370.2 * np.arange(len(made.velocity)) / FS + 0.3)
    with_force = cf.circle.ScanRecord(fs=FS, velocity=made.velocity, angle=made.angle, tones=made.tones, force=force)
    bare, over = cf.circle.demodulate(made, [8]), cf.circle.demodulate(with_force, [8])
    np.testing.assert_allclose(over.V, bare.V / (2.0 * np.exp(0.3j)), rtol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("split", [1.5, 0.75])  # half-power bandwidth 1.48 Hz
def test_a_close_pair_both_excited_is_distinguished(split, held):
    rig, circle = ring_rig(split=split, zeta=[0.002, 0.0025, 0.002, 0.002])
    tones = [cf.rig.Tone(f) for f in np.linspace(368.13, 371.93, 13)]
    made = cf.rig.scan(
        rig, cf.rig.Turning(mirror=2.71), tones, circle=circle, drive=5, fs=FS, seconds=20.0, seed=SEED, snr_db=30.0
    )
    pair = cf.circle.split_pair(cf.circle.demodulate(made.record, [8]), 8)
    np.testing.assert_allclose(pair.freq, rig.freq[:2], atol=0.01)
    assert np.all(np.abs(pair.freq - rig.freq[:2]) < 4.0 * pair.freq_sigma)
    truth = np.degrees(0.13) + np.array([0.0, 90.0 / 8])
    off = (pair.angle_deg - truth + 90.0 / 8) % (180.0 / 8) - 90.0 / 8
    assert np.all(np.abs(off) < 4.0 * pair.angle_sigma_deg)
    assert pair.angle_sigma_deg.max() < 0.5
    np.testing.assert_allclose(pair.zeta, [0.002, 0.0025], rtol=0.05)
    assert pair.split == pytest.approx(split, abs=4.0 * pair.split_sigma)
    assert 0.6 < pair.misfit < 1.6
    held(1e-4, pair=finite(pair))


CLOSE = np.array([369.25, 370.75]), np.array([0.002, 0.0025]), PSI  # frequencies, damping ratios, antinodes


def resonances(tones, freq, zeta):
    """Mobilities of members of unit size, (tones, 2)."""
    omega, own = 2.0 * np.pi * tones[:, None], 2.0 * np.pi * freq
    return 1j * omega / (own**2 - omega**2 + 2j * zeta * own * omega)


def close_pair(rng):
    """Exact waves of a pair and a slow rest at six tones, with noise."""
    tones, (freq, zeta, angle) = np.linspace(368.1, 371.9, 6), CLOSE
    h, rest = resonances(tones, freq, zeta), 2e-8j * np.pi * tones
    cosine, sine = (h * part(8 * angle) @ [1.0, 0.8] + rest for part in (np.cos, np.sin))
    V = 0.5 * np.column_stack([cosine + 1j * sine, cosine - 1j * sine])
    sigma = np.full(V.shape, 0.003 * np.abs(V).max())
    noise = sigma * (rng.standard_normal(V.shape) + 1j * rng.standard_normal(V.shape))
    return cf.circle.CircleScan(
        tones=tones, n=np.array([-8, 8]), V=V + noise, sigma=sigma, floor=sigma, rate=2.0, left=1.0
    )


def left_over(seen, pair):
    """Sum of squares over the noise's that the poles of a pair leave of a scan, of 24 equations."""
    A = np.hstack([resonances(seen.tones, pair.freq, pair.zeta), 2e-6j * np.pi * seen.tones[:, None]])
    data = np.column_stack([seen.V.sum(axis=1), 1j * (seen.V[:, 1] - seen.V[:, 0])])
    left = np.linalg.lstsq(np.vstack([A.real, A.imag]), np.vstack([data.real, data.imag]), rcond=None)[1]
    return left.sum() / (2.0 * seen.sigma[0, 0] ** 2)


@pytest.mark.slow
def test_the_misfit_of_a_pair_is_over_the_equations_that_its_ten_unknowns_leave(held):
    seen = close_pair(np.random.default_rng(SEED))
    pair = cf.circle.split_pair(seen, 8)
    held(1e-4, pair=finite(pair))
    assert pair.misfit == pytest.approx(np.sqrt(left_over(seen, pair) / (24 - 10)), rel=1e-6)


@pytest.mark.campaign
def test_uncertainties_of_a_pair_are_the_scatter_of_repeated_scans():
    """40 draws of noise on exact waves: deviations over sigma have unit rms, misfit^2 a mean of 1 (14 of 24 equations).

    Tolerances are 3.5 standard deviations of 40 draws.
    """
    (freq, zeta, angle), draws = CLOSE, 40
    rng, off, misfits = np.random.default_rng(SEED), [], []
    for _ in range(draws):
        pair = cf.circle.split_pair(close_pair(rng), 8)
        turned = (pair.angle_deg - np.degrees(angle) + 90.0 / 8) % (180.0 / 8) - 90.0 / 8
        parts = (
            (pair.freq - freq) / pair.freq_sigma, (pair.zeta - zeta) / pair.zeta_sigma,
            turned / pair.angle_sigma_deg, (pair.split - np.ptp(freq)) / pair.split_sigma,
        )  # fmt: skip
        off.append(max(pair.misfit, 1.0) * np.hstack(parts))  # by which a fit that misfits raises its sigma
        misfits.append(pair.misfit**2)
    assert np.sqrt(np.mean(np.square(off), axis=0)) == pytest.approx(np.ones(7), abs=3.5 / np.sqrt(2.0 * draws))
    assert np.mean(misfits) == pytest.approx(1.0, abs=3.5 * np.sqrt(2.0 / 14 / draws))


def scan_of_a_pair(freq, amplitude=(1.0, 0.8), seed=None):
    """Two members of one damping at six tones, sigma 1e-3 of the largest wave; noise of that size with a seed."""
    tones, orders = np.linspace(368.1, 371.9, 6), np.array([-8, 8])
    omega, own = 2.0 * np.pi * tones[:, None], 2.0 * np.pi * np.asarray(freq)
    h = 1j * omega / (own**2 - omega**2 + 2j * 0.002 * own * omega)
    cosine, sine = (h * part(8 * PSI) @ amplitude for part in (np.cos, np.sin))
    V = 0.5 * np.column_stack([cosine + 1j * sine, cosine - 1j * sine])
    sigma = np.full(V.shape, 1e-3 * np.abs(V).max())
    if seed is not None:
        rng = np.random.default_rng(seed)
        V = V + sigma * (rng.standard_normal(V.shape) + 1j * rng.standard_normal(V.shape))
    return cf.circle.CircleScan(tones=tones, n=orders, V=V, sigma=sigma, floor=sigma, rate=2.0, left=1.0)


@pytest.mark.slow
def test_two_members_of_nearly_one_frequency_are_distinguished_without_noise():
    pair = cf.circle.split_pair(scan_of_a_pair([370.0, 370.01]), 8)
    np.testing.assert_allclose(pair.freq, [370.0, 370.01], rtol=1e-9)
    np.testing.assert_allclose(pair.angle_deg, np.degrees(PSI), rtol=1e-6)


@pytest.mark.parametrize(
    ("freq", "amplitude", "seed"),
    [
        ([370.0, 370.0], [1.0, 0.8], 5),  # the best two would be 1.900 +- 0.044 Hz apart
        ([370.0, 370.0001], [1.0, 0.8], 1),
    ],
)
@pytest.mark.slow
def test_two_members_of_one_frequency_and_damping_are_not_distinguished(freq, amplitude, seed):
    with pytest.raises(
        cf.errors.InputError, match="the pair n = 8: the tones do not distinguish two members: found a misfit of"
    ):
        cf.circle.split_pair(scan_of_a_pair(freq, amplitude, seed), 8)


@pytest.mark.slow
def test_a_split_of_a_fifteenth_of_the_bandwidth_is_distinguished_from_noise(held):
    pair = cf.circle.split_pair(scan_of_a_pair([369.95, 370.05], seed=5), 8)
    assert pair.split == pytest.approx(0.1, abs=4.0 * pair.split_sigma)
    assert pair.split_sigma < 0.02
    held(1e-4, pair=finite(pair))


@pytest.mark.campaign
def test_noise_makes_no_two_of_a_double():
    """At a level of 1e-3 none of 200 draws, but once in five such counts."""
    for seed in range(200):
        with pytest.raises(cf.errors.InputError, match="do not distinguish two members"):
            cf.circle.split_pair(scan_of_a_pair([370.0, 370.0], seed=seed), 8)


def test_what_cannot_be_demodulated_is_refused():
    def record(seconds=5.0, rate=2.3, tones=(371.3,), fs=FS):
        count = round(seconds * fs)
        return cf.circle.ScanRecord(fs=fs, velocity=np.ones(count), angle=turning(rate, fs, count), tones=tones)

    for given, orders, words in (
        (record(seconds=0.5), 8, r"too short: found 1.15 turns.*1.5 .*\(0.652 s, or a higher"),
        (record(rate=0.0), 8, "turning mirror or casing"),
        (record(fs=760.0), 8, "expected all below fs/2"),
        (record(), [-1], "orders"),
        (record(), [], "orders"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.circle.demodulate(given, orders)
    with pytest.raises(cf.errors.InputError, match="run-out's harmonic"):
        cf.circle.demodulate(record(tones=(4.6,)), 3, runout=4)
    found = cf.circle.demodulate(record(), 8)
    for call, words in (
        (lambda: found.wave(0, 9), "order n = 9"),
        (lambda: cf.circle.split_pair(found, 8), "found 1 tones"),
        (lambda: cf.circle.split_pair(found, 9), "order n = 9"),
        (lambda: record(tones=(0.0,)), "tones"),
        (lambda: record(tones=()), "tones"),
        (lambda: cf.circle.ScanRecord(fs=FS, velocity=[1.0], angle=[1.0, 2.0], tones=(3.0,)), "angle: found shape"),
        (lambda: cf.circle.ScanRecord(fs=FS, velocity=[np.nan], angle=[1.0], tones=(3.0,)), "velocity: found shape"),
        (lambda: cf.circle.from_tacho([0.0, 1.0], FS, 5000), "span the record"),
        (lambda: cf.circle.from_tacho([0.0, 0.0], FS, 5), "ascending"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            call()


def test_what_cannot_be_scanned_is_refused():
    rig, circle = ring_rig()
    asked = {"circle": circle, "drive": 0, "fs": FS, "seconds": 1.0, "seed": SEED}
    for turn, changes, words in (
        (cf.rig.Turning(mirror=1.0), {"drive": None}, "a probe fixed to the casing, or a circle"),
        (cf.rig.Turning(mirror=1.0), {"drive_circle": circle}, "a probe fixed to the casing, or a circle"),
        (cf.rig.Turning(mirror=1.0), {"circle": [0, 1, 3]}, "uneven angles"),
        (cf.rig.Turning(mirror=1.0), {"seconds": 0.0}, "two samples"),
        (cf.rig.Turning(mirror=1.0), {"drive": 99}, "each from 0 to 47"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.rig.scan(rig, turn, [cf.rig.Tone(370.0)], **(asked | changes))
    for bad in ({}, {"mirror": np.inf}, {"mirror": 1.0, "wander": 0.5}, {"mirror": 1.0, "casing": 1.0}):
        with pytest.raises(cf.errors.InputError):
            cf.rig.Turning(**bad)


def test_the_floor_is_the_noise_in_one_bin_and_goes_by_the_force():
    """White noise has its variance in count/2 bins alike; a force of 2 N halves all but what has no unit."""
    clean, level = wave(8, 0.11), 0.5
    noisy = clean.velocity + level * np.random.default_rng(SEED).standard_normal(clean.velocity.size)
    record = replace(clean, velocity=noisy)
    found = cf.circle.demodulate(record, 9)
    assert np.sqrt(np.mean(found.floor**2) * noisy.size / 2.0) == pytest.approx(level, rel=0.1)
    force = 2.0 * np.cos(2.0 * np.pi * 371.3 * np.arange(noisy.size) / FS + 0.3)
    over = cf.circle.demodulate(replace(record, force=force), 9)
    np.testing.assert_allclose(over.floor, found.floor / 2.0, rtol=1e-8)
    np.testing.assert_allclose(over.sigma, found.sigma / 2.0, rtol=1e-8)
    one, other = found.wave(0, 8), over.wave(0, 8)
    assert other.amplitude_sigma == pytest.approx(one.amplitude_sigma / 2.0, rel=1e-8)
    assert other.travelling_sigma == pytest.approx(one.travelling_sigma, rel=1e-8)


@pytest.mark.parametrize("psi", [0.05, 0.3])
def test_the_phase_of_a_wave_is_that_at_its_antinode(psi):
    assert cf.circle.demodulate(wave(5, psi, phase=0.4), 6).wave(0, 5).phase_deg == pytest.approx(
        np.degrees(0.4), abs=1e-7
    )


@pytest.mark.parametrize("direction", [1, -1])
def test_a_tacho_of_an_even_rate_states_what_the_rate_does(direction):
    at = np.arange(20) / (4 * 2.3)
    angle = cf.circle.from_tacho(at, FS, 3000, per_turn=4, first_angle=0.7, direction=direction)
    np.testing.assert_allclose(angle, turning(direction * 2.3, FS, 3000, first_angle=0.7), atol=1e-10)
    assert angle[0] == pytest.approx(0.7)
