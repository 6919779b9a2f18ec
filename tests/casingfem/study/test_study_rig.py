"""[rig] of a study file: what is made of it, the command, the pictures, what is refused."""

import json
import re
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from tests.casingfem.study.study_texts import STEEL, THIN, written
from tests.probed import numbers_of_document

CASING = (
    THIN
    + """
[[imperfection]]
of = "radius"
harmonics = [{p = 12, cos = 0.001}]
[support.base]
kind = "clamped"
[mesh]
order = 6
rows = 1
around = 9
[modes]
count = 10
[rig]
seed = 4711
zeta = 0.003
zeta_spread = 0.2
quantity = "mobility"
[[rig.drive]]
height = 0.25
angle_deg = 17.0
mass = 0.01
[[rig.sensor]]
height = 0.25
count = 24
"""
)
EXACT = """
[rig.test]
kind = "exact"
band_hz = [360.0, 440.0]
resolution_hz = 0.25
snr_db = 60.0
"""
BURST = EXACT.replace('"exact"', '"burst-random"').replace("0.25", "0.5") + "blocks = 6\nbits = 20\n"
SCAN = """
[rig.scan]
height = 0.25
tones_hz = [370.1, 384.3]
mirror_hz = 2.3
seconds = 6.0
fs = 1200.0
orders = 10
snr_db = 30.0
"""


@pytest.fixture
def study(tmp_path):
    return partial(written, tmp_path)


def made(path):
    """What the command writes, read back."""
    out = path.with_suffix("")
    done = CliRunner().invoke(main, ["rig", str(path), "--out", str(out)])
    assert done.exit_code == 0, done.output
    found = SimpleNamespace(truth=cf.FrequencyTable.from_csv(out / "truth.csv"))
    for name in ("frfs", "coherence"):
        file = out / f"{name}.npz"
        setattr(found, name, cf.frf.FrfSet.load(file) if file.exists() else None)
    file = out / "scan.npz"
    found.scan = cf.circle.ScanRecord.load(file) if file.exists() else None
    return found


@pytest.mark.slow
def test_exact_responses_have_the_truth(study):
    test = made(study(CASING + EXACT))
    assert len(test.frfs) == 24
    assert test.frfs.card[0].startswith("SYNTHETIC")
    assert any("seed 4711" in line for line in test.frfs.card)
    found = test.truth
    assert found.card[0].startswith("SYNTHETIC")
    bare = cf.modes(cf.load_study(study(CASING)).shell, 10)
    assert sorted(found.n.tolist()) == sorted(bare.nodal_diameters.tolist())
    assert np.all(found.freq_hz <= bare.freq * (1.0 + 1e-12))
    assert found.freq_hz[0] < bare.freq[0] * (1.0 - 1e-4)
    size = np.linalg.norm(test.frfs.responses, axis=0)
    lines = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] > size[2:])) + 1
    for peak in test.frfs.x[lines[np.argsort(size[lines])[-3:]]]:
        assert np.abs(found.freq_hz - peak).min() < 0.5


@pytest.mark.slow
def test_records_give_nearly_the_same_responses(study):
    plain = CASING.replace("mass = 0.01", "")
    exact = made(study(plain + EXACT.replace("snr_db = 60.0", "").replace("0.25", "0.5"))).frfs
    test = made(study(plain + BURST))
    assert np.linalg.norm(test.frfs.responses - exact.responses) < 0.01 * np.linalg.norm(exact.responses)
    assert np.median(test.coherence.responses.real) > 0.99


@pytest.mark.slow
def test_a_scan_finds_the_orders_of_the_modes(study):
    test = made(study(CASING + SCAN.replace("orders = 10", "orders = 11\npoints = 23")))
    waves = cf.circle.demodulate(test.scan, 11)
    seen = [abs(waves.n[np.abs(V).argmax()]) for V in waves.V]
    nearest = [test.truth.n[np.abs(test.truth.freq_hz - tone).argmin()] for tone in (370.1, 384.3)]
    assert seen == nearest


@pytest.mark.slow
def test_the_same_file_twice_is_the_same_to_the_last_bit(study):
    few = CASING.replace("count = 24", "count = 3")
    one, two = (made(study(few + EXACT + SCAN.replace("seconds = 6.0", "seconds = 3.0"))) for _ in range(2))
    assert np.array_equal(one.frfs.responses, two.frfs.responses)
    assert np.array_equal(one.scan.velocity, two.scan.velocity)
    other = made(study((few + EXACT).replace("4711", "4712")))
    assert not np.array_equal(one.truth.zeta, other.truth.zeta)
    assert not np.array_equal(one.frfs.responses, other.frfs.responses)


@pytest.mark.slow
def test_the_command_writes_everything_and_all_of_it_states_synthetic(study, tmp_path, held):
    out = tmp_path / "out"
    path = study(CASING + BURST + "keep_records = true\n" + SCAN)
    result = CliRunner().invoke(main, ["rig", str(path), "--json", "--out", str(out)])
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["synthetic"] is True
    assert document["source"]["sha256"]
    truth = cf.FrequencyTable.from_csv(out / "truth.csv")
    for name in ("freq_hz", "angle_deg", "zeta"):
        column = np.array([row[name] for row in document["modes"]], dtype=float)
        np.testing.assert_array_equal(column, getattr(truth, name))
    assert [row["n"] if row["n"] is not None else -1 for row in document["modes"]] == truth.n.tolist()
    assert document["frfs"] == {"channels": 24, "lines": 161, "unit": "(m/s)/N"}
    assert {w["n"] for w in document["waves"]} >= {7, 8}
    assert {p.name for p in out.iterdir()} == {
        "rig.json", "truth.csv", "frfs.uff", "frfs.npz", "frfs.png", "coherence.npz", "scan.npz", "scan.png",
        "deflections.png", "responses.uff", "forces.uff",
    }  # fmt: skip
    assert cf.frf.FrfSet.from_uff(out / "frfs.uff").card[0].startswith("SYNTHETIC")
    assert len(cf.frf.FrfSet.from_uff(out / "responses.uff", "time")) == 24
    assert cf.frf.FrfSet.from_uff(out / "forces.uff", "time").unit == "N"
    assert cf.frf.FrfSet.load(out / "frfs.npz").card[0].startswith("SYNTHETIC")
    assert cf.circle.ScanRecord.load(out / "scan.npz").card[0].startswith("SYNTHETIC")
    assert cf.FrequencyTable.from_csv(out / "truth.csv").card[0].startswith("SYNTHETIC")
    words = CliRunner().invoke(main, ["rig", str(path)]).stdout
    assert words.startswith("SYNTHETIC")
    assert "waves above 4 sigma" in words
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_troubles_are_made_and_their_truth_is_reported(study, tmp_path, held):
    path = study(CASING + EXACT + "[rig.test.troubles]\nsetups = 3\nshift = 0.002\ndead = 2\nhalf_rim = true\n")
    result = CliRunner().invoke(main, ["rig", str(path), "--json", "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["frfs"]["channels"] == 12
    assert len(document["troubles"]["freq_hz"]) == 3
    assert len(document["troubles"]["dead"]) == 2
    assert (tmp_path / "out" / "coherence.npz").exists()
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_open_charts_give_places_by_their_parameters(study):
    plate = (
        STEEL
        + """
[chart]
kind = "plate"
length = 0.11
width = 0.04
[shell]
thickness = 5e-3
[support.root]
kind = "clamped"
[modes]
count = 4
[rig]
seed = 3
zeta = 0.002
[[rig.drive]]
at = [0.11, 0.0]
direction = "normal"
[[rig.sensor]]
at = [0.08, 0.01]
direction = "normal"
[rig.test]
kind = "impact"
band_hz = [200.0, 1000.0]
resolution_hz = 4.0
blocks = 2
"""
    )
    test = made(study(plate))
    assert test.truth.n.tolist() == [-1] * 4
    assert abs(test.frfs.x[np.abs(test.frfs.responses[0]).argmax()] - test.truth.freq_hz[0]) <= 4.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "words"),
    [
        (CASING.partition("[rig]")[0], r"rig: found nothing, expected a table \[rig\]"),
        (CASING.replace("zeta = 0.003", "zeta = 3.0"), "rig.zeta"),
        (CASING.partition("[[rig.sensor]]")[0] + EXACT, "rig.sensor: found nothing"),
        (CASING + EXACT.replace("[360.0, 440.0]", "[440.0, 360.0]"), "two frequencies in order"),
        (CASING + EXACT.replace("[360.0, 440.0]", "[360.0, 360.01]"), "expected 2 to 1,000,000 lines in the band"),
        (CASING + EXACT.replace("[360.0, 440.0]", "[360.0, 1e9]"), "expected 2 to 1,000,000 lines in the band"),
        (CASING + EXACT + "bits = 12\n", "found bits with exact responses"),
        (CASING + BURST + "[rig.test.troubles]\ndead = 1\n", "found troubles, expected kind"),
        (CASING + EXACT + "[rig.test.troubles]\ndead = -1\n", "rig.test.troubles.dead"),
        (CASING + EXACT + "keep_records = true\n", "found keep_records with exact responses"),
        (CASING + SCAN + "drive = 3\n", "rig.scan.drive: found 3, expected 1 to 1"),
        (CASING + SCAN.replace("mirror_hz = 2.3", ""), "at least one of them to turn"),
        (CASING + SCAN.replace("384.3", "372.4"), "cannot be separated"),
        (CASING + SCAN.replace("6.0", "0.3"), "too short"),
        (CASING.replace("height = 0.25\nangle_deg", "height = 0.35\nangle_deg") + EXACT, "outside the surface"),
        (CASING.replace("height = 0.25\ncount", "at = [0.25, 0.0]\nheight = 0.25\ncount") + EXACT, "one of them"),
        (CASING + SCAN + "wobble = 1\n", "unknown key"),
    ],
)
def test_what_cannot_be_is_refused_with_its_key(study, text, words):
    refused = CliRunner().invoke(main, ["rig", str(study(text))])
    assert refused.exit_code == 2
    assert re.search(words, refused.stderr), refused.stderr
