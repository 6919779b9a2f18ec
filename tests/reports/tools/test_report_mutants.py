"""The share of mutants killed, on a project of two functions of which one is tested."""

import json
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from reports.tools.mutants.draw import draw, mutant
from reports.tools.mutants.judge import Limits, verdict
from reports.tools.mutants.reach import read_reach
from reports.tools.mutants.share import Campaign, command_line, main, record
from reports.tools.mutants.sites import sites

SOURCE = '''"""A module."""


def seen(x):
    """Tests examine this."""
    return x < 2


def unseen(x):
    """Tests call this and examine nothing."""
    return x + 1
'''
TESTS = """
import pytest
from tiny.module import seen, unseen


def test_seen():
    assert seen(1)
    assert not seen(2)
    assert not seen(3)


def test_unseen():
    unseen(1)


@pytest.fixture
def given():
    assert seen(0)


def test_by_a_fixture(given):
    pass
"""
ONE = """
from tiny.module import unseen


def test_unseen():
    assert unseen(1) == 7
"""


@pytest.fixture
def campaign(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Campaign:
    # each process of tests would load every plugin that is installed
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    root = tmp_path / "project"
    for name, text in {
        "tiny/__init__.py": "",
        "tiny/module.py": SOURCE,
        "tests/test_module.py": TESTS,
        "pyproject.toml": "[tool.pytest.ini_options]\npythonpath = ['.']\n",
    }.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    return Campaign(root=root, packages=("tiny",), out=tmp_path / "out", count=9)


def changes(line: str) -> set[str]:
    """What can become of one statement in a function."""
    text = f"def f(a, b):\n    {line}\n"
    made = [mutant("f.py", text, site, new) for site in sites(text) for new in site.choices]
    return {one.after for one in made if one is not None}


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("return a <= b", {"return a < b"}),
        ("x = a - θ * abs(b)", {"x = a + θ * abs(b)", "x = a - θ / abs(b)", "x = a - θ * (b)"}),
        ("a[b] += -b", {"a[b] -= -b", "a[b] += b", "pass"}),
        ("x = not a and np.max(b)", {"x = a and np.max(b)", "x = not a or np.max(b)", "x = not a and np.min(b)"}),
        ("x = a is not b", {"x = a is b"}),
        ("x = a if b else -a", {"x = a if False else -a", "x = a if True else -a", "x = a if b else a"}),
        ("x = 1.5 + 2", {"x = 3.0 + 2", "x = 4.5 + 2", "x = 1.5 - 2", "x = 1.5 + 3"}),
        ("if a: raise ValueError(f'{b + 1}')", {"if False: raise ValueError(f'{b + 1}')", "if a: pass"}),
        ("x = a / (b + 1e-300)", {"x = a * (b + 1e-300)"}),
        ("x = a / max(b, 1e-300)", {"x = a * max(b, 1e-300)", "x = a / min(b, 1e-300)"}),
        ("x = a < 1e-12", {"x = a < 0.001"}),
        ("x = np.full(a, -1)", {"x = np.full(a, 1)"}),
        ("x = np.full(a, -1.5)", {"x = np.full(a, 1.5)", "x = np.full(a, -3.0)", "x = np.full(a, -4.5)"}),
        (
            "x = a * [1.0, -1.0]",
            {"x = a * [2.0, -1.0]", "x = a * [3.0, -1.0]", "x = a * [1.0, 1.0]"}
            | {"x = a * [1.0, -2.0]", "x = a * [1.0, -3.0]"},
        ),
        ("x = -1.0 * a", {"x = 1.0 * a", "x = -2.0 * a", "x = -3.0 * a", "x = -1.0 / a"}),
        ("x = a < 1e-3", {"x = a <= 1e-3", "x = a < 0.002", "x = a < 0.003"}),
        ("x = field(default=a, repr=False)", set()),
        ("x: Literal[1] = 'text' + a", set()),
        ("x = f'{a + b}'", set()),
        ("print(a + b)", set()),
        ("return solve(a, b, check_finite=False)", set()),
        ("x = a.reshape(3, -1)", {"x = a.reshape(4, -1)"}),
    ],
)
def test_what_becomes_of_a_statement(line: str, expected: set[str]) -> None:
    assert changes(line) == expected


def test_returned_numbers_change_by_their_promised_type() -> None:
    text = "def f(a=1) -> float:\n    return a\n"
    made = [mutant("f.py", text, site, new) for site in sites(text) for new in site.choices]
    assert [one.after for one in made if one] == ["def f(a=2) -> float:", "return 2.0 * (a)"]
    assert not sites("def f(a) -> float:\n    return math.nan\n")


@pytest.mark.parametrize(
    "kind", ["def __repr__(a=1):\n    return f(a + 1)", "def f(a=1): ...", 'def f(a=1):\n    "Text."']
)
def test_what_is_only_printed_or_never_run_is_left_alone(kind: str) -> None:
    assert sites(kind) == []


def test_a_change_that_compiles_to_the_same_is_no_mutant() -> None:
    assert changes("return 2.0 * 1.0") == {
        f"return {a} * {b}" for a, b in [(4.0, 1.0), (6.0, 1.0), (2.0, 2.0), (2.0, 3.0)]
    }


def test_a_smaller_draw_is_the_beginning_of_a_larger_one() -> None:
    sources = {f"{name}.py": SOURCE for name in "abcdef"}
    assert draw(sources, 7, 5) == draw(sources, 7, 20)[:5]
    assert draw(sources, 8, 5) != draw(sources, 7, 5)
    assert {one.file for one in draw(sources, 7, 20, "b*")} == {"b.py"}


def test_no_function_is_drawn_more_than_twice() -> None:
    drawn = draw({"a.py": "def f(a):\n    return a[1, 2, 3, 4, 5]\n"}, 1, 20)
    assert len(drawn) == 2


def test_tests_are_found_through_fixtures_and_nearest_first(campaign: Campaign) -> None:
    reach = read_reach(campaign.root, ("tiny",), ("tests",))
    file = "tests/test_module.py"
    near = reach.distances(("tiny/module.py", "seen"))
    assert near == {(file, "test_seen"): 1, (file, "test_by_a_fixture"): 2}
    assert reach.nearest("tiny/module.py", "unseen", 1)[0] == f"{file}::test_unseen"


def test_of_tests_equally_near_those_of_its_folder_and_its_name_come_first(campaign: Campaign) -> None:
    text = "from tiny.module import unseen\ndef test_1():\n    unseen(1)\n"
    for name, body in {"a": text, "tiny/z": text, "b": text.replace("test_1", "test_what_is_unseen")}.items():
        path = campaign.root / "tests" / name
        path = path.with_name(f"test_{path.name}.py")
        path.parent.mkdir(exist_ok=True)
        path.write_text(body, encoding="utf-8")
    (campaign.root / "tests/test_module.py").unlink()
    reach = read_reach(campaign.root, ("tiny",), ("tests",))
    for seed in range(5):
        last = reach.nearest("tiny/module.py", "unseen", seed)[-1]
        assert last == "tests/test_a.py::test_1"


def test_a_file_named_like_the_folder_comes_before_nearer_ones(campaign: Campaign) -> None:
    """Tests of a rub call what runs all scenes, from where the loops of a rub are as far as any."""
    (campaign.root / "tiny/rub").mkdir()
    (campaign.root / "tiny/rub/loop.py").write_text("def step():\n    return 1\n", encoding="utf-8")
    (campaign.root / "tiny/run.py").write_text(
        "from tiny.rub import loop\ndef run():\n    loop.step()\n", encoding="utf-8"
    )
    direct = "from tiny.rub.loop import step\ndef test_1():\n    step()\n"
    for name, text in {"any": direct, "rub_forces": "from tiny.run import run\ndef test_2():\n    run()\n"}.items():
        (campaign.root / f"tests/test_{name}.py").write_text(text, encoding="utf-8")
    first = read_reach(campaign.root, ("tiny",), ("tests",)).nearest("tiny/rub/loop.py", "step", 1)[0]
    assert first == "tests/test_rub_forces.py::test_2"


@pytest.mark.campaign
def test_examples_of_a_docstring_are_tests(campaign: Campaign) -> None:
    """Those of a package; of other folders nothing runs them."""
    text = SOURCE.replace(
        '"""Tests examine this."""',
        '"""Text.\n\n    >>> from tiny.module import unseen\n    >>> unseen(1)\n    2\n    """',
    )
    for name in ("tiny/module.py", "tests/other.py"):
        (campaign.root / name).write_text(text, encoding="utf-8")
    reach = read_reach(campaign.root, ("tiny",), ("tests",))
    assert reach.distances(("tiny/module.py", "unseen"))["tiny/module.py", "tiny.module.seen"] == 1
    assert not any(file == "tests/other.py" for file, _ in reach.tests)
    seed = next(k for k in range(9) if "x - 1" in replace(campaign, seed=k, count=1).mutants()[0].after)
    assert [row["killed by"] for row in main(replace(campaign, seed=seed, count=1))] == [
        "tiny/module.py::tiny.module.seen"
    ]


def test_tests_are_found_through_the_stub_of_a_package_and_its_rooms(campaign: Campaign) -> None:
    for name, text in {
        "tiny/__init__.py": "import lazy_loader\n",
        "tiny/__init__.pyi": "from . import room\nfrom .module import seen\n",
        "tiny/room/__init__.py": "import lazy_loader\n",
        "tiny/room/__init__.pyi": "from ..module import unseen\n",
        "tests/test_package.py": "import tiny as t\ndef test_1():\n    t.seen(1)\ndef test_2():\n    t.room.unseen\n",
    }.items():
        (campaign.root / name).parent.mkdir(exist_ok=True)
        (campaign.root / name).write_text(text, encoding="utf-8")
    reach, file = read_reach(campaign.root, ("tiny",), ("tests",)), "tests/test_package.py"
    assert reach.distances(("tiny/module.py", "seen"))[file, "test_1"] == 1
    assert reach.distances(("tiny/module.py", "unseen"))[file, "test_2"] == 1


@pytest.mark.campaign
def test_tests_are_found_by_the_module_that_a_text_names(campaign: Campaign) -> None:
    """Plain loops are imported by their dotted names."""
    text = 'from importlib import import_module\n\nN = import_module("tiny.module")\n'
    text += "\n\ndef test_plain():\n    N.alone(1)\n"
    (campaign.root / "tests/test_plain.py").write_text(text)
    module = campaign.root / "tiny/module.py"
    module.write_text(module.read_text() + "\n\ndef alone(x):\n    return x - 1\n")
    reach = read_reach(campaign.root, ("tiny",), ("tests",))
    assert ("tests/test_plain.py", "test_plain") in reach.distances(("tiny/module.py", "alone"))


@pytest.mark.campaign
def test_seen_mutants_are_killed_others_survive_and_a_rerun_continues(
    campaign: Campaign, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = main(campaign)
    killed = {row["after"]: row["killed by"] for row in rows}
    assert killed == {
        "return x <= 2": "tests/test_module.py::test_seen",
        "return x < 3": "tests/test_module.py::test_seen",
        "return x - 1": "",
        "return x + 2": "",
    }
    assert "2 of 4 mutants killed, 50.0 %" in capsys.readouterr().out
    table = campaign.out / "mutants_survivors.csv"
    survivors = pd.read_csv(table).assign(note=["equivalent: seen by none", "seen by none"])
    assert list(survivors["files"]) == ["tests/test_module.py"] * 2
    survivors.to_csv(table, index=False)
    kept = sorted(campaign.folder.glob("verdicts-*/*.json"))
    assert len(kept) == 4
    kept[0].unlink()
    stamps = [path.stat().st_mtime_ns for path in kept[1:]]
    assert main(campaign) == rows
    assert kept[0].exists()
    assert [path.stat().st_mtime_ns for path in kept[1:]] == stamps
    assert list(pd.read_csv(table)["note"]) == ["equivalent: seen by none", "seen by none"]
    assert "of the 3 that are not noted as equivalent: 66.7 %" in capsys.readouterr().out
    assert (campaign.root / "tiny/module.py").read_text("utf-8") == SOURCE


@pytest.mark.campaign
def test_what_tests_run_is_recorded_and_decides_which_of_them_judge(campaign: Campaign) -> None:
    """Those that run a function; of what Python does not run itself, those that run its user."""
    more = {
        "tiny/far.py": "from tiny.near import STEP\ndef far(x):\n    return x + STEP\n",
        "tiny/near.py": "STEP = 1\n",
        "tests/test_far.py": "from tiny.far import far\ndef test_far():\n    assert far(1) == 2\n",
    }
    for name, text in more.items():
        (campaign.root / name).write_text(text, encoding="utf-8")
    campaign = replace(campaign, count=30, limits=Limits(nearest=0, files=0))
    assert set(map(len, campaign.tests(campaign.mutants()).values())) == {0}
    for tree in campaign.trees:
        tree.refresh()
    record(campaign, campaign.trees)
    judging = {(m.file, m.function): tests for m, tests in campaign.tests(campaign.mutants()).items()}
    assert judging["tiny/module.py", "seen"][0] == "tests/test_module.py::test_seen"
    assert judging["tiny/near.py", ""] == ["tests/test_far.py::test_far"]


@pytest.mark.campaign
def test_tests_that_run_the_changed_function_come_first_and_the_rest_of_their_file_last(campaign: Campaign) -> None:
    more = {
        "tiny/near.py": "def asked(x):\n    return x + 1\n",
        "tiny/far.py": "from tiny.near import asked\ndef far(x):\n    return asked(x)\n",
        "tests/test_far.py": "from tiny.far import far\ndef test_far():\n    assert far(1) == 2\n",
        "tests/test_near.py": "from tiny.near import asked\ndef test_asked():\n    assert callable(asked)\n",
    }
    for name, text in more.items():
        (campaign.root / name).write_text(text, encoding="utf-8")
    campaign = replace(campaign, only="tiny/near.py", limits=Limits(nearest=1))
    for tree in campaign.trees:
        tree.refresh()
    run, only_named = "tests/test_far.py::test_far", "tests/test_near.py::test_asked"
    assert [tests[:2] for tests in campaign.tests(campaign.mutants()).values()] == [[only_named, run]] * 2
    record(campaign, campaign.trees)
    assert list(campaign.tests(campaign.mutants()).values()) == [[run, only_named]] * 2
    near = campaign.root / "tests/test_near.py"
    near.write_text(near.read_text() + "def test_newer():\n    assert asked(1) == 2\n")
    newer = "tests/test_near.py::test_newer"
    assert list(campaign.tests(campaign.mutants()).values()) == [[newer, run, only_named]] * 2


@pytest.mark.campaign
def test_a_test_that_fails_without_a_mutant_kills_none(campaign: Campaign, capsys: pytest.CaptureFixture[str]) -> None:
    (campaign.root / "tiny/module.py").write_text("def unseen(x):\n    return x + x\n", encoding="utf-8")
    (campaign.root / "tests/test_module.py").write_text(ONE, encoding="utf-8")
    assert [row["killed"] for row in main(campaign)] == [False]
    assert "fails without a mutant: tests/test_module.py::test_unseen" in capsys.readouterr().out


@pytest.mark.campaign
def test_a_mutant_that_never_ends_is_killed(campaign: Campaign) -> None:
    endless = "def unseen(x):\n    while not x:\n        x = bool(x)\n    return SEVEN\n\n\nSEVEN = int('7')\n"
    (campaign.root / "tiny/module.py").write_text(endless, encoding="utf-8")
    (campaign.root / "tests/test_module.py").write_text(ONE, encoding="utf-8")
    rows = main(replace(campaign, limits=Limits(test=2.0)))
    assert {row["after"]: row["how"] for row in rows}["while x:"] == "took too long"


@pytest.mark.campaign
def test_time_that_is_spent_leaves_tests_out(campaign: Campaign) -> None:
    main(replace(campaign, limits=Limits(budget=0.0), count=1))
    kept = [json.loads(path.read_text("utf-8")) for path in campaign.folder.glob("verdicts-*/*.json")]
    assert [(one["killed"], one["ran"], one["left_out"]) for one in kept] == [(False, [], 3)]


@pytest.mark.campaign
def test_tests_left_out_of_a_survivor_run_again_with_more_time(campaign: Campaign, monkeypatch) -> None:
    (campaign.root / "tests/test_module.py").write_text(ONE.replace("== 7", "== 2"), encoding="utf-8")
    monkeypatch.setattr("reports.tools.mutants.judge.PATIENCE", 1e9)
    tree = campaign.trees[0]
    tree.refresh()
    (faulty,) = (one for one in campaign.mutants() if one.after == "return x - 1")
    found = tree.judge(faulty, ["tests/test_module.py::test_unseen"], Limits(budget=1e-6))
    assert (found.killed, found.by, found.left_out) == (True, "tests/test_module.py::test_unseen", 0)


def test_what_a_run_states_of_a_mutant() -> None:
    assert verdict([("passed", "a"), ("begun", "b")], -11, "").how == "ended the process"
    assert verdict([], 2, "errors during collection").killed
    assert not verdict([("passed", "a"), ("skipped", "b"), ("left out", "c")], 0, "").killed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (["--count", "0"], "found '0', expected a whole number of 1 or more"),
        (["--only", "nothing/*"], "--only: found 'nothing/*', expected a pattern of files"),
    ],
)
def test_what_cannot_be_asked_for(asked: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        command_line(asked)
    assert words in capsys.readouterr().err


@pytest.mark.campaign
def test_tests_that_cannot_be_collected_kill_nothing(campaign: Campaign) -> None:
    """A missing name would stop every mutant's run, and pass for what the mutant did."""
    (campaign.root / "tests/test_module.py").write_text(TESTS.replace("seen, unseen", "seen, unseen, gone"), "utf-8")
    with pytest.raises(RuntimeError, match=r"(?s)tests are not collected without a mutant either.*gone"):
        main(replace(campaign, count=1))
