"""Splits of many casings at once: right to third order in the imperfections, as full solutions have them."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.modal.test_mistuning import SPECTRUM, lab, tube

COUNT = 8
WALL = cf.field.RandomField(spectrum=SPECTRUM, seed=5, stream=1)
CASING = tube(radius_defect=lab(1.0), thickness_defect=WALL)


@pytest.fixture(scope="module")
def pairs():
    return cf.modal.SplitMap.of(CASING, COUNT)


def scaled(fields, factor):
    return {
        name: cf.FourierField(p=each.p, cos=factor * each.cos, sin=factor * each.sin) for name, each in fields.items()
    }


@pytest.mark.slow
def test_frequencies_of_pairs_are_right_to_third_order_in_the_imperfections(pairs):
    """Half the imperfection, a sixteenth of the error."""
    fields = {"radius": lab(1.0).redrawn(3).fit, "thickness": WALL.redrawn(3).fit}
    errors = []
    for factor in (1.0, 0.5):
        casing = scaled(fields, factor)
        found = pairs.splits(pairs.series([casing]))
        full = cf.modes(
            tube(radius_defect=casing["radius"], thickness_defect=casing["thickness"]), COUNT, method="shell"
        )
        of_pair = {(int(full.nodal_diameters[a]), int(full.meridional[a])): full.freq[[a, b]] for a, b in full.doublets}
        exact = np.array([of_pair[n, m] for n, m in zip(pairs.n.tolist(), pairs.rank.tolist(), strict=True)])
        half = 0.5 * found.split[0]
        ours = found.freq[0][:, None] * (1.0 + np.array([-1.0, 1.0]) * half[:, None])
        errors.append(np.abs(ours / exact - 1.0).max())
    assert errors[0] < 2e-3
    assert errors[0] / errors[1] > 10.0


@pytest.mark.slow
def test_splits_and_orientations_are_those_of_full_solutions(pairs):
    draws = (1, 2)
    fields = [{"radius": lab(0.2).redrawn(k), "thickness": WALL.redrawn(k)} for k in draws]
    found = pairs.splits(pairs.series(fields))
    for k, each in enumerate(fields):
        full = cf.modes(tube(radius_defect=each["radius"], thickness_defect=each["thickness"]), COUNT, method="shell")
        for (low, _), split in zip(full.doublets, full.splits, strict=True):
            j = np.flatnonzero((pairs.n == full.nodal_diameters[low]) & (pairs.rank == full.meridional[low]))[0]
            period = 180.0 / pairs.n[j]
            turned = (found.angle_deg[k, j] - full.angle_deg[low] + 0.5 * period) % period - 0.5 * period
            assert found.split[k, j] == pytest.approx(split, rel=0.02, abs=2e-6)
            assert abs(turned) < 0.02 * period


def test_a_casing_depends_on_its_own_series_alone(pairs):
    series = pairs.series([{"radius": lab(0.4).redrawn(k), "thickness": WALL.redrawn(k)} for k in range(5)])
    together, alone = pairs.splits(series), pairs.splits(series[3:4])
    assert np.allclose(together.split[3], alone.split[0], rtol=1e-9)


def test_casings_that_are_no_family_have_no_map():
    along = cf.FourierField(p=np.array([3]), cos=np.array([[1e-3, 1e-3]]), sin=np.zeros((1, 2)))
    assert cf.modal.SplitMap.of(tube(radius_defect=along), COUNT) is None
