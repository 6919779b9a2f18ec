"""Bounds of what a test may say: the value just inside is taken, the one just outside refused in words."""

import numpy as np
import pytest

import casingfem as cf

NAN, INF = float("nan"), float("inf")
BAND = (20.0, 180.0)
OUT = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]


def scan(**changes):
    return cf.circle.ScanRecord(
        **{"fs": 10.0, "velocity": [1.0, 2.0], "angle": [0.0, 1.0], "tones": (3.0, 4.0)} | changes
    )


def shapes(**changes):
    """Two modes on two channels."""
    given = {"freq_hz": [1.0, 2.0], "values": [[1.0, 2.0], [3.0, 4.0]], "points": OUT, "directions": OUT}
    return cf.correlation.MeasuredShapes.from_arrays(**given | changes)


def stored(**changes):
    """Two modes on two channels, as they are kept."""
    given = {"freq_hz": [1.0, 2.0], "values": np.eye(2), "points": OUT, "directions": OUT, "labels": [1, 2]}
    return cf.correlation.MeasuredShapes(**{name: np.array(value) for name, value in (given | changes).items()})


def frfs(lines=3, **changes):
    given = {"kind": "frf", "x": 10.0 * np.arange(lines), "responses": np.full((1, lines), 1.0 - 1.0j), "unit": "m/N"}
    return cf.frf.FrfSet.from_arrays(**given | changes)


def spoilt(value, kind="frf"):
    return frfs(kind=kind, responses=[[1.0, value, 1.0]])


def estimated(drives=1, overlap=0.0, **options):
    rig = cf.rig.Rig.of(omega=[600.0], zeta=[0.02], rows=[[1.0], [0.5]])
    force = [cf.rig.BurstRandom(rms=1.0, band=BAND)] * drives
    test = cf.rig.record(rig, force, drives=list(range(drives)), sensors=[0], fs=512.0, block=256, blocks=4, seed=11)
    return cf.rig.estimate(test, overlap=overlap, **options)


def resonance(lines=61, x=None, factor=1.0, **changes):
    """Mobility of one mode at 100 Hz over evenly spaced lines."""
    x = np.linspace(85.0, 115.0, lines) if x is None else np.asarray(x)
    H = 1e3j * x / (100.0**2 - x**2 + 2j * 0.01 * 100.0 * x)
    return frfs(x=x, responses=factor * H[None, :], unit="m/s/N", **changes)


def read(what, **options):
    return cf.identify(what, **options)


TAKEN, REFUSED = 0, 1
BOUNDS = {
    "tones.zero": (lambda k: scan(tones=((1e-9, 4.0), (0.0, 4.0))[k]), r"tones: found \(0\.0, 4\.0\), expected freq"),
    "tones.order": (lambda k: scan(tones=(3.0, (3.1, 3.0)[k])), r"tones: found \(3\.0, 3\.0\), expected freq.* ascend"),
    "tones.none": (lambda k: scan(tones=((3.0,), ())[k]), r"tones: found \(\), expected frequencies above 0 Hz"),
    "fs": (lambda k: scan(fs=(1e-9, 0.0)[k]), "fs: found 0.0, expected samples a second"),
    "velocity": (lambda k: scan(velocity=[1.0, (2.0, INF)[k]]), "velocity: found shape .* expected finite numbers"),
    "angle": (lambda k: scan(angle=([0.0, 1.0], [0.0])[k]), "angle: found shape .1,., expected finite numbers, one"),
    "force": (lambda k: scan(force=[1.0, (2.0, NAN)[k]]), "force: found shape .2,., expected finite numbers"),
    "tacho.few": (
        lambda k: cf.circle.from_tacho([0.0, 1.0][: 2 - k], 1.0, 1),
        "tacho: expected the instants of two pulses",
    ),
    "tacho.order": (
        lambda k: cf.circle.from_tacho([0.0, (1e-9, 0.0)[k]], 1.0, 1),
        "tacho: expected the instants of two pulses",
    ),
    "tacho.first": (
        lambda k: cf.circle.from_tacho([(0.0, 1e-9)[k], 9.0], 1.0, 2),
        "pulses from 1e-09 to 9 s, expected them to",
    ),
    "tacho.last": (
        lambda k: cf.circle.from_tacho([0.0, (1.0, 0.999)[k]], 1.0, 2),
        "from 0 to 0.999 s, expected .* 0 to 1 s",
    ),
    "shapes.direction": (lambda k: shapes(directions=[OUT[0], [0.0, (1e-9, 0.0)[k], 0.0]]), "a direction of no length"),
    "shapes.modes": (lambda k: shapes(values=[[1.0, 2.0][: 2 - k]] * 2), r"values \(2, 1\); expected \(channels, 2 m"),
    "shapes.flat": (lambda k: shapes(values=(np.eye(2), [1.0, 2.0])[k]), r"values \(2,\); expected \(channels, 2 m"),
    "shapes.freq": (lambda k: shapes(freq_hz=[(1e-9, 0.0)[k], 2.0]), "above 0 in ascending order"),
    "shapes.order": (lambda k: stored(freq_hz=[2.0, (2.0, 1.99)[k]]), "above 0 in ascending order"),
    "shapes.zero": (lambda k: shapes(values=[[1.0, (1e-9, 0.0)[k]], [1.0, 0.0]]), "mode 2 zero everywhere"),
    "shapes.nan": (lambda k: shapes(values=[[1.0, (1.0, NAN)[k]], [1.0, 1.0]]), "numbers that are not finite"),
    "shapes.sigma": (lambda k: shapes(sigma=[NAN, (1e-9, 0.0)[k]]), r"sigma \[nan, 0\.0\] and n .*; expected a sigma"),
    "shapes.sigmas": (lambda k: shapes(sigma=[0.1] * (2 + k)), r"sigma \(3,\); expected one for each of 2 modes"),
    "shapes.n": (lambda k: stored(n=[4] * (2 + k)), r"n \[4, 4, 4\]; expected .* for each of 2 modes"),
    "shapes.channels": (lambda k: stored(values=np.ones((2 + k, 2))), r"values \(3, 2\) of 2 modes and 2 channels"),
    "shapes.points": (lambda k: stored(points=OUT[: 2 - k]), r"points \(1, 3\) and directions \(2, 3\); expected thr"),
    "frf.kind": (lambda k: frfs(kind=("spectrum", "spectra")[k]), "kind 'spectra'; expected frf or time or spectrum"),
    "frf.nan": (lambda k: spoilt((NAN, INF)[k]), r"1 of 1 channels, on 1 of 3 lines, first at 10; expected finite num"),
    "frf.time": (lambda k: spoilt((1.0, NAN)[k], "time"), "1 of 1 channels, on 1 of 3 lines, first at 10; expected f"),
    "frf.complex": (lambda k: spoilt((1.0, 1j)[k], "time"), "a complex time record; expected real values"),
    "frf.x": (lambda k: frfs(x=[0.0, 10.0, (20.0, INF)[k]]), "nan or infinity in the abscissa; expected finite num"),
    "frf.ascends": (lambda k: frfs(x=[0.0, 10.0, (10.1, 10.0)[k]]), "10 after 10; expected an abscissa that ascends"),
    "frf.lines": (lambda k: frfs(x=[0.0, 1.0, 2.0][: 3 - k]), r"x \(2,\), responses \(1, 3\).*expected x \(lines,\)"),
    "frf.places": (lambda k: frfs(response_point=[1] * (1 + k)), r"response_point \(2,\).*; expected x \(lines,\)"),
    "form": (
        lambda k: read(resonance(), form=("mobility", "compliance")[k]),
        "form 'compliance'; expected .*receptance",
    ),
    "window": (
        lambda k: read(resonance(), exponential=(1.0, 0.0)[k]),
        "expected the window's time constant .s., above 0",
    ),
    "window.inf": (
        lambda k: read(resonance(), exponential=(1e9, INF)[k]),
        "expected the window's time constant .s., above 0",
    ),
    "window.card": (
        lambda k: read(resonance(card=[f"exponential_window_s: {('2', 'two')[k]}"])),
        "window_s two; expected",
    ),
    "pick.low": (lambda k: read(resonance(), pick=[(100.0, 85.0)[k]]), "85 Hz picked; expected .* 85 and 115 Hz"),
    "pick.high": (lambda k: read(resonance(), pick=[(100.0, 115.0)[k]]), "115 Hz picked; expected .* 85 and"),
    "pick.none": (lambda k: read(resonance(), pick=[100.0][k:]), "no frequency picked; expected frequencies"),
    "usable.kind": (
        lambda k: read(resonance(kind=("frf", "spectrum")[k])),
        "kind 'spectrum'; expected frequency responses",
    ),
    "usable.band": (lambda k: read(resonance(), band=(0.0, (1e4, 0.0)[k])), "band 0 to 0 Hz; expected 0 <= from < to"),
    "usable.below": (
        lambda k: read(resonance(), band=((0.0, -1.0)[k], 1e4)),
        "band -1 to 10000 Hz; expected 0 <= from < to",
    ),
    "usable.few": (lambda k: read(resonance(30 - k)), "lines in the band; expected at least"),
    "usable.silent": (lambda k: read(resonance(factor=(1e-9, 0.0)[k])), "expected a signal"),
    "usable.phase": (lambda k: read(resonance() if k == 0 else frfs(40, responses=np.ones((1, 40)))), "without phase"),
    "usable.even": (
        lambda k: read(resonance(x=np.r_[85.0:124.0, (124.0, 124.1)[k]])),
        "steps from 1 to 1.1 Hz; expected even steps",
    ),
    "band": (
        lambda k: cf.rig.Random(rms=1.0, band=(0.0, (1e-9, 0.0)[k])),
        "band: found 0.0 to 0.0 Hz, expected from lower",
    ),
    "band.below": (
        lambda k: cf.rig.Random(rms=1.0, band=((0.0, -1.0)[k], 9.0)),
        "band: found -1.0 to 9.0 Hz, expected from",
    ),
    "band.inf": (
        lambda k: cf.rig.BurstRandom(rms=1.0, band=(1.0, (9.0, INF)[k])),
        "band: found 1.0 to inf Hz, expected fro",
    ),
    "rms": (lambda k: cf.rig.Random(rms=(1e-9, 0.0)[k], band=BAND), "rms: found 0.0, expected a number above 0"),
    "part.none": (
        lambda k: cf.rig.BurstRandom(rms=1.0, band=BAND, part=(1e-9, 0.0)[k]),
        "part: found 0.0, expected a part",
    ),
    "part.all": (
        lambda k: cf.rig.BurstRandom(rms=1.0, band=BAND, part=(0.99, 1.0)[k]),
        "part: found 1.0, expected a part of",
    ),
    "peak": (lambda k: cf.rig.Impact(peak=(1.0, -1.0)[k], width=1e-3), "peak: found -1.0, expected a number above 0"),
    "width": (lambda k: cf.rig.Impact(peak=1.0, width=(1e-9, 0.0)[k]), "width: found 0.0, expected a number above 0"),
    "delay": (
        lambda k: cf.rig.Impact(peak=1.0, width=1e-3, delay=(0.0, -1e-9)[k]),
        "delay: found -1e-09, expected a number",
    ),
    "sine": (
        lambda k: cf.rig.StepSine(amplitude=1.0, freq=(3.0, (1e-9, 0.0)[k])),
        r"freq: found \(3\.0, 0\.0\), expected fr",
    ),
    "sine.none": (
        lambda k: cf.rig.StepSine(amplitude=1.0, freq=((3.0,), ())[k]),
        r"freq: found \(\), expected frequencies",
    ),
    "snr": (lambda k: cf.rig.noisy(frfs(), (1e3, INF)[k], seed=7), "snr_db: found inf, expected"),
    "bits.low": (lambda k: cf.rig.Converter(bits=(4, 3)[k], full_scale=1.0), "bits: found 3, expected 4 to 32"),
    "bits.high": (lambda k: cf.rig.Converter(bits=(32, 33)[k], full_scale=1.0), "bits: found 33, expected 4 to 32"),
    "full_scale": (
        lambda k: cf.rig.Converter(bits=8, full_scale=(1e-9, 0.0)[k]),
        "full_scale: found 0.0, expected the large",
    ),
    "full_scale.inf": (
        lambda k: cf.rig.Converter(bits=8, full_scale=(1e9, INF)[k]),
        "full_scale: found inf, expected the",
    ),
    "overlap": (lambda k: estimated(overlap=(0.9, 0.91)[k]), "overlap: found 0.91, expected 0 to 0.9"),
    "overlap.below": (lambda k: estimated(overlap=(0.0, -0.01)[k]), "overlap: found -0.01, expected 0 to 0.9"),
    "H2": (lambda k: estimated(1 + k, estimator="H2"), "estimator: found H2 with 2 drives, expected H1, or one drive"),
    "estimator": (lambda k: estimated(estimator=("H1", "H3")[k]), "estimator: found 'H3', expected H1 or H2"),
    "window.name": (lambda k: estimated(window=("hann", "han")[k]), "window: found 'han', expected "),
    "estimate.lines": (lambda k: estimated(band=((90.0, 94.0), (90.1, 90.2))[k]), "90.1 to 90.2 Hz without a line"),
    "scan.wander": (
        lambda k: cf.rig.Turning(mirror=2.0, wander=(0.1, 0.101)[k]),
        r"wander 0\.101, speckle 0\.0: expected",
    ),
    "scan.back": (lambda k: cf.rig.Turning(mirror=2.0, wander=(0.0, -1e-9)[k]), "wander -1e-09, speckle 0.0: expected"),
    "scan.speckle": (
        lambda k: cf.rig.Turning(mirror=2.0, speckle=(0.0, -1e-9)[k]),
        "wander 0.0, speckle -1e-09: expected",
    ),
    "scan.casing": (lambda k: cf.rig.Turning(mirror=2.0, wander=0.01, casing=float(k)), "0 where the casing turns"),
    "unkind.coherent": (lambda k: cf.rig.Troubles(coherent=(1.0, 1.01)[k]), "coherent: found 1.01, expected 0 to 1"),
    "unkind.shift": (lambda k: cf.rig.Troubles(shift=(0.05, 0.051)[k]), "shift: found 0.051, expected 0 to 0.05"),
    "unkind.double": (
        lambda k: cf.rig.Troubles(double_hit=(0.99, 1.0)[k]),
        "double_hit: found 1.0, expected 0 to 0.99",
    ),
    "unkind.phase": (lambda k: cf.rig.Troubles(phase_deg=(0.0, -1.0)[k]), "phase_deg: found -1.0, expected 0 to 90"),
    "unkind.setups": (lambda k: cf.rig.Troubles(setups=(1, 0)[k]), "setups: found 0, expected none, or a number"),
    "unkind.dead": (lambda k: cf.rig.Troubles(dead=(0, -1)[k]), "dead: found -1, expected none, or a number"),
    "unkind.fixture": (lambda k: cf.rig.Troubles(fixture=(0, -1)[k]), "fixture: found -1, expected none, or a number"),
    "unkind.window": (
        lambda k: cf.rig.Troubles(exponential=(0.0, -0.1)[k]),
        "exponential: found -0.1, expected none, or a number",
    ),
}


@pytest.mark.parametrize("name", BOUNDS)
def test_just_inside_is_taken_and_just_outside_refused(name):
    made, words = BOUNDS[name]
    made(TAKEN)
    with pytest.raises((cf.errors.InputError, ValueError), match=words):
        made(REFUSED)
