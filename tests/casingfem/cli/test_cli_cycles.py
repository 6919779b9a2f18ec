"""The command cycles: its document, its files, its exit codes."""

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner

from casingfem.cli import main
from tests.contact.scene.test_scene_cycles import TEXT, written
from tests.probed import numbers_of_document


def invoke(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.mark.slow
def test_cycles_gives_points_folds_and_files(tmp_path, held):
    asked = "\n[basins]\nat = 0.23\nstarts = 3\nseed = 9\nsettle = 150\n"
    file = written(tmp_path, TEXT.replace("to_hz = 0.2", "to_hz = 0.26") + "longest_step = 0.06\n" + asked)
    result = invoke("cycles", file, "--json", "--check", 20, "--out", tmp_path / "out")
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert set(document) == {
        "parameter", "points", "folds", "events", "end", "branches", "seconds", "warnings", "basins",
        "harmonic_balance",
    }  # fmt: skip
    assert set(document["points"][0]) == {"freq_hz", "amplitude", "multiplier", "stable", "contacts", "growth_1_s"}
    assert 2.0 * np.pi * document["folds"][0]["freq_hz"] == pytest.approx(1.5579, rel=3e-3)
    assert document["points"][0]["freq_hz"] == 0.15
    assert document["points"][-1]["freq_hz"] == 0.26
    with (tmp_path / "out" / "cycles.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(document["points"])
    assert float(rows[7]["amplitude_x"]) == document["points"][7]["amplitude"]["x"]
    with np.load(tmp_path / "out" / "cycles.npz") as file_of_arrays:
        arrays = dict(file_of_arrays)
    assert arrays["x"].shape == (len(rows), 2)
    assert np.abs(arrays["multipliers"][7]).max() == document["points"][7]["multiplier"]
    assert "fold" in arrays["special"]
    assert (tmp_path / "out" / "cycles.png").stat().st_size > 10_000
    page = (tmp_path / "out" / "cycles.html").read_text(encoding="utf-8")
    for words in ("How sure", "Floquet", "fold at 0.247", "sha256", "Unstable", "Force"):
        assert words in page, words
    checked = document["harmonic_balance"]
    assert (checked["orbits"], checked["found"]) == (len(rows), len(rows))
    assert 0.0 < checked["amplitude_difference"] < 1e-3
    assert "Harmonic balance (20 harmonics) agrees within" in page
    motions = document["basins"]["motions"]
    assert 0.0 < sum(one["share"] for one in motions) <= 1.0
    assert {"share", "periods", "amplitude_x_m"} == set(motions[0])
    assert "Motions reached from random initial states" in page
    assert "<pre>" not in page
    assert not list((tmp_path / "out").glob("*.part.npz"))
    held(1e-4, document=numbers_of_document(document))


def test_bad_input_ends_with_2_and_writes_nothing(tmp_path):
    file = written(tmp_path, TEXT.replace("amplitude = 0.02\n", ""))
    result = invoke("cycles", file, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "drive: from_hz, to_hz found" in result.stderr
    assert not (tmp_path / "out").exists()
    rigid = written(tmp_path, TEXT.replace("stiffness = 100.0\n", ""))
    result = invoke("cycles", rigid, "--check", 30, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "contact 1: found a rigid contact, expected one with a compliance for harmonic balance" in result.stderr
    assert not (tmp_path / "out").exists()
