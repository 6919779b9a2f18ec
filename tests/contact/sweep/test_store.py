"""The store of a sweep: finished runs are read again to the last bit, and a file that was altered is no run."""

import json
import os
from pathlib import Path

import pytest
from click.testing import CliRunner

from casingfem.cli import main

SCENE = (Path(__file__).parents[3] / "data" / "scenes" / "two_rods.toml").read_text(encoding="utf-8")
SPEEDS = [1.0 + 0.25 * k / 3.0 for k in range(20)]


def swept(folder, speeds, *options):
    """Rows of a sweep over the speed of a rod and how many of them were stored before."""
    table = f'[sweep]\n[[sweep.vary]]\nkey = "rod[1].velocity"\nvalues = {speeds}\n'
    (folder / "rods.toml").write_text(SCENE.replace("elements = 100", "elements = 5") + table, encoding="utf-8")
    words = ["sweep", str(folder / "rods.toml"), *(options or ("--jobs", "1")), "--out", str(folder / "out"), "--json"]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 0, done.output
    document = json.loads(done.stdout)
    return document["runs"], document["resumed"]


def files(folder):
    return sorted(path for path in (folder / "out" / "store").rglob("*") if path.is_file())


@pytest.fixture
def filled(tmp_path):
    """A folder with the store of a sweep, and its rows."""
    rows, resumed = swept(tmp_path, SPEEDS)
    assert resumed == 0
    assert len(files(tmp_path)) == len(SPEEDS)
    return tmp_path, rows


def test_rows_come_back_to_the_last_bit(filled):
    folder, rows = filled
    assert swept(folder, SPEEDS) == (rows, 20)
    assert swept(folder, SPEEDS[2:5]) == (rows[2:5], 3)
    assert len({row["peak_force_N"] for row in rows}) == 20


def test_runs_of_another_sweep_are_found_and_files_removed_are_forgotten(filled):
    folder, rows = filled
    files(folder)[3].unlink()
    more, resumed = swept(folder, [*SPEEDS, 9.0])
    assert more[:20] == rows
    assert resumed == 19
    assert len(files(folder)) == 21


def test_torn_changed_and_renamed_files_are_no_runs_and_are_replaced(filled):
    folder, rows = filled
    first, second, third, fourth = files(folder)[:4]
    first.write_text(first.read_text()[:-20])
    content = json.loads(second.read_text())
    content["row"]["peak_force_N"] += 1.0
    second.write_text(json.dumps(content))
    fourth.write_bytes(third.read_bytes())  # whole, but of another run
    third.write_bytes(b"\xff\xfe")
    assert swept(folder, SPEEDS) == (rows, 16)
    assert swept(folder, SPEEDS) == (rows, 20)


@pytest.mark.parametrize("content", ["[" * 100_000, '{"row": ' * 100_000, "9" * 5000, "null", "[]", "{}", "NaN"])
def test_what_is_no_run_is_run_again(filled, content):
    folder, rows = filled
    files(folder)[0].write_text(content)
    assert swept(folder, SPEEDS) == (rows, 19)


@pytest.mark.slow
def test_no_flipped_bit_changes_a_row(filled):
    """In each round a bit of another byte of every file."""
    folder, rows = filled
    whole = [path.read_bytes() for path in files(folder)]
    for start in range(0, max(map(len, whole)), 5 * len(whole)):
        for number, (path, data) in enumerate(zip(files(folder), whole, strict=True)):
            changed, k = bytearray(data), (start + number) % len(data)
            changed[k] ^= 1 << k % 8
            path.write_bytes(changed)
        assert swept(folder, SPEEDS)[0] == rows


def test_a_half_written_file_has_a_name_of_its_own(tmp_path, monkeypatch):
    """A writer killed before the move leaves nothing under the run's name."""
    with monkeypatch.context() as patched:
        patched.setattr("os.replace", lambda *names: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(AssertionError):
            swept(tmp_path, SPEEDS[:2])
    rows, resumed = swept(tmp_path, SPEEDS[:2])
    assert resumed == 0
    assert swept(tmp_path, SPEEDS[:2]) == (rows, 2)


@pytest.mark.slow
def test_a_row_whose_worker_does_not_share_the_disk_is_written_where_the_sweep_was_started(tmp_path, monkeypatch):
    """The file that the worker writes does not arrive: the first move of each is lost."""
    distributed, lost, move = pytest.importorskip("distributed"), set(), os.replace

    def first_is_lost(source, target):
        if "runs" in Path(target).parts and target not in lost:
            lost.add(target)
            os.unlink(source)
        else:
            move(source, target)

    with (
        monkeypatch.context() as patched,
        distributed.LocalCluster(
            n_workers=1, processes=False, protocol="tcp", host="127.0.0.1", dashboard_address=None
        ) as cluster,
    ):
        patched.setattr(os, "replace", first_is_lost)
        rows, _ = swept(tmp_path, SPEEDS[:3], "--scheduler", cluster.scheduler_address)
    assert len(lost) == 3
    assert swept(tmp_path, SPEEDS[:3]) == (rows, 3)
