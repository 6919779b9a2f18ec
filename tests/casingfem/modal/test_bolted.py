"""Modes of bolted casings by coupled harmonics: the two-dimensional shell, turned bolts, bands, refused input."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BOLTS = cf.Bolts(count=8, k=1e8, k_rot=1e3, width=0.6)
LOOSE = replace(BOLTS, loose={2: 0.0, 5: 0.3})
RING = cf.Ring(section=cf.edge.Section.rectangle(width=0.02, depth=0.01), support=LOOSE)
ROWS = (0.0, 0.06, 0.94, 1.0)


def casing(base, mesh=None, **parts):
    return cf.Shell(
        chart=cf.Cylinder(radius=0.3, height=0.15),
        thickness=4e-3,
        material=STEEL,
        supports={"base": base, **parts.pop("supports", {})},
        mesh=mesh,
        **parts,
    )


def by_harmonics(base, count=8, **parts):
    return cf.modes(casing(base, **parts), count, method="bolts")


@pytest.mark.parametrize(
    ("base", "around", "orders"), [(LOOSE, 24, (4, 7)), pytest.param(RING, 8, (6, 9), marks=pytest.mark.campaign)]
)
def test_the_two_dimensional_shell_converges_to_the_coupled_harmonics(base, around, orders):
    def error(order):
        mesh = cf.ShellMesh(order=order, rows=ROWS, around=around)
        found, exact = (cf.modes(casing(base, mesh), 8, method=method) for method in ("shell", "bolts"))
        np.testing.assert_array_equal(found.nodal_diameters, exact.nodal_diameters)
        a, b = (part.fields[:, :3].reshape(-1, 8) for part in (found, exact))
        np.testing.assert_allclose(np.abs(np.sum(a * b, axis=0)), np.sum(a * a, axis=0), rtol=0.02)
        return np.abs(found.freq / exact.freq - 1.0).max()

    coarse, fine = map(error, orders)
    assert fine < 2e-4
    assert fine < 0.3 * coarse


def test_turning_the_bolts_by_any_angle_changes_no_frequency():
    np.testing.assert_allclose(
        by_harmonics(replace(LOOSE, first_angle=2.1234)).freq, by_harmonics(LOOSE).freq, rtol=1e-8
    )


def test_equal_bolts_split_only_what_their_number_allows():
    """N divides 2n for n = 4, 8, ... of 8 bolts; every other pair stays double."""
    found = by_harmonics(BOLTS, 14)
    n = np.array([found.nodal_diameters[low] for low, _ in found.doublets])
    assert found.splits[2 * n % 8 != 0].max() < 1e-8
    assert found.splits[2 * n % 8 == 0].max() > 1e-4


def test_bolts_at_both_edges_are_both_felt():
    one, both = by_harmonics(BOLTS), by_harmonics(BOLTS, supports={"top": BOLTS})
    held = by_harmonics(BOLTS, supports={"top": cf.Clamped()})
    assert np.all(one.freq < both.freq)
    assert np.all(both.freq < held.freq)


def test_a_band_has_the_modes_of_a_count():
    counted = by_harmonics(LOOSE, 8)
    low, high = 0.5 * (counted.freq[1] + counted.freq[2]), 0.5 * (counted.freq[5] + counted.freq[6])
    found = cf.modes(casing(LOOSE), band=(low, high), method="bolts")
    np.testing.assert_allclose(found.freq, counted.freq[2:6], rtol=5e-5)
    assert found.sturm_count == 4


@pytest.mark.parametrize(
    ("base", "parts", "found"),
    [
        (cf.Clamped(), {}, "no bolts"),
        (BOLTS, {"radius_defect": cf.FourierField.of({3: 1e-3})}, "varies around apart from them"),
        (cf.Bolts(count=200, k=1e8, loose={1: 0.0}), {}, "patches of 0.6 degrees"),
    ],
)
def test_what_the_method_does_not_cover_is_refused(base, parts, found):
    with pytest.raises(cf.errors.ModelError, match=f"{found}.*modes-method"):
        cf.modes(casing(base, **parts), 4, method="bolts")
