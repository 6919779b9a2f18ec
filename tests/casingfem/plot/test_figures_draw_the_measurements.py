"""Figures of measurements, correlations and draws show what the results hold, number for number, with units."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.plot.correlation import figure_comac, figure_located, figure_mac
from casingfem.plot.experiment import figure_deflections, figure_scan
from casingfem.plot.modes import figure_splits
from casingfem.plot.pages.fit import figure_shape_mac
from casingfem.plot.records import figure_estimate, figure_hit
from casingfem.plot.update import Paired, figure_comparison, figure_corner
from tests.casingfem.plot.drawings import drawn, require_units, same

TIME = np.linspace(-0.01, 0.99, 1001)


def estimate(count=3):
    """A hit of 2 ms, and responses of three sensors that decay."""
    force = 40.0 * np.exp(-((TIME / 1e-3) ** 2))
    responses = np.array([[-3.0], [1.0], [0.5]])[:count] * np.exp(-4.0 * TIME) * np.cos(300.0 * TIME)
    x = np.linspace(10.0, 50.0, 5)
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=[[1.0 + k * 1j, 2, 3j, 4, 5] for k in range(count)],
                                     unit="(m/s^2)/N")  # fmt: skip
    coherence = cf.frf.FrfSet.from_arrays(
        kind="spectrum", x=x, responses=[[0.9, 0.8, 0.99 - 0.1 * k, 1.0, 0.5 + 0.1 * k] for k in range(count)], unit=""
    )
    return SimpleNamespace(
        shown=SimpleNamespace(time=TIME, force=force, responses=responses, force_window=np.exp(-np.abs(TIME)),
                              response_window=np.exp(-3.0 * np.abs(TIME))),
        kept=(SimpleNamespace(width=5e-3),), frfs=frfs, coherence=coherence,
    )  # fmt: skip


def test_a_hit_is_drawn_in_newtons_over_milliseconds_with_its_windows():
    found = estimate()
    figure = figure_hit(found)
    require_units(figure)
    near = np.abs(TIME) < 8.0 * 5e-3
    shown = found.shown
    assert np.array_equal(drawn(figure.axes[0], "force"), (1e3 * TIME[near], shown.force[near]))
    x, y = drawn(figure.axes[0], "its window, scaled to the peak")
    assert np.array_equal((x, y), (1e3 * TIME[near], shown.force.max() * shown.force_window[near]))
    relative = np.abs(shown.responses) / np.abs(shown.responses).max(axis=1)[:, None]
    x, y = drawn(figure.axes[1], "largest response, relative to its peak")
    assert np.array_equal(x, TIME)
    assert np.allclose(y, relative.max(axis=0), rtol=1e-12)
    assert np.array_equal(drawn(figure.axes[1], "its window"), (TIME, shown.response_window))


def test_an_estimate_shows_the_rms_of_all_channels_and_the_least_coherence():
    found = estimate()
    figure = figure_estimate(found)
    require_units(figure)
    H = np.abs(found.frfs.responses)
    x, y = drawn(figure.axes[0], "rms of 3 channels")
    assert np.array_equal(x, found.frfs.x)
    assert np.allclose(y, np.sqrt((H[0] ** 2 + H[1] ** 2 + H[2] ** 2) / 3.0), rtol=1e-12)
    assert same(figure.axes[1].lines[0], found.frfs.x, [0.9, 0.8, 0.79, 1.0, 0.5])


def test_splits_are_drawn_in_per_cent_with_their_quantiles():
    draws = 201
    split = 1e-3 * np.arange(draws) / (draws - 1)  # quantile q is q 1e-3
    found = SimpleNamespace(perfect=[(4, 1)], n=np.full(draws, 4), m=np.full(draws, 1), split=split, draws=draws)
    figure = figure_splits(found)
    require_units(figure)
    (axes,) = figure.axes
    (bar,) = axes.collections[0].get_segments()
    assert np.allclose(bar, [[4.0, 0.01], [4.0, 0.09]])
    assert np.allclose(drawn(axes, "m = 1"), ([4.0], [0.05]))
    assert np.allclose(axes.lines[1].get_ydata(), 0.099)


def scan_of(psi_deg: float, amplitude: float, n: int = 3) -> cf.circle.CircleScan:
    """A standing wave of one tone: A cos n(theta - psi)."""
    turned = np.exp(1j * n * np.radians(psi_deg))
    V = np.exp(0.7j) * np.array([[0.5 * amplitude * turned, 0.5 * amplitude * np.conj(turned)]])
    small = np.full((1, 2), 1e-6 * amplitude)
    return cf.circle.CircleScan(
        tones=np.array([300.0]), n=np.array([-n, n]), V=V, sigma=small, floor=small, rate=4.0, left=1.0
    )


def test_the_spectrum_of_a_scan_has_the_height_of_its_lines():
    found = scan_of(20.0, 2e-3)
    time = np.arange(8000) / 2000.0
    theta = 2.0 * np.pi * 4.0 * time
    velocity = np.real(np.exp(2j * np.pi * 300.0 * time + 0.7j) * 2e-3 * np.cos(3.0 * (theta - np.radians(20.0))))
    figure = figure_scan(SimpleNamespace(velocity=velocity, fs=2000.0, force=None, card=()), found)
    require_units(figure)
    freq, spectrum = drawn(figure.axes[0], "spectrum, Hann window")
    at, height = drawn(figure.axes[0], "lines of 300.00 Hz")
    assert np.allclose((at, height), ([288.0, 312.0], [1e-3, 1e-3]))
    assert np.allclose(spectrum[[np.argmin(np.abs(freq - one)) for one in at]], height, rtol=1e-6)


@pytest.mark.parametrize("psi", [20.0, 55.0])
def test_a_deflection_has_its_antinodes_where_the_wave_has_them(psi):
    figure = figure_deflections(scan_of(psi, 2e-3), [(0, 3)])
    (axes,) = figure.axes
    circle, wave, marks = axes.lines
    assert np.allclose(np.unique(circle.get_ydata()), 1.0)
    theta, radius = wave.get_xdata(), wave.get_ydata()
    assert np.allclose((radius - 1.0) / 0.45, np.cos(3.0 * (theta - np.radians(psi))), atol=1e-12)
    assert np.allclose(np.degrees(marks.get_xdata()) % 120.0, psi)
    assert f"{psi:.1f} deg" in axes.get_title()


@pytest.fixture(scope="module")
def modes():
    casing = cf.Shell(
        chart=cf.Cylinder(radius=0.2, height=0.2), thickness=2e-3,
        material=cf.Material(E=2e11, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()},
        radius_defect=cf.FourierField.of({6: 1e-3, 8: 1e-3, 10: 1e-3}),
    )  # fmt: skip
    return cf.modes(casing, 6)


@pytest.mark.slow
def test_a_comparison_shows_frequencies_splits_and_antinodes_of_both_sides(modes):
    pairs = [pair for pair in modes.doublets if np.isfinite(modes.angle_deg[pair[0]])]
    rows = np.array(pairs).ravel()
    n = modes.nodal_diameters[rows]
    table = cf.FrequencyTable.from_arrays(
        freq_hz=modes.freq[rows] * (1.0 + 1e-3 * (np.arange(len(rows)) % 2)), sigma_hz=0.5, n=n,
        mode=np.arange(len(rows)) + 1, angle_deg=np.where(np.arange(len(rows)) % 2, modes.angle_deg[rows], np.nan),
    )  # fmt: skip
    figure = figure_comparison(table, {"imperfect": Paired(modes, cf.correlation.pair(modes, table))})
    require_units(figure)
    frequency, split, antinode = figure.axes
    x, y = drawn(frequency, "imperfect")
    assert sorted(y) == sorted(modes.freq[rows])
    measured = frequency.containers[0].lines[0]
    assert np.array_equal(measured.get_ydata(), table.freq_hz)
    low, high = (table.freq_hz[k::2] for k in (0, 1))
    assert np.allclose(split.lines[0].get_ydata(), 200.0 * (high - low) / (high + low))
    assert np.allclose(split.lines[1].get_ydata(), 100.0 * modes.splits[[modes.doublets.index(p) for p in pairs]])
    assert np.allclose(antinode.lines[0].get_ydata() % 1.0, antinode.lines[1].get_ydata() % 1.0, atol=1e-6)
    assert np.allclose(antinode.lines[1].get_ydata(), modes.angle_deg[rows[::2]] * n[::2] / 180.0)
    assert np.array_equal(np.round(x), n[np.argsort(modes.freq[rows])][np.argsort(np.argsort(y))])


def test_a_corner_plot_has_ellipses_of_the_correlation_and_the_density_of_each_parameter():
    R = np.array([[1.0, -0.94], [-0.94, 1.0]])
    given = {"sigma": None, "log": False}
    fit = SimpleNamespace(
        parameters=[SimpleNamespace(name="material.E", **given), SimpleNamespace(name="k", **given)], correlation=R,
        value=(2e11, 0.01), sigma=np.array([2e9, 0.02]), x=np.array([2e11, 0.01]),
    )  # fmt: skip
    figure = figure_corner(fit)
    axes = figure.axes[0]
    assert figure.axes[1].get_ylabel() == "correlation [-]"
    assert {text.get_position(): text.get_text() for text in axes.texts} == {(1, 0): "-0.94"}
    words = [label.get_text() for label in axes.get_xticklabels()]
    assert words == ["2 × 10\u00b9\u00b9\n± 1 %", "0.01\n± 0.02"]
    ellipses = [np.array(line.get_data()) for line in axes.lines if len(line.get_xdata()) == 91]
    for size, ellipse in zip((1.0, 2.0), ellipses, strict=True):
        u, v = (ellipse[0] - 0.0) * 3.0 / 0.47, (1.0 - ellipse[1]) * 3.0 / 0.47
        np.testing.assert_allclose((u**2 - 2.0 * R[0, 1] * u * v + v**2) / (1.0 - R[0, 1] ** 2), size**2)


def side(mac):
    """Three measured shapes beside four modes, of which two pair with one doublet."""
    matches = (SimpleNamespace(rows=(0,), modes=(0,)), SimpleNamespace(rows=(1, 2), modes=(2, 3)))
    return SimpleNamespace(
        mac=mac, modes=SimpleNamespace(nodal_diameters=np.array([5, 6, 4, 4])), rows=np.arange(3),
        measured=SimpleNamespace(freq_hz=np.array([101.2, 230.0, 231.5])), pairing=SimpleNamespace(matches=matches),
    )  # fmt: skip


def require_mac(axes, mac):
    """A matrix drawn cell by cell, its rows by frequency, its columns by mode and n."""
    assert np.array_equal(np.asarray(axes.collections[0].get_array()).reshape(mac.shape), mac)
    assert [label.get_text() for label in axes.get_yticklabels()] == ["101.2", "230.0", "231.5"]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["1\nn 5", "2\nn 6", "3\nn 4", "4\nn 4"]
    frames = [(line.get_xdata().min(), line.get_xdata().max(), line.get_ydata().min(), line.get_ydata().max())
              for line in axes.lines]  # fmt: skip
    assert frames == [(-0.5, 0.5, -0.5, 0.5), (1.5, 3.5, 0.5, 2.5)]


def test_a_mac_matrix_has_its_rows_and_columns_and_frames_its_pairs():
    mac = np.arange(12.0).reshape(3, 4) / 12.0
    figure = figure_mac(side(mac))
    require_mac(figure.axes[0], mac)
    found = SimpleNamespace(before=side(mac), after=side(mac[::-1]),
                            fit=SimpleNamespace(table=SimpleNamespace(freq_hz=side(mac).measured.freq_hz)))  # fmt: skip
    both = figure_shape_mac(found)
    require_mac(both.axes[0], mac)
    require_mac(both.axes[1], mac[::-1])
    for one in (figure, both):
        assert one.axes[-1].get_ylabel() == "MAC [-]"


@pytest.mark.slow
def test_comac_is_drawn_at_the_sensors_by_angle_and_height(modes):
    angle, z = np.array([10.0, 130.0, 250.0]), np.array([0.05, 0.1, 0.15])
    found = SimpleNamespace(
        modes=modes, sensors=SimpleNamespace(a=z, b=np.radians(angle)), comac=np.array([0.9, 0.8, 0.7]),
        ecomac=np.array([0.1, 0.2, 0.3]),
    )  # fmt: skip
    figure = figure_comac(found)
    require_units(figure)
    panels = [axes for axes in figure.axes if axes.get_title()]
    for axes, values in zip(panels, (found.comac, found.ecomac), strict=True):
        assert np.allclose(axes.collections[0].get_offsets(), np.stack([angle, z], axis=1))
        assert np.array_equal(axes.collections[0].get_array(), values)


@pytest.mark.parametrize(("among", "scale", "unit"), [("bolts", 1.0, "[-]"), ("mass", 1e3, "[g]")])
def test_what_was_located_is_drawn_at_its_angle_with_three_sigma(among, scale, unit):
    def explanation(angle, value):
        return SimpleNamespace(found=(SimpleNamespace(angle_deg=angle, value=value, sigma=0.01),))

    found = SimpleNamespace(among=among, angles_deg=np.arange(0.0, 360.0, 30.0), best=explanation(60.0, 0.4),
                            others=(explanation(240.0, 0.45),))  # fmt: skip
    (axes,) = figure_located(found).axes
    assert re.search(re.escape(unit), axes.get_title())
    for container, (angle, value) in zip(axes.containers, ((60.0, 0.4), (240.0, 0.45)), strict=True):
        line, _, (bar,) = container.lines
        assert np.allclose((line.get_xdata(), line.get_ydata()), ([np.radians(angle)], [scale * value]))
        (segment,) = bar.get_segments()
        assert np.allclose(segment[:, 1], scale * np.array([value - 0.03, value + 0.03]))
