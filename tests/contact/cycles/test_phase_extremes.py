"""Extremes that one phase takes over from those before it, and hands on."""

from types import SimpleNamespace

import numpy as np

from contact.cycles.passage import Extremes, _begun

REACHED = Extremes(
    gap=np.array([0.1, 0.2, 0.3]), force=np.array([3.0, 4.0, 5.0]), most=np.array([6.0, 7.0]),
    least=np.array([-8.0, -9.0]),
)  # fmt: skip
INF = np.inf


def begun(slips):
    """The second of three contacts is closed."""
    phase = SimpleNamespace(closed=(1,))
    work = SimpleNamespace(y=np.zeros((2, 2)), most=np.zeros(5), least=np.zeros(5))
    plant, driven = SimpleNamespace(slips=slips), SimpleNamespace(work=work, phase=phase)
    assert _begun(plant, driven, np.array([1.0 + 2.0j, 3.0 - 4.0j]), REACHED) is work
    assert work.y.tolist() == [[1.0, 3.0], [2.0, -4.0]]
    return phase, work


def test_open_contacts_are_watched_for_their_gaps_closed_ones_for_their_forces():
    phase, work = begun(())
    assert work.most.tolist() == [INF, 4.0, INF, 6.0, 7.0]
    assert work.least.tolist() == [0.1, -INF, 0.3, -8.0, -9.0]
    work.most[:], work.least[:] = [INF, 4.5, INF, 6.5, 7.5], [0.05, -INF, 0.25, -8.5, -9.5]
    after = REACHED.after(phase, work)
    assert after.gap.tolist() == [0.05, 0.0, 0.25]  # a closed contact's gap is none
    assert after.force.tolist() == [3.0, 4.5, 5.0]
    assert (after.most.tolist(), after.least.tolist()) == ([6.5, 7.5], [-8.5, -9.5])
    deep = REACHED._replace(gap=np.array([0.1, -0.4, 0.3]))
    assert deep.after(phase, work).gap.tolist() == [0.05, -0.4, 0.25]
    assert REACHED.gap.tolist() == [0.1, 0.2, 0.3]
    assert REACHED.force.tolist() == [3.0, 4.0, 5.0]


def test_the_slip_of_a_closed_contact_is_watched_in_its_phase_alone():
    _, work = begun(((0, 1), (1, 0)))
    assert work.most.tolist() == [INF, 4.0, INF, INF, INF]
    assert work.least.tolist() == [0.1, -INF, 0.3, INF, -INF]
