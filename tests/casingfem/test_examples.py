"""The examples that come with the program: listed, written with what they need, never over a file, and they run."""

import json
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import casingfem as cf
from casingfem.cli import main
from casingfem.examples import DATA, examples, strings
from reports.studies.section_44 import THICKNESS

ROOT = Path(__file__).parents[2]


def invoke(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_study_and_scene_is_an_example_but_the_chain_of_make_study_and_what_only_makes_bases():
    stems = {path.relative_to(ROOT / "data").as_posix() for path in (ROOT / "data").rglob("*.toml")}
    named = {example.file.as_posix() for example in examples().values()}
    parts = {f"scenes/{folder}/{part}.toml" for folder in ("rub", "interaction_map") for part in ("casing", "blade")}
    assert named == stems - parts - {"studies/rig.toml"}


def test_the_list_has_a_line_for_each():
    lines = invoke("example").stdout.splitlines()
    assert [line.split()[0] for line in lines[:-1]] == list(examples())
    assert all(len(line.split()) > 4 for line in lines)
    listed = {entry["name"]: entry for entry in json.loads(invoke("example", "--json").stdout)["examples"]}
    assert listed["frustum"]["about"] == (
        "A clamped frustum with three harmonics of out-of-roundness, all below half a per cent of its radius."
    )
    commands = {"bench_casing": "rig", "mistuning": "mistune", "olson_lindberg": "update", "bolted_ring": "modes",
                "pair": "stability", "two_rods": "contact", "two_rods_sweep": "sweep", "bladed_disk": "rub",
                "interaction_map/map": "sweep", "beam_in_ring": "contact",
                "cycles/rod_on_obstacle": "cycles"}  # fmt: skip
    assert {name: listed[name]["command"] for name in commands} == commands


@pytest.mark.slow
@pytest.mark.parametrize("name", examples())
def test_what_a_file_names_is_written_or_made_by_what_is_said_next(here, name):
    document = json.loads(invoke("example", name, "--json").stdout)
    written = {Path(file) for file in document["files"]}
    assert all(path.read_bytes() == (ROOT / path).read_bytes() for path in written)
    assert written == {path.relative_to(here) for path in here.rglob("*") if path.is_file()}
    assert document["next"][-1].split()[2] == document["files"][0]
    made = set()
    for line in document["next"][:-1]:
        _, reduce, study, out, folder = line.split()
        assert (reduce, out, Path(study) in written) == ("reduce", "--out", True)
        made.add(Path(folder) / tomllib.loads(Path(study).read_text(encoding="utf-8"))["reduce"]["out"])
    for file in (path for path in written if path.suffix == ".toml"):
        tables = tomllib.loads(file.read_text(encoding="utf-8"))
        tables.pop("reduce", None)  # what it writes
        named = {file.parent / text for _, text in strings(tables) if text.endswith((".csv", ".npz", ".toml"))}
        assert all(path in made or path.is_file() for path in named)


def test_nothing_is_overwritten_and_a_table_that_is_there_stays(here):
    assert invoke("example", "rig_casing").exit_code == 0
    again = invoke("example", "rig_casing")
    assert again.exit_code == 2
    assert "data/studies/rig_casing.toml: found such a file, expected none" in again.stderr
    other = invoke("example", "rig_test")  # shares the survey
    assert other.stdout.splitlines()[0] == "wrote data/studies/rig_test.toml"
    assert "rig_casing.csv" not in other.stdout
    Path("data/studies/rig_test.toml").unlink()
    survey = Path("data/surveys/rig_casing.csv")
    survey.write_text("mine\n", encoding="utf-8")
    refused = invoke("example", "rig_test")
    assert refused.exit_code == 2
    assert "data/surveys/rig_casing.csv: found such a file" in refused.stderr
    assert survey.read_text(encoding="utf-8") == "mine\n"
    assert not Path("data/studies/rig_test.toml").exists()
    assert invoke("example", "rig_test", "--out", "elsewhere").exit_code == 0
    assert Path("elsewhere/surveys/rig_casing.csv").read_bytes() == (DATA / "surveys/rig_casing.csv").read_bytes()


@pytest.mark.parametrize(
    ("wrong", "near"), [("two_rod", "two_rods"), ("five_nodes", "rub/five_nodes"), ("frustrum", "frustum")]
)
def test_a_wrong_name_offers_the_nearest(here, wrong, near):
    result = invoke("example", wrong)
    assert result.exit_code == 2
    assert f"found '{wrong}'" in result.stderr
    assert near in result.stderr.partition("did you mean")[2]
    assert list(here.iterdir()) == []


def test_where_no_name_is_near_those_that_hold_the_word_are_offered(here):
    words = invoke("example", "ring").stderr.split()
    assert words[words.index("(did") :] == ["(did", "you", "mean", "bolted_ring", "or", "beam_in_ring?)"]


def test_a_calculation_of_a_second_runs_as_is_said(here):
    for line in json.loads(invoke("example", "pair", "--json").stdout)["next"]:
        assert json.loads(invoke(*line.split()[1:], "--json").stdout)["peak"]["growth"] > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("hz", [423, 418, 388])
def test_the_blades_of_the_rubs_are_those_of_their_report(here, hz):
    assert invoke("example", f"rub_blade_{hz}").exit_code == 0
    study = Path(f"data/studies/rub_blade_{hz}.toml")
    assert cf.load_study(study).shell.thickness == THICKNESS[f"blade_{hz}"]
    (freq, *_) = json.loads(invoke("reduce", study, "--out", here, "--json").stdout)["freq_hz"]
    assert freq == pytest.approx(hz, abs=1.0)
