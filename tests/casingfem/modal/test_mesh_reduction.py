"""Reduction of imported parts: static compliance, interfaces against those of charts, outputs, refusals."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf

TABLE = cf.FrequencyTable.from_csv(Path(__file__).parents[3] / "data" / "experiments" / "rig_casing.csv")
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
ENDS = {"root": (0, 0.0), "tip": (0, 1.0)}
CLAMPED = {"root": cf.Clamped()}


def blade_place(u):
    """A twisted blade: 30 degrees over its span."""
    a = np.radians(30.0) * u[:, 0]
    y, z = 0.04 * (u[:, 1] - 0.5), 0.005 * (u[:, 2] - 0.5)
    return np.stack([0.11 * u[:, 0], np.cos(a) * y - np.sin(a) * z, np.sin(a) * y + np.cos(a) * z], axis=1)


def solid(kind="hexahedron20", counts=(6, 3, 1)):
    return cf.Solid(
        mesh=cf.imported.grid_mesh(kind, counts, blade_place, groups=ENDS), material=STEEL, supports=CLAMPED
    )


def strip(counts=(6, 3), flip=False):
    """A flat blade as an imported shell."""

    def place(u):
        y = (0.5 - u[:, 1] if flip else u[:, 1] - 0.5) * 0.04
        return np.stack([0.11 * u[:, 0], y, 0.0 * y], axis=1)

    mesh = cf.imported.grid_mesh("quad9", counts, place, groups=ENDS)
    return cf.MeshShell(mesh=mesh, thickness=5.4e-3, material=STEEL, supports=CLAMPED)


def ring(kind="quad9", counts=(24, 3), place=None, thickness=0.02):
    wall = place or cf.imported.revolved((0.5, 0.45), (0.0, 0.25), thickness)
    groups = {"base": (1, 0.0), "top": (1, 1.0)}
    mesh = cf.imported.grid_mesh(kind, counts, lambda u: wall(np.insert(u, 0, 0.5, axis=1)), groups=groups, wrap=0)
    return cf.MeshShell(mesh=mesh, thickness=thickness, material=STEEL, supports={"base": cf.Clamped()})


def tube(groups):
    """A casing of solids."""
    mesh = cf.imported.grid_mesh(
        "hexahedron20", (1, 48, 5), cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.02), groups=groups, wrap=1
    )
    return cf.Solid(mesh=mesh, material=STEEL, supports={"base": cf.Clamped()})


def corners(structure):
    """Two nodes at the tip by their numbers."""
    mesh = structure.mesh
    tip = mesh.groups["tip"].nodes
    return tuple(mesh.node_numbers[tip[[0, len(tip) // 2]]].tolist())


@pytest.mark.slow
@pytest.mark.parametrize("method", ["free", "craig-bampton"])
@pytest.mark.parametrize("part", [solid, lambda: solid("tetra10", (5, 2, 1)), strip], ids=["brick", "tetra", "shell"])
def test_compliance_at_nodes_is_the_static_answer_to_forces_there(part, method):
    """rows diag(1/omega^2) rows^T + S column by column against a static solution of its own."""
    structure = part()
    nodes = corners(structure)
    basis = cf.reduce(structure, cf.modal.AtNodes(nodes), modes=8, method=method)
    assert basis.channels[:3] == tuple(f"{nodes[0]}.{axis}" for axis in "xyz")
    for k, node in enumerate(nodes):
        for i, force in enumerate(np.eye(3)):
            bent = cf.solve_static(structure, [cf.imported.NodeLoad(node=node, force=tuple(force))])
            answer = np.concatenate([bent.at(other) for other in nodes])
            np.testing.assert_allclose(
                basis.compliance[:, 3 * k + i], answer, rtol=1e-7, atol=1e-9 * np.abs(answer).max()
            )
    if method == "free":
        np.testing.assert_allclose(basis.freq, cf.modes(structure, 8).freq, rtol=1e-12)
        assert np.linalg.eigvalsh(basis.S).min() > -1e-12 * np.trace(basis.S)


@pytest.mark.parametrize("interface", [cf.Tip("tip"), cf.TipNodes("tip", 3)], ids=["one", "pieces"])
@pytest.mark.slow
def test_a_tip_is_that_of_the_same_blade_on_a_chart(interface):
    chart = cf.Shell(
        chart=cf.Plate(length=0.11, width=0.04), thickness=5.4e-3, material=STEEL, supports=CLAMPED,
        mesh=cf.ShellMesh(order=8, rows=2, around=2),
    )  # fmt: skip
    exact = cf.reduce(chart, interface, modes=6)
    found = cf.reduce(strip((24, 12)), interface, modes=6)
    np.testing.assert_allclose(found.freq, exact.freq, rtol=1e-3)
    assert found.channels == exact.channels
    np.testing.assert_allclose(found.compliance, exact.compliance, atol=1e-3 * np.abs(exact.compliance).max())
    np.testing.assert_allclose(found.participation**2, exact.participation**2, atol=1e-3 * 0.5)
    directions = found.provenance["directions"]
    np.testing.assert_allclose(list(directions.values()), [[1, 0, 0], [0, 0, 1], [0, 1, 0]], atol=1e-9)


@pytest.mark.slow
def test_a_rim_is_that_of_the_same_casing_on_a_chart():
    chart = cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=0.01, material=STEEL,
        supports={"base": cf.Clamped()}, wall="linear", shear_correction=5.0 / (6.0 - STEEL.nu),  # as imported shells
        mesh=cf.ShellMesh(order=8, rows=(0.0, 0.97, 1.0), around=10),
    )  # fmt: skip
    rim = cf.Rim("top", n_max=6, axial=True)
    exact, found = (cf.reduce(part, rim, modes=12) for part in (chart, ring(counts=(72, 12), thickness=0.01)))
    np.testing.assert_allclose(found.freq, exact.freq, rtol=1e-3)
    np.testing.assert_allclose(found.compliance, exact.compliance, atol=4e-3 * np.abs(exact.compliance).max())
    assert found.channels == exact.channels
    assert found.radius == pytest.approx(0.45, rel=1e-5)
    np.testing.assert_allclose(found.lines, [[0.25, 0.45]], rtol=1e-5)
    assert np.abs(found.out_of_roundness).max() < 1e-9


@pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")
@pytest.mark.slow
def test_a_solids_rim_is_its_end_face():
    found = cf.reduce(tube({"base": (2, 0.0), "top": (2, 1.0)}), cf.Rim("top", n_max=3), modes=6)
    exact = cf.reduce(ring(), cf.Rim("top", n_max=3), modes=6)
    np.testing.assert_allclose(found.freq, exact.freq, rtol=2e-2)
    np.testing.assert_allclose(np.diag(found.compliance), np.diag(exact.compliance), rtol=3e-2)


@pytest.mark.slow
def test_an_oval_rim_knows_its_shape():
    wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.02)

    def place(u):
        x = wall(u)
        x[:, :2] *= 1.0 + 1e-3 * np.cos(3 * np.arctan2(x[:, 1], x[:, 0]) - 0.4)[:, None]
        return x

    shape = cf.reduce(ring(place=place), cf.Rim("top", n_max=16), modes=4).out_of_roundness[0]  # no node resolves more
    np.testing.assert_allclose(shape[[3, 16 + 3]], 0.45e-3 * np.array([np.cos(0.4), np.sin(0.4)]), rtol=1e-3)
    assert np.abs(np.delete(shape, [3, 19])).max() < 2e-6


def test_stress_of_a_pulled_bar_is_force_over_area():
    mesh = cf.imported.grid_mesh("tetra10", (2, 1, 1), lambda u: u * [1.0, 0.1, 0.1], groups=ENDS)
    bar = cf.Solid(mesh=mesh, material=replace(STEEL, nu=0.0), supports=CLAMPED)
    pulled = cf.solve_static(bar, [cf.loads.EdgeLoad(edge="tip", force=(3e6, 0.0, 0.0))])
    row = cf.modal.NodeStress(name="s", node=int(mesh.node_numbers[0]), component="xx").row(bar.assembled())
    assert float((row * pulled.fields).sum()) == pytest.approx(3e6, rel=1e-9)
    row = cf.modal.NodeStrain(name="e", node=int(mesh.node_numbers[-1]), component="xx").row(bar.assembled())
    assert float((row * pulled.fields).sum()) == pytest.approx(3e6 / 210e9, rel=1e-9)


@dataclass(frozen=True)
class Doubled:
    """A structure of one's own: a solid twice as stiff, by the members that `MeshStructure` names and no more."""

    solid: cf.Solid

    @property
    def mesh(self):
        return self.solid.mesh

    @property
    def supports(self):
        return self.solid.supports

    def density(self):
        return self.solid.density()

    def assembled(self):
        system = self.solid.assembled()
        return replace(system, structure=self, K=2.0 * system.K)


@pytest.mark.slow
def test_a_structure_of_ones_own_needs_the_protocol_alone():
    one, twice = solid(), Doubled(solid())
    np.testing.assert_allclose(cf.modes(twice, 4).freq, np.sqrt(2.0) * cf.modes(one, 4).freq, rtol=1e-9)
    a, b = (cf.reduce(part, cf.TipNodes("tip", 2), modes=4) for part in (one, twice))
    np.testing.assert_allclose(b.compliance, 0.5 * a.compliance, atol=1e-9 * np.abs(a.compliance).max())
    load = [cf.loads.Gravity()]
    assert cf.solve_static(twice, load).energy == pytest.approx(0.5 * cf.solve_static(one, load).energy)


@dataclass(frozen=True)
class Rotating(Doubled):
    """A solid as it is, with a rotation and without the members that model it."""

    rotation: cf.Rotation | None = None

    def assembled(self):
        return replace(replace(self.solid, rotation=self.rotation).assembled(), structure=self)


@dataclass(frozen=True)
class Modelled(Rotating):
    """The same with all members of `TurningStructure`."""

    def spin(self, at_rest, rotation):
        return self.solid.spin(at_rest, rotation)

    def turning(self, at_rest, rotation):
        return self.solid.turning(at_rest, rotation)


@pytest.mark.slow
def test_a_structure_of_ones_own_rotates_by_the_members_of_the_protocol():
    rotation = cf.Rotation(omega=800.0, axis=(0.0, 0.0, 1.0), centre=(-0.2, 0.0, 0.0))
    one, own = replace(solid(), rotation=rotation), Modelled(solid(), rotation)
    np.testing.assert_allclose(cf.modes(own, 4).freq, cf.modes(one, 4).freq, rtol=1e-9)
    drawn, expected = (cf.campbell(part, [0.0, 500.0], 3).freq for part in (own, one))
    np.testing.assert_allclose(drawn, expected, rtol=1e-9)
    with pytest.warns(cf.errors.ModelWarning, match="reduce-steady"):
        a, b = (cf.reduce(part, cf.TipNodes("tip", 2), modes=4) for part in (one, own))
    largest = np.abs(a.stiffness_by_speed).max()
    np.testing.assert_allclose(np.abs(b.stiffness_by_speed), np.abs(a.stiffness_by_speed), atol=1e-6 * largest)
    assert a.spin == b.spin != 0.0


def test_a_rotation_without_the_members_that_model_it_is_refused():
    own = Rotating(solid(), cf.Rotation(omega=800.0, axis=(0.0, 0.0, 1.0), centre=(-0.2, 0.0, 0.0)))
    found = r"rotation: found a rotating Rotating without spin and turning, expected .*structure-unknown"
    for call in (
        lambda: cf.modes(own, 2), lambda: cf.campbell(own, [0.0], 2), lambda: cf.whirl_modes(own, 2),
        lambda: cf.reduce(own, cf.TipNodes("tip", 2), modes=2),
    ):  # fmt: skip
        with pytest.raises(cf.errors.ModelError, match=found):
            call()


def cornered():
    """A solid with a group of one node, which no facet has as its only one."""
    part = solid()
    corner = cf.imported.Group(nodes=part.mesh.groups["tip"].nodes[:1])
    return replace(part, mesh=replace(part.mesh, groups={**part.mesh.groups, "corner": corner}))


OPEN = cf.imported.grid_mesh(
    "quad9",
    (12, 2),
    lambda u: cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.02)(np.insert(u, 0, 0.5, axis=1) * [1, 0.8, 1]),
    groups={"base": (1, 0.0), "top": (1, 1.0)},
)
BAD = {
    "no node": (solid, cf.modal.AtNodes((1, 99999)), "node 99999 that no cell has"),
    "twice": (solid, cf.modal.AtNodes((1, 1)), "each once"),
    "held": (solid, cf.modal.AtNodes((1,)), "node 1 fixed"),
    "corner": (cornered, cf.Tip("corner"), "grid: interface 'corner'; .*mesh-group-no-facets"),
    "no pieces": (
        solid,
        cf.TipNodes("tip", 0),
        "TipNodes.count must lie between 1 and 100, found 0; .*interface-nodes",
    ),
    "101 pieces": (solid, cf.TipNodes("tip", 101), "TipNodes.count must lie between 1 and 100, found 101"),
    "100 pieces": (solid, cf.TipNodes("tip", 100), "piece 0 of 100 on 'tip' has no facet"),
    "group": (solid, cf.Tip("tpi"), "no group 'tpi' .did you mean 'tip'"),
    "pieces": (lambda: strip((2, 1)), cf.TipNodes("tip", 60), "has no facet"),
    "held edge": (solid, cf.Tip("root"), "'root' is fixed"),
    "harmonics": (ring, cf.Rim("top", 17), "between 1 and 16 on 'top', found 17"),
    "lines": (ring, cf.Rim("top", 3, lines=(0.1,)), "lines: found 0.1 m on an imported mesh"),
    "gaps": (
        lambda: cf.MeshShell(mesh=OPEN, thickness=0.02, material=STEEL, supports={"base": cf.Clamped()}),
        cf.Rim("top", 3),
        "found a gap of 7. degrees in 'top'",
    ),
    "all round": (lambda: tube({"base": (2, 0.0), "top": (0, 1.0)}), cf.Tip("top"), "whose normals cancel"),
    "free": (lambda: replace(solid(), supports={}), cf.Tip("tip"), "rigid motions"),
    "chart": (
        lambda: cf.Shell(chart=cf.Plate(length=1.0, width=1.0), thickness=0.1, material=STEEL, supports=CLAMPED),
        cf.modal.AtNodes((3,)),
        "nodes 3 of a chart",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", BAD)
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
def test_interfaces_that_are_not_there_are_named(name):
    part, interface, message = BAD[name]
    with pytest.raises(cf.errors.ModelError, match=message):
        cf.reduce(part(), interface, modes=3)


def test_a_chart_axis_is_z():
    casing = cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=0.2), thickness=0.02, material=STEEL, supports={"base": cf.Clamped()}
    )
    with pytest.raises(cf.errors.ModelError, match=r"axis \(1\.0, 0\.0, 0\.0\) .* expected z on a chart"):
        cf.reduce(casing, cf.Rim("top", 3, axis=(1.0, 0.0, 0.0)), modes=3)


def test_outputs_of_the_wrong_kind_of_structure_are_refused_in_words():
    chart = cf.Shell(chart=cf.Plate(length=1.0, width=1.0), thickness=0.1, material=STEEL, supports=CLAMPED)
    for part, output, message in (
        (chart, cf.modal.NodeDisplacement(name="a", node=1, direction="x"), "node 1 on a chart"),
        (solid(), cf.modal.Displacement(name="a", at=(0.0, 0.0)), "parameters of a chart on an imported part"),
        (solid(), cf.modal.NodeStress(name="a", node=99999, component="xx"), "node 99999, expected a node of a cell"),
        (solid(), cf.modal.NodeStress(name="a", node=1, component="rr"), "component 'rr'"),
        (strip(), cf.modal.NodeStrain(name="a", node=1, component="xx"), "strains at nodes are computed for solids"),
        (solid(), cf.modal.NodeDisplacement(name="a", node=1, direction="r"), "direction 'r'"),
    ):
        with pytest.raises(cf.errors.ModelError, match=message):
            cf.reduce(part, cf.Tip("tip"), modes=3, outputs=[output])


@pytest.mark.parametrize(
    "call",
    [
        lambda x: cf.modes(x, 3),
        lambda x: cf.solve_static(x, [cf.loads.Gravity()]),
        lambda x: cf.reduce(x, cf.Tip("tip")),
    ],
)
def test_what_is_no_structure_is_reported_what_it_lacks(call):
    with pytest.raises(cf.errors.ModelError, match="found Material, which has no mesh, supports, density, assembled"):
        call(STEEL)


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("mistune", lambda x: cf.modal.mistune(x, 1)),
        ("out_of_roundness", lambda x: cf.modal.out_of_roundness(x, cf.Rim("top"))),
        ("locate", lambda x: cf.locate(x, TABLE)),
    ],
)
def test_what_needs_a_chart_states_so(name, call):
    with pytest.raises(cf.errors.ModelError, match=f"{name}: found Solid, which has no chart; .*structure-chart"):
        call(solid())


def turned_basis(axis, origin):
    """The basis of a ring whose axis of rotation is moved to another one, and its static compliance around."""
    a = np.array(axis) / np.linalg.norm(axis)
    e1 = np.cross(a, [0.3, -0.8, 0.5])
    e1 /= np.linalg.norm(e1)
    frame = np.array([e1, np.cross(a, e1), a])
    wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.02)
    casing = ring(place=lambda u: wall(u) @ frame + origin)
    basis = cf.reduce(casing, cf.Rim("top", 3, axis=tuple(axis), point=tuple(origin)), modes=8)
    return basis, basis.rows / basis.omega**2 @ basis.rows.T + basis.S


@pytest.mark.slow
def test_a_rim_about_any_axis_is_the_one_about_z():
    """Frequencies, and compliance of each wave whatever the angle from which it is counted."""
    straight, flexible = turned_basis((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    basis, turned = turned_basis((-2.0, 0.1, -1.5), (0.4, -0.2, 0.7))
    np.testing.assert_allclose(basis.freq, straight.freq, rtol=1e-8)
    names = [name.split(".") for name in basis.channels]
    for direction in ("radial", "tangential", "axial"):
        for n in range(4):
            at = [k for k, (one, wave) in enumerate(names) if one == direction and wave in (f"cos{n}", f"sin{n}")]
            if at:
                trace = np.trace(turned[np.ix_(at, at)])
                assert trace == pytest.approx(np.trace(flexible[np.ix_(at, at)]), rel=1e-6)
