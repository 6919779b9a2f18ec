"""The least squares of an update: priors below the data, modes counted, rows paired anew."""

from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.updating.problem import Problem
from tests.casingfem.updating.test_update_judged import blade, table

PRIORS = [
    cf.Parameter(name="material.E", lower=1e9, upper=1e12),
    cf.Parameter(name="shell.thickness", lower=1e-3, upper=1e-2, sigma=2e-4),
]


@pytest.fixture(scope="module")
def problem():
    return Problem(blade(), table(rows=3), PRIORS, 5, 0.5)


def test_priors_stand_below_the_data(problem):
    x = problem.start * [1.0, 1.1]
    r, J = problem.fun(x), problem.jac(x)
    np.testing.assert_array_equal(r[:3], problem.state(x).values)
    assert r[3] == pytest.approx(3e-4 / 2e-4)
    np.testing.assert_array_equal(J[:3], problem.data_jacobian(x))
    np.testing.assert_allclose(J[3], [0.0, 5e3], rtol=1e-14)
    for k in range(2):
        step = 1e-5 * x * np.eye(2)[k]
        slope = (problem.fun(x + step) - problem.fun(x - step)) / (2e-5 * x[k])
        np.testing.assert_allclose(J[:, k], slope, rtol=1e-3)


def test_modes_of_a_point_are_counted_when_asked(problem):
    problem.jac(problem.start)
    x = problem.start * [1.02, 1.0]
    state = problem.state(x)
    assert state.modes.sturm_count is None  # restarted from the point before
    whole = problem.counted(x)
    assert whole.modes.sturm_count == 5
    assert whole.solution.modes is whole.modes
    np.testing.assert_array_equal(whole.values, state.values)


def test_rows_paired_anew_are_where_modes_are_followed_from(problem):
    x = problem.start * [1.03, 1.0]
    fresh = problem.paired_anew(x)
    assert problem.anchor is fresh
    assert problem.state(x) is fresh
    assert [match.rows for match in fresh.pairing.matches] == [(0,), (1,), (2,)]


def test_an_imported_part_is_solved_from_nothing_and_counted_as_it_is():
    mesh = cf.imported.grid_mesh(
        "quad9", (2, 1), lambda u: np.insert(u * [0.3, 0.05], 2, 0.0, axis=1), groups={"root": (0, 0.0)}
    )
    # thick enough for bending to stand out of the round-off of K's sums, on any processor
    part = cf.MeshShell(
        mesh=mesh, thickness=2e-2, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"root": cf.Clamped()}
    )
    freq = cf.modes(part, 3).freq
    rows = cf.FrequencyTable.from_arrays(freq_hz=1.01 * freq, sigma_hz=1e-3 * freq)
    problem = Problem(part, rows, [cf.Parameter(name="material.E", lower=1e9, upper=1e12)], 4, 0.5)
    x = problem.start
    state = problem.state(x)
    assert state.solution is None
    assert problem.counted(x) is state
    np.testing.assert_allclose(state.values, -10.0, rtol=1e-6)
    np.testing.assert_allclose(problem.jac(x)[:, 0], 1e3 / (2.0 * 210e9), rtol=1e-6)
    assert problem.structure(1.1 * x).material.E == pytest.approx(231e9)


@pytest.mark.slow
def test_a_perfect_casing_is_solved_harmonic_by_harmonic_and_another_as_a_whole(frustum):
    mesh = cf.ShellMesh(order=4, rows=1, around=7)
    rows = cf.FrequencyTable.from_arrays(freq_hz=cf.modes(frustum(thickness=2e-2, mesh=mesh), 4).freq, sigma_hz=1.0)
    for defect, whole in ((None, False), (cf.FourierField.of({3: 1e-3}), True)):
        shell = frustum(thickness=2e-2, mesh=mesh, radius_defect=defect)
        state = Problem(shell, rows, PRIORS, 8, 0.5).state(np.array([210e9, 2e-2]))
        assert (state.solution is not None) == whole
        assert state.modes.sturm_count == 8


def test_an_assembled_shell_is_used_by_its_first_solution_alone():
    shell = blade()
    system = cf.shell.assemble(shell)
    problem = Problem(shell, table(rows=3), PRIORS, 5, 0.5, system=system)
    assert problem.state(problem.start).solution.system is system
    assert problem.system is None
    other = Problem(shell, table(rows=3), PRIORS, 5, 0.5, system=system)
    assert other.state(1.01 * other.start).solution.system is not system


def test_seconds_of_pairing_are_those_by_frequency_and_those_of_following(monkeypatch):
    problem = Problem(blade(), table(rows=3), PRIORS, 5, 0.5)
    clock = SimpleNamespace(perf_counter=count().__next__)  # a second passes between any two looks
    monkeypatch.setattr("casingfem.updating.problem.time", clock)
    problem.state(problem.start)
    assert problem.seconds["pairing"] == 1.0
    problem.jac(problem.start)  # the point is where modes are followed from now
    problem.state(problem.start * [1.02, 1.0])
    assert problem.seconds["pairing"] == 3.0
    assert problem.seconds["sensitivities"] == 1.0
