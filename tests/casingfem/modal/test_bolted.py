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


@pytest.mark.parametrize("factor", [0.3, 2.5])
@pytest.mark.parametrize("ringed", [False, True])
def test_bolts_that_are_all_loose_are_softer_bolts(factor, ringed):
    loose = replace(BOLTS, loose=dict.fromkeys(range(1, 9), factor))
    softer = replace(BOLTS, k=factor * BOLTS.k, k_rot=factor * BOLTS.k_rot)
    a, b = (by_harmonics(replace(RING, support=bolts) if ringed else bolts, 12).freq for bolts in (loose, softer))
    np.testing.assert_allclose(a, b, rtol=2e-6)


def test_bolts_of_which_every_other_is_missing_are_half_as_many():
    every = cf.Bolts(count=16, k=(3e7, 1e8, 2e8), k_rot=1e3, width=0.3, loose=dict.fromkeys(range(2, 17, 2), 0.0))
    np.testing.assert_allclose(
        by_harmonics(every).freq, by_harmonics(replace(every, count=8, loose={})).freq, rtol=2e-6
    )


def test_a_bolt_that_is_loosened_lowers_every_frequency_and_a_stiffer_one_raises_it():
    soft, tight, stiff = (by_harmonics(replace(BOLTS, loose={3: factor})).freq for factor in (0.5, 1.0, 2.0))
    assert np.all(soft < tight)
    assert np.all(tight < stiff)


def test_loose_bolts_at_both_edges_are_those_of_the_casing_turned_over():
    def ends(base, top):
        return by_harmonics(base, supports={"top": top}).freq

    softest = replace(BOLTS, k_rot=0.0, loose={7: 0.1})
    np.testing.assert_allclose(ends(LOOSE, softest), ends(softest, LOOSE), rtol=1e-6)


def test_bolted_casings_are_computed_by_harmonics_unless_something_else_varies_around():
    coarse = cf.ShellMesh(order=4, rows=1, around=8)
    found = cf.modes(casing(LOOSE, coarse), 4)
    assert found.by_harmonics
    np.testing.assert_array_equal(found.freq, cf.modes(casing(LOOSE, coarse), 4, method="bolts").freq)
    assert not cf.modes(casing(LOOSE, coarse), 4, method="shell").by_harmonics
    assert not cf.modes(casing(LOOSE, coarse, radius_defect=cf.FourierField.of({3: 1e-3})), 4).by_harmonics


@pytest.mark.parametrize("count", [8, 24])
def test_the_default_mesh_agrees_with_the_coupled_harmonics(count):
    chart = cf.Frustum(r_base=0.5, r_top=0.45, height=0.25)
    bolts = cf.Bolts(count=count, k=2e8, k_rot=1e3, loose={2: 0.3})
    shell = cf.Shell(chart=chart, thickness=3e-3, material=STEEL, supports={"base": bolts})
    mesh, exact = (cf.modes(shell, 12, method=method).freq for method in ("shell", "bolts"))
    np.testing.assert_allclose(mesh, exact, rtol=3e-4)


def test_energies_are_not_taken_from_shapes_of_coupled_harmonics():
    found = cf.modes(casing(BOLTS), 4)
    vary = [cf.Parameter(name="support.base.k", lower=1e7, upper=1e9)]
    with pytest.raises(cf.errors.ModelError, match=r'two-dimensional model.*method="shell".*modes-harmonics'):
        cf.updating.eigen_derivatives(found, vary)
    with pytest.raises(cf.errors.ModelError, match="modes-harmonics"):
        cf.rig.rig_of(found, [cf.rig.Place(at=(0.1, 0.0))], zeta=0.002)


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
        (cf.Bolts(count=60, k=1e8, spacing=0.1), {}, "patches of 1.91 degrees, not evenly around"),
        (cf.Bolts(count=60, k=1e8, loose=dict.fromkeys(range(1, 26), 0.0)), {}, "25 loose bolts, expected at most 24"),
    ],
)
def test_what_the_method_does_not_cover_is_refused(base, parts, found):
    with pytest.raises(cf.errors.ModelError, match=f"{found}.*modes-method"):
        cf.modes(casing(base, **parts), 4, method="bolts")
