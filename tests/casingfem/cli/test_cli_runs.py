"""What commands refuse before they begin, and how a run that breaks off is taken."""

from importlib import import_module
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from casingfem.cli import main
from casingfem.cli.contact import is_scene, ran
from contact import NumericsError


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("modes", "a.toml", "--modes", "1"), "--modes chooses what --vtu or --uff writes: give --vtu too"),
        (("modes", "a.toml", "--vtu"), "--vtu or --uff needs --out DIR"),
        (("modes", "a.toml", "--uff", "--modes", "1"), "--vtu or --uff needs --out DIR"),
        (("rub", "a.toml", "--vtu"), "found --vtu without --out DIR, expected a folder to write to"),
        (("identify", "a.uff", "--open", "--angles", "b.csv"), "--open is for parts without a circle of sensors"),
        (("import", "a.mtx", "--out", "a.npy"), "--out: found 'a.npy', expected a file name ending in .npz"),
        (("explain", "mesh-coarze"), "found 'mesh-coarze', expected a code such as shell-thickness"),
    ],
)
def test_words_that_do_not_go_together_are_refused_at_once(words, said):
    result = CliRunner().invoke(main, list(words))
    assert (result.exit_code, said in result.stderr) == (2, True), result.output


@pytest.mark.parametrize("words", [("modes", "none.toml", "--vtu", "--modes", "1", "--out", "o"), ("rub", "none.toml")])
def test_words_that_go_together_are_taken(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, list(words))
    assert (result.exit_code, "Usage" in result.stderr, "none.toml" in result.stderr) == (2, False, True)


@pytest.mark.parametrize(
    ("content", "scene"),
    [(b"[scene]", True), (b"[material]", False), (b"[scene", False), (b"a = '\xff'", False), (None, False)],
)
def test_a_scene_is_a_file_with_its_table(tmp_path, content, scene):
    if content is not None:
        (tmp_path / "a.toml").write_bytes(content)
    assert is_scene(tmp_path / "a.toml") is scene


@pytest.fixture
def broken(monkeypatch):
    """A run that ends as a test says; what was drawn."""
    drawn = []
    run = import_module("contact.run")
    error = NumericsError("diverged")

    def completed(ready, progress):
        progress(0.5)
        if ready == "whole":
            return "result"
        raise error

    monkeypatch.setattr(run, "prepared", lambda scene: scene.ready)
    monkeypatch.setattr(run, "completed", completed)
    monkeypatch.setattr("casingfem.cli.pictures.with_states", lambda ready: drawn.append(ready) or ready)
    return SimpleNamespace(error=error, drawn=drawn)


@pytest.mark.parametrize(
    ("pictured", "record", "drawn"),
    [(True, None, ["whole"]), (False, None, []), (True, "a", []), (False, "a", [])],
)
def test_states_are_stored_for_pictures_where_the_scene_says_nothing(broken, pictured, record, drawn):
    done = []
    assert ran(SimpleNamespace(ready="whole", record=record), done.append, pictured) == ("result", None)
    assert (broken.drawn, done) == (drawn, [0.5])


def test_a_run_that_breaks_off_keeps_what_it_has(broken):
    scene = SimpleNamespace(ready="breaks", record=None)
    broken.error.result = "so far"
    assert ran(scene, lambda done: None, False) == ("so far", broken.error)
    broken.error.result = None
    with pytest.raises(NumericsError):
        ran(scene, lambda done: None, False)
