"""`casingfem interactions` and `campbell`: table, document and picture; a run that diverges keeps its files."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main
from casingfem.modal.campbell import Campbell
from casingfem.plot.interaction import figure_interactions

DATA = Path(__file__).parents[3] / "data"


def call(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.mark.slow
def test_interactions_of_a_pair_are_confirmed_by_a_run(tmp_path):
    found = call("interactions", DATA / "scenes" / "pair.toml", "--out", tmp_path, "--json")
    assert found.exit_code == 0
    document = json.loads(found.stdout)
    (row,) = document["interactions"]
    assert row["growth"] == pytest.approx(3.788, rel=1e-3)
    assert abs(document["run"]["off_rel"]) < 0.05
    assert set(document["columns"]) >= {"growth", "turns", "f_c/n"}
    table = (tmp_path / "interactions.csv").read_text().splitlines()
    assert table[0].startswith("# COMPUTED")
    assert table[-2].split(",")[0] == "n"
    assert float(table[-1].split(",")[9]) == row["growth"]
    assert (tmp_path / "interactions.png").read_bytes()[1:4] == b"PNG"
    said = call("stability", DATA / "scenes" / "pair.toml", "--out", tmp_path)
    assert "the growth column of `casingfem interactions`" in said.stdout
    assert (tmp_path / "stability.png").exists()


def test_the_picture_shows_growing_poles_bands_and_the_run():
    pair = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
        blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4,
    )  # fmt: skip
    found = ct.growth.interactions(pair, np.linspace(52.0, 54.0, 41))
    upper, lower, bar = figure_interactions(found).axes
    assert upper.get_ylabel() == "frequency at the blade [Hz]"
    assert bar.get_ylabel() == "growth [1/s], contact closed"
    coloured = upper.collections[0]
    assert coloured.get_offsets()[:, 0].min() > 52.6  # those in the band alone have a colour
    assert coloured.get_array().max() == pytest.approx(3.78, abs=0.02)
    assert len(lower.patches) == 1


def test_campbell_of_a_study_at_rest_is_refused_and_a_turning_one_drawn(tmp_path):
    refused = call("campbell", DATA / "studies" / "frustum.toml")
    assert refused.exit_code == 2
    assert "rotation" in refused.stderr


@pytest.mark.slow
def test_campbell_of_a_blade(tmp_path):
    found = call(
        "campbell", DATA / "studies" / "rotating_blade.toml", "--count", 2, "--steps", 3, "--to-hz", 50.0,
        "--out", tmp_path, "--json",
    )  # fmt: skip
    assert found.exit_code == 0
    document = json.loads(found.stdout)
    assert document["speed_hz"] == pytest.approx([0.0, 25.0, 50.0])
    meets = [(met["order"], met["mode"]) for met in document["crossings"]]
    assert (4, 1) in meets
    rows = (tmp_path / "campbell.csv").read_text().splitlines()
    assert rows[1] == "speed_hz,mode1_hz,mode2_hz"
    assert [float(cell) for cell in rows[-1].split(",")[1:]] == document["freq_hz"][-1]
    assert (tmp_path / "campbell.png").exists()


def test_a_campbell_diagram_marks_engine_orders():
    data = Campbell(
        omega=2.0 * np.pi * np.array([0.0, 50.0]), freq=np.array([[100.0], [110.0]]), southwell=np.array([2.0]),
        overlap=np.ones((2, 1)),
    )  # fmt: skip
    (axes,) = data.plot(orders=4).axes
    dots = [line for line in axes.lines if line.get_marker() == "o"]
    assert [(round(float(x), 2), round(float(y), 1)) for dot in dots for x, y in dot.get_xydata()] == [
        (35.71, 107.1), (26.32, 105.3),
    ]  # fmt: skip
    assert "3 at 35.71 Hz, 4 at 26.32 Hz" in data.table(4)
    assert cf.campbell is not None


@pytest.mark.slow
def test_a_run_that_diverges_writes_all_it_has_and_ends_with_3(tmp_path):
    from reports.robustness.diverging import RIM, at, bodies

    bodies(tmp_path)
    scene = tmp_path / "rim.toml"
    scene.write_text(at(150.0, scene=RIM))
    found = call("rub", scene, "--out", tmp_path / "out")
    assert found.exit_code == 3
    assert "diverged: the rim moved" in found.stderr
    assert "FLAG: diverged" in found.stdout
    kept = ct.Result.load(tmp_path / "out" / "rub.npz")
    assert kept.divergence.limit == "wall"
    assert json.loads((tmp_path / "out" / "rub.json").read_text())["divergence"]["growth_1_s"] > 100.0
