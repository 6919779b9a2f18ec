"""Contact that stays closed: the mean of a turning compliance, modes that are equal, what turns into itself."""

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.permanent import equal_modes, mean_compliance
from contact.model.gaps.rub_system import rub_system
from tests.contact.synthetic_rub import N_MAX, nodes, rim3, tips


def test_the_mean_compliance_of_a_turn_is_that_over_many_angles():
    system = rub_system(ct.Rub(rim3(), (nodes(2),), tips(2)), 2)
    mean, varies = mean_compliance(system, N_MAX)
    around = np.array([system.compliance(turned) for turned in 2.0 * np.pi * np.arange(997) / 997])
    np.testing.assert_allclose(mean, around.mean(axis=0), rtol=1e-10, atol=1e-12 * np.abs(mean).max())
    most = np.abs(around - mean).max() / np.abs(mean).max()
    assert 0.8 * most < varies <= most * (1.0 + 1e-9)


@pytest.mark.parametrize(("apart", "groups"), [(1e-9, [[0, 1], [2]]), (1e-6, [[0], [1], [2]])])
def test_modes_are_equal_to_eight_digits_and_in_damping(apart, groups):
    omega = np.array([100.0, 100.0 * (1.0 + apart), 300.0])
    assert [group.tolist() for group in equal_modes(omega, np.full(3, 0.01))] == groups
    assert [group.tolist() for group in equal_modes(omega, np.array([0.01, 0.02, 0.01]))] == [[0], [1], [2]]
