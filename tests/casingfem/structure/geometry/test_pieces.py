"""Meridians of several pieces: lines, arcs and fillets in the plane; the shells on them."""

import numpy as np
import pytest

import casingfem as cf
from reports.verification.modes.meridians import CASINGS, chart_shell, sector, stations

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
CONE = (cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.25, 0.2)))


def meridian(*pieces, start=(0.3, 0.0), fillet=0.01):
    return cf.geometry.PiecewiseMeridian(start=start, pieces=pieces or CONE, fillet=fillet)


def shell(profile, **given):
    parts = {"thickness": 8e-3, "material": STEEL, "supports": {"base": cf.Clamped()}}
    return cf.Shell(chart=cf.Revolved(profile=profile), **{**parts, **given})


SHAPES = {
    "cone": meridian(),
    "right angle in": meridian(cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.2, 0.1))),
    "right angle out": meridian(cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.4, 0.1))),
    "arc to the left": meridian(
        cf.geometry.Piece(to=(0.3, 0.1)),
        cf.geometry.Piece(to=(0.2, 0.18), radius=0.15),
        cf.geometry.Piece(to=(0.1, 0.4)),
    ),
    "arc to the right": meridian(
        cf.geometry.Piece(to=(0.3, 0.1)),
        cf.geometry.Piece(to=(0.4, 0.2), radius=-0.12),
        cf.geometry.Piece(to=(0.4, 0.3)),
    ),
    "two arcs": meridian(cf.geometry.Piece(to=(0.35, 0.1), radius=0.2), cf.geometry.Piece(to=(0.3, 0.2), radius=-0.1)),
    "back": meridian(
        cf.geometry.Piece(to=(0.3, 0.1)),
        cf.geometry.Piece(to=(0.35, 0.05)),
        cf.geometry.Piece(to=(0.4, 0.2)),
        fillet=0.006,
    ),
}


@pytest.mark.parametrize("profile", SHAPES.values(), ids=SHAPES)
def test_pieces_and_fillets_make_one_smooth_line_of_unit_speed(profile):
    s = np.linspace(0.0, profile.length, 20_001)
    at, h = profile.at(s), profile.length / 20_000
    np.testing.assert_allclose(at.r1**2 + at.z1**2, 1.0, rtol=1e-12)
    assert np.hypot(np.diff(at.r), np.diff(at.z)).max() < h * (1.0 + 1e-9)
    assert np.hypot(np.diff(at.r1), np.diff(at.z1)).max() < h / 0.005  # no kink is left: no bend is sharper
    for line in profile.lines[1:-1]:
        np.testing.assert_allclose(
            np.stack(profile.at(np.array(line - 1e-12))[::3] + profile.at(np.array(line - 1e-12))[1::3]),
            np.stack(profile.at(np.array(line + 1e-12))[::3] + profile.at(np.array(line + 1e-12))[1::3]),
            atol=1e-9,
        )
    inside = np.setdiff1d(np.arange(50, 19_950, 97), np.searchsorted(s, profile.lines))
    for value, slope, bend in ((at.r, at.r1, at.r2), (at.z, at.z1, at.z2)):
        step = np.array([profile.lines.searchsorted(s[inside - 2]), profile.lines.searchsorted(s[inside + 2])])
        k = inside[step[0] == step[1]]
        np.testing.assert_allclose((value[k + 1] - value[k - 1]) / (2.0 * h), slope[k], atol=1e-6)
        np.testing.assert_allclose((slope[k + 1] - slope[k - 1]) / (2.0 * h), bend[k], atol=1e-5 * 200.0)


def test_a_fillet_touches_both_pieces_at_its_radius():
    """A right angle: from the ends of the fillet to the corner is its radius, and it is a quarter turn."""
    profile = SHAPES["right angle in"]
    assert np.diff(profile.lines) == pytest.approx([0.09, 0.01 * np.pi / 2.0, 0.09])
    assert profile.owners[0][1] == pytest.approx(0.09 + 0.005 * np.pi / 2.0)
    ends = profile.at(profile.lines)
    assert (ends.r[1], ends.z[1]) == pytest.approx((0.3, 0.09))
    assert (ends.r[2], ends.z[2]) == pytest.approx((0.29, 0.1))


def test_an_arc_passes_through_its_ends_at_its_radius():
    """A quarter circle about (0.2, 0.0) from (0.3, 0.0) to (0.2, 0.1) needs no fillet behind a cylinder."""
    profile = cf.geometry.PiecewiseMeridian(
        start=(0.3, -0.1),
        pieces=(
            cf.geometry.Piece(to=(0.3, 0.0)),
            cf.geometry.Piece(to=(0.2, 0.1), radius=0.1),
            cf.geometry.Piece(to=(0.1, 0.1)),
        ),
    )
    at = profile.at(np.linspace(0.1, 0.1 + 0.05 * np.pi, 9))
    np.testing.assert_allclose(np.hypot(at.r - 0.2, at.z), 0.1, rtol=1e-12)
    assert len(profile.bends) == 3


@pytest.mark.parametrize(
    ("pieces", "given", "words"),
    [
        (CONE, {"fillet": None}, r"piece\[2\].fillet: found none at a corner of 26.6 degrees"),
        (CONE, {"fillet": 1.0}, r"chart\.piece\[2\]\.fillet: found 1 m, expected"),
        (
            (cf.geometry.Piece(to=(0.3, 0.0)),),
            {},
            r"chart\.piece\[1\]: found a piece of length 0 at \[r, z\] = \[0\.3, 0\.0\] m",
        ),
        (
            (cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.3, 0.1))),
            {},
            r"chart\.piece\[2\]: found a piece of length 0 at \[r, z\] = \[0\.3, 0\.1\] m",
        ),
        (
            (cf.geometry.Piece(to=(0.2, 0.0), radius=0.04),),
            {},
            r"chart\.piece\[1\]\.radius: found 0\.04 m for an arc whose ends are 0\.1 m",
        ),
        ((cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.3, 0.0))), {}, "at a corner of 180 degrees"),
        (
            (cf.geometry.Piece(to=(0.4, 0.0)), cf.geometry.Piece(to=(0.4, 0.02)), cf.geometry.Piece(to=(0.5, 0.02))),
            {"fillet": 0.015},
            "longer than the piece of 0.02 m",
        ),
    ],
)
def test_pieces_that_do_not_join_are_named(pieces, given, words):
    with pytest.raises(cf.errors.ModelError, match=words):
        meridian(*pieces, **given)


def test_a_meridian_that_reaches_the_axis_is_refused():
    with pytest.raises(cf.errors.ModelError, match="meridian-axis"):
        meridian(cf.geometry.Piece(to=(0.0, 0.1)))
    assert meridian(cf.geometry.Piece(to=(1e-5, 0.1))).at(np.array([0.0, 1e9])).r.min() < 1e-4


@pytest.mark.parametrize("fillet", [1e-6, 3.9e-3])
def test_a_fillet_too_short_for_the_wall_is_refused_however_short_it_is(fillet):
    with pytest.raises(cf.errors.ModelError, match=r"times the radius of curvature of a bend.*shell-thickness-size"):
        shell(meridian(fillet=fillet))


def test_a_fillet_of_half_the_wall_is_the_shortest():
    assert shell(meridian(fillet=4e-3)).thickness == 8e-3


@pytest.mark.slow
def test_pieces_in_line_are_the_frustum():
    """No corner, no fillet: two pieces of one cone are the frustum's chart."""
    mesh = cf.ShellMesh(order=7, rows=(0.0, 0.4, 1.0), around=21)
    parts = {"thickness": 8e-3, "material": STEEL, "supports": {"base": cf.Clamped()}, "mesh": mesh}
    whole = cf.Shell(chart=cf.Frustum(r_base=0.3, r_top=0.25, height=0.2), **parts)
    cut = cf.geometry.PiecewiseMeridian(
        start=(0.3, 0.0), pieces=(cf.geometry.Piece(to=(0.28, 0.08)), cf.geometry.Piece(to=(0.25, 0.2)))
    )
    assert len(cut.bends) == 2
    np.testing.assert_allclose(cf.modes(shell(cut, mesh=mesh), 4).freq, cf.modes(whole, 4).freq, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*mesh-(kink|aspect)")
def test_a_corner_is_that_of_imported_quadrilaterals():
    pieces, walls = CASINGS["the same, cone of 5 mm"]
    casing = chart_shell(pieces, walls, 5e-3)
    own = cf.modes(casing, 8)
    quads = sector(casing, rows=stations(casing, 0.006, 8), sectors=60, solid=False)
    theirs = cf.modal.cyclic_modes(quads, 1, diameters=(3, 4))
    for n, freq in zip((3, 4), theirs.freq, strict=True):
        assert own.freq[own.nodal_diameters == n][0] == pytest.approx(freq, rel=3e-4)


@pytest.mark.slow
def test_the_harmonic_path_is_the_shell_and_a_corner_hardly_asks_how_round_it_is():
    casing = shell(meridian(fillet=8e-3), mesh=cf.ShellMesh(order=6, rows=(0.0, *corner_lines(8e-3), 1.0), around=9))
    np.testing.assert_allclose(cf.modes(casing, 5).freq, cf.modes(casing, 5, method="shell").freq, rtol=2e-3)
    sharper, rounder = (cf.modes(shell(meridian(fillet=fillet)), 8).freq for fillet in (4e-3, 8e-3))
    np.testing.assert_allclose(sharper, rounder, rtol=2e-3)


def corner_lines(fillet):
    lines = meridian(fillet=fillet).lines
    return (lines[1:-1] / lines[-1]).tolist()


def test_element_lines_are_where_pieces_meet():
    casing = shell(meridian(), strips=(cf.Strip(start=meridian().owners[1][0], end=meridian().length, thickness=5e-3),))
    lines = casing.mesh.breaks * meridian().length
    for line in (*meridian().lines, meridian().owners[1][0]):
        assert np.abs(lines - line).min() < 1e-9
    with pytest.raises(cf.errors.ModelError, match="meridian-off-line"):
        shell(meridian(), mesh=cf.ShellMesh(order=6, rows=3, around=9))
