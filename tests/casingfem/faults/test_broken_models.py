"""Broken models: each is refused or warned of with its code, cause and remedy; none gives frequencies in silence."""

import importlib.util
import json
import os
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from reports.verification.robustness.broken import table as broken_models
from reports.verification.robustness.broken.files import STUDY
from tests.probed import numbers_of_document

DOCS = Path(__file__).parents[3] / "docs"
MODELS = broken_models.models()


def explained(*arguments):
    return CliRunner().invoke(main, ["explain", *arguments])


@pytest.fixture(scope="module")
def catalogue():
    """Cause and remedy of every code."""
    return json.loads(explained("--json").stdout)["faults"]


# every third; `python -m reports.verification.robustness.broken` takes all
@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS[::6], ids=[model.name for model in MODELS[::6]])
def test_no_broken_model_computes_in_silence(model, catalogue):
    happened, messages = broken_models.outcome(model)
    assert happened in ("refused", "warned"), messages
    assert all(name in "\n".join(messages) for name in model.names), messages
    said = {cf.errors.code_of(message): message for message in messages}
    assert model.code in (*said, "")
    if model.code and not model.code.startswith(("study-", "survey-")) and not model.name.startswith("study"):
        assert catalogue[model.code]["remedy"] in said[model.code]


def test_every_code_has_a_cause_and_a_remedy_and_an_unknown_one_is_a_mistake(catalogue):
    for code, fault in catalogue.items():
        assert code == code.lower().strip("-")
        assert min(len(fault["cause"]), len(fault["remedy"])) > 10
    with pytest.raises(KeyError):
        cf.errors.ModelError("no-such-code", "message")
    with pytest.warns(cf.errors.ModelWarning, match="shell-thin"):
        cf.errors.warn("shell-thin", "message")


def test_the_page_of_codes_is_current(catalogue):
    spec = importlib.util.spec_from_file_location("errors_page", DOCS / "errors.py")
    page = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(page)
    text = (DOCS / "errors.md").read_text(encoding="utf-8")
    assert text == page.page(), "run .venv/bin/python docs/errors.py"
    assert text.count("\n| ") == len(catalogue) + 1


def test_explain_prints_one_code_and_corrects_a_misspelt_one(catalogue):
    assert catalogue["mesh-coarse"]["remedy"] in explained("mesh-coarse").stdout
    wrong = explained("mesh-corse")
    assert wrong.exit_code == 2
    assert "did you mean mesh-coarse" in wrong.stderr


def test_a_refusal_keeps_the_warnings_that_came_before_it():
    def make():
        cf.errors.warn("shell-thin", "a foil")
        raise cf.errors.ModelError("shell-thickness", "no wall")

    happened, messages = broken_models.outcome(broken_models.Broken("foil", make, "shell-thin"))
    assert (happened, [cf.errors.code_of(message) for message in messages]) == (
        "refused",
        ["shell-thin", "shell-thickness"],
    )


TUBE = """
from reports.verification.robustness.broken import table as broken_models
from casingfem.errors import code_of
model, = (m for m in broken_models.models() if m.name == "height 2000 radii")
happened, messages = broken_models.outcome(model)
print(happened, *map(code_of, messages))
"""


@pytest.mark.campaign
@pytest.mark.parametrize("kernels", ["Nehalem", "Haswell"])
def test_a_tube_of_2000_radii_is_doubted_on_every_processor(kernels):
    """Round-off outweighs its lowest eigenvalues: 1, 2 or 4 of them are below zero, as the kernels of BLAS sum."""
    environment = os.environ | {"OPENBLAS_CORETYPE": kernels}
    product = "import numpy as np; np.ones((1000, 40)).T @ np.ones((1000, 8))"
    if subprocess.run([sys.executable, "-c", product], env=environment).returncode < 0:
        pytest.skip("numpy's own products end the process with these kernels (OpenBLAS 0.3.34, its issue 6026)")
    done = subprocess.run(
        [sys.executable, "-c", TUBE], env=environment, cwd=DOCS.parent, capture_output=True, text=True
    )
    assert done.stdout.split() == ["warned", "chart-aspect", "shell-thin"], done.stderr


def test_there_are_at_least_600_by_name():
    assert len(MODELS) == len({model.name for model in MODELS}) >= 600
    assert all(model.code or model.names for model in MODELS)


def test_what_ends_in_a_traceback_or_in_silence_is_astray():
    def trips():
        raise KeyError("E")

    rows = [broken_models.row(broken_models.Broken("x", make, "", ("E",))) for make in (trips, lambda: None)]
    assert [row["outcome"] for row in rows] == ["TRACEBACK", "silent"]
    assert all(row["verdict"].startswith("expected") for row in rows)


def sound() -> dict[str, object]:
    """Structures near the thresholds, on the good side."""
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    casing = {"material": steel, "supports": {"base": cf.Clamped()}}
    blade = {"material": steel, "supports": {"root": cf.Clamped()}}
    return {
        "thin casing": cf.Shell(chart=cf.Cylinder(radius=1.0, height=0.5), thickness=1e-4, **casing),
        "large casing": cf.Shell(chart=cf.Cylinder(radius=5.0, height=8.0), thickness=0.05, **casing),
        "thick casing": cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.5), thickness=0.08, **casing),
        "long tube": cf.Shell(chart=cf.Cylinder(radius=0.05, height=2.0), thickness=2e-3, **casing),
        "wavy casing": cf.Shell(
            chart=cf.Cylinder(radius=0.5, height=0.3), thickness=3e-3, radius_defect=cf.FourierField.of({3: 0.01}),
            **casing,
        ),
        "small blade": cf.Shell(chart=cf.Plate(length=0.02, width=0.01), thickness=5e-4, **blade),
        "twisted blade": cf.Shell(
            chart=cf.geometry.TwistedPlate(length=0.3, width=0.1, twist=1.2), thickness=3e-3, **blade
        ),
        "dome with a hole": cf.Shell(
            chart=cf.Revolved(profile=cf.geometry.Arc(radius=0.5, start=0.0, end=1.4)), thickness=3e-3, **casing
        ),
        "aluminium on springs": cf.Shell(
            chart=cf.Cylinder(radius=0.5, height=0.3), thickness=3e-3,
            material=cf.Material(E=70e9, nu=0.33, rho=2700.0),
            supports={"base": cf.ElasticEdge(k_r=1e6, k_theta=1e6, k_z=1e6)},
        ),
    }  # fmt: skip


SLOW = "wavy casing"


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name == SLOW else name for name in sound()]
)
def test_sound_models_meet_no_uncertainty(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.all(cf.modes(sound()[name], 4).freq > 0.0)


def written(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


PLAIN = STUDY[: STUDY.index("[[imperfection]]")] + STUDY[STUDY.index("[support.base]") :]


def test_a_study_error_has_a_code_for_each_problem(tmp_path):
    text = PLAIN.replace("nu = 0.3", "nu = 0.9").replace("order = 6", "order = 60").replace("thickness", "thicknes")
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(written(tmp_path, text))
    assert set(caught.value.codes) == {"material-poisson", "mesh-order", "study-key", "study-missing"}


def test_warnings_are_one_clean_line_each_and_listed_in_json(tmp_path, held):
    path = written(tmp_path, PLAIN.replace("210e9", "210e3") + '[checks]\nallow = ["E", "sound"]\n')
    result = CliRunner().invoke(main, ["modes", str(path), "--json", "--out", str(tmp_path / "out")])
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert [entry["code"] for entry in document["warnings"]] == ["material-units"]
    lines = result.stderr.splitlines()
    assert lines == [f"warning: {entry['message']}" for entry in document["warnings"]]
    assert lines[0].endswith("[material-units]")
    assert json.loads((tmp_path / "out" / "modes.json").read_text())["warnings"] == document["warnings"]
    again = CliRunner().invoke(main, ["modes", str(written(tmp_path, PLAIN)), "--json"])
    assert json.loads(again.stdout)["warnings"] == []
    assert again.stderr == ""
    held(1e-4, document=numbers_of_document(document))


def test_refusals_show_their_code_on_the_command_line(tmp_path):
    text = PLAIN.replace("20e-3", "0.6") + '[checks]\nallow = ["thickness"]\n'
    result = CliRunner().invoke(main, ["modes", str(written(tmp_path, text))])
    assert result.exit_code == 2
    assert result.stderr.endswith("[shell-thickness-size]\n")


@pytest.mark.campaign
def test_the_report_lists_them(tmp_path, capsys):
    rows = broken_models.main(tmp_path, quick=True)
    assert {row["verdict"] for row in rows} == {"as expected"}
    assert "silent" not in capsys.readouterr().out
    assert (tmp_path / "broken_models.csv").exists()
