"""Machine code made ahead: after one tiny run of each kind no loop is left to be compiled, whatever runs then."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

SCENES = Path(__file__).parents[2] / "data/scenes"
# runs a command; says on stderr how many functions were compiled for it
COUNTED = """
import sys
from numba.core import event
from casingfem.cli import main
found = []
class Count(event.Listener):
    def on_start(self, e): found.append(e.data["dispatcher"].__name__)
    def on_end(self, e): pass
event.register("numba:compile", Count())
try:
    main(sys.argv[1:], standalone_mode=False)
finally:
    print("compiled:", len(found), *found, file=sys.stderr)
"""
compiles = pytest.mark.skipif(numba.config.DISABLE_JIT, reason="numba is told not to compile")


@compiles
@pytest.mark.slow
def test_a_directory_that_was_filled_ahead_leaves_nothing_to_compile(tmp_path):
    env = {**os.environ, "NUMBA_CACHE_DIR": "", "CASINGFEM_PROGRESS": "off"}
    command = [sys.executable, "-m", "casingfem", "compile", "--into", str(tmp_path / "code"), "--json"]
    done = subprocess.run([*command, "--kind", "point"], env=env, capture_output=True, text=True, check=True)
    document = json.loads(done.stdout)
    assert document["directory"] == str(tmp_path / "code")
    assert [each["kind"] for each in document["kinds"]] == ["point"]
    assert document["files"] == len(list((tmp_path / "code").rglob("*.code"))) > 0
    env["NUMBA_CACHE_DIR"] = str(tmp_path / "code")
    run = [sys.executable, "-c", COUNTED, "contact", str(SCENES / "modal_rod_on_wall.toml")]
    done = subprocess.run(run, env=env, capture_output=True, text=True, check=True)
    assert done.stderr.splitlines()[-1] == "compiled: 0"


def test_a_directory_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    command = [sys.executable, "-m", "casingfem", "compile", "--into", str(tmp_path / "file/code")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert str(tmp_path / "file") in done.stderr
