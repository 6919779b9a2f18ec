"""Modes are followed by their shapes: through crossings, flipped labels and turning doublets."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.updating.following import LostModeError, followed, overlaps, paired_rows


def mixed_casing(c8=0.002):
    """A casing whose strong cos 8 theta mixes n = 7 with n = 9."""
    return cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25),
        thickness=3e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"base": cf.Clamped()},
        radius_defect=cf.FourierField.of({8: c8, 2: 0.001}),
        mesh=cf.ShellMesh(order=6, rows=1, around=13),
    )


def plate(width):
    """A cantilever plate: its first torsion falls below its second bending as it gets wider."""
    return cf.Shell(
        chart=cf.Plate(length=0.2, width=width),
        thickness=2e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=1, around=1),
    )


def table_of(modes, rows, labels=True):
    return cf.FrequencyTable.from_arrays(
        freq_hz=modes.freq[:rows], sigma_hz=0.2, n=modes.nodal_diameters[:rows] if labels else -1
    )


@pytest.fixture(scope="module")
def casing_modes():
    return cf.modes(mixed_casing(), 16)


def test_a_mode_overlaps_with_itself_and_no_other(casing_modes):
    share = overlaps(casing_modes, casing_modes)
    np.testing.assert_allclose(share, np.eye(len(casing_modes)), atol=1e-9)


def test_labels_do_not_matter(casing_modes):
    """Half n = 7, half n = 9: whatever a mode is called on the way, it keeps its row."""
    table = table_of(casing_modes, 8)
    before = cf.correlation.pair(casing_modes, table)
    other = cf.modes(mixed_casing(0.0021), 16)
    renamed = replace(other, nodal_diameters=np.where(other.nodal_diameters == 7, 9, other.nodal_diameters))
    assert paired_rows(cf.correlation.pair(renamed, table)) != paired_rows(before)
    after = followed(before, casing_modes, renamed, table)
    assert paired_rows(after) == paired_rows(before)
    share = overlaps(casing_modes, renamed)
    for old, new in zip(before.matches, after.matches, strict=True):
        assert old.rows == new.rows
        assert share[np.ix_(old.modes, new.modes)].sum() > 0.9 * len(old.modes)


def test_two_modes_that_cross_swap_their_places():
    narrow, wide = cf.modes(plate(0.05), 6), cf.modes(plate(0.08), 6)
    swapped = np.argsort(-overlaps(narrow, wide), axis=1)[:, 0]
    assert swapped[1] == 2  # the case is what it is meant to be
    assert swapped[2] == 1
    table = table_of(narrow, 4, labels=False)
    before = cf.correlation.pair(narrow, table)
    after = followed(before, narrow, wide, table)
    assert [match.modes for match in before.matches] == [(0,), (1,), (2,), (3,)]
    assert {match.rows[0]: match.modes[0] for match in after.matches}[1] == 2
    assert {match.rows[0]: match.modes[0] for match in after.matches}[2] == 1
    assert after.unpaired_modes == (3, 5)


def test_a_doublet_that_turns_stays_one(casing_modes):
    """Turned by 30 degrees every doublet has other members, but not another plane."""
    table = table_of(casing_modes, 8)
    before = cf.correlation.pair(casing_modes, table)
    turned = casing_modes.fields.copy()
    c, s = np.cos(0.5), np.sin(0.5)
    for low, high in casing_modes.doublets:
        turned[:, :, [low, high]] = turned[:, :, [low, high]] @ np.array([[c, -s], [s, c]])
    after = followed(before, casing_modes, replace(casing_modes, fields=turned), table)
    assert [match.modes for match in after.matches] == [match.modes for match in before.matches]


def test_a_mode_that_is_gone_is_named(casing_modes):
    table = table_of(casing_modes, 8)
    before = cf.correlation.pair(casing_modes, table)
    fewer = cf.modes(mixed_casing(), 4)
    with pytest.raises(LostModeError, match="of their mode is found again") as caught:
        followed(before, casing_modes, fewer, table)
    assert caught.value.rows in paired_rows(before)
