"""Supports: what is fixed, how springs vary around an edge, refusals; and what they do to a shell."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf


def frequencies(shell, count=8):
    return cf.modes(shell, count, method="shell").omega


class Rising:
    """A pattern that is no series: z along the axis, whatever the angle."""

    def derivatives(self, z, theta):
        value = np.asarray(z) + 0.0 * np.asarray(theta)
        return cf.field.FieldValues(value, 1.0 + 0 * value, *[0 * value] * 4)

    def rotated(self, angle):
        return self


def test_any_field_is_a_pattern_and_is_taken_at_its_edge(steel):
    """On the upper edge, z = .4: all springs are stiffer by .4, as by a pattern p = 0."""
    parts = {"chart": cf.Cylinder(radius=0.5, height=0.4), "thickness": 5e-3, "material": steel}
    mesh = cf.ShellMesh(order=5, rows=1, around=5)
    springs = {"k_r": 1e8, "k_theta": 1e8, "k_z": 1e8, "k_rot": 1e3}
    rising, stiffer = (
        frequencies(cf.Shell(supports={"top": cf.ElasticEdge(**springs, around=around)}, mesh=mesh, **parts))
        for around in (Rising(), cf.FourierField.of({0: 0.4}))
    )
    np.testing.assert_allclose(rising, stiffer, rtol=1e-12)


def test_each_spring_may_have_a_pattern_of_its_own():
    theta = np.linspace(0, 6, 13)
    around = {"k_r": cf.FourierField.of({4: (0.3, -0.1)}), "k_z": cf.FourierField.of({2: 0.2})}
    edge = cf.ElasticEdge(k_r=1.0, k_theta=2.0, k_z=3.0, k_rot=4.0, around=around)
    d = cf.Cylinder(radius=1.0, height=1.0).directions(np.zeros(13), theta)
    blocks, rotation = edge.line_stiffness(d, np.zeros(13), theta, np.full(13, 0.01))
    felt = np.einsum("kip,pij,kjp->kp", d, blocks, d)
    np.testing.assert_allclose(felt[0], 1 + 0.3 * np.cos(4 * theta) - 0.1 * np.sin(4 * theta), rtol=1e-14)
    np.testing.assert_allclose(felt[1], 2.0, rtol=1e-14)
    np.testing.assert_allclose(felt[2], 3 * (1 + 0.2 * np.cos(2 * theta)), rtol=1e-14)
    np.testing.assert_allclose(rotation, 4.0, rtol=1e-14)
    assert edge.patterns == around
    with pytest.raises(TypeError):
        edge.around["k_r"] = None


def test_line_springs_act_along_their_directions():
    edge = cf.ElasticEdge(k_r=1.0, k_theta=2.0, k_z=3.0, k_rot=4.0, around=cf.FourierField.of({2: (0.5, 0.0)}))
    theta = np.array([0.0, 0.4, 2.0])
    d = cf.Cylinder(radius=1.0, height=1.0).directions(np.zeros(3), theta)
    blocks, rotation = edge.line_stiffness(d, np.zeros(3), theta, np.full(3, 0.01))
    factor = 1 + 0.5 * np.cos(2 * theta)
    for k, stiffness in enumerate((1.0, 2.0, 3.0)):
        felt = np.einsum("ip,pij,jp->p", d[k], blocks, d[k])
        np.testing.assert_allclose(felt, stiffness * factor, rtol=1e-14)
    np.testing.assert_allclose(rotation, 4.0 * factor, rtol=1e-14)


def test_face_foundation_is_felt_over_the_thickness():
    t, theta = np.array([0.01, 0.02]), np.zeros(2)
    d = cf.Cylinder(radius=1.0, height=1.0).directions(np.zeros(2), theta)
    blocks, rotation = cf.ElasticEdge(k_face=5e12).line_stiffness(d, np.zeros(2), theta, t)
    np.testing.assert_allclose(blocks, 5e12 * t[:, None, None] * np.eye(3), rtol=1e-14)
    np.testing.assert_allclose(rotation, 5e12 * t**3 / 12, rtol=1e-14)


def test_energy_of_the_springs_in_a_translation(frustum, coarse):
    """A translation of 1 m across strains nothing but the springs: pi R (k_r + k_theta) + 2 pi R t k_face."""
    springs = cf.ElasticEdge(k_r=2e6, k_theta=1e6, k_z=7e6, k_rot=3e3, k_face=1e8)
    system = cf.shell.assemble(frustum(supports={"base": springs}, mesh=coarse))
    fields = np.zeros((len(system.frames), 5, 2))
    fields[:, 0, 0] = fields[:, 2, 1] = 1.0
    vectors = system.restrict(fields)  # nothing is turned here: forces and motions alike
    energy = vectors.T @ (system.K @ vectors)
    face = 2 * np.pi * 0.5 * 3e-3 * 1e8
    np.testing.assert_allclose(
        energy, np.diag([np.pi * 0.5 * 3e6 + face, 2 * np.pi * 0.5 * 7e6 + face]), rtol=1e-6, atol=1.0
    )


@pytest.mark.slow
def test_stiff_springs_approach_the_clamp_from_below(frustum):
    coarse = cf.ShellMesh(order=5, rows=1, around=7)
    clamped = frequencies(frustum(mesh=coarse), count=4)
    last = np.zeros_like(clamped)
    for k in (1e10, 1e13, 1e17):
        now = frequencies(frustum(supports={"base": cf.ElasticEdge(k_face=k)}, mesh=coarse), count=4)
        assert np.all(now > last)
        last = now
    assert np.all(last < clamped)
    np.testing.assert_allclose(last, clamped, rtol=1e-4)


def test_shear_diaphragm_keeps_its_own_plane(steel):
    shell = cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=0.4),
        thickness=5e-3,
        material=steel,
        supports={"base": cf.ShearDiaphragm()},
        mesh=cf.ShellMesh(order=4, rows=1, around=5),
    )
    system = cf.shell.assemble(shell)
    fields = system.expand(np.random.default_rng(11).normal(size=(system.size, 3)))
    edge = system.grid.edges["base"].nodes
    assert np.abs(fields[edge, :2]).max() < 1e-15  # radial and hoop
    assert np.abs(fields[edge, 4]).max() == 0.0
    assert np.abs(fields[edge, 2]).min() > 0.0
    assert np.abs(fields[edge, 3]).min() > 0.0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({}, "at least one"),
        ({"k_r": -1.0}, r"support\.k_r must be finite"),
        ({"k_face": float("nan")}, r"support\.k_face must be finite"),
        ({"k_rot": float("inf")}, r"support\.k_rot must be finite"),
        ({"k_r": 1.0, "around": {"k_x": cf.FourierField.of({4: 0.1})}}, "found 'k_x', expected springs among k_r"),
    ],
)
def test_refuses_springs_that_are_none(values, message):
    with pytest.raises(ValueError, match=message):
        cf.ElasticEdge(**values)


def test_refuses_patterns_that_make_a_spring_push(frustum):
    edge = cf.ElasticEdge(k_r=1.0, around={"k_r": cf.FourierField.of({4: (0.8, 0.7)})})
    with pytest.raises(
        cf.errors.ModelError,
        match=r"support\.base\.around.*multiply k_r by -0\.0629",
    ) as caught:
        frustum(supports={"base": edge})
    assert caught.value.code == "springs-negative"


@pytest.mark.filterwarnings("ignore:.*support-incomplete")
def test_an_edge_without_springs_for_a_motion_leaves_it_free(frustum, coarse):
    axial_only = frequencies(frustum(supports={"base": cf.ElasticEdge(k_z=1e12)}, mesh=coarse), count=3)
    assert np.all(axial_only < 1.0)  # two translations and the turn about the axis
    assert replace(cf.ElasticEdge(k_z=1.0), k_r=2.0).k_r == 2.0
