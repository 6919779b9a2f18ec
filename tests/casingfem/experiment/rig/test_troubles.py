"""A bench with troubles: each does what its truth says."""

import numpy as np
import pytest

import casingfem as cf

SEED = 9103
X = np.arange(80.0, 160.0, 0.25)
QUIET = 200.0  # dB: as good as no noise


def rig():
    at = np.r_[2.0 * np.pi * np.arange(8) / 8, 0.4]
    rows = np.stack([np.cos(2 * at), np.sin(2 * at), np.cos(3 * at)], axis=1)
    probes = [cf.rig.Probe(k + 1, 1, (0.0, 0.0, 0.0), float(a)) for k, a in enumerate(at)]
    return cf.rig.Rig.of(omega=2 * np.pi * np.array([100.0, 104.0, 130.0]), zeta=0.004, rows=rows, probes=probes)


def made(**troubles):
    return cf.rig.troubled_frfs(
        rig(), X, cf.rig.Troubles(**{"snr_db": QUIET, **troubles}), sensors=range(8), drives=[8], seed=SEED
    )


EXACT = rig().frfs(X, sensors=range(8), drives=[8]).responses


def off(H, reference=EXACT):
    return np.abs(H - reference).max(axis=1) / np.abs(reference).max(axis=1)


def test_without_troubles_it_is_the_bench():
    assert off(made().frfs.responses).max() < 1e-8
    assert made().coherence.responses.real.min() > 1.0 - 1e-9
    assert made().frfs.card[0].startswith("SYNTHETIC")


def test_each_set_up_has_poles_of_its_own():
    test = made(setups=2, shift=0.01)
    assert test.truth.setup.tolist() == [0] * 4 + [1] * 4
    for k in range(2):
        shifted = cf.rig.Rig.of(omega=2 * np.pi * np.sort(test.truth.freq[k]), zeta=0.004, rows=rig().rows)
        own = shifted.frfs(X, sensors=range(8), drives=[8]).responses
        here = test.truth.setup == k
        assert off(test.frfs.responses[here], own[here]).max() < 1e-7
    assert 0.0 < np.abs(test.truth.freq / rig().freq - 1.0).max() <= 0.01


def test_an_exponential_window_adds_its_damping():
    test = made(exponential=0.5)
    added = 1.0 / 0.5 / (2 * np.pi * rig().freq)
    np.testing.assert_allclose(test.truth.zeta[0], 0.004 + added, rtol=1e-3)
    widened = cf.rig.Rig.of(omega=2 * np.pi * test.truth.freq[0], zeta=test.truth.zeta[0], rows=rig().rows)
    like = widened.frfs(X, sensors=range(8), drives=[8]).responses
    assert off(test.frfs.responses, like).max() < 0.02 < 0.2 < off(test.frfs.responses).max()


def test_leakage_lowers_peaks_by_what_the_window_takes():
    sharp, blunt = (np.abs(made(leakage=on).frfs.responses).max() for on in (False, True))
    assert 0.6 < blunt / sharp < 0.95


def test_spoilt_channels_are_those_of_the_truth():
    test = made(dead=1, flipped=1, swapped=1)
    H, (a, b) = test.frfs.responses, test.truth.swapped[0]
    (dead,), (flipped,) = test.truth.dead, test.truth.flipped
    assert np.abs(H[dead]).max() < 1e-6 * np.abs(EXACT[dead]).max()
    assert off(-H[[flipped]], EXACT[[flipped]]).max() < 1e-8
    assert off(H[[a, b]], EXACT[[b, a]]).max() < 1e-8
    assert np.sum(off(H) > 1e-6) == 4
    assert test.truth.records()["dead"] == [dead + 1]


def test_noise_has_its_size_colour_and_common_part():
    test = made(snr_db=20.0, colour=2.0, coherent=0.8, noisy=1)
    noise = test.frfs.responses - EXACT
    ratio = np.linalg.norm(noise, axis=1) / np.linalg.norm(EXACT, axis=1)
    (loud,) = test.truth.noisy
    others = np.delete(np.arange(8), loud)
    assert np.all((ratio[others] > 0.08) & (ratio[others] < 0.15))
    assert ratio[loud] > 5 * ratio[others].max()
    ends = np.abs(noise[others][:, :80]).mean() / np.abs(noise[others][:, -80:]).mean()
    assert ends == pytest.approx((90.0 / 150.0) ** -2, rel=0.25)
    alike = np.abs(np.corrcoef(noise[others]))[np.triu_indices(7, 1)]
    assert 0.6 < np.median(alike) < 0.95
    assert test.coherence.responses.real.min() < 0.5


def test_a_local_mode_is_seen_by_three_neighbours_at_half_its_size():
    local = made(fixture=1)
    near = np.flatnonzero(off(local.frfs.responses) > 1e-6)
    added = np.abs(local.frfs.responses - EXACT).max(axis=1)[near]
    assert sorted(np.diff(sorted(near)).tolist())[0] == 1
    np.testing.assert_allclose(np.sort(added) / added.max(), [0.5, 0.5, 1.0], rtol=1e-4)
    half = 0.1 * np.ptp(X)
    assert X[0] + half < local.truth.fixture_hz[0] < X[-1] - half


def test_a_second_hit_has_lines_where_the_noise_rises_and_coherence_falls():
    one, two = (made(snr_db=20.0, double_hit=hit) for hit in (0.0, 0.9))
    worse = np.mean(two.coherence.responses.real - one.coherence.responses.real, axis=0)
    assert worse.min() < -0.2 < 0.0 < worse.max()


def test_half_a_rim_local_modes_and_phases():
    assert len(made(half_rim=True).frfs) == 4
    local = made(fixture=1)
    assert np.sum(off(local.frfs.responses) > 1e-6) == 3
    line = np.argmin(np.abs(X - local.truth.fixture_hz[0]))
    added = np.abs(local.frfs.responses - EXACT)
    assert abs(int(added.sum(axis=0).argmax()) - line) <= 3
    turned = made(phase_deg=20.0)
    assert 0.05 < off(turned.frfs.responses).max() < 1.5


@pytest.mark.parametrize("wrong", [{"coherent": 1.5}, {"shift": -0.1}, {"setups": 0}, {"double_hit": 1.0}])
def test_refuses_troubles_out_of_range(wrong):
    with pytest.raises(cf.errors.InputError, match=next(iter(wrong))):
        cf.rig.Troubles(**wrong)


def test_some_channels_are_left_alive():
    channels = len(EXACT)
    assert len(made(dead=channels - 1).frfs) == channels
    with pytest.raises(
        cf.errors.InputError, match=f"troubles.dead: found {channels}; expected less than the {channels}"
    ):
        made(dead=channels)
