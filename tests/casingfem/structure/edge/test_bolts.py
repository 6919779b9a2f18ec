"""Bolts: patches that carry their stiffness whole on any mesh, symmetry, default meshes, refusals, derivatives."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

QUIET = cf.ShellMesh(order=5, rows=1, around=8)


def bolted(frustum, bolts, mesh=QUIET):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cf.errors.ModelWarning)
        return frustum(supports={"base": bolts}, mesh=mesh)


@pytest.mark.parametrize("around", [5, 8, 9])
@pytest.mark.parametrize("loose", [{}, {3: 0.3, 7: 0.0}])
def test_patches_have_their_stiffness_whole_on_any_mesh(frustum, around, loose):
    """A shift of 1 m strains nothing but the bolts: sum of k_z, and k_r cos^2 + k_theta sin^2 at each angle."""
    bolts = cf.Bolts(count=8, k=(1e6, 2e6, 3e6), first_angle=0.123, width=0.4, loose=loose)
    system = cf.shell.assemble(bolted(frustum, bolts, cf.ShellMesh(order=5, rows=1, around=around)))
    fields = np.zeros((len(system.frames), 5, 2))
    fields[:, 0, 0] = fields[:, 2, 1] = 1.0
    vectors = system.restrict(fields)
    energy = vectors.T @ (system.K @ vectors)
    theta, density = np.linspace(-0.2, 0.2, 4001), np.linspace(-1, 1, 4001)
    density = (1.0 - density**2) ** 2 / np.trapezoid((1.0 - density**2) ** 2, theta)
    across = [np.trapezoid(density * (1e6 * np.cos(a + theta) ** 2 + 2e6 * np.sin(a + theta) ** 2), theta)
              for a in bolts.angles]  # fmt: skip
    factors = np.array([loose.get(b, 1.0) for b in range(1, 9)])
    np.testing.assert_allclose(np.diag(energy), [factors @ across, 3e6 * factors.sum()], rtol=2e-6)


def test_a_patch_across_the_seam_is_whole(frustum):
    """Bolt 1 is on the seam: turning all bolts by a pitch changes nothing."""
    here, on = (
        cf.shell.assemble(bolted(frustum, cf.Bolts(count=8, k=1e7, first_angle=a))).K for a in (0.0, -np.pi / 4)
    )
    assert abs(here - on).max() < 1e-12 * abs(here).max()


@pytest.mark.slow
def test_equal_bolts_split_only_what_their_number_allows(frustum):
    """N divides 2n for n = 4, 8, ... of 8 bolts; every other pair stays double."""
    found = cf.modes(
        frustum(supports={"base": cf.Bolts(count=8, k=1e8)}, mesh=cf.ShellMesh(order=6, rows=1, around=16)), 20
    )
    n = np.array([found.nodal_diameters[low] for low, _ in found.doublets])
    allowed = 2 * n % 8 == 0
    assert found.splits[~allowed].max() < 1e-9
    assert found.splits[allowed].max() > 1e-3


def test_turning_the_bolts_turns_the_modes(frustum):
    """A pattern turned by whole elements is the same casing."""
    still, turned = (
        cf.modes(bolted(frustum, cf.Bolts(count=8, k=1e8, loose={2: 0.0}, first_angle=a)), 6) for a in (0.0, np.pi / 2)
    )
    np.testing.assert_allclose(turned.freq, still.freq, rtol=1e-9)


@pytest.mark.slow
def test_many_bolts_act_as_an_elastic_edge(frustum):
    """Forty bolts whose patches touch: k per length is count k/(2 pi R), the patches' ripple acts on n >= 20 only."""

    many = cf.Bolts(count=40, k=1e6, width=2 * np.pi / 40)
    line = 40e6 / (2 * np.pi * 0.5)
    even = cf.ElasticEdge(k_r=line, k_theta=line, k_z=line)
    mesh = cf.ShellMesh(order=6, rows=1, around=10)
    a = cf.modes(bolted(frustum, many, mesh), 8).freq
    b = cf.modes(frustum(supports={"base": even}, mesh=mesh), 8, method="shell").freq
    np.testing.assert_allclose(a, b, rtol=2e-3)


def test_bolts_along_a_part_of_the_edge_repeat_after_a_whole_turn_only():
    equal = cf.Bolts(count=4, k=1e8)
    assert equal.period == 4
    assert replace(equal, loose={1: 0.5, 3: 0.5}).period == 2
    assert replace(equal, loose={2: 0.5}).period == 1
    assert replace(equal, spacing=0.3).period == 1


def test_a_mesh_that_does_not_follow_is_doubted_with_an_estimate(frustum):
    with pytest.warns(cf.errors.ModelWarning, match=r"24 bolts on 21 elements .* by about \de-0\d.*\[bolt-mesh\]"):
        frustum(supports={"base": cf.Bolts(count=24, k=2e8)}, mesh=cf.ShellMesh(order=7, rows=1, around=21))
    frustum(supports={"base": cf.Bolts(count=24, k=2e8)}, mesh=cf.ShellMesh(order=5, rows=1, around=48))  # says nothing


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"count": 0, "k": 1e8}, "bolt-count"),
        ({"count": 8, "k": -1.0}, "bolt-stiffness"),
        ({"count": 8, "k": float("nan")}, "bolt-stiffness"),
        ({"count": 8, "k": (1e8, 1e8)}, "bolt-stiffness"),
        ({"count": 8, "k": 0.0}, "bolt-stiffness"),
        ({"count": 8, "k": 1e8, "loose": {9: 0.5}}, "bolt-number"),
        ({"count": 8, "k": 1e8, "loose": {0: 0.5}}, "bolt-number"),
        ({"count": 8, "k": 1e8, "loose": {1: -0.5}}, "bolt-stiffness"),
        ({"count": 8, "k": 1e8, "width": 0.8}, "bolt-overlap"),
        ({"count": 8, "k": 1e8, "width": 0.0}, "bolt-overlap"),
        ({"count": 8, "k": 1e8, "spacing": 1.0}, "bolt-overlap"),
        ({"count": 8, "k": 1e8, "first_angle": float("inf")}, "bolt-off-edge"),
    ],
)
def test_refuses_bolts_that_are_none(values, code):
    with pytest.raises(cf.errors.ModelError) as caught:
        cf.Bolts(**values)
    assert caught.value.code == code


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"k": float("inf")}, "k_rot and factors must be finite and not negative"),
        ({"k_rot": -1.0}, "k_rot and factors must be finite and not negative"),
        ({"loose": {1: float("inf")}}, "k_rot and factors must be finite and not negative"),
        ({"k": 0.0, "loose": {1: 0.5}}, "bolts: found k = 0 and k_rot = 0, expected one of them above 0"),
        ({"width": float("inf")}, "spacing and width must be positive and finite"),
        ({"width": 0.1, "spacing": -0.1}, "spacing and width must be positive and finite"),
        (
            {"width": 0.15, "spacing": 0.1},
            r"bolts\.width: found 8\.594 deg at a spacing of 5\.73 deg, so that patches overlap",
        ),
        ({"spacing": 1.0}, r"8 bolts at a spacing of 57\.3 deg, more than one"),
        (
            {"width": 0.6, "spacing": 0.85},
            r"bolts\.width: found 34\.38 deg at a spacing of 19\.09 deg, so that patches overlap",
        ),
    ],
)
def test_states_what_is_wrong_with_bolts(values, said):
    with pytest.raises(cf.errors.ModelError, match=said):
        cf.Bolts(**{"count": 8, "k": 1e8} | values)


def test_bolts_may_keep_by_their_rotation_alone_and_keep_what_they_were_given():
    given = {3: 0.5}
    bolts = cf.Bolts(count=24, k=0.0, k_rot=1e3, loose=given)
    given[3] = 0.0
    assert bolts.loose == {3: 0.5}
    with pytest.raises(TypeError):
        bolts.loose[3] = 0.0
    assert bolts.patch == pytest.approx(np.pi / 36, rel=1e-14)
    with pytest.raises(KeyError, match="bolts with k = 0, expected k above 0: a factor does not change"):
        bolts.with_number(("k",), 1e8)


def test_the_stiffness_of_bolts_is_the_largest_of_three_and_keeps_its_form():
    three = cf.Bolts(count=8, k=(1e8, 4e8, 2e8), loose={2: 0.5})
    assert (three.number(("k",)), three.number(("bolts", "2", "k"))) == (4e8, 2e8)
    assert three.with_number(("k",), 2e8).k == (5e7, 2e8, 1e8)
    assert cf.Bolts(count=8, k=2e8).with_number(("k",), 1e8).k == 1e8
    with pytest.raises(KeyError, match=r"bolts\.1\.k to bolts\.8\.k"):
        three.number(("bolts", "0", "k"))


@pytest.mark.parametrize("first", [0.0, -0.1])
def test_wide_patches_across_the_seam_see_every_element(frustum, first):
    """Patches over two and a half elements; half a turn brings each bolt to the other's place."""
    bolts = cf.Bolts(count=2, k=1e10, k_rot=1e6, width=2.0)
    here, on = (cf.shell.assemble(bolted(frustum, replace(bolts, first_angle=a))).K for a in (first, first + np.pi))
    assert abs(here - on).max() < 1e-13 * abs(here).max()


def test_bolts_off_an_open_edge_are_refused(steel):
    panel = cf.Panel(radius=0.6, length=0.3, angle=0.5)
    on = cf.Bolts(count=5, k=1e8, spacing=0.1, first_angle=-0.2)
    cf.Shell(chart=panel, thickness=3e-3, material=steel, supports={"root": on})
    with pytest.raises(
        cf.errors.ModelError,
        match=r"support\.root: found patches .* on the edge, from -0\.25 to 0\.25.*bolt-off-edge",
    ):
        cf.Shell(chart=panel, thickness=3e-3, material=steel, supports={"root": replace(on, first_angle=-0.15)})
    with pytest.raises(
        cf.errors.ModelError, match=r"found patches from -0\.266667 to 0\.166667 .* edge, from -0\.25 to 0\.25"
    ):
        cf.Shell(chart=panel, thickness=3e-3, material=steel, supports={"root": replace(on, first_angle=-0.25)})


@pytest.mark.slow
@pytest.mark.parametrize("name", ["support.base.k", "support.base.k_rot", "support.base.bolts.3.k", "bolts.5.k"])
def test_derivatives_by_bolt_stiffnesses(frustum, name):
    """Against central differences of single modes: loose bolts part all pairs."""
    shell = bolted(frustum, cf.Bolts(count=8, k=(1e7, 2e7, 4e7), k_rot=500.0, loose={1: 0.2, 3: 0.5, 4: 0.7}))
    found = cf.modes(shell, 6, method="shell")
    value = cf.updating.get_value(shell, name)
    slope = np.diagonal(cf.updating.eigen_derivatives(found, [cf.Parameter(name=name, lower=0.0, upper=1e12)])[0])
    step = 1e-4 * value
    low, high = (
        cf.modes(bolted(frustum, cf.updating.with_value(shell, name, value + d).supports["base"]), 6, method="shell")
        for d in (-step, step)
    )
    np.testing.assert_allclose(slope, (high.omega**2 - low.omega**2) / (2 * step), rtol=1e-5, atol=1e-9 * slope.max())


def test_a_mesh_of_a_cylinder_with_two_bolted_edges_follows_both(steel):
    edges = {"base": cf.Bolts(count=8, k=1e8), "top": cf.Bolts(count=12, k=1e8)}
    shell = cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.3), thickness=3e-3, material=steel, supports=edges)
    assert shell.mesh.around % 24 == 0
