"""Whether and where a search over a range goes on when a branch is done: made-up branches."""

from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest

import contact as ct

module = import_module("contact.cycles.follow")


@pytest.mark.parametrize(
    ("values", "stable", "end", "runs_from"),
    [
        ([0.0, 0.3, 0.6], [True, True, True], "a contact grazes", 0.6),
        ([0.0, 0.3, 0.6], [True, True, False], "a contact grazes", 0.3),
        ([0.0, 0.6, 0.5], [True, False, True], "a contact grazes", 0.5),
        ([0.0, 0.3, 0.6], [False, False, False], "a contact grazes", None),  # no run stays on any
        ([0.0, 0.6, 0.0], [True, True, False], "", None),  # past a fold back to where it began
        ([0.0, 0.6, 1.0], [True, True, True], "", None),
        ([0.0, 1.0, 0.9], [True, True, True], "a contact grazes", None),
    ],
)
@pytest.mark.parametrize("backwards", [False, True])
def test_a_run_goes_on_where_a_branch_ends_inside_the_range(values, stable, end, runs_from, backwards, monkeypatch):
    """From the last orbit that it stays on, at most a hundredth of the range beyond the farthest one."""
    place = (lambda part: 1.0 - part) if backwards else (lambda part: part)

    def orbit(_, value, guess=(7.0,), start=0.25, stable=True):
        return SimpleNamespace(value=value, x=np.array(guess), start=start, periods=1, stable=stable)

    points = [orbit(None, place(part), (part,), 0.5, stable=kept) for part, kept in zip(values, stable, strict=True)]
    found = iter([ct.cycles.Branch(points=tuple(points), specials=(), end=end)])
    runs = []

    def followed(_, way, **__):
        other = ct.cycles.Branch(points=(way, orbit(None, place(1.0))), specials=(), end="")
        return next(found, other)

    def settled(_, value, __, *, x, at):
        runs.append((value, *x, at))
        return x, at

    for name, replaced in (
        ("orbit", orbit), ("settled", settled), ("begun", lambda _, begin, *__: begin), ("followed", followed),
    ):  # fmt: skip
        monkeypatch.setattr(module, name, replaced)
    family = SimpleNamespace(name="freq_hz")
    cycles = module.follow(family, (place(0.0), place(1.0)))
    if runs_from is None:
        assert len(cycles.branches) == 1
        assert runs == []
        return
    ((value, *state),) = runs
    assert state == [runs_from, 0.5]
    assert 0.6 < place(value) <= 0.61
    assert [branch.points[0].value for branch in cycles.branches] == [place(0.0), value]
