"""When the file of a long computation is written, and whose file it is."""

import time
from dataclasses import dataclass
from pathlib import Path

import pytest

import contact as ct
from contact.base.checkpoint import Checkpoint
from contact.resumed import Moment


def moment(taken: int) -> Moment:
    return Moment(asked="this", taken=taken, seconds=0.0, memory=(), samples=(), calm=None)


@dataclass
class Clock:
    now: float = 0.0


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(time, "monotonic", lambda: clock.now)
    return clock


def test_a_file_is_written_every_two_seconds_or_when_it_must_be(clock: Clock, tmp_path: Path) -> None:
    file = tmp_path / "out/part.npz"
    kept = Checkpoint(file, "this", Moment)
    assert kept.found is None
    clock.now = 1.99
    kept.keep(lambda: moment(1))
    assert not file.parent.exists()
    kept.keep(lambda: moment(2), now=True)
    clock.now = 3.98
    kept.keep(lambda: moment(3))
    assert Checkpoint(file, "this", Moment).found.taken == 2
    clock.now = 4.0
    kept.keep(lambda: moment(4))
    assert Checkpoint(file, "this", Moment).found.taken == 4


def test_the_interval_grows_with_the_time_that_a_writing_takes(clock: Clock, tmp_path: Path) -> None:
    file = tmp_path / "part.npz"
    kept = Checkpoint(file, "this", Moment)

    def slow(taken: int) -> Moment:
        clock.now += 0.5
        return moment(taken)

    kept.keep(lambda: slow(1), now=True)
    for later, taken in ((9.99, 1), (10.0, 2)):
        clock.now = 0.5 + later
        kept.keep(lambda: slow(2))
        assert Checkpoint(file, "this", Moment).found.taken == taken


def test_a_file_of_another_computation_or_of_nothing_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "part.npz"
    Checkpoint(file, "this", Moment).keep(lambda: moment(1), now=True)
    with pytest.raises(ct.InputError, match=r"checkpoint: .*part.npz: found that of another computation or version"):
        Checkpoint(file, "other", Moment)
    file.write_bytes(b"not a file of numbers")
    with pytest.raises(ct.InputError, match=r"checkpoint: .*part.npz.*; remove it to begin anew"):
        Checkpoint(file, "this", Moment)
