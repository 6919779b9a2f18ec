"""Every visible peak is in the answer, once: known residues, pairs, records of several lengths, set-ups, bad data."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.held_modes import numbers_of_modes

THETA = 2.0 * np.pi * np.arange(16) / 16 + 0.03
ANGLES = dict(enumerate(np.degrees(THETA)))


def receptances(x, poles, noise=0.0, seed=1, **places):
    """Responses of modes (f [Hz], zeta, residues (channels,)) over lines x, peaks of one unit of residue 1/(2 zeta)."""
    rng = np.random.default_rng(seed)
    H = sum(np.outer(r, f**2 / (f**2 - x**2 + 2j * z * f * x)) for f, z, r in poles)
    H = H + noise * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    given = {"response_point": np.arange(len(H))} | places
    return cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", **given)


def test_one_mode_gives_its_pole_and_its_residues(held):
    residues = np.array([1.0, -0.5, 0.25])
    found = cf.identify(receptances(np.arange(80.0, 120.0, 0.1), [(100.0, 0.004, residues)], noise=1e-3))
    assert found.freq == pytest.approx([100.0], abs=5 * found.sigma_freq[0])
    assert found.zeta == pytest.approx([0.004], abs=5 * found.sigma_zeta[0])
    np.testing.assert_allclose(found.residues[:, 0, 0], residues, atol=1e-3)
    assert found.sure.tolist() == [True]
    assert found.diagram.stable.any()
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.parametrize("lines", [0.1, 0.5, 2.0])
def test_a_mode_narrower_than_the_lines_is_found_with_an_honest_damping(lines, held):
    """Bandwidths of 0.1, 0.5 and 2 lines: 1/T over the bandwidth says how long a record was."""
    x = np.arange(80.0, 120.0, 0.1)
    zeta = 0.5 * lines * 0.1 / 100.03
    found = cf.identify(receptances(x, [(100.03, zeta, np.array([1.0, -0.6, 0.4, 0.8]))], noise=1e-2))
    assert len(found) == 1
    held(1e-4, **numbers_of_modes(found))
    assert abs(found.freq[0] - 100.03) < 5 * found.sigma_freq[0] + 1e-4
    assert abs(found.zeta[0] - zeta) < 5 * found.sigma_zeta[0]


def test_a_perfect_pair_is_one_mode_with_one_reference_and_an_unresolved_pair_with_two(held):
    x, one, two = np.arange(190.0, 210.0, 0.05), np.cos(3 * THETA), np.sin(3 * THETA)
    single = cf.identify(receptances(x, [(200.0, 0.003, one + 0.5 * two)], noise=1e-2), angles=ANGLES)
    assert single.n.tolist() == [3]
    assert "n = 3 at 200.00 Hz has no partner" in " ".join(single.notes)
    rows = np.r_[one + 0.5 * two, 0.3 * one - two]
    places = {"response_point": np.tile(np.arange(16), 2), "reference_point": np.repeat([101, 102], 16)}
    double = cf.identify(receptances(x, [(200.0, 0.003, rows)], noise=1e-2, **places), angles=ANGLES)
    assert double.n.tolist() == [3]
    assert double.unresolved == (0,)
    assert "pair at 200.00 Hz, unresolved" in " ".join(double.notes)
    assert double.freq == pytest.approx([200.0], abs=1e-2)
    two = {f"two {name}": column for name, column in numbers_of_modes(double).items()}
    held(1e-4, **numbers_of_modes(single), **two)


def test_a_tone_of_one_line_is_in_the_answer_and_doubtful(held):
    x = np.arange(20.0, 80.0, 0.1)
    frfs = receptances(x, [(40.0, 0.004, np.array([1.0, -0.5, 0.25, 0.7]))], noise=1e-2)
    H = frfs.responses.copy()
    H[:, 300] += np.array([40.0, 30.0, 20.0, 50.0])
    found = cf.identify(replace(frfs, responses=H))
    assert found.freq == pytest.approx([40.0, 50.0], abs=0.1)
    assert found.sure.tolist() == [True, False]
    assert "hum" in found.reasons[1]
    held(1e-4, **numbers_of_modes(found))


def test_a_mode_that_one_weak_channel_alone_sees_is_found(held):
    x, noise = np.arange(80.0, 160.0, 0.1), np.random.default_rng(7)
    strong, weak = np.array([1.0, -0.5, 0.8, 0.0]), np.array([0.0, 0.0, 0.0, 1e-3])
    frfs = receptances(x, [(100.0, 0.004, strong), (140.0, 0.004, weak)])
    size = np.array([1e-2, 1e-2, 1e-2, 1e-4])[:, None]
    H = frfs.responses + size * (noise.standard_normal((4, len(x))) + 1j * noise.standard_normal((4, len(x))))
    found = cf.identify(replace(frfs, responses=H))
    assert found.freq == pytest.approx([100.0, 140.0], abs=0.05)
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.slow
def test_every_visible_peak_of_many_is_in_the_answer_once(held):
    rng = np.random.default_rng(17)
    x = np.arange(100.0, 400.0, 0.1)
    freqs = 110.0 * np.cumprod(np.r_[1.0, rng.uniform(1.02, 1.08, 20)])
    poles = [(f, rng.uniform(1e-3, 4e-3), rng.standard_normal(6)) for f in freqs]
    found = cf.identify(receptances(x, poles, noise=0.5))
    assert found.freq == pytest.approx(freqs[freqs < 395.0], rel=1e-4)
    assert found.sure.all()
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.parametrize("seeds", [3, pytest.param(24, marks=pytest.mark.campaign)])
def test_noise_that_channels_share_makes_no_mode_and_its_intervals_keep(seeds):
    """Half of the noise is common to all channels, and alike on three lines; intervals are judged by many draws."""
    x, errors = np.arange(80.0, 120.0, 0.1), []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        frfs = receptances(x, [(100.0, 0.004, np.array([1.0, -0.5, 0.8, 0.6]))])
        common, own = (rng.standard_normal((2, k, len(x) + 2)) for k in (1, 4))
        noise = (common[0] + 1j * common[1]) + (own[0] + 1j * own[1])
        noise = 0.3 * (noise[:, :-2] + noise[:, 1:-1] + noise[:, 2:])
        found = cf.identify(replace(frfs, responses=frfs.responses + noise))
        assert found.sure.sum() == 1, seed
        k = int(np.flatnonzero(found.sure)[0])
        errors.append([(found.freq[k] - 100.0) / found.sigma_freq[k], (found.zeta[k] - 0.004) / found.sigma_zeta[k]])
    assert seeds < 24 or np.sqrt(np.mean(np.square(errors))) == pytest.approx(1.0, abs=0.35)


@pytest.mark.slow
def test_modes_of_three_set_ups_are_given_once_with_the_mean_of_their_frequencies(held):
    at = np.r_[THETA, 0.4]
    orders = (4, 4, 2, 2, 5, 5)
    freqs = np.array([300.0, 301.5, 320.0, 321.0, 345.0, 347.0])
    rows = np.array([np.cos(n * (at - 0.1) - k % 2 * np.pi / 2) for k, n in enumerate(orders)]).T
    probes = [cf.rig.Probe(k + 1, 1, (0.0, 0.0, 0.0), float(a)) for k, a in enumerate(at)]
    rig = cf.rig.Rig.of(omega=2 * np.pi * freqs, zeta=2e-3, rows=rows, probes=probes)
    what = cf.rig.Troubles(snr_db=45.0, setups=3, shift=2e-3)
    test = cf.rig.troubled_frfs(rig, np.arange(290.0, 357.0, 0.1), what, sensors=range(16), drives=[16], seed=5)
    found = cf.identify(test.frfs, angles={k + 1: float(np.degrees(a)) for k, a in enumerate(THETA)})
    assert found.n.tolist() == list(orders)
    mean = test.truth.freq.mean(axis=0)
    assert np.abs(found.freq - mean).max() < 0.03
    assert np.all(np.abs(found.freq - mean) < 5.0 * found.sigma_freq + 1e-3)
    assert 3e-4 < found.shift < 3e-3
    assert "different frequencies in 3 groups of channels" in " ".join(found.notes)
    held(1e-4, **numbers_of_modes(found))


def roving(modes, setups, shift, sensors=12, **places):
    """Responses of a plate whose sensors are measured in set-ups; a roving mass lowers all modes by bandwidths."""
    rng, x = np.random.default_rng(71), np.arange(100.0, 250.0, 0.1)
    shapes = rng.uniform(0.4, 1.0, (sensors, modes)) * rng.choice([-1.0, 1.0], (sensors, modes))
    part, zeta = np.arange(sensors) % setups, rng.uniform(2e-3, 4e-3, modes)
    poles = []
    for k, freq in enumerate(np.linspace(120.0, 230.0, modes).tolist()):
        for s in range(setups):
            own = freq * (1.0 - shift * 2.0 * zeta[k] * s * rng.uniform(0.7, 1.3))
            poles.append((own, zeta[k], shapes[:, k] * (part == s)))
    return receptances(x, poles, noise=0.3, **{key: value(part) for key, value in places.items()})


def test_a_mode_that_one_set_up_does_not_see_has_the_mean_frequency_of_all_set_ups(held):
    """Each set-up lowers all modes by 0.1 % more than the one before; the last does not see the second mode."""
    rng, part = np.random.default_rng(71), np.arange(12) % 3
    freqs, zeta = np.array([120.0, 140.0, 160.0]), 3e-3
    shapes = rng.uniform(0.4, 1.0, (12, 3)) * rng.choice([-1.0, 1.0], (12, 3))
    shapes[part == 2, 1] = 0.0
    poles = [
        (freq * (1.0 - 1e-3 * s), zeta, shapes[:, k] * (part == s)) for k, freq in enumerate(freqs) for s in range(3)
    ]
    found = cf.identify(receptances(np.arange(110.0, 170.0, 0.1), poles, noise=0.3))
    np.testing.assert_allclose(found.freq, freqs * (1.0 - 1e-3), rtol=1e-4)
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.slow
def test_a_mode_that_a_roving_mass_shifts_by_a_quarter_of_a_bandwidth_is_given_once(held):
    found = cf.identify(roving(6, 6, 0.25, 6))
    assert len(found) == 6
    held(1e-4, **numbers_of_modes(found))
    assert found.sure.all()
    assert "different frequencies in 6 groups of channels" in " ".join(found.notes)


@pytest.mark.slow
@pytest.mark.parametrize("setups", [2, 12])
def test_one_mode_whose_frequency_differs_between_channels_is_given_once(setups, held):
    found = cf.identify(roving(1, setups, 0.5 / setups))
    assert found.sure.tolist() == [True]
    held(1e-4, **numbers_of_modes(found))
    assert "differs between channels" in "".join(found.notes)
    one = cf.identify(roving(1, 1, 0.0))
    assert abs(found.freq[0] - one.freq[0]) < one.zeta[0] * one.freq[0]
    assert found.zeta == pytest.approx(one.zeta, rel=0.05)


@pytest.mark.slow
def test_modes_of_two_directions_are_not_one_mode_in_two_set_ups(held):
    """A beam bends in both directions at nearly the same frequencies."""
    found = cf.identify(roving(4, 2, 1.0, response_direction=lambda part: 1 + part))
    assert len(found) == 8
    held(1e-4, **numbers_of_modes(found))
    assert found.sure.all()


@pytest.mark.slow
def test_intervals_of_orientations_keep_where_waves_finer_than_the_sensors_resolve_turn_them(held):
    """On 24 even sensors n = 20 and 28 resemble n = 4: the other waves show their size."""
    theta, rng = np.arange(24) * np.pi / 12, np.random.default_rng(2)
    order = np.setdiff1d(np.arange(2, 41), [4])
    finer = np.hstack([np.cos(np.outer(theta, order)), np.sin(np.outer(theta, order))])
    turn, freqs = rng.uniform(0.0, 45.0, 24), 200.0 * 1.02 ** np.arange(24)
    turn[1::2] = turn[::2] + 22.5
    shapes = [np.cos(4.0 * (theta - a)) + finer @ (0.02 * rng.normal(size=finer.shape[1])) for a in np.radians(turn)]
    poles = [(freq, 0.002, shape) for freq, shape in zip(freqs, shapes, strict=True)]
    found = cf.identify(
        receptances(np.arange(190.0, 330.0, 0.1), poles, 0.05), angles=dict(enumerate(np.degrees(theta)))
    )
    assert found.n.tolist() == [4] * 24
    held(1e-4, **numbers_of_modes(found))
    error = np.degrees(np.arcsin(np.sin(4.0 * np.radians(found.angle_deg - turn)))) / 4.0
    assert np.sum(np.abs(error) < 1.96 * found.sigma_angle) >= 21


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_strong_modes_just_beyond_the_band_do_not_move_those_inside(seed, held):
    """In a window of 30 Hz, peaks 8 Hz outside leave a residual that is not a parabola."""
    rng = np.random.default_rng(seed)
    inside = [(94.0, 0.01, rng.normal(size=8)), (96.0, 0.012, rng.normal(size=8)), (105.0, 0.01, rng.normal(size=8))]
    outside = [(77.0, 0.008, 20.0 * rng.normal(size=8)), (123.0, 0.008, 20.0 * rng.normal(size=8))]
    found = cf.identify(receptances(np.arange(85.0, 115.0, 0.05), [*inside, *outside], noise=0.2, seed=seed))
    np.testing.assert_allclose(found.freq, [freq for freq, _, _ in inside], atol=0.01)
    np.testing.assert_allclose(found.zeta, [zeta for _, zeta, _ in inside], rtol=0.02)
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.slow
@pytest.mark.parametrize("shift", [0.0, 1e-3])
def test_channels_are_of_two_set_ups_only_where_their_poles_are_shifted(shift, held):
    """Bandwidths are 4e-3. Each half of the channels also sees a local mode that the other half does not see."""
    freqs, rng = 300.0 * 1.03 ** np.arange(7), np.random.default_rng(11)
    halves = rng.uniform(0.5, 1.5, (7, 2, 8)) * rng.choice([-1.0, 1.0], (7, 2, 8))
    none, local = np.zeros(8), rng.uniform(0.5, 1.5, 8)
    poles = [(freq * (1.0 + 0.5 * shift), 2e-3, np.r_[half[0], none]) for freq, half in zip(freqs, halves, strict=True)]
    poles += [
        (freq * (1.0 - 0.5 * shift), 2e-3, np.r_[none, half[1]]) for freq, half in zip(freqs, halves, strict=True)
    ]
    poles += [(313.5, 2e-3, np.r_[local, none]), (332.6, 2e-3, np.r_[none, local])]
    found = cf.identify(receptances(np.arange(290.0, 370.0, 0.1), poles, noise=2e-2, seed=4))
    assert len(found) == 9
    held(1e-4, **numbers_of_modes(found))
    at = [int(np.argmin(np.abs(found.freq - freq))) for freq in freqs]
    np.testing.assert_allclose(found.freq[at], freqs, atol=0.01)
    np.testing.assert_allclose(found.zeta[at], 2e-3, rtol=0.02)
    assert found.shift == pytest.approx(shift / np.sqrt(2.0), rel=0.02)
    assert ("in 2 groups of channels" in " ".join(found.notes)) == (shift > 0.0)


@pytest.mark.slow
def test_channels_that_are_no_sensors_and_no_references_of_their_own_are_no_set_up():
    """Poles differ like the fields of a chess board of sensors and references: no measurement is made so."""
    sensors, references = np.divmod(np.arange(16), 2)
    field, freqs, rng = (sensors + references) % 2, [120.0, 131.0, 144.0, 158.0], np.random.default_rng(71)
    shapes = rng.uniform(0.4, 1.0, (16, 4)) * rng.choice([-1.0, 1.0], (16, 4))
    poles = [
        (freq * (0.9995 + 1e-3 * own), 2e-3, shapes[:, k] * (field == own))
        for k, freq in enumerate(freqs)
        for own in (0, 1)
    ]
    x, places = np.arange(115.0, 163.0, 0.1), {"response_point": sensors, "reference_point": 100 + references}
    found = cf.identify(receptances(x, poles, 0.3, **places))
    np.testing.assert_allclose(found.freq, freqs, rtol=2e-4)
    assert found.shift == 0.0
    assert not any("groups of channels" in note for note in found.notes)


@pytest.mark.slow
def test_two_references_that_each_drive_one_member_of_every_pair_are_one_set_up():
    """The other member is driven 1 deg from a node: 10 to 60 times less. At 13 sensors no two shapes are alike."""
    theta = np.arange(13) * 2.0 * np.pi / 13 + 0.05
    at = np.r_[theta, np.radians([1.0, 46.0])]
    orders = (2, 6, 10, 2, 6, 10, 3, 5)
    freqs = np.array([309.0 * 1.03**k * (1.0 + side) for k in range(8) for side in (-1e-3, 1e-3)])
    rows = np.array([np.cos(n * at - k * np.pi / 2) for n in orders for k in (0, 1)]).T
    probes = [cf.rig.Probe(k + 1, 1, (0.0, 0.0, 0.0), float(a)) for k, a in enumerate(at)]
    rig = cf.rig.Rig.of(omega=2 * np.pi * freqs, zeta=2e-3, rows=rows, probes=probes)
    frfs = cf.rig.noisy(rig.frfs(np.arange(295.0, 395.0, 0.1), sensors=range(13), drives=[13, 14]), 40.0, seed=3)
    found = cf.identify(frfs, angles={k + 1: float(np.degrees(a)) for k, a in enumerate(theta)})
    np.testing.assert_allclose(found.freq, freqs, atol=0.01)
    assert found.sure.all()
    assert found.shift == 0.0


@pytest.mark.parametrize("kind", ["constant", "spike", "huge", "tiny"])
def test_data_without_a_mode_have_no_sure_one(kind):
    x = np.arange(20.0, 80.0, 0.1)
    H = np.ones((3, len(x)), complex) * np.array([[1.0], [0.5j], [2.0]])
    if kind == "spike":
        H[:, 100] *= 1e6
    if kind in ("huge", "tiny"):
        H = H * {"huge": 1e100, "tiny": 1e-100}[kind]
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(3))
    found = cf.identify(frfs)
    assert not found.sure.any()
    assert all(np.isfinite(found.freq))


@pytest.mark.slow
@pytest.mark.parametrize(("alike", "sure"), [(0.8, [True, False]), (0.0, [True, True])])
def test_of_two_modes_within_half_a_bandwidth_whose_shapes_are_alike_the_weaker_one_is_doubtful(alike, sure, held):
    """A peak that moves from hit to hit leaves two poles of similar shape; normal modes differ in shape."""
    along = np.pi * np.linspace(0.05, 0.95, 8)
    one, other = np.sin(2.0 * along), np.sin(3.0 * along)
    weaker = 0.7 * (alike * one + np.sqrt(1.0 - alike**2) * other)
    x = np.arange(98.0, 102.0, 0.02)
    found = cf.identify(receptances(x, [(99.95, 2e-3, one), (100.07, 2e-3, weaker)], noise=0.1))
    assert found.freq == pytest.approx([99.95, 100.07], abs=0.01)
    assert found.sure.tolist() == sure
    held(1e-4, **numbers_of_modes(found))
