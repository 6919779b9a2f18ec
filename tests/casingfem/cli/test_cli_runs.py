"""What commands refuse before they begin, and how a run that was stopped goes on."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from casingfem.cli import main


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("modes", "a.toml", "--modes", "1"), "--modes found without --vtu or --uff"),
        (("modes", "a.toml", "--vtu"), "--vtu or --uff found without --out DIR"),
        (("modes", "a.toml", "--uff", "--modes", "1"), "--vtu or --uff found without --out DIR"),
        (("rub", "a.toml", "--vtu"), "found --vtu without --out DIR, expected both"),
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


LONG = """
[scene]
kind = "rods"
t_end = 12.0
[[mass]]
mass = 1.0
x = 0.5
anchor = 0.0
stiffness = 1e4
velocity = 1.0
force = 20.0
force_hz = 20.0
[wall]
x = 0.55
[scheme]
kind = "cd-lagrange"
restitution = 0.8
dt = 2e-7
"""


@pytest.mark.campaign
def test_a_killed_run_goes_on_to_the_same_numbers(tmp_path: Path) -> None:
    (tmp_path / "long.toml").write_text(LONG, encoding="utf-8")
    here = {**os.environ, "CASINGFEM_PROGRESS": "on"}

    def command(out: str) -> list[str]:
        return [sys.executable, "-m", "casingfem", "contact", "long.toml", "--json", "--out", out]

    whole = subprocess.run(command("whole"), cwd=tmp_path, env=here, capture_output=True, text=True, check=False)
    assert "left" in whole.stderr  # an estimate in a pipe
    running = subprocess.Popen(command("killed"), cwd=tmp_path, env=here, stdout=subprocess.DEVNULL)
    part, end = tmp_path / "killed/contact.part.npz", time.monotonic() + 120.0
    while not part.exists() and time.monotonic() < end:
        time.sleep(0.02)
    running.send_signal(signal.SIGKILL)
    running.wait()
    assert part.exists()
    again = subprocess.run(command("killed"), cwd=tmp_path, env=here, capture_output=True, text=True, check=False)
    assert not part.exists()
    first, second = (json.loads(each.stdout) for each in (whole, again))
    assert first.pop("seconds") > 0.0 < second.pop("seconds")
    assert first == second
    assert (tmp_path / "whole/contact_forces.csv").read_bytes() == (tmp_path / "killed/contact_forces.csv").read_bytes()
