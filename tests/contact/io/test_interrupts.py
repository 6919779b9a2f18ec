"""Ctrl-C waits for the end of a block, though another thread takes the signal."""

import subprocess
import sys

SCRIPT = """
import os, signal, threading, time
from contact.io.interrupts import interrupts_held

signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background has it ignored
threading.Thread(target=time.sleep, args=(2.0,), daemon=True).start()  # it takes signals too
try:
    with interrupts_held():
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.2)
        print("goes on")
    print("not reached")
except KeyboardInterrupt:
    print("ends")
print("as before" if signal.getsignal(signal.SIGINT) is signal.default_int_handler else "changed")
"""


def test_an_interrupt_comes_at_the_end_of_the_block_in_a_program_of_several_threads():
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=False)
    assert (done.stdout.split("\n"), done.stderr) == (["goes on", "ends", "as before", ""], "")
