"""Rows of outputs against fields that the elements carry exactly, and what bases and matrices say of themselves."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
PANEL = cf.shell.assemble(
    cf.Shell(
        chart=cf.Panel(radius=0.5, length=0.3, angle=0.8), thickness=4e-3, material=STEEL,
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=4, rows=1, around=1),
    )
)  # fmt: skip
PLATE = cf.shell.assemble(
    cf.Shell(
        chart=cf.Plate(length=0.3, width=0.2), thickness=4e-3, material=STEEL,
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=4, rows=1, around=1),
    )
)  # fmt: skip
AT = (0.13, 0.07)


@pytest.mark.parametrize("direction", ["x", "y", "z", "normal", "radial", "tangential"])
def test_a_displacement_is_read_along_its_direction(direction):
    a, b = PANEL.grid.nodes
    fields = np.stack([1.0 + a**2, b + 3.0 * a, a * b - 2.0, 1e6 * a, 1e6 * b], axis=1)
    here = np.array([1.0 + AT[0] ** 2, AT[1] + 3.0 * AT[0], AT[0] * AT[1] - 2.0])
    x, y, _ = PANEL.shell.geometry(*(np.array([v]) for v in AT)).surface.x[:, 0]
    c, s = x / np.hypot(x, y), y / np.hypot(x, y)
    units = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1], "radial": [c, s, 0.0], "tangential": [-s, c, 0.0]}
    row = cf.modal.Displacement(name="u", at=AT, direction=direction).row(PANEL)
    if direction == "normal":
        assert cf.modal.Displacement(name="u", at=AT).direction == "normal"
        assert abs(np.sum(row * fields)) == pytest.approx(abs(here @ [c, s, 0.0]), rel=1e-9)
    else:
        assert np.sum(row * fields) == pytest.approx(here @ units[direction], rel=1e-9)


@pytest.mark.parametrize("side", [-1.0, 0.0, 0.5, 1.0])
@pytest.mark.parametrize("component", ["11", "22", "12"])
def test_strains_of_a_plate_are_those_of_membrane_and_bending(component, side):
    x, y = PLATE.grid.nodes
    fields = np.zeros((len(x), 5))
    fields[:, 0], fields[:, 1] = 2.0 * x**2 + 3.0 * y, 0.5 * y**2 - x * y
    fields[:, 3], fields[:, 4] = 7.0 * x + 2.0 * y**2, 11.0 * y + 5.0 * x
    a, b = AT
    membrane = {"11": 4.0 * a, "22": b - a, "12": 3.0 - b}[component]
    bending = {"11": 7.0, "22": 11.0, "12": 4.0 * b + 5.0}[component]
    row = cf.modal.Strain(name="e", at=AT, component=component, side=side).row(PLATE)
    assert np.sum(row * fields) == pytest.approx(membrane + side * 2e-3 * bending, rel=1e-9)
    assert (cf.modal.Strain(name="e", at=AT).component, cf.modal.Strain(name="e", at=AT).side) == ("11", 1.0)


@pytest.mark.parametrize(
    ("output", "words"),
    [
        (cf.modal.Strain(name="e", at=AT, component="13"), "output 'e': found component '13', side 1.0"),
        (cf.modal.Strain(name="e", at=AT, side=1.001), "found component '11', side 1.001"),
        (cf.modal.Strain(name="e", at=AT, side=-1.001), "side -1.001"),
        (cf.modal.Displacement(name="u", at=AT, direction="w"), "output 'u': found direction 'w'"),
        (cf.modal.Displacement(name="u", at=(0.4, 0.0)), "output 'u': "),
        (cf.modal.NodeDisplacement(name="n", node=3, direction="x"), "output 'n': found node 3 on a chart"),
    ],
)
def test_outputs_that_a_chart_does_not_have_are_refused(output, words):
    with pytest.raises(cf.errors.ModelError) as caught:
        output.row(PLATE)
    assert words in str(caught.value)


MESH = cf.imported.grid_mesh(
    "hexahedron20", (2, 1, 1), lambda u: u * [0.4, 0.1, 0.2] + 0.03 * np.roll(u, 1, axis=1) ** 2,
    groups={"root": (0, 0.0)},
)  # fmt: skip
SOLID = cf.Solid(mesh=MESH, material=STEEL, supports={"root": cf.Clamped()}).assembled()
GRADIENT = np.array([[1.0, 2.0, -3.0], [0.5, -4.0, 5.0], [7.0, 0.25, 6.0]])  # d u_i / d x_j
SHARED = int(MESH.node_numbers[np.flatnonzero(np.bincount(MESH.cells.ravel()) == 2)[0]])
ALONE = int(MESH.node_numbers[np.flatnonzero(np.bincount(MESH.cells.ravel()) == 1)[0]])


def linear():
    return SOLID.points @ GRADIENT.T + [1.0, 2.0, 3.0]


@pytest.mark.parametrize("node", [SHARED, ALONE])
def test_strains_and_stresses_at_a_node_of_a_solid_are_those_of_its_linear_field(node):
    strain = {name: GRADIENT[i, i] for i, name in enumerate(("xx", "yy", "zz"))}
    strain |= {name: GRADIENT[i, j] + GRADIENT[j, i] for name, i, j in (("yz", 1, 2), ("xz", 0, 2), ("xy", 0, 1))}
    G = 210e9 / 2.6
    lame = 0.3 * 210e9 / (1.3 * 0.4)
    for name, value in strain.items():
        row = cf.modal.NodeStrain(name="e", node=node, component=name).row(SOLID)
        assert np.sum(row * linear()) == pytest.approx(value, rel=1e-8), name
        normal = name[0] == name[1]
        stress = 2.0 * G * value + lame * np.trace(GRADIENT) if normal else G * value
        row = cf.modal.NodeStress(name="s", node=node, component=name).row(SOLID)
        assert np.sum(row * linear()) == pytest.approx(stress, rel=1e-8), name


@pytest.mark.parametrize(("direction", "column"), [("x", 0), ("y", 1), ("z", 2)])
def test_a_displacement_of_a_node_is_its_own(direction, column):
    row = cf.modal.NodeDisplacement(name="u", node=ALONE, direction=direction).row(SOLID)
    place = int(np.flatnonzero(MESH.node_numbers == ALONE)[0])
    assert np.sum(row * linear()) == pytest.approx(linear()[place, column], rel=1e-14)


@pytest.mark.parametrize(
    ("output", "words"),
    [
        (cf.modal.NodeStrain(name="e", node=ALONE, component="zx"), "output 'e': found component 'zx'"),
        (
            cf.modal.NodeStrain(name="e", node=10**6, component="xx"),
            "output 'e': found node 1000000, expected a node of a cell",
        ),
        (cf.modal.NodeDisplacement(name="u", node=ALONE, direction="r"), "output 'u': found direction 'r'"),
        (cf.modal.Displacement(name="d", at=AT), "output 'd': found parameters of a chart on an imported part"),
    ],
)
def test_outputs_that_a_solid_does_not_have_are_refused(output, words):
    with pytest.raises(cf.errors.ModelError) as caught:
        output.row(SOLID)
    assert words in str(caught.value)


def basis(S, channels=("6.x", "6.z"), zeta=0.02):
    rows = np.array([[1.0, 0.5, -0.2], [0.3, -1.0, 0.7]])
    return cf.ModalBasis(
        omega=np.array([10.0, 20.0, 40.0]), zeta=np.full(3, zeta), channels=channels, rows=rows, S=S, kind="point"
    )


@pytest.mark.parametrize("S", [np.array([[1e-3, 2e-4], [2e-4, 2e-3]]), np.zeros((2, 2))])
@pytest.mark.parametrize("zeta", [0.0, 0.02])
def test_matrices_of_a_basis_answer_as_it_does(S, zeta):
    """u = rows (omega^2 - w^2 + 2 i zeta omega w)^-1 rows^T + S at any frequency."""
    given = basis(S, zeta=zeta)
    found = cf.modal.basis_matrices(given)
    w = 13.0
    C = np.zeros(found.K.shape) if found.C is None else found.C.toarray()
    assert (found.C is None) == (zeta == 0.0)
    dynamic = found.K.toarray() - w**2 * found.M.toarray() + 1j * w * C
    modal = given.omega**2 - w**2 + 2j * zeta * given.omega * w
    np.testing.assert_allclose(np.linalg.inv(dynamic)[:2, :2], (given.rows / modal) @ given.rows.T + S, rtol=1e-9)
    assert len(found.dofs) == len(dynamic)


def test_matrices_of_channels_that_hang_together_are_refused():
    with pytest.raises(cf.errors.ModelError, match="found a singular S"):
        cf.modal.basis_matrices(basis(np.array([[1.0, 1.0], [1.0, 1.0]]) * 1e-3))
    given = basis(np.zeros((2, 2)))
    with pytest.raises(cf.errors.ModelError, match="found 2 channels whose motions in 3 modes are not independent"):
        cf.modal.basis_matrices(replace(given, rows=np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]])))
    few = cf.ModalBasis(
        omega=np.ones(1), zeta=np.zeros(1), channels=("a", "b"), rows=np.ones((2, 1)), S=np.zeros((2, 2)), kind="point"
    )
    with pytest.raises(cf.errors.ModelError, match="found 2 channels whose motions in 1 modes"):
        cf.modal.basis_matrices(few)
