"""What a command shows on stderr while it takes long: on a terminal, in a file, and switched off."""

import io
import time

import pytest

from casingfem.cli import progress
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
