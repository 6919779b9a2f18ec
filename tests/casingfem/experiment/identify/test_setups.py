"""Set-ups with peaks of their own, modes matched between them, and a window that leaks."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.identify import identification
from casingfem.experiment.identify.poles.pole_fit import fit_poles
from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.grouping import find_setups, matched, matching_sigma
from casingfem.experiment.identify.setups.own_shifts import Modes, OwnPeaks
from casingfem.experiment.identify.setups.shifted import Shifted
from casingfem.experiment.identify.verdict import verdicts
from casingfem.experiment.rig.troubles import Troubles, hann_power, troubled_frfs
from tests.casingfem.experiment.identify.test_identification import numeric

GROUPS = [np.array([0, 1, 4]), np.array([2, 5]), np.array([3, 6, 7])]
SIGMA = 1e-5


def peaks(logs, zeta, rng):
    """Modes (modes, set-ups) with frequencies off by `logs`, as fits of one channel each give them."""
    m, count = logs.shape
    noise = SIGMA * rng.standard_normal((2, m, count))
    freq = np.linspace(300.0, 400.0, m)[:, None] * np.exp(logs + noise[0])
    ones = np.ones((m, count))
    return OwnPeaks(freq, zeta[:, None] * np.exp(100 * noise[1]), SIGMA**2 * ones, 1e-6 * ones, ones + 0j, 0.0)


def test_channels_whose_peaks_agree_are_one_setup_and_a_dead_one_is_anywhere():
    rng = np.random.default_rng(17)
    shift, where = 1e-3 * rng.standard_normal((10, 3)), np.zeros(8, int)
    for k, channels in enumerate(GROUPS):
        where[channels] = k
    own = peaks(shift[:, where], np.full(10, 2e-3), rng)
    found = find_setups([own], np.ones(8, bool))
    assert sorted(map(tuple, found)) == sorted(map(tuple, GROUPS))
    alive = np.ones(8, bool)
    alive[4] = False
    assert sorted(len(channels) for channels in find_setups([own], alive)) == [2, 2, 4]
    few = OwnPeaks(*(part[:2] for part in own[:5]), 0.0)  # two modes tell nothing of that kind
    assert len(find_setups([few], np.ones(8, bool))) == 8


def test_modes_that_cross_are_matched_by_their_damping_and_doubted_without():
    rng = np.random.default_rng(19)
    setups = [np.array([k]) for k in range(3)]
    logs = np.array([[0.0, 1.0, 0.2], [0.4, 0.3, 0.9]]) * 1e-3
    for zeta, sure in (((1e-3, 1.3e-3), True), ((1e-3, 1e-3), False)):
        own = peaks(logs, np.array(zeta), rng)
        own = own._replace(freq=350.0 * np.exp(logs))
        rows = [np.array([0, 1]), np.array([1, 0]), np.array([0, 1])]
        found = matched(own.ordered(rows, setups), setups, 5e-4)
        by_freq, by_zeta = matching_sigma(found, setups, 5e-4)
        if sure:
            np.testing.assert_allclose(np.sort(np.log(found.freq / 350.0), axis=0), np.sort(logs, axis=0), atol=1e-9)
            assert np.log(found.freq[:, 1] / 350.0) @ [1, -1] == pytest.approx(
                0.7e-3 * np.sign(found.zeta[1, 0] - found.zeta[0, 0]), abs=1e-9
            )
            assert by_freq.max() < 1e-6
            assert by_zeta.max() < 1e-3
        else:
            assert by_freq.min() > 2e-5


def test_a_mode_that_few_setups_show_is_not_sure():
    residues = np.array([[1.0, 1.0, 1.0, 1.0], [0.0, 0.0, 1.0, 0.0]], complex)
    modes = Modes(np.full((2, 4), 100.0), np.full(2, 4e-3), residues)
    nothing = np.zeros(2)
    found = Shifted(
        modes, np.zeros((2, 4)), nothing, nothing, nothing, [np.array([k]) for k in range(4)], 0.0, 1e-3, 1.0
    )
    np.testing.assert_allclose(found.seen(), [1.0, 0.25])
    lines = np.arange(95.0, 105.0, 0.05)
    H = 100.0**2 / (100.0**2 - lines**2 + 2j * 4e-3 * 100.0 * lines)
    H = H[:, None] * np.ones(8) + 0.05 * np.random.default_rng(53).standard_normal((len(lines), 8))
    stacked = np.concatenate([H.real, H.imag])
    window = Window(freq=lines, Y=stacked, power=0, residues="real", weight=np.ones(8), floor=0.0, along=np.ones(200))
    fit = fit_poles(window, np.array([100.0]), np.array([4e-3]))
    (sure,), (doubtful,) = (verdicts(replace(fit, seen=share), [1.0]) for share in (np.ones(1), found.seen()[1:]))
    assert sure == ("", False)
    assert doubtful[0].startswith("seen in 25 % of the set-ups")


@pytest.mark.slow
def test_a_window_that_leaks_does_not_damp():
    """Responses smoothed by a Hann window's power spectrum, bandwidths of six lines and three."""
    lines, step = np.arange(90.0, 130.0, 0.1), 0.1
    shape = np.array([1.0, -0.6, 0.8, 0.4, -0.9, 0.7])[:, None]

    def clean(f):
        return sum(
            shape**k * f0**2 / (f0**2 - f**2 + 2j * z * f0 * f) for k, f0, z in ((1, 100.0, 3e-3), (2, 118.0, 1.3e-3))
        )

    x = np.arange(-1.75, 1.8, 0.25)
    leaked = sum(w * clean(lines + by * step) for w, by in zip(hann_power(x), x, strict=True))
    rng = np.random.default_rng(23)
    for H, noted in ((clean(lines), False), (leaked, True)):
        noise = 0.002 * np.abs(H).max() * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
        frfs = cf.frf.FrfSet.from_arrays(
            kind="frf", x=lines, responses=H + noise, unit="m/N", response_point=range(len(shape))
        )
        found = cf.identify(frfs)
        assert any("Hann" in note for note in found.notes) == noted
        np.testing.assert_allclose(found.zeta, [3e-3, 1.3e-3], rtol=0.01)


@pytest.mark.slow
def test_rounded_lines_are_even_and_what_one_channel_hardly_shows_is_not_sure():
    rng = np.random.default_rng(37)
    lines = np.arange(90.0, 130.0, 0.1)
    H = sum(a * f0**2 / (f0**2 - lines**2 + 2j * 3e-3 * f0 * lines) for a, f0 in ((1.0, 100.0), (0.02, 118.0)))
    H = H + 0.4 * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    rounded = lines + 0.002 * rng.uniform(-1.0, 1.0, len(lines))
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=rounded, responses=H[None], unit="m/N", response_point=[1])
    found = cf.identify(frfs)
    assert found.freq.round(1).tolist() == [100.0, 118.0]
    assert found.sure.tolist() == [True, False]
    assert "in 1 channel" in found.doubts[1]


@pytest.fixture(scope="module")
def three_setups():
    """Two pairs and a mode as three set-ups see them; the damping of their rig; what is found."""
    zeta, freq = np.array([2e-3, 2.2e-3, 1.5e-3, 1.4e-3, 3e-3]), np.array([200.0, 200.9, 212.0, 213.5, 225.0])
    around = 2 * np.pi * np.arange(13) / 13
    waves = zip((2, 2, 3, 3, 4), (0.3, 0.3 + np.pi / 2, 1.0, 1.0 + np.pi / 2, 0.5), strict=True)
    rig = cf.rig.Rig.of(
        omega=2 * np.pi * freq, zeta=zeta, rows=np.array([np.cos(n * around - turn) for n, turn in waves]).T
    )
    what = Troubles(snr_db=45.0, setups=3, shift=2e-3, leakage=True)
    test = troubled_frfs(rig, np.arange(192.0, 233.0, 0.1), what, sensors=range(12), drives=[12], seed=29)
    return test, zeta, cf.identify(test.frfs)


@pytest.mark.slow
def test_processes_share_a_test_and_find_the_same(three_setups, monkeypatch):
    test, _, alone = three_setups
    said = list[str]()
    monkeypatch.setattr(identification, "LARGE", 0)
    shared = cf.identify(test.frfs, processes=2, say=said.append)
    np.testing.assert_equal(numeric(shared), numeric(alone))
    np.testing.assert_array_equal(shared.shapes, alone.shapes)
    bands = said.index("set-ups") - 1
    assert said[: bands + 1] == [f"poles: {k} of {bands} bands done" for k in range(bands + 1)]


@pytest.mark.slow
def test_pairs_that_three_setups_show_elsewhere_are_found_once_with_honest_intervals(three_setups, held):
    test, zeta, found = three_setups
    held(1e-4, **numeric(found))
    assert len(found) == 5
    assert found.sure.all()
    np.testing.assert_allclose(found.freq, test.truth.freq.mean(axis=0), rtol=5e-5)
    np.testing.assert_allclose(found.zeta, zeta, rtol=0.02)
    assert np.all(np.abs(found.freq - test.truth.freq.mean(axis=0)) < 4.0 * found.sigma_freq)
    assert np.all(np.abs(found.freq - test.truth.freq) < 4.0 * found.sigma_setup)  # what each set-up shows
    np.testing.assert_array_equal(found.table().sigma_hz, found.sigma_setup)
    assert [row["sigma_mean_hz"] for row in found.records()] == found.sigma_freq.tolist()
