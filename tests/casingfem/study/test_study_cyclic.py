"""[cyclic] of a study: from the file of a sector to modes by nodal diameter and a basis; what it cannot mean."""

import json
import re

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main
from reports.verification.modes.cyclic import bladed_disk
from reports.verification.modes.mesh_files import write_inp
from tests.casingfem.study.study_texts import STEEL
from tests.probed import numbers_of_document

SMALL = (1, 1, 2, 1)
WHEEL = f"""{STEEL}[solid]
mesh = "disk.inp"
[support.hub]
kind = "clamped"
[cyclic]
sectors = 6
mistuning = "blades.csv"
blade = "vane"
[modes]
count = 2
[reduce]
interface = "tip"
nodes = 2
modes = 2
out = "wheel.npz"
"""
TABLE = "# SYNTHETIC\nblade,deviation\n" + "".join(f"{7 - k},{0.01 * k}\n" for k in range(1, 7))
DEVIATIONS = 0.01 * np.arange(6, 0, -1)


@pytest.fixture(scope="module")
def disk():
    return bladed_disk(6, SMALL)


@pytest.fixture
def write(tmp_path, disk):
    mesh = disk.structure.mesh
    write_inp(mesh, tmp_path / "disk.inp")
    cells = "\n".join(str(cell + 1) for cell in mesh.groups["blade"].cells)
    with (tmp_path / "disk.inp").open("a") as file:
        file.write(f"*ELSET, ELSET=vane\n{cells}\n")

    def written(old="", new="", table=TABLE):
        assert old in WHEEL
        (tmp_path / "blades.csv").write_text(table)
        (tmp_path / "wheel.toml").write_text(WHEEL.replace(old, new, 1))
        return tmp_path / "wheel.toml"

    return written


def run(*arguments):
    return CliRunner().invoke(main, list(map(str, arguments)))


@pytest.mark.slow
def test_modes_and_basis_of_a_file_are_those_of_python(write, disk, tmp_path, held):
    answer = run("modes", write(), "--json", "--out", tmp_path / "out", "--vtu", "--modes", "1")
    assert answer.exit_code == 0, answer.output
    document = json.loads(answer.stdout)
    exact = cf.modal.cyclic_modes(disk, 2)
    assert [(row["n"], row["doublet"] is None) for row in document["modes"][:4]] == [(0, True)] * 2 + [(1, False)] * 2
    np.testing.assert_allclose(sorted({row["freq_hz"] for row in document["modes"]}), np.sort(exact.freq), rtol=1e-9)
    mistuned = cf.modal.mistuned_modes(disk, DEVIATIONS, 2, blade="blade")
    np.testing.assert_allclose([row["freq_hz"] for row in document["mistuned"]], mistuned.freq, rtol=1e-9)
    assert (tmp_path / "out" / "vtu" / "mode_001.vtu").is_file()
    assert (tmp_path / "out" / "modes.csv").read_text().count("False") == 12
    assert run("reduce", tmp_path / "wheel.toml").exit_code == 0
    body = ct.ModalBody.load(tmp_path / "wheel.npz")
    assert (body.sectors, len(body.omega), body.channels[-1]) == (6, 12, "sector5.node1.chord")
    np.testing.assert_allclose(body.omega, 2.0 * np.pi * mistuned.freq, rtol=2e-4)
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_waves_are_printed_where_they_are_asked_for(write):
    turning = '[rotation]\nspeed_hz = 100.0\naxis = "z"\n[cyclic]\ncoriolis = true\nnodal_diameters = [1]\n'
    said = run("modes", write("[cyclic]\n", turning)).stdout
    assert said.count("forward") == said.count("backward") == 2
    assert "localisation" in said


MISTUNED = 'mistuning = "blades.csv"\nblade = "vane"\n'
COUNTED, BAND = "[modes]\ncount = 2\n", "[modes]\nband_hz = [1395.0, 1469.5]\n"
TURNING = '[rotation]\nspeed_hz = 100.0\naxis = "z"\n'


def test_a_band_of_a_tuned_wheel_at_rest_contains_the_modes_of_its_diameters_within(write, disk):
    answer = run("modes", write(MISTUNED + COUNTED, f"nodal_diameters = [0, 1]\n{BAND}"), "--json")
    assert answer.exit_code == 0, answer.output
    freq = np.array([row["freq_hz"] for row in cf.modal.cyclic_modes(disk, 2, diameters=[0, 1]).records()])
    inside = freq[(freq > 1395.0) & (freq < 1469.5)]
    assert len(inside) == 4  # two pairs of n = 1
    found = json.loads(answer.stdout)["modes"]
    assert [row["n"] for row in found] == [1, 1, 1, 1]
    np.testing.assert_allclose([row["freq_hz"] for row in found], inside, rtol=1e-9)


@pytest.mark.parametrize(
    ("old", "new"),
    [(COUNTED, BAND), (MISTUNED + COUNTED, f"coriolis = true\n{TURNING}{BAND}")],
    ids=["mistuned", "whirling"],
)
def test_a_band_of_a_mistuned_or_a_whirling_wheel_is_refused(write, old, new):
    answer = run("modes", write(old, new))
    assert answer.exit_code == 2
    words = "modes.band_hz: found a band of a mistuned or whirling wheel, expected count, of each nodal diameter"
    assert words in answer.stderr


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("sectors = 6", "sectors = 1", "cyclic.sectors: found 1"),
        ("sectors = 6", "sectors = 6\nsector = 3", "cyclic.sector: found an unknown key"),
        ("sectors = 6", "sectors = 5", "cyclic: disk.inp: rotated by 72 degrees"),
        ("sectors = 6", "sectors = 6\ncoriolis = true", "cyclic.coriolis: found true for a wheel at rest"),
        ("sectors = 6", "sectors = 6\nnodal_diameters = [4]", r"nodal_diameters: found [4], expected some of 0 to 3"),
        ("sectors = 6", 'sectors = 6\nfaces = ["low"]', "cyclic.faces: found ['low']"),
        ("sectors = 6", 'sectors = 6\nfaces = ["low", "tip"]', "found an angle of 30 degrees between the faces"),
        ('mistuning = "blades.csv"', "mistuning = [0.1]", "cyclic.mistuning: found 1 values, expected 6"),
        ('mistuning = "blades.csv"', 'mistuning = "none.csv"', "none.csv"),
        ('mistuning = "blades.csv"\n', "", "found blade without mistuning"),
        ('blade = "vane"', 'blade = "van"', "did you mean 'vane'"),
    ],
)
def test_bad_wheels_are_named_by_key(write, old, new, words):
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(write(old, new), wheel=True)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("blade,freq\n1,0.1\n", "line 1: found blade,freq; expected blade,deviation"),
        (TABLE.replace("5,0.02", "4,0.02"), "expected each blade from 1 to 6 once"),
        (TABLE.replace("0.02", "two"), "line 4, column 'deviation': found 'two'"),
    ],
)
def test_bad_tables_of_blades_are_named_by_line(write, table, words):
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(write(table=table), wheel=True)
    assert words in str(caught.value)


def test_commands_for_a_part_alone_refuse_a_wheel(write):
    answer = run("export", write())
    assert answer.exit_code == 2
    assert "cyclic: found a table [cyclic]" in answer.stderr
    answer = run("reduce", write("modes = 2\nout", 'modes = 2\nmethod = "free"\nout'))
    assert (answer.exit_code, "reduce.method" in answer.stderr) == (2, True)


RESPONSE = """[[response]]
order = 5
from_hz = 100.0
to_hz = 800.0
steps = 60
force = 2.0
zeta = 0.005
sigma = 0.01
draws = 5
seed = 3
influence = "air.csv"
"""
AIR = "# SYNTHETIC\noffset,stiffness,damping\n0,100.0,0.3\n1,20.0,0.0\n-1,-20.0,0.0\n"


@pytest.mark.slow
def test_engine_orders_of_a_file_are_those_of_python(write, disk, tmp_path):
    (tmp_path / "air.csv").write_text(AIR)
    answer = run("response", write("[modes]", RESPONSE + "[modes]"), "--json", "--out", tmp_path / "out")
    assert answer.exit_code == 0, answer.output
    (found,) = json.loads(answer.stdout)["responses"]
    wheel = cf.modal.BladedWheel.of(disk, cf.TipNodes("tip", 2), modes=2, blade="blade")
    air = cf.modal.Influence(offset=[0, 1, -1], stiffness=[100.0, 20.0, -20.0], damping=[0.3, 0.0, 0.0])
    given = {"zeta": 0.005, "influence": air}
    exact = cf.modal.engine_order_response(
        wheel, 5, np.linspace(100.0, 800.0, 60), force=2.0, deviations=DEVIATIONS, **given
    )
    assert (found["nodal_diameters"], len(found["rows"])) == (1, 60)
    assert found["peak_m"] == pytest.approx(exact.peak, rel=1e-6)
    assert found["amplification"] == pytest.approx(exact.amplification, rel=1e-6)
    drawn = cf.modal.amplification(wheel, 5, sigma=0.01, draws=5, seed=3, band_hz=(500.0, 4000.0), **given)
    np.testing.assert_allclose(found["draws"]["amplification"], drawn.amplification, rtol=1e-6)
    written = {file.name for file in (tmp_path / "out").iterdir()}
    assert written >= {"response.json", "safe.png", "response_1.csv", "response_1.png", "amplification_1.csv"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[modes]", "[modes]", r"response: found none, expected a table \[\[response\]\]"),
        ("[modes]", RESPONSE.replace("to_hz = 800.0", "to_hz = 80.0") + "[modes]", "0 < from_hz < to_hz"),
        ("[modes]", RESPONSE.replace("zeta = 0.005\n", "").replace('influence = "air.csv"\n', "") + "[modes]",
         "a wheel without damping"),
        ("[modes]", RESPONSE.replace("order = 5", "order = 0") + "[modes]", "response.*order"),
        ("[modes]", RESPONSE.replace("force", 'channel = "twist"\nforce') + "[modes]", "found 'twist'"),
        ("[modes]", RESPONSE.replace("air.csv", "wind.csv") + "[modes]", "wind.csv"),
    ],
)  # fmt: skip
def test_engine_orders_that_cannot_be_are_refused(write, tmp_path, old, new, words):
    (tmp_path / "air.csv").write_text(AIR)
    answer = run("response", write(old, new))
    assert answer.exit_code == 2, answer.output
    assert re.search(words, " ".join(answer.output.split()))
