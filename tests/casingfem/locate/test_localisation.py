"""Loose bolts and added masses found from splits: exact recovery, what cannot be told, bad input."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import f

import casingfem as cf
from casingfem.experiment.correlation.matches import Match
from casingfem.experiment.correlation.sensors import sensors_of
from casingfem.locate.explanations import bolts_explained, groups_alike, significant_masses
from casingfem.locate.localisation import search_model, with_baseline_noise
from casingfem.locate.located import Explanation, Found
from casingfem.locate.mass_places import Masses, at_places
from casingfem.locate.misfit import Misfit, Point, turning
from casingfem.locate.shape_check import checked_by_shapes, unlike
from casingfem.updating.calibration import calibrated, correction, paired_by_shares, turned_to
from tests.test_results import assert_whole

BOLTS = cf.Bolts(count=12, k=2e8, k_rot=1e5)
COARSE = cf.ShellMesh(order=5, rows=(0.0, 0.05, 1.0), around=12)


def measured(found, top, sigma=1e-4):
    """The modes below `top` as a test would give them, without noise."""
    below = np.flatnonzero(found.freq < top)
    angle = found.angle_deg[below].copy()
    for low, high in found.doublets:
        if high < len(below) and np.isnan(angle[low]):  # a perfect pair lies anywhere, its members apart
            angle[[low, high]] = 0.0, 90.0 / found.nodal_diameters[low]
    return cf.FrequencyTable.from_arrays(
        freq_hz=found.freq[below],
        sigma_hz=sigma * found.freq[below],
        n=found.nodal_diameters[below],
        angle_deg=angle,
    )


def on_ring(bolts):
    return {"base": cf.Ring(section=cf.edge.Section.rectangle(width=0.03, depth=0.03), support=bolts)}


def loosened(shell, loose):
    return replace(shell, supports=on_ring(replace(BOLTS, loose=loose)))


@pytest.fixture(scope="module")
def casing(frustum):
    return frustum(supports=on_ring(BOLTS), mesh=COARSE)


@pytest.fixture(scope="module")
def model(casing):
    return search_model(casing, measured(cf.modes(casing, 20, method="shell"), 470.0))


@pytest.fixture(scope="module")
def table_with(casing):
    """The table of the casing with some bolts loose; many tests ask for the same."""

    @cache
    def table(loose):
        return measured(cf.modes(loosened(casing, dict(loose)), 20, method="shell"), 470.0)

    return lambda loose: table(tuple(loose.items()))


@pytest.fixture(scope="module")
def noisy(casing, model, table_with):
    """A table off by three times its sigma, and what one loose bolt makes of it."""
    clean = table_with({3: 0.5})
    noise = 3.0 * clean.sigma_hz * np.random.default_rng(27).standard_normal(len(clean))
    table = replace(clean, freq_hz=clean.freq_hz + noise)
    return table, cf.locate(casing, table, model=model, most=1)


@pytest.mark.slow
@pytest.mark.parametrize("loose", [pytest.param({5: 0.3}, marks=pytest.mark.campaign), {2: 0.3, 6: 0.5}])
def test_loose_bolts_are_recovered_without_noise(casing, model, loose, tmp_path, table_with):
    found = cf.locate(casing, table_with(loose), model=model)
    turned = {(bolt + 5) % 12 + 1 for bolt in loose}
    explanations = (found.best, *found.others)
    assert {frozenset(loose), frozenset(turned)} == {e.places for e in explanations}
    told = next(e for e in explanations if e.places == frozenset(loose))
    assert {one.place: one.value for one in told.found} == pytest.approx(loose, abs=5e-3)
    assert found.chi2 < 1e-4 * found.chi2_start
    assert_whole(found, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("loose", [{2: 0.3, 8: 0.7}, {2: 0.5, 8: 0.5}])
def test_opposite_bolts_change_places_by_half_a_turn(casing, model, loose, table_with):
    """The turned explanation has the same bolts, and the other's factor for each; nothing new where both are alike."""
    misfit = Misfit(model=model[0], table=table_with(loose), count=20)
    x, on = np.zeros(12), [bolt - 1 for bolt in loose]
    x[on] = np.array(list(loose.values())) - 1.0
    explained = bolts_explained(misfit, on, misfit.at(x), model[1])
    told = [{one.place: round(one.value, 2) for one in e.found} for e in explained]
    turned = {2: loose[8], 8: loose[2]}
    assert loose in told
    assert turned in told
    assert len(told) == (1 if turned == loose else 2)


@pytest.mark.slow
def test_a_tight_casing_has_no_loose_bolt(casing, model, table_with):
    found = cf.locate(casing, table_with({}), model=model)
    assert found.found == ()
    np.testing.assert_allclose(found.angles_deg, 30.0 * np.arange(12), atol=1e-12)
    assert "no loose bolts found" in repr(found)


@pytest.mark.slow
def test_sigma_scale_and_smallest_are_what_chi_square_says(noisy, held):
    """Frequencies off by three times their sigma: chi^2 rises by scale^2 at one standard deviation, either way."""
    _, found = noisy
    (one,) = found.found
    told = sorted((e.place, e.value, e.sigma) for by in (found.best, *found.others) for e in by.found)
    held(1e-4, chi2=[found.chi2, found.chi2_start, found.scale, found.rows], smallest=found.smallest, told=told)
    assert found.scale == pytest.approx(np.sqrt(found.chi2 / (found.rows - 1)), rel=1e-12)
    assert 1.5 < found.scale < 4.5
    assert abs(one.value - 0.5) < 3.5 * one.sigma
    at = np.eye(12)[one.place - 1]
    best, step = one.value - 1.0, one.sigma
    for way in (-1.0, 1.0):
        risen = found.misfit.at((best + way * step) * at).chi2 - found.chi2
        assert risen == pytest.approx(found.scale**2, rel=0.2)
    start = found.misfit.at(np.zeros(12))
    seen = np.sum((start.jacobian * found.smallest) ** 2, axis=0) / found.scale**2
    np.testing.assert_allclose(seen, f.isf(0.01 / 12, 1, found.rows - 1), rtol=1e-9)


@pytest.mark.slow
def test_the_misfit_falls_as_its_derivatives_say(casing, model, table_with):
    """With all modes of the basis, from pairs split and turned by two loose bolts."""
    basis, table = model[0], table_with({3: 0.4, 4: 0.7})
    misfit = Misfit(model=basis, table=table, count=len(basis.K))
    at, step = np.zeros(12), 1e-4
    at[[1, 5]] = -0.7, -0.5
    there = misfit.at(at)
    for bolt in (1, 5, 8):
        move = step * np.eye(12)[bolt]
        up, down = misfit.at(at + move), misfit.at(at - move)
        slope = (up.values - down.values) / (2.0 * step)
        np.testing.assert_allclose(there.jacobian[:, bolt], slope, atol=1e-5 * np.abs(slope).max())


@pytest.mark.slow
def test_half_a_turn_is_the_same_table_and_is_said(casing, model, table_with):
    here, there = (table_with({bolt: 0.3}) for bolt in (3, 9))
    np.testing.assert_allclose(here.freq_hz, there.freq_hz, rtol=1e-9)
    found = cf.locate(casing, here, model=model)
    assert abs(found.others[0].behind) < 1e-2
    assert "half a turn changes no frequency and no orientation" in repr(found)
    assert found.alike == tuple((bolt, bolt + 6) for bolt in range(1, 7))


def without_angles(table):
    return replace(table, angle_deg=np.full(len(table), np.nan))


@pytest.mark.slow
@pytest.mark.parametrize("loose", [{5: 0.3}, {2: 0.3, 5: 0.6}])
def test_without_orientations_all_turns_and_mirror_images_are_listed(casing, model, loose, table_with):
    """One bolt or two, three steps apart in either sense: twelve and 24 places; one, with half a turn, was named."""
    misfit = Misfit(model=model[0], table=without_angles(table_with(loose)), count=20)
    x, on = np.zeros(12), [bolt - 1 for bolt in loose]
    x[on] = np.array(list(loose.values())) - 1.0
    explained = bolts_explained(misfit, on, misfit.at(x), model[1])
    turned = [
        {(start + way * (bolt - 5)) % 12 + 1: value for bolt, value in loose.items()}
        for start in range(12)
        for way in (1, -1)
    ]
    told = [{one.place: round(one.value, 3) for one in e.found} for e in explained]
    assert all(one in told for one in turned)
    assert len({frozenset(one.items()) for one in told}) == len(told)
    assert max(e.behind for e in explained) < 1.0


@pytest.mark.slow
def test_orientations_leave_but_half_a_turn(casing, model, table_with):
    misfit = Misfit(model=model[0], table=table_with({5: 0.3}), count=20)
    x = -0.7 * np.eye(12)[4]
    assert [e.places for e in bolts_explained(misfit, [4], misfit.at(x), model[1])] == [{5}, {11}]


@pytest.mark.slow
@pytest.mark.parametrize("left", [0.0, pytest.param(0.2, marks=pytest.mark.campaign)])
def test_no_bolt_loses_more_than_it_has_by_a_turn(casing, left, table_with):
    """Opposite a bolt that has lost most lies one with less, or none: stiffness below nothing ended in a traceback."""
    designed, table = loosened(casing, {9: left}), table_with({9: left, 3: 0.1})
    model, angles = search_model(designed, table)
    misfit = Misfit(model=model, table=table, count=20)
    x = -0.9 * np.eye(12)[2]
    assert [e.places for e in bolts_explained(misfit, [2], misfit.at(x), angles)] == [{3}]


@pytest.mark.slow
def test_without_orientations_equal_bolts_are_seen_alike(casing, model, table_with):
    """Of pairs and of one member alone: the axes of a perfect pair, which the solver chose, told bolts apart."""
    table = without_angles(table_with({}))
    for rows in (table, table.without(1)):
        start = Misfit(model=model[0], table=rows, count=20).at(np.zeros(12))
        assert groups_alike(start.jacobian) == (tuple(range(1, 13)),)
        np.testing.assert_allclose(np.ptp(np.linalg.norm(start.jacobian, axis=0)), 0.0, atol=1e-3)


@pytest.mark.slow
def test_the_slope_of_a_perfect_pair_without_orientation_is_of_its_length(casing, model, table_with):
    """One bolt, loosened a little: lengths of splits and a member alone move as the slope from that side says."""
    table, step = without_angles(table_with({})).without(1), -1e-4
    misfit = Misfit(model=model[0], table=table, count=len(model[0].K))
    start, there = (misfit.at(x) for x in (np.zeros(12), step * np.eye(12)[4]))
    slope = (there.values - start.values) / step
    np.testing.assert_allclose(start.jacobian[:, 4], slope, atol=1e-3 * np.abs(slope).max())


def test_a_mode_of_the_same_frequency_turns_no_other():
    """The first two of three lie anywhere; rows that pair with the first and the third gave rates of 1e10."""
    amplitudes = np.zeros((5, 1, 3, 3), complex)
    amplitudes[4, 0, 0] = 1.0, 1.0j, 1.0 + 1.0j
    freq = np.array([100.0, 100.0 + 1e-10, 120.0])
    found = SimpleNamespace(freq=freq, omega=2.0 * np.pi * freq)
    found.rings = SimpleNamespace(amplitudes=amplitudes, weights=np.ones(1))
    G = np.ones((1, 3, 3))
    assert turning(found, SimpleNamespace(n=4, modes=(0, 2)), G) == pytest.approx([0.0])


def test_places_with_parallel_effects_are_grouped_by_their_numbers_from_one():
    """The fifth has no effect, the fourth the opposite one of the second."""
    effects = [[1.0, 0.0], [0.0, 1.0], [2.0, 0.0], [0.0, -1.0], [0.0, 0.0], [0.0, 3.0]]
    assert groups_alike(np.transpose(effects)) == ((1, 3), (2, 6))


@pytest.mark.slow
def test_a_baseline_takes_manufacture_out(casing, model):
    """A radius harmonic splits n = 8 by far more than half a loose bolt splits anything."""
    made = replace(casing, radius_defect=cf.FourierField.of({16: 1e-4, 5: 2e-4}))
    before, now = (measured(cf.modes(loosened(made, loose), 20), 470.0) for loose in ({}, {3: 0.5}))
    known = cf.locate(casing, now, baseline=before, model=model, model_error=1e-4)
    assert {e.places for e in (known.best, *known.others)} == {frozenset({3}), frozenset({9})}
    assert known.found[0].value == pytest.approx(0.5, abs=0.05)
    assert known.scale < cf.locate(casing, now, model=model, model_error=1e-4).scale


@pytest.mark.slow
def test_a_calibrated_model_has_its_baseline(casing, model):
    made = replace(casing, thickness_defect=cf.FourierField.of({14: 0.01, 10: 0.008}))
    before = measured(cf.modes(made, 20), 470.0)
    found = calibrated(model[0], before).modes(np.zeros(12), 20)
    assert len(before) > 10
    np.testing.assert_allclose(found.freq[: len(before)], before.freq_hz, rtol=1e-9)
    turned = np.radians(found.angle_deg[: len(before)] - before.angle_deg) * before.n
    np.testing.assert_allclose(np.sin(turned), 0.0, atol=1e-6)


@pytest.mark.campaign
def test_masses_between_candidates_are_recovered(casing):
    added = [cf.edge.EdgeMass(angle=np.radians(angle), mass=mass) for angle, mass in ((20.0, 0.02), (111.0, 0.03))]
    heavy = replace(casing, masses={"top": added})
    found = cf.locate(casing, measured(cf.modes(heavy, 20, method="shell"), 470.0), among="mass")
    said = (found.best, *found.others)
    twins = [e for e in said if [round(one.angle_deg) for one in e.found] == [20, 111]]
    assert len(twins) == 1
    assert [one.value for one in twins[0].found] == pytest.approx([0.02, 0.03], rel=5e-3)
    assert "mass [g]" in repr(found)


@pytest.mark.slow
@pytest.mark.parametrize("edge", [None, "base"])
def test_a_mass_is_looked_for_at_the_top_unless_told(steel, edge):
    """A free cone 0.3 m wide at its base, 0.25 m at its top: what 20 g do at either edge differs."""
    mesh = cf.ShellMesh(order=5, rows=1, around=7)
    cone = cf.Shell(chart=cf.Frustum(r_base=0.3, r_top=0.25, height=0.05), thickness=4e-3, material=steel, mesh=mesh)
    heavy = replace(cone, masses={edge or "top": [cf.edge.EdgeMass(angle=np.radians(40.0), mass=0.02)]})
    found = cf.modes(heavy, 12, method="shell")
    elastic = slice(found.rigid, None)
    table = cf.FrequencyTable.from_arrays(
        freq_hz=found.freq[elastic],
        sigma_hz=1e-4 * found.freq[elastic],
        n=found.nodal_diameters[elastic],
        angle_deg=found.angle_deg[elastic],
    )
    model = search_model(cone, table, among="mass", edge=edge, places=8)
    (one,) = cf.locate(cone, table, among="mass", edge=edge, most=1, model=model).found
    assert (one.place, one.angle_deg, one.value) == (2, pytest.approx(40.0, abs=1e-4), pytest.approx(0.02, rel=1e-5))


@pytest.mark.slow
def test_scale_and_sigma_of_masses_count_an_angle_with_each(steel):
    """Two masses take four from the degrees of freedom; standard deviations by differences of the residuals."""
    mesh = cf.ShellMesh(order=5, rows=1, around=7)
    cone = cf.Shell(chart=cf.Frustum(r_base=0.3, r_top=0.25, height=0.05), thickness=4e-3, material=steel, mesh=mesh)
    added = [cf.edge.EdgeMass(angle=np.radians(angle), mass=mass) for angle, mass in ((40.0, 0.02), (115.0, 0.03))]
    heavy = cf.modes(replace(cone, masses={"top": added}), 14, method="shell")
    elastic = slice(heavy.rigid, None)
    freq = heavy.freq[elastic]
    noise = 3e-4 * np.random.default_rng(5).standard_normal(len(freq))
    table = cf.FrequencyTable.from_arrays(
        freq_hz=freq * (1.0 + noise),
        sigma_hz=1e-4 * freq,
        n=heavy.nodal_diameters[elastic],
        angle_deg=heavy.angle_deg[elastic],
    )
    model = search_model(cone, table, among="mass", places=8)
    found = cf.locate(cone, table, among="mass", most=2, model=model)

    def at(values):
        return at_places(found.misfit, "top", values[2:], values[:2])[0]

    def values(explanation):
        return np.array([(one.value, np.radians(one.angle_deg)) for one in explanation.found]).T.ravel()

    assert found.scale == pytest.approx(np.sqrt(found.chi2 / (found.rows - 4)), rel=1e-12)
    assert found.scale > 1.5
    best, steps = values(found.best), np.diag([1e-5, 1e-5, 1e-4, 1e-4])
    J = np.column_stack([(at(best + step).values - at(best - step).values) / (2.0 * step.sum()) for step in steps])
    sigma = found.scale * np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
    assert [one.sigma for one in found.found] == pytest.approx(sigma[:2], rel=1e-3)
    assert [one.angle_sigma_deg for one in found.found] == pytest.approx(np.degrees(sigma[2:]), rel=1e-3)
    assert len(found.others) == 3
    for other in found.others:
        risen = at(values(other)).chi2 - found.chi2
        assert other.behind == pytest.approx(risen / found.scale**2, rel=1e-6)


@pytest.mark.slow
def test_fox_ring_gives_its_masses_back(steel):
    """The closed form of a thin free ring with masses (Fox, J. Sound Vib. 142, 1990, 227), for n = 2 to 5.

    w^2 = w0^2/{1 + [sum m +- (n^2 - 1)/(n^2 + 1) |sum m e^(2 i n theta)|]/M0}, axis tan 2 n psi.
    """
    ring = cf.Shell(
        chart=cf.Cylinder(radius=0.3, height=0.02),
        thickness=0.006,
        material=steel,
        mesh=cf.ShellMesh(order=7, rows=1, around=9),
    )
    bare = cf.modes(ring, 34, method="shell")
    angles, masses = np.radians([25.0, 80.0]), np.array([0.004, 0.007])
    whole = 2.0 * np.pi * 0.3 * 0.006 * 0.02 * steel.rho
    rows = []
    for n in (2, 3, 4, 5):
        radial = np.abs(bare.rings.amplitudes[n, :, 0]).mean(axis=0)
        flat = [k for k in np.flatnonzero(bare.nodal_diameters == n) if radial[k] > 0.3 * radial.max()]
        swing = np.sum(masses * np.exp(2j * n * angles))
        part = (n**2 - 1) / (n**2 + 1) * abs(swing)
        axis = np.degrees(np.angle(swing)) / (2 * n)
        for way, turn in ((1.0, 0.0), (-1.0, 90.0 / n)):
            freq = bare.freq[flat[0]] / np.sqrt(1.0 + (masses.sum() + way * part) / whole)
            rows.append((n, freq, (axis + turn) % (180.0 / n)))
    n, freq, angle = map(np.array, zip(*rows, strict=True))
    table = cf.FrequencyTable.from_arrays(n=n, freq_hz=freq, sigma_hz=1e-4 * freq, angle_deg=angle)
    found = cf.locate(ring, table, among="mass", edge="top", most=2)
    said = {tuple(round(one.angle_deg) for one in e.found): e for e in (found.best, *found.others)}
    assert (25, 80) in said
    assert [one.value for one in said[25, 80].found] == pytest.approx(masses, rel=0.02)


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"among": "welds"}, "locate-among"),
        ({"edge": "left"}, "locate-edge"),
        ({"baseline": "far"}, "locate-baseline"),
        ({"table": "bare"}, "locate-unlabelled"),
    ],
)
def test_bad_input_is_named(casing, model, options, code):
    table = cf.FrequencyTable.from_arrays(freq_hz=[366.0, 367.0], sigma_hz=0.1, n=[8, 8], angle_deg=[0.0, 11.25])
    bare = cf.FrequencyTable.from_arrays(freq_hz=[366.0, 367.0], sigma_hz=0.1)
    if options.get("baseline"):
        far = cf.FrequencyTable.from_arrays(freq_hz=[9366.0, 9367.0], sigma_hz=0.1, n=[8, 8])
        options = {"baseline": far, "model": model}
    elif "table" in options:
        options, table = {}, bare
    with pytest.raises(cf.errors.ModelError) as caught:
        cf.locate(casing, table, **options)
    assert caught.value.code == code


@pytest.mark.slow
def test_a_table_of_which_no_row_pairs_is_refused(casing, model):
    """It was answered that no bolt is loose."""
    far = cf.FrequencyTable.from_arrays(freq_hz=[110.0, 111.0], sigma_hz=0.1, n=[8, 8], path="far.csv")
    with pytest.raises(
        cf.errors.InputError, match=r"no row of far\.csv pairs .* within 30%: measured 110\.0 to 111\.0 Hz, computed"
    ):
        cf.locate(casing, far, model=model)
    right = measured(cf.modes(casing, 8), 470.0)
    kilo = replace(right, freq_hz=1e-3 * right.freq_hz, sigma_hz=1e-3 * right.sigma_hz)
    with pytest.raises(cf.errors.InputError, match="as of kHz; expected Hz"):
        cf.locate(casing, kilo, model=model)
    with pytest.raises(cf.errors.ModelError, match=r"baseline: .* as of kHz; expected Hz.*\[locate-baseline\]"):
        cf.locate(casing, right, baseline=kilo, model=model)


def with_far_rows(table):
    """The table below two rows that pair with no mode."""
    far = {"freq_hz": [10.0, 99.0], "sigma_hz": 0.01, "n": [0, 0], "angle_deg": np.nan}
    return cf.FrequencyTable.from_arrays(
        **{name: np.concatenate([np.broadcast_to(rows, 2), getattr(table, name)]) for name, rows in far.items()}
    )


@pytest.mark.slow
def test_rows_that_pair_with_nothing_are_named_and_change_nothing_else(casing, model, noisy):
    """Frequencies off by three times their sigma, beside two rows that counted as 100 and 990 of theirs."""
    table, plain = noisy
    found = cf.locate(casing, with_far_rows(table), model=model, most=1)
    assert (found.unpaired, plain.unpaired) == ((1, 2), ())
    assert "no mode pairs with table modes 1, 2: they took no part" in repr(found).splitlines()
    told, expected = found.to_json(), plain.to_json()
    assert (told.pop("unpaired"), expected.pop("unpaired")) == ([1, 2], [])
    assert told == expected
    assert plain.scale > 1.5


@pytest.mark.slow
def test_rows_of_a_baseline_that_pair_with_nothing_are_named_and_change_nothing_else(casing, model, table_with):
    before, now = table_with({}), table_with({3: 0.5})
    found, plain = (
        cf.locate(casing, now, baseline=table, model=model, most=1) for table in (with_far_rows(before), before)
    )
    assert (found.unpaired, found.baseline_unpaired, plain.baseline_unpaired) == ((), (1, 2), ())
    assert "no mode pairs with baseline modes 1, 2: they took no part" in repr(found).splitlines()
    told, expected = found.to_json(), plain.to_json()
    assert (told.pop("baseline_unpaired"), expected.pop("baseline_unpaired")) == ([1, 2], [])
    assert told == expected


@pytest.mark.slow
def test_a_table_whose_doublets_pair_with_nothing_is_refused(casing, model):
    single = cf.modes(casing, 1, method="shell").freq[0]
    table = cf.FrequencyTable.from_arrays(freq_hz=[11.0, 12.0, single], sigma_hz=0.1, n=[8, 8, 7])
    with pytest.raises(
        cf.errors.ModelError, match="no doublet with nodal diameters; no mode pairs with table modes 1, 2: they"
    ):
        cf.locate(casing, table, model=model)


def test_a_baseline_widens_rows_by_its_noise_and_by_what_couples_them():
    """Half splits of 1.5 %: row 2 is nearer than that to another n, row 4 lies 10 Hz away from one; 1 % of noise."""
    noisy = cf.FrequencyTable.from_arrays(freq_hz=[99.0, 101.0, 300.0], sigma_hz=[0.99, 1.01, 3.0], n=[3, 3, 0])
    now = cf.FrequencyTable.from_arrays(freq_hz=[100.0, 101.0, 102.0, 112.0], sigma_hz=0.5, n=[3, 3, 4, 5])
    own = 0.015 * now.freq_hz
    expected = np.sqrt(0.25 + (0.01 * now.freq_hz) ** 2 + (own**2 / [2.0, own[1], own[2], 10.0]) ** 2)
    wider = with_baseline_noise(now, noisy, 0.015)
    np.testing.assert_allclose(wider.sigma_hz, expected, rtol=1e-12)
    np.testing.assert_array_equal(wider.freq_hz, now.freq_hz)
    unsplit = with_baseline_noise(now, noisy, 0.0)
    np.testing.assert_allclose(unsplit.sigma_hz, np.hypot(0.5, 0.01 * now.freq_hz), rtol=1e-12)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
def test_pairs_that_bolts_split_as_designed_hide_no_loose_bolt(casing):
    """Sixteen bolts split n = 8 by 6 %; that was taken for manufacture, and less than 61 % of a bolt was not seen."""

    def bolted(loose):
        bolts = replace(BOLTS, count=16, loose=loose)
        return replace(casing, supports=on_ring(bolts), mesh=replace(COARSE, around=16))

    before, now = (
        measured(cf.modes(replace(bolted(loose), radius_defect=cf.FourierField.of({14: 1e-4, 5: 2e-4})), 22), 420.0)
        for loose in ({}, {3: 0.6})
    )
    assert before.splits()[8] == pytest.approx(0.064, abs=0.002)
    found = cf.locate(bolted({}), now, baseline=before)
    assert {e.places for e in (found.best, *found.others)} == {frozenset({3}), frozenset({11})}
    assert found.found[0].value == pytest.approx(0.6, abs=0.02)
    assert found.smallest.max() < 0.1


@pytest.mark.parametrize(
    ("rows", "on", "pair", "shift"),
    [
        ([0, 1], [0, 1], [0, 1], (101.0**2 + 103.0**2 - 100.0**2 - 104.0**2) / 2),
        ([1], [1], [0, 1], 103.0**2 - 104.0**2),
        ([2], [2], [2], 208.0**2 - 200.0**2),
    ],
)
def test_a_baseline_without_orientations_moves_means(rows, on, pair, shift):
    """A doublet, half of one, a single mode: squares of frequencies, all members of a pair alike."""
    found = SimpleNamespace(
        omega=2.0 * np.pi * np.array([100.0, 104.0, 200.0]), doublets=((0, 1),), nodal_diameters=np.array([3, 3, 0]),
        doublet_of=lambda mode: 0 if mode < 2 else -1,
    )  # fmt: skip
    table = cf.FrequencyTable.from_arrays(freq_hz=[101.0, 103.0, 208.0], sigma_hz=0.1, n=[3, 3, 0])
    moved, block = correction(found, table, SimpleNamespace(rows=tuple(rows), modes=tuple(on)))
    assert moved == pair
    np.testing.assert_allclose(block, 4.0 * np.pi**2 * shift * np.eye(len(pair)), rtol=1e-12)


def localised(among, best, *others, **change):
    parts = {
        "chi2": 12.345678, "chi2_start": 9876.54, "rows": 20, "scale": 1.2345, "smallest": np.array([0.0123, 0.0456]),
        "alike": ((1, 7),), "calibrated": False, "angles_deg": np.array([0.0, 30.0]), "misfit": None,
    }  # fmt: skip
    best, *others = (Explanation(found=found, behind=behind) for found, behind in (best, *others))
    return cf.Localisation(among=among, best=best, others=tuple(others), **parts | change)


def test_loose_bolts_are_told_in_words_and_numbers():
    bolts = [Found(place=k, angle_deg=30.0 * k - 30.0, value=v, sigma=0.0123) for k, v in ((3, 0.254), (9, 0.3))]
    found = localised("bolts", ((bolts[0],), 0.0), ((bolts[1],), 2.345))
    assert repr(found).splitlines() == [
        "1 loose bolt found (without a baseline)",
        "no.  chi^2 above  place  angle [deg]  stiffness left [%]  sigma [%]",
        "  1            0      3        60.00                  25        1.2",
        "  2          2.3      9       240.00                  30        1.2",
        "chi^2 9877 -> 12.35 over 20 residuals; they are 1.23 times their stated sigma",
        "half a turn changes no frequency and no orientation: measured shapes decide",
        "a single change is seen from 0.012 to 0.046 of a bolt's stiffness",
    ]
    keys = ("explanation", "chi2_behind", "place", "angle_deg", "value", "sigma", "angle_sigma_deg")
    rows = [(1, 0.0, 3, 60.0, 0.254, 0.0123, 0.0), (2, 2.345, 9, 240.0, 0.3, 0.0123, 0.0)]
    assert found.records() == [dict(zip(keys, row, strict=True)) for row in rows]
    document = found.to_json()
    assert [one["behind"] for one in document["explanations"]] == [0.0, 2.345]
    assert (document["found"][0]["place"], document["chi2"], document["chi2_start"]) == (3, 12.345678, 9876.54)
    assert document["unpaired"] == []


@pytest.mark.parametrize(
    ("places", "free", "half"), [((5, 11), False, True), ((5, 11, 6), True, True), ((5, 9), True, False)]
)
def test_turns_of_any_size_and_half_turns_are_said_where_listed(places, free, half):
    bolts = [Found(place=k, angle_deg=30.0 * k - 30.0, value=0.3, sigma=0.01) for k in places]
    told = repr(localised("bolts", *(((bolt,), 0.0) for bolt in bolts)))
    assert (f"{len(places)} explanations, and nothing in the table to choose: orientations of more" in told) == free
    assert ("half a turn changes no frequency" in told) == half


@pytest.mark.parametrize(("scale", "badly"), [(4.9, False), (5.1, True)])
def test_residuals_far_beyond_noise_are_said_to_be_explained_badly(scale, badly):
    """Orientations turned by 17 deg named a wrong bolt, with residuals of 17 sigma in one line among others."""
    bolt = Found(place=6, angle_deg=150.0, value=0.34, sigma=0.085)
    told = repr(localised("bolts", ((bolt,), 0.0), scale=scale))
    assert ("this explains the table badly, do not rely on it" in told) == badly
    assert ("zero and sense of angle_deg" in told) == badly


@pytest.mark.parametrize(
    ("among", "smallest", "line"),
    [
        ("bolts", [3.1, 1.0], "nothing can be seen: even a bolt lost wholly stays within what the rows leave open"),
        ("bolts", [0.5, 1.2, np.nan, 0.6], "seen from 0.5 to 0.6 of a bolt's stiffness, at places 2, 3 not at all"),
        ("mass", [3.1, 1.2], "seen from 1.2 to 3.1 kg"),
        ("mass", [np.nan, np.nan], "nothing can be seen: even any mass stays"),
    ],
)
def test_what_cannot_be_seen_is_said(among, smallest, line):
    """A baseline 5 % off: no loose bolt found, "seen from 3.1 of a bolt's stiffness", more than it has."""
    assert line in repr(localised(among, ((), 0.0), smallest=np.array(smallest))).splitlines()[-1]


@pytest.mark.parametrize(("count", "more"), [(12, ""), (13, " and 1 more")])
def test_twelve_rows_that_pair_with_nothing_are_named(count, more):
    bolt = Found(place=3, angle_deg=60.0, value=0.254, sigma=0.0123)
    line = repr(localised("bolts", ((bolt,), 0.0), unpaired=tuple(range(1, count + 1)))).splitlines()[4]
    assert line == f"no mode pairs with table modes 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12{more}: they took no part"


def test_masses_are_told_in_grams_with_their_angles():
    masses = [
        Found(place=k, angle_deg=a, value=m, sigma=3.4e-5, angle_sigma_deg=0.123)
        for k, a, m in ((3, 20.004, 0.02), (7, 111.0, 0.0123456))
    ]
    assert repr(localised("mass", (tuple(masses), 0.0), calibrated=True)).splitlines() == [
        "2 added masses found (with a baseline)",
        "no.  chi^2 above  place  angle [deg]  mass [g]  sigma [g]  sigma of angle [deg]",
        "  1            0      3        20.00        20      0.034                  0.12",
        "  1            0      7       111.00     12.35      0.034                  0.12",
        "chi^2 9877 -> 12.35 over 20 residuals; they are 1.23 times their stated sigma",
        "a single change is seen from 0.012 to 0.046 kg",
    ]


def test_among_bolts_wants_one_bolted_edge(frustum):
    table = cf.FrequencyTable.from_arrays(freq_hz=[366.0, 367.0], sigma_hz=0.1, n=[8, 8])
    with pytest.raises(cf.errors.ModelError, match="0 edges of the structure have bolts"):
        cf.locate(frustum(), table)


@pytest.mark.slow
def test_shapes_tell_a_bolt_from_the_opposite_one(casing, model):
    """Noise of 2 % of each shape at 24 sensors around the rim; bolts 4 and 10 have one table."""
    loose = cf.modes(loosened(casing, {4: 0.3}), 16)
    theta = 2.0 * np.pi * np.arange(24) / 24
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    points = np.real(casing.geometry(np.full(24, 0.25), theta).surface.x).T
    values = sensors_of(loose, points, out).shapes(loose.fields)
    noise = np.random.default_rng(11).standard_normal(values.shape)
    values = values + 0.02 * np.sqrt(np.mean(values**2, axis=0)) * noise
    shapes = cf.correlation.MeasuredShapes.from_arrays(freq_hz=loose.freq, values=values, points=points, directions=out)
    found = cf.locate(casing, measured(loose, 470.0), model=model)
    right, wrong = checked_by_shapes(model[0], found, shapes)
    assert right.explanation.places == {4}
    assert wrong.explanation.places == {10}
    assert right.unlike < 0.3 * wrong.unlike
    with pytest.raises(cf.errors.InputError, match="found no shape that pairs with a mode"):
        checked_by_shapes(model[0], found, replace(shapes, freq_hz=3.0 * shapes.freq_hz))


def test_whitened_residuals_have_the_covariance_of_frequencies_and_orientations():
    """Two pairs, a single row between: by differences of the measured split vector, an angle's noise goes along it."""
    n, angle_sigma = [5, 5, -1, 8, 8], 0.03
    angle = [12.0, np.nan, np.nan, np.nan, 31.0]
    table = cf.FrequencyTable.from_arrays(
        freq_hz=[300.0, 304.0, 350.0, 400.0, 403.0], sigma_hz=[0.1, 0.2, 0.1, 0.15, 0.1], n=n, angle_deg=angle
    )
    matches = [
        Match(rows=rows, modes=rows, n=n[rows[0]], confidence=1.0, measured_hz=(), computed_hz=())
        for rows in ((0, 1), (2,), (3, 4))
    ]
    misfit = Misfit(model=None, table=table, count=5, angle_sigma=angle_sigma)
    C = np.eye(7)
    for first, (low, high), lower, of in ((0, (0, 1), 12.0, 5), (4, (3, 4), 31.0 - 90.0 / 8, 8)):
        f, s = table.freq_hz[[low, high]], np.hypot(*table.sigma_hz[[low, high]])
        split = (f[1] ** 2 - f[0] ** 2) / (2.0 * np.sqrt(np.mean(f**2)))
        up, down = (of * np.radians(lower) + way * 1e-5 for way in (1.0, -1.0))  # n psi
        turned = [split / s * np.array([np.cos(2.0 * phase), np.sin(2.0 * phase)]) for phase in (up, down)]
        slope = (turned[0] - turned[1]) / 2e-5
        C[first + 1 : first + 3, first + 1 : first + 3] += angle_sigma**2 * np.outer(slope, slope)
    W = misfit.whitening(table, matches, 7)
    np.testing.assert_allclose(W @ C @ W.T, np.eye(7), atol=1e-8)


@pytest.mark.parametrize("degrees", [3.0, 20.0, 33.0])
def test_a_pair_is_turned_until_its_lower_member_has_the_measured_antinode(degrees):
    """From members at 7 deg and a quarter wave on, three rings: the turned one is largest there."""
    n, size = 5, np.array([0.3, 1.0, 0.6])
    at = np.radians([7.0, 7.0 + 90.0 / n])
    amplitudes = np.zeros((n + 1, 3, 1, 2), complex)
    amplitudes[n, :, 0] = size[:, None] * np.exp(-1j * n * at)
    T = turned_to(SimpleNamespace(rings=SimpleNamespace(amplitudes=amplitudes)), [0, 1], n, np.radians(degrees))
    theta = np.radians(np.linspace(0.0, 36.0, 3601))
    radial = np.cos(n * (theta[:, None] - at)) @ T
    assert np.degrees(theta[np.abs(radial[:, 0]).argmax()]) == pytest.approx(degrees, abs=0.011)
    np.testing.assert_allclose(T.T @ T, np.eye(2), atol=1e-12)


@pytest.mark.parametrize(("many", "kept"), [(2.9, [1]), (3.1, [0, 1])])
def test_masses_within_three_sigma_of_nothing_are_none(many, kept, monkeypatch):
    """Angles as sure as nothing; the first mass `many` times its sigma of 1 mg, the other ten times."""
    jacobian = np.vstack([1e6 * np.eye(4), np.zeros((6, 4))])
    point = Point(np.zeros(4), None, np.zeros(10), jacobian, 1.0)
    given = Masses(np.array([0.1, 2.0]), np.array([many, 10.0]) * 1e-6, point, jacobian)

    def refined(misfit, edge, angles, masses):
        of = [int(np.flatnonzero(given.angles == angle)[0]) for angle in angles]
        return Masses(angles, masses, point, jacobian[:, [*of, *(2 + k for k in of)]])

    monkeypatch.setitem(significant_masses.__globals__, "refined", refined)
    assert significant_masses(None, "top", given).angles.tolist() == given.angles[kept].tolist()


def test_shapes_are_those_of_the_stiffness_that_an_explanation_leaves_of_a_bolt(casing):
    """A change is what is left less what the design has of a tight bolt: bolt 2 comes with 60 %, bolt 5 with all."""
    asked = []

    def solved(x, count):
        asked.append(x)
        raise LookupError

    shell = loosened(casing, {2: 0.6})
    model = SimpleNamespace(system=SimpleNamespace(shell=shell), modes=solved, nominal=np.zeros(20))
    places = tuple(Found(place=k, angle_deg=0.0, value=v, sigma=0.1) for k, v in ((2, 0.25), (5, 0.3)))
    with pytest.raises(LookupError):
        unlike(model, Explanation(found=places, behind=0.0), np.eye(3), np.zeros(4), 0.05)
    changed = np.zeros(12)
    changed[[1, 4]] = 0.25 - 0.6, 0.3 - 1.0
    np.testing.assert_allclose(asked[0], changed)


@pytest.mark.parametrize(("off", "mode"), [(1.049, 1), (1.052, 0)])
def test_a_wrong_n_costs_as_much_as_a_twentieth_in_frequency(off, mode):
    """A row n = 8 between a mode n = 5 at its frequency and one n = 8 further up: exp(.05) is 1.0513."""
    shares = np.zeros((9, 2))
    shares[5, 0] = shares[8, 1] = 1.0
    found = SimpleNamespace(freq=np.array([100.0, 100.0 * off]), rigid=0, rings=SimpleNamespace(shares=lambda: shares))
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.0], sigma_hz=0.1, n=[8])
    matches, lost = paired_by_shares(found, table, 0.3)
    assert [match.modes for match in matches] == [(mode,)]
    assert lost == []


@pytest.mark.parametrize(("modes_n", "pairs"), [((5, 8), [(0, 1), (1, 0)]), ((8, 5), [(0, 0), (1, 1)])])
def test_rows_go_to_the_modes_that_share_their_n_in_any_order(modes_n, pairs):
    shares = np.full((9, 2), 0.0)
    for mode, n in enumerate(modes_n):
        shares[[5, 8], mode] = 0.2
        shares[n, mode] = 0.8
    found = SimpleNamespace(freq=np.array([100.0, 101.0]), rigid=0, rings=SimpleNamespace(shares=lambda: shares))
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.2, 100.8], sigma_hz=0.1, n=[8, 5])
    matches, _ = paired_by_shares(found, table, 0.3)
    assert sorted((match.rows[0], match.modes[0]) for match in matches) == pairs
