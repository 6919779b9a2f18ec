"""The command line: documents, files, exit codes. Bad input ends with 2, names file and key, writes nothing."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import casingfem as cf
from casingfem.cli import main
from tests.casingfem.study.study_texts import STEEL, THICK
from tests.probed import numbers_of_document

SCENES = Path(__file__).parents[3] / "data" / "scenes"

STUDY = THICK + 'out = "casing.npz"\n'
UPDATE = """
[update]
table = "table.csv"
[[update.parameter]]
name = "material.E"
lower = 150e9
upper = 250e9
sigma = 20e9
[[update.parameter]]
name = "support.base.k_face"
log = true
lower = 1e11
upper = 1e14
"""
BLADE = (
    STEEL
    + """
[chart]
kind = "plate"
length = 0.2
width = 0.05
[shell]
thickness = 4e-3
[support.root]
kind = "clamped"
[mesh]
order = 4
rows = 1
around = 1
[reduce]
interface = "tip"
modes = 4
"""
)
RUB = """
[scene]
kind = "rim"
t_end = 2e-3
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 5.0
[contact]
clearance = -1e-6
[speed]
turning = "blades"
hz = 5.0
[scheme]
kind = "exact-modal"
dt = 2e-6
"""
SURVEY_ROWS = [f"{a},{z},{0.5 - 0.2 * z:.2f}" for z in (0.0, 0.25) for a in range(0, 360, 5)]
OTHER_ROWS = [row.replace(",0.5", ",0.8").replace(",0.45", ",0.75") for row in SURVEY_ROWS]
KEYS = {"mode", "freq_hz", "n", "n_purity", "m", "doublet", "split_rel", "angle_deg"}


def invoke(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(a) for a in arguments])


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Frequencies of the same model with E = 205 GPa and k_face = 1.2e12 N/m^3."""
    folder = tmp_path_factory.mktemp("truth")
    (folder / "truth.toml").write_text(STUDY.replace("210e9", "205e9").replace("1e12", "1.2e12"))
    truth = cf.modes(cf.load_study(folder / "truth.toml").shell, 6)
    cf.FrequencyTable.from_arrays(
        freq_hz=truth.freq, sigma_hz=0.5, n=truth.nodal_diameters, angle_deg=truth.angle_deg, synthetic=True
    ).to_csv(folder / "table.csv")
    return (folder / "table.csv").read_bytes()


@pytest.fixture
def study(tmp_path: Path, table: bytes) -> Path:
    """A study with an update."""
    (tmp_path / "table.csv").write_bytes(table)
    (tmp_path / "study.toml").write_text(STUDY + UPDATE)
    return tmp_path / "study.toml"


def test_modes_is_one_document_and_two_files(study, tmp_path, held):
    result = invoke("modes", study, "--json", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert document.keys() >= {"modes", "dofs", "seconds", "sturm_count"}
    assert [row.keys() >= KEYS for row in document["modes"]] == [True] * 6
    assert [row["mode"] for row in document["modes"]] == [1, 2, 3, 4, 5, 6]
    assert document["sturm_count"] == 6
    assert result.stderr == ""
    files = ["modes.csv", "modes.json", "modes.png", "modes_rim.png"]
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == files
    rows = (tmp_path / "out" / "modes.csv").read_text().splitlines()
    assert rows[3].startswith("mode,n,freq_hz,sigma_hz,")
    assert float(rows[4].split(",")[2]) == document["modes"][0]["freq_hz"]
    table = cf.FrequencyTable.from_csv(tmp_path / "out" / "modes.csv")
    assert table.n.tolist() == [row["n"] for row in document["modes"]]
    np.testing.assert_allclose(table.sigma_hz, 1e-4 * table.freq_hz)
    assert table.synthetic
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_modes_of_a_band(study):
    text = study.read_text()
    lowest = json.loads(invoke("modes", study, "--json").stdout)["modes"][0]["freq_hz"]
    for end, least in ((1.2 * lowest, 2), (0.5 * lowest, 0)):
        study.write_text(text.replace("count = 6", f"band_hz = [0, {end}]"))
        result = invoke("modes", study, "--json")
        assert result.exit_code == 0, result.stderr
        document = json.loads(result.stdout)
        assert len(document["modes"]) == document["sturm_count"]
        assert bool(document["modes"]) == bool(least)
        assert all(row["freq_hz"] <= end for row in document["modes"])


def test_modes_in_words_is_the_table(study):
    result = invoke("modes", study)
    assert result.exit_code == 0
    assert "freq [Hz]" in result.stdout
    assert "6 modes" in result.stdout


@pytest.mark.slow
def test_same_study_twice_gives_the_same_table(study, tmp_path):
    for name in ("a", "b"):
        assert invoke("modes", study, "--out", tmp_path / name).exit_code == 0
    assert (tmp_path / "a" / "modes.csv").read_bytes() == (tmp_path / "b" / "modes.csv").read_bytes()


@pytest.mark.slow
def test_update_judges_itself_when_asked(study, held):
    result = invoke("update", study, "--json", "--leave-one-out", "--posterior", "laplace")
    document = json.loads(result.stdout)
    left = document["leave_one_out"]
    assert [row["mode"] for row in left["rows"]] == [pair["mode"] for pair in document["pairs"]]
    assert left["rms_sigma"] == pytest.approx(np.sqrt(np.mean([row["deviation"] ** 2 for row in left["rows"]])))
    assert {row["name"] for row in document["posterior"]["parameters"]} == {p["name"] for p in document["parameters"]}
    assert document["posterior"]["kind"] == "laplace"
    assert document["identifiability"]["rank"] <= len(document["parameters"])
    assert "model_floor" in document
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_an_update_that_cannot_leave_a_row_out_states_so_with_its_file(study):
    table, text = study.with_name("table.csv"), study.read_text()
    lines = table.read_text().splitlines(keepends=True)
    head = next(k for k, line in enumerate(lines) if line.startswith("mode,"))
    count = text.count("[[update.parameter]]")
    table.write_text("".join(lines[: head + 1 + count]))
    result = invoke("update", study, "--json", "--leave-one-out")
    assert result.exit_code == 2
    assert f"{study}: update: {table}: without mode 1 and 2: found no other row" in result.stderr


@pytest.mark.slow
def test_update_recovers_what_made_the_table_and_writes_a_study(study, tmp_path, held):
    result = invoke("update", study, "--json", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    wanted = {
        "parameters", "pairs", "rms_before", "rms_after", "iterations", "correlation", "stopped", "seconds",
    }  # fmt: skip
    assert wanted <= document.keys()
    assert {"mode", "n", "measured_hz", "before_hz", "after_hz", "sigma_hz"} <= document["pairs"][0].keys()
    assert document["rms_after"] < 1e-4 < document["rms_before"]
    E, k = document["parameters"]
    assert E["value"] == pytest.approx(205e9, rel=1e-2)
    assert abs(np.log10(k["value"] / 1.2e12)) < 3 * k["sigma"]
    page = (tmp_path / "out" / "update.html").read_text(encoding="utf-8")
    for words in ("How sure", "stated uncertainty", "Parameters; sigma", "sha256"):
        assert words in page, words
    again = invoke("modes", tmp_path / "out" / "study_updated.toml", "--json")
    modes = json.loads(again.stdout)["modes"]
    assert modes[0]["freq_hz"] == pytest.approx(document["pairs"][0]["after_hz"], rel=1e-9)
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_an_error_allowed_to_the_model_widens_sigma(study):
    first = json.loads(invoke("update", study, "--json").stdout)["parameters"][1]["sigma"]
    study.write_text(study.read_text().replace('table = "table.csv"', 'table = "table.csv"\nmodel_error = 0.01'))
    assert json.loads(invoke("update", study, "--json").stdout)["parameters"][1]["sigma"] > 3.0 * first


@pytest.mark.slow
def test_reduce_and_rub(study, tmp_path, held):
    (tmp_path / "blade.toml").write_text(BLADE)
    casing = json.loads(invoke("reduce", study, "--json", "--out", tmp_path).stdout)
    assert (casing["kind"], len(casing["freq_hz"]), casing["n_max"]) == ("rim", 8, 6)
    assert Path(casing["file"]) == tmp_path / "casing.npz"
    blade = invoke("reduce", tmp_path / "blade.toml", "--out", tmp_path)
    assert f"wrote {tmp_path / 'blade.npz'}" in blade.stdout
    (tmp_path / "rub.toml").write_text(RUB)
    result = invoke("rub", tmp_path / "rub.toml", "--json", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["contacts"][0]["impulse"] > 0.0
    files = ["rub.json", "rub.npz", "rub.png", "rub_forces.csv"]
    assert sorted(p.name for p in (tmp_path / "out").iterdir() if p.suffix != ".parquet") == files
    held(1e-4, casing=numbers_of_document(casing))


@pytest.mark.slow
def test_reduce_beside_the_study_when_it_names_the_file(study, tmp_path):
    assert invoke("reduce", study).exit_code == 0
    assert len(cf.ModalBasis.load(tmp_path / "casing.npz")) == 8
    (tmp_path / "blade.toml").write_text(BLADE)
    assert "not written: give --out DIR" in invoke("reduce", tmp_path / "blade.toml").stdout


@pytest.mark.slow
def test_contact_is_one_document_with_bodies_and_energy(tmp_path, held):
    result = invoke("contact", SCENES / "two_rods.toml", "--json", "--out", tmp_path, "--pictures")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    wanted = {"time", "force", "intervals", "impulse", "max_penetration", "residual"}
    assert document["contacts"][0].keys() >= wanted
    assert document.keys() >= {"contacts", "bodies", "energy", "steps", "seconds"}
    assert "mean_velocity" in document["bodies"][0]
    assert {"start", "end", "lost_in_contact", "unaccounted"} <= document["energy"].keys()
    pictures = ["contact.png", "contact_energy.png", "contact_spectrum.png"]
    files = sorted([*pictures, "contact.json", "contact.npz", "contact_forces.csv"])
    assert sorted(p.name for p in tmp_path.iterdir() if p.suffix != ".parquet") == files
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_sweep_writes_table_picture_and_store_and_goes_on(tmp_path, held):
    file = tmp_path / "rods.toml"
    vary = '[sweep]\n[[sweep.vary]]\nkey = "rod[1].velocity"\nvalues = [1.0, 2.0]\n'
    vary += '[[sweep.vary]]\nkey = "rod[2].x"\nvalues = [1e-3, 2e-3]\n'
    file.write_text((SCENES / "two_rods.toml").read_text() + vary)
    out = tmp_path / "out"
    result = invoke("sweep", file, "--jobs", "1", "--json", "--out", out)
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert [run["status"] for run in document["runs"]] == ["done"] * 4
    assert document["runs"][0]["rod[1].velocity"] == 1.0
    made = ["store", "sweep.csv", "sweep.html", "sweep.json", "sweep.png"]
    assert sorted(p.name for p in out.iterdir() if p.suffix != ".parquet") == made
    table = (out / "sweep.csv").read_bytes()
    again = invoke("sweep", file, "--jobs", "1", "--out", out)
    assert "4 runs were there already" in again.stdout
    assert (out / "sweep.csv").read_bytes() == table
    assert table.splitlines()[-5].startswith(b"run,rod[1].velocity_m_s,rod[2].x_m,status,")
    held(1e-4, document=numbers_of_document(document))


def test_a_sweep_of_which_nothing_is_done_ends_with_3(tmp_path):
    """All runs refused: 3, how many, and why the first; some: 0, and a line that states it."""
    file = tmp_path / "rods.toml"
    scene = (SCENES / "two_rods.toml").read_text()
    file.write_text(scene + '[sweep]\n[[sweep.vary]]\nkey = "scheme.courant"\nvalues = [1.5, 2.0]\n')
    result = invoke("sweep", file, "--jobs", "1", "--out", tmp_path / "out")
    assert result.exit_code == 3
    assert "all 2 runs failed or were refused, the first: " in result.stderr
    assert "dt * omega_max = 3, expected <= 2" in result.stderr
    assert (tmp_path / "out" / "sweep.csv").is_file()
    file.write_text(scene + '[sweep]\n[[sweep.vary]]\nkey = "scheme.courant"\nvalues = [0.9, 1.5]\n')
    some = invoke("sweep", file, "--jobs", "1")
    assert some.exit_code == 0
    assert "1 of 2 runs refused, the first: " in some.stdout
    file.write_text(scene + '[sweep]\n[[sweep.vary]]\nkey = "rod[1].elements"\nvalues = [40]\n')
    one = invoke("sweep", file, "--jobs", "1", "--out", tmp_path / "one")
    assert one.stdout.startswith("1 run over rod[1].elements")
    last = (tmp_path / "one" / "sweep.csv").read_text().splitlines()[-1]
    assert last.startswith("1,40,done,")


def test_sweep_refuses_a_scene_without_one():
    result = invoke("sweep", SCENES / "two_rods.toml")
    assert result.exit_code == 2
    assert "sweep: missing" in result.stderr


def test_rub_refuses_rods(tmp_path):
    result = invoke("rub", SCENES / "two_rods.toml")
    assert result.exit_code == 2
    assert "scene.kind: found 'rods', expected 'rim', 'rub', 'disk' or 'rotor'" in result.stderr


@pytest.mark.slow
def test_schema_and_doctor_are_documents(held):
    assert {"study", "scene"} < json.loads(invoke("schema", "--json").stdout).keys()
    doctor = json.loads(invoke("doctor", "--json").stdout)
    assert doctor["numba"]["compiles"] is True
    assert doctor["products"] == {"right": True}
    assert doctor["versions"]["numpy"] == np.__version__
    held(1e-4, doctor=numbers_of_document(doctor))


@pytest.mark.slow
def test_rigid_modes_are_shown_unless_elastic_ones_are_asked_for(study):
    free = STUDY[: STUDY.index("[support")] + STUDY[STUDY.index("[modes]") : STUDY.index("[reduce]")]
    study.write_text(free.replace("count = 6", "count = 8"))
    result = invoke("modes", study, "--json")
    assert json.loads(result.stdout)["rigid"] == 6
    assert "rigid" in invoke("modes", study).stdout


# what is wrong, what is in its place, and the words the message must have beside the file's name
WAVES = "harmonics = [{p = 6, cos = 0.004}]"
BROKEN = {
    "unknown key": ("nu = 0.3", "nu = 0.3\nmu = 0.1", "material.mu: found an unknown key"),
    "misspelt key": ("nu = 0.3", "n = 0.3", "did you mean nu?"),
    "unknown table": ("[modes]", "[mode]", "mode: found an unknown key"),
    "missing table": ("[shell]\nthickness = 20e-3\n", "", "shell: found nothing"),
    "missing key": ("rho = 7800.0\n", "", "material.rho: found nothing, expected density"),
    "negative thickness": ("20e-3", "-20e-3", "shell.thickness: found -0.02, expected greater than 0"),
    "thickness zero": ("20e-3", "0.0", "shell.thickness: found 0.0"),
    "thickness nan": ("20e-3", "nan", "shell.thickness: found nan, expected a finite number"),
    "thickness inf": ("20e-3", "inf", "shell.thickness: found inf, expected a finite number"),
    "nu one half": ("nu = 0.3", "nu = 0.5", "material.nu: found 0.5, expected less than 0.5"),
    "number in quotes": ("210e9", '"210e9"', "material.E: found '210e9', expected a number"),
    "boolean for a number": ("7800.0", "true", "material.rho: found true, expected a number"),
    "chart unknown": ('"frustum"', '"cone"', "chart.kind: found 'cone', expected one of frustum, cylinder"),
    "chart without kind": ('kind = "frustum"\n', "", "chart.kind: found nothing"),
    "table instead of a number": ("20e-3", "{a = 1}", "shell.thickness"),
    "radius negative": ("0.45", "-0.45", "chart.r_top: found -0.45"),
    "imperfection without source": ("harmonics = [{p = 6, cos = 0.004}]", "", "imperfection[1]: found neither"),
    "random without seed": (WAVES, 'random = "example"', "found random without seed"),
    "random of another name": (WAVES, 'random = "shop"', "imperfection[1].random: found"),
    "example of a modulus": (f'"radius"\n{WAVES}', '"modulus"\nrandom = "example"\nseed = 3', "expected a spectrum"),
    "spectrum upside down": (WAVES, "random = [{p = 2, median = 0.1, high = 0.05}]\nseed = 3", "expected 0 < medi"),
    "seed of nothing": ("cos = 0.004}]", "cos = 0.004}]\nseed = 3", "found seed beside harmonics"),
    "harmonic twice": ("{p = 6, cos", "{p = 6}, {p = 6, cos", "imperfection[1].harmonics: found harmonics [6, 6]"),
    "harmonic not whole": ("p = 6", "p = 6.5", "imperfection[1].harmonics[1].p: found 6.5, expected a whole"),
    "imperfection of what": ('of = "radius"', 'of = "mass"', "imperfection[1].of: found 'mass'"),
    "imperfection as large as the casing": ("cos = 0.004", "cos = 0.95", "imperfection: radius_defect"),
    "length in millimetres": ("0.45", "450000.0", "chart.r_top: found 450000.0, expected less than"),
    "no array": ("[[imperfection]]", "[imperfection]", "imperfection: found {'of': 'radius'"),
    "edge that does not exist": ("[support.base]", "[support.bottom]", "support.bottom: found edge 'bottom'"),
    "support unknown": ('kind = "elastic"', 'kind = "glue"', "clamped, shear-diaphragm, symmetry, elastic"),
    "spring negative": ("1e12", "-1e12", "support.base.k_face"),
    "spring zero": ("1e12", "0.0", "support.base: found an elastic support whose stiffnesses are all 0"),
    "spring pattern negative": ("1e12", "1e12\naround = [{p = 2, cos = 0.8}, {p = 3, cos = 1}]", "sin that multiply"),
    "count zero": ("count = 6", "count = 0", "modes.count: found 0"),
    "mesh rows": ("rows = 1", "rows = [0.0, 0.7, 0.5, 1.0]", "mesh.rows"),
    "interface of no edge": ('interface = "top"', 'interface = "left"', "reduce.interface: found 'left'"),
    "method unknown": ("modes = 8", 'modes = 8\nmethod = "guyan"', "reduce.method: found 'guyan'"),
    "out elsewhere": ('"casing.npz"', '"../casing.npz"', "reduce.out"),
    "parameter that does not exist": ("material.E", "material.G", "update.parameter[1]: 'material.G'"),
    "parameter twice": ('"support.base.k_face"', '"material.E"', "update.parameter[2]: name: found material.E"),
    "bounds swapped": ("lower = 150e9", "lower = 260e9", "update.parameter[1]: material.E: bounds"),
    "start outside the bounds": ("sigma = 20e9", "start = 300e9", "update.parameter[1]: material.E: found the"),
    "sigma negative": ("sigma = 20e9", "sigma = -20e9", "update.parameter[1].sigma"),
    "log of zero": ("lower = 1e11", "lower = 0.0", "update.parameter[2]: support.base.k_face: found lower = 0.0"),
    "missing table file": ('"table.csv"', '"no.csv"', "no.csv: found no such file"),
    "no parameter": (UPDATE[UPDATE.index("[[") :], "parameter = []", "update.parameter: found []"),
    "toml syntax": ("nu = 0.3", "nu = = 0.3", "not TOML: Invalid value (at line 4"),
    "repeated key": ("nu = 0.3", "nu = 0.3\nnu = 0.2", "not TOML: Cannot overwrite a value (at line 5"),
}  # fmt: skip


def refused(file: Path, words: str, command: str = "modes") -> None:
    out = file.parent / "results"
    for form in ([], ["--json"]):
        result = invoke(command, file, "--out", out, *form)
        assert result.exit_code == 2, result.output
        assert isinstance(result.exception, SystemExit)
        assert result.stdout == ""
        assert str(file) in result.stderr
        assert words in result.stderr
        assert "Traceback" not in result.stderr
        assert not out.exists()


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_study_is_refused(study, name):
    old, new, words = BROKEN[name]
    text = study.read_text()
    assert old in text
    study.write_text(text.replace(old, new, 1))
    refused(study, words)


SURVEYS = {
    "nan": (["theta_deg,z_m,radius_m", *SURVEY_ROWS[:7], "35,0.0,nan", *SURVEY_ROWS[8:]], "line 9"),
    "half a circle": (["theta_deg,z_m,radius_m", *SURVEY_ROWS[:36]], "survey.csv"),
    "no unit": (["theta_deg,z_m,radius", *SURVEY_ROWS], "radius"),
    "empty": ([], "survey.csv"),
    "no points": (["theta_deg,z_m,radius_m"], "line 1"),
    "another casing": (["theta_deg,z_m,radius_m", *OTHER_ROWS], "mean radius"),
    "not utf-8": (["theta_deg,z_m,radius_m", "\xe9"], "UTF-8"),
}  # fmt: skip


@pytest.mark.parametrize("name", SURVEYS)
def test_a_survey_that_cannot_be_used_is_refused(study, tmp_path, name):
    rows, words = SURVEYS[name]
    (tmp_path / "survey.csv").write_text("\n".join(rows), encoding="latin-1")
    source = 'survey = "survey.csv"\nn_max = 12'
    study.write_text(STUDY.replace("harmonics = [{p = 6, cos = 0.004}]", source))
    refused(study, "imperfection[1].survey")
    refused(study, words)


TABLES = {
    "empty": ("", "header"),
    "no rows": ("mode,n,freq_hz,sigma_hz\n", "no rows"),
    "no unit": ("mode,n,freq,sigma_hz\n1,3,900,1\n", "freq_hz"),
    "no sigma": ("mode,n,freq_hz\n1,3,900\n", "sigma_hz"),
    "nan": ("mode,n,freq_hz,sigma_hz\n1,3,nan,1\n", "line 2"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", TABLES)
def test_a_table_that_cannot_be_used_is_refused(study, tmp_path, name):
    text, words = TABLES[name]
    (tmp_path / "table.csv").write_text(text)
    refused(study, "update.table", "update")
    refused(study, words, "update")


def test_files_that_are_no_study(tmp_path):
    file = tmp_path / "study.toml"
    refused(file, "found no such file, expected one")
    file.write_bytes(b"[material]\nE = 1 # \xff")
    refused(file, "line 2: found byte 0xff, which is not UTF-8")
    file.write_text("")
    refused(file, "material: found nothing, expected a table [material]")
    file.unlink()
    file.mkdir()
    refused(file, "found a folder")


def test_two_mistakes_are_both_reported_a_line_each(study):
    study.write_text(STUDY.replace("nu = 0.3", "nu = 0.7").replace("[support.base]", "[support.bottom]"))
    lines = invoke("modes", study).stderr.splitlines()
    assert [line.split(": ")[1] for line in lines] == ["material.nu", "support.bottom"]


@pytest.mark.slow
def test_what_a_command_needs_and_the_study_lacks(study):
    free = STUDY[: STUDY.index("[support")] + STUDY[STUDY.index("[modes]") :]
    study.write_text(free.replace("count = 6", "count = 8\nelastic_only = true"))
    refused(study, "modes.elastic_only: found true, and 6 rigid modes")
    refused(study, "reduce: found a structure without supports", "reduce")
    refused(study, "update: found nothing, expected a table [update]", "update")
    study.write_text(STUDY.replace("n_max = 6", "n_max = 60"))
    refused(study, "reduce: rim.n_max must lie between 1 and", "reduce")


@pytest.mark.slow
def test_a_table_of_other_frequencies_pairs_nothing(study, tmp_path):
    (tmp_path / "table.csv").write_text("mode,n,freq_hz,sigma_hz\n1,3,9,1\n")
    refused(study, "update: no row of", "update")


@pytest.mark.slow
def test_a_table_that_is_three_times_too_high_is_refused_with_the_factor(study):
    file = study.with_name("table.csv")
    table = cf.FrequencyTable.from_csv(file)
    replace(table, freq_hz=3.0 * table.freq_hz).to_csv(file)
    refused(study, f"update: {file}, column 'freq_hz': found ", "update")
    refused(study, "typically 3.0", "update")
    refused(study, "check the unit of the table, and E, rho and the dimensions of the model", "update")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("t_end = 2.5e-4", "t_end = 0.0", "scene.t_end"),
        ("x = 0.0", "x = -0.1", "overlap"),
        ("area = 6.4516e-4", "area = -6.4516e-4", "area"),
        ("[scheme]", "[schema]", "schem"),
    ],
)
def test_a_broken_scene_is_refused(tmp_path, old, new, words):
    file = tmp_path / "scene.toml"
    text = (SCENES / "two_rods.toml").read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    refused(file, words, "contact")


def test_out_that_is_a_file(study, tmp_path):
    result = invoke("modes", study, "--out", tmp_path / "table.csv")
    assert result.exit_code == 2
    assert "table.csv" in result.stderr


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from casingfem.cli import main; main()", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_the_program_itself_prints_one_document_and_loads_only_what_it_needs(study):
    script = (
        "import sys; from casingfem.cli import main\n"
        "try: main(['modes', sys.argv[1], '--json'])\n"
        "except SystemExit as end: code = end.code\n"
        "heavy = ['matplotlib', 'jinja2', 'meshio', 'pandas', 'scipy.interpolate', 'scipy.ndimage', 'scipy.optimize']\n"
        "heavy += ['scipy.spatial']\n"
        "unwanted = [m for m in heavy if m in sys.modules]\n"
        "unwanted += [m for m in sys.modules if m[:8] == 'contact.' and m[8:10] not in ('io', 'fo')]\n"
        "print(code, unwanted, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", script, study], capture_output=True, text=True, check=False)
    assert done.stderr == "0 []\n"
    assert len(json.loads(done.stdout)["modes"]) == 6


@pytest.mark.slow
def test_the_program_itself_refuses_and_helps(tmp_path):
    bad = run("modes", tmp_path / "no.toml", "--json")
    assert (bad.returncode, bad.stdout) == (2, "")
    expected = "found no such file, expected one [study-file]"
    assert bad.stderr == f"{tmp_path / 'no.toml'}: {expected}\n"
    assert "Commands:" in invoke().output


def test_doctor_prints_each_finding_on_a_line_and_how_to_install_what_is_missing():
    document = json.loads(invoke("doctor", "--json").stdout)
    lines = invoke("doctor").stdout.splitlines()
    starts = [line[:30].strip() for line in lines]
    for key, value in document.items():
        if key == "extras":
            assert all(f"extra {name}" in starts for name in value)
        elif isinstance(value, dict):
            assert all(f"{key}.{name}" in starts for name in value)
        else:
            assert key in starts or value == []
    shown = {start: line[31:] for start, line in zip(starts, lines, strict=True)}
    for name, found in document["extras"].items():
        state = "installed" if found["installed"] else f"not installed ({', '.join(found['missing'])})"
        assert shown[f"extra {name}"] == f"{state}: {found['for']}"
    wanted = [found["install"] for found in document["extras"].values() if not found["installed"]]
    assert [line.strip() for line in lines if not line[:30].strip()] == wanted
    assert shown["versions.numpy"] == np.__version__
    assert "None" not in shown.values()
