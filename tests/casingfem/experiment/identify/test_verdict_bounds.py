"""Limits of what makes a mode doubtful or none, both sides of each, on made-up fits with one pole or two."""

from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.experiment.identify import verdict
from casingfem.experiment.identify.poles.pole_selection import (
    alike_lines,
    cut_off,
    lines_high,
    lines_of,
    near,
    noise_at,
    penalty,
)

SURE = {
    "freq": 1e-9, "damping": 1e-9, "cut": 0.0, "lines": 5.0, "zeta": 0.01, "worth": 99.0, "ratio": 9.0, "phase": 1.0,
    "seen": 1.0, "channels": 8, "alike": 8, "skirts": True, "high": 1,
}  # fmt: skip


def reasons(monkeypatch, **changes):
    """Of one pole at 120 Hz in a window about 100 Hz; `ratio` is its peak over the noise, `alike` channels see it."""
    told = SURE | changes
    window = SimpleNamespace(scale=100.0, power=2)
    zeta, lines = told["zeta"], told["lines"]
    size = np.zeros(told["channels"])
    size[: told["alike"]] = np.sqrt(told["channels"] / told["alike"])
    sigma = np.array([told["freq"] * 2.0 * zeta / min(lines, 1.0), told["damping"]])
    fit = SimpleNamespace(
        freq=np.array([120.0]), zeta=np.array([zeta]), noise=4.0, covariance=np.diag(sigma**2) / 4.0, window=window,
        A=np.stack([0.6 * size, 0.8 * size])[None], seen=np.array([told["seen"]]),
    )  # fmt: skip
    stubs = {
        "lines_of": np.array([lines]), "cut_off": (0.0, told["cut"] * zeta), "has_skirts": told["skirts"],
        "lines_high": told["high"],
        "noise_at": 0.5 * (1.2**2 / (2.0 * zeta) / told["ratio"]) ** 2,
    }  # fmt: skip
    for name, value in stubs.items():
        monkeypatch.setattr(verdict, name, lambda *_, value=value: value)
    return list(verdict._reasons(fit, 0, told["worth"], told["phase"]))


def test_a_sure_mode_has_no_reasons(monkeypatch):
    assert reasons(monkeypatch) == []


@pytest.mark.parametrize(
    ("name", "doubtful", "sure", "out", "words"),
    [
        ("freq", 0.101, 0.099, None, "frequency uncertain by 0.1 of its bandwidth"),
        ("freq", 0.501, 0.499, True, "frequency uncertain by 0.5 of its bandwidth"),
        ("damping", 0.081, 0.079, None, "damping uncertain by 8 %"),
        ("damping", 0.601, 0.599, True, "damping uncertain by 60 %"),
        ("cut", 0.081, 0.079, None, "damping uncertain by 8 %"),
        ("zeta", 0.0601, 0.0599, None, "damping of 6 %"),
        ("zeta", 0.301, 0.299, True, "damping of 30 %"),
        ("worth", 2.99, 3.01, None, "hardly above what the fit leaves"),
        ("ratio", 2.99, 3.01, None, "peak 3 times what the fit leaves there"),
        ("ratio", 0.499, 0.501, True, "peak 0.5 times what the fit leaves there"),
        ("phase", 0.599, 0.601, None, "only 60 % of its shape in phase"),
        ("seen", 0.299, 0.301, None, "seen in 30 % of the set-ups"),
    ],
)
def test_both_sides_of_each_limit(monkeypatch, name, doubtful, sure, out, words):
    """`out`: whether the limit is that of being left out, beyond that of being doubtful."""
    ((text, left_out),) = reasons(monkeypatch, **{name: doubtful})
    assert text.startswith(words)
    assert left_out == bool(out)
    inside = reasons(monkeypatch, **{name: sure})
    assert [flag for _, flag in inside] == ([False] if out else [])


def test_of_few_channels_a_peak_must_be_higher(monkeypatch):
    """Six confirm each other; of two it must be three times as high."""
    few = {"channels": 2, "alike": 2}
    assert reasons(monkeypatch, ratio=9.01, **few) == []
    ((text, out),) = reasons(monkeypatch, ratio=8.99, **few)
    assert (text, out) == ("peak 9 times what the fit leaves there, in 2 channels: 9 are asked for", False)
    assert reasons(monkeypatch, ratio=2.9, **few)[0][0] == "peak 2.9 times what the fit leaves there"
    assert reasons(monkeypatch, ratio=9.0, channels=1, alike=1)[0][0].endswith(" in 1 channel: 18 are asked for")


def test_local_modes_are_told_from_eight_channels_on(monkeypatch):
    ((text, out),) = reasons(monkeypatch, channels=9, alike=1)
    assert (text, out) == ("seen by 1 of 9 channels: local, of a fixture?", False)
    assert reasons(monkeypatch, channels=8, alike=1) == []  # 0.125 of them
    assert not any("local" in text for text, _ in reasons(monkeypatch, channels=7, alike=1))


def test_peaks_narrower_than_the_lines(monkeypatch):
    assert reasons(monkeypatch, lines=1.0) == []
    ((text, out),) = reasons(monkeypatch, lines=0.99, damping=0.1)
    assert (text, out) == ("damping: narrower than the lines (0.99), below 1.2 %", False)
    ((text, out),) = reasons(monkeypatch, lines=0.99, skirts=False)
    assert (text, out) == ("bandwidth of 0.99 lines, no skirts beyond the nearest: hum?", True)
    assert reasons(monkeypatch, lines=0.99, damping=0.1, high=2)[0][0].startswith("damping: narrower than the lines")
    ((text, out),) = reasons(monkeypatch, lines=0.1, high=3)
    assert (text, out) == (
        "damping: 3 lines have half the peak's power, one explains it best: noise on the peak?",
        False,
    )
    assert reasons(monkeypatch, lines=0.5, freq=0.11)[0] == ("frequency uncertain by 0.11 of a line", False)


def beside(monkeypatch, *, away=1.0, mac=1.0, channels=8, size=0.15, misfit=1.0, zeta=0.01, complex_residues=True):
    """A pole at 100 Hz and a stronger neighbour, `away` bandwidths above, `size` times as high a peak."""
    first = np.zeros(channels)
    first[0] = 1.0
    other = np.zeros(channels)
    other[0], other[1] = np.sqrt(mac), np.sqrt(1.0 - mac)
    freq = 100.0
    for _ in range(60):  # away = (f - 100)/(2 sqrt(zeta 100 zeta f))
        freq = 100.0 + away * 2.0 * np.sqrt(0.01 * 100.0 * zeta * freq)
    A = np.stack([first * size * 0.01 / zeta, other])
    A = np.stack([0.6 * A, 0.8 * A], axis=1) if complex_residues else A[:, None]
    fit = SimpleNamespace(
        freq=np.array([100.0, freq]), zeta=np.array([0.01, zeta]), A=A, window=SimpleNamespace(weight=np.ones(channels))
    )
    monkeypatch.setattr(verdict, "_misfit", lambda *_: misfit)
    return list(verdict._beside(fit, 0))


@pytest.mark.parametrize(("own", "matching"), [(1.6e-4, 0.0), (0.0, 1.6e-4), (1.14e-4, 1.14e-4)])
def test_a_frequency_that_a_close_neighbour_leaves_uncertain(own, matching):
    def told(gap, share=1.0):
        fit = SimpleNamespace(
            freq=np.array([100.0, 100.0 + 2.0 * gap]), zeta=np.array([0.01, 0.01]), noise=4.0,
            covariance=(share * own) ** 2 / 4.0 * np.eye(4), matching=share * np.array([matching, matching]),
            rival=np.zeros(2),
        )  # fmt: skip
        return list(verdict._close(fit, 0))

    ((text, out),) = told(0.3)
    assert text == "frequency uncertain by 0.016 %: the next mode is 0.3 bandwidths away"
    assert not out
    assert told(1.1) == []
    assert told(0.3, share=0.9) == []


def test_a_frequency_that_another_reading_has_elsewhere():
    def told(rival):
        fit = SimpleNamespace(
            freq=np.array([100.0, 140.0]), zeta=np.array([0.01, 0.01]), noise=4.0, covariance=1e-12 * np.eye(4),
            matching=np.zeros(2), rival=np.array([rival, 0.0]),
        )  # fmt: skip
        return list(verdict._close(fit, 0))

    assert told(1.9e-4) == []
    assert told(3.1e-4) == [("frequency: the set-ups can nearly as well be read 0.031 % off", False)]


@pytest.mark.parametrize("complex_residues", [True, False])
def test_a_peak_beside_a_stronger_one_of_its_shape(monkeypatch, complex_residues):
    given = {"complex_residues": complex_residues}
    ((text, out),) = beside(monkeypatch, away=2.99, mac=0.81, **given)
    assert text.startswith("3.0 bandwidths from the stronger mode at 106.")
    assert text.endswith("of the same shape: one mode?")
    assert not out
    assert beside(monkeypatch, away=3.01, mac=0.81, **given) == []
    assert beside(monkeypatch, away=2.99, mac=0.79, **given) == []
    assert beside(monkeypatch, away=2.99, mac=0.81, size=0.17, **given) == []  # above its skirt, 1/6.06 of its peak
    assert beside(monkeypatch, away=0.51, mac=0.81, size=0.8, **given) == []
    assert beside(monkeypatch, away=0.49, mac=0.81, size=0.99, **given) != []
    assert beside(monkeypatch, away=0.49, mac=0.81, size=1.01, **given) == []
    assert "too few channels to tell" in beside(monkeypatch, away=2.99, mac=0.0, channels=5, **given)[0][0]
    assert beside(monkeypatch, away=2.99, mac=0.0, channels=6, **given) == []
    assert beside(monkeypatch, away=0.5, zeta=0.0599, size=0.1, **given) != []
    assert beside(monkeypatch, away=0.5, zeta=0.0601, size=0.1, **given) == []  # broad: no peak that hides others


def test_a_peak_where_the_fit_leaves_more_than_noise(monkeypatch):
    given = {"away": 5.9, "mac": 0.0, "size": 0.69}
    ((text, out),) = beside(monkeypatch, misfit=3.24, **given)
    assert text.startswith("beside the stronger mode at 112.")
    assert text.endswith("where the fit leaves 1.8 times the noise")
    assert not out
    for changes in ({"misfit": 2.99}, {"away": 6.1}, {"size": 0.71}):
        assert beside(monkeypatch, **{"misfit": 3.24} | given | changes) == []


def noisy(spread, *, zeta=0.01, freq=50.0, noise=1e-9, step=1.0):
    lines = step * np.arange(len(spread))
    window = SimpleNamespace(
        freq=lines,
        Y=np.zeros((2 * len(spread), spread.shape[1])),
        columns=2,
        floor=0.0,
        power=0,
        scale=1.0,
        as_complex=(lines == 50.0 * step)[:, None] * np.ones(spread.shape, complex),
    )
    return SimpleNamespace(spread=spread, freq=np.array([freq]), zeta=np.array([zeta]), noise=noise, window=window)


def test_deviation_about_a_pole():
    """Twelve lines on either side, more about a broad pole; noise is half of its mean square at least."""
    spread = np.arange(100.0)[:, None] * np.ones((1, 2)) * (1 + 0j)
    assert near(noisy(spread), 0)[:, 0].real.tolist() == list(range(38, 62))
    assert near(noisy(spread, zeta=0.06), 0)[[0, -1], 0].real.tolist() == [35.0, 64.0]  # 5 half-widths of 3 lines
    assert near(noisy(spread, freq=5.0), 0)[[0, -1], 0].real.tolist() == [0.0, 16.0]
    flat = np.full((100, 2), 3.0 + 4.0j)
    assert noise_at(noisy(flat), 0) == pytest.approx(12.5)
    assert noise_at(noisy(flat, noise=13.0), 0) == 13.0
    assert lines_of(noisy(flat, zeta=0.03, step=0.5)).tolist() == pytest.approx([6.0])
    assert penalty(noisy(flat).window) == pytest.approx((2 * 2 + 2) * np.log(400.0))


def test_lines_over_which_a_deviation_is_alike():
    """1 + 2 sum (1 - l/L) rho_l: of a constant, rho_l = (N - l)/N; of alternating signs no less than 1."""
    flat = np.ones((100, 1), complex)
    fit = noisy(flat, zeta=0.05)  # five lines in the half-power bandwidth, 24 about the pole
    exact = 1.0 + 2.0 * sum((1.0 - lag / 5.0) * (1.0 - lag / 24.0) for lag in range(1, 5))
    assert alike_lines(fit, 0) == pytest.approx(exact)
    assert alike_lines(noisy(flat * (-1.0) ** np.arange(100)[:, None], zeta=0.05), 0) == 1.0
    assert alike_lines(noisy(0.0 * flat, zeta=0.05), 0) == 1.0
    assert alike_lines(noisy(flat, zeta=0.019), 0) == 1.0
    assert alike_lines(noisy(flat, zeta=0.021), 0) == pytest.approx(1.0 + 2.0 * 0.5 * 23.0 / 24.0)


def test_a_record_that_ends_before_the_mode():
    freq, zeta = cut_off(noisy(np.ones((100, 1)), zeta=0.002), 0)  # 0.2 lines in its bandwidth
    left = np.exp(-np.pi * 0.2)
    assert (freq, zeta) == pytest.approx((left / 50.0 / np.sqrt(12.0), 0.5 * left / 50.0))


def test_a_peak_that_is_wider_than_its_fit():
    """Lines of 0.7, 1, 0.75 and 0.72 of a peak: half the power is 0.707."""
    seen = noisy(np.ones((100, 1)), zeta=1e-4)
    seen.window.as_complex[48:54, 0] = [0.3, 0.7, 1.0, 0.75j, -0.72, 0.7]
    for freq in (48.0, 50.4, 52.0):
        seen.freq[0] = freq
        assert lines_high(seen, 0) == 3
    left = np.exp(-np.pi * lines_of(seen)[0]) / 52.0
    assert cut_off(seen, 0)[1] == pytest.approx(3.0 * 0.5 * left)
    seen.window.as_complex[52, 0] = 0.7
    assert lines_high(seen, 0) == 2
    assert cut_off(seen, 0)[1] == pytest.approx(0.5 * left)
    seen.window.as_complex[:] = 1.0
    assert lines_high(seen, 0) == 100
