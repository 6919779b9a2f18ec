"""Commands that read leave the disk as it is, whatever lies beside their files."""

import hashlib
import os
import platform
import re
import shutil
import stat
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from casingfem.cli import main
from reports.verification.robustness.kill_targets import write_inputs

ROTATION = "[rotation]\nspeed_hz = 10.0\n"
READ = {  # arguments of each command; the exit code is 0, or 2 where the files lack what it needs
    "modes": ("study.toml",), "campbell": ("turning.toml", "--steps", "2", "--count", "2"), "update": ("study.toml",),
    "frf": ("records.npz",), "identify": ("frfs.npz", "--open", "--order", "8"),
    "correlate": ("study.toml", "frfs.npz"),
    "mistune": ("study.toml", "--draws", "1"), "rig": ("study.toml",), "locate": ("study.toml", "table.csv"),
    "import": ("part.npz", "--contact", "7", "--modes", "2"), "export": ("study.toml",), "contact": ("scene.toml",),
    "rub": ("rim.toml",), "stability": ("rim.toml",), "interactions": ("rim.toml", "--runs", "2"),
    "cycles": ("scene.toml",), "sweep": ("sweep.toml", "--jobs", "1"), "chance": ("rim.toml",), "schema": (),
    "response": ("study.toml",), "explain": ("shell-thickness",), "doctor": (),
}  # fmt: skip
REFUSED = {"correlate", "mistune", "rig", "locate", "cycles", "chance", "response"}
MANIFEST = ".casingfem-publication.json"
HERE = re.sub(r"\W", "_", platform.node())  # names of unfinished sets begin with their machine
NAMES = ("study.toml", "table.csv", "rim.toml", "casing.npz", "blade.npz", "part.npz", "frfs.npz", "records.npz")


WRITE = {"compile", "example", "new", "recover", "reduce", "report", "watch"}


def test_every_command_that_reads_has_a_case_here():
    assert set(main.commands) == set(READ) | WRITE


def state(folder):
    """Kind, mode, owner, time, size, links and content of all that lies in a folder, and of the folder."""
    found = {}
    for path in (folder, *sorted(folder.rglob("*"))):
        at = path.lstat()
        content = os.readlink(path) if path.is_symlink() else ""
        if stat.S_ISREG(at.st_mode):
            content = hashlib.sha256(path.read_bytes()).hexdigest()
        # a folder's size and number of links are those of its file system
        found[str(path)] = (at.st_mode, at.st_uid, at.st_gid, at.st_mtime_ns, at.st_ino, at.st_nlink, content)
    return found


def with_a_new_folder(folder, victim):
    """Add the folder `.new`, in which an earlier version kept files while it wrote them."""
    (folder / ".new" / "deep").mkdir(parents=True)
    for name in NAMES:
        (folder / ".new" / name).write_text("not yours")


def with_odd_owners_and_odd_things(folder, victim):
    """Add a closed folder, pipes, links and parts of killed writers; the files are read-only and of another owner."""
    for name in NAMES:
        (folder / name).chmod(0o444)
        if os.geteuid() == 0:
            os.chown(folder / name, 12345, 12345)
    (folder / "closed").mkdir(mode=0o000)
    (folder / ".new").symlink_to(victim)
    os.mkfifo(folder / "pipe.csv")
    (folder / "nothing.toml").symlink_to("nowhere")
    (folder / "loop.toml").symlink_to("loop.toml")
    (folder / MANIFEST).write_text('{"format": "casingfem-publication-1"}')
    dead = f"{HERE}-{2**22 + 1}-0-{'0' * 32}.part"
    (folder / f".study.toml.{dead}").write_text("half")
    (folder / f".set.{dead}" / "new").mkdir(parents=True)
    (folder / f".link.{dead}").symlink_to(victim)
    (folder / ".casing.npz.host-1-0.part").write_text("of an earlier version")


@pytest.mark.skipif(os.name != "posix", reason="pipes, links and modes are of POSIX systems")
@pytest.mark.parametrize(
    ("command", "surroundings"),
    [("modes", with_a_new_folder), *((command, with_odd_owners_and_odd_things) for command in READ)],
)
@pytest.mark.slow
def test_a_command_that_reads_changes_nothing(inputs, tmp_path, monkeypatch, command, surroundings):
    folder, victim = tmp_path / "project", tmp_path / "victim"
    shutil.copytree(inputs, folder)
    (victim / "sub").mkdir(parents=True)
    (victim / "study.toml").write_text("mine")
    (victim / "sub" / "b.txt").write_text("mine")
    surroundings(folder, victim)
    before = state(tmp_path)
    monkeypatch.chdir(folder)
    result = CliRunner().invoke(main, [command, *READ[command]])
    assert result.exit_code == (2 if command in REFUSED else 0), result.output
    after = state(tmp_path)
    assert {path for path in before.keys() | after.keys() if before.get(path) != after.get(path)} == set()


@pytest.fixture(scope="session")
def inputs(tmp_path_factory):
    """A folder with files that the commands read."""
    folder = tmp_path_factory.mktemp("inputs") / "old"
    write_inputs(folder, 1.0)
    study = (folder / "study.toml").read_text()
    (folder / "turning.toml").write_text(study.partition("[update]")[0] + ROTATION)
    t = np.arange(400) / 1e3
    pulse = np.where(np.abs(t - 0.05) < 5e-3, np.cos(100.0 * np.pi * (t - 0.05)) ** 2, 0.0)
    np.savez(folder / "records.npz", fs=1e3, force=pulse, response=np.convolve(pulse, np.exp(-30.0 * t))[:400])
    return Path(folder)
