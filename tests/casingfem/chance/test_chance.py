"""`casingfem chance`: draws, answers, resume, the worst casings; what is refused."""

import json
import shutil
import tomllib

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner
from scipy.stats import lognorm, truncnorm, uniform

import casingfem as cf
from casingfem.cli import main
from contact import ModalBody, load_scene
from tests.casingfem.study.study_texts import STEEL
from tests.probed import numbers_of_document

STUDY = (
    STEEL
    + """
[chart]
kind = "cylinder"
radius = 0.5
height = 0.3
[shell]
thickness = 0.01
[support.base]
kind = "clamped"
[[imperfection]]
of = "radius"
random = "example"
seed = 7
scale = 0.2
p_max = 5
[[imperfection]]
of = "thickness"
random = [{p = 2, median = 0.002}, {p = 8, median = 0.001}]
seed = 7
[mesh]
order = 7
rows = 1
around = 11
[reduce]
interface = "top"
n_max = 8
modes = 8
zeta = 0.002
out = "casing.npz"
"""
)
SCENE = """
[scene]
kind = "rim"
t_end = 1e-3
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = 1e-3
friction = 0.3
[speed]
hz = 5.0
turning = "blades"
scan = {from_hz = 5.0, to_hz = 60.0, steps = 12}
[scheme]
kind = "exact-modal"
dt = 1e-5
[chance]
study = "casing.toml"
seed = 11
draws = 52
worst = 1
runs = 2
turns = 0.05
importance = 4
[chance.blade]
deviation = 0.02
[chance.clearance]
deviation = 1e-4
[chance.friction]
deviation = 0.05
law = "uniform"
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Study, scene and bases, and the first run."""
    folder = tmp_path_factory.mktemp("chance")
    (folder / "casing.toml").write_text(STUDY)
    (folder / "scene.toml").write_text(SCENE)
    study = cf.load_study(folder / "casing.toml")
    cf.reduce(study.structure, study.interface, modes=8, zeta=0.002).save(folder / "casing.npz")
    ModalBody(
        omega=[2.0 * np.pi * 350.0], zeta=[0.002], channels=("span", "flap"), rows=[[0.05], [2.0]],
        S=[[2e-8, 0.0], [0.0, 6e-8]],
    ).save(folder / "blade.npz")  # fmt: skip
    return folder


def run(folder, *options, scene="scene.toml"):
    return CliRunner().invoke(main, ["chance", str(folder / scene), "--processes", "1", *options])


@pytest.fixture(scope="module")
def first(made):
    result = run(made, "--out", str(made / "out"), "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@pytest.mark.slow
def test_answers_have_every_part(made, first, held):
    assert first["casings"] == 52
    assert 0.0 < first["dangerous"]["low"] < first["dangerous"]["value"] < first["dangerous"]["high"] <= 1.0
    assert len(first["speeds"]) == 12
    assert first["in_full"] >= 2  # draws 0 and 50 are checks
    assert 0.0 < first["largest_difference"] < 0.02
    assert len(first["runs"]) == 2
    assert all(row["verdict"] in ("unstable", "resonance", "safe", "not decided") for row in first["runs"])
    assert all(row["low"] <= row["probability"] <= row["high"] for row in first["speeds"])
    assert {row["group"] for row in first["importance"]} == {
        "radius field", "thickness field", "blade", "clearance", "friction",
    }  # fmt: skip
    names = {path.name for path in (made / "out").iterdir()}
    assert names >= {"chance.csv", "chance_pairs.csv", "chance_speeds.csv", "chance.json", "chance.html", "worst"}
    held(1e-4, first=numbers_of_document(first))


@pytest.mark.slow
def test_the_worst_casing_is_a_study_with_the_keys_of_its_own_study(made, first):
    (path,) = (made / "out" / "worst").rglob("casing.toml")
    written, stated = (tomllib.loads(text) for text in (path.read_text(encoding="utf-8"), STUDY))
    for tables in (written, stated):
        tables.pop("imperfection")
        tables["reduce"].pop("out")
    assert written == stated


@pytest.fixture(scope="module")
def lawful(made, tmp_path_factory):
    """The files of casings with another law for each number, without runs and worst casings."""
    out = tmp_path_factory.mktemp("lawful")
    head = SCENE.partition("[chance.blade]")[0].replace("draws = 52", "draws = 64")
    head = head.replace("worst = 1", "worst = 0").replace("runs = 2", "runs = 0").replace("importance = 4", "")
    laws = """[chance.blade]
deviation = 0.3
law = "lognormal"
[chance.clearance]
deviation = 1e-4
mean = 9e-4
[chance.friction]
deviation = 0.1
law = "uniform"
"""
    (made / "laws.toml").write_text(head + laws)
    result = run(made, "--out", str(out), scene="laws.toml")
    assert result.exit_code == 0, result.output
    return out


@pytest.mark.slow
def test_without_runs_and_worst_casings_only_the_tables_and_the_page_are_written(lawful):
    written = {path.relative_to(lawful).as_posix() for path in lawful.iterdir()}
    tables = {"chance.csv", "chance_pairs.csv", "chance_speeds.csv"}
    assert written == {*tables, "chance.json", "chance.html", "draws"}
    assert json.loads((lawful / "chance.json").read_text())["runs"] == []


@pytest.mark.slow
def test_drawn_numbers_have_their_laws(lawful):
    """Each is the quantile of one random number of the points of `cf.chance`; a normal law is cut at 4 sigma."""
    table = pd.read_csv(lawful / "chance.csv", comment="#")
    spread = np.sqrt(np.log(1.09))
    expected = {
        "blade": lognorm(spread, scale=np.exp(-0.5 * spread**2)), "friction": uniform(0.3 - 0.1 * 3**0.5, 0.2 * 3**0.5),
        "clearance": truncnorm(-4.0, 4.0, loc=9e-4, scale=1e-4),
    }  # fmt: skip
    assert expected["blade"].mean() == pytest.approx(1.0)
    assert expected["blade"].std() == pytest.approx(0.3)
    reached = [law.cdf(table[name].to_numpy())[:, None] for name, law in expected.items()]
    sizes = []  # numbers of random numbers, of which each of these is one
    for size in range(3, 60):
        u = cf.chance.points(11, range(64), size)
        columns = [np.flatnonzero(np.abs(own - u).max(axis=0) < 1e-9).tolist() for own in reached]
        if any(columns):
            sizes.append(size)
            assert len({column for (column,) in columns}) == 3
    assert len(sizes) == 1


@pytest.mark.slow
def test_a_run_that_goes_on_gives_the_same_numbers_to_the_last_bit(made, first, tmp_path):
    again = tmp_path / "out"
    shutil.copytree(made / "out" / "draws", again / "draws")
    lot = min((again / "draws").glob("draws_*.npz"))
    lot.write_bytes(lot.read_bytes()[:-40])  # torn
    result = run(made, "--out", str(again), "--json")
    assert result.exit_code == 0, result.output
    assert (again / "chance.csv").read_bytes() == (made / "out" / "chance.csv").read_bytes()
    assert json.loads(result.stdout)["importance"] == first["importance"]
    assert json.loads(result.stdout)["runs"] == first["runs"]


@pytest.mark.slow
def test_more_draws_are_added_and_another_scene_is_refused(made, first, tmp_path):
    for name in ("casing.toml", "casing.npz", "blade.npz"):
        shutil.copy(made / name, tmp_path / name)
    shutil.copytree(made / "out" / "draws", tmp_path / "out" / "draws")
    (tmp_path / "scene.toml").write_text(SCENE.replace("draws = 52", "draws = 60").replace("worst = 1", "worst = 0"))
    result = run(tmp_path, "--out", str(tmp_path / "out"), "--json")
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["casings"] == 60
    (tmp_path / "scene.toml").write_text(SCENE.replace("friction = 0.3", "friction = 0.25"))
    result = run(tmp_path, "--out", str(tmp_path / "out"))
    assert result.exit_code == 2
    assert "another scene, study or version" in result.output


@pytest.mark.slow
def test_the_worst_casing_is_a_scene_and_a_study_of_its_own(made, first):
    folder = made / "out" / "worst" / "01"
    scene = load_scene(folder / "scene.toml")
    row = (made / "out" / "chance.csv").read_text().splitlines()
    names = next(line for line in row if not line.startswith("#")).split(",")
    own = next(line for line in row if line.startswith(f"{first['worst'][0]},")).split(",")
    values = dict(zip(names, own, strict=True))
    assert scene.what.clearance == float(values["clearance"])
    assert scene.what.speed_hz == float(values["at_hz"])
    assert scene.law.mu == float(values["friction"])
    casing = cf.load_study(folder / "casing.toml")
    full = cf.reduce(casing.structure, casing.interface, modes=8, zeta=0.002)
    assert ModalBody.load(folder / "casing.npz").omega == pytest.approx(full.omega, rel=1e-3)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("deviation = 0.02", "deviation = -0.02", "chance.blade.deviation: found -0.02"),
        ("deviation = 1e-4", "deviation = 1e-3", "chance.clearance: found a normal law"),
        ("deviation = 0.05", "deviation = 0.2", "chance.friction: found a uniform law"),
        ("[chance.friction]", "[chance.frictoin]", "unknown key, expected one of study, draws"),
        ("[chance.friction]", "[chance.closing]", "chance.closing: found it, but the scene has no [closing]"),
        ('study = "casing.toml"', 'study = "none.toml"', "none.toml: found no such file"),
        ("importance = 4", "importance = 9", "expected 0 or a power of 2"),
        ('law = "uniform"', 'law = "gamma"', "'normal', 'uniform' or 'lognormal'"),
    ],
)
def test_bad_input_is_refused_with_file_and_key(made, old, new, words):
    (made / "bad.toml").write_text(SCENE.replace(old, new, 1))
    result = run(made, scene="bad.toml")
    assert result.exit_code == 2
    assert "Traceback" not in result.output
    assert words in " ".join(result.output.split())


@pytest.mark.parametrize(
    ("name", "keys", "words"),
    [
        ("clearance", "deviation = 2.5e-4", ""),
        ("clearance", "deviation = 2.51e-4", "a normal law of mean 0.001 and standard deviation 0.000251, which reaches"
         " -4e-06, expected values >= 0"),
        ("clearance", "deviation = 5.77e-4\nlaw = 'uniform'", ""),
        ("clearance", "deviation = 5.78e-4\nlaw = 'uniform'", "which reaches -1.13e-06"),
        ("clearance", "deviation = 1e-2\nlaw = 'lognormal'", ""),
        ("clearance", "deviation = 1e-3\nmean = 4e-3", ""),
        ("clearance", "deviation = 1e-3\nmean = 3.9e-3", "which reaches -0.0001"),
        ("clearance", "deviation = 1e-3\nmean = -1e-4", ""),  # an interference may be of any size
        ("clearance", "deviation = 1e-3\nmean = 0.0", "which reaches -0.004"),
        ("clearance", "deviation = 1e-3\nmean = 0.0\nlaw = 'lognormal'", "expected a mean above 0"),
        ("friction", "deviation = 0.075", ""),
        ("friction", "deviation = 0.0751", "which reaches -0.0004"),
        ("blade", "deviation = 0.2499", ""),
        ("blade", "deviation = 0.25", "a normal law of mean 1 and standard deviation 0.25, which reaches 0, expected"
         " ratios above 0"),
        ("blade", "deviation = 0.25\nmean = 1.01", ""),
        ("blade", "deviation = 0.25\nlaw = 'lognormal'", ""),
    ],
)  # fmt: skip
def test_a_law_that_reaches_impossible_values_is_refused_and_no_other(made, name, keys, words):
    text = SCENE.partition("[chance.blade]")[0].replace('"casing.toml"', '"none.toml"')
    (made / "bad.toml").write_text(f"{text}[chance.{name}]\n{keys}\n")
    found = " ".join(run(made, scene="bad.toml").output.split())
    assert "none.toml: found no such file" in found
    assert (f"chance.{name}: found" in found) == bool(words)
    assert words in found


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (STUDY[STUDY.index("[reduce]") :], "", "reduce: found no rim of a casing, expected [reduce] with interface"),
        ("n_max = 8\n", "n_max = 9\n", "casing.basis: found n_max = 8, 1 lines, expected n_max = 9 and one line"),
        ('kind = "clamped"', 'kind = "bolts"\ncount = 4\nk = 1e8', "found a casing that needs a full solution for"),
        (STUDY[STUDY.index("[[imp") : STUDY.index("[mesh]")], '[[imperfection]]\nof = "radius"\nharmonics = [{p = 2,'
         " cos = 0.001}]\n", "imperfection: found no random one, expected [[imperfection]] with random and seed"),
        ("p_max = 5", "p_max = 26", "imperfection[1]: found harmonic 26 of the radius, expected at most 25 on the 77"),
        ("{p = 8,", "{p = 26,", "imperfection[2]: found harmonic 26 of the thickness, expected at most 25 on the 77"),
    ],
)  # fmt: skip
def test_a_study_without_random_casings_of_the_scene_s_rim_is_refused(made, old, new, words):
    assert STUDY.count(old) == 1
    (made / "other.toml").write_text(STUDY.replace(old, new))
    (made / "bad.toml").write_text(SCENE.replace("casing.toml", "other.toml"))
    result = run(made, scene="bad.toml")
    assert result.exit_code == 2
    assert words in " ".join(result.output.split())


def test_all_that_is_wrong_is_reported_at_once(made):
    text = SCENE.replace("deviation = 1e-4", "deviation = 1e-3").replace("deviation = 0.05", "deviation = 0.2")
    (made / "bad.toml").write_text(text.replace("friction = 0.3", "friction = 0.3\nfriciton = 1.0"))
    found = run(made, scene="bad.toml").output
    assert "friciton" in found
    (made / "bad.toml").write_text(text)
    found = run(made, scene="bad.toml").output
    assert "chance.clearance" in found
    assert "chance.friction" in found


def test_a_spectrum_beyond_the_mesh_is_refused(made):
    (made / "fine.toml").write_text(STUDY.replace("p_max = 5", "p_max = 40"))
    (made / "bad.toml").write_text(SCENE.replace("casing.toml", "fine.toml"))
    result = run(made, scene="bad.toml")
    assert result.exit_code == 2
    assert "found harmonic 40 of the radius, expected at most 25" in " ".join(result.output.split())


@pytest.mark.campaign  # two workers import everything
def test_workers_of_a_cluster_give_the_same_table(made, first, tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, dashboard_address=None, local_directory=tmp_path
    ) as cluster:
        options = ("--scheduler", cluster.scheduler_address, "--out", str(tmp_path / "out"))
        result = run(made, *options)
    assert result.exit_code == 0, result.output
    for name in ("chance.csv", "chance_pairs.csv", "chance_speeds.csv"):
        assert (tmp_path / "out" / name).read_bytes() == (made / "out" / name).read_bytes()
