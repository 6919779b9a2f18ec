"""Progress in a notebook: said after a while, written over, and not outside of one."""

import sys

import contact as ct
from contact.io import notebook


def rods():
    return [
        ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20, x=-1.1, velocity=1.0),
        ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20),
    ]


def test_a_run_says_how_far_it_is_in_a_notebook_alone(monkeypatch, capsys):
    monkeypatch.setattr(notebook, "PATIENCE", 0.0)
    ct.run(rods(), t_end=4.0, courant=0.9)
    assert capsys.readouterr().err == ""
    monkeypatch.setitem(sys.modules, "ipykernel", object())
    ct.run(rods(), t_end=4.0, courant=0.9)
    assert capsys.readouterr().err == "\rrun: 0%"  # said once the loop is compiled
    seen = []
    ct.run(rods(), t_end=4.0, courant=0.9, progress=seen.append)  # one of the user's own takes its place
    assert capsys.readouterr().err == ""
    assert seen == [0.0, 1.0]


def test_a_line_waits_and_is_not_written_all_the_time(monkeypatch, capsys):
    clock = iter([0.0, 1.0, 2.1, 2.2, 2.7])
    monkeypatch.setattr(notebook.time, "monotonic", lambda: next(clock))
    line = notebook.Line("sweep", "{} of 4 runs".format)
    for k in range(1, 5):
        line(k)
    assert capsys.readouterr().err == "\rsweep: 2 of 4 runs\rsweep: 4 of 4 runs"
