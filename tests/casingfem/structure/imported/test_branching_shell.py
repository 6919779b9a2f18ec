"""Shells whose walls branch and fold: a box of seven walls, a T, and what must not change their frequencies."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main

FILES = Path(__file__).parent / "branching"
STEEL = cf.Material(E=207e9, nu=0.3, rho=7850.0)


def part(name):
    """A mesh of the folder."""
    return cf.read_mesh(FILES / f"{name}.inp")


def shell(mesh, thickness=1e-3, *, held=True, **given):
    supports = {"BASE": cf.Clamped()} if held else {}
    return cf.MeshShell(mesh=mesh, thickness=thickness, material=STEEL, supports=supports, **given)


def frequencies(mesh, thickness=1e-3, count=12, *, held=True):
    return cf.modes(shell(mesh, thickness, held=held), count).freq


def permuted(mesh):
    """The same with nodes and cells in another order, cells beginning at another corner."""
    rng = np.random.default_rng(1)
    order = rng.permutation(len(mesh.points))
    place = np.argsort(order)
    cells = np.roll(place[mesh.cells][rng.permutation(len(mesh.cells))], 1, axis=1)
    groups = {name: cf.imported.Group(nodes=place[group.nodes]) for name, group in mesh.groups.items()}
    return cf.imported.MeshData(kind=mesh.kind, points=mesh.points[order], cells=cells, groups=groups)


def test_a_branched_shell_that_spins_is_stiffer():
    """A T whose web runs along the radius, clamped at its root 0.3 m from the axis: a beam so long has 2.8 Omega^2."""
    mesh = part("tee")
    root = cf.imported.Group(nodes=np.flatnonzero(mesh.points[:, 1] < 1e-9))
    mesh = replace(mesh, groups={"BASE": root})
    spin = cf.Rotation(omega=60.0, axis=(0.0, 0.0, 1.0), centre=(0.2, -0.3, 0.0))
    at_rest, spinning = (cf.modes(shell(mesh, rotation=rotation), 3).freq for rotation in (None, spin))
    rise = (spinning**2 - at_rest**2) / (60.0 / (2.0 * np.pi)) ** 2
    assert ((rise > 1.0) & (rise < 4.0)).all()


def test_a_sector_of_a_wheel_may_not_branch():
    with pytest.raises(
        cf.errors.ModelError, match=r"tee\.inp: found a sector with walls that meet.*7 nodes.*mesh-branch"
    ):
        cf.imported.CyclicSector(structure=shell(part("tee")), sectors=12)


def cut(mesh):
    """Nodes of the squares and of the triangles (m, 3) of a mesh with every third square of `mesh` cut in two."""
    third = np.arange(len(mesh.cells)) % 3 == 0
    halves = mesh.cells[third]
    return mesh.cells[~third], np.concatenate([halves[:, [0, 1, 2]], halves[:, [0, 2, 3]]])


def as_inp(mesh, quads, triangles):
    rows = [f"{k}, {x:.17g}, {y:.17g}, {z:.17g}" for k, (x, y, z) in enumerate(mesh.points, 1)]
    cells = [f"{k}, {', '.join(map(str, cell + 1))}" for k, cell in enumerate([*quads, *triangles], 1)]
    held = [f"{node + 1}," for node in mesh.groups["BASE"].nodes]
    squares, halves = cells[: len(quads)], cells[len(quads) :]
    elements = ["*ELEMENT, TYPE=S4", *squares, "*ELEMENT, TYPE=S3", *halves]
    return "\n".join(["*NODE", *rows, *elements, "*NSET, NSET=BASE", *held]) + "\n"


def as_bdf(mesh, quads, triangles):
    rows = [f"GRID,{k},,{x:.14f},{y:.14f},{z:.14f}" for k, (x, y, z) in enumerate(mesh.points, 1)]
    cells = [f"CQUAD4,{k},1,{','.join(map(str, cell + 1))}" for k, cell in enumerate(quads, 1)]
    cells += [f"CTRIA3,{k},1,{','.join(map(str, cell + 1))}" for k, cell in enumerate(triangles, len(quads) + 1)]
    held = [f"SPC1,1,123456,{node + 1}" for node in mesh.groups["BASE"].nodes]
    return "\n".join(["BEGIN BULK", *rows, *cells, *held, "ENDDATA"]) + "\n"


def as_msh(mesh, quads, triangles):
    rows = [f"{k} {x:.17g} {y:.17g} {z:.17g}" for k, (x, y, z) in enumerate(mesh.points, 1)]
    held = mesh.groups["BASE"].nodes
    edges = mesh.facets.reshape(-1, 2)
    ends = edges[np.isin(edges, held).all(axis=1)]
    kinds = [(1, 2, ends), (3, 1, quads), (2, 1, triangles)]  # Gmsh's number of the kind, physical group, cells
    cells = [f"{kind} 2 {tag} {tag} {' '.join(map(str, cell + 1))}" for kind, tag, part in kinds for cell in part]
    return "\n".join([
        "$MeshFormat", "2.2 0 8", "$EndMeshFormat",
        "$PhysicalNames", "2", '2 1 "WALL"', '1 2 "BASE"', "$EndPhysicalNames",
        "$Nodes", str(len(rows)), *rows, "$EndNodes",
        "$Elements", str(len(cells)), *(f"{k} {cell}" for k, cell in enumerate(cells, 1)), "$EndElements", "",
    ])  # fmt: skip


@pytest.mark.slow
def test_triangles_among_squares_branch_in_every_format_alike(tmp_path):
    tee = part("tee")
    found = []
    for name, write in (("tee.inp", as_inp), ("tee.bdf", as_bdf), ("tee.msh", as_msh)):
        (tmp_path / name).write_text(write(tee, *cut(tee)))
        mesh = cf.read_mesh(tmp_path / name)
        base = min(mesh.groups, key=lambda name: mesh.groups[name].nodes.size)  # each format names it as it does
        structure = cf.MeshShell(mesh=mesh, thickness=1e-3, material=STEEL, supports={base: cf.Clamped()})
        assert len(structure.apart.meeting) == 7
        found.append(cf.modes(structure, 6).freq)
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=1e-9)
    np.testing.assert_allclose(found[0], frequencies(tee, 1e-3, 6), rtol=0.2)


def test_the_compliance_of_a_basis_at_a_joint_is_the_static_answer_there():
    """Node 32 lies on the line where plate and web meet, 84 on the web's far corner."""
    structure = shell(part("tee"))
    basis = cf.reduce(structure, cf.modal.AtNodes((32, 84)), modes=6)
    np.testing.assert_allclose(basis.freq, cf.modes(structure, 6).freq, rtol=1e-10)
    for column, (node, force) in enumerate((node, force) for node in (32, 84) for force in np.eye(3).tolist()):
        bent = cf.solve_static(structure, [cf.imported.NodeLoad(node=node, force=tuple(force))])
        answer = np.concatenate([bent.at(32), bent.at(84)])
        np.testing.assert_allclose(basis.compliance[:, column], answer, rtol=1e-6, atol=1e-9 * np.abs(answer).max())


def test_the_frame_of_a_webs_tip_is_that_of_the_web_however_cells_are_numbered():
    """The web's upper edge: span along z, chord along y, flap along the web's normal."""
    for mesh in (part("tee"), permuted(part("tee"))):
        rim = cf.imported.Group(nodes=np.flatnonzero(mesh.points[:, 2] > 0.15 - 1e-9))
        basis = cf.reduce(shell(replace(mesh, groups={**mesh.groups, "rim": rim})), cf.Tip("rim"), modes=4)
        found = np.abs(list(basis.provenance["directions"].values()))
        np.testing.assert_allclose(found, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-9)


@pytest.mark.slow
def test_what_hangs_on_a_joint_feels_its_whole_rotation():
    """A mass on an arm as such, behind a joint as the reference of a rigid connection, in front of one: all alike."""
    tee = part("tee")
    points = np.vstack([tee.points, [0.2, 0.15, -0.03]])
    mesh, far, joint = replace(tee, points=points, node_numbers=np.zeros(0, dtype=int)), len(tee.points), 31
    J = np.diag([1e-4, 2e-4, 3e-4])
    masses = (cf.imported.PointMass(node=far, mass=0.2, inertia=J),)
    own = cf.imported.PointMass(node=joint, mass=0.2, inertia=J, offset=(0.0, 0.0, -0.03))
    spin = cf.Rotation(omega=60.0, axis=(0.0, 0.0, 1.0), centre=(0.2, -0.3, 0.0))
    for rotation in (None, spin):
        found = []
        for on, given in (
            (tee, {"masses": (own,)}),
            (mesh, {"masses": masses, "rigids": (cf.imported.Rigid(reference=joint, nodes=np.array([far])),)}),
            (mesh, {"masses": masses, "rigids": (cf.imported.Rigid(reference=far, nodes=np.array([joint])),)}),
        ):
            root = cf.imported.Group(nodes=np.flatnonzero(on.points[:, 1] < 1e-9))
            whole = replace(on, groups={"BASE": root}, attachments=cf.imported.Attachments(**given))
            found.append(cf.modes(shell(whole, 2e-3, rotation=rotation), 6).freq)
        np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=1e-8)


@pytest.mark.slow
def test_the_command_line_takes_a_branching_shell(tmp_path):
    (tmp_path / "tee.inp").write_bytes((FILES / "tee.inp").read_bytes())
    study = tmp_path / "tee.toml"
    study.write_text("""
[material]
E = 207e9
nu = 0.3
rho = 7850.0
[shell]
mesh = "tee.inp"
thickness = 1e-3
[support.BASE]
kind = "clamped"
[modes]
count = 4
[reduce]
at = [32, 84]
modes = 4
""")
    result = CliRunner().invoke(main, ["modes", str(study), "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    assert "warning" not in result.output
    freq = pd.read_csv(tmp_path / "out" / "modes.csv", comment="#")["freq_hz"]
    np.testing.assert_allclose(freq, frequencies(part("tee"), 1e-3, 4), rtol=1e-6)
    result = CliRunner().invoke(main, ["reduce", str(study), "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "out" / "tee.npz").exists()


@pytest.mark.filterwarnings("ignore:.*mesh-kink")
@pytest.mark.parametrize("angle", [30.0, 60.0, 90.0])
def test_a_folded_plate_settles_as_a_flat_one_does(angle):
    """Clamped across the fold; within 0.6 % of a mesh twice as fine. A mitred director is 3 % off at 60."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))

    def place(u):
        beyond = np.maximum(u[:, 0] - 0.5, 0.0)
        return np.stack([u[:, 0] - beyond * (1 - c), u[:, 1], beyond * s], axis=1)

    coarse, fine = (
        frequencies(cf.imported.grid_mesh("quad9", (n, n), place, groups={"BASE": (1, 0.0)}), 0.01, 4) for n in (4, 8)
    )
    np.testing.assert_allclose(coarse, fine, rtol=6e-3)
