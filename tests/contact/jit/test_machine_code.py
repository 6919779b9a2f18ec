"""Machine code on disk is used where it was made from the same sources, whoever may write there, and never otherwise.

Each run of a copy of the package has a process of its own, a fork of one that has loaded numba and nothing of contact.
As root, file modes count once capabilities are dropped.
"""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import contact

PACKAGE = Path(contact.__file__).parent
DECIDE = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "PYTHONDONTWRITEBYTECODE")  # whether and where code is stored
DROPPED = "-dac_override,-dac_read_search"
SETPRIV = shutil.which("setpriv")
AS_USER = [SETPRIV, f"--bounding-set={DROPPED}", f"--inh-caps={DROPPED}"] if SETPRIV and os.geteuid() == 0 else []
modes_count = pytest.mark.skipif(os.geteuid() == 0 and not SETPRIV, reason="root writes everywhere")

# sums whose order depends on how often they were optimised, in a function too long to be drawn into its caller
CALLEE = """
from contact.jit.compiled import jit

@jit
def inner(a, b, c, n):
    s = 0.0
    for i in range(n):
        s += a[i] * b[i]
        c[i] = 0.5 * s + a[i]
    for i in range(n):
        s -= b[i] * c[i]
        if s > 1e3:
            s *= 0.1
    for i in range(n):
        s += a[i] * c[i] * b[i]
    for i in range(n - 1):
        s += (a[i] - b[i + 1]) * c[i]
    for i in range(0, n, 2):
        s += (a[i] - b[i + 1]) / (1.5 + c[i])
    for i in range(n):
        for j in range(n):
            s += a[i] * b[j] * c[j]
    return s * FACTOR
"""
CALLER = """
from contact.jit.compiled import jit_entry
from contact.loop.callee import inner

@jit_entry
def outer(a, b, c, n):
    return inner(a, b, c, n) + inner(b, a, c, n - 1) + inner(c, a, b, n - 2)
"""
RUN = """
from contact.loop.caller import outer
rng = np.random.default_rng(7)
found = [outer(*rng.normal(size=(3, 64)), n).hex() for n in range(3, 40)]
print("compiled" if sum(outer.stats.cache_misses.values()) else "read", *found)
"""


# runs RUN in a fork for each line of folders: the root of a copy, a home and a cache, or none
FORKS = f"""
import json, os, sys
import numpy as np
import numba
for line in sys.stdin:
    root, home, cache = json.loads(line)
    child = os.fork()
    if child == 0:
        os.environ.update(PYTHONPATH=root, HOME=home, **({{"NUMBA_CACHE_DIR": cache}} if cache else {{}}))
        numba.config.reload_config()
        os.chdir(root)
        sys.path.insert(0, root)
        exec({RUN!r})
        sys.stdout.flush()
        os._exit(0)
    os.waitpid(child, 0)
    print("end", flush=True)
"""


@pytest.fixture(scope="module")
def forks() -> Iterator[subprocess.Popen[str]]:
    """The process that has loaded numba."""
    without = {key: value for key, value in os.environ.items() if key not in DECIDE}
    command = [*AS_USER, sys.executable, "-P", "-c", FORKS]
    with subprocess.Popen(command, env=without, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        yield process


class Copy:
    """A copy of the package with one loop of its own, whose callee is in another file."""

    def __init__(self, root: Path, forks: subprocess.Popen[str]) -> None:
        self.root, self.home, self.forks = root, root / "home", forks
        self.home.mkdir()
        shutil.copytree(PACKAGE, root / "contact", ignore=shutil.ignore_patterns("*-????????????????"))  # machine code
        (root / "contact/loop/caller.py").write_text(CALLER, encoding="utf-8")
        self.write_callee(1.0)

    def write_callee(self, factor: float) -> None:
        """Write it with a factor; Python compiles it again if the size differs."""
        text = CALLEE.replace("FACTOR", str(factor))
        (self.root / "contact/loop/callee.py").write_text(text, encoding="utf-8")

    def run(self, cache: Path | None) -> tuple[str, list[float]]:
        """Whether the loop was compiled or read, and what it returned."""
        assert self.forks.stdin
        assert self.forks.stdout
        folders = [str(self.root), str(self.home), str(cache) if cache else ""]
        self.forks.stdin.write(json.dumps(folders) + "\n")
        self.forks.stdin.flush()
        words = list(map(str.strip, iter(self.forks.stdout.readline, "end\n")))[-1].split()
        return words[0], [float.fromhex(word) for word in words[1:]]

    def files(self) -> list[Path]:
        return sorted(self.root.rglob("*.code"))


@pytest.fixture
def copy(tmp_path: Path, forks: subprocess.Popen[str]) -> Copy:
    return Copy(tmp_path, forks)


@pytest.mark.slow
def test_the_process_that_compiles_and_the_next_agree_to_the_last_bit(copy: Copy, tmp_path: Path) -> None:
    how, first = copy.run(tmp_path / "cache")
    assert how == "compiled"
    assert len(copy.files()) == 1  # the part is in the machine code of its caller
    assert copy.run(tmp_path / "cache") == ("read", first)
    (file,) = copy.files()
    file.write_bytes(file.read_bytes()[:-100])  # a damaged file is not used and is replaced
    assert copy.run(tmp_path / "cache") == ("compiled", first)
    assert len(copy.files()) == 1


@pytest.mark.slow
@modes_count
def test_machine_code_goes_to_the_package_where_the_named_directory_cannot_be_written(
    copy: Copy, tmp_path: Path
) -> None:
    cache = tmp_path / "read_only"
    cache.mkdir(mode=0o555)
    assert copy.run(cache)[0] == "compiled"
    assert len(copy.files()) == 1  # in the package's own directory
    assert not list(cache.iterdir())


@pytest.mark.slow
@modes_count
def test_a_read_only_cache_is_used_and_what_it_lacks_goes_to_the_user(copy: Copy) -> None:
    _, first = copy.run(None)  # as the administrator who installed the package
    inside = [copy.root / "contact", *(copy.root / "contact").rglob("*")]
    for each in inside:
        each.chmod(0o555 if each.is_dir() else 0o444)
    try:
        assert copy.run(None) == ("read", first)
        assert not list(copy.home.rglob("*.code"))
    finally:
        for each in inside:
            each.chmod(0o755 if each.is_dir() else 0o644)
    copy.write_callee(16.0)
    for each in inside:
        each.chmod(0o555 if each.is_dir() else 0o444)
    try:
        assert copy.run(None) == ("compiled", [16.0 * value for value in first])
        assert len(list(copy.home.rglob("*.code"))) == 1
        assert copy.run(None)[0] == "read"
    finally:
        for each in inside:
            each.chmod(0o755 if each.is_dir() else 0o644)
