"""Progress in a notebook: shown after a while, written over, and not outside of one."""

import sys
import time

import pytest

import contact as ct


def rods():
    return [
        ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20, x=-1.1, velocity=1.0),
        ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20),
    ]


def test_a_run_shows_its_progress_in_a_notebook_alone(monkeypatch, capsys):
    ticks = iter(range(0, 10_000, 3))
    monkeypatch.setattr(time, "monotonic", lambda: float(next(ticks)))
    ct.run(rods(), t_end=4.0, courant=0.9)
    assert capsys.readouterr().err == ""
    monkeypatch.setitem(sys.modules, "ipykernel", object())
    ct.run(rods(), t_end=4.0, courant=0.9)
    assert capsys.readouterr().err == "\rrun: 0%\rrun: 100%"
    seen = []
    ct.run(rods(), t_end=4.0, courant=0.9, progress=seen.append)  # one of the user's own takes its place
    assert capsys.readouterr().err == ""
    assert seen == [0.0, 1.0]


@pytest.mark.parametrize(("step", "shown"), [(0.9, []), (1.1, [100]), (2.1, [0, 100])])
def test_a_line_waits_for_two_seconds(monkeypatch, capsys, step, shown):
    ticks = iter(range(10_000))
    monkeypatch.setattr(time, "monotonic", lambda: step * next(ticks))
    monkeypatch.setitem(sys.modules, "ipykernel", object())
    ct.run(rods(), t_end=4.0, courant=0.9)
    assert capsys.readouterr().err == "".join(f"\rrun: {percent}%" for percent in shown)


def test_a_line_is_written_over_every_half_second_at_most(monkeypatch, capsys):
    """Eleven calls, 0.3 s apart: at 2.1 s, 2.7 s and 3.3 s."""
    ticks = iter(range(10_000))
    monkeypatch.setattr(time, "monotonic", lambda: 0.3 * next(ticks))
    monkeypatch.setitem(sys.modules, "ipykernel", object())
    ct.run([ct.Wall(x=0.0), ct.PointMass(mass=1.0, x=1.0, velocity=1.0)], t_end=0.2, dt=1e-6)
    assert capsys.readouterr().err == "\rrun: 60%\rrun: 80%\rrun: 100%"
