"""Solids: patch tests, volume, rigid motions, frequencies of beams and cubes, supports, materials."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh

import casingfem as cf

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")  # coarse rings, only compared with each other

SOLIDS = ("tetra", "tetra10", "hexahedron", "hexahedron20", "hexahedron27")
SHELLS = ("quad", "quad8", "quad9")
QUADRATIC = tuple(kind for kind in SOLIDS if kind[-1].isdigit())


def bar(kind, counts=(6, 2, 2), size=(1.0, 0.1, 0.1)):
    ends = {"root": (0, 0.0), "tip": (0, 1.0), "low": (1, 0.0), "bottom": (2, 0.0)}
    return cf.imported.grid_mesh(kind, counts, lambda u: u * size, groups=ends)


def frequencies(system, count=8):
    values = eigsh(system.K, count, M=system.M, sigma=-1e2, return_eigenvectors=False)
    return np.sqrt(np.abs(np.sort(values))) / (2 * np.pi)


def bent(u):
    """A cube with curved faces: quadratic in each coordinate."""
    x, y, z = u.T
    return np.stack([x + 0.1 * y * z, y - 0.08 * x**2, z + 0.12 * x * y], axis=1)


@pytest.mark.parametrize("kind", QUADRATIC)
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
def test_constant_strain_needs_no_inner_forces(kind, steel):
    """The patch test on distorted cells: displacements linear in x give forces on the boundary only."""
    mesh = cf.imported.grid_mesh(kind, (2, 2, 2), lambda u: u + 0.04 * np.sin(3.0 * u[:, [1, 2, 0]]) * u * (1 - u))
    system = cf.Solid(mesh=mesh, material=steel).assembled()
    gradient = np.array([[1.0, 0.3, -0.2], [0.1, -0.5, 0.7], [0.4, 0.2, 0.9]])
    force = system.K @ (mesh.points @ gradient).ravel()
    on_boundary = np.unique(mesh.facet_nodes(mesh.boundary))
    inner = np.setdiff1d(np.arange(len(mesh.points)), on_boundary)
    assert len(inner)
    assert np.abs(force.reshape(-1, 3)[inner]).max() < 1e-11 * np.abs(force).max()


@pytest.mark.parametrize("kind", SOLIDS)
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
def test_free_body_has_six_rigid_motions_without_energy_and_its_mass(kind, steel):
    system = cf.Solid(mesh=bar(kind), material=steel).assembled()
    assert system.rigid == 6
    x = system.points
    turn = np.cross([0.3, -0.2, 0.5], x).ravel()
    assert np.abs(system.K @ turn).max() < 1e-11 * np.abs(system.K).max() * np.abs(turn).max()
    assert system.M.sum() == pytest.approx(3 * 7800.0 * 0.01, rel=1e-12)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron27"])
def test_curved_geometry_is_kept(kind, steel):
    """A quarter of a percent of the ring's volume is lost if its cells' middle nodes are straightened."""
    ring = cf.imported.grid_mesh(kind, (1, 20, 2), cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.02), wrap=1)
    volume = cf.Solid(mesh=ring, material=steel).assembled().M.sum() / 3 / 7800.0
    exact = 2 * np.pi * 0.475 * 0.02 * np.hypot(0.25, 0.05)
    assert volume == pytest.approx(exact, rel=1e-4)


def test_curved_cells_integrate_a_known_volume(steel):
    mesh = cf.imported.grid_mesh("hexahedron27", (1, 1, 1), bent)
    finer = cf.imported.grid_mesh("hexahedron27", (4, 4, 4), bent)
    one, many = (cf.Solid(mesh=m, material=steel).assembled().M.sum() for m in (mesh, finer))
    assert one == pytest.approx(many, rel=1e-12)  # the map is in the element's space: any division gives the same


@pytest.mark.parametrize("kind", QUADRATIC)
def test_axial_modes_of_a_guided_bar_are_exact(kind):
    """Held sideways everywhere, nu = 0: omega = c pi k/L; order four in the element length."""
    material = cf.Material(E=200e9, nu=0.0, rho=8000.0)
    errors = []
    for count in (4, 8):
        mesh = bar(kind, (count, 1, 1))
        everywhere = cf.imported.Group(nodes=np.arange(len(mesh.points)))
        mesh = cf.imported.MeshData(kind=kind, points=mesh.points, cells=mesh.cells, groups={"all": everywhere})
        solid = cf.Solid(mesh=mesh, material=material, supports={"all": cf.imported.Fixed(directions=("y", "z"))})
        system = solid.assembled()
        assert system.rigid == 1
        exact = np.sqrt(200e9 / 8000.0) / 2.0
        errors.append(frequencies(system, 2)[1] / exact - 1)
    assert 0 < errors[1] < 1e-4
    assert 12 < errors[0] / errors[1] < 20


def test_foundation_on_a_face_is_a_spring_under_a_rigid_block(steel):
    """A stiff block on k [N/m^3]: omega^2 = k/(rho h) for each translation, less the block's own give."""
    mesh = bar("hexahedron20", (2, 2, 2), (0.1, 0.1, 0.1))
    system = cf.Solid(mesh=mesh, material=steel, supports={"bottom": cf.ElasticEdge(k_face=1e7)}).assembled()
    assert system.rigid == 0
    total = np.tile(np.eye(3)[2], len(mesh.points))
    assert total @ (system.K @ total) == pytest.approx(1e7 * 0.01, rel=1e-6)
    assert np.abs(frequencies(system, 6) - np.sqrt(1e7 / 780.0) / 2 / np.pi).min() < 1e-3


@pytest.mark.parametrize(
    ("supports", "left"),
    [
        ({"root": cf.Clamped()}, 0),
        ({"root": cf.imported.Fixed(directions=("x",))}, 3),
        ({"root": cf.imported.Fixed(directions=("x",)), "low": cf.imported.Fixed(directions=("y",))}, 1),
        ({"bottom": cf.ElasticEdge(k_face=1e6)}, 0),
        ({}, 6),
    ],
)
def test_rigid_motions_that_supports_leave(supports, left, steel):
    assert cf.Solid(mesh=bar("tetra10"), material=steel, supports=supports).assembled().rigid == left


def test_materials_by_group_act_where_they_are(steel):
    mesh = bar("hexahedron20", (4, 1, 1))
    halves = {"left": cf.imported.Group(nodes=mesh.cells[:2].ravel(), cells=np.arange(2))}
    mesh = cf.imported.MeshData(kind=mesh.kind, points=mesh.points, cells=mesh.cells, groups=halves)
    light = cf.Material(E=210e9, nu=0.3, rho=1000.0)
    system = cf.Solid(mesh=mesh, material=steel, materials={"left": light}).assembled()
    assert system.M.sum() == pytest.approx(3 * 0.005 * 8800.0)
    with pytest.raises(cf.errors.ModelError, match="mesh-group-no-cells"):
        cf.Solid(mesh=bar("hexahedron20"), material=steel, materials={"root": light})


def test_a_cell_in_two_materials_is_named(steel):
    mesh = bar("hexahedron20", (4, 1, 1))
    groups = {
        name: cf.imported.Group(nodes=mesh.cells[k].ravel(), cells=np.array(k))
        for name, k in {"a": [0, 1], "b": [1]}.items()
    }
    mesh = cf.imported.MeshData(
        kind=mesh.kind, points=mesh.points, cells=mesh.cells, groups=groups, cell_numbers=np.arange(11, 15)
    )
    with pytest.raises(cf.errors.ModelError, match=r"cell 12 has the materials of 'a' and 'b'.*mesh-material-twice"):
        cf.Solid(mesh=mesh, material=steel, materials={"a": steel, "b": steel})


def test_refuses_supports_that_solids_cannot_have(steel):
    mesh = bar("hexahedron20")
    with pytest.raises(cf.errors.ModelError, match="mesh-support"):
        cf.Solid(mesh=mesh, material=steel, supports={"root": cf.ElasticEdge(k_r=1e6)})
    with pytest.raises(cf.errors.ModelError, match="mesh-support"):
        cf.Solid(mesh=mesh, material=steel, supports={"root": cf.ShearDiaphragm()})
    pinned = replace(mesh, groups={"pin": cf.imported.Group(nodes=mesh.groups["root"].nodes[:3])})
    with pytest.raises(cf.errors.ModelError, match=r"support.pin.*mesh-group-no-facets"):
        cf.Solid(mesh=pinned, material=steel, supports={"pin": cf.ElasticEdge(k_face=1e6)})
    with pytest.raises(cf.errors.ModelError, match=r"no group 'rot' \(did you mean 'root'"):
        cf.Solid(mesh=mesh, material=steel, supports={"rot": cf.Clamped()})


@pytest.mark.parametrize("kind", SHELLS)
def test_cells_of_shells_are_no_solid(kind, steel):
    skin = cf.imported.grid_mesh(kind, (1, 1), lambda u: np.insert(u, 2, 0.0, axis=1))
    with pytest.raises(cf.errors.ModelError, match=rf"cells of kind {kind}; .*mesh-not-solid"):
        cf.Solid(mesh=skin, material=steel)


def test_linear_cells_are_doubted_and_lock(steel):
    with pytest.warns(cf.errors.ModelWarning, match="mesh-linear-cells"):
        solid = cf.Solid(mesh=bar("hexahedron", (6, 1, 1)), material=steel, supports={"root": cf.Clamped()})
    good = cf.Solid(mesh=bar("hexahedron20", (6, 1, 1)), material=steel, supports={"root": cf.Clamped()})
    locked, sound = (frequencies(s.assembled(), 2)[0] for s in (solid, good))
    assert locked > 1.3 * sound
    assert sound == pytest.approx(83.8, rel=0.02)  # .5596 h/L^2 sqrt(E/12 rho) of a slender cantilever: 83.8
