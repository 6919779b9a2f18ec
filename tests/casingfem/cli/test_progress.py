"""What a command shows on stderr while it takes long: on a terminal, in a file, and switched off."""

import io
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from casingfem.cli import main, progress
from casingfem.cli.progress import ProgressMessage


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    return now


def until(shown: io.StringIO, words: str) -> str:
    """What a stream has once these words are in it."""
    end = time.monotonic() + 60.0
    while words not in shown.getvalue() and time.monotonic() < end:
        time.sleep(0.005)
    return shown.getvalue()


def test_the_estimate_leaves_out_the_time_before_the_first_share(clock: list[float]) -> None:
    message = ProgressMessage("rub a.toml: compiling")
    clock[0] = 130.0
    assert message.text == "rub a.toml: compiling, 30 s so far"
    message.say("rub a.toml", 0.0)
    assert message.text == "rub a.toml: 0%, 30 s so far"
    clock[0] = 132.0
    message.say("rub a.toml", 0.1)
    assert message.text == "rub a.toml: 10%, 32 s so far, about 18 s left"
    clock[0] = 140.0
    message.say("drawing")  # a step of unknown length
    assert message.text == "drawing, 40 s so far"
    message.say("again", 0.5)
    assert message.text == "again: 50%, 40 s so far"
    assert message.seconds == 40.0


def test_what_a_step_tells_counts_where_the_command_knows_no_share(clock: list[float]) -> None:
    message = ProgressMessage("modes of a.toml")
    message.tell("0 of 40 modes converged", 0.2)
    clock[0] = 104.0
    message.tell("10 of 40 modes converged", 0.4)
    assert message.text == "modes of a.toml, 10 of 40 modes converged: 40%, 4 s so far, about 12 s left of this part"
    message.tell("step 1 of at most 30", 0.0, most=True)  # a smaller share is that of another part
    clock[0] = 106.0
    message.tell("step 4 of at most 30", 0.1, most=True)
    assert message.text == "modes of a.toml, step 4 of at most 30: 10%, 6 s so far, at most 18 s left of this part"
    message.say("sweep, 1 of 4 runs", 0.25)
    message.tell("a run", 0.9)
    clock[0] = 108.0
    message.say("sweep, 2 of 4 runs", 0.5)
    assert message.text == "sweep, 2 of 4 runs: 50%, 8 s so far, about 4 s left"


STUDY = """[chart]
kind = "frustum"
r_base = 0.2
r_top = 0.18
height = 0.2
[shell]
thickness = 2e-3
[material]
E = 2e11
nu = 0.3
rho = 7800.0
[support.base]
kind = "clamped"
[modes]
count = 12
[mesh]
order = 4
rows = 1
around = 9
[[imperfection]]
of = "radius"
harmonics = [{p = 4, cos = 1e-3}]
[update]
table = "modes.csv"
[[update.parameter]]
name = "material.E"
lower = 1e11
upper = 3e11
"""


@pytest.mark.slow
def test_modes_and_updates_tell_their_shares(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[str, float | None]] = []
    monkeypatch.setenv(progress.SWITCH, "on")
    monkeypatch.setattr(ProgressMessage, "tell", lambda _, words, done=None, most=False: told.append((words, done)))
    table = "# MEASURED: made for a test\nmode,n,freq_hz,sigma_hz\n1,4,700.0,5.0\n"
    (tmp_path / "modes.csv").write_text(table, encoding="utf-8")
    study = tmp_path / "study.toml"
    study.write_text(STUDY, encoding="utf-8")
    assert CliRunner().invoke(main, ["modes", str(study)]).exit_code == 0
    for words, done in told:  # the share is that of the modes; unknown while there is none
        ready, _, wanted = words.split(" modes converged")[0].rpartition(", ")[2].partition(" of ")
        assert done == (int(ready) / int(wanted) if int(ready) else None)
    assert told
    told.clear()
    CliRunner().invoke(main, ["update", str(study)])
    assert [words.split(",")[0] for words, _ in told if "step" in words][:2] == [
        "step 1 of at most 30", "step 2 of at most 30"
    ]  # fmt: skip
    assert [done for words, done in told if "step" in words][:2] == [0.0, 1.0 / 30.0]


def test_a_file_gets_whole_lines_with_the_estimate(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = io.StringIO()
    monkeypatch.setattr("sys.stderr", shown)
    monkeypatch.setattr(progress, "FIRST", 0.01)
    monkeypatch.setenv(progress.SWITCH, "on")
    with ProgressMessage("sweep a.toml") as working:
        working.say("sweep a.toml, 0 of 8 runs", 0.0)
        working.say("sweep a.toml, 2 of 8 runs", 0.25)
        lines = until(shown, "left\n").splitlines()
    assert lines[-1].startswith("sweep a.toml, 2 of 8 runs: 25%, 0 s so far, about ")


def test_a_terminal_gets_its_cursor_back(monkeypatch: pytest.MonkeyPatch) -> None:
    hidden, visible = "\x1b[?25l", "\x1b[?25h"
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    monkeypatch.setenv(progress.SWITCH, "on")
    monkeypatch.setenv("TERM", "xterm")
    with ProgressMessage("modes"):
        until(terminal, "modes")
    assert "modes" in terminal.getvalue()
    assert terminal.getvalue().rindex(visible) > terminal.getvalue().rindex(hidden)


def test_progress_is_switched_off_by_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = io.StringIO()
    monkeypatch.setattr("sys.stderr", shown)
    monkeypatch.setattr(progress, "FIRST", 0.0)
    monkeypatch.setenv(progress.SWITCH, "off")
    with ProgressMessage("modes"):
        time.sleep(0.05)
    assert shown.getvalue() == ""
