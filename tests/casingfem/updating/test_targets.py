"""Residuals of singles and doublets, and their Jacobians against finite differences."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import casingfem as cf
from casingfem.experiment.correlation.pairing import pair
from casingfem.modal.neighbour import solved
from casingfem.updating.targets import jacobian, lower_angle, pair_state, rates, split_vector, values

MESH = cf.ShellMesh(order=6, rows=1, around=13)
COUNT = 40


def table_of(found, rows, angles=True):
    return cf.FrequencyTable.from_arrays(
        freq_hz=1.01 * found.freq[:rows],
        sigma_hz=0.001 * found.freq[:rows],
        n=found.nodal_diameters[:rows],
        angle_deg=found.angle_deg[:rows] if angles else np.nan,
    )


def evaluate(shell, table, vary=()):
    """Residuals and their derivatives, rows in the order of the table."""
    return judged(solved(shell, COUNT), table, vary)


def judged(solution, table, vary=()):
    """The same of a solution."""
    matches = sorted(pair(solution.modes, table).matches, key=lambda match: match.rows)
    residual = values(solution.modes, table, matches)
    if not vary:
        return residual, None
    return residual, jacobian(solution.modes, table, matches, rates(solution.modes, solution, vary, table, matches))


@pytest.mark.slow
@given(st.floats(10.0, 1e4), st.floats(0.0, 0.3))
def test_mean_and_split_give_the_pair_back(f1, split):
    f2 = f1 * (1 + split)
    mean, difference = pair_state(f1, f2)
    assert mean**2 - mean * difference == pytest.approx(f1**2, rel=1e-9)
    assert mean**2 + mean * difference == pytest.approx(f2**2, rel=1e-9)


def test_split_vector_lies_in_the_plane_of_its_phase():
    np.testing.assert_allclose(split_vector(2.0, 0.0), [2, 0], atol=1e-15)
    np.testing.assert_allclose(split_vector(2.0, np.pi / 2), [0, 2], atol=1e-15)
    np.testing.assert_allclose(split_vector(2.0, np.pi), [-2, 0], atol=1e-15)


def test_angle_of_the_lower_member_from_either():
    assert lower_angle(np.array([10.0, np.nan]), 4) == 10.0
    assert lower_angle(np.array([np.nan, 32.5]), 4) == 10.0
    assert np.isnan(lower_angle(np.array([np.nan, np.nan]), 4))


@pytest.fixture(scope="module")
def casing(frustum):
    return frustum(radius_defect=cf.FourierField.of({8: (0.002, 0.001), 3: (0.001, 0.001)}), mesh=MESH)


@pytest.fixture(scope="module")
def middle(casing):
    """The casing's solution, and that of another, which is the measured one."""
    other = cf.updating.with_value(cf.updating.with_value(casing, "radius.p8.cos", 0.0017), "material.E", 200e9)
    return solved(casing, COUNT), cf.modes(other, 12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["material.E", "shell.thickness", "radius.p8.cos", "radius.p8.sin", "radius.p16.cos", "thickness.p8.sin"],
)
def test_doublet_jacobian_equals_finite_differences(casing, middle, name):
    """Turning included: what the computed modes leave of it, 2 %, the adjoints add. Angles measured, or none."""
    here, other = middle
    p = cf.Parameter(name=name, lower=-1e15, upper=1e15)
    x = cf.updating.get_value(casing, name)
    h = 1e-4 * abs(x) or 1e-7
    beside = [solved(cf.updating.with_value(casing, name, x + s), COUNT) for s in (h, -h)]
    for angles in (True, False):
        table = table_of(other, 12, angles)
        exact = judged(here, table, [p])[1][:, 0]
        plus, minus = (judged(solution, table)[0] for solution in beside)
        numeric = (plus - minus) / (2 * h)
        assert len(exact) == (18 if angles else 12)
        assert np.abs(exact - numeric).max() < 1e-6 * np.abs(numeric).max()


@pytest.mark.slow
def test_residuals_are_weighted_by_their_sigma(casing):
    """Its own frequencies times 1.01: means off by ten sigma of a mean, splits by next to nothing."""
    found = cf.modes(casing, COUNT)
    residual, _ = evaluate(casing, table_of(cf.modes(casing, 12), 12, angles=False))
    means = residual[0::2]
    np.testing.assert_allclose(means, -10.0 * np.sqrt(2), rtol=1e-2)
    assert np.abs(residual[1::2]).max() < 0.3
    assert len(found) == COUNT


@pytest.mark.slow
def test_split_vector_jacobian_at_a_perfect_start(frustum):
    """No split, no angle: the vector is still linear in cos and sin of 2 n theta, through zero."""
    shell = frustum(mesh=cf.ShellMesh(order=6, rows=1, around=17), radius_defect=cf.FourierField.of({8: (0.0, 0.0)}))
    split = frustum(mesh=shell.mesh, radius_defect=cf.FourierField.of({8: (0.0006, 0.0008)}))
    measured = cf.modes(split, 24)
    four = np.flatnonzero(measured.nodal_diameters == 4)[:2]
    table = cf.FrequencyTable.from_arrays(
        freq_hz=measured.freq[four], sigma_hz=1.0, n=4, angle_deg=measured.angle_deg[four]
    )
    vary = [cf.Parameter(name=f"radius.p8.{part}", lower=-1, upper=1) for part in ("cos", "sin")]
    _, start = evaluate(shell, table, vary)
    h = 1e-6
    for k, p in enumerate(vary):
        plus, minus = (evaluate(cf.updating.with_value(shell, p.name, s), table)[0] for s in (h, -h))
        numeric = (plus - minus) / (2 * h)
        assert np.abs(start[1:, k] - numeric[1:]).max() < 1e-6 * np.abs(numeric[1:]).max()
    np.testing.assert_allclose(start[1:, 0] @ start[1:, 1], 0.0, atol=1e-9 * np.sum(start**2))


def test_open_shells_have_single_residuals(steel):
    plate = cf.Shell(
        chart=cf.Plate(length=0.4, width=0.2), thickness=3e-3, material=steel, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=1, around=1),
    )  # fmt: skip
    table = cf.FrequencyTable.from_arrays(
        freq_hz=cf.modes(plate, 6).freq[:4] * 1.01, sigma_hz=cf.modes(plate, 6).freq[:4] * 0.001
    )
    residual, slope = evaluate(plate, table, [cf.Parameter(name="material.E", lower=1.0, upper=1e15)])
    np.testing.assert_allclose(residual, -10.0, rtol=1e-9)
    np.testing.assert_allclose(slope[:, 0], 1000.0 / (2 * 210e9), rtol=1e-9)


@pytest.mark.slow
def test_half_a_doublet_is_a_single(casing):
    found = cf.modes(casing, COUNT)
    residual, _ = evaluate(casing, table_of(found, 12).without(2))
    assert len(residual) == 1 + 5 * 3


@pytest.mark.slow
def test_slopes_of_a_small_casing_equal_differences(frustum):
    """A pair of n = 4 with an angle, turned by all other modes too, and a single row."""
    shell = frustum(
        thickness=2e-2,
        mesh=cf.ShellMesh(order=4, rows=1, around=7),
        radius_defect=cf.FourierField.of({8: (4e-3, 2e-3), 3: 2e-3}),
    )
    names = ("radius.p8.sin", "material.E")
    vary = [cf.Parameter(name=name, lower=-1e15, upper=1e15) for name in names]
    here = solved(shell, 10)
    low, high = next(pair for pair in here.modes.doublets if here.modes.nodal_diameters[pair[0]] == 4)
    rows = [low, high, 5]
    table = cf.FrequencyTable.from_arrays(
        freq_hz=here.modes.freq[rows] * [1.0, 1.001, 1.002], sigma_hz=0.1, n=here.modes.nodal_diameters[rows],
        angle_deg=[here.modes.angle_deg[low] + 3.0, np.nan, np.nan],
    )  # fmt: skip
    exact = judged(here, table, vary)[1]
    assert exact.shape == (4, 2)
    for k, name in enumerate(names):
        x = cf.updating.get_value(shell, name)
        ends = [judged(solved(cf.updating.with_value(shell, name, x * by), 10), table)[0] for by in (1.0001, 0.9999)]
        slope = (ends[0] - ends[1]) / (2e-4 * x)
        np.testing.assert_allclose(exact[:, k], slope, atol=1e-4 * np.abs(slope).max())
