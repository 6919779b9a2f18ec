"""A user's chart whose parameters begin anywhere, or whose lines are askew, is the shell of the plain chart."""

from dataclasses import dataclass

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.geometry.chart_checks import check_chart, check_symmetry
from casingfem.structure.geometry.rotation import blade_frame
from casingfem.structure.geometry.strip import breaks_between
from casingfem.structure.geometry.survey_check import mean_radius
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.parts import sampled_geometry
from casingfem.structure.shell.plausible import chart_warnings, extent, sampled, stretches
from casingfem.structure.shell.shell import require_shell
from casingfem.structure.shell.variation import harmonic_amplitudes

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BAR = cf.edge.Section.rectangle(width=0.01, depth=0.004)


@dataclass(frozen=True)
class Moved:
    """A chart with its first parameter `on` further and, of an open one, its second as well."""

    plain: object
    on: float = 2.0

    @property
    def across(self):
        return 0.0 if self.plain.periodic else self.on

    @property
    def bounds(self):
        (a0, a1), (b0, b1) = self.plain.bounds
        return (a0 + self.on, a1 + self.on), (b0 + self.across, b1 + self.across)

    @property
    def periodic(self):
        return self.plain.periodic

    @property
    def axisymmetric(self):
        return self.plain.axisymmetric

    @property
    def edges(self):
        return self.plain.edges

    def surface(self, a, b, defect):
        return self.plain.surface(np.asarray(a) - self.on, np.asarray(b) - self.across, defect)

    def directions(self, a, b):
        return self.plain.directions(np.asarray(a) - self.on, np.asarray(b) - self.across)


def both(plain, on=2.0, thickness=2e-3, stiffened=True, **parts):
    """Two shells, their strips and stiffeners where they belong."""
    shells = []
    for chart, start in ((plain, 0.0), (Moved(plain, on), on)):
        strips = (cf.Strip(start=start, end=start + 0.05, thickness=4e-3),)
        rings = (cf.edge.Stiffener(at=start + 0.2, section=BAR, offset=(0.006, 0.0)),) if stiffened else ()
        given = {"supports": {}, "strips": strips, "stiffeners": rings} | parts
        shells.append(cf.Shell(chart=chart, thickness=thickness, material=STEEL, **given))
    return shells


def test_a_casing_that_begins_anywhere_has_the_same_mesh_and_sizes():
    plain, moved = both(cf.Cylinder(radius=0.5, height=0.3), taper=cf.Taper(along=(1.0, 0.6)))
    assert (moved.mesh.order, moved.mesh.around) == (plain.mesh.order, plain.mesh.around)
    np.testing.assert_allclose(moved.mesh.rows, plain.mesh.rows, rtol=1e-12)
    np.testing.assert_allclose(stretches(moved), stretches(plain) + 2.0, rtol=1e-13)
    one, other = extent(plain), extent(moved)
    for part in ("diagonal", "sides", "curvature", "thickness"):
        np.testing.assert_allclose(getattr(other, part), getattr(one, part), rtol=1e-9)
    one, other = sampled_geometry(plain, 5), sampled_geometry(moved, 5)
    np.testing.assert_allclose(other.surface.x, one.surface.x, atol=1e-12)
    np.testing.assert_allclose(other.thickness, one.thickness, rtol=1e-12)
    assert mean_radius(moved.chart) == pytest.approx(0.5)
    assert moved.thinnest == plain.thinnest == pytest.approx(1.2e-3)


@pytest.mark.parametrize("n", [0, 2])
def test_its_harmonics_are_the_same(n):
    mesh = cf.ShellMesh(order=3, rows=(0.0, 1 / 6, 2 / 3, 1.0), around=9)
    held = {"base": cf.Clamped(), "top": cf.ElasticEdge(k_r=1e9)}
    plain, moved = (
        harmonic_matrices(s, n) for s in both(cf.Cylinder(radius=0.5, height=0.3), mesh=mesh, supports=held)
    )
    np.testing.assert_allclose(moved.z, plain.z + 2.0, rtol=1e-13)
    np.testing.assert_allclose(moved.K, plain.K, atol=1e-9 * np.abs(plain.K).max())
    np.testing.assert_allclose(moved.mass, plain.mass, rtol=1e-9)


def test_its_fields_are_taken_where_it_lies():
    plain, moved = both(cf.Cylinder(radius=0.5, height=0.3))
    rising = {at: cf.FourierField(p=[3], cos=[[0.0, 0.1]], sin=[[0.0, 0.0]], z_mid=at, z_half=0.3) for at in (0.0, 2.0)}
    found = harmonic_amplitudes(plain, rising[0.0]), harmonic_amplitudes(moved, rising[2.0])
    np.testing.assert_allclose(found[1], found[0], atol=1e-11)
    for shell, at in ((plain, 0.0), (moved, 2.0)):
        field = cf.FourierField(p=[0], cos=[[0.0, -0.92]], sin=[[0.0, 0.0]], z_mid=at, z_half=0.3)
        with pytest.raises(ValueError, match=r"the field reaches -0\.92, it may run"):
            cf.Shell(chart=shell.chart, thickness=1e-3, material=STEEL, modulus_defect=field)
        edge = cf.ElasticEdge(
            k_r=1e6, around=cf.FourierField(p=[0], cos=[[0.0, -1.1]], sin=[[0.0] * 2], z_mid=at, z_half=0.3)
        )
        cf.Shell(chart=shell.chart, thickness=1e-3, material=STEEL, supports={"base": edge})
        with pytest.raises(ValueError, match=r"support\.top\.around.*makes k_r negative \(factor -0\.1\)"):
            cf.Shell(chart=shell.chart, thickness=1e-3, material=STEEL, supports={"top": edge})
    half = cf.FourierField(p=[0], cos=[[0.0, 0.4]], sin=[[0.0, 0.0]], z_mid=2.0, z_half=0.3)
    waving = cf.Shell(chart=moved.chart, thickness=1e-3, material=STEEL, radius_defect=half)
    assert [words for _, words in chart_warnings(waving)] == ["radius_defect reaches 0.4 of the radius"]


def test_a_plate_that_begins_anywhere_has_the_same_mesh_and_frame():
    plain, moved = both(cf.Plate(length=0.5, width=0.2), stiffened=False)
    assert (moved.mesh.order, moved.mesh.around) == (plain.mesh.order, plain.mesh.around) == (8, 2)
    np.testing.assert_allclose(moved.mesh.rows, plain.mesh.rows, rtol=1e-12)
    np.testing.assert_allclose(blade_frame(moved.chart), blade_frame(plain.chart), atol=1e-14)
    check_chart(moved.chart)
    for edge in moved.chart.edges:
        check_symmetry(moved.chart, edge)
    taper = cf.Taper(across=(1.0, 0.5))
    at = np.array([2.1]), np.array([2.05])
    assert taper.factor(moved.chart.bounds, *at) == pytest.approx(0.625, rel=1e-12)
    twisted = cf.TwistedPlate(length=0.5, width=0.2, twist=1.0)
    check_chart(Moved(twisted))
    for chart in (twisted, Moved(twisted)):
        for edge, lean in (("root", r"0\.39"), ("left", r"0\.84")):
            with pytest.raises(ValueError, match=f"directions across this edge differ by {lean} rad"):
                check_symmetry(chart, edge)
        with pytest.raises(ValueError, match="directions across this edge differ"):
            cf.Shell(chart=chart, thickness=1e-3, material=STEEL, supports={"right": cf.edge.Symmetry()})


def test_slack_is_a_part_of_the_length_wherever_it_begins():
    """A billionth of 0.3 m, of a casing that begins at 1000 m: a line 1e-6 m beside a strip's end is off."""
    chart = Moved(cf.Cylinder(radius=0.5, height=0.3), on=1000.0)
    strips = (cf.Strip(start=1000.1, end=1000.2, thickness=4e-3),)
    assert breaks_between(strips, chart.bounds[0]) == pytest.approx([0.0, 1 / 3, 2 / 3, 1.0])
    ring = cf.edge.Stiffener(at=1000.2, section=BAR, offset=(0.006, 0.0))
    for parts, words in (
        ({"strips": strips}, r"no element line at 1000\.2 m"),
        ({"stiffeners": (ring,)}, "1000.2 m, stiffener 1"),
    ):
        given = {"chart": chart, "thickness": 2e-3, "material": STEEL} | parts
        cf.Shell(**given, mesh=cf.ShellMesh(order=2, rows=(0.0, 1 / 3, 2 / 3, 1.0), around=9))
        with pytest.raises(ValueError, match=words):
            cf.Shell(**given, mesh=cf.ShellMesh(order=2, rows=(0.0, 1 / 3, 2 / 3 + 1e-6, 1.0), around=9))


@dataclass(frozen=True)
class Skew(Moved):
    """The lines of the second parameter run on by 0.3 of it along the first."""

    on: float = 0.0

    def surface(self, a, b, defect):
        s = self.plain.surface(np.asarray(a) + 0.3 * np.asarray(b), b, defect)
        x12 = 0.3 * s.x11 + s.x12
        return cf.geometry.Surface(s.x, s.x1, 0.3 * s.x1 + s.x2, s.x11, x12, 0.09 * s.x11 + 0.6 * s.x12 + s.x22)


def test_curvatures_do_not_know_the_lines():
    """Of a helicoid with 5 rad/m: -+ 5/(1 + (5 y)^2)."""
    twisted = Skew(cf.TwistedPlate(length=0.3, width=0.2, twist=1.5))
    check_chart(twisted)
    found = sampled(cf.Shell(chart=twisted, thickness=1e-3, material=STEEL), np.array([0.1, 0.2]), 3)
    assert found.curvature == pytest.approx([4.0, 5.0, 4.0] * 2, rel=1e-11)


def test_what_has_no_chart_is_told():
    require_shell(both(cf.Plate(length=0.5, width=0.2), stiffened=False)[0], "modes")
    with pytest.raises(ValueError, match="modes: found float, which has no chart"):
        require_shell(3.0, "modes")
