"""Energies of motions: harmonics against the shell as a whole, rates against complex steps, held directions."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.mesh.kinematics import frame
from casingfem.structure.mesh.shell_mesh import make_grid
from casingfem.structure.shell.assembly import admitted, edge_rotation, held_dofs, independent, joint_frame
from casingfem.structure.shell.axisymmetric import harmonic_matrices
from casingfem.structure.shell.edges import outward, ties
from casingfem.structure.shell.energies import modal_products, point_fields, product_rates
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.rigid import free_motions, kinetic_products, rigid_fields, rigid_modes, ring_turns
from casingfem.structure.shell.shell import remade

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BRASS = cf.Material(E=90e9, nu=0.34, rho=8400.0)
BAR = cf.edge.Section.rectangle(width=0.05, depth=0.03)
CONE = cf.Frustum(r_base=0.5, r_top=0.4, height=0.3)
SPRINGS = cf.ElasticEdge(k_r=3e9, k_theta=5e9, k_z=7e9, k_rot=2e7, k_face=4e11)

CASINGS = {
    "springs and a diaphragm": {
        "supports": {"base": SPRINGS, "top": cf.ShearDiaphragm()},
        "strips": (cf.Strip(start=0.0, end=0.1, thickness=0.03, material=BRASS),),
    },
    "rings": {
        "supports": {
            "top": cf.Ring(section=BAR, material=BRASS, offset=(0.03, -0.02), support=SPRINGS, foot=(0.0, 0.04))
        },
        "stiffeners": (cf.edge.Stiffener(at=0.1, section=BAR, offset=(0.035, 0.01)),),
        "wall": "linear",
    },
}


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("name", CASINGS)
def test_a_harmonic_has_the_energies_of_its_motion_on_the_whole_casing(name, n):
    """(u_r, -u_theta, u_z, w_1, -w_2) times (cos, sin, cos, cos, sin) of n theta, turns of rings with sin: pi times."""
    mesh = cf.ShellMesh(order=6, rows=(0.0, 1 / 3, 1.0), around=9)
    shell = cf.Shell(chart=CONE, thickness=0.02, material=STEEL, mesh=mesh, **CASINGS[name])
    meridian, grid = harmonic_matrices(shell, n), make_grid(shell.chart, mesh, shell.stations)
    vectors = np.random.default_rng(4).normal(size=(len(meridian.free), 2))
    amplitudes, own = meridian.expand(vectors), meridian.expand_own(vectors)
    z, theta = grid.nodes
    at = np.abs(z[:, None] - meridian.z).argmin(axis=1)
    c, s = np.cos(n * theta)[:, None], np.sin(n * theta)[:, None]
    u_r, u_theta, u_z, w_1, w_2 = amplitudes[at].transpose(1, 0, 2)
    u_theta, w_2 = -u_theta * s, -w_2 * s
    a, b = np.cos(theta)[:, None], np.sin(theta)[:, None]
    fields = np.stack([u_r * c * a - u_theta * b, u_r * c * b + u_theta * a, u_z * c, w_1 * c, w_2], axis=1)
    edges = [theta[grid.edges[line].nodes] for line in shell.rings]
    turns = [-np.sin(n * angle)[:, None] * own[k] for k, angle in enumerate(edges)]
    whole = modal_products(shell, point_fields(shell, grid, fields, np.vstack([np.zeros((0, 2)), *turns])))
    kinetic = vectors.T @ (meridian.mass[:, None] * vectors)
    np.testing.assert_allclose([whole.K, whole.M], [np.pi * meridian.energies(vectors), np.pi * kinetic], rtol=1e-7)
    np.testing.assert_allclose(meridian.energies(vectors), vectors.T @ meridian.K @ vectors, rtol=1e-9)
    np.testing.assert_allclose(meridian.collect(amplitudes, own), vectors, atol=1e-9 * np.abs(vectors).max())
    forces = np.random.default_rng(5).normal(size=(5 * len(meridian.z), 3))
    expected = amplitudes.reshape(-1, 2).T @ forces
    np.testing.assert_allclose(vectors.T @ meridian.restrict(forces), expected, rtol=1e-9, atol=1e-9)


def test_the_centre_of_a_ring_lies_off_its_edge_outwards_and_up():
    """At 0.03 m along the radius and -0.02 m along the axis: u + phi x arm there, phi the turn of the wall's frame."""
    shell = cf.Shell(
        chart=CONE, thickness=0.02, material=STEEL, **CASINGS["rings"], mesh=cf.ShellMesh(around=9, order=3, rows=3)
    )
    theta = np.array([0.4, 2.0])
    G, points, radial = ties(shell, np.full(2, 0.3), theta, np.array([0.03, -0.02]))
    out = np.stack([np.cos(theta), np.sin(theta), 0.0 * theta], axis=1)
    np.testing.assert_allclose(points, 0.43 * out + [0.0, 0.0, 0.28], rtol=1e-13)
    np.testing.assert_allclose(radial, out, atol=1e-15)
    basis = frame(CONE.surface(np.full(2, 0.3), theta, None))
    for k in range(2):
        phi = 0.7 * basis.e2[:, k] - 0.2 * basis.e1[:, k] + 0.5 * basis.normal[:, k]
        expected = np.array([1.0, 2.0, 3.0]) + np.cross(phi, 0.03 * out[k] + [0.0, 0.0, -0.02])
        np.testing.assert_allclose(G[k] @ [1.0, 2.0, 3.0, 0.7, 0.2, 0.5], [*expected, *phi], atol=1e-14)
    assert [outward(shell, name) for name in ("base", "top", "stiffener 1")] == [-1, 1, 0]


def casing(**changes):
    given = {
        "chart": CONE, "thickness": 0.02, "material": STEEL, "mesh": cf.ShellMesh(order=3, rows=2, around=5),
        "supports": {"base": cf.ShearDiaphragm(), "top": cf.ElasticEdge(k_r=1e9, k_z=2e9)},
    }  # fmt: skip
    return cf.Shell(**given | changes)


STEP = 1e-20j
BENT = cf.FourierField.of({2: 0.01})
CHANGES = {
    "thickness": lambda s: {"thickness": s.thickness + STEP},
    "density": lambda s: {"material": replace(STEEL, rho=7800.0 + 1e6 * STEP)},
    "radius field": lambda s: {"radius_defect": BENT.with_harmonic(2, cos=0.01 + STEP)},
    "radius": lambda s: {"chart": replace(CONE, r_top=0.4 + STEP)},
    "height": lambda s: {"chart": replace(CONE, height=0.3 + STEP)},
    "springs": lambda s: {"supports": {**s.supports, "top": cf.ElasticEdge(k_r=1e9 + 1e9 * STEP, k_z=2e9)}},
    "masses": lambda s: {"masses": {"top": (cf.edge.EdgeMass(angle=1.0, mass=3.0 + STEP),)}},
}


@pytest.mark.parametrize("held", ["frame", "springs"])
@pytest.mark.parametrize("name", CHANGES)
def test_rates_of_energies_are_the_imaginary_parts_of_a_complex_step(name, held):
    shell = casing(radius_defect=BENT, masses={"top": [cf.edge.EdgeMass(angle=1.0, mass=3.0)]})
    if held == "springs":
        shell = replace(shell, supports={"top": cf.ElasticEdge(k_r=1e9, k_z=2e9)})
    grid = make_grid(shell.chart, shell.mesh)
    fields = np.random.default_rng(1).normal(size=(grid.nodes.shape[1], 5, 2))
    fields = admitted(shell, grid, fields)
    at = point_fields(shell, grid, fields, np.zeros((0, 2)))
    stepped = replace(remade(ShellParts, shell), **CHANGES[name](shell))
    found, exact = product_rates(stepped, at), modal_products(stepped, at)
    np.testing.assert_allclose(found.K, exact.K.imag, rtol=1e-10, atol=1e-12 * np.abs(exact.K.imag).max())
    if held == "springs" or name not in ("radius", "height", "radius field"):
        np.testing.assert_allclose(found.M, exact.M.imag, rtol=1e-10, atol=1e-12 * np.abs(exact.M.imag).max())
    still = modal_products(remade(ShellParts, shell), at)
    np.testing.assert_allclose(still.K, np.real(exact.K), rtol=1e-12)


def test_what_a_shell_without_held_corners_may_move():
    """A clamped root and a symmetric side of a panel: at their corner both hold."""
    shell = cf.Shell(
        chart=cf.Panel(radius=0.5, length=0.3, angle=0.8), thickness=0.01, material=STEEL,
        mesh=cf.ShellMesh(order=2, rows=1, around=1), supports={"left": cf.edge.Symmetry(), "tip": cf.ShearDiaphragm()},
    )  # fmt: skip
    grid = make_grid(shell.chart, shell.mesh)
    fields = np.random.default_rng(1).normal(size=(grid.nodes.shape[1], 5, 2))
    left = admitted(shell, grid, fields)
    held = {}
    for name, which in (("left", [0, 3]), ("tip", [1, 2, 4])):
        edge = grid.edges[name]
        turn = edge_rotation(shell, grid.nodes[:, edge.nodes], edge.along)
        np.testing.assert_allclose(turn.swapaxes(1, 2) @ turn, np.tile(np.eye(5), (len(turn), 1, 1)), atol=1e-14)
        for node, columns in zip(edge.nodes.tolist(), turn[:, :, which], strict=True):
            held[node] = np.hstack([held.get(node, np.zeros((5, 0))), columns])
    assert sorted(columns.shape[1] for columns in held.values()) == [2, 2, 3, 3, 5]
    free, frames = held_dofs(shell, grid)
    expected = fields.copy()
    for node, columns in held.items():
        expected[node] -= columns @ np.linalg.pinv(columns) @ fields[node]
    np.testing.assert_allclose(left, expected, atol=1e-12)
    assert len(free) == 45 - sum(np.linalg.matrix_rank(columns, tol=1e-8) for columns in held.values())
    for node, columns in held.items():  # what stays free in a node's frame moves none of its held directions
        own = [dof - 5 * node for dof in free if dof // 5 == node]
        assert np.abs(columns.T @ frames[node][:, own]).max(initial=0.0) < 1e-14


@pytest.mark.parametrize(("off", "rank"), [(1e-8, 1), (1e-4, 2)])
def test_directions_count_once(off, rank):
    columns = np.array([[1.0, 1.0, 0.0], [0.0, off, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    assert independent(columns).shape[1] == rank + 1
    turn, held = joint_frame(columns)
    assert held.tolist() == [True, rank == 2, False, True, False]
    np.testing.assert_allclose(turn @ turn.T, np.eye(5), atol=1e-14)
    assert np.abs(turn[:3, 3:]).max() == np.abs(turn[3:, :3]).max() == 0.0
    assert abs(turn[3, 3]) == pytest.approx(1.0)


def test_motions_of_a_ringed_casing_go_there_and_back():
    shell = casing(supports={"top": cf.Ring(section=BAR, offset=(0.03, 0.0)), "base": cf.ShearDiaphragm()})
    system = cf.shell.assemble(shell)
    vectors = np.random.default_rng(3).normal(size=(system.size, 2))
    fields, own = system.expand(vectors), system.expand_own(vectors)
    assert (system.own, len(own), system.dofs, system.K.shape[0]) == (15, 15, 5, system.size)
    np.testing.assert_allclose(system.collect(fields, own), vectors, rtol=1e-8, atol=1e-10)
    forces = np.random.default_rng(6).normal(size=fields.shape)
    work = np.einsum("ndi,ndj->ij", fields, forces)
    np.testing.assert_allclose(vectors.T @ system.restrict(forces), work, rtol=1e-10, atol=1e-9)
    kinetic = kinetic_products(shell, system.grid, fields, own)
    np.testing.assert_allclose(vectors.T @ system.M @ vectors, kinetic, rtol=1e-9)
    found = modal_products(shell, point_fields(shell, system.grid, fields, own))
    np.testing.assert_allclose([vectors.T @ system.K @ vectors, kinetic], [found.K, found.M], rtol=1e-8)
    free = cf.shell.assemble(casing(supports={"top": cf.Ring(section=BAR)}))
    axes = np.array([[0.6, 0.0, 0.8]])
    moved = free.expand(free.translations(axes))[:, :, 0]
    np.testing.assert_allclose(moved, np.tile([0.6, 0.0, 0.8, 0.0, 0.0], (len(moved), 1)), atol=1e-9)


def test_rigid_motions_that_supports_leave():
    """Three translations and three turns; springs along z alone leave four; the turns of rings about the normal."""
    for supports, count in (
        ({}, 6), ({"top": cf.Clamped()}, 0), ({"base": cf.ElasticEdge(k_z=1e-3)}, 3),
        ({"base": cf.Bolts(count=3, k=(0.0, 1.0, 0.0))}, 3), ({"top": cf.Ring(section=BAR)}, 6),
        ({"top": cf.Ring(section=BAR, support=cf.ElasticEdge(k_theta=1.0))}, 3),
    ):  # fmt: skip
        shell = casing(supports=supports, mesh=cf.ShellMesh(order=3, rows=2, around=6))
        grid = make_grid(shell.chart, shell.mesh)
        assert free_motions(shell, grid).shape == (grid.nodes.shape[1], 5, count)
    fields = rigid_fields(shell, grid)
    turns = ring_turns(shell, grid, fields)
    size = np.abs(shell.geometry(*grid.nodes).surface.x.T - shell.geometry(*grid.nodes).surface.x.mean(axis=1)).max()
    theta, slope = grid.nodes[1, grid.edges["top"].nodes], np.arctan(1 / 3)
    inwards = -np.array([np.cos(slope) * np.cos(theta), np.cos(slope) * np.sin(theta), np.sin(slope) + 0 * theta]).T
    np.testing.assert_allclose(turns, np.hstack([0 * inwards, inwards / size]), atol=1e-9)


def test_modes_that_are_rigid_are_counted_from_the_first():
    shell = casing(supports={})
    grid = make_grid(shell.chart, shell.mesh)
    rigid, bent = free_motions(shell, grid), np.random.default_rng(2).normal(size=(grid.nodes.shape[1], 5, 2))
    own = np.zeros((0, 8))
    assert rigid_modes(shell, grid, np.dstack([rigid, bent]), own) == 6
    assert rigid_modes(shell, grid, rigid[:, :, :4], own[:, :4]) == 4
    assert rigid_modes(shell, grid, np.dstack([bent, rigid]), own) == 0
    with pytest.warns(UserWarning, match="6 rigid motions are free, 3 modes show them"):
        assert rigid_modes(shell, grid, np.dstack([rigid[:, :, :3], bent, rigid[:, :, 3:]]), own) == 3
    assert rigid_modes(replace(shell, supports={"base": cf.Clamped()}), grid, rigid, own[:, :6]) == 0
