"""The display of progress ends while worker processes start, so that these are copies of the command, and goes on."""

import os
import subprocess
import sys

import pytest

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
    assert b"the rest, 2 s so far" in shown


def read(file):
    """Some bytes; none at the end, which is an error of a terminal."""
    try:
        return os.read(file, 4096)
    except OSError:
        return b""
