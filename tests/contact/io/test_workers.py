"""Worker processes: copies of a process with one thread, fresh ones beside other threads; both end with their pool."""

import subprocess
import sys
import textwrap

import pytest

SCRIPT = """
import sys
import threading

from contact.io.workers import forks, worker_pool

loaded = []


def seen():
    return loaded


if __name__ == "__main__":
    loaded.append("by the parent")
    ended = threading.Event()
    if "thread" in sys.argv:
        threading.Thread(target=ended.wait).start()
    print(forks())
    with worker_pool(2) as pool:
        print(*pool.submit(seen).result())
    ended.set()
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere every worker is a fresh process")
@pytest.mark.parametrize(("words", "expected"), [([], ["True", "by the parent"]), (["thread"], ["False", ""])])
def test_workers_have_what_their_parent_loaded_unless_a_thread_could_keep_a_lock(tmp_path, words, expected):
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(SCRIPT))
    done = subprocess.run([sys.executable, script, *words], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.splitlines() == expected


ASIDE = """
import multiprocessing
import os
import signal
import sys
import time

from contact.io.workers import parts_aside

PARENT = os.getpid()


def part():
    return os.getpid() != PARENT, sum(range(10))


def fails():
    raise ValueError("what this part refuses")


def unsent():
    return lambda: None


def killed():
    if os.getpid() != PARENT:
        os.kill(os.getpid(), signal.SIGKILL)
    return "done by the parent"


def never():
    time.sleep(600.0)


with parts_aside() as start:
    waiting = [start(each) for each in (part, fails, unsent, killed, never)]
    print(*waiting[0]())
    for each in waiting[1:3]:
        try:
            each()
        except Exception as error:
            print(error)
    print(waiting[3]())
print(len(multiprocessing.active_children()))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a script needs its parts in a module")
def test_a_part_aside_gives_its_result_or_error_and_ends_with_the_block(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(ASIDE))
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=120, check=True)
    result, error, unsent, killed, left = done.stdout.splitlines()
    assert (result, error, killed, left) == ("True 45", "what this part refuses", "done by the parent", "0")
    assert "pickle" in unsent
