"""A store of runs: whole files or none, and what is altered is no run."""

import json

import pytest

from contact.io.publication.digests import digest_of
from contact.sweep.row import Store, read_run, run_path, write_run

ROWS = {digest_of({"run": k}): {"status": "done", "x": k / 3.0, "why": ""} for k in range(20)}


def filled(folder):
    store = Store.open(folder)
    store.note(ROWS)
    return store


def test_rows_come_back_to_the_last_bit(tmp_path):
    store = filled(tmp_path)
    assert store.rows(ROWS) == ROWS
    assert Store.open(tmp_path).rows(list(ROWS)[:3]) == dict(list(ROWS.items())[:3])
    assert len(store.files()) == 20
    assert store.unreadable() == []


def test_files_written_by_workers_are_found_and_files_removed_are_forgotten(tmp_path):
    filled(tmp_path)
    new, (gone, *_) = digest_of({"run": "new"}), ROWS
    write_run(tmp_path, new, {"status": "done"})
    run_path(tmp_path, gone).unlink()
    found = Store.open(tmp_path).rows([new, *ROWS])
    assert found[new] == {"status": "done"}
    assert gone not in found
    assert len(found) == 20


def test_torn_or_changed_files_are_seen(tmp_path):
    store = filled(tmp_path)
    first, second, third, fourth = store.files()[:4]
    first.write_text(first.read_text()[:-20])
    content = json.loads(second.read_text())
    content["row"]["x"] += 1.0
    second.write_text(json.dumps(content))
    third.rename(third.with_name(fourth.name))
    fourth.parent.joinpath(fourth.name).write_bytes(b"\xff\xfe")
    bad = store.unreadable()
    assert {first, second} <= set(bad)
    assert len(bad) == 4
    assert read_run(tmp_path / "nowhere.json") is None
    assert len(store.rows(ROWS)) == 16
    store.note(ROWS)
    assert store.rows(ROWS) == ROWS


@pytest.mark.parametrize("content", ["[" * 100_000, '{"row": ' * 100_000, "9" * 5000, "null", "[]", "{}", "NaN"])
def test_what_is_no_run_is_none(tmp_path, content):
    path = run_path(tmp_path, digest_of("a run"))
    path.parent.mkdir(parents=True)
    path.write_text(content)
    assert read_run(path) is None


def test_no_flipped_bit_changes_a_row(tmp_path):
    """A bit of each byte in turn: the row is the same, or there is none."""
    store = filled(tmp_path)
    digest, row = next(iter(ROWS.items()))
    path = run_path(tmp_path, digest)
    data = path.read_bytes()
    for k in range(len(data)):
        changed = bytearray(data)
        changed[k] ^= 1 << k % 8
        path.write_bytes(changed)
        assert store.rows([digest]) in ({}, {digest: row})


def test_a_half_written_file_has_a_name_of_its_own(tmp_path, monkeypatch):
    """A writer killed before the move leaves nothing under the run's name."""
    digest = next(iter(ROWS))
    monkeypatch.setattr("os.replace", lambda *names: (_ for _ in ()).throw(KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        write_run(tmp_path, digest, ROWS[digest])
    assert not run_path(tmp_path, digest).exists()
    assert Store.open(tmp_path).files() == []
