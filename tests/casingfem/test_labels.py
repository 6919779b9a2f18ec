"""Modes that two nodal diameters share keep their row of the table."""

import numpy as np

import casingfem as cf
from casingfem.updating.labels import followed, paired_rows, relabelled


def mixed_modes():
    """A casing whose strong cos 8 theta mixes n = 7 with n = 9."""
    shell = cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25),
        thickness=3e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": cf.Clamped()},
        radius_defect=cf.FourierField.of({8: 0.002, 2: 0.001}),
        mesh=cf.ShellMesh(order=6, rows=1, around=17),
    )
    return cf.modes(shell, 12)


def table_of(modes, labels):
    return cf.FrequencyTable.from_arrays(freq_hz=modes.freq[:8], sigma_hz=0.2, n=labels[:8])


def test_a_row_lost_to_a_flipped_label_is_found_under_the_second_one():
    modes = mixed_modes()
    shares = modes.rings.shares()
    second = shares.argsort(axis=0)[-2]
    shared = np.flatnonzero(shares[second, np.arange(len(modes))][:8] > 0.3)[:2]
    assert len(shared) == 2  # the case is what it is meant to be
    labels = modes.nodal_diameters.copy()
    labels[shared] = second[shared]
    original = relabelled(modes, labels)
    table = table_of(original, labels)
    _, before = followed(original, table, 0.5, None)
    rows = paired_rows(before)
    assert sum(map(len, rows)) == 8
    lost = paired_rows(followed(modes, table, 0.5, None)[1])
    assert lost != rows
    kept, pairing = followed(modes, table, 0.5, rows)
    assert paired_rows(pairing) == rows
    np.testing.assert_array_equal(kept.nodal_diameters[:8], labels[:8])


def test_relabelling_keeps_frequencies_and_shapes():
    modes = mixed_modes()
    same = relabelled(modes, modes.nodal_diameters)
    assert same.doublets == modes.doublets
    np.testing.assert_array_equal(same.meridional, modes.meridional)
    np.testing.assert_array_equal(same.fields, modes.fields)
    np.testing.assert_allclose(same.purity, modes.purity)
