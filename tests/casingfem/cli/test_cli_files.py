"""What commands write and find: files of examples and new folders, tables of a key, errors."""

from pathlib import Path
from types import SimpleNamespace

import click
import pytest

import casingfem as cf
from casingfem import examples
from casingfem.cli.new import changes, listed, run_once, stamps, verb_of, write
from casingfem.cli.schema import explained, roots, walked
from casingfem.examples import Example, first_sentence, maker, strings


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({}, "a.csv"),
        ({"found": "1"}, "a.csv: found 1; expected "),
        ({"expected": "2"}, "a.csv: found ; expected 2"),
        ({"line": 7, "column": "n", "where": "set 3"}, "a.csv, line 7, column 'n', set 3"),
        ({"column": "", "found": "1", "expected": "2"}, "a.csv, column '': found 1; expected 2"),
    ],
)
def test_an_error_says_only_what_is_known(given, text):
    error = cf.errors.InputError("a.csv", **given)
    assert str(error) == text
    assert {name: getattr(error, name) for name in given} == given


@pytest.mark.parametrize(
    ("message", "code"),
    [("a [study-value]", "study-value"), ("a [no-such-code]", ""), ("[study-value] a", ""), ("a", "")],
)
def test_a_code_stands_at_the_end_and_in_the_catalogue(message, code):
    assert cf.errors.code_of(message) == code
    assert cf.errors.with_code("mesh-order", message) == (message if code else f"{message} [mesh-order]")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("# One. Two.\n", "One."),
        ("# One\n# goes on. Two\n", "One goes on."),
        ("# One.\n# Two.\n", "One."),
        ("# One:\n# two. three\n", "One:"),
        ("# No end\n[material]\n# More.", "No end"),
        ("[material]\n# More.", ""),
        ("#No\n# One.", ""),
    ],
)
def test_the_first_sentence_of_a_comment(text, sentence):
    assert first_sentence(text) == sentence


def test_strings_are_found_with_their_keys():
    tables = {"a": "x", "b": [{"c": "y", "d": 1}, "z"], "e": {"f": ["u", ["v"]]}, "g": 2.0}
    assert list(strings(tables)) == [("a", "x"), ("c", "y"), ("b", "z"), ("f", "u"), ("f", "v")]


@pytest.mark.parametrize(
    ("tables", "verb"),
    [
        ({"scene": {"kind": "rods"}}, "contact"),
        ({"scene": {"kind": "rim"}, "sweep": {}, "drive": {}}, "sweep"),
        ({"scene": {"kind": "patch"}, "drive": {}}, "cycles"),
        ({"scene": {"kind": "disk"}}, "rub"),
        ({"scene": {"kind": "pair"}}, "stability"),
        ({"rig": {}, "update": {}}, "rig"),
        ({"update": {}, "imperfection": [{"random": "example"}]}, "update"),
        ({"imperfection": [{"harmonics": []}, {"random": "example"}]}, "mistune"),
        ({"imperfection": [{"harmonics": []}]}, "modes"),
        ({}, "modes"),
    ],
)
def test_a_file_is_run_by_what_is_in_it(tables, verb):
    assert Example("a", Path("a.toml"), tables).verb == verb


@pytest.fixture
def data(tmp_path, monkeypatch):
    """A folder of examples: a scene on two bases, one of which is there, and the studies that make the other."""
    for folder in ("studies", "scenes"):
        (tmp_path / folder).mkdir()
    (tmp_path / "studies" / "a.toml").write_text('survey = "../s.csv"\n[material]\n[reduce]\nout = "a.npz"\n')
    (tmp_path / "studies" / "b.toml").write_text('[material]\n[reduce]\nout = "b.npz"\n')
    (tmp_path / "scenes" / "near.toml").write_text('[material]\n[reduce]\nout = "b.npz"\n')
    (tmp_path / "scenes" / "rub.toml").write_text(
        '# A rub.\n[scene]\nkind = "rim"\n[casing]\nbasis = "a.npz"\n[blade]\nbasis = "c.npz"\n'
    )
    (tmp_path / "scenes" / "c.npz").write_bytes(b"c")
    (tmp_path / "s.csv").write_text("s")
    monkeypatch.setattr(examples, "DATA", tmp_path)
    return tmp_path


def test_an_example_knows_what_makes_its_bases_and_what_it_needs(data):
    known = examples.examples()
    assert list(known) == ["a", "b", "rub"]
    rub = known["rub"]
    assert (rub.about, rub.verb, rub.makers) == ("A rub.", "rub", (Path("studies/a.toml"),))
    assert [file.as_posix() for file in rub.files] == ["scenes/rub.toml", "scenes/c.npz", "studies/a.toml", "s.csv"]
    assert rub.commands(Path("my data")) == (
        "casingfem reduce 'my data/studies/a.toml' --out 'my data/scenes'",
        "casingfem rub 'my data/scenes/rub.toml'",
    )
    assert maker("b.npz", Path("scenes")) == Path("scenes/near.toml")
    with pytest.raises(FileNotFoundError, match="no study makes this basis"):
        maker("d.npz", Path("scenes"))


def test_an_example_is_written_with_what_is_not_there_yet(data, tmp_path, capsys):
    rub, out = examples.examples()["rub"], tmp_path / "out"
    assert [path.relative_to(out).as_posix() for path in write(rub, out)] == [
        "scenes/rub.toml", "scenes/c.npz", "studies/a.toml", "s.csv"
    ]  # fmt: skip
    (out / "scenes" / "rub.toml").unlink()
    (out / "s.csv").unlink()
    assert [path.name for path in write(rub, out)] == ["rub.toml", "s.csv"]
    with pytest.raises(SystemExit):  # its own file is there, though it is the same
        write(rub, out)
    (out / "scenes" / "rub.toml").unlink()
    (out / "s.csv").write_text("mine")
    with pytest.raises(SystemExit):
        write(rub, out)
    said = capsys.readouterr().err.splitlines()
    assert [line.partition(",")[0] for line in said] == [
        f"{out / name}: found such a file" for name in ("scenes/rub.toml", "s.csv")
    ]


def test_the_list_of_examples_cuts_long_words_at_eighty():
    known = {name: SimpleNamespace(name=name, about=about) for name, about in (("a", "word " * 20), ("long", "x"))}
    lines = listed(known).splitlines()
    assert lines[0] == "a     " + " ".join(["word"] * 15) + " ..."
    assert lines[1] == "long  x"


# --- watch ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ended", "code"),
    [
        (None, 0),
        (click.UsageError("wrong"), 2),
        (click.Abort(), 130),
        (SystemExit(3), 3),
        (SystemExit(), 0),
    ],
)
def test_a_command_that_is_run_once_gives_its_exit_code(ended, code):
    @click.group()
    def group():
        """Commands."""

    @group.command()
    def one():
        if ended is not None:
            raise ended

    assert run_once(group, ["one"]) == code


def test_what_is_in_a_file_says_what_runs_it(tmp_path):
    file = tmp_path / "a.toml"
    for text, verb in (('[scene]\nkind = "rim"', "rub"), ("[rig]", "rig"), ("[scene]", "modes"), ("a = = 1", "modes")):
        file.write_text(text)
        assert verb_of(file) == verb
    assert verb_of(tmp_path / "none.toml") == "modes"


def test_stamps_are_of_files_that_are_there_and_not_of_what_is_written(tmp_path):
    file = tmp_path / "a.toml"
    file.write_text(
        'note = "plain"\ntable = "t.csv"\nother = "none.csv"\n[reduce]\nout = "b.npz"\n[casing]\nbasis = "b.npz"\n'
    )
    for name in ("t.csv", "b.npz", "plain"):
        (tmp_path / name).write_text(name)
    found = stamps(file)
    assert list(found) == [file, tmp_path / "t.csv"]
    assert found[tmp_path / "t.csv"] == ((tmp_path / "t.csv").stat().st_mtime_ns, 5)
    assert stamps(tmp_path / "none.toml") == {}


def test_a_change_is_looked_for_twice_a_second(tmp_path):
    file, paused = tmp_path / "a.toml", []
    file.write_text("")

    def sleep(seconds):
        paused.append(seconds)
        if len(paused) == 3:
            file.write_text("a = 1")

    looks = changes(file, sleep)
    next(looks)
    assert paused == []
    next(looks)
    assert paused == [0.5] * 3


# --- schema ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "names"),
    [
        (["chart", "frustum"], ["FrustumTable"]),
        (["support", "base", "bolts"], ["BoltsTable"]),
        (["imperfection[2]", "harmonics"], ["Harmonic"]),
        (["shell", "thickness"], ["thickness", "ShellTable"]),
        (["shell", "thickness", "more"], []),
        (["solid", "material", "body"], ["MaterialTable"]),
        (["shell", "nothing"], []),
        ([], ["StudyFile"]),
    ],
)
def test_a_path_of_keys_leads_to_tables(path, names):
    found = walked(roots()["study"], path)
    assert [part if isinstance(part, str) else part.__name__ for part in found] == names


def test_a_key_is_told_for_each_kind_of_file_that_has_another():
    (one,) = explained("study.mesh.order")
    assert (one["key"], one["files"]) == ("study.mesh.order", ["study"])
    assert one["text"].splitlines()[:2] == ["study.mesh.order", "  order  polynomial order"]
    (differs,) = explained("contact")
    assert differs["text"].splitlines()[0] == "contact differs by the kind of file; ask for one of"
    assert {part["key"] for part in explained("scene")} == set(roots()) - {"study", "sweep"}
    assert explained("nothing") == []
