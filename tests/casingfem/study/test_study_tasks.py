"""What a study asks for reaches the update and the reduction key by key; errors name the study and the task."""

from pathlib import Path
from types import SimpleNamespace

import pytest

import casingfem as cf
from casingfem.study import tasks
from casingfem.study.imported import MeshStudy
from casingfem.study.problems import StudyError
from casingfem.study.tables.tasks import ReduceTable, UpdateTable
from casingfem.study.tasks import judge_update, run_reduce, run_update

PARAMETER = {"name": "material.E", "lower": 1.0, "upper": 2.0}


class Basis(SimpleNamespace):
    """A basis that can be replaced."""


@pytest.fixture
def told(monkeypatch):
    """What the computing functions were given."""
    given = {}

    def taking(name, result):
        def call(*arguments, **named):
            given[name] = (arguments, named)
            return result

        return call

    basis = Basis(provenance={"by": "hand"})
    for name, result in (("update", "fit"), ("reduce", basis), ("cyclic_reduce", basis)):
        monkeypatch.setattr(tasks, name, taking(name, result))
    monkeypatch.setattr(tasks, "replace", lambda found, provenance: provenance)
    return given


def error(key, found, expected):
    return StudyError([f"s.toml: {key}: found {found}, expected {expected}"])


def study(**keys):
    given = {"path": Path("s.toml"), "source": {"study": "s.toml"}, "structure": "own", "start": "start",
             "table": "table", "parameters": (1, 2), "shapes": "shapes", "interface": "rim",
             "error": error}  # fmt: skip
    update, reduce = keys.pop("update", None), keys.pop("reduce", None)
    return SimpleNamespace(file=SimpleNamespace(update=update, reduce=reduce), **given | keys)


def wheel_study(reduce):
    wheel = SimpleNamespace(sector="sector", deviations="deviations", blade="vane")
    whole = object.__new__(MeshStudy)
    for name, value in vars(study(reduce=reduce)).items():
        if name in MeshStudy.__dataclass_fields__:
            object.__setattr__(whole, name, value)
    object.__setattr__(whole, "wheel", wheel)
    return whole


def test_an_update_is_given_the_keys_of_its_table(told):
    more = {"count": 7, "reach": 0.3, "model_error": 0.01, "regularise": "l-curve", "regularised": ["a"],
            "outliers": "keep"}  # fmt: skip
    table = UpdateTable(table="t.csv", parameter=[PARAMETER], **more)
    assert run_update(study(update=table), "progress") == "fit"
    assert told["update"] == (("start", "table", [1, 2]), {
        "count": 7, "reach": 0.3, "model_error": 0.01, "shapes": "shapes", "progress": "progress", "outliers": "keep",
        "regularise": cf.updating.Regularisation(rule="l-curve", names=("a",)),
    })  # fmt: skip
    run_update(study(update=UpdateTable(table="t.csv", parameter=[PARAMETER])))
    assert told["update"][1]["regularise"] is None


@pytest.mark.parametrize("missing", [{"table": None}, {"update": None}])
def test_an_update_wants_its_table(told, missing):
    keys = {"update": UpdateTable(table="t.csv", parameter=[PARAMETER])} | missing
    with pytest.raises(cf.errors.InputError, match=r"s.toml: update: found nothing"):
        run_update(study(**keys))
    assert told == {}


def test_a_reduction_is_given_the_keys_of_its_table(told):
    output = [{"name": "a", "at": [0.0, 1.0], "direction": "x"}]
    table = ReduceTable(interface="top", modes=9, method="craig-bampton", zeta=0.1, recovery=True, output=output)
    assert run_reduce(study(reduce=table)) == {"by": "hand", "source": {"study": "s.toml"}}
    assert told["reduce"] == (("own", "rim"), {
        "modes": 9, "method": "craig-bampton", "zeta": 0.1, "recovery": True,
        "outputs": [cf.modal.Displacement(name="a", at=(0.0, 1.0), direction="x")],
    })  # fmt: skip
    run_reduce(study(reduce=table), "updated")
    assert told["reduce"][0] == ("updated", "rim")


@pytest.mark.parametrize("missing", [{"interface": None}, {"reduce": None}])
def test_a_reduction_wants_its_table(told, missing):
    with pytest.raises(cf.errors.InputError, match=r"s.toml: reduce: found nothing"):
        run_reduce(study(**{"reduce": ReduceTable(interface="top")} | missing))
    assert told == {}


@pytest.mark.parametrize(("keys", "modes"), [({}, tasks.OF_A_DIAMETER), ({"modes": 40}, 40), ({"modes": 2}, 2)])
def test_a_wheel_is_reduced_by_its_diameters(told, keys, modes):
    assert run_reduce(wheel_study(ReduceTable(interface="tip", zeta=0.1, **keys)))["source"] == {"study": "s.toml"}
    assert told["cyclic_reduce"] == (
        ("sector", "rim"), {"modes": modes, "zeta": 0.1, "deviations": "deviations", "blade": "vane"}
    )  # fmt: skip


@pytest.mark.parametrize(("key", "value"), [("method", "free"), ("output", [])])
def test_a_wheel_has_neither_method_nor_outputs(told, key, value):
    with pytest.raises(
        cf.errors.InputError, match=rf"s.toml: reduce.{key}: found it beside \[cyclic\], expected no such key"
    ):
        run_reduce(wheel_study(ReduceTable(interface="tip", **{key: value})))
    assert told == {}


def test_what_cannot_be_computed_is_told_with_study_and_task(monkeypatch):
    def fails(*_, **__):
        raise ValueError("too few rows")

    for name in ("update", "reduce", "leave_one_out", "laplace"):
        monkeypatch.setattr(tasks, name, fails)
    whole = study(update=UpdateTable(table="t", parameter=[PARAMETER]), reduce=ReduceTable(interface="top"))
    with pytest.raises(cf.errors.InputError, match=r"^s.toml: update: too few rows$"):
        run_update(whole)
    with pytest.raises(cf.errors.InputError, match=r"^s.toml: reduce: too few rows$"):
        run_reduce(whole)
    for asked in ({"left_out": True, "posterior": None}, {"left_out": False, "posterior": "laplace"}):
        with pytest.raises(cf.errors.InputError, match=r"^s.toml: update: too few rows$"):
            judge_update(whole, None, say=lambda what: None, **asked)


@pytest.mark.parametrize(
    ("left_out", "posterior", "found", "said"),
    [
        (False, None, {}, []),
        (True, None, {"leave_one_out": "left fit"}, ["predicting rows left out"]),
        (False, "laplace", {"posterior": "laplace fit"}, ["posterior by laplace"]),
        (False, "emcee", {"posterior": "sampled fit"}, ["posterior by emcee"]),
    ],
)
def test_an_update_is_judged_as_far_as_is_asked(monkeypatch, left_out, posterior, found, said):
    for name, word in (("leave_one_out", "left"), ("laplace", "laplace"), ("sample_posterior", "sampled")):
        monkeypatch.setattr(tasks, name, lambda fit, word=word: f"{word} {fit}")
    told = []
    assert judge_update(study(), "fit", left_out=left_out, posterior=posterior, say=told.append) == found
    assert told == said
