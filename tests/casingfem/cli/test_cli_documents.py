"""What commands print for programs and for readers: histories of a run, tables of a file, a part of another program."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main
from tests.casingfem.structure.imported.test_imported import ROTATION, SKIN, SOLID, study
from tests.probed import numbers_of_document

HISTORIES = ("time", "force", "gap", "windowed_force")
BALL = """
[scene]
kind = "rods"
t_end = {end}
gravity = 9.81
[[mass]]
mass = 1.0
x = 0.02
[wall]
x = 0.0
[scheme]
kind = "moreau-jean"
restitution = 0.8
dt = 1e-4
"""


def call(*arguments):
    ran = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert ran.exit_code == 0, ran.stderr
    return ran


@pytest.fixture(scope="module")
def long(tmp_path_factory) -> Path:
    """A scene whose four histories have 6,001 samples each: 24,004 numbers."""
    file = tmp_path_factory.mktemp("long") / "rod.toml"
    file.write_text(BALL.format(end=0.6), encoding="utf-8")
    return file


@pytest.mark.slow
def test_histories_of_more_than_20_000_numbers_are_left_out_and_named(long, tmp_path):
    ran = call("contact", long, "--json", "--out", tmp_path)
    document = json.loads(ran.stdout)
    stored = ct.Result.load(tmp_path / "contact.npz")
    count = stored.time.size * stored.impulse.size
    assert 4 * count > 20_000
    assert document["left_out"] == dict.fromkeys(HISTORIES, count)
    assert not set(HISTORIES) & document["contacts"][0].keys()
    assert document["contacts"][0]["impulse"] == stored.impulse[0]
    assert f"time ({count:,} numbers)" in ran.stderr
    assert "--history" in ran.stderr
    assert json.loads((tmp_path / "contact.json").read_text(encoding="utf-8"))["left_out"] == document["left_out"]
    whole = json.loads(call("contact", long, "--json", "--history").stdout)
    assert whole["left_out"] == {}
    assert whole["contacts"][0]["gap"] == stored.gap[:, 0].tolist()


@pytest.mark.slow
def test_short_histories_stay_in_the_document(tmp_path, held):
    file = tmp_path / "rod.toml"
    file.write_text(BALL.format(end=0.1), encoding="utf-8")
    ran = call("contact", file, "--json")
    document = json.loads(ran.stdout)
    assert document["left_out"] == {}
    assert set(HISTORIES) <= document["contacts"][0].keys()
    assert "--history" not in ran.stderr
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_campbell_of_an_imported_part_is_that_of_its_structure(tmp_path, held):
    file = study(tmp_path, SOLID.replace("[solid]", "[shell]\nthickness = 0.03") + ROTATION, SKIN)
    found = json.loads(call("campbell", file, "--steps", 2, "--count", 2, "--to-hz", 50.0, "--json").stdout)
    structure = cf.load_study(file).structure
    exact = cf.campbell(structure, 2.0 * np.pi * np.array([0.0, 50.0]), 2)
    np.testing.assert_allclose(found["freq_hz"], exact.freq, rtol=1e-9)
    assert found["freq_hz"][1] != found["freq_hz"][0]
    held(1e-4, found=numbers_of_document(found))
