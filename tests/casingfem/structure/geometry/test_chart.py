"""Charts: exact derivatives by the complex step, and a user's own chart through the protocol."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.geometry.complex_step import assert_exact

CHARTS = {
    "frustum": cf.Frustum(r_base=0.5, r_top=0.45, height=0.25),
    "cylinder": cf.Cylinder(radius=0.4, height=0.6),
    "panel": cf.Panel(radius=0.6, length=0.3, angle=0.5),
    "plate": cf.Plate(length=0.3, width=0.2),
    "bowl": cf.Revolved(profile=cf.geometry.Arc(radius=0.4, start=-1.2, end=0.3, r0=0.05, z0=0.1)),
    "dome": cf.geometry.RevolvedPanel(profile=cf.geometry.Arc(radius=0.4, start=0.2, end=-1.2), angle=0.9),
}


class Wave:
    """f = .02 e^(2 z) cos 3 theta, analytic in both parameters."""

    def derivatives(self, z, theta):
        f, f_t = 0.02 * np.exp(2 * z) * np.cos(3 * theta), -0.06 * np.exp(2 * z) * np.sin(3 * theta)
        return cf.field.FieldValues(f, 2 * f, f_t, 4 * f, 2 * f_t, -9 * f)


@pytest.mark.parametrize("name", CHARTS)
def test_derivatives_equal_the_complex_step(name):
    assert_exact(CHARTS[name])


@pytest.mark.parametrize("name", ["frustum", "cylinder", "panel", "bowl", "dome"])
def test_derivatives_with_a_radius_field_equal_the_complex_step(name):
    assert_exact(CHARTS[name], Wave())


@pytest.mark.parametrize("name", ["frustum", "cylinder", "panel", "bowl", "dome"])
def test_derivatives_with_a_fourier_field_equal_central_differences(name):
    chart, h = CHARTS[name], 1e-5
    field = cf.FourierField(p=[2, 5], cos=[[0.01, 0.02], [0.0, 0.01]], sin=[[0.0, 0.01], [0.02, 0.0]], z_half=0.2)
    a, b = np.full(9, 0.1), np.linspace(-0.2, 0.2, 9)

    def at(a, b):
        return chart.surface(a, b, field.derivatives(a, b))

    here = at(a, b)
    differences = [(at(a + h, b), at(a - h, b)), (at(a, b + h), at(a, b - h))]
    for k, first in enumerate([("x1", "x11", "x12"), ("x2", "x12", "x22")]):
        plus, minus = differences[k]
        for name_exact, name_value in zip(first, ("x", "x1", "x2"), strict=True):
            numeric = (getattr(plus, name_value) - getattr(minus, name_value)) / (2 * h)
            np.testing.assert_allclose(getattr(here, name_exact), numeric, atol=1e-8)


RADII = {
    "quotients": lambda z: 0.5 / (1.0 + z / 0.8) - 0.1 * z / (2.0 - z),
    "powers": lambda z: 0.4 + z**2 / 3.0 - 0.1 * (1.0 + z) ** -1.5 + 0.2 * z**1 + z**3 + z**0,
    "negatives": lambda z: 1.0 - z - (-z) * 0.3,
    "functions": lambda z: 0.3 * cf.geometry.sqrt(1.0 + z * z) + 0.1 * cf.geometry.exp(-z),
}


@dataclass(frozen=True)
class Nozzle(cf.geometry.ClosedOfRevolution):
    """r(z) about z by a formula."""

    formula: str

    @property
    def bounds(self):
        return (0.0, 0.4), (0.0, 2.0 * np.pi)

    def surface(self, a, b, defect):
        z, theta = cf.geometry.jets(a, b)
        r = RADII[self.formula](z)
        return cf.geometry.surface(r * cf.geometry.cos(theta), r * cf.geometry.sin(theta), z)

    def directions(self, a, b):
        return cf.Frustum(r_base=0.5, r_top=0.45, height=0.4).directions(a, b)


@pytest.mark.parametrize("formula", RADII)
def test_derivatives_of_a_formula_equal_the_complex_step(formula):
    assert_exact(Nozzle(formula))


def test_radius_of_a_defective_casing_is_r0_times_one_plus_f():
    chart, field = CHARTS["frustum"], cf.FourierField.of({8: 0.01})
    z, theta = np.array([0.0, 0.1, 0.25]), np.array([0.0, 0.3, 1.0])
    x = chart.surface(z, theta, field.derivatives(z, theta)).x
    np.testing.assert_allclose(np.hypot(x[0], x[1]), chart.radius(z) * (1 + 0.01 * np.cos(8 * theta)), rtol=1e-14)


@pytest.mark.parametrize("name", CHARTS)
def test_spring_directions_are_orthonormal(name):
    chart = CHARTS[name]
    d = chart.directions(np.full(5, 0.1), np.linspace(-0.2, 0.2, 5))
    np.testing.assert_allclose(np.einsum("aip,bip->pab", d, d), np.tile(np.eye(3), (5, 1, 1)), atol=1e-15)


def test_a_plate_takes_no_radius_defect():
    with pytest.raises(ValueError, match="no radius"):
        CHARTS["plate"].surface(0.0, 0.0, cf.FourierField.of({2: 0.1}).derivatives(0.0, 0.0))


@pytest.mark.parametrize("name", CHARTS)
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_refuses_dimensions_that_are_not_positive(name, value):
    chart = CHARTS[name]
    for dimension in [name for name in chart.__dataclass_fields__ if name != "profile"]:
        with pytest.raises(ValueError, match=rf"chart\.{dimension} must be positive"):
            replace(chart, **{dimension: value})


def test_a_panel_must_stay_open():
    arc = cf.geometry.Arc(radius=0.4, start=0.2, end=-1.2)
    with pytest.raises(cf.errors.ModelError, match=r"chart\.angle must be below 2 pi, found 6\.2831"):
        cf.geometry.RevolvedPanel(profile=arc, angle=2.0 * np.pi)
    assert cf.geometry.RevolvedPanel(profile=arc, angle=6.283).angle == 6.283
    with pytest.raises(ValueError, match="closed casing use a Cylinder"):
        cf.Panel(radius=1.0, length=1.0, angle=2 * np.pi)


@dataclass(frozen=True)
class HelicalCylinder:
    """The same cylinder with lines that wind around it: parameters that are not orthogonal."""

    cylinder: cf.Cylinder
    winding: float

    @property
    def bounds(self):
        return self.cylinder.bounds

    @property
    def periodic(self):
        return True

    @property
    def axisymmetric(self):
        return False

    @property
    def edges(self):
        return self.cylinder.edges

    def surface(self, a, b, defect):
        k, s = self.winding, self.cylinder.surface(a, b + self.winding * a, None)
        x11 = s.x11 + 2 * k * s.x12 + k * k * s.x22
        return cf.geometry.Surface(s.x, s.x1 + k * s.x2, s.x2, x11, s.x12 + k * s.x22, s.x22)

    def directions(self, a, b):
        return self.cylinder.directions(a, b + self.winding * a)


@dataclass(frozen=True)
class Upturned:
    """A chart read from its other end: the normal turns over."""

    chart: cf.Cylinder

    @property
    def bounds(self):
        return self.chart.bounds

    @property
    def periodic(self):
        return True

    @property
    def axisymmetric(self):
        return False

    @property
    def edges(self):
        return {"base": (0, 1), "top": (0, 0)}

    def surface(self, a, b, defect):
        s = self.chart.surface(self.chart.height - a, b, None)
        return cf.geometry.Surface(s.x, -s.x1, s.x2, s.x11, -s.x12, s.x22)

    def directions(self, a, b):
        return self.chart.directions(self.chart.height - a, b)


def lowest_frequencies(chart, steel, supports, mesh):
    shell = cf.Shell(chart=chart, thickness=4e-3, material=steel, supports=supports, mesh=mesh)
    return cf.modes(shell, 8, method="shell").omega


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*support-incomplete")
@pytest.mark.parametrize(
    "supports", [{"base": cf.Clamped()}, {"base": cf.ShearDiaphragm(), "top": cf.ShearDiaphragm()}]
)
def test_a_chart_that_runs_the_other_way_gives_the_same_shell(steel, supports):
    cylinder, mesh = cf.Cylinder(radius=0.3, height=0.4), cf.ShellMesh(order=6, rows=1, around=7)
    assert isinstance(Upturned(cylinder), cf.geometry.Chart)
    expected = lowest_frequencies(cylinder, steel, supports, mesh)
    found = lowest_frequencies(Upturned(cylinder), steel, supports, mesh)
    # between diaphragms the casing may slide along its axis: one frequency is round-off about zero
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-2)


@pytest.mark.slow
def test_a_chart_whose_lines_are_not_orthogonal_gives_the_same_shell(steel):
    cylinder, mesh = cf.Cylinder(radius=0.3, height=0.4), cf.ShellMesh(order=8, rows=1, around=7)
    expected = lowest_frequencies(cylinder, steel, {"base": cf.Clamped()}, mesh)
    helical = HelicalCylinder(cylinder, winding=np.array(0.5))  # a chart with an array cannot be hashed
    assert isinstance(helical, cf.geometry.Chart)
    np.testing.assert_allclose(lowest_frequencies(helical, steel, {"base": cf.Clamped()}, mesh), expected, rtol=2e-4)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*support-incomplete")
def test_a_diaphragm_on_a_chart_whose_lines_are_not_orthogonal(steel):
    cylinder, mesh = cf.Cylinder(radius=0.3, height=0.4), cf.ShellMesh(order=8, rows=1, around=7)
    held = {"base": cf.ShearDiaphragm(), "top": cf.ShearDiaphragm()}
    found = lowest_frequencies(HelicalCylinder(cylinder, winding=0.5), steel, held, mesh)
    expected = lowest_frequencies(cylinder, steel, held, mesh)
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=1e-2)


def test_something_else_is_no_chart():
    assert not isinstance(object(), cf.geometry.Chart)
    assert all(isinstance(chart, cf.geometry.Chart) for chart in CHARTS.values())


class Faulty:
    """A cylinder with some attributes exchanged, and a change of its surface."""

    def __init__(self, change=lambda surface, a, b: surface, **other):
        self.inner, self.change = cf.Cylinder(radius=0.4, height=0.6), change
        for name in ("bounds", "edges", "periodic", "axisymmetric"):
            setattr(self, name, other.get(name, getattr(self.inner, name)))

    def surface(self, a, b, defect):
        return self.change(self.inner.surface(a, b, defect), a, b)

    def directions(self, a, b):
        return self.inner.directions(a, b)


@pytest.mark.parametrize(
    ("chart", "code", "words"),
    [
        (Faulty(bounds=((0.0, 0.0), (0.0, 2.0 * np.pi))), "chart-bounds", r"found \(\(0.0, 0.0\)"),
        (Faulty(bounds=((0.0, 0.6), (1.0, 1.0))), "chart-bounds", "chart.bounds: found"),
        (Faulty(bounds=((0.0, np.inf), (0.0, 2.0 * np.pi))), "chart-bounds", "inf"),
        (Faulty(bounds=((0.0, 0.6), (0.0, 6.0))), "chart-turn", "from 0 to 6 on a closed chart, expected a range of 2"),
        (Faulty(edges={"base": (0, 2)}), "chart-edge", r"'base' is \(0, 2\)"),
        (Faulty(lambda s, a, b: s._replace(x22=np.nan * s.x22)), "chart-not-finite", "not finite somewhere"),
        (Faulty(lambda s, a, b: s._replace(x2=0.0 * s.x2)), "chart-fold", r"parallel or zero at \(0, 0\)"),
        (Faulty(lambda s, a, b: s._replace(x1=2.0 * s.x1)), "chart-derivatives", r"x1 is not the derivative of its x"),
        (Faulty(lambda s, a, b: s._replace(x2=-s.x2)), "chart-derivatives", r"x2 is not the derivative of its x"),
        (
            Faulty(lambda s, a, b: s._replace(x11=s.x11 + 1.0)),
            "chart-derivatives",
            r"x11 is not the derivative of its x1",
        ),
        (
            Faulty(lambda s, a, b: s._replace(x12=s.x12 + 0.1)),
            "chart-derivatives",
            r"x12 is not the derivative of its x2",
        ),
        (Faulty(lambda s, a, b: s._replace(x22=-s.x22)), "chart-derivatives", r"x22 is not the derivative of its x2"),
        (
            Faulty(
                lambda s, a, b: s._replace(x=s.x + 0.1 * b * np.eye(3)[:, 2:], x2=s.x2 + 0.1 * np.eye(3)[:, 2:]),
                axisymmetric=False,
            ),
            "chart-open-seam",
            r"declared periodic, but its ends are 0\.628 m apart",
        ),
        (Faulty(periodic=False), "chart-axisymmetric", "periodic = False, expected both True"),
    ],
)
def test_a_users_chart_is_checked_for_bounds_edges_derivatives_and_its_seam(steel, chart, code, words):
    for size in (1e-5, 1.0, 1e5):  # of the area of the tangent plane, which does not show a fold
        cf.Shell(chart=cf.Cylinder(radius=size, height=3.0 * size), thickness=1e-3 * size, material=steel)
    cf.Shell(chart=Faulty(), thickness=2e-3, material=steel)
    with pytest.raises(cf.errors.ModelError, match=words) as refused:
        cf.Shell(chart=chart, thickness=2e-3, material=steel)
    assert code in str(refused.value)
