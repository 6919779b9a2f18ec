"""Numbers held: cells, attachments, ties, sectors and files of small meshes."""

import numpy as np
import pytest

import casingfem as cf
from reports.verification.modes.cyclic import bent_plate, bladed_disk
from reports.verification.modes.mesh_files import write_bdf, write_inp
from tests.casingfem.structure.imported.parts import STEEL, added_nodes, hung, supported
from tests.casingfem.structure.imported.test_mixed_cells import mixed
from tests.probed import probed

QUIET = ("mesh-linear-cells", "mesh-thin-curved", "mesh-aspect", "mesh-orphan-nodes", "mesh-kink")
pytestmark = [pytest.mark.filterwarnings(f"ignore:.*{code}") for code in QUIET]
ENDS = {"root": (0, 0.0), "tip": (0, 1.0)}
BODIES = ("hexahedron", "hexahedron20", "hexahedron27", "tetra", "tetra10")
SKINS = ("quad", "quad8", "quad9")
AROUND = cf.Rotation(omega=300.0, axis=(0.0, 1.0, 0.5), centre=(-0.2, 0.02, 0.01))


def bent(u):
    return (u + 0.1 * np.sin(3.0 * u[:, [1, 2, 0]]) * u * (1.0 - u) - [0.0, 0.5, 0.5]) * [0.3, 0.1, 0.06]


def skin(u):
    return cf.imported.revolved((0.3, 0.28), (0.0, 0.2), 0.02)(
        np.column_stack([np.full(len(u), 0.5), 0.2 * u[:, 0], u[:, 1]])
    )


def body(kind):
    return supported(cf.imported.grid_mesh(kind, (2, 1, 1), bent, groups=ENDS))


def plate(kind):
    mesh = cf.imported.grid_mesh(kind, (2, 2), skin, groups=ENDS)
    return cf.MeshShell(mesh=mesh, thickness=4e-3, material=STEEL, supports={"root": cf.Clamped()})


def numbers_of(part):
    """Matrices and static answers of a part that is fixed."""
    system = part.assembled()
    mesh = part.mesh
    node = int(mesh.node_numbers[mesh.groups["tip"].nodes[-1]])
    loads = [
        cf.loads.EdgeLoad(edge="tip", force=(1e3, -5e2, 2e3)),
        cf.imported.NodeLoad(node=node, force=(1e2, 2e2, -3e2)),
        cf.imported.FacetPressure(group="tip", pressure=1e4),
    ]
    if mesh.cell_kind.dim == 2:
        loads.pop()
    if not len(mesh.attachments.masses):
        loads.append(cf.loads.Gravity(acceleration=(1.0, -2.0, 3.0)))
    found = [cf.solve_static(part, [load]) for load in loads]
    return {
        "size": [system.size, len(mesh.points), len(mesh.boundary)],
        "K": probed(system.K),
        "M": probed(system.M),
        "energy": [one.energy for one in found],
        "at": [one.at(node) for one in found],
    }


@pytest.mark.parametrize("kind", BODIES)
def test_numbers_of_bodies(kind, held):
    held(**numbers_of(body(kind)), freq=cf.modes(body(kind), 3).freq)


@pytest.mark.parametrize("kind", SKINS)
def test_numbers_of_skins(kind, held):
    held(**numbers_of(plate(kind)), freq=cf.modes(plate(kind), 3).freq)


def test_numbers_of_mixed_cells(held, tmp_path):
    mesh = mixed(tmp_path, (3, 1, 1), bend=0.1)
    system = supported(mesh).assembled()
    held(K=probed(system.K), M=probed(system.M), size=[system.size, len(mesh.cells), len(mesh.boundary)])


def flat(kind):
    """A straight part along x, of cells of the wall or of its mid-surface."""
    if kind == "quad9":
        mesh = cf.imported.grid_mesh(
            kind, (2, 2), lambda u: np.insert((u - [0.0, 0.5]) * [0.11, 0.04], 2, 0.0, axis=1), groups=ENDS
        )
        return cf.MeshShell(mesh=mesh, thickness=3e-3, material=STEEL, supports={"root": cf.Clamped()}, rotation=AROUND)
    mesh = cf.imported.grid_mesh(kind, (3, 1, 1), lambda u: (u - [0.0, 0.5, 0.5]) * [0.11, 0.04, 3e-3], groups=ENDS)
    return supported(mesh, rotation=AROUND)


@pytest.mark.slow
def test_numbers_of_attachments(held):
    mesh, (end, middle) = added_nodes(
        cf.imported.grid_mesh("hexahedron20", (2, 1, 1), bent, groups=ENDS), (0.35, 0.0, 0.0), (0.4, 0.01, 0.0)
    )
    tip = mesh.groups["tip"].nodes
    mass = cf.imported.PointMass(node=end, mass=0.3, inertia=np.diag([1e-4, 2e-4, 3e-4]), offset=(0.0, 0.01, 0.02))
    springs = tuple(
        cf.imported.Spring(terms=(cf.imported.Term(end, c, 1.0), cf.imported.Term(middle, c, -1.0)), stiffness=k)
        for c, k in enumerate((3e6, 2e6, 1e6))
    ) + tuple(cf.imported.Spring(terms=(cf.imported.Term(middle, c, 1.0),), stiffness=5e6) for c in range(3))
    links = {
        "rigid": {"rigids": (cf.imported.Rigid(reference=end, nodes=tip),)},
        "mean": {"means": (cf.imported.Mean(reference=end, nodes=tip, weights=np.linspace(1.0, 2.0, len(tip))),)},
    }
    found = {}
    for name, link in links.items():
        part = supported(hung(mesh, **link, masses=(mass,), springs=springs))
        numbers = numbers_of(part) | {"freq": cf.modes(part, 4).freq}
        found |= {f"{key} {name}": value for key, value in numbers.items()}
    held(**found)


@pytest.mark.parametrize("kind", ["hexahedron20", "quad8"])
def test_numbers_of_ties(kind, held):
    flat = kind == "quad8"

    def upon(z):
        place = cf.imported.revolved((0.5, 0.5), z, 0.05)
        return (
            (lambda u: place(np.column_stack([np.full(len(u), 0.5), 0.5 * u[:, 0], u[:, 1]])))
            if flat
            else (lambda u: place(u * [1.0, 0.5, 1.0]))
        )

    ends = {"low": (1 if flat else 2, 0.0), "high": (1 if flat else 2, 1.0)}
    first, other = ((3, 1), (4, 1)) if flat else ((1, 3, 1), (1, 4, 1))
    pair = cf.imported.beside(
        {
            "a": cf.imported.grid_mesh(kind, first, upon((0.0, 0.2)), groups=ends),
            "b": cf.imported.grid_mesh(kind, other, upon((0.2, 0.5)), groups=ends),
        }
    )
    mesh = cf.imported.tied(pair, [cf.imported.Gluing(follower="b.low", master="a.high")])
    supports = {"a.low": cf.Clamped()}
    part = (
        cf.MeshShell(mesh=mesh, thickness=0.05, material=STEEL, supports=supports) if flat else supported(mesh, "a.low")
    )
    system = part.assembled()
    held(
        K=probed(system.K),
        M=probed(system.M),
        size=[system.size],
        freq=cf.modes(part, 4).freq,
        points=probed(mesh.points),
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["disk", "turning disk", "bent plate"])
def test_numbers_of_sectors(name, held):
    turning = cf.Rotation(omega=300.0)
    sector = (
        bent_plate(3, turning, (3, 1))
        if name == "bent plate"
        else bladed_disk(4, (1, 1, 2, 1), turning if "turning" in name else None)
    )
    found = cf.modal.cyclic_modes(sector, 3)
    columns = {"freq": found.freq, "n": found.nodal_diameters}
    if name == "disk":
        tips, deviations = cf.TipNodes("tip", 2), np.array([0.02, -0.01, 0.0, -0.03])
        made = cf.modal.cyclic_reduce(sector, tips, modes=3, deviations=deviations, blade="blade")
        columns |= {
            "omega": made.omega,
            "compliance": probed(made.compliance),
            "mistuned": cf.modal.mistuned_modes(sector, deviations, count=3, blade="blade").freq,
        }
    else:
        columns["whirl"] = cf.modal.cyclic_whirl(sector, 3).freq
    held(1e-5, **columns)


@pytest.mark.parametrize("kind", ["hexahedron20", "tetra10", "quad8"])
@pytest.mark.parametrize("write", [write_inp, write_bdf], ids=["inp", "bdf"])
def test_numbers_of_files(kind, write, held, tmp_path):
    mesh = cf.imported.grid_mesh(
        kind, (2, 1) if kind == "quad8" else (2, 1, 1), skin if kind == "quad8" else bent, groups=ENDS
    )
    path = tmp_path / f"part.{write.__name__[-3:]}"
    write(mesh, path)
    found = cf.read_mesh(path, scale=2.0)
    groups = {name: group.nodes for name, group in found.groups.items() if name != "body"}
    held(
        points=probed(found.points),
        cells=probed(found.cells),
        **{f"nodes {k}": np.sort(nodes) for k, nodes in enumerate(groups.values())},
    )
