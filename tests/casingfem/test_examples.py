"""The examples that come with the program: listed, written with what they need, never over a file, and they run."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import casingfem as cf
from casingfem.cli import main
from reports.studies.section_44 import THICKNESS


def invoke(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("wrong", "near"), [("two_rod", "two_rods"), ("five_nodes", "rub/five_nodes"), ("frustrum", "frustum")]
)
def test_a_wrong_name_offers_the_nearest(here, wrong, near):
    result = invoke("example", wrong)
    assert result.exit_code == 2
    assert f"found '{wrong}'" in result.stderr
    assert near in result.stderr.partition("did you mean")[2]
    assert list(here.iterdir()) == []


def test_where_no_name_is_near_those_that_keep_the_word_are_offered(here):
    words = invoke("example", "ring").stderr.split()
    assert words[words.index("(did") :] == ["(did", "you", "mean", "bolted_ring", "or", "beam_in_ring?)"]


def test_a_calculation_of_a_second_runs_as_is_reported(here):
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
