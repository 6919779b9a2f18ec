"""What the fits of bands hand on to each other, how often each is fitted, and what is said meanwhile."""

from dataclasses import replace

import numpy as np
import pytest

from casingfem.experiment.identify import band_fits
from casingfem.experiment.identify.band_fits import Responses, _modes, _of_band, _window, fit_bands
from casingfem.experiment.identify.poles.bands import Band
from casingfem.experiment.identify.poles.pole_fit import fit_poles
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.shifted import Shifted

LINES = np.arange(90.0, 112.0, 0.05)
BAND = Band((0, len(LINES)), (0, len(LINES)), 2)


def responses(residues):
    """Accelerances of two modes in three channels, noise of 1e-9, (channels, lines)."""
    freq, zeta = np.array([98.0, 103.0]), np.array([3e-3, 4e-3])
    each = freq**2 / (freq**2 - LINES[:, None] ** 2 + 2j * zeta * freq * LINES[:, None])
    H = (1j * LINES[:, None]) ** 2 * (each @ residues)
    return Responses(LINES, H.T, np.full(residues.shape[1], 1e-9), 2, np.ones(len(LINES)))


@pytest.mark.parametrize("lag", [0.0, 0.2])
def test_modes_of_a_fit_respond_as_the_data_do(lag):
    residues = np.array([[1.0, -0.5, 0.3], [0.2, 0.8, -0.6]]) * np.exp(1j * lag * np.array([[1.0, -2.0, 3.0]]))
    data = responses(residues)
    window = _window(data, BAND)
    assert window.columns == 1
    fitted = replace(window, residues="complex" if lag else "real")
    fit = fit_poles(fitted, np.array([98.0, 103.0]), np.array([3e-3, 4e-3]))
    found = _modes(data, [BAND], [fit])
    np.testing.assert_allclose(found.residues, residues, atol=1e-6)
    np.testing.assert_allclose(found.response(window, [np.arange(3)]), window.as_complex, atol=1e-6 * window.Y.max())


def test_a_band_by_its_own_lines_has_the_same_window():
    data = responses(np.array([[1.0, -0.5, 0.3], [0.2, 0.8, -0.6]]))
    band = Band((120, 300), (80, 360), 1)
    there, own = _of_band(data, band)
    assert (own.core, own.window, own.peaks) == ((40, 220), (0, 280), 1)
    whole, part = _window(data, band), _window(there, own)
    np.testing.assert_array_equal(part.Y, whole.Y)
    np.testing.assert_array_equal(part.freq[slice(*own.core)], LINES[slice(*band.core)])


WIDE = np.arange(90.0, 150.0, 0.25)
FREQ, ZETA = np.array([98.0, 103.0, 146.0]), np.array([5e-3, 6e-3, 4e-3])
BANDS = [Band((0, 100), (0, 120), 2), Band((100, 170), (80, 200), 0), Band((170, 240), (160, 240), 1)]


def three_modes():
    """Three modes in three channels, the third of them in the last band."""
    rng = np.random.default_rng(11)
    each = FREQ**2 / (FREQ**2 - WIDE[:, None] ** 2 + 2j * ZETA * FREQ * WIDE[:, None])
    shapes = np.array([[1.0, -0.5, 0.3], [0.2, 0.8, -0.6], [0.7, 0.4, -0.9]])
    H = each @ shapes
    H = H + 0.05 * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    return Responses(WIDE, H.T, np.full(3, 0.05), 0, np.ones(len(WIDE)))


class Rounds:
    """All that is asked for on the way; the stable poles are given, and what set-ups the modes are found to have."""

    def __init__(self, monkeypatch, several=False, last="real"):
        self.said, self.selected, self.shifts, self.aligned = [], [], [], []

        def sweep(data, band, order):
            at = (FREQ > data.freq[0]) & (FREQ < data.freq[-1])
            return f"diagram {data.freq[0]:g}, {order}", np.column_stack([FREQ[at], ZETA[at]])

        def selecting(window, starts, search):
            self.selected.append((window, np.array(starts), search))
            kind = last if len(starts) and starts[0, 0] > 130.0 else "real"
            return fit_poles(replace(window, residues=kind), *np.reshape(starts, (-1, 2)).T, steps=0)

        def shifted(whole, modes, places, each):
            self.shifts.append((whole, modes, places, each))
            nothing = np.zeros(len(modes.zeta))
            setups = [np.array([0, 2]), np.array([1])] if several else [np.arange(3)]
            evidence = 5.0 if several else -5.0
            return Shifted(modes, nothing[:, None], nothing, nothing, nothing, setups, 1e-6, 1e-3, evidence)

        def aligned(data, bands, found, whole):
            self.aligned.append((data, bands, found, whole))
            return ["aligned"]

        for name, fake in (("_sweep", sweep), ("select_poles", selecting), ("shifted", shifted),
                           ("as_waves", lambda found, whole, places, each: found._replace(shift=2e-3)),
                           ("_aligned_fits", aligned)):  # fmt: skip
            monkeypatch.setattr(band_fits, name, fake)

    def run(self, data, picked=None, bands=BANDS):
        return fit_bands(data, bands, 7, picked, self.said.append)


FIRST = [f"poles: {k} of 3 bands done" for k in range(4)]


def test_bands_with_peaks_are_fitted_first_then_all_of_them_twice(monkeypatch):
    rounds, data = Rounds(monkeypatch), three_modes()
    found = rounds.run(data)
    again = [f"fit {n} of 3, band {k} of 3" for n in (2, 3) for k in (1, 2, 3)]
    assert rounds.said == [*FIRST, "set-ups", *again]
    assert [len(window.freq) for window, *_ in rounds.selected] == [120, 80, *[120, 120, 80] * 2]
    assert all(search for *_, search in rounds.selected)
    starts = [start for _, start, _ in rounds.selected]
    np.testing.assert_array_equal(starts[0], np.column_stack([FREQ[:2], ZETA[:2]]))
    assert [len(start) for start in starts] == [2, 1, 2, 0, 1, 2, 0, 1]
    np.testing.assert_allclose(np.vstack(starts[5:]), np.column_stack([FREQ, ZETA]), rtol=1e-12)
    assert [len(fit.freq) for fit in found.fits] == [2, 0, 1]
    assert found.diagrams == ["diagram 90, 7", "diagram 110, 7", "diagram 130, 7"]
    assert (found.shift, found.leak, found.belongs, found.bands) == (0.0, 1e-6, None, BANDS)
    assert [window.leak for window, *_ in rounds.selected] == [0.0, 0.0, *[1e-6] * 6]
    for window, start, _ in rounds.selected[5:]:  # without modes outside nothing but noise is left beside the own
        values = window.values(start[:, 0], start[:, 1]) if len(start) else np.zeros((len(window.freq), 0))
        terms = np.hstack([values, window.polynomials()])
        rest = window.as_complex - terms @ np.linalg.lstsq(terms, window.as_complex, rcond=None)[0]
        assert np.std(rest) < 2.0


def test_set_ups_are_looked_for_among_all_modes_on_all_lines(monkeypatch):
    for kind in ("real", "complex"):  # as one of the bands has them
        rounds, data = Rounds(monkeypatch, last=kind), three_modes()._replace(places="places")
        rounds.run(data)
        ((whole, modes, places, each),) = rounds.shifts
        assert (whole.residues, places, each) == (kind, "places", map)
        np.testing.assert_array_equal(whole.freq, WIDE)
        np.testing.assert_allclose(whole.as_complex, data.H.T / 0.05, rtol=1e-13)
        assert isinstance(modes, Modes)
        np.testing.assert_allclose(np.sort(modes.freq[:, 0]), FREQ, rtol=1e-4)


def test_a_test_of_several_set_ups_is_read_as_waves_and_aligned(monkeypatch):
    rounds, data = Rounds(monkeypatch, several=True), three_modes()
    found = rounds.run(data)
    assert rounds.said == [*FIRST, "set-ups", "waves round the circle"]
    ((given, bands, seen, whole),) = rounds.aligned
    assert (given.leak, bands, seen.shift) == (1e-6, BANDS, 2e-3)
    np.testing.assert_array_equal(whole.freq, WIDE)
    assert (found.fits, found.shift, found.leak, found.belongs) == (["aligned"], 2e-3, 1e-6, None)
    assert len(found.diagrams) == 3


def test_picked_poles_are_all_kept_and_of_one_set_up(monkeypatch):
    rounds, data = Rounds(monkeypatch, several=True), three_modes()
    found = rounds.run(data, np.array([98.2, 103.1, 120.0, 146.0]))
    assert "waves round the circle" not in rounds.said
    assert not any(search for *_, search in rounds.selected)
    np.testing.assert_allclose(rounds.selected[0][1], np.column_stack([[98.2, 103.1], ZETA[:2]]), rtol=1e-12)
    assert [len(fit.freq) for fit in found.fits] == [2, 0, 1]
    assert (found.leak, found.shift) == (1e-6, 0.0)


def test_without_a_peak_no_set_ups_are_looked_for(monkeypatch):
    rounds = Rounds(monkeypatch)
    flat = three_modes()._replace(H=0.05 * np.exp(2j * np.pi * np.random.default_rng(2).random((3, len(WIDE)))))
    found = rounds.run(flat, bands=[BANDS[1]])
    assert rounds.said == [
        "poles: 0 of 1 bands done",
        "poles: 1 of 1 bands done",
        "fit 2 of 3, band 1 of 1",
        "fit 3 of 3, band 1 of 1",
    ]
    assert not rounds.shifts
    assert (found.leak, len(found.fits)) == (0.0, 1)
    silent = Rounds(monkeypatch)
    fit_bands(flat, [BANDS[1]], None)
    assert not silent.said
