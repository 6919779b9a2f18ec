"""casingfem identify: files in, table and pictures out."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from tests.probed import numbers_of_document

THETA = np.radians(np.arange(12) * 30.0 + 5.0)


@pytest.fixture(scope="module")
def frfs():
    """A pair of n = 3 and a single n = 0."""
    at = np.r_[THETA, 0.4]
    rows = np.column_stack([np.cos(3 * (at - 0.1)), np.cos(3 * (at - 0.1) - np.pi / 2), np.ones(13)])
    probes = [cf.rig.Probe(k + 1, 1, (np.cos(a), np.sin(a), 0.0), a) for k, a in enumerate(at)]
    rig = cf.rig.Rig.of(omega=2 * np.pi * np.array([200.0, 201.0, 230.0]), zeta=0.003, rows=rows, probes=probes)
    return cf.rig.noisy(rig.frfs(np.arange(190.0, 240.0, 0.1), sensors=range(12), drives=[12]), 40.0, seed=61)


@pytest.fixture(scope="module")
def uff(frfs, tmp_path_factory):
    path = tmp_path_factory.mktemp("uff") / "frfs.uff"
    points = np.column_stack([0.5 * np.cos(THETA), 0.5 * np.sin(THETA), np.zeros(12)])
    zeros = np.zeros(12, np.int64)
    nodes = cf.uff.Nodes(labels=np.arange(1, 13), points=points, systems=zeros, motions=zeros)
    return cf.uff.write_uff(path, nodes=nodes, functions=frfs.functions(), binary=True)


def invoke(*arguments):
    return CliRunner().invoke(main, ["identify", *map(str, arguments)])


@pytest.mark.slow
def test_a_universal_file_gives_table_pictures_and_a_document(uff, tmp_path, held):
    result = invoke(uff, "--out", tmp_path / "out", "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert [mode["n"] for mode in document["modes"]] == [3, 3, 0]
    assert [mode["doublet"] for mode in document["modes"]] == [1, 1, None]
    np.testing.assert_allclose([mode["freq_hz"] for mode in document["modes"]], [200, 201, 230], rtol=1e-4)
    table = cf.FrequencyTable.from_csv(tmp_path / "out" / "identified.csv")
    page = (tmp_path / "out" / "identified.html").read_text(encoding="utf-8")
    for words in ("How sure", "The residual of the fit", "Modes found", "sha256"):
        assert words in page, words
    assert table.n.tolist() == [3, 3, 0]
    assert table.angle_deg[0] == pytest.approx(np.degrees(0.1), abs=0.5)
    shapes = cf.correlation.read_shapes(tmp_path / "out" / "identified.npz")
    np.testing.assert_allclose(np.hypot(*shapes.points[:, :2].T), 0.5)  # at the nodes of the file
    np.testing.assert_allclose(shapes.freq_hz, table.freq_hz)
    for name in ("stabilisation.png", "responses.png"):
        assert (tmp_path / "out" / name).read_bytes()[:4] == b"\x89PNG"
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_npz_with_angles_and_a_band(frfs, tmp_path):
    path, angles = frfs.save(tmp_path / "frfs.npz"), tmp_path / "angles.csv"
    angles.write_text("point,angle_deg\n" + "".join(f"{k + 1},{np.degrees(a)}\n" for k, a in enumerate(THETA)))
    result = invoke(path, "--angles", angles, "--band", 190, 215, "--json")
    assert [mode["n"] for mode in json.loads(result.stdout)["modes"]] == [3, 3]


@pytest.mark.slow
def test_a_table_of_sensors_places_the_shapes(frfs, tmp_path):
    path, sensors = frfs.save(tmp_path / "frfs.npz"), tmp_path / "sensors.csv"
    rows = (f"{k + 1},{np.degrees(a)},0.5,0.2\n" for k, a in enumerate(THETA))
    sensors.write_text("point,angle_deg,radius_m,z_m\n" + "".join(rows))
    assert invoke(path, "--angles", sensors, "--band", 190, 215, "--out", tmp_path).exit_code == 0
    places = cf.Identified.load(tmp_path / "identified.npz").sensors.places
    np.testing.assert_allclose(places, np.column_stack([0.5 * np.cos(THETA), 0.5 * np.sin(THETA), np.full(12, 0.2)]))


@pytest.mark.slow
def test_picked_poles_are_refined_and_no_other_is_added(frfs, tmp_path, held):
    path, picks = frfs.save(tmp_path / "frfs.npz"), tmp_path / "picks.csv"
    picks.write_text("mode,freq_hz\n1,200.3\n2,229.8\n")
    document = json.loads(invoke(path, "--pick", picks, "--json", "--out", tmp_path / "out").stdout)
    assert len(document["modes"]) == 2
    assert document["modes"][1]["freq_hz"] == pytest.approx(230.0, abs=0.01)
    assert 200.0 < document["modes"][0]["freq_hz"] < 201.0  # one pole for a pair
    picks.write_text("freq_hz\n200.05\n200.9\n230.1\n")
    document = json.loads(invoke(path, "--pick", picks, "--json").stdout)
    np.testing.assert_allclose([mode["freq_hz"] for mode in document["modes"]], [200, 201, 230], rtol=1e-4)
    picks.write_text("freq_hz\n500.0\n")
    result = invoke(path, "--pick", picks)
    assert result.exit_code == 2
    assert "500 Hz picked" in result.stderr
    picks.write_text("hz\n200.0\n")
    assert "freq_hz" in invoke(path, "--pick", picks).stderr
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_an_open_part_has_no_n(uff, tmp_path):
    result = invoke(uff, "--open", "--json", "--out", tmp_path)
    assert [mode["n"] for mode in json.loads(result.stdout)["modes"]] == [None, None, None]
    np.testing.assert_array_equal(
        np.abs(cf.correlation.read_shapes(tmp_path / "identified.npz").directions[0]), [1.0, 0.0, 0.0]
    )
    (tmp_path / "angles.csv").write_text("point,angle_deg\n1,0\n")
    assert "--open is for parts" in invoke(uff, "--open", "--angles", tmp_path / "angles.csv").stderr


@pytest.mark.slow
def test_without_angles_modes_have_no_n(frfs, tmp_path):
    result = invoke(frfs.to_csv(tmp_path / "frfs.csv"), "--json")
    assert [mode["n"] for mode in json.loads(result.stdout)["modes"]] == [None, None, None]


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("frfs.mat", "", ".mat"),
        ("angles.csv", "point,angle\n1,0\n", "expected angle_deg, or angle [deg]"),
        ("angles.csv", "point,angle_deg\n1,0\n1,4\n", "1 again"),
        ("angles.csv", "point,angle_deg\n1,0\n", "no angle for point 2"),
    ],
)
def test_bad_input_ends_with_2(frfs, tmp_path, name, text, words):
    bad = tmp_path / name
    bad.write_text(text)
    good = frfs.save(tmp_path / "frfs.npz")
    result = invoke(bad) if name == "frfs.mat" else invoke(good, "--angles", bad)
    assert result.exit_code == 2
    assert words in result.stderr


def test_a_window_without_a_time_constant_ends_with_2(frfs, tmp_path):
    result = invoke(frfs.save(tmp_path / "frfs.npz"), "--exponential", "0")
    assert result.exit_code == 2
    assert "exponential_window_s 0.0" in result.stderr
