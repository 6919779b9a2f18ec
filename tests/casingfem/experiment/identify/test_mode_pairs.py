"""Partners among identified modes: neighbours of one n, a quarter wave apart, each in one pair only."""

from types import SimpleNamespace

import numpy as np

from casingfem.experiment.identify.found_modes import PAIR_SPAN, paired


def mode(freq, turns=0.0, *, n=3, unresolved=False):
    """A mode whose antinode is turned by so many quarter waves."""
    return SimpleNamespace(freq=freq, n=n, angle=turns * np.pi / (2.0 * max(n, 1)), unresolved=unresolved)


def test_a_mode_of_a_pair_is_no_partner_of_the_next():
    """Two pairs of one n: the upper mode of the first lies a quarter wave from the lower of the next."""
    assert paired([mode(100.0), mode(101.0, 1.0), mode(110.0), mode(111.0, 1.0)]) == ((0, 1), (2, 3))
    assert paired([mode(100.0), mode(101.0, 1.0), mode(102.0)]) == ((0, 1),)


def test_partners_are_neighbours_of_one_n_and_apart_by_a_quarter_wave():
    assert paired([mode(100.0), mode(100.5, n=2), mode(101.0, 1.0), mode(101.5, 1.0, n=2)]) == ((0, 2), (1, 3))
    assert paired([mode(100.0), mode(101.0, 0.2)]) == ()
    assert paired([mode(100.0), mode(100.0 * (1.0 + 0.99 * PAIR_SPAN), 1.0)]) == ((0, 1),)
    assert paired([mode(100.0), mode(100.0 * (1.0 + 1.01 * PAIR_SPAN), 1.0)]) == ()


def test_modes_of_one_nodal_diameter_have_partners():
    assert paired([mode(100.0, n=1), mode(101.0, 1.0, n=1)]) == ((0, 1),)


def test_what_has_no_waves_or_holds_two_shapes_has_no_partner():
    assert paired([mode(100.0, n=0), mode(101.0, n=0)]) == ()
    assert paired([mode(100.0, unresolved=True), mode(101.0, 1.0)]) == ()
    assert paired([mode(100.0), mode(101.0, 1.0, unresolved=True), mode(102.0, 1.0)]) == ((0, 2),)
