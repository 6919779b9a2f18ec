"""[update] with measured shapes: from the file to rows of the table and places on the wall; what is wrong is named."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main

STUDIES = Path(__file__).parents[3] / "data" / "studies"
BENCH = STUDIES / "bench_model.toml"
STUDY = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
[chart]
kind = "frustum"
r_base = 0.50
r_top = 0.45
height = 0.25
[shell]
thickness = 3.0e-3
[[imperfection]]
of = "radius"
harmonics = [{p = 14, cos = 0.0003}, {p = 16, cos = 0.0005}]
[support.base]
kind = "clamped"
[mesh]
order = 5
rows = 1
around = 11
[update]
table = "table.csv"
shapes = "shapes.uff"
SHAPES
[[update.parameter]]
name = "material.E"
lower = 150e9
upper = 250e9
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A casing's own frequencies and shapes."""
    where = tmp_path_factory.mktemp("study")
    (where / "bare.toml").write_text(STUDY.partition("[update]")[0] + "[modes]\ncount = 8\n", encoding="utf-8")
    found = cf.modes(cf.load_study(where / "bare.toml").shell, 8)
    arguments = ["modes", str(where / "bare.toml"), "--uff", "--modes", "1,2,3,4", "--out", str(where)]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    (where / "modes.uff").rename(where / "shapes.uff")
    table = cf.FrequencyTable.from_arrays(freq_hz=found.freq[:6], sigma_hz=0.01, n=found.nodal_diameters[:6])
    table.to_csv(where / "table.csv")
    return where


def study(folder, keys="shape_sigma = 0.01", **other):
    text = STUDY.replace("SHAPES", keys)
    for old, new in other.items():
        text = text.replace(f"{old}.", new)
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return folder / "study.toml"


@pytest.mark.slow
def test_shapes_of_a_universal_file_go_to_their_rows(folder):
    loaded = cf.load_study(study(folder, "shape_sigma = 0.03\nshape_error = 0.04"))
    shapes = loaded.shapes
    assert np.isnan(shapes.shapes[0]).tolist() == [False] * 4 + [True] * 2
    np.testing.assert_allclose(shapes.sigma[:4], 0.05 / np.sqrt(len(shapes.a)))
    found = cf.modes(loaded.shell, 8)
    np.testing.assert_allclose(np.diag(shapes.mac(found))[:4], 1.0, atol=1e-6)


def test_identified_shapes_bring_their_noise_and_n():
    loaded = cf.load_study(BENCH)
    shapes, identified = loaded.shapes, cf.Identified.load(STUDIES / "../experiments/bench.npz")
    own = np.linalg.norm(identified.sigma_shapes, axis=0)
    assert loaded.file.update.shape_error == 2e-3
    np.testing.assert_allclose(shapes.sigma, np.hypot(own, 2e-3) / np.sqrt(24))
    np.testing.assert_allclose(shapes.a, 0.25, atol=1e-9)
    np.testing.assert_allclose(np.degrees(shapes.b) % 360.0, 15.0 * np.arange(24), atol=1e-6)
    assert loaded.table.synthetic
    assert identified.card[0].startswith("SYNTHETIC")


@pytest.mark.slow
def test_the_digest_knows_the_shapes(folder):
    other = study(folder, "shape_sigma = 0.01 #")
    before = cf.load_study(other).source["sha256"]
    saved = (folder / "shapes.uff").read_bytes()
    (folder / "shapes.uff").write_bytes(saved.replace(b"modes of a shell", b"MODES of a shell"))
    after = cf.load_study(other).source["sha256"]
    (folder / "shapes.uff").write_bytes(saved)
    assert before != after


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("", "update.shape_sigma: found nothing, expected the relative noise of the shapes, which shapes.uff"),
        ("shape_sigma = 0", "update.shape_sigma: found 0"),
        ("shape_error = 1.5\nshape_sigma = 0.1", "update.shape_error: found 1.5"),
        ("shape_sigmas = 0.1", "did you mean shape_sigma?"),
        ("shape_sigma = 0.01\nshape_reach = 1e-9", "update.shapes: "),
    ],
)
def test_keys_are_checked(folder, keys, words):
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(study(folder, keys))
    assert any(words in problem for problem in caught.value.problems), caught.value.problems


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("nowhere.uff", None, "nowhere.uff: found no such file"),
        ("shapes.csv", b"", "found ending '.csv'; expected .uff"),
        ("shapes.npz", b"PK", "no readable npz file"),
        ("shapes2.uff", b"    -1\n   151\n" + b"x\n" * 7 + b"    -1\n", "expected modes in sets 55"),
    ],
)
def test_files_that_are_no_shapes_are_named(folder, name, content, words):
    if content is not None:
        (folder / name).write_bytes(content)
    path = study(folder, **{'"shapes': f'"{name.partition(".")[0]}.'})
    path.write_text(path.read_text().replace(f'"{name.partition(".")[0]}.uff"', f'"{name}"'), encoding="utf-8")
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(path)
    assert words in str(caught.value)
    assert str(folder / name) in str(caught.value)


def test_keys_of_shapes_need_shapes(folder):
    path = study(folder, "shape_error = 0.1")
    path.write_text(path.read_text().replace('shapes = "shapes.uff"\n', ""), encoding="utf-8")
    with pytest.raises(cf.errors.InputError, match="found shape_error without shapes, expected shapes = a file"):
        cf.load_study(path)


def test_shapes_off_the_wall_are_refused(folder):
    with pytest.raises(cf.errors.InputError, match=r"update.shapes: sensor \d+ at"):
        cf.load_study(study(folder, **{"height = 0": "height = 1."}))


ALIKE = {"points": np.eye(3), "directions": np.eye(3)}


def shapes_at(freq, n=-1):
    values = np.random.default_rng(5).standard_normal((3, len(freq)))
    return cf.correlation.MeasuredShapes.from_arrays(freq_hz=freq, values=values, n=n, path="test.uff", **ALIKE)


def rows(freq, n=-1):
    return cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=0.01, n=n, path="table.csv")
