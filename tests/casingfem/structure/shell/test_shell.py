"""The Shell value: what it refuses, when it is axisymmetric, the mesh it chooses."""

import copy
import pickle
from dataclasses import FrozenInstanceError
from itertools import pairwise

import numpy as np
import pytest

import casingfem as cf

PATTERN = cf.FourierField.of({4: (0.2, 0.0)})


@pytest.mark.parametrize("value", [0.0, -3e-3, np.nan, np.inf])
def test_refuses_a_thickness_that_is_none(frustum, value):
    with pytest.raises(ValueError, match=r"shell\.thickness must be positive"):
        frustum(thickness=value)


def test_refuses_a_shear_correction_that_is_none(frustum):
    with pytest.raises(ValueError, match=r"shell\.shear_correction"):
        frustum(shear_correction=0.0)


def test_names_the_edges_there_are(frustum):
    with pytest.raises(ValueError, match="no edge 'tip'; it has base, top"):
        frustum(supports={"tip": cf.Clamped()})


def test_refuses_a_support_of_another_kind(frustum):
    with pytest.raises(ValueError, match=r"support\.base: expected .* found str"):
        frustum(supports={"base": "clamped"})


@pytest.mark.parametrize("name", ["radius_defect", "thickness_defect", "modulus_defect", "density_defect"])
def test_refuses_a_field_that_eats_the_shell(frustum, name):
    with pytest.raises(ValueError, match=f"{name}: the field reaches -0.95"):
        frustum(**{name: cf.FourierField.of({3: 0.95})})


class NotFinite:
    def derivatives(self, z, theta):
        value = np.full(np.broadcast(z, theta).shape, np.nan)
        return cf.field.FieldValues(*[value] * 6)

    def rotated(self, angle):
        return self


def test_refuses_a_field_that_is_not_finite(frustum):
    with pytest.raises(ValueError, match="radius_defect: the field is not finite"):
        frustum(radius_defect=NotFinite(), mesh=cf.ShellMesh())


@pytest.mark.slow
@pytest.mark.parametrize("again", [copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_a_shell_and_its_modes_are_copied_and_pickled(frustum, again):
    edge = cf.ElasticEdge(k_face=1e12, k_r=1e8, around={"k_r": PATTERN})
    held = {"base": edge, "top": cf.Bolts(count=9, k=1e8, loose={2: 0.5})}
    masses = {"top": [cf.edge.EdgeMass(angle=0.3, mass=0.1)]}
    found = cf.modes(frustum(supports=held, masses=masses, mesh=cf.ShellMesh(order=4, rows=1, around=9)), 4)
    same = again(found)
    assert same.shell.supports["top"].loose == {2: 0.5}
    assert cf.modes(same.shell, 4).freq.tobytes() == found.freq.tobytes() == same.freq.tobytes()
    with pytest.raises(TypeError):
        same.shell.supports["top"] = cf.Clamped()


def test_is_a_value(frustum):
    shell, supports = frustum(), {"base": cf.Clamped()}
    with pytest.raises(FrozenInstanceError):
        shell.thickness = 1.0
    kept = frustum(supports=supports)
    supports.clear()
    assert list(kept.supports) == ["base"]
    with pytest.raises(TypeError):
        kept.supports["top"] = cf.Clamped()


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, True),
        ({"supports": {}}, True),
        ({"supports": {"base": cf.ElasticEdge(k_r=1e6)}}, True),
        ({"supports": {"base": cf.ElasticEdge(k_r=1e6, around=PATTERN)}}, False),
        ({"radius_defect": cf.FourierField.of({3: 0.001})}, False),
        ({"thickness_defect": cf.FourierField.of({3: 0.001})}, False),
        ({"modulus_defect": cf.FourierField.of({3: 0.001})}, False),
        ({"density_defect": cf.FourierField.of({3: 0.001})}, False),
        ({"chart": cf.Panel(radius=0.5, length=0.3, angle=1.0), "supports": {}}, False),
    ],
)
def test_axisymmetric_means_nothing_varies_around(frustum, changes, expected):
    assert frustum(**changes).axisymmetric is expected


def test_thickness_field_is_relative(frustum):
    shell = frustum(thickness_defect=cf.FourierField.of({4: 0.1}))
    theta = np.linspace(0, 6, 9)
    t = shell.geometry(np.full(9, 0.1), theta).thickness
    np.testing.assert_allclose(t, 3e-3 * (1 + 0.1 * np.cos(4 * theta)), rtol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "power"), [("modulus", 0.5), ("density", -0.5)])
def test_an_even_field_scales_the_material(frustum, coarse, name, power):
    """E (1 + f) and rho (1 + f) with f the same everywhere: omega goes with sqrt(E/rho)."""
    field = {f"{name}_defect": cf.FourierField.of({0: 0.21})}
    plain, varied = (cf.modes(frustum(mesh=coarse, **parts), 6, method="shell").freq for parts in ({}, field))
    np.testing.assert_allclose(varied, plain * 1.21**power, rtol=1e-10)


def test_default_mesh_is_odd_around_and_finer_for_finer_fields(frustum):
    plain, wavy = frustum().mesh, frustum(radius_defect=cf.FourierField.of({24: 0.001})).mesh
    assert plain.around % 2 == wavy.around % 2 == 1
    assert wavy.around * wavy.order >= 11.5 * 24
    assert wavy.around > plain.around


def test_default_mesh_grades_edges_without_support(frustum):
    layer = 2.5 * 3e-3 / np.hypot(0.25, 0.05)  # of the length along the wall
    assert frustum().mesh.rows == pytest.approx((0.0, 1.0 - layer, 1.0), abs=1e-12)
    assert frustum(supports={}).mesh.rows == pytest.approx((0.0, layer, 1.0 - layer, 1.0), abs=1e-12)
    assert frustum(supports={"base": cf.Clamped(), "top": cf.Clamped()}).mesh.rows == (0.0, 1.0)
    ring = cf.Ring(section=cf.edge.Section.rectangle(width=0.04, depth=0.04))
    for loose in (cf.ElasticEdge(k_face=1e12), ring, cf.Bolts(count=24, k=2e8)):
        assert frustum(supports={"base": loose, "top": cf.Clamped()}).mesh.rows == pytest.approx(
            (0.0, layer, 1.0), abs=1e-12
        )


def test_default_mesh_of_a_plate_follows_its_shape(steel):
    wide = cf.Shell(chart=cf.Plate(length=0.2, width=0.8), thickness=0.01, material=steel).mesh
    assert (len(wide.breaks) - 1, wide.columns) == (2 + 2, 8 + 2)  # with a layer at each free edge


@pytest.mark.slow
@pytest.mark.parametrize(("stretches", "order"), [(1, 8), (2, 7), (30, 7), (31, 6), (60, 3), (300, 2)])
def test_the_order_falls_beyond_thirty_stretches(steel, stretches, order):
    places = np.linspace(0.0, 1.0, stretches + 1).tolist()
    strips = [cf.Strip(start=low, end=high, thickness=2e-3) for low, high in pairwise(places)]
    mesh = cf.Shell(chart=cf.Cylinder(radius=0.5, height=1.0), thickness=1e-3, material=steel, strips=strips).mesh
    assert mesh.order == order


def test_a_thin_casing_gets_more_elements(steel):
    def around(t):
        return cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.3), thickness=t, material=steel).mesh.around

    assert around(1e-4) > around(1e-3) >= around(5e-3)


def test_refuses_a_wall_that_is_none(frustum):
    with pytest.raises(ValueError, match=r"shell\.wall: expected curved or linear, found 'thin'"):
        frustum(wall="thin")
