"""A casing of ten given motions with six bolts: what an answer says, and what is asked for by default."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import t

import casingfem as cf
from casingfem.locate.located import Explanation, Found
from casingfem.locate.misfit import Misfit
from casingfem.locate.shape_check import unlike
from casingfem.modal.affine import AffineModel
from casingfem.modal.harmonics import Rings

SQUARE = (2.0 * np.pi) ** 2
FREQ, ORDERS = np.repeat([100.0, 135.0, 172.0, 222.0, 300.0], 2), np.repeat([2, 3, 4, 5, 7], 2)
ANGLES = 0.15 + 2.0 * np.pi * np.arange(6) / 6.0
SHIFT = SQUARE * 30.0**2


class Nominal(SimpleNamespace):
    def __len__(self):
        return len(FREQ)


@pytest.fixture(scope="module")
def shell():
    return cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=0.3), thickness=5e-3, supports={"base": cf.Bolts(count=6, k=2e8)},
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0), mesh=cf.ShellMesh(order=4, rows=1, around=6),
    )  # fmt: skip


@pytest.fixture(scope="module")
def model(shell):
    """A bolt of stiffness k at theta adds k v v^T, v = (cos n theta, sin n theta)."""
    pushes = np.array([[np.cos(n * a) if k % 2 == 0 else np.sin(n * a) for k, n in enumerate(ORDERS)] for a in ANGLES])
    amplitudes = np.zeros((8, 2, 3, 10), dtype=complex)
    for k, n in enumerate(ORDERS):
        amplitudes[n, :, 0, k] = np.array([1.0, 0.4]) * (1.0 if k % 2 == 0 else -1j)
    return AffineModel(
        system=SimpleNamespace(shell=shell), nominal=Nominal(rigid=0), motions=np.eye(10),
        K=np.diag(SQUARE * FREQ**2 + SHIFT), M=np.eye(10), shift=SHIFT,
        stiffness=2e4 * np.einsum("ci,cj->cij", pushes, pushes), mass=None,
        rings=Rings(amplitudes, np.array([0.3, 0.7])),
    )  # fmt: skip


def table_of(model, x, rows=8, sigma=1e-4):
    found = model.modes(np.asarray(x, dtype=float), 10)
    return cf.FrequencyTable.from_arrays(
        freq_hz=found.freq[:rows], sigma_hz=sigma * found.freq[:rows], n=found.nodal_diameters[:rows],
        angle_deg=found.angle_deg[:rows],
    )  # fmt: skip


LOOSE = [0.0, -0.6, 0.0, 0.0, 0.0, 0.0]


@pytest.fixture(scope="module")
def table(model):
    return table_of(model, LOOSE)


@pytest.fixture(scope="module")
def found(shell, model, table):
    return cf.locate(shell, table, model=(model, ANGLES))


def test_a_loose_bolt_is_found_with_what_is_left_of_it_or_half_a_turn_away(found):
    """Round-off chooses which of the two is named first."""
    (bolt,), (other,) = sorted((e.found for e in (found.best, *found.others)), key=lambda on: on[0].place)
    for one, place in ((bolt, 2), (other, 5)):
        assert (one.place, one.value) == (place, pytest.approx(0.4, abs=1e-5))
        assert one.angle_deg == pytest.approx(np.degrees(0.15) + 60.0 * (place - 1))
    assert found.others[0].behind == pytest.approx(0.0, abs=1e-6)
    assert found.chi2 == pytest.approx(0.0, abs=1e-6)
    assert (found.among, found.calibrated, found.unpaired, found.baseline_unpaired) == ("bolts", False, (), ())
    np.testing.assert_allclose(found.angles_deg, np.degrees(ANGLES), rtol=1e-14)


@pytest.mark.parametrize(("more", "level", "sigma", "error"), [
    ({}, 0.01, 0.01, 0.0), ({"level": 0.2, "angle_sigma": 0.05, "model_error": 1e-4}, 0.2, 0.05, 1e-4),
])  # fmt: skip
def test_what_is_seen_of_a_bolt_follows_from_slopes_of_the_tight_casing(shell, model, table, more, level, sigma, error):
    """Nine modes of ten are compared: 10/2.2 and four more."""
    answer = cf.locate(shell, table, model=(model, ANGLES), **more)
    start = Misfit(model=model, table=table, count=9, angle_sigma=sigma, model_error=error).at(np.zeros(6))
    assert answer.misfit.count == 9
    assert answer.rows == len(start.values)
    assert answer.scale == 1.0
    assert answer.chi2_start == pytest.approx(start.chi2, rel=1e-12)
    needed = t.isf(0.5 * level / 6, len(start.values) - 1)
    np.testing.assert_allclose(answer.smallest, needed / np.linalg.norm(start.jacobian, axis=0), rtol=1e-9)


def test_residuals_beyond_their_sigma_are_scaled_by_rows_less_one_for_each_bolt(shell, model, table):
    rough = replace(table, freq_hz=table.freq_hz * (1.0 + 3e-4 * np.array([1, -1, -1, 1, 1, 1, -1, -1])))
    answer = cf.locate(shell, rough, model=(model, ANGLES), most=1)
    assert len(answer.found) == 1
    assert answer.scale > 1.0
    assert answer.scale == pytest.approx(np.sqrt(answer.chi2 / (answer.rows - len(answer.found))), rel=1e-12)


@pytest.mark.parametrize("most", [0, 1])
def test_no_more_bolts_are_found_than_asked_for(shell, model, most):
    two = table_of(model, [-0.5, 0.0, -0.7, 0.0, 0.0, 0.0])
    assert len(cf.locate(shell, two, model=(model, ANGLES), most=most).found) == most


@pytest.mark.parametrize(("loss", "told"), [(0.101, True), (0.099, False)])
def test_a_bolt_that_has_lost_less_than_a_tenth_is_as_it_comes(shell, model, loss, told):
    answer = cf.locate(shell, table_of(model, [0.0, 0.0, -loss, 0.0, 0.0, 0.0]), model=(model, ANGLES))
    assert [one.place % 3 for one in answer.found] == ([0] if told else [])  # 3, or half a turn away 6


def with_far_row(table):
    """A row of n = 6 at 900 Hz, where no mode is."""
    return cf.FrequencyTable.from_arrays(
        freq_hz=[*table.freq_hz, 900.0], sigma_hz=[*table.sigma_hz, 0.1], n=[*table.n, 6],
        angle_deg=[*table.angle_deg, np.nan],
    )  # fmt: skip


@pytest.mark.slow
def test_a_row_that_pairs_with_nothing_is_named_and_left_out(shell, model, table, found):
    answer = cf.locate(shell, with_far_row(table), model=(model, ANGLES))
    assert answer.unpaired == (9,)
    assert answer.best == found.best
    assert (answer.rows, answer.chi2_start) == (found.rows, found.chi2_start)


def test_what_was_asked_for_holds_without_the_rows_that_pair_with_nothing(shell, model, table):
    asked = {"most": 1, "level": 0.2, "angle_sigma": 0.05, "model_error": 1e-4, "model": (model, ANGLES)}
    whole, less = (cf.locate(shell, rows, **asked) for rows in (table, with_far_row(table)))
    assert whole.to_json() | {"unpaired": [9]} == less.to_json()


def test_a_baseline_takes_out_what_manufacture_split(shell, model):
    """Its rows that pair with nothing are named too."""
    made = replace(model, K=model.K + SQUARE * np.diag([40.0, -30.0, 0.0, 90.0, -80.0, 60.0, 50.0, -90.0, 0.0, 0.0]))
    before, after = table_of(made, np.zeros(6)), table_of(made, LOOSE)
    answer = cf.locate(shell, after, baseline=with_far_row(before), model=(model, ANGLES))
    assert answer.calibrated
    assert (answer.unpaired, answer.baseline_unpaired) == ((), (9,))
    assert {*answer.best.places} | {place for e in answer.others for place in e.places} == {2, 5}
    assert answer.found[0].value == pytest.approx(0.4, abs=0.02)
    assert np.all(answer.misfit.table.sigma_hz > np.sqrt(2.0) * after.sigma_hz * (1.0 - 1e-3))


def test_shapes_are_unlike_by_the_mean_of_one_less_mac(model):
    """Bolts 2 and 5, half a turn apart, have one table: mode pairs with mode. All of eight shapes and six more."""
    rows = np.random.default_rng(8).standard_normal((15, 10))
    true = model.modes(np.array(LOOSE), 10)
    numbers = {"points": np.zeros((15, 3)), "directions": np.tile([1.0, 0.0, 0.0], (15, 1))}
    seen = rows @ true.coordinates[:, :8] * np.array([1, -2, 3, -4, 5, -6, 7, -8])
    shapes = cf.correlation.MeasuredShapes.from_arrays(freq_hz=true.freq[:8], values=seen, **numbers)

    def left(place):
        found = (Found(place=place, angle_deg=0.0, value=0.4, sigma=0.1),)
        return unlike(model, Explanation(found=found, behind=0.0), rows, shapes, 0.002)

    other = rows @ model.modes(np.roll(LOOSE, 3), 10).coordinates[:, :8]
    mac = np.sum(seen * other, axis=0) ** 2 / np.sum(seen**2, axis=0) / np.sum(other**2, axis=0)
    assert left(2) == pytest.approx(0.0, abs=1e-12)
    assert left(5) == pytest.approx(1.0 - np.mean(mac), rel=1e-6)
    assert left(5) > 1e-4
    far = cf.correlation.MeasuredShapes.from_arrays(freq_hz=3.0 * true.freq[:8], values=seen, **numbers)
    with pytest.raises(cf.errors.InputError, match=r"one within 0\.002 of a mode's frequency and like it"):
        unlike(model, Explanation(found=(), behind=0.0), rows, far, 0.002)
