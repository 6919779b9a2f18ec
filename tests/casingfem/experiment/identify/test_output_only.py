"""Modes of responses alone: a shell under random loads, close pairs, intervals that hold, tones, what is refused."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import expm
from scipy.signal import butter, lfilter

import casingfem as cf
from casingfem.cli import main
from tests.casingfem.experiment.identify.held_modes import numbers_of_modes

FS = 640.0
THETA = np.radians(np.arange(16) * 22.5 + 3.0)
FREQ, ZETA = np.array([120.0, 121.2, 163.0, 163.4, 210.0]), np.array([4e-3, 5e-3, 3e-3, 3.5e-3, 6e-3])
N, ANTINODE = (3, 3, 4, 4, 0), np.array([0.1, 0.1 + np.pi / 6, 0.3, 0.3 + np.pi / 8, 0.0])
LOADS = np.radians([17.0, 80.0, 200.0, 305.0])


def shapes(at):
    return np.cos(np.array(N) * (np.asarray(at)[:, None] - ANTINODE))


def driven(seed, seconds, tone=0.0, noise=0.03, freqs=FREQ):
    """Accelerations on a circle under four white forces; each step of the modes is exact for forces that are fixed."""
    rng, count = np.random.default_rng(seed), int(seconds * FS)
    forces, y = rng.standard_normal((len(LOADS), count)), np.zeros((len(THETA), count))
    for freq, zeta, push, seen in zip(freqs, ZETA, shapes(LOADS).T, shapes(THETA).T, strict=True):
        omega = 2.0 * np.pi * freq
        step = expm(np.array([[0, 1, 0], [-(omega**2), -2 * zeta * omega, 1], [0, 0, 0]]) / FS)
        A, b = step[:2, :2], step[:2, 2]
        down, p = [1.0, -np.trace(A), np.linalg.det(A)], push @ forces
        q = lfilter([0.0, b[0], A[0, 1] * b[1] - A[1, 1] * b[0]], down, p)
        v = lfilter([0.0, b[1], A[1, 0] * b[0] - A[0, 0] * b[1]], down, p)
        y += np.outer(seen, p - 2.0 * zeta * omega * v - omega**2 * q)
    y = y[:, int(5.0 * FS) :]
    y = y + noise * y.std(axis=1, keepdims=True) * rng.standard_normal(y.shape)
    return y + tone * y.std() * np.sin(2.0 * np.pi * 140.0 * np.arange(y.shape[1]) / FS)


def records(y, fs=FS):
    return cf.frf.FrfSet.from_arrays(
        kind="time", x=np.arange(y.shape[1]) / fs, responses=y, unit="m/s^2", response_point=np.arange(1, len(y) + 1),
        response_direction=1,
    )  # fmt: skip


ANGLES = dict(enumerate(np.degrees(THETA), start=1))


@pytest.mark.slow
def test_pairs_closer_than_their_bandwidth_are_distinguished(held):
    """The pair of n = 4 is 0.4 of a bandwidth apart."""
    found = cf.identify(records(driven(7, 300.0)), angles=ANGLES, band=(100.0, 230.0))
    assert found.n.tolist() == list(N)
    assert found.sure.all()
    np.testing.assert_allclose(found.freq, FREQ, rtol=1e-3)
    assert (np.abs(found.freq - FREQ) < 3.5 * found.sigma_freq).all()
    assert (np.abs(found.zeta - ZETA) < 3.5 * found.sigma_zeta).all()
    assert (found.sigma_zeta < 0.15 * found.zeta).all()
    assert found.doublets == ((0, 1), (2, 3))
    period = 180.0 / np.array(N[:4])
    off = (found.angle_deg[:4] - np.degrees(ANTINODE[:4]) + period / 2) % period - period / 2
    assert (np.abs(off) < 3.5 * found.sigma_angle[:4]).all()
    assert found.deviation < 0.4
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.slow
def test_a_pair_without_a_split_is_one_unresolved_mode_or_a_doublet_with_a_note(held):
    """Its two shapes are arbitrary. If they are a quarter wave apart they form a doublet, else they are one mode."""
    freqs = np.array([120.0, 120.0, *FREQ[2:]])
    one, two = (
        cf.identify(records(driven(seed, 120.0, freqs=freqs)), angles=ANGLES, band=(100.0, 230.0)) for seed in (75, 61)
    )
    assert one.n.tolist() == [3, 4, 4, 0]
    assert (one.unresolved, one.doublets) == ((0,), ((1, 2),))
    assert one.sure.all()
    assert abs(one.freq[0] - 120.0) < 2.0 * one.sigma_freq[0] < 0.4
    assert np.isnan(one.angle_deg[0])
    assert "unresolved: its split is below" in " ".join(one.notes)
    assert (two.n.tolist(), two.unresolved, two.doublets) == (list(N), (), ((0, 1), (2, 3)))
    (note,) = [note for note in two.notes if "below two standard deviations" in note]
    assert note.startswith("pair of n = 3 at 120.0")
    two = {f"two {name}": column for name, column in numbers_of_modes(two).items()}
    held(1e-4, **numbers_of_modes(one), **two)


@pytest.mark.slow
def test_a_shell_under_random_loads_has_the_frequencies_and_damping_of_its_modes():
    """Splits of about 1 Hz in modes that are 2 Hz wide."""
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25), thickness=3e-3, supports={"base": cf.Clamped()},
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0), mesh=cf.ShellMesh(order=5, rows=2, around=13),
        radius_defect=cf.FourierField.of({p: (1e-5, 2e-5) for p in (14, 16, 18)}),
    )  # fmt: skip
    places = [cf.rig.Place(at=(0.25, angle)) for angle in (0.3, 1.4, 2.9, 4.5)]
    bench = cf.rig.rig_of(cf.modes(casing, count=6), [*places, *cf.rig.circle(0.25, 24)], zeta=3e-3)
    loads = [cf.rig.Random(rms=1.0, band=(250.0, 480.0))] * 4
    test = cf.rig.record(bench, loads, drives=range(4), sensors=range(4, 28), fs=1280.0, block=2**18, blocks=1, seed=5)
    found = cf.identify(test.functions()[0], angles=cf.rig.rig_angles(bench), band=(340.0, 420.0))
    np.testing.assert_allclose(found.freq, bench.freq, rtol=1e-3)
    assert (np.abs(found.zeta - 3e-3) < 3.5 * found.sigma_zeta).all()
    assert sorted(found.n.tolist()) == [7, 7, 8, 8, 9, 9]


@pytest.mark.slow
def test_a_spectrum_that_falls_by_many_decades_has_no_peaks_but_those_of_modes(held):
    """Displacements of a long bridge in wind: the correlations have not decayed at the longest lag."""
    rng, count, fs = np.random.default_rng(9), 54_000, 15.0
    freqs = np.array([0.2, 0.32, 0.44, 0.86])
    at = np.linspace(0.15, 0.85, 5)
    y = np.zeros((len(at), count))
    for k, freq in enumerate(freqs, start=1):
        pole = np.exp((-0.005 + 1j) * 2.0 * np.pi * freq / fs)
        load = lfilter(*butter(4, 1.2, fs=fs), rng.standard_normal(count))
        q = lfilter([0.0, pole.imag], [1.0, -2.0 * pole.real, abs(pole) ** 2], load)
        y += np.outer(np.sin(np.pi * k * at), q / freq)
    found = cf.identify(records(y, fs))
    assert np.abs(found.freq[found.sure][:, None] - freqs).min(axis=1).max() < 3e-3
    assert np.abs(found.freq[:, None] - freqs).min(axis=0).max() < 3e-3
    assert not [note for note in found.notes if "recurs" in note]
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.slow
def test_a_tone_is_no_sure_mode(held):
    found = cf.identify(records(driven(3, 120.0, tone=0.5)), angles=ANGLES, band=(100.0, 230.0))
    assert not (found.sure & (np.abs(found.freq - 140.0) < 1.0)).any()
    assert "tone" in " ".join((*found.doubtful(), *found.notes))
    assert np.abs(found.freq[found.sure] - FREQ).max() < 0.2
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.campaign
def test_intervals_keep_what_they_state_over_a_hundred_records():
    """95 % intervals of frequency and damping hold 92 to 97 %; every mode is found, none besides is sure."""
    off, held, others = [], [], 0
    for seed in range(100):
        found = cf.identify(records(driven(1000 + seed, 400.0)), angles=ANGLES, band=(100.0, 230.0))
        at = [int(np.argmin(np.abs(found.freq - freq))) for freq in FREQ]
        assert len(set(at)) == len(FREQ)
        off.append(found.freq[at] / FREQ - 1.0)
        others += int(found.sure.sum()) - len(FREQ)
        held += [np.abs(found.freq[at] - FREQ) < 1.96 * found.sigma_freq[at],
                 np.abs(found.zeta[at] - ZETA) < 1.96 * found.sigma_zeta[at]]  # fmt: skip
    assert others <= 2
    assert np.mean(np.abs(off) < 1e-3) > 0.99
    assert 0.92 <= np.mean(held[::2]) <= 0.97
    assert 0.92 <= np.mean(held[1::2]) <= 0.97


def test_what_has_no_modes_is_refused():
    y = np.random.default_rng(1).standard_normal((3, 4000))
    for call, words in (
        (lambda: cf.identify(records(y[:, :900])), "900 samples; expected 2000 or more"),
        (lambda: cf.identify(records(0.0 * y)), "no channel with a signal"),
        (lambda: cf.identify(records(y), pick=[20.0]), "pick with time records"),
        (lambda: cf.identify(records(y), band=(500.0, 600.0)), "band 500 to 600 Hz"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            call()


@pytest.mark.slow
def test_the_command_reads_records_of_responses_and_their_angles(tmp_path):
    y = driven(2, 100.0)
    np.savez(tmp_path / "run.npz", fs=FS, response=y, unit="m/s^2")
    rows = "".join(f"{point},{angle}\n" for point, angle in ANGLES.items())
    (tmp_path / "angles.csv").write_text("point,angle_deg\n" + rows)
    arguments = ["identify", str(tmp_path / "run.npz"), "--output-only", "--band", "100", "230"]
    result = CliRunner().invoke(
        main, [*arguments, "--angles", str(tmp_path / "angles.csv"), "--json", "--out", str(tmp_path / "out")]
    )
    assert result.exit_code == 0, result.output
    assert [mode["n"] for mode in json.loads(result.stdout)["modes"]] == list(N)
    assert "responses alone" in (tmp_path / "out" / "identified.csv").read_text()
    for more, words in ((["--exponential", "1"], "--exponential are of frequency responses"),
                        (["--channels", "x.csv"], "x.csv")):  # fmt: skip
        refused = CliRunner().invoke(main, [*arguments, *more])
        assert refused.exit_code == 2
        assert words in refused.output


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--seconds", str(15.0 / FS)],
         "found lags of 0.0234 s in a record of 5 s; expected at most a 22th of the record, 0.025"),
        (["--seconds", "1.0"], "found lags of 1 s in a record of 5 s; expected at most a 22th"),
        (["--band", "230.0", "100.0"], "found band 230 to 100 Hz; expected from < to, up to 320 Hz"),
        (["--band", "100.0", "100.1"], "found band 100 to 100.1 Hz; expected from < to"),
    ],
)  # fmt: skip
def test_lags_and_bands_that_the_record_does_not_have_are_refused(options, words, tmp_path):
    np.savez(tmp_path / "run.npz", fs=FS, response=driven(3, 10.0), unit="m/s^2")
    refused = CliRunner().invoke(main, ["identify", str(tmp_path / "run.npz"), "--output-only", *options])
    assert refused.exit_code == 2
    assert words in refused.output
