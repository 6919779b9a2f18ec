"""The display of progress ends while worker processes start, so that these are copies of the command, and goes on."""

import os
import re
import subprocess
import sys

import pytest

from casingfem.cli.progress import ProgressMessage, duration

SCRIPT = """
import time

from casingfem.cli.progress import ProgressMessage
from contact.io.workers import forks, worker_pool

loaded = []


def seen():
    return loaded


if __name__ == "__main__":
    loaded.append("by the parent")
    with ProgressMessage("the work") as working:
        time.sleep(1.2)
        with worker_pool(2) as pool:
            found = pool.submit(seen).result()
        copies = forks()
        working.say("the rest")
        time.sleep(1.5)
    print(copies, *found)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere every worker is a fresh process")
@pytest.mark.parametrize("terminal", [False, True])
def test_workers_beside_a_display_are_copies_and_the_display_goes_on(tmp_path, terminal):
    (tmp_path / "script.py").write_text(SCRIPT)
    ours, theirs = os.openpty() if terminal else os.pipe()
    ending = {"CASINGFEM_PROGRESS": "on", "TERM": "xterm", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, tmp_path / "script.py"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=theirs, env={**os.environ, **ending}) as running:
        os.close(theirs)
        shown = b"".join(iter(lambda: read(ours), b""))
        assert running.stdout is not None
        assert running.stdout.read().split() == [b"True", b"by", b"the", b"parent"]
    os.close(ours)
    assert re.search(rb"the rest, ([2-9]|[1-9]\d+) s so far", shown)  # later on a busy machine


def read(file):
    """Some bytes; none at the end, which is an error of a terminal."""
    try:
        return os.read(file, 4096)
    except OSError:
        return b""


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.4, "0 s"), (59.4, "59 s"), (59.6, "1 min 0 s"), (61.0, "1 min 1 s"), (3599.4, "59 min 59 s"),
        (3599.6, "1 h 0 min"), (3661.0, "1 h 1 min"), (90061.0, "25 h 1 min"),
    ],
)  # fmt: skip
def test_durations_are_in_the_two_largest_units(seconds, words):
    assert duration(seconds) == words


def later(working, seconds):
    """The text after so many seconds more."""
    working.started -= seconds
    return working.text


def test_remaining_time_is_that_of_the_share_since_the_first_one():
    working = ProgressMessage("modes")
    assert later(working, 90.0) == "modes, 1 min 30 s so far"
    working.say("modes: meshes", 0.25)
    assert working.text == "modes: meshes: 25%, 1 min 30 s so far"
    working.started -= 30.0
    working.say("modes: shapes", 0.5)
    assert working.text == "modes: shapes: 50%, 2 min 0 s so far, about 1 min 0 s left"
    working.tell("step 3", 0.1)  # of a step: the share of the command stays
    assert working.text == "modes: shapes, step 3: 50%, 2 min 0 s so far, about 1 min 0 s left"
    working.say("modes: rest")
    assert working.text == "modes: rest, 2 min 0 s so far"


def test_the_share_of_a_step_counts_where_that_of_the_command_is_unknown():
    working = ProgressMessage("update")
    working.started -= 100.0
    working.tell("step 1", 0.2)
    assert working.text == "update, step 1: 20%, 1 min 40 s so far"
    working.started -= 10.0
    working.tell("step 2", 0.4, True)
    assert working.text == "update, step 2: 40%, 1 min 50 s so far, at most 30 s left of this part"
    working.tell("step 2", 0.4)
    assert working.text == "update, step 2: 40%, 1 min 50 s so far, about 30 s left of this part"
    working.tell("another", 0.3)  # less: another step begins
    assert working.text == "update, another: 30%, 1 min 50 s so far"
    working.started -= 10.0
    working.tell("another", 0.65)
    assert working.text == "update, another: 65%, 2 min 0 s so far, about 10 s left of this part"
    working.say("update: page", 0.9)
    working.started -= 10.0
    working.tell("words", 0.1, True)
    working.say("update: page", 0.95)
    assert working.text == "update: page: 95%, 2 min 10 s so far, about 10 s left"  # from 90 % on, of the command
