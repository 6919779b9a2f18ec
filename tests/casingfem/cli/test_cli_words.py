"""What commands say and draw: of a rig, of a run, of the installation, of a key."""

from types import SimpleNamespace

import numpy as np
import pytest
from pydantic import BaseModel, Field

from casingfem.cli import pictures
from casingfem.cli.doctor import blas, extra_lines, products, text
from casingfem.cli.identify import waves_unit, words_of_test
from casingfem.cli.schema import headline, headline_of, kept


def rig_test(force=None, coherence=None, scan=True, frfs="frfs"):
    record = SimpleNamespace(force=force)
    return SimpleNamespace(
        rig="rig", truth="truth", frfs=frfs, waves="waves", scan=SimpleNamespace(record=record) if scan else None,
        coherence=None if coherence is None else SimpleNamespace(responses=np.array(coherence, complex)),
    )  # fmt: skip


def test_a_rig_says_what_it_made():
    assert waves_unit(rig_test(scan=False)) == "m/s"
    assert waves_unit(rig_test()) == "m/s"
    assert waves_unit(rig_test(force=1.0)) == "(m/s)/N"
    lines = words_of_test(rig_test(force=1.0, coherence=[0.2, 0.9, 0.8])).splitlines()
    assert lines[:4] == ["SYNTHETIC: nobody measured this", "'rig'", "'truth'", "'frfs'"]
    assert lines[4] == "coherence 0.8000 (median)"
    assert (lines[6], lines[7]) == ("waves: amplitude [(m/s)/N], phase and angle [deg]", "'waves'")
    bare = words_of_test(rig_test(scan=False, frfs=None)).splitlines()
    assert bare == ["SYNTHETIC: nobody measured this", "'rig'", "'truth'"]


def run_result(**keys):
    energy = SimpleNamespace(
        lost_in_contact=1.0, rotation=2.0, friction=3.0, damping=4.0, external=5.0, body_force=6.0, numerical=7.0,
        start=SimpleNamespace(total=8.0), end=SimpleNamespace(total=10.5), unaccounted=-0.5, scale=2.0,
    )  # fmt: skip
    given = {
        "energy": energy, "steps": 30, "dt": 0.1, "impulse": np.array([[1.0, 2.0]]), "contact_steps": np.array([4, 9]),
        "windowed_force": lambda: np.array([[1.0, 7.0]]), "peak_force": np.array([11.0, 3.0]),
        "residual": np.array([1e-9, 2e-9]), "growth": None,
    }  # fmt: skip
    return SimpleNamespace(**given | keys)


def test_the_ledger_of_a_run_has_what_goes_into_the_bodies():
    assert pictures.ledger(run_result()) == {
        "contact": -1.0, "turning rim": 2.0, "friction": 3.0, "damping": 4.0, "loads": 5.0, "gravity, whirl": 6.0,
        "numerical": 7.0, "stored at the end": 2.5,
    }  # fmt: skip


def test_the_history_of_forces_is_a_table_with_a_card(tmp_path, monkeypatch):
    columns = {"time_s": np.array([0.0, 0.1]), "mean_N": np.array([1.23456789012, -2.0])}
    monkeypatch.setattr("contact.histories.force_table", lambda _: columns)
    monkeypatch.setattr(pictures, "find_spec", lambda _: None)
    files = pictures.force_files(None, "rub")
    assert list(files) == ["rub_forces.csv"]
    files["rub_forces.csv"](tmp_path / "a.csv")
    card, *rows = (tmp_path / "a.csv").read_text().splitlines()
    assert card.startswith("# COMPUTED: contact forces; ")
    assert rows == ["time_s,mean_N", "0,1.23456789", "0.1,-2"]
    monkeypatch.setattr(pictures, "find_spec", lambda name: name == "pyarrow")
    assert list(pictures.force_files(None, "rub")) == ["rub_forces.csv", "rub_forces.parquet"]


@pytest.mark.parametrize(
    ("code", "error", "why"),
    [(-4, "", "ended by signal 4"), (1, "Traceback\n  line\nAssertionError\n", "AssertionError"), (1, "x", "x")],
)
def test_a_product_that_fails_is_told_with_its_reason(monkeypatch, code, error, why):
    monkeypatch.setattr("subprocess.run", lambda *_, **__: SimpleNamespace(returncode=code, stderr=error))
    found = products()
    assert found == {"right": False, "why": f"numpy's matrix product: {why}", "install": "pip install 'numpy<2.5.2'"}
    monkeypatch.setattr("subprocess.run", lambda *_, **__: SimpleNamespace(returncode=0, stderr=""))
    assert products() == {"right": True}


def test_findings_of_the_doctor_are_a_line_each():
    extra = {"installed": False, "missing": ["a", "b"], "for": "tests", "install": "pip install x"}
    document = {"python": "3.13", "threads": {"OMP": None, "MKL": 0}, "extras": {"dev": extra}}
    assert text(document).splitlines() == [
        f"{'python':<30} 3.13", f"{'threads.OMP':<30} -", f"{'threads.MKL':<30} 0",
        f"{'extra dev':<30} not installed (a, b): tests", f"{'':<30} pip install x",
    ]  # fmt: skip
    assert extra_lines("dev", extra | {"installed": True}) == [f"{'extra dev':<30} installed: tests"]


@pytest.mark.parametrize(
    ("config", "name"),
    [({}, "unknown"), ({"Build Dependencies": {"blas": {"name": "openblas", "version": "0.3"}}}, "openblas 0.3")],
)
def test_blas_is_named_with_its_version(monkeypatch, config, name):
    monkeypatch.setattr("numpy.show_config", lambda mode: config)
    assert blas() == name


class Keys(BaseModel):
    """[keys] of a test: the first line.

    More.
    """

    must: float = Field(description="m")
    on: bool = Field(default=True, description="o")
    count: int = Field(default=0, description="c")
    words: list[str] = Field(default=["a", "b"], description="w")
    made: list[float] = Field(default_factory=lambda: [1.0], description="d")
    none: float | None = Field(default=None, description="n")
    empty: list[str] = Field(default=[], description="e")


def test_a_key_says_what_it_is_where_it_is_left_out():
    assert [kept(info) for info in Keys.model_fields.values()] == [
        "must be given", "true if left out", "0 if left out", "['a', 'b'] if left out", "[1.0] if left out",
        "may be left out", "may be left out",
    ]  # fmt: skip


def test_the_headline_of_a_table_is_its_first_sentence_without_its_name():
    assert headline(Keys) == "the first line."
    assert headline_of((Keys,)) == "the first line."
    assert headline_of(("must", Keys)) == "m"
    assert headline(type("Bare", (BaseModel,), {"__doc__": "Of a: b."})) == "Of a: b."
