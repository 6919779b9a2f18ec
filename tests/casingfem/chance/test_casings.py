"""Bases of drawn casings, from one perfect casing, against reductions of the casings themselves."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.chance.casings import Casings
from casingfem.chance.replaced import in_full, replaced
from contact import ModalBody
from tests.casingfem.modal.test_mistuning import SPECTRUM, lab, tube

RIM = cf.Rim("top", n_max=8)
MODES = 8


@pytest.fixture(scope="module")
def casings():
    wall = cf.field.RandomField(spectrum=SPECTRUM, seed=5, stream=1)
    mesh = cf.ShellMesh(order=7, rows=1, around=13)
    return Casings.of(tube(radius_defect=lab(0.2), thickness_defect=wall, mesh=mesh), RIM, MODES, 0.002)


def compliance(body, hz=0.0):
    """Motion of the rim per force [m/N], below resonance."""
    return (body.rows / (body.omega**2 - (2.0 * np.pi * hz) ** 2)) @ body.rows.T + body.S


@pytest.mark.slow
def test_a_casing_without_imperfections_has_the_perfect_basis(casings):
    (found,), perfect = casings.bodies(0.0 * casings.random.fixed[None]), casings.perfect
    assert found.omega == pytest.approx(perfect.omega, rel=1e-5)
    assert np.allclose(compliance(found), compliance(perfect), atol=1e-5 * np.abs(compliance(perfect)).max())


@pytest.mark.slow
def test_the_ratio_of_a_mode_is_that_of_the_pair_with_its_nodal_diameters(casings):
    """A pair of n waves is raised by n per cent."""
    bare = replace(casings.shell, radius_defect=None, thickness_defect=None)
    n = cf.modes(bare, MODES).nodal_diameters
    raised = casings.pairs.freq * (1.0 + 0.01 * casings.pairs.n)
    found = casings.ratios(np.stack([raised, casings.pairs.freq]))
    np.testing.assert_allclose(found[0], np.where(np.isin(n, casings.pairs.n), 1.0 + 0.01 * n, 1.0), rtol=1e-12)
    np.testing.assert_array_equal(found[1], 1.0)
    assert np.ptp(found[0]) > 0.01


@pytest.mark.slow
def test_the_basis_of_a_drawn_casing_is_that_of_its_own_reduction(casings):
    series = casings.random.series(cf.chance.points(3, range(16), casings.random.dimension))[5]
    top = series.shape[1] // 2
    fields = {
        f"{name}_defect": cf.FourierField(
            p=np.arange(1, top + 1), cos=2.0 * line[top + 1 :, None].real, sin=-2.0 * line[top + 1 :, None].imag
        )
        for name, line in zip(casings.random.quantities, series, strict=True)
    }
    full = ModalBody.of(cf.reduce(replace(casings.shell, **fields), RIM, modes=MODES, zeta=0.002))
    (found,) = casings.bodies(series[None])
    assert found.omega == pytest.approx(full.omega, rel=2e-4)
    near = 0.9 * full.omega[0] / (2.0 * np.pi)  # where the lowest modes and their orientation matter
    exact = compliance(full, near)
    off, perfect = (np.abs(compliance(body, near) - exact).max() for body in (found, casings.perfect))
    assert off < 0.05 * np.abs(exact).max()
    assert off < 0.5 * perfect  # other waves in the modes' motion at the rim are left out
    d = casings.deviation(series[None])[0, : RIM.n_max + 1]
    assert np.allclose(full.out_of_roundness[0, : RIM.n_max + 1], d.real, atol=1e-7)
    assert np.allclose(full.out_of_roundness[0, RIM.n_max + 1 :], -d.imag[1:], atol=1e-7)


@pytest.mark.slow
def test_a_draw_with_large_terms_of_third_order_is_solved_anew(casings):
    small = casings.random.series(cf.chance.points(3, range(2), casings.random.dimension))
    series = small * np.array([1.0, 8.0])[:, None, None]
    pairs = casings.pairs.splits(series)
    found = replaced(casings, series, pairs)
    assert found.by[0] == 0
    assert found.by[1] > 0
    assert np.array_equal(found.pairs.split[0], pairs.split[0])
    full = in_full(casings, series[1])
    known = {(int(full.nodal_diameters[low]), int(full.meridional[low])): low for low, _ in full.doublets}
    for k, name in enumerate(zip(casings.pairs.n.tolist(), casings.pairs.rank.tolist(), strict=True)):
        if name in known and found.pairs.share[1, k] > 0.7:
            lower = found.pairs.freq[1, k] * (1.0 - 0.5 * found.pairs.split[1, k])
            assert lower == pytest.approx(full.freq[known[name]], rel=2e-3)
