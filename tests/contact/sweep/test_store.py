"""A store of runs: whole files or none, an index that can be made again."""

import json
import sqlite3

import pytest

from contact.sweep.store import Store, digest_of, read_run, run_path, write_run

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
    store = filled(tmp_path)
    new, (gone, *_) = digest_of({"run": "new"}), ROWS
    write_run(tmp_path, new, {"status": "done"})
    run_path(tmp_path, gone).unlink()
    assert new not in store.rows([new])
    found = Store.open(tmp_path).rows([new, *ROWS])
    assert found[new] == {"status": "done"}
    assert gone not in found
    assert len(found) == 20


@pytest.mark.parametrize("damage", ["lost", "not a database", "no table"])
def test_a_broken_index_is_made_again(tmp_path, damage):
    store = filled(tmp_path)
    for extra in tmp_path.glob("index.sqlite-*"):
        extra.unlink()
    store.index.unlink()
    if damage == "not a database":
        store.index.write_bytes(b"garbage" * 1000)
    if damage == "no table":
        sqlite3.connect(store.index).close()
    assert Store.open(tmp_path).rows(ROWS) == ROWS


def test_an_index_that_is_none_is_closed_before_it_is_made_again(tmp_path, monkeypatch):
    """From Python 3.13 on a connection left open is a warning, raised in whatever runs when it is collected."""
    store, opened, connect = filled(tmp_path), [], sqlite3.connect
    store.index.write_bytes(b"garbage" * 1000)

    def watched(*arguments, **named):
        opened.append(connect(*arguments, **named))
        return opened[-1]

    monkeypatch.setattr(sqlite3, "connect", watched)
    Store.open(tmp_path)
    assert len(opened) == 2
    for index in opened:
        with pytest.raises(sqlite3.ProgrammingError, match="closed"):
            index.execute("SELECT 1")


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
    store.rebuild()
    assert len(store.rows(ROWS)) == 16


def test_a_half_written_file_has_a_name_of_its_own(tmp_path, monkeypatch):
    """A writer killed before the move leaves nothing under the run's name."""
    digest = next(iter(ROWS))
    monkeypatch.setattr("os.replace", lambda *names: (_ for _ in ()).throw(KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        write_run(tmp_path, digest, ROWS[digest])
    assert not run_path(tmp_path, digest).exists()
    assert Store.open(tmp_path).files() == []
