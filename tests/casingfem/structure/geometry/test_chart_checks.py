"""What charts, strips, stations, tapers and axes are asked, at their bounds; rigid motions of any body."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.geometry.chart import require_positive
from casingfem.structure.geometry.chart_checks import check_chart, check_symmetry, real
from casingfem.structure.geometry.revolved import chart_lines
from casingfem.structure.geometry.stations import along, coefficients, lowest, stations
from casingfem.structure.geometry.strip import breaks_between, check_strips, spread
from casingfem.structure.geometry.survey_check import mean_radius

TUBE = cf.Cylinder(radius=0.4, height=0.6)


def made(surface, chart=TUBE, **changes):
    """A chart with another surface."""
    given = {"bounds": chart.bounds, "edges": chart.edges, "periodic": chart.periodic, "surface": surface}
    return SimpleNamespace(**given | changes)


# of the tube: the largest coordinates are 0.4, 0.4 and 0.6 m, those of its derivatives x1 1, x2 and x22 0.4
SCALES = {
    "x1": ("x", 0.6 / 0.6 + 1.0),
    "x2": ("x", 0.6 / (2.0 * np.pi) + 0.4),
    "x11": ("x1", 1.0 / 0.6),
    "x12": ("x1", 1.0 / (2.0 * np.pi)),  # as the derivative of x2 it may be off by more
    "x22": ("x2", 0.4 / (2.0 * np.pi) + 0.4),
}


@pytest.mark.parametrize("name", SCALES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_derivative_may_be_off_by_a_ten_thousandth(name, sign):
    source, scale = SCALES[name]

    def off(part):
        def surface(a, b, defect):
            whole = TUBE.surface(a, b, defect)
            shift = sign * part * 1e-4 * scale * np.array([[0.0], [0.0], [1.0]])
            return whole._replace(**{name: getattr(whole, name) + shift})

        return made(surface)

    check_chart(off(0.98))
    with pytest.raises(ValueError, match=rf"the chart's {name} is not the derivative of its {source} \(0\.0% off\)"):
        check_chart(off(1.02))


def test_a_wrong_sign_is_told_in_per_cent():
    def surface(a, b, defect):
        whole = TUBE.surface(a, b, defect)
        return whole._replace(x22=-whole.x22)

    with pytest.raises(ValueError, match=r"x22 is not the derivative of its x2 \(172\.5% off\)"):  # 0.8/(0.4637)
        check_chart(made(surface))


@pytest.mark.parametrize("edge", [(0, 2), (2, 0), (1, -1)])
def test_edges_are_ends_of_parameters(edge):
    check_chart(made(TUBE.surface, edges={"base": [1, 1]}))
    with pytest.raises(ValueError, match=rf"chart.edges: 'base' is \({edge[0]}, {edge[1]}\)"):
        check_chart(made(TUBE.surface, edges={"base": edge}))


@pytest.mark.parametrize(("power", "folded"), [(1e-8, False), (1e-10, True)])
def test_a_chart_may_not_fold(power, folded):
    """A sector of a disk, its inner radius a small part of the outer one."""
    disk = cf.geometry.RevolvedPanel(profile=SimpleNamespace(length=1.0, at=lambda s: flat(s, power)), angle=1.0)
    if folded:
        with pytest.raises(ValueError, match=r"the chart's tangents span no plane at \(0, "):
            check_chart(disk)
    else:
        check_chart(disk)


def flat(s, inner):
    zero, one = 0.0 * s, 0.0 * s + 1.0
    return SimpleNamespace(r=s + inner, r1=one, r2=zero, z=zero, z1=zero, z2=zero)


def test_a_complex_step_is_left_out():
    surface = real(cf.Cylinder(radius=0.4 + 1e-20j, height=0.6).surface(np.array([0.1]), np.array([0.2]), None))
    assert {part.dtype for part in surface} == {np.dtype(float)}
    check_chart(cf.Cylinder(radius=0.4 + 1e-20j, height=0.6))


@pytest.mark.parametrize(("slope", "slanted"), [(0.49e-6, False), (0.51e-6, True)])
@pytest.mark.parametrize("edge", ["base", "top"])
def test_a_symmetric_rim_meets_its_plane_at_a_right_angle(slope, slanted, edge):
    """Across opposite ends of a cone's rim the directions differ by twice its slope."""
    cone = cf.Frustum(r_base=0.5, r_top=0.5 - 0.25 * slope, height=0.25)
    if slanted:
        with pytest.raises(ValueError, match=rf"support\.{edge}: directions across this edge differ by 1e-06 rad"):
            check_symmetry(cone, edge)
    else:
        check_symmetry(cone, edge)


def test_straight_and_twisted_sides_as_planes_of_symmetry():
    for edge in ("left", "right", "root", "tip"):
        check_symmetry(cf.Panel(radius=0.4, length=0.3, angle=1.0), edge)
        check_symmetry(cf.Plate(length=0.3, width=0.1), edge)
    swept = cf.Blade(length=0.3, chord=0.1, sweep=(0.0, 0.05, 0.0))
    for edge, slanted in (("left", True), ("right", True), ("root", False)):
        if slanted:
            with pytest.raises(ValueError, match="differ by"):
                check_symmetry(swept, edge)
        else:
            check_symmetry(swept, edge)
    twisted = cf.TwistedPlate(length=0.3, width=0.1, twist=1.0)
    with pytest.raises(ValueError, match=r"support\.tip: directions"):
        check_symmetry(twisted, "tip")


@pytest.mark.parametrize("value", [0.0, -1.0, np.inf, np.nan])
def test_lengths_are_positive(value):
    require_positive("chart", radius=1e-300 + 1j)
    with pytest.raises(ValueError, match=r"chart\.radius must be positive and finite.*chart-dimension"):
        require_positive("chart", radius=value)


def test_a_strip_covers_its_ends():
    strip = cf.Strip(start=1.0, end=3.0, thickness=2e-3)
    at = np.array([1.0 - 3e-9, 1.0 - 1e-9, 2.0, 3.0 + 1e-9, 3.0 + 3e-9])
    assert strip.covers(at).tolist() == [False, True, True, True, False]
    assert spread([strip], at, 5.0, [7.0]).tolist() == [5.0, 7.0, 7.0, 7.0, 5.0]
    with pytest.raises(ValueError, match=r"strip: found start 1\.0, end 1\.0"):
        cf.Strip(start=1.0, end=1.0, thickness=2e-3)


@pytest.mark.parametrize(
    ("ends", "words"),
    [
        ([(1.0, 2.0), (2.0, 3.0)], ""),
        ([(2.0, 3.0), (1.0, 2.0)], ""),
        ([(1.0, 2.0 + 2e-9), (2.0, 3.0)], ""),  # of 4 m
        ([(2.0 - 6e-9, 3.0), (1.0, 2.0)], r"strip\[1\] from 2 to 3 m overlaps strip\[2\]"),
        ([(1.0, 5.0 + 2e-9)], ""),
        ([(2.0, 5.0 + 6e-9)], r"strip\[1\] from 2 to 5 m leaves the shell, 1 to 5 m"),
        ([(1.0 - 2e-9, 2.0)], ""),
        ([(1.0 - 6e-9, 2.0)], "leaves the shell"),
        ([(1.0, 2.0 + 5e-9)], r"strip\[1\] from 1 to 2 m: no element line at 2 m"),
        ([(1.0 + 5e-9, 2.0)], r"strip\[1\] from 1 to 2 m: no element line at 1 m"),
    ],
)  # fmt: skip
def test_strips_lie_in_the_shell_side_by_side_on_lines(ends, words):
    strips = [cf.Strip(start=low, end=high, thickness=2e-3) for low, high in ends]
    lines = np.array([1.0, 2.0, 3.0, 5.0])
    if words:
        with pytest.raises(ValueError, match=words):
            check_strips(strips, (1.0, 5.0), lines)
        if "line" in words:
            check_strips(strips, (1.0, 5.0), None)
    else:
        check_strips(strips, (1.0, 5.0), lines)


def test_breaks_are_parts_of_the_length_each_once():
    strips = [cf.Strip(start=3.0, end=5.0, thickness=2e-3), cf.Strip(start=1.0, end=2.0, thickness=2e-3)]
    assert breaks_between(strips, (1.0, 5.0)) == [0.0, 0.25, 0.5, 1.0]
    assert breaks_between(strips, (1.0, 5.0), [4.0, 3.0 + 3e-9]) == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert len(breaks_between(strips, (1.0, 5.0), [3.0 + 6e-9, 1.0 + 2e-9, 5.0 - 2e-9])) == 5
    assert len(breaks_between(strips, (1.0, 5.0), [1.0 + 6e-9, 5.0 - 6e-9])) == 6


def test_laws_pass_through_their_stations():
    law = (2.0, -1.0, 0.5, 3.0)
    np.testing.assert_allclose(along(law, np.linspace(0.0, 1.0, 4)), law, rtol=1e-13)
    assert coefficients(7.0).tolist() == [7.0]
    assert along(7.0, np.array([0.2, 0.9])).tolist() == [7.0, 7.0]
    assert lowest((1.0, 0.0, 2.0)) == pytest.approx(-0.0416, abs=1e-4)  # 1 - 5 xi + 6 xi^2
    assert stations("law", np.array([1.0, 2.0])) == (1.0, 2.0)
    assert stations("law", 3) == 3
    stations("law", [1.0] * 8)
    for law in ([1.0] * 9, [], [[1.0, 2.0]], "no law", True):
        with pytest.raises(ValueError, match="law: found"):
            stations("law", law)
    with pytest.raises(ValueError, match="which is not finite"):
        stations("law", [1.0, np.nan])


def test_a_taper_is_the_product_of_its_laws():
    taper = cf.Taper(along=(1.0, 0.5), across=(0.4, 1.0))
    found = taper.factor(((1.0, 3.0), (-1.0, 4.0)), np.array([1.5]), np.array([1.0]))
    assert found.tolist() == pytest.approx([0.875 * 0.64], rel=1e-14)
    assert taper.lowest == pytest.approx(0.2, rel=1e-14)
    assert (taper.even, cf.Taper(along=(1.0, 0.5)).even, cf.Taper(across=(1.0,)).even) == (False, True, True)
    with pytest.raises(ValueError, match=r"taper\.across falls to 0"):
        cf.Taper(across=(1.0, 0.0))


@pytest.mark.parametrize(("start", "end", "sense"), [(0.2, 1.1, 1.0), (1.1, 0.2, -1.0)])
def test_an_arc_either_way(start, end, sense):
    arc = cf.geometry.Arc(radius=0.5, start=start, end=end, r0=0.3, z0=-0.1)
    assert arc.length == pytest.approx(0.45, rel=1e-14)
    s, at = 0.2, arc.at(np.array(0.2))
    phi = start + sense * s / 0.5
    c, d = np.cos(phi), np.sin(phi)
    exact = [0.3 + 0.5 * c, -sense * d, -2.0 * c, -0.1 + 0.5 * d, sense * c, -2.0 * d]
    np.testing.assert_allclose([float(part) for part in at], exact, rtol=1e-14)
    panel = cf.geometry.RevolvedPanel(profile=arc, angle=1.5)
    assert panel.bounds == ((0.0, arc.length), (-0.75, 0.75))
    assert chart_lines(panel) == chart_lines(cf.Revolved(profile=arc)) == []
    with pytest.raises(ValueError, match="angle must be below 2 pi"):
        cf.geometry.RevolvedPanel(profile=arc, angle=2.0 * np.pi)
    assert mean_radius(panel) == pytest.approx(0.3 + 0.5 * np.cos(0.65), rel=1e-13)
    assert mean_radius(panel, s) == pytest.approx(0.3 + 0.5 * c, rel=1e-13)
