"""Patches of bolts on their own: moments of their density, cuts at elements, numbers by name, the model of an edge."""

import numpy as np
import pytest

import casingfem as cf

TURN = 2.0 * np.pi


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("first", [0.1, -1.2, 9.0])
def test_a_patch_has_the_moments_of_its_density(closed, first):
    """15/(8 w) (1 - xi^2)^2 has the moments 1, 0, 1/7 and 1/21 in xi^0, xi, xi^2 and xi^4, however it is cut."""
    bolts = cf.Bolts(count=3, k=1.0, first_angle=first, width=0.8)
    places, weights, bolt = bolts.points(np.linspace(0.0, TURN, 10), closed, 6)
    for b, angle in enumerate((first, first + TURN / 3, first + 2 * TURN / 3)):
        here = bolt == b
        xi = (places[here] - angle) / 0.4
        assert np.abs(xi).max() < 1.0
        found = [weights[here] @ xi**k for k in (0, 1, 2, 4)]
        np.testing.assert_allclose(found, [1.0, 0.0, 1 / 7, 1 / 21], atol=1e-13)


def test_patches_are_cut_where_elements_end():
    """Elements of 0.5 rad from 0.2 on: the patch from 0.55 to 1.35 is cut at 0.7 and 1.2, that a turn on as well."""
    breaks = np.append(0.2 + 0.5 * np.arange(12), 0.2 + TURN)
    for turn, closed in ((0, True), (1, True), (-2, True), (0, False)):
        bolts = cf.Bolts(count=1, k=1.0, first_angle=0.95 + TURN * turn, width=0.8)
        places, _, bolt = bolts.points(breaks, closed, 4)
        assert places.size == 12
        assert bolt.tolist() == [0] * 12
        cells = np.searchsorted([0.7, 1.2], places - TURN * turn)
        assert cells.tolist() == [0] * 4 + [1] * 4 + [2] * 4
    across = cf.Bolts(count=1, k=1.0, first_angle=0.2, width=0.8).points(breaks, True, 4)[0]
    assert np.searchsorted([0.2], across).tolist() == [0] * 4 + [1] * 4  # the seam; the last element ends there


def test_numbers_of_bolts():
    bolts = cf.Bolts(count=4, k=(1.0, 4.0, 2.0), k_rot=3.0, loose={2: 0.5})
    assert [bolts.number(p) for p in (("k",), ("k_rot",), ("bolts", "2", "k"), ("bolts", "4", "k"))] == [
        4.0,
        3.0,
        2.0,
        4.0,
    ]
    assert bolts.with_number(("k_rot",), 5.0).k_rot == 5.0
    assert bolts.with_number(("bolts", "1", "k"), 1.0).loose == {1: 0.25, 2: 0.5}
    half = bolts.with_number(("k",), 2.0)
    assert (half.k, half.loose) == ((0.5, 2.0, 1.0), {2: 1.0})
    for path in (("bolts", "0", "k"), ("bolts", "5", "k"), ("bolts", "-1", "k"), ("bolts", "2"), ("k_z",)):
        with pytest.raises(KeyError, match=r"bolts are k, k_rot and bolts\.1\.k to bolts\.4\.k'"):
            bolts.number(path)


def test_bolts_repeat_as_their_factors_do():
    """Of twelve, every third or fourth loose; bolts 1 to 12 are counted from the first."""
    for loose, period in (({}, 12), ((1, 4, 7, 10), 4), ((2, 6, 10), 3), ((1, 7), 2), ((1, 2), 1), ((12,), 1)):
        bolts = cf.Bolts(count=12, k=1.0, loose=dict.fromkeys(loose, 0.5))
        assert bolts.period == period
        assert np.flatnonzero(bolts.factors < 1.0).tolist() == [b - 1 for b in sorted(loose)]
    assert bolts.angles.tolist() == pytest.approx([TURN * k / 12 for k in range(12)])
    assert (bolts.pitch, bolts.patch) == (pytest.approx(TURN / 12), pytest.approx(TURN / 36))
    spaced = cf.Bolts(count=3, k=1.0, spacing=0.3, first_angle=-0.2)
    assert (spaced.angles.tolist(), spaced.patch) == (pytest.approx([-0.2, 0.1, 0.4]), pytest.approx(0.1))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"count": 1000}, ""), ({"count": 1001}, "between 1 and 1000"), ({"count": 1}, ""), ({"count": 0}, "between"),
        ({"count": 2.0}, "between 1 and 1000, found 2.0"), ({"k": (1.0, 2.0)}, "one number or three"),
        ({"k": 0.0, "k_rot": 1.0}, ""), ({"k": (0.0, 0.0, 1.0)}, ""), ({"loose": {8: 0.0}}, ""),
        ({"loose": {9: 1.0}}, r"bolts\.loose: found bolt 9, expected 1 to 8"), ({"loose": {0: 1.0}}, "found bolt 0"),
        ({"width": TURN / 8}, ""), ({"width": TURN / 8 * (1 + 1e-9)}, "overlap"), ({"width": 0.0}, "positive and fin"),
        ({"spacing": TURN / 8, "width": 0.1}, ""), ({"spacing": np.nan}, "positive and finite"),
        ({"k": (1.0, -1e-9, 1.0)}, "must be finite and not negative"), ({"k_rot": np.inf}, "must be finite and"),
        ({"loose": {1: -0.1}}, "must be finite and not negative"), ({"k": 0.0}, "found k = 0 and k_rot = 0"),
        ({"first_angle": np.inf}, "first_angle must be finite"), ({"spacing": TURN / 6.99}, "more than one full"),
    ],
)  # fmt: skip
def test_bolts_at_their_bounds(given, words):
    given = {"count": 8, "k": 1.0} | given
    if words:
        with pytest.raises(ValueError, match=words):
            cf.Bolts(**given)
    else:
        cf.Bolts(**given)


@pytest.mark.parametrize(("span", "off"), [((0.0, 1.0), False), ((1e-9, 1.0), True), ((0.0, 1.0 - 1e-9), True)])
def test_a_patch_lies_on_an_open_edge(span, off):
    wide = cf.Bolts(count=1, k=1.0, first_angle=0.5, width=1.0)
    wide.require_on(span, True, "base")
    if off:
        with pytest.raises(
            ValueError,
            match=r"support\.tip: found patches from 0 to 1 rad .* on the edge, from",
        ):
            wide.require_on(span, False, "tip")
    else:
        wide.require_on(span, False, "tip")
