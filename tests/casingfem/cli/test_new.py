"""`casingfem new` and `watch`: a folder that runs as it is, and files run again when they are saved; completion."""

import json
import time
import tomllib
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from tests.casingfem.study.study_texts import STEEL_PLATE

PLATE = f"""{STEEL_PLATE}[modes]
count = 2
[reduce]
interface = "tip"
out = "plate.npz"
"""


def invoke(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_new_folder_is_whole_and_states_what_to_type(here):
    document = json.loads(invoke("new", "mine", "--json").stdout)
    names = {"casing.toml", "blade.toml", "rub.toml", "survey.csv", "frequencies.csv"}
    assert {path.name for path in (here / "mine").iterdir()} == names
    assert document["next"][0] == "cd mine"
    casing, blade = (cf.load_study(here / "mine" / f"{name}.toml") for name in ("casing", "blade"))
    assert casing.table.path.endswith("frequencies.csv")
    assert (casing.file.reduce.out, blade.file.reduce.out) == ("casing.npz", "blade.npz")
    every = " ".join(path.read_text(encoding="utf-8") for path in (here / "mine").glob("*.toml"))
    for absent in ("../", "data/"):
        assert absent not in every


def test_nothing_that_is_there_is_touched(here):
    (here / "mine").mkdir()
    again = invoke("new", "mine")
    assert again.exit_code == 2
    assert "mine: found an existing file or folder" in again.stderr
    assert list((here / "mine").iterdir()) == []
    assert invoke("new", "mine", "--out", "elsewhere").exit_code == 0
    assert (here / "elsewhere" / "mine" / "rub.toml").is_file()


@pytest.mark.campaign
def test_the_new_folder_runs_as_it_is(here, monkeypatch):
    steps = json.loads(invoke("new", "mine", "--json").stdout)["next"][1:]
    monkeypatch.chdir(here / "mine")
    found = {}
    for step in steps:
        if step.split()[1] in ("reduce", "rub"):  # modes, update and report of this casing are tested elsewhere
            result = invoke(*step.split()[1:], "--json")
            assert result.exit_code == 0, result.output
            found[step.split()[1]] = json.loads(result.stdout)
    assert len(found["rub"]["contacts"][0]["intervals"]) >= 4  # twice a turn
    assert Path("results/rub_forces.csv").is_file()


def test_watching_runs_again_when_the_file_or_what_it_names_is_saved(here, monkeypatch):
    """Not when what it writes is written, and not while nothing happens; Ctrl-C ends with 130."""
    file = here / "plate.toml"
    file.write_text(PLATE, encoding="utf-8")
    looks = []

    def sleep(seconds):
        looks.append(seconds)
        if len(looks) == 2:
            file.write_text(PLATE.replace("3e-3", "4e-3"), encoding="utf-8")
        if len(looks) == 3:
            (here / "plate.npz").write_bytes(b"made")
        if len(looks) == 4:
            file.write_text(PLATE.replace("thickness", "thicknes"), encoding="utf-8")
        if len(looks) == 6:
            raise KeyboardInterrupt

    monkeypatch.setattr(time, "sleep", sleep)
    result = invoke("watch", file, "--json")
    assert result.exit_code == 130
    first, second = (json.loads(line)["modes"][0]["freq_hz"] for line in result.stdout.splitlines())
    assert second == pytest.approx(4.0 / 3.0 * first, rel=2e-3)  # and a little shear
    assert "did you mean thickness?" in result.stderr  # the third run
    assert result.stderr.count(f"casingfem modes {file} --json") == 3
    assert result.stderr.splitlines()[-1] == "stopped watching"


@pytest.mark.parametrize(("words", "start", "found"), [((), "wat", "watch"), (("example",), "two_r", "two_rods"),
                                                       (("explain",), "mesh-co", "mesh-coarse"),
                                                       (("schema",), "coat", "coating")])  # fmt: skip
def test_the_shell_completes_names(words, start, found):
    known = ShellComplete(main, {}, "casingfem", "_CASINGFEM_COMPLETE").get_completions(list(words), start)
    assert found in [item.value for item in known]


@pytest.mark.parametrize("name", ["blade_off", "rotor37", "rotor67"])
def test_a_folder_of_scenes_is_an_example_that_runs_by_itself(tmp_path, name):
    ran = invoke("example", name, "--out", tmp_path, "--json")
    assert ran.exit_code == 0, ran.output
    document = json.loads(ran.stdout)
    folder = tmp_path / "scenes" / name
    assert {path.name for path in folder.iterdir()} == {Path(path).name for path in document["files"]}
    assert document["next"][0] == f"cd {folder}"
    named = {word for line in document["next"] for word in line.split() if word.endswith(".toml")}
    assert named == {path.name for path in folder.glob("*.toml")}
    assert {line.split()[0] for line in document["next"][1:]} == {"casingfem"}
    for path in folder.glob("*.toml"):
        tables = tomllib.loads(path.read_text())
        missing = [text for _, text in strings(tables) if text.endswith(".csv") and not (folder / text).exists()]
        assert not missing
        bases = {text for key, text in strings(tables) if key == "basis"}
        assert bases <= {"blade.npz", "casing.npz", "casing_thick.npz"}


@pytest.mark.campaign
def test_the_folder_of_a_lost_blade_runs_its_bases_and_its_scenes(tmp_path):
    invoke("example", "blade_off", "--out", tmp_path)
    folder = tmp_path / "scenes" / "blade_off"
    for study in ("casing", "casing_thick", "blade"):
        assert invoke("reduce", folder / f"{study}.toml", "--out", folder).exit_code == 0
    speed = {}
    for name in ("rub", "wider", "thicker"):
        scene = folder / f"{name}.toml"
        scene.write_text(scene.read_text().replace("t_end = 1.0", "t_end = 0.05"))
        ran = invoke("rub", scene, "--json")
        assert ran.exit_code == 0, ran.output
        speed[name] = json.loads(ran.stdout)["rotor"]["speed_hz_end"]
    assert speed["thicker"] < speed["rub"] < speed["wider"] < 100.0


def strings(tables, key=""):
    """Every text of nested tables with its key."""
    if isinstance(tables, str):
        return [(key, tables)]
    items = enumerate(tables) if isinstance(tables, list) else tables.items() if isinstance(tables, dict) else ()
    return [found for name, value in items for found in strings(value, key if isinstance(tables, list) else name)]
