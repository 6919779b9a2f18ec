"""Cylinders between shear diaphragms against 3-D elasticity (data/reference/cyl_shear_diaphragm_exact.csv)."""

import numpy as np
import pytest

from casingfem.linalg.eigen import solve_modes
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.assembly import assemble
from reports.verification.cylinder import FIXED, cylinder, errors
from reports.verification.cylinder_exact import anew, elasticity, gaps, shear_shell


@pytest.fixture(scope="module")
def thin(reference):
    """Errors of the 390 rows with h/R <= .02 on the report's one fixed mesh."""
    table = reference("cyl_shear_diaphragm_exact.csv")
    return errors(table[table.h_over_R <= 0.02])


@pytest.mark.slow
def test_one_mesh_serves_the_table(thin):
    """384 of 390 rows within .1 % of 3-D, all within .19 %: the rest are the shortest waves (h/R = .02, L/R = .5,
    m = 2), where first-order shear theory itself ends."""
    assert len(thin) == 390
    assert np.count_nonzero(thin.error.abs() < 1e-3) >= 380
    assert thin.error.abs().max() < 2e-3
    beyond = thin[thin.error.abs() >= 1e-3]
    assert set(beyond.h_over_R) == {0.02}
    assert set(beyond.L_over_R) == {0.5}
    assert set(beyond.m) == {2}


@pytest.mark.slow
def test_thinner_is_closer(thin):
    worst = thin.error.abs().groupby(thin.h_over_R).max()
    assert worst[0.005] < 3e-4
    assert worst[0.005] < worst[0.01] < worst[0.02]


@pytest.mark.slow
def test_shear_deformable_theory_is_closer_than_fluegge_where_waves_are_short(thin):
    short = thin[(thin.h_over_R == 0.02) & (thin.L_over_R == 0.5) & (thin.m == 2)]
    assert np.all(short.error.abs() < 0.3 * short.fluegge.abs())


def test_refining_the_mesh_changes_nothing(reference):
    table = reference("cyl_shear_diaphragm_exact.csv")
    rows = table[(table.h_over_R == 0.01) & table.n.isin([2, 7, 12])]
    fine = ShellMesh(order=10, rows=6, around=1)
    np.testing.assert_allclose(errors(rows, fine).error, errors(rows).error, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("h", "length", "n"), [(0.01, 0.5, 5), (0.005, 1.0, 6), (0.02, 2.0, 3), (0.02, 5.0, 2)])
def test_two_dimensional_shell_meets_sampled_rows(reference, h, length, n):
    table = reference("cyl_shear_diaphragm_exact.csv")
    row = table[(table.h_over_R == h) & (table.L_over_R == length) & (table.n == n) & (table.m == 1)].iloc[0]
    system = assemble(cylinder(h, length, ShellMesh(order=8, rows=1, around=9)))
    found = np.sqrt(np.maximum(solve_modes(system.K, system.mass, 24, shift=-1e-4).eigenvalues, 0.0))
    near = np.sort(np.abs(found / row.omega_3d - 1))
    assert near[1] < 1e-3  # both members of the pair
    assert FIXED.order == 8


def test_the_table_is_computed_anew(reference):
    table = reference("cyl_shear_diaphragm_exact.csv").iloc[::13]
    np.testing.assert_allclose(anew(table), table.omega_3d, rtol=2e-5)
    assert elasticity(0.1, 0.5, 12, 2, degree=12) == pytest.approx(elasticity(0.1, 0.5, 12, 2), rel=2e-7)


@pytest.mark.parametrize(("h", "length", "n"), [(0.1, 20.0, 4), (0.1, 0.5, 12), (0.02, 0.5, 0), (0.05, 2.0, 8)])
def test_the_mesh_solves_the_shell_s_own_theory(reference, h, length, n):
    """Two waves each, of which the lower at h/R .1, L/R 20, n = 4 has a neighbour nearer to 3-D than itself."""
    table = reference("cyl_shear_diaphragm_exact.csv")
    rows = table[(table.h_over_R == h) & (table.L_over_R == length) & (table.n == n)]
    found = errors(rows).omega
    np.testing.assert_allclose(found, [shear_shell(h, length, n, m, metric=False) for m in rows.m], rtol=3e-5)


def test_the_metric_through_the_wall_is_what_long_waves_miss():
    for h in (0.02, 0.05, 0.1):
        without, kept = gaps(h, 20.0, 2, 1)
        assert abs(kept) < 0.8 * abs(without)
    assert abs(gaps(0.1, 0.5, 12, 2)[1]) > 0.7 * abs(gaps(0.1, 0.5, 12, 2)[0])  # short waves: it is the shear
