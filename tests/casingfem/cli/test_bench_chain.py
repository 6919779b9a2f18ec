"""From the test bench to the updated model by the command line alone: rig, identify, correlate, update, report."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main

STUDIES = Path(__file__).parents[3] / "data" / "studies"
TRUTH = {
    "material.E": 204e9,
    "support.base.k_face": 3e12,
    "support.base.around.p3.cos": 0.35,
    "support.base.around.p3.sin": -0.2,
}  # of bench_casing.toml


def run(*arguments):
    result = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def off(document):
    """Distance of each parameter from the truth in its sigma, which a misfit above 1 widens."""
    found = {}
    for entry in document["parameters"]:
        value, truth = entry["value"], TRUTH[entry["name"]]
        error = np.log10(value / truth) if entry["log"] else value - truth
        found[entry["name"]] = error / (entry["sigma"] * max(document["misfit"], 1.0))
    return found


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """The bench's two studies, smaller: coarser meshes, fewer lines, a nearer guess."""
    folder = tmp_path_factory.mktemp("bench")
    casing = (STUDIES / "bench_casing.toml").read_text(encoding="utf-8")
    casing = casing.replace("order = 8", "order = 7").replace("around = 15", "around = 12")
    casing = casing.replace("band_hz = [295.0, 410.0]", "band_hz = [295.0, 365.0]")
    (folder / "bench_casing.toml").write_text(casing, encoding="utf-8")
    model = (STUDIES / "bench_model.toml").read_text(encoding="utf-8")
    model = model.replace("order = 8", "order = 7").replace("k_face = 1e13", "k_face = 4e12")
    model = model.replace("E = 210e9 ", "E = 206e9 ")
    model = model.replace("../experiments/bench.csv", "out/identified.csv")
    model = model.replace("../experiments/bench.npz", "out/identified.npz")
    (folder / "bench_model.toml").write_text(model, encoding="utf-8")
    return folder


@pytest.mark.campaign
def test_from_the_bench_to_the_updated_model(bench):
    out, model = bench / "out", bench / "bench_model.toml"
    assert run("rig", bench / "bench_casing.toml", "--out", out, "--json")["synthetic"]
    modes = run("identify", out / "frfs.uff", "--out", out, "--json")["modes"]
    truth = cf.FrequencyTable.from_csv(out / "truth.csv")
    inside = (truth.freq_hz > 295.0) & (truth.freq_hz < 365.0)
    freq, sigma = (np.array([mode[key] for mode in modes]) for key in ("freq_hz", "sigma_hz"))
    assert np.all(sigma < 1e-5 * freq)
    assert np.all(np.abs(freq - truth.freq_hz[inside]) < 4.0 * sigma)
    assert [mode["n"] for mode in modes] == truth.n[inside].tolist()

    before = run("correlate", model, out / "identified.npz", "--json")
    fit = run("update", model, "--out", out, "--json")
    assert max(map(abs, off(fit).values())) < 3.0, off(fit)
    assert fit["rms_after"] < 0.05 * fit["rms_before"]
    assert fit["iterations"] <= 20  # frequencies alone wander for thirty once they agree to their noise
    planes = [row["plane_after"] for row in fit["shapes"]["rows"]]
    assert len(planes) == len(modes)
    assert min(planes) > 0.999
    after = run("correlate", out / "bench_model_updated.toml", out / "identified.npz", "--json")
    macs = [[row["subspace_mac"] or 0.0 for row in document["shapes"]] for document in (before, after)]
    assert min(macs[1]) > 0.999
    assert np.mean(macs[1]) > np.mean(macs[0])

    run("report", out / "bench_model_updated.toml", "--out", out, "--json")
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "<h2>Mode shapes</h2>" in page
    assert "SYNTHETIC" in page
    assert "Mode shapes at 24 sensors from identified.npz" in page
