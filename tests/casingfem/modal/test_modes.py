"""Modes: the table, doublets, splitting rules, orientation, rigid motions, refusals, determinism."""

import json
import warnings
from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

MEDIUM = cf.ShellMesh(order=6, rows=1, around=17)
EIGHT = cf.ShellMesh(order=6, rows=1, around=16)  # as symmetric as an imperfection of period 45 degrees


def splits(found):
    """Nodal diameters and relative split of each doublet."""
    return found.nodal_diameters[[low for low, _ in found.doublets]], found.splits


# --- what is split, what is not -------------------------------------------------------------------------------


@pytest.mark.slow
def test_cos_8_theta_in_the_radius_splits_4_and_8_and_leaves_odd_n_double(split_modes):
    n, split = splits(split_modes)
    assert np.all(split[np.isin(n, [4, 8])] > 5e-3)
    assert np.all(split[n == 12] > 1e-3)  # at third order
    assert split[n % 4 != 0].max() < 1e-9
    assert set(n[n % 4 != 0]) >= {3, 5, 6, 7, 9, 10, 11, 13, 14, 15}


@pytest.mark.slow
def test_split_falls_with_the_imperfection_at_the_order_of_the_rule(frustum):
    """2 n = k p: n = 4 at first order in cos 8 theta, n = 8 at second."""
    small, large = (cf.modes(frustum(radius_defect=cf.FourierField.of({8: a}), mesh=MEDIUM), 20) for a in (1e-4, 2e-4))
    ratio = {n: splits(large)[1][splits(large)[0] == n][0] / splits(small)[1][splits(small)[0] == n][0] for n in (4, 8)}
    assert ratio[4] == pytest.approx(2.0, rel=0.02)
    assert ratio[8] == pytest.approx(4.0, rel=0.05)


def assert_turned(turned, still, angle, tolerance):
    """The same frequencies, and orientations moved by the angle where a pair is split."""
    np.testing.assert_allclose(turned.freq, still.freq, rtol=tolerance)
    n, split = still.nodal_diameters, np.zeros(len(still))
    for pair, own in zip(still.doublets, still.splits, strict=True):
        split[list(pair)] = own
    known = split > 1e-4
    assert np.count_nonzero(known) >= 4
    period = 180.0 / n[known]
    off = turned.angle_deg[known] - still.angle_deg[known] - np.degrees(angle)
    np.testing.assert_allclose(np.mod(off + period / 2, period) - period / 2, 0.0, atol=1e-3)


@pytest.mark.slow
def test_turning_the_field_changes_no_frequency_and_turns_the_shapes(frustum, split_modes):
    """Default mesh: 1e-11."""
    field = cf.FourierField.of({8: 0.002}).rotated(0.3)
    assert_turned(cf.modes(frustum(radius_defect=field), 40), split_modes, 0.3, 1e-9)


@pytest.mark.campaign
@pytest.mark.slow
def test_turning_a_mixed_field_changes_no_frequency(frustum):
    """Five harmonics up to 0.2 %, default mesh; mixed harmonics couple many n through the mesh."""
    field = cf.FourierField.of({2: 0.002, 3: (0.001, 0.0005), 5: 0.0005, 8: 0.001, 4: 0.001})
    still = cf.modes(frustum(radius_defect=field), 24)
    assert_turned(cf.modes(frustum(radius_defect=field.rotated(-1.7)), 24), still, -1.7, 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("around", [8, 4])
def test_equal_springs_split_n_only_if_their_number_divides_2n(frustum, around):
    """Springs k(1 + .9 cos N theta), as of N bolts: N = 8 splits 4, 8, 12; N = 4 also 6 and 10."""
    bolts = cf.ElasticEdge(k_face=1e11, around=cf.FourierField.of({around: (0.9, 0.0)}))
    n, split = splits(cf.modes(frustum(supports={"base": bolts}, mesh=EIGHT), 24))
    allowed = (2 * n) % around == 0
    assert split[~allowed].max() < 1e-10
    # order k = 2n/N of the pattern: the first two are plain to see
    plain = allowed & (2 * n // around <= 2)
    assert split[plain].min() > 1e-6
    assert split[n == 4][0] == split.max()


def test_a_thickness_field_splits_by_the_same_rule(frustum):
    n, split = splits(cf.modes(frustum(thickness_defect=cf.FourierField.of({8: 0.05}), mesh=EIGHT), 20))
    assert split[n == 4][0] > 1e-3
    assert split[(2 * n) % 8 != 0].max() < 1e-10


# --- labels and orientation -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_members_of_a_split_pair_are_a_quarter_wave_apart(split_modes):
    for low, high in split_modes.doublets:
        n = split_modes.nodal_diameters[low]
        if np.isfinite(split_modes.angle_deg[low]):
            off = split_modes.angle_deg[high] - split_modes.angle_deg[low]
            assert np.mod(off, 180 / n) == pytest.approx(90 / n, abs=1e-3)


@pytest.mark.slow
def test_a_perfect_pair_has_no_orientation_and_is_as_cosine_and_sine(perfect_modes):
    assert np.all(np.isnan(perfect_modes.angle_deg))
    grid = perfect_modes.grid
    at_zero = np.flatnonzero((grid.nodes[1] == 0.0) & (grid.nodes[0] == 0.25))[0]
    radial = perfect_modes.fields[at_zero, 0]
    cosine, sine = np.array(perfect_modes.doublets).T
    assert np.abs(radial[sine]).max() < 1e-6 * np.abs(radial[cosine]).min()


@pytest.mark.slow
def test_shapes_are_mass_normalised_and_orthogonal(split_modes):
    system = cf.shell.assemble(split_modes.shell)
    phi = system.collect(split_modes.fields, split_modes.own)
    np.testing.assert_allclose(phi.T @ (system.mass[:, None] * phi), np.eye(40), atol=1e-9)
    lam = split_modes.omega**2
    np.testing.assert_allclose(phi.T @ (system.K @ phi) / lam[-1], np.diag(lam) / lam[-1], atol=1e-9)


@pytest.mark.slow
def test_fourier_shapes_are_the_shells_own(frustum):
    """The fast path's nodal fields are mass-normalised modes of the assembled matrices."""
    mesh = cf.ShellMesh(order=8, rows=1, around=17)
    fast = cf.modes(frustum(mesh=mesh), 8, method="fourier")
    system = cf.shell.assemble(frustum(mesh=mesh))
    phi = system.collect(fast.fields, fast.own)
    np.testing.assert_allclose(phi.T @ (system.mass[:, None] * phi), np.eye(8), atol=1e-6)
    whole = cf.modes(frustum(mesh=mesh), 8, method="shell")
    slow = system.collect(whole.fields, whole.own)
    np.testing.assert_allclose(np.abs(phi.T @ (system.mass[:, None] * slow)), np.eye(8), atol=1e-5)


@pytest.mark.slow
def test_meridional_rank_counts_a_doublet_once(perfect_modes):
    for n in (8, 9, 10):
        own = perfect_modes.meridional[perfect_modes.nodal_diameters == n]
        assert own.tolist() == [1, 1, 2, 2]


# --- free bodies, open shells ---------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["shell", "fourier"])
def test_free_casing_shows_its_six_rigid_motions(frustum, coarse, method):
    found = cf.modes(frustum(supports={}, mesh=coarse), 10, method=method)
    assert found.rigid == 6
    assert found.freq[:6].max() < 0.05
    assert found.freq[6] > 5.0
    assert found.nodal_diameters.tolist() == [-1] * 6 + [2, 2, 2, 2]
    assert [row["rigid"] for row in found.records()] == [True] * 6 + [False] * 4
    assert repr(found).count("rigid") == 6


@pytest.mark.filterwarnings("ignore:.*modes-round-off")
@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("thickness", [1e-3, 2e-3, 3e-3, 5e-3, 1e-2, 2e-2])  # round-off leaves zero of either sign
def test_a_free_casing_may_be_asked_for_one_mode_or_two(steel, thickness, count):
    """Six lie at zero: so many are counted, or none can be; four belong to n = 1."""
    mesh = cf.ShellMesh(order=4, rows=1, around=9)
    shell = cf.Shell(chart=cf.Cylinder(radius=1.0, height=1.0), thickness=thickness, material=steel, mesh=mesh)
    found = cf.modes(shell, count, method="fourier")
    assert (len(found), found.rigid) == (count, count)
    assert found.freq[-1] < 0.01
    assert found.sturm_count in (None, 6)


def test_torsion_of_a_wide_tube_moves_all_around_alike(steel):
    """u_theta = sqrt(2/mass) sin(pi z/2L), omega = pi sqrt(G/rho)/2L."""
    tube = cf.Shell(
        chart=cf.Cylinder(radius=2.0, height=0.5), thickness=0.1, material=steel, supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=1, around=9),
    )  # fmt: skip
    exact = np.sqrt(steel.shear_modulus / steel.rho) / (4.0 * 0.5)
    found = cf.modes(tube, band=(0.999 * exact, 1.001 * exact), method="fourier")
    (torsion,) = np.flatnonzero(found.nodal_diameters == 0)
    z, theta = found.grid.nodes
    x, y = found.fields[:, :2, torsion].T
    mass = steel.rho * 2.0 * np.pi * 2.0 * 0.5 * 0.1
    around = np.sqrt(2.0 / mass) * np.sin(np.pi * z)
    np.testing.assert_allclose(np.abs(y * np.cos(theta) - x * np.sin(theta)), around, atol=1e-3 * around.max())


def test_free_methods_agree(frustum, coarse):
    """Elastic modes of a free thin ring lie five decades below the stiffness: still five digits."""
    shell = frustum(supports={}, mesh=coarse)
    a, b = (cf.modes(shell, 10, method=method).freq[6:] for method in ("shell", "fourier"))
    np.testing.assert_allclose(a, b, rtol=1e-3)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*shell-thin")
@pytest.mark.parametrize(("ratio", "counted"), [(1e-3, True), (1e-4, True), (1e-5, False)])
def test_a_thin_free_ring_by_harmonics_has_an_answer_and_a_word_on_round_off(steel, ratio, counted):
    """Rayleigh's inextensional n = 2 of a long cylinder, less what its free edges take off, about .07 sqrt(t/R)."""
    shell = cf.Shell(chart=cf.Cylinder(radius=1.0, height=1.0), thickness=ratio, material=steel)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        found = cf.modes(shell, 10, method="fourier")
    assert (found.sturm_count is not None) is counted
    assert any("modes-round-off" in str(one.message) for one in said) is not counted
    bending = steel.E * ratio**2 / (12.0 * (1.0 - steel.nu**2) * steel.rho)
    rayleigh = np.sqrt(bending / 5.0) * 6.0 / (2.0 * np.pi)
    np.testing.assert_allclose(found.freq[6:8], rayleigh * (1.0 - 0.0702 * np.sqrt(ratio)), rtol=4e-4)


def test_a_wall_too_thin_for_double_precision_is_refused(steel):
    # at 1e-6 it is the processor's rounding that decides; at 3e-7 and less every one loses the stiffness
    shell = cf.Shell(chart=cf.Cylinder(radius=1.0, height=1.0), thickness=1e-7, material=steel)
    with (
        pytest.warns(cf.errors.ModelWarning, match="shell-thin"),
        pytest.raises(cf.errors.NumericsError, match="too thin"),
    ):
        cf.modes(shell, 10, method="fourier")


def test_open_shell_has_no_diameters(steel):
    plate = cf.Shell(
        chart=cf.Plate(length=1.0, width=0.5), thickness=0.01, material=steel, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=2, around=1),
    )  # fmt: skip
    found = cf.modes(plate, 5)
    assert found.nodal_diameters.tolist() == [-1] * 5
    assert np.all(np.isnan(found.purity))
    assert found.doublets == ()
    assert found.splits.shape == (0,)
    assert found.rings is None
    assert found.records()[0]["n_purity"] is None
    head = repr(found).splitlines()[0]  # without the columns that are empty for every mode
    assert head.split() == ["mode", "freq", "[Hz]", "m"]


def test_cantilever_strip_bends_as_a_beam_does(steel):
    """nu = 0, L/h = 100: 1.8751^2 sqrt(E h^2/12 rho)/(2 pi L^2), 1e-4 above the shear-deformable beam."""
    strip = cf.Shell(
        chart=cf.Plate(length=1.0, width=0.05), thickness=0.01, material=replace(steel, nu=0.0),
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=2, around=1),
    )  # fmt: skip
    exact = 1.875104069**2 * np.sqrt(210e9 * 0.01**2 / 12 / 7800) / (2 * np.pi)
    assert cf.modes(strip, 1).freq[0] == pytest.approx(exact, rel=3e-4)


# --- counts, methods, errors ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("method", ["shell", "fourier"])
def test_a_count_that_cuts_a_doublet_gives_as_many_modes_and_states_so(frustum, coarse, method):
    whole, cut = (cf.modes(frustum(mesh=coarse), count, method=method) for count in (8, 7))
    assert (len(whole), len(cut)) == (8, 7)
    assert (whole.sturm_count, cut.sturm_count) == (8, 8)
    assert len(cut.doublets) == 3
    np.testing.assert_allclose(cut.freq, whole.freq[:7], rtol=1e-10)
    assert cut.records()[-1]["doublet"] is None


@pytest.mark.slow
def test_auto_takes_the_fast_path_only_where_nothing_varies(frustum, coarse):
    assert "assemble" not in cf.modes(frustum(mesh=coarse), 4).seconds
    field = cf.FourierField.of({3: 0.001})
    assert "assemble" in cf.modes(frustum(mesh=coarse, radius_defect=field), 4).seconds
    assert "assemble" in cf.modes(frustum(mesh=coarse), 4, method="shell").seconds


def test_fourier_refuses_what_varies_around(frustum):
    with pytest.raises(ValueError, match="axisymmetric casing at rest"):
        cf.modes(frustum(radius_defect=cf.FourierField.of({3: 0.001})), 4, method="fourier")


def test_refuses_a_method_it_does_not_know(frustum):
    with pytest.raises(ValueError, match="found 'ritz'"):
        cf.modes(frustum(), 4, method="ritz")


@pytest.mark.parametrize("method", ["shell", "fourier"])
@pytest.mark.parametrize("count", [0, -1])
def test_refuses_no_modes(frustum, count, method):
    with pytest.raises(ValueError, match=f"count must be at least 1, found {count}"):
        cf.modes(frustum(), count, method=method)


def test_refuses_more_modes_than_there_are(frustum):
    with pytest.raises(cf.errors.NumericsError, match="count must lie between 1 and"):
        cf.modes(frustum(mesh=cf.ShellMesh(order=2, rows=1, around=3)), 500, method="shell")


@pytest.mark.slow
def test_two_calls_agree_bit_by_bit(frustum, coarse):
    shell = frustum(mesh=coarse, radius_defect=cf.FourierField.of({8: 0.002}))
    a, b = cf.modes(shell, 10), cf.modes(shell, 10)
    assert a.freq.tobytes() == b.freq.tobytes()
    assert a.fields.tobytes() == b.fields.tobytes()


@pytest.mark.slow
def test_arrays_are_read_only(perfect_modes):
    for array in (perfect_modes.freq, perfect_modes.fields, perfect_modes.nodal_diameters):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


@pytest.mark.slow
def test_records_are_plain_json(split_modes):
    records = json.loads(json.dumps(split_modes.records()))
    assert len(records) == 40
    first = records[0]
    assert first == {
        "mode": 1,
        "freq_hz": pytest.approx(split_modes.freq[0]),
        "n": 8,
        "n_purity": pytest.approx(split_modes.purity[0]),
        "m": 1,
        "doublet": 1,
        "split_rel": pytest.approx(split_modes.splits[0]),
        "angle_deg": pytest.approx(split_modes.angle_deg[0]),
        "rigid": False,
    }


@pytest.mark.slow
def test_repr_is_the_table(split_modes):
    lines = repr(split_modes).splitlines()
    assert len(lines) == 42
    assert lines[0].split() == ["mode", "freq", "[Hz]", "n", "share", "of", "n", "m", "split", "[%]", "angle", "[deg]"]
    assert lines[1].split()[:3] == ["1", f"{split_modes.freq[0]:.3f}", "8"]
    assert "40 modes" in lines[-1]
    assert "Sturm count 40" in lines[-1]


@pytest.mark.slow
def test_tube_of_two_materials_scales(steel):
    """Frequencies go with sqrt(E/rho) and with one over the size."""
    tube = cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=0.4), thickness=4e-3, material=steel, supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=1, around=9),
    )  # fmt: skip
    f = cf.modes(tube, 6).freq
    light = cf.modes(replace(tube, material=replace(steel, E=70e9, rho=2700.0)), 6).freq
    np.testing.assert_allclose(light, f * np.sqrt(70e9 / 2700.0 / (210e9 / 7800.0)), rtol=1e-10)
    half = replace(tube, chart=cf.Cylinder(radius=0.25, height=0.2), thickness=2e-3)
    np.testing.assert_allclose(cf.modes(half, 6).freq, 2 * f, rtol=1e-9)


def humped(steel):
    """A thin cylinder that may slide along its axis: n = 0 lies lowest, n = 1 to 10 climb, the next wait at n = 17."""
    base, top = cf.ElasticEdge(k_r=1e13, k_z=1e13, k_theta=1e6), cf.ElasticEdge(k_r=1e13)
    return cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=0.25), thickness=5e-4, material=steel, supports={"base": base, "top": top}
    )


@pytest.mark.slow
def test_a_low_axial_mode_does_not_hide_the_valley_behind_a_hump(steel):
    found = cf.modes(humped(steel), 3)
    assert found.nodal_diameters.tolist() == [0, 17, 17]
    assert found.sturm_count == 3


@pytest.mark.slow
def test_the_valley_behind_a_hump_is_as_in_the_whole_shell(steel):
    shell = replace(humped(steel), mesh=cf.ShellMesh(order=8, rows=2, around=19))
    np.testing.assert_allclose(cf.modes(shell, 3).freq, cf.modes(shell, 3, method="shell").freq, rtol=1e-4)


# --- bands ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("method", ["shell", "fourier"])
def test_a_band_contains_the_modes_of_the_count_and_no_other(frustum, coarse, method):
    shell = frustum(mesh=coarse)
    freq = cf.modes(shell, 16, method=method).freq
    found = cf.modes(shell, band=(freq[2] * (1 + 1e-12), freq[9]), method=method)  # both ends on doublets
    np.testing.assert_allclose(found.freq, freq[2:10], rtol=1e-9)
    assert found.sturm_count == 8
    assert len(found.doublets) == 4


@pytest.mark.parametrize("method", ["shell", "fourier"])
def test_a_band_without_modes(frustum, coarse, method):
    found = cf.modes(frustum(mesh=coarse), band=(1.0, 2.0), method=method)
    assert len(found) == found.sturm_count == 0
    assert "0 modes" in repr(found)


def test_refuses_bands_that_are_none(frustum):
    with pytest.raises(ValueError, match="found both count and band"):
        cf.modes(frustum(), 4, band=(0.0, 10.0))
    with pytest.raises(ValueError, match=r"band: found 9.0 to 3.0 Hz.*modes-band"):
        cf.modes(frustum(), band=(9.0, 3.0))


# --- rigid motions --------------------------------------------------------------------------------------------


def test_a_mesh_too_coarse_to_turn_a_thin_body_is_doubted(steel):
    """Order 3, 7 elements around, R/t = 3,000: it bends before it turns."""
    shell = cf.Shell(
        chart=cf.Frustum(r_base=0.07, r_top=0.09, height=0.03), thickness=2.4e-5, material=steel,
        mesh=cf.ShellMesh(order=3, rows=1, around=7),
    )  # fmt: skip
    with pytest.warns(cf.errors.ModelWarning, match=r"found 4 rigid-body modes, expected 6, .*modes-rigid"):
        assert cf.modes(shell, 12, method="shell").rigid == 4


@pytest.mark.parametrize("around", [3, 5])
def test_a_thin_free_casing_on_a_very_coarse_mesh_has_six_rigid_motions(frustum, around):
    """A rotation of the body is interpolated with an error: its frequency is small, not zero."""
    found = cf.modes(frustum(supports={}, thickness=2e-4, mesh=cf.ShellMesh(order=4, rows=1, around=around)), 8)
    assert found.rigid == 6


@pytest.mark.filterwarnings("ignore:.*support-soft")
def test_a_casing_on_soft_springs_is_supported(frustum, coarse):
    soft = {"base": cf.ElasticEdge(k_r=1.0, k_theta=1.0, k_z=1.0)}
    found = cf.modes(frustum(supports=soft, mesh=coarse), 8)
    assert found.rigid == 0
    assert found.freq[5] < 1.0


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*support-incomplete")
def test_a_casing_that_may_slide_and_turn_has_two_rigid_motions(frustum, coarse):
    found = cf.modes(
        frustum(supports={"base": cf.ElasticEdge(k_r=1e9), "top": cf.ElasticEdge(k_r=1e9)}, mesh=coarse), 6
    )
    assert found.rigid == 2


@pytest.mark.slow
def test_pairs_that_the_mesh_itself_splits_are_doubted(frustum):
    """Eighteen elements of order 4 split n = 9 by 3 %; nineteen split no pair below n = 19."""
    thinner = cf.FourierField.of({2: 1e-3})
    with pytest.warns(cf.errors.ModelWarning, match=r"2 modes .*the mesh itself splits pairs.*mesh-coarse"):
        doubted = cf.modes(frustum(mesh=cf.ShellMesh(order=4, rows=2, around=18), thickness_defect=thinner), 6)
    assert 0.03 < np.ptp(doubted.freq[doubted.nodal_diameters == 9]) / 390.0 < 0.04
    whole = cf.modes(frustum(mesh=cf.ShellMesh(order=4, rows=2, around=19), thickness_defect=thinner), 6)
    assert np.ptp(whole.freq[whole.nodal_diameters == 9]) / 390.0 < 1e-3


@pytest.mark.slow
def test_modes_of_a_thin_soft_ring_are_not_missed_by_the_harmonics(frustum):
    """The floor of each harmonic, below which no mode is searched for, counts the weakest part: here the ring."""
    soft = cf.Material(E=2e9, nu=0.3, rho=8000.0)
    free = cf.Ring(section=cf.edge.Section.rectangle(width=0.004, depth=0.03), material=soft)
    mesh = cf.ShellMesh(order=8, rows=1, around=11)
    shell = frustum(mesh=mesh, supports={"base": cf.Clamped(), "top": free})
    by_harmonics, whole = (cf.modes(shell, 16, method=method).freq for method in ("fourier", "shell"))
    np.testing.assert_allclose(by_harmonics, whole, rtol=2e-3)


@pytest.mark.parametrize("band", [(0.0, np.nan), (300.0, 200.0), (-1.0, 200.0), (0.0, np.inf)])
def test_bands_that_are_none_are_refused(frustum, coarse, band):
    with pytest.raises((cf.errors.ModelError, cf.errors.InputError), match=r"band|below"):
        cf.modes(frustum(mesh=coarse), band=band)


@pytest.mark.parametrize(("around", "low", "high"), [(16, 0.0, 1e-12), (15, 1e-4, 1e-2)])
def test_elements_of_a_multiple_of_a_fields_period_leave_double_what_the_field_does(around, low, high):
    """Waves of period 4 split pairs of even nodal diameters alone; 15 elements share no symmetry with them."""
    shell = cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3, supports={"base": cf.Clamped()},
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0), mesh=cf.ShellMesh(order=6, rows=1, around=around),
        radius_defect=cf.FourierField.of({8: 0.004, 4: 0.002}),
    )  # fmt: skip
    found = cf.modes(shell, 20, method="shell")
    odd = np.array([found.nodal_diameters[first] % 2 == 1 for first, _ in found.doublets])
    assert odd.any()
    assert low <= found.splits[odd].max() < high
    assert found.splits[~odd].max() > 0.01


@pytest.mark.slow
def test_a_pair_whose_upper_member_is_not_among_the_modes_is_no_doublet(steel):
    shell = cf.Shell(
        chart=cf.Cylinder(radius=0.4, height=0.2), thickness=3e-3, material=steel, supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=5, rows=1, around=9), radius_defect=cf.FourierField.of({16: 1e-3, 14: 5e-4}),
    )  # fmt: skip
    found = {count: cf.modes(shell, count, method="shell") for count in (2, 3, 4)}
    assert [part.doublets for part in found.values()] == [(), ((1, 2),), ((0, 3), (1, 2))]
    assert [part.nodal_diameters.tolist() for part in found.values()] == [[8, 7], [8, 7, 7], [8, 7, 7, 8]]
