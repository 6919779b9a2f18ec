"""Small whole files of every kind that the packages read, each with its reader."""

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
from scipy.sparse import csc_array

import casingfem as cf
import contact as ct
from casingfem.experiment.frf.files import read_frfs
from casingfem.experiment.frf.hdf5 import write_hdf5
from casingfem.experiment.uff.write import write_uff
from casingfem.structure.imported.grid import grid_mesh
from casingfem.structure.imported.matrix.matrix_set import MatrixSet
from casingfem.structure.imported.matrix.read import read_matrices
from casingfem.structure.imported.matrix.write import matrix_files
from casingfem.structure.imported.read import read_mesh
from casingfem.study.load import load_any
from reports.robustness.broken.files import FREE, STUDY
from reports.robustness.set_kills import SWEEP
from reports.robustness.uff_samples import samples

Reader = Callable[[Path], object]
TABLE = (
    "# SYNTHETIC\nmode,n,freq_hz,sigma_hz,angle_deg,zeta\n1,8,371.2,0.4,12.0,0.0021\n2,8,373.9,0.4,,\n3,7,402.5,0.4,,\n"
)


def inp() -> str:
    """Two bricks as Abaqus writes them."""
    mesh = grid_mesh("hexahedron", (2, 1, 1), lambda u: u * [0.2, 0.1, 0.05], groups={})
    nodes = "".join(f"{k}, {x:.6f}, {y:.6f}, {z:.6f}\n" for k, (x, y, z) in enumerate(mesh.points, 1))
    cells = "".join(f"{k}, {', '.join(map(str, cell + 1))}\n" for k, cell in enumerate(mesh.cells, 1))
    return f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=body\n{cells}*NSET, NSET=root\n1, 2, 3, 4\n"


def bdf() -> str:
    """One tetrahedron in large and free fields."""
    return (
        "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID*   2                               0.2             0.\n*       0.1\n"
        "GRID,3,,0.,.2,0.\nGRID,4,,0.,0.,.2\nCTETRA,7,5,1,2,3,4\nSPC1,3,123,1,2\nENDDATA\n"
    )


def msh() -> str:
    """The same for Gmsh."""
    nodes = "1 0 0 0\n2 0.2 0 0.1\n3 0 0.2 0\n4 0 0 0.2\n"
    return (
        '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 "body"\n$EndPhysicalNames\n'
        f"$Nodes\n4\n{nodes}$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"
    )


def cdb() -> str:
    """One tetrahedron as Ansys writes it: blocks of fixed columns, a component."""
    points = ((0.0, 0.0, 0.0), (0.2, 0.0, 0.1), (0.0, 0.2, 0.0), (0.0, 0.0, 0.2))
    nodes = "".join(
        f"{k:9d}{0:9d}{0:9d}" + "".join(f"{x:21.13E}" for x in row) + "\n" for k, row in enumerate(points, 1)
    )
    numbers = "".join(f"{n:9d}" for n in (1, 1, 1, 1, 0, 0, 0, 0, 4, 0, 1, 1, 2, 3, 4))
    return (
        f"/PREP7\nET,1,285\nNBLOCK,6,SOLID,{4:9d},{4:9d}\n(3i9,6e21.13e2)\n{nodes}N,R5.3,LOC,       -1,\n"
        f"EBLOCK,19,SOLID,{1:9d},{1:9d}\n(19i9)\n{numbers}\n       -1\n"
        "CMBLOCK,ROOT    ,NODE,       2\n(8i10)\n         1         2\n"
    )


def meshio_files(folder: Path) -> None:
    """The tetrahedron as VTU and as Gmsh 4.1 in binary."""
    points = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.1], [0.0, 0.2, 0.0], [0.0, 0.0, 0.2]])
    mesh = meshio.Mesh(points, [("tetra", np.array([[0, 1, 2, 3]]))])
    meshio.write(folder / "mesh.vtu", mesh)
    meshio.gmsh.write(folder / "binary.msh", mesh, fmt_version="4.1", binary=True)


def matrices() -> MatrixSet:
    """Two nodes of three directions on springs."""
    rng = np.random.default_rng(719)
    half = rng.normal(size=(6, 6))
    dofs = np.array([(node, direction) for node in (7, 9) for direction in (1, 2, 3)])
    return MatrixSet(
        K=csc_array(1e6 * (half @ half.T + 6.0 * np.eye(6))), M=csc_array(np.eye(6) * 0.25), dofs=dofs,
        points={7: np.zeros(3), 9: np.array([0.1, 0.0, 0.2])},
    )  # fmt: skip


def matrix_kinds(folder: Path) -> dict[str, tuple[bytes, str, Reader]]:
    """Matrices in each format; what belongs to the damaged file, beside it, stays whole."""
    whole = matrices()
    damaged = {form: f"part.{form}" for form in ("pch", "op4", "npz", "mat")} | {"mtx": "part_K.mtx"}
    found: dict[str, tuple[bytes, str, Reader]] = {}
    for form, damage in damaged.items():
        for name, content in matrix_files(whole, "part", form).items():
            (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
        found[f"matrices.{form}"] = ((folder / damage).read_bytes(), damage, read_part)
    lower = [(i, j) for j in range(6) for i in range(j, 6)]
    for ending, A in (("sti", whole.K.toarray()), ("mas", whole.M.toarray())):
        (folder / f"part.{ending}").write_text("".join(f"{j + 1} {i + 1} {A[i, j]:.12e}\n" for i, j in lower))
    (folder / "part.dof").write_text("".join(f"{node}.{direction}\n" for node, direction in whole.dofs.tolist()))
    return found | {
        f"matrices.{ending}": ((folder / f"part.{ending}").read_bytes(), f"part.{ending}", read_part)
        for ending in ("sti", "dof")
    }


def read_part(path: Path) -> object:
    """Matrices of a file, with what belongs to it beside it."""
    beside = [path.with_name("part_M.mtx")] if path.suffix == ".mtx" else []
    dofs = path.with_name("part_dofs.csv") if path.suffix in (".op4", ".mtx") else None
    return read_matrices([path, *beside], dofs=dofs)


def frfs() -> cf.frf.FrfSet:
    """Two responses."""
    rng = np.random.default_rng(719)
    values = rng.normal(size=(2, 40)) + 1j * rng.normal(size=(2, 40))
    return cf.frf.FrfSet.from_arrays(
        kind="frf", x=np.arange(40) * 0.25 + 10.0, responses=values, response_point=[3, 5], response_direction=[1, -1],
        unit="m/N", card=("SYNTHETIC: one",),
    )  # fmt: skip


def body() -> ct.ModalBody:
    """A blade of two modes."""
    return ct.ModalBody(
        omega=[2400.0, 15000.0], zeta=[0.002, 0.002], channels=("span", "flap"), rows=[[0.1, 0.2], [2.0, 0.5]],
        S=[[2e-8, 0.0], [0.0, 6e-8]],
    )  # fmt: skip


def kinds(folder: Path) -> dict[str, tuple[bytes, str, Reader]]:
    """Whole files by kind: bytes, name, reader."""
    angles = np.arange(0, 360, 10)
    survey = "# SYNTHETIC\ntheta_deg,z_m,radius_m\n" + "".join(
        f"{a},{z},{0.5 - 0.2 * z:.4f}\n" for z in (0.0, 0.2) for a in angles
    )
    study = STUDY.replace('survey = "survey.csv"\nn_max = 4\ndegree = 1', "harmonics = [{p = 8, cos = 0.001}]")
    assert FREE in study
    body().save(folder / "body.npz")
    frfs().save(folder / "frfs.npz")
    frfs().to_csv(folder / "frfs.csv")
    write_hdf5(frfs(), folder / "frfs.h5")
    for name in ("55", "58 complex double even", "58b complex double even", "2412"):
        write_uff(folder / f"{name}.uff", **samples()[name].parts)  # type: ignore[arg-type]
    meshio_files(folder)
    readers: tuple[tuple[str, Reader], ...] = (
        *(("frfs.csv", read_frfs), ("frfs.npz", read_frfs), ("frfs.h5", read_frfs), ("body.npz", ct.ModalBody.load)),
        *((path.name, cf.uff.read_uff) for path in sorted(folder.glob("*.uff"))),
        *(("mesh.vtu", read_mesh), ("binary.msh", read_mesh)),
    )
    texts: tuple[tuple[str, str, Reader], ...] = (
        ("table.csv", TABLE, cf.FrequencyTable.from_csv),
        ("survey.csv", survey, cf.SurveyField.from_csv),
        ("study.toml", study, lambda path: load_any(path).file),
        ("scene.toml", SWEEP.format(k=1e4), lambda path: ct.load_scene(path).what),
        *(("mesh.inp", inp(), read_mesh), ("mesh.bdf", bdf(), read_mesh), ("mesh.msh", msh(), read_mesh)),
        ("mesh.cdb", cdb(), read_mesh),
    )
    return (
        {name: (content.encode(), name, reader) for name, content, reader in texts}
        | {name: ((folder / name).read_bytes(), name, reader) for name, reader in readers}
        | matrix_kinds(folder)
    )
