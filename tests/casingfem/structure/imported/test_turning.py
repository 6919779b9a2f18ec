"""What hangs on a rotating part: rigid bodies on springs and pendulums in closed form, forces in rigid connections."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eig, eigh

import casingfem as cf
from tests.casingfem.structure.imported.parts import STEEL, added_nodes, hung

QUIET = ("mesh-aspect", "mesh-orphan-nodes", "material-units", "mesh-parts")
pytestmark = [pytest.mark.filterwarnings(f"ignore:.*{code}") for code in QUIET]
SIDES, OMEGA = np.array([0.1, 0.2, 0.3]), 400.0
SPRINGS = np.array([3e7, 5e7, 8e7, 4e5, 6e5, 9e5])
Z = cf.Rotation(omega=OMEGA, axis=(0.0, 0.0, 1.0))


def ground(node, stiffness):
    return tuple(
        cf.imported.Spring(terms=(cf.imported.Term(node, c, 1.0),), stiffness=float(k)) for c, k in enumerate(stiffness)
    )


def at_speed(part, rotation=Z):
    """Stiffness at its speed, mass and Coriolis matrix of an unsupported part."""
    system = part.assembled()
    added = part.spin(system, rotation)
    K = system.K + added.stiffness(rotation.omega)
    return K.toarray(), system.M.toarray(), rotation.omega * added.G.toarray()


def body(how):
    """A steel block about the origin as a rigid body: its nodes on a reference, or its mass and inertia at a node."""
    cube = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: (u - 0.5) * SIDES)
    mass = 7800.0 * float(SIDES.prod())
    J = mass * (SIDES @ SIDES - SIDES**2) / 12.0
    mesh, (node,) = added_nodes(cube, (0.0, 0.0, 0.0))
    rigid = cf.imported.Rigid(reference=node, nodes=np.arange(node))
    if how == "cells":
        return cf.Solid(mesh=hung(mesh, rigids=(rigid,), springs=ground(node, SPRINGS)), material=STEEL), mass, J
    light = cf.Material(E=210e9, nu=0.3, rho=1e-9)
    masses = (cf.imported.PointMass(node=node, mass=mass, inertia=np.diag(J)),)
    if how == "pieces":  # eight eccentric masses with inertia of their own
        quarter = SIDES / 4.0
        corners = quarter * np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        masses = tuple(
            cf.imported.PointMass(node=node, mass=mass / 8.0, inertia=np.diag(J) / 32.0, offset=tuple(corner))
            for corner in corners
        )
    mesh = hung(mesh, rigids=(rigid,), springs=ground(node, SPRINGS), masses=masses)
    return cf.Solid(mesh=mesh, material=light), mass, J


@pytest.mark.parametrize("how", ["cells", "mass", "pieces"])
def test_a_rigid_body_on_springs_turns_as_euler_states(how):
    """k_x - m O^2, k_tx + (J_z - J_y) O^2, k_ty + (J_z - J_x) O^2; Coriolis 2 m O, (J_x + J_y - J_z) O."""
    part, mass, J = body(how)
    K, M, G = at_speed(part)
    soft = mass * np.array([1.0, 1.0, 0.0])
    turn = np.array([J[2] - J[1], J[2] - J[0], 0.0])
    scale = np.sqrt(np.outer(SPRINGS, SPRINGS))
    np.testing.assert_allclose(K / scale, np.diag(SPRINGS + OMEGA**2 * np.r_[-soft, turn]) / scale, atol=1e-7)
    np.testing.assert_allclose(M, np.diag([mass] * 3 + J.tolist()), atol=1e-7 * mass)
    wanted = np.zeros((6, 6))
    wanted[0, 1], wanted[3, 4] = -2.0 * mass * OMEGA, -(J[0] + J[1] - J[2]) * OMEGA
    np.testing.assert_allclose(G, wanted - wanted.T, atol=1e-6 * mass * OMEGA)
    poles = eig(np.block([[np.zeros((6, 6)), np.eye(6)], [-np.linalg.solve(M, K), -np.linalg.solve(M, G)]]))[0]
    assert np.abs(poles.real).max() < 1e-6 * np.abs(poles).max()


def pendulum(arm, hub, kind):
    """A mass on an arm along x, hinged at a hub: carried by an offset, by a rigid connection, by two of them."""
    mesh = cf.imported.grid_mesh(
        "hexahedron20", (1, 1, 1), lambda u: (u - [2.0, 0.5, 0.5]) * 0.1, groups={"root": (0, 0.0)}
    )
    places = [(hub, 0.0, 0.0), (hub + 0.4 * arm, 0.0, 0.0), (hub + arm, 0.0, 0.0)]
    mesh, (hinge, half, end) = added_nodes(mesh, *places)
    groups = dict(mesh.groups) | {"hinge": cf.imported.Group(nodes=[hinge])}
    k = (7e4, 8e4, 9e4)
    springs = tuple(
        cf.imported.Spring(terms=(cf.imported.Term(hinge, 3 + c, 1.0),), stiffness=value) for c, value in enumerate(k)
    )
    items = {
        "offset": {"masses": (cf.imported.PointMass(node=hinge, mass=3.0, offset=(arm, 0.0, 0.0)),)},
        "rigid": {
            "masses": (cf.imported.PointMass(node=end, mass=3.0),),
            "rigids": (cf.imported.Rigid(reference=hinge, nodes=np.array([end])),),
        },
        "chain": {
            "masses": (cf.imported.PointMass(node=end, mass=3.0),),
            "rigids": (
                cf.imported.Rigid(reference=hinge, nodes=np.array([half])),
                cf.imported.Rigid(reference=half, nodes=np.array([end])),
            ),
        },
    }[kind]
    mesh = hung(replace(mesh, groups=groups), springs=springs, **items)
    held = {"root": cf.Clamped(), "hinge": cf.imported.Fixed(directions=("x", "y", "z"))}
    return cf.Solid(mesh=mesh, material=STEEL, supports=held), hinge, k


@pytest.mark.parametrize("kind", ["offset", "rigid", "chain"])
def test_a_pendulum_on_a_hub_stiffens_as_its_lengths_state(kind):
    """Out of the plane k + m O^2 a (R + a), in it k + m O^2 a R, for an arm a at the hub's radius R; m a^2 moves."""
    arm, hub = 0.5, 0.3
    part, hinge, k = pendulum(arm, hub, kind)
    system = part.assembled()
    first = system.dofs * len(system.points)
    turns = np.flatnonzero(system.free >= first + 3 * np.searchsorted(system.connected.rows.motions.turning, hinge))[:3]
    K, M, _ = at_speed(part)
    K, M = K[np.ix_(turns, turns)], M[np.ix_(turns, turns)]
    added = 3.0 * OMEGA**2 * arm * np.array([0.0, hub + arm, hub])
    np.testing.assert_allclose(K, np.diag(np.array(k) + added), rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(M, np.diag([0.0, 1.0, 1.0]) * 3.0 * arm**2, atol=1e-12)


L, B = 1.0, 0.02


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "how"), [("solid", "rigid"), ("solid", "mean"), ("shell", "rigid")])
def test_a_mass_beyond_the_tip_of_a_light_beam_stiffens_it(kind, how):
    """Southwell's coefficient of a heavy end on a rigid arm, by the energy of the beam's static shape.

    Shape w of the beam under its tip force, arm e: int w'^2 T dx + T e w'(L)^2 over (w(L) + e w'(L))^2, T = L + e;
    less one in the plane of rotation.
    """
    e = 0.25
    light = cf.Material(E=210e9, nu=0.0, rho=1e-3)
    ends = {"root": (0, 0.0), "tip": (0, 1.0)}
    if kind == "shell":
        mesh = cf.imported.grid_mesh(
            "quad8", (6, 1), lambda u: np.insert((u - [0.0, 0.5]) * [L, B], 2, 0.0, axis=1), groups=ends
        )
    else:
        mesh = cf.imported.grid_mesh(
            "hexahedron20", (12, 1, 1), lambda u: (u - [0.0, 0.5, 0.5]) * [L, B, 1.5 * B], groups=ends
        )
    mesh, (node,) = added_nodes(mesh, (L + e, 0.0, 0.0))
    tip = mesh.groups["tip"].nodes
    link = {"rigids": (cf.imported.Rigid(reference=node, nodes=tip),)}
    if how == "mean":
        link = {"means": (cf.imported.Mean(reference=node, nodes=tip, weights=np.ones(len(tip))),)}
    mesh = hung(mesh, masses=(cf.imported.PointMass(node=node, mass=2.0),), **link)
    x = np.linspace(0.0, L, 4001)
    slope = x * (L + e) - 0.5 * x**2  # of a force at the arm's end, EI w'' = L + e - x
    shape = np.cumsum(np.r_[0.0, 0.5 * (slope[1:] + slope[:-1]) * np.diff(x)])
    end = shape[-1] + e * slope[-1]
    stiffened = (L + e) * (np.trapezoid(slope**2, x) + e * slope[-1] ** 2) / end**2
    for axis, wanted in (((0.0, 1.0, 0.0), stiffened), ((0.0, 0.0, 1.0), stiffened)):
        options = {"material": light, "supports": {"root": cf.Clamped()}, "rotation": cf.Rotation(omega=0.0, axis=axis)}
        part = cf.MeshShell(mesh=mesh, thickness=B, **options) if kind == "shell" else cf.Solid(mesh=mesh, **options)
        found = cf.campbell(part, [0.0, 5.0], count=2)
        np.testing.assert_allclose(sorted(found.southwell), [wanted - 1.0, wanted], atol=4e-3)


@pytest.mark.slow
def test_reduced_and_whirling_parts_have_what_hangs_on_them():
    """A basis of a rotating beam with a tip mass, and its whirl: the same frequencies by the full matrices."""
    mesh = cf.imported.grid_mesh("hexahedron20", (4, 1, 1), lambda u: (u - [0.0, 0.5, 0.5]) * [0.5, 0.03, 0.04],
                     groups={"root": (0, 0.0), "tip": (0, 1.0)})  # fmt: skip
    mesh, (node,) = added_nodes(mesh, (0.6, 0.0, 0.0))
    mass = cf.imported.PointMass(node=node, mass=1.0, inertia=np.diag([1e-3, 2e-3, 3e-3]), offset=(0.05, 0.0, 0.0))
    mesh = hung(mesh, rigids=(cf.imported.Rigid(reference=node, nodes=mesh.groups["tip"].nodes),), masses=(mass,))
    part = cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()}, rotation=Z)
    K, M, G = at_speed(replace(part, rotation=None))
    values = eigh(K, M, eigvals_only=True)
    at = int(mesh.node_numbers[node])
    basis = cf.reduce(part, interface=cf.modal.AtNodes((at,)), modes=4)
    np.testing.assert_allclose(basis.omega[:4] ** 2, values[:4], rtol=1e-7)
    state = np.block([[np.zeros_like(K), np.eye(len(K))], [-np.linalg.solve(M, K), -np.linalg.solve(M, G)]])
    poles = np.sort(np.abs(np.linalg.eigvals(state).imag))[::2]
    np.testing.assert_allclose(2.0 * np.pi * cf.modal.whirl_modes(part, 4).freq, poles[:4], rtol=1e-5)


@pytest.mark.slow
def test_connections_of_a_part_in_large_rotation_are_taken_at_rest_and_unknown_turns_refused():
    """A mass with inertia on a spring moves no node as it turns: a curve over the speed cannot follow it."""
    mesh = cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u * 0.1, groups={"root": (0, 0.0)})
    mesh, (node,) = added_nodes(mesh, (0.3, 0.0, 0.0))
    heavy = cf.imported.PointMass(node=node, mass=1.0, inertia=np.eye(3))
    part = cf.Solid(mesh=hung(mesh, masses=(heavy,), springs=ground(node, SPRINGS)), material=STEEL,
                 supports={"root": cf.Clamped()}, rotation=Z)  # fmt: skip
    with pytest.raises(
        cf.errors.ModelError, match=r"found rotary inertia on a rotation that moves no other node.*mesh-attachment"
    ):
        cf.campbell(part, [0.0, 10.0], count=2)
    assert part.spin(replace(part, rotation=None).assembled(), Z).steady is None
