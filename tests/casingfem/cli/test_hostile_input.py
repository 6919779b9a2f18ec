"""Input that once ended in a traceback or never: every command answers, or says what it would cost."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from itertools import pairwise

import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from tests.casingfem.study.study_texts import THICK

STUDY = """[material]
E = 2e11
nu = 0.3
rho = 7800.0
[chart]
kind = "cylinder"
radius = 0.2
height = 0.2
[shell]
thickness = 2e-3
[support.base]
kind = "clamped"
[modes]
count = 4
"""
RODS = """[scene]
kind = "rods"
t_end = 1e-4
[[rod]]
length = 1.0
area = 1e-4
E = 2e11
rho = 7800.0
elements = 10
velocity = -1.0
[wall]
x = -1e-6
[scheme]
kind = "forward-lagrange"
courant = 0.9
"""
UPDATE = '[update]\ntable = "table.csv"\n[[update.parameter]]\nname = "material.E"\nlower = 1e11\nupper = 3e11\n'
RIM = """[scene]
kind = "rim"
t_end = 1.0
[casing]
basis = "a\\u0000.npz"
[blade]
basis = "b.npz"
[contact]
clearance = 1e-4
[speed]
turning = "blades"
hz = 1.0
[scheme]
kind = "exact-modal"
dt = 1e-5
"""
NESTED = "a = " + "[" * 3000 + "]" * 3000
VARIED = '[[sweep.vary]]\nkey = "rod[1].{}"\nfrom = 1e-3\nto = 2e-3\nsteps = 1000000\n'
CASES = {
    "nested study": ("modes", NESTED, "not TOML: found values nested"),
    "nested scene": ("contact", NESTED, "not TOML: found values nested"),
    "nested tables": ("contact", "a = " + "{a = " * 3000 + "1" + "}" * 3000, "not TOML: found values nested"),
    "digits": ("modes", STUDY.replace("count = 4", "count = " + "9" * 5000), "not TOML: Exceeds the limit"),
    "a scene of no text": ("contact", "\udcff", "line 1: found byte 0xff, which is not UTF-8"),
    "modes": ("modes", STUDY.replace("count = 4", "count = 100000"), "14 GB of shapes, expected at most 11765"),
    "modes of an update": ("update", STUDY + UPDATE.replace('csv"', 'csv"\ncount = 100000'), "14 GB of shapes"),
    "a wide band": ("modes", STUDY.replace("count = 4", "band_hz = [0.0, 1e7]"), "some 4.1e+05 of 17000 unknowns"),
    "any band": ("modes", STUDY.replace("count = 4", "band_hz = [0.0, 1e24]"), "band: found 0.0 to 1e+24 Hz"),
    "a frequency": ("update", STUDY + UPDATE.replace("table.csv", "high.csv"), "e+300 Hz, expected a finite frequency"),
    "elements": ("contact", RODS.replace("= 10\n", "= 1000000000\n"), "elements: found 1000000000, expected at most"),
    "more elements": ("contact", RODS.replace("= 10\n", "= " + "9" * 400 + "\n"), "elements: found over 1e18"),
    "no mass": ("contact", RODS.replace("7800.0", "1e-300"), "rod[1].rho: found 1e-300, expected at least 1e-25"),
    "a basis with a zero byte": ("contact", RIM, "casing.basis"),
    "a survey with a zero byte": ("modes", STUDY + '[[imperfection]]\nof = "radius"\nsurvey = "\\u0000"\n', "zero"),
    "runs": ("sweep", RODS + "[sweep]\n" + VARIED.format("x") + VARIED.format("area"), "found 1000000000000"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_it_is_refused_at_once(tmp_path, case):
    command, text, words = CASES[case]
    (tmp_path / "table.csv").write_text("# SYNTHETIC\nmode,n,freq_hz,sigma_hz\n1,,1000,1\n2,,2000,1\n")
    (tmp_path / "high.csv").write_text("# SYNTHETIC\nmode,n,freq_hz,sigma_hz\n1,,1e300,1\n2,,2e300,1\n")
    file = tmp_path / "file.toml"
    file.write_text(text, encoding="utf-8", errors="surrogateescape")
    started = time.process_time()
    result = CliRunner().invoke(main, [command, str(file)])
    assert (result.exit_code, words in result.stderr, str(file) in result.stderr) == (2, True, True), result.stderr
    assert time.process_time() - started < 8.0


@pytest.mark.slow
def test_a_hundred_strips_are_answered():
    """Rows as short as that need no polynomials of order 7: the mesh has 210 nodes along the meridian, not 700."""
    steel = cf.Material(E=2e11, nu=0.3, rho=7800.0)
    ends = [0.2 * k / 100 for k in range(101)]
    strips = [cf.Strip(start=low, end=high, thickness=2e-3) for low, high in pairwise(ends)]
    parts = {"chart": cf.Cylinder(radius=0.2, height=0.2), "material": steel, "supports": {"base": cf.Clamped()}}
    divided = cf.Shell(**parts, thickness=2e-3, strips=strips)
    assert divided.mesh.order * len(divided.mesh.breaks) < 220
    plain, found = (cf.modes(shell, 2).freq[0] for shell in (cf.Shell(**parts, thickness=2e-3), divided))
    assert found == pytest.approx(plain, rel=3e-4)


@pytest.mark.parametrize("change", [{"E": 1e-300}, {"rho": 1e-300}, {"E": 1e300}])
def test_materials_beyond_what_floats_can_have(change):
    with pytest.raises(cf.errors.InputError, match=r"must lie between 1e-25 and 1e25, found 1e.300"):
        cf.Material(**({"E": 2e11, "nu": 0.3, "rho": 7800.0} | change))


def test_a_table_whose_name_has_a_zero_byte():
    with pytest.raises(cf.errors.InputError, match="found a name with a zero byte"):
        cf.FrequencyTable.from_csv("table\0.csv")


def test_numbers_of_bolts_and_waves_are_whole_and_modest():
    with pytest.raises(cf.errors.InputError, match=r"a whole number between 1 and 1000, found 7.5"):
        cf.Bolts(count=7.5, k=1e8)
    with pytest.raises(cf.errors.InputError, match="harmonics must be <= 10000, found 1000000000"):
        cf.FourierField.of({10**9: 1e-3})


@pytest.mark.parametrize("command", ["modes", "contact", "rig", "sweep", "report"])
def test_results_are_not_written_over_a_file(tmp_path, command):
    """Said before anything is computed: the study is not there."""
    (tmp_path / "out").write_text("mine")
    result = CliRunner().invoke(main, [command, str(tmp_path / "none.toml"), "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    (tmp_path / "file.toml").write_text("")
    result = CliRunner().invoke(main, [command, str(tmp_path / "file.toml"), "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert f"'{tmp_path / 'out'}' is a file" in result.stderr
    assert (tmp_path / "out").read_text() == "mine"


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers that interrupt")
def test_ctrl_c_in_the_report_on_a_study_does_not_claim_stored_results(tmp_path):
    file, out = tmp_path / "casing.toml", tmp_path / "out"
    file.write_text(THICK.replace("order = 5", "order = 10").replace("around = 9", "around = 31"))
    listening = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        result = CliRunner().invoke(main, ["report", str(file), "--out", str(out)])
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, listening)
    assert result.exit_code == 130
    assert result.stderr.endswith(f"stopped: no file in {out} is half written; run the same command again\n")
    assert not out.exists()


@pytest.mark.slow
def test_ctrl_c_in_a_sweep_ends_its_workers_and_it_goes_on(tmp_path):
    """SIGINT to the whole group, as a terminal sends it, while two workers are busy."""
    file, out = tmp_path / "sweep.toml", tmp_path / "out"
    vary = '[sweep]\n[[sweep.vary]]\nkey = "rod[1].velocity"\nfrom = -2.0\nto = -1.0\nsteps = 6\n'
    file.write_text(RODS.replace("1e-4\n[[rod", "3.0\n[[rod") + vary)  # seconds of work, else it may be through
    line = [sys.executable, "-m", "casingfem", "sweep", str(file), "--jobs", "2", "--out", str(out)]
    # where the tests themselves run in the background of a shell, SIGINT is ignored, and children inherit that
    listening = signal.signal(signal.SIGINT, signal.default_int_handler)
    process = subprocess.Popen(line, stderr=subprocess.PIPE, text=True, start_new_session=True)
    signal.signal(signal.SIGINT, listening)
    deadline = time.monotonic() + 120.0
    while not list(out.glob("store/runs/*/*.json")) and time.monotonic() < deadline:
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    said = process.communicate(timeout=20.0)[1]  # returns when the last worker has closed it
    assert process.returncode == 130
    assert said == f"stopped: finished results are stored in {out}/store; the same command continues from them\n"
    again = CliRunner().invoke(main, ["sweep", str(file), "--jobs", "1", "--out", str(out), "--json"])
    assert 1 <= json.loads(again.stdout)["resumed"] < 6  # its workers did not go on to the end


@pytest.mark.slow
def test_runs_of_a_sweep_that_are_not_done_are_counted_on_stderr(tmp_path):
    """Of nine one is done: the table is whole, the exit code 0, and nobody overlooks the other eight."""
    file, out = tmp_path / "sweep.toml", tmp_path / "out"
    speeds = ", ".join(["-1.0", *(f"-{k}e300" for k in range(1, 9))])
    file.write_text(RODS + f'[sweep]\n[[sweep.vary]]\nkey = "rod[1].velocity"\nvalues = [{speeds}]\n')
    found = CliRunner().invoke(main, ["sweep", str(file), "--jobs", "1", "--out", str(out)])
    assert found.exit_code == 0
    assert f"sweep {file}: 8 of 9 runs did not finish; the first: " in found.stderr
    assert len([line for line in (out / "sweep.csv").read_text().splitlines() if not line.startswith("#")]) == 10


def test_a_run_in_which_nothing_touches_states_how_near_it_came(tmp_path):
    """Free flight away from the wall: the least gap is that of the start; towards it, that of the end."""
    file = tmp_path / "rods.toml"
    for velocity, least in (("1.0", 1e-2), ("-1.0", 1e-2 - 1e-4)):
        text = RODS.replace("velocity = -1.0", f"velocity = {velocity}").replace("x = -1e-6", "x = -1e-2")
        file.write_text(text)
        found = CliRunner().invoke(main, ["contact", str(file)])
        assert found.exit_code == 0
        said = re.search(r"no contact closed: the smallest gap was (\S+) m, at contact 1 and (\S+) s", found.stdout)
        assert float(said[1]) == pytest.approx(least, abs=2.5e-5)  # a step
    file.write_text(RODS)
    assert "no contact closed" not in CliRunner().invoke(main, ["contact", str(file)]).stdout
