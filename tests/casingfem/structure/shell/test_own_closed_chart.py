"""Closed charts of a user's own: axisymmetric only where stated and true; no mode sees the parameters."""

from dataclasses import dataclass

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


@dataclass(frozen=True, kw_only=True)
class Torus(cf.geometry.Closed):
    """A pipe bend: a tube of `radius` about a circle of radius `bend`, over an `angle` [rad]: parameters are angles."""

    radius: float
    bend: float
    angle: float

    @property
    def bounds(self):
        return (0.0, self.angle), (0.0, 2.0 * np.pi)

    def surface(self, a, b, defect):
        phi, theta = cf.geometry.jets(a, b)
        out = cf.geometry.cos(theta) * self.radius + self.bend
        y = cf.geometry.sin(theta) * self.radius
        return cf.geometry.surface(out * cf.geometry.cos(phi), y, out * cf.geometry.sin(phi))

    def directions(self, a, b):
        a, b = np.broadcast_arrays(a, b)
        c, s, u, v, zero = np.cos(a), np.sin(a), np.cos(b), np.sin(b), np.zeros_like(a + b)
        return np.array([[u * c, v, u * s], [-v * c, u, -v * s], [-s, zero, c]])


@dataclass(frozen=True, kw_only=True)
class Tube(cf.geometry.Closed):
    """x = A cos t, y = B sin t, z: t = b + swing sin b around, z = height (a + lag a (1 - a)) along, a from 0 to 1."""

    A: float = 0.1
    B: float = 0.1
    height: float = 0.2
    swing: float = 0.0
    lag: float = 0.0
    turned: float = 0.0
    states: bool = False
    turn: float = 2.0 * np.pi

    @property
    def bounds(self):
        return (0.0, 1.0), (0.0, self.turn)

    @property
    def axisymmetric(self):
        return self.states

    def surface(self, a, b, defect):
        u, v = cf.geometry.jets(a, b)
        v = v * (2.0 * np.pi / self.turn)
        t = v + cf.geometry.sin(v) * self.swing + self.turned
        x, y = cf.geometry.cos(t) * self.A, cf.geometry.sin(t) * self.B
        return cf.geometry.surface(x, y, (u + (u - u * u) * self.lag) * self.height)

    def directions(self, a, b):
        a, b = np.broadcast_arrays(a, b)
        t = b + self.swing * np.sin(b) + self.turned
        c, s, zero = self.B * np.cos(t), self.A * np.sin(t), np.zeros_like(a + b)
        c, s = c / np.hypot(c, s), s / np.hypot(c, s)
        return np.array([[c, s, zero], [-s, c, zero], [zero, zero, zero + 1.0]])


def clamped(chart, **parts):
    return cf.Shell(chart=chart, thickness=3e-3, material=STEEL, supports={"base": cf.Clamped()}, **parts)


@pytest.mark.slow
def test_a_torus_is_not_taken_for_a_body_of_revolution():
    """A quarter bend swings at 162.4 Hz as a whole; as if axisymmetric, 448 Hz came out."""
    bend = clamped(Torus(radius=0.1, bend=0.5, angle=np.pi / 2), mesh=cf.ShellMesh(order=7, rows=4, around=11))
    found = cf.modes(bend, count=2)
    np.testing.assert_allclose(found.freq, [162.38, 164.85], rtol=5e-4)
    assert np.isnan(found.angle_deg).all()
    assert found.nodal_diameters.tolist() == [1, 1]


def test_a_bend_that_is_nearly_straight_is_meshed_as_the_tube_it_is():
    """Its first parameter runs over 4e-5 rad; its length is 0.4 m."""
    bend = clamped(Torus(radius=0.1, bend=1e4, angle=0.4 / 1e4)).mesh
    tube = clamped(Tube(height=0.4)).mesh
    assert (bend.order, bend.around) == (tube.order, tube.around)
    np.testing.assert_allclose(bend.breaks, tube.breaks, rtol=1e-6)


@pytest.mark.slow
def test_modes_of_a_tube_do_not_depend_on_its_parameters():
    """Frequencies and labels are those of the cylinder's own harmonics."""
    mesh = cf.ShellMesh(order=7, rows=4, around=11)
    found = cf.modes(clamped(Tube(height=0.1, swing=0.3, lag=-0.3), mesh=mesh), count=4)
    exact = cf.modes(clamped(cf.Cylinder(radius=0.1, height=0.1), mesh=mesh), count=4)
    np.testing.assert_allclose(found.freq, exact.freq, rtol=1e-4)
    assert found.nodal_diameters.tolist() == exact.nodal_diameters.tolist()


@pytest.mark.slow
def test_modes_of_an_elliptic_cylinder_do_not_depend_on_its_parameters():
    sides = {"A": 0.12, "B": 0.08, "height": 0.1}
    first, second = (
        cf.modes(clamped(Tube(**sides, **uneven), mesh=cf.ShellMesh(order=7, rows=(0.0, 0.9, 1.0), around=13)), count=6)
        for uneven in ({}, {"swing": -0.25, "lag": 0.2, "turned": 0.7})
    )
    np.testing.assert_allclose(first.freq, second.freq, rtol=1e-4)
    assert first.nodal_diameters.tolist() == second.nodal_diameters.tolist()


def test_rows_are_divided_in_metres():
    """The layer of a free edge is 2.5 t = 7.5 mm wide, wherever the parameter is there."""
    tube = Tube(height=0.2, lag=0.6)
    z = tube.surface(clamped(tube).mesh.breaks, 0.0, None).x[2]
    np.testing.assert_allclose(z, [0.0, 0.09625, 0.1925, 0.2], rtol=1e-4)


def test_an_uneven_second_parameter_takes_more_elements():
    """At swing 0.4 the longest element is 1.4 times the mean: 17 elements become 25 of at most the same length."""
    assert clamped(Tube()).mesh.around == 17
    assert clamped(Tube(swing=0.4)).mesh.around == 25


@pytest.mark.parametrize(
    ("wrong", "found"),
    [
        ({"A": 0.1001}, "its x "),
        ({"swing": 1e-4}, "its x "),
        ({"turned": 0.1}, None),
        ({"A": 0.12, "B": 0.08}, "its x "),
    ],
)
def test_the_statement_is_checked(wrong, found):
    if found is None:  # about z, from another start: still that at b = 0 turned by b
        assert clamped(Tube(states=True, **wrong)).axisymmetric
        return
    with pytest.raises(
        cf.errors.ModelError, match=rf"states axisymmetric = True, but {found}.*rotated about z by b; .*chart-axisymm"
    ):
        clamped(Tube(states=True, **wrong))


def test_an_axisymmetric_chart_is_closed():
    @dataclass(frozen=True, kw_only=True)
    class Sector(Tube):
        @property
        def periodic(self):
            return False

    with pytest.raises(cf.errors.ModelError, match="expected both True"):
        clamped(Sector(states=True))


def test_a_closed_chart_runs_over_a_turn():
    with pytest.raises(
        cf.errors.ModelError, match=r"second parameter from 0 to 1 on a closed chart, expected a range of 2 pi"
    ):
        clamped(Tube(turn=1.0))


def test_a_rim_needs_a_circle_about_z():
    ellipse = clamped(Tube(A=0.12, B=0.08, height=0.1), mesh=cf.ShellMesh(order=4, rows=1, around=9))
    with pytest.raises(cf.errors.ModelError, match=r"rim: 'top'.*: found angles 0\.2 rad from"):
        cf.reduce(ellipse, cf.Rim("top", n_max=4), modes=4)


def test_a_rim_of_a_round_chart_that_states_nothing_is_that_of_the_cylinder():
    mesh = cf.ShellMesh(order=4, rows=1, around=9)
    rims = [
        cf.reduce(clamped(chart, mesh=mesh), cf.Rim("top", n_max=4), modes=4)
        for chart in (Tube(height=0.1), cf.Cylinder(radius=0.1, height=0.1))
    ]
    np.testing.assert_allclose(rims[0].compliance, rims[1].compliance, rtol=1e-8, atol=1e-18)
    assert rims[0].radius == pytest.approx(rims[1].radius, rel=1e-12)
