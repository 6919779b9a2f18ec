"""A run over many draws: its chunks, what is kept of them, what is taken up again, what a worker computes."""

import math
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

import casingfem as cf
from casingfem.modal.mistuning import Pair
from casingfem.study import mistuning
from casingfem.study.mistuning import chunk_name, compute_chunk, open_store, pair_of, read, result_of, run_mistune


def study(digest="abc", count=6):
    file = SimpleNamespace(modes=SimpleNamespace(count=count))
    return SimpleNamespace(path=Path("s.toml"), source={"sha256": digest}, file=file, shell="shell")


def rows(chunk):
    return [list(Pair(draw, 4, 1, 100.0 + draw, 0.01 * (draw + 1), math.nan)) for draw in chunk]


@pytest.fixture
def computed(monkeypatch):
    """A run in threads of this process, whose chunks are quick; those that were computed."""
    done = []

    @contextmanager
    def pool(workers, set_up, *arguments):
        done.append((workers, arguments))
        with ThreadPoolExecutor(1) as executor:
            yield executor

    def chunk(draws):
        done.append(draws)
        return {"pairs": rows(draws), "errors": {str(draws.start): 1e-9 * draws.start}, "from_nothing": [draws[-1]]}

    monkeypatch.setattr(mistuning, "worker_pool", pool)
    monkeypatch.setattr(mistuning, "require_pairs", lambda shell: None)
    monkeypatch.setattr(mistuning, "compute_chunk", chunk)
    monkeypatch.setattr(mistuning, "mean_pairs", lambda: [Pair(-1, 4, 1, 100.0, 0.0, 0.0)])
    return done


def test_a_run_computes_five_draws_at_a_time_and_tells_how_many_are_done(computed):
    said = []
    run = run_mistune(study(), 12, processes=2, progress=said.append)
    assert computed[0] == (2, ("s.toml", "abc"))
    assert sorted(computed[1:], key=lambda chunk: chunk.start) == [range(5), range(5, 10), range(10, 12)]
    assert sorted(said) == said
    assert said[-1] == 12
    assert run.found.draw.tolist() == list(range(12))
    assert run.found.freq.tolist() == [100.0 + draw for draw in range(12)]
    assert (run.errors, run.from_nothing, run.resumed) == ({0: 0.0, 5: 5e-9, 10: 1e-8}, (4, 9, 11), 0)


def test_a_run_has_no_more_workers_than_chunks(computed):
    run_mistune(study(), 6, processes=9)
    assert computed[0][0] == 2


def test_what_is_kept_is_not_computed_again(computed, tmp_path):
    whole = run_mistune(study(), 12, processes=1, folder=tmp_path)
    assert sorted(path.name for path in tmp_path.glob("draws*")) == [
        "draws_000000_000004.json", "draws_000005_000009.json", "draws_000010_000011.json"
    ]  # fmt: skip
    (tmp_path / "draws_000005_000009.json").unlink()
    computed.clear()
    said = []
    again = run_mistune(study(), 12, processes=3, folder=tmp_path, progress=said.append)
    assert (computed, said, again.resumed) == ([(1, ("s.toml", "abc")), range(5, 10)], [12], 7)
    assert (again.found.freq.tolist(), again.errors) == (whole.found.freq.tolist(), whole.errors)
    computed.clear()
    assert run_mistune(study(), 12, processes=3, folder=tmp_path).resumed == 12
    assert computed == [(1, ("s.toml", "abc"))]


def test_a_folder_belongs_to_one_study_and_one_count_of_modes(tmp_path):
    assert open_store(study(), tmp_path) == tmp_path
    assert open_store(study(), tmp_path) == tmp_path
    for other in (study(digest="abd"), study(count=7)):
        with pytest.raises(
            cf.errors.InputError, match=r"s.toml: .* holds draws of another study or version: give another --out"
        ):
            open_store(other, tmp_path)


def test_a_chunk_that_is_not_whole_is_not_there(tmp_path):
    assert read(tmp_path, range(5)) is None
    (tmp_path / chunk_name(range(5))).write_text("{")
    assert read(tmp_path, range(5)) is None


def test_a_row_without_an_angle_is_read_back_as_nan():
    pair = pair_of([3, 4, 1, 100.0, 0.01, None])
    assert pair[:5] == (3, 4, 1, 100.0, 0.01)
    assert math.isnan(pair[5])


def test_a_chunk_that_fails_calls_the_others_off():
    called = []
    executor = SimpleNamespace(shutdown=lambda **given: called.append(given))
    good, bad = Future(), Future()
    good.set_result({"a": 1})
    bad.set_exception(KeyError("k"))
    assert (result_of(good, executor), called) == ({"a": 1}, [])
    with pytest.raises(KeyError):
        result_of(bad, executor)
    assert called == [{"wait": False, "cancel_futures": True}]


def test_every_fiftieth_draw_is_checked_unless_it_was_solved_from_nothing(monkeypatch):
    monkeypatch.setattr(mistuning, "_worker", [mistuning.WorkerState(study(), "mean")])
    monkeypatch.setattr(
        mistuning, "drawn_modes", lambda shell, mean, count, draw: ((shell, mean, count, draw), draw != 100)
    )
    monkeypatch.setattr(mistuning, "pairs_of", lambda found, draw: [(found, draw)])
    monkeypatch.setattr(mistuning, "restart_error", lambda found: found[3] / 64.0)
    content = compute_chunk(range(49, 52))
    assert content["pairs"] == [(("shell", "mean", 6, draw), draw) for draw in (49, 50, 51)]
    assert (content["errors"], content["from_nothing"]) == ({"50": 0.78125}, [])
    assert compute_chunk(range(99, 102))["errors"] == {}
    assert compute_chunk(range(99, 102))["from_nothing"] == [100]


def test_a_worker_refuses_a_study_that_changed_meanwhile(monkeypatch):
    monkeypatch.setattr(mistuning, "load_shell_study", lambda path: study())
    monkeypatch.setattr(mistuning, "mean_modes", lambda shell, count: (shell, count))
    monkeypatch.setattr(mistuning, "perfect_pairs", lambda mean, count: [mean, count])
    monkeypatch.setattr(mistuning, "_worker", [])
    with pytest.raises(RuntimeError, match=r"s\.toml changed while its draws were computed"):
        mistuning.set_up("s.toml", "abd")
    assert mistuning._worker == []
    mistuning.set_up("s.toml", "abc")
    assert mistuning.mean_pairs() == [("shell", 6), 6]
