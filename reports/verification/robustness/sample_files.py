"""Small whole files of every kind that the packages read, each with its reader, in one folder."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from scipy.sparse import csc_array

import casingfem as cf
import contact as ct
from casingfem.errors import InputError
from casingfem.experiment.circle.record import ScanRecord, turning
from casingfem.experiment.frf.files import read_frfs, read_picks, read_places, write_hdf5
from casingfem.experiment.identify.identified import Identified
from casingfem.experiment.uff.write import write_uff
from casingfem.modal.basis import ModalBasis
from casingfem.structure.imported.cyclic.sector import CyclicSector
from casingfem.structure.imported.grid import grid_mesh
from casingfem.structure.imported.matrix.matrix_set import MatrixSet
from casingfem.structure.imported.matrix.read import read_matrices
from casingfem.structure.imported.matrix.write import matrix_files
from casingfem.structure.imported.read import read_mesh
from casingfem.study.cyclic import read_deviations
from casingfem.study.load import load_study
from contact.io.outfiles import read_checked, write_checked
from contact.result import Result
from contact.scene.cycles import load_cycles
from contact.scene.rub import read_profile
from contact.scene.stability import load_interactions, load_stability
from contact.sweep.plan import load_sweep
from reports.tables import DATA
from reports.verification.robustness.broken.files import FREE, STUDY
from reports.verification.robustness.kill_targets import STUDY as UPDATE
from reports.verification.robustness.kill_targets import SWEEP
from reports.verification.robustness.mesh_samples import write_meshes
from reports.verification.robustness.uff_samples import samples

Reader = Callable[[Path], object]
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
UFF = ("55", "58 complex double even", "58b complex double even", "2412")
SCENES = (
    "pair",
    "cycles/rod_on_obstacle",
    "bladed_disk",
    "rotating_beam",
    "cantilever_on_stop",
    "coulomb_oscillator",
)  # read with no other file
TABLE = (
    "# SYNTHETIC\nmode,n,freq_hz,sigma_hz,angle_deg,zeta\n1,8,371.2,0.4,12.0,0.0021\n2,8,373.9,0.4,,\n3,7,402.5,0.4,,\n"
)
PLACES = "point,angle_deg,radius_m,z_m\n3,0.0,0.45,0.1\n5,36.5,0.45,0.1\n8,90.0,0.45,0.2\n"
PROFILE = "theta_deg,depth_m\n0,1e-5\n90,2.5e-5\n180,0\n270,-1e-5\n"
WHEEL = """[material]
E = 210e9
nu = 0.3
rho = 7800.0
[solid]
mesh = "cyclic.inp"
[cyclic]
sectors = 12
faces = ["low", "high"]
mistuning = "blades.csv"
[modes]
count = 4
[[support.base.spring]]
"""
TIED = """[material]
E = 210e9
nu = 0.3
rho = 7800.0
[shell]
mesh = "tied.inp"
thickness = 2e-3
[support."one.root"]
kind = "clamped"
[modes]
count = 4
"""
RIM = """[scene]
kind = "rim"
t_end = 0.05
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = 1e-4
friction = 0.1
out_of_roundness = [{p = 2, cos = 2e-4}]
[speed]
turning = "blades"
hz = 20.0
[scheme]
kind = "exact-modal"
dt = 2e-5
"""


def matrices() -> MatrixSet:
    """Two nodes of three directions on springs."""
    rng = np.random.default_rng(719)
    half = rng.normal(size=(6, 6))
    dofs = np.array([(node, direction) for node in (7, 9) for direction in (1, 2, 3)])
    return MatrixSet(
        K=csc_array(1e6 * (half @ half.T + 6.0 * np.eye(6))), M=csc_array(np.eye(6) * 0.25), dofs=dofs,
        points={7: np.zeros(3), 9: np.array([0.1, 0.0, 0.2])},
    )  # fmt: skip


def write_matrices(folder: Path) -> None:
    """Matrices in each format."""
    whole = matrices()
    for form in ("pch", "op4", "npz", "mat", "mtx"):
        for name, content in matrix_files(whole, "part", form).items():
            (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    dofs = whole.dofs.tolist()
    lower = [(i, j) for j in range(6) for i in range(j, 6)]
    for ending, name, A in (("sti", "K", whole.K.toarray()), ("mas", "M", whole.M.toarray())):
        (folder / f"part.{ending}").write_text("".join(f"{j + 1} {i + 1} {A[i, j]:.12e}\n" for i, j in lower))
        labelled = (f"{dofs[i][0]},{dofs[i][1]},{dofs[j][0]},{dofs[j][1]}, {A[i, j]:.12e}\n" for i, j in lower)
        (folder / f"abaqus_{name}.mtx").write_text("".join(labelled))
        (folder / f"dense_{name}.mtx").write_text(
            "%%MatrixMarket matrix array real general\n6 6\n" + "".join(f"{x:.12e}\n" for x in A.T.ravel())
        )
    (folder / "part.dof").write_text("".join(f"{node}.{direction}\n" for node, direction in dofs))
    (folder / "dense_K.dof").write_text((folder / "part.dof").read_text())
    with h5py.File(folder / "part.h5", "w") as file:
        file["K"], file["dofs"] = whole.K.toarray(), whole.dofs
        sparse = file.create_group("M")  # as MATLAB keeps it
        sparse.attrs["MATLAB_sparse"] = 6
        for name, values in (("data", whole.M.data), ("ir", whole.M.indices), ("jc", whole.M.indptr)):
            sparse.create_dataset(name, data=values, chunks=True, compression="gzip")
    (folder / "binary.op4").write_bytes(binary_op4(whole))


def binary_op4(whole: MatrixSet) -> bytes:
    """K and M as Nastran writes them in records of Fortran, whole columns."""

    def record(*parts: bytes) -> bytes:
        body = b"".join(parts)
        return np.int32(len(body)).tobytes() + body + np.int32(len(body)).tobytes()

    out = b""
    for name, A in (("K", whole.K.toarray()), ("M", whole.M.toarray())):
        n = len(A)
        out += record(np.array([n, n, 6, 2], dtype=np.int32).tobytes(), f"{name:8}".encode())
        for j, column in enumerate(A.T, 1):
            out += record(np.array([j, 1, 2 * n], dtype=np.int32).tobytes(), column.astype("<f8").tobytes())
        out += record(np.array([n + 1, 1, 2], dtype=np.int32).tobytes(), np.array([1.0]).tobytes())
    return out


def read_part(path: Path) -> object:
    """Matrices of a file, with its companion files."""
    other = path.with_name(path.name.replace("_K", "_M"))
    dofs = path.with_name("part_dofs.csv") if path.name in ("part.op4", "binary.op4", "part_K.mtx") else None
    return read_matrices([path, other] if path.suffix == ".mtx" else path, dofs=dofs)


def read_wheel(path: Path) -> object:
    """A sector of twelve of a mesh file, its faces found."""
    part = cf.MeshShell if path.name == "sector.inp" else cf.Solid
    more = {"thickness": 2e-3} if part is cf.MeshShell else {}
    return CyclicSector(structure=part(mesh=read_mesh(path), material=STEEL, **more), sectors=12).pairs


def read_row(path: Path) -> object:
    """The row of a run; a file that is not whole holds none."""
    row = read_checked(path, "row", format="sample")
    if row is None:
        raise InputError(str(path), found="no whole row", expected="one")
    return row


def frfs() -> cf.frf.FrfSet:
    """Two responses."""
    rng = np.random.default_rng(719)
    values = rng.normal(size=(2, 40)) + 1j * rng.normal(size=(2, 40))
    return cf.frf.FrfSet.from_arrays(
        kind="frf", x=np.arange(40) * 0.25 + 10.0, responses=values, response_point=[3, 5], response_direction=[1, -1],
        unit="m/N", card=("SYNTHETIC: one",),
    )  # fmt: skip


def write_tests(folder: Path) -> None:
    """Files of measurements: responses, a scan, identified modes, tables."""
    frfs().save(folder / "frfs.npz")
    frfs().to_csv(folder / "frfs.csv")
    write_hdf5(frfs(), folder / "frfs.h5")
    for name in UFF:
        write_uff(folder / f"{name}.uff", **samples()[name].parts)  # type: ignore[arg-type]
    angle = turning(2.5, 1000.0, 400)
    ScanRecord(fs=1000.0, velocity=np.cos(3.0 * angle), angle=angle, tones=(120.0, 240.5)).save(folder / "scan.npz")
    (folder / "identified.npz").write_bytes((DATA / "experiments" / "bench.npz").read_bytes())
    survey = "# SYNTHETIC\ntheta_deg,z_m,radius_m\n" + "".join(
        f"{a},{z},{0.5 - 0.2 * z:.4f}\n" for z in (0.0, 0.2) for a in np.arange(0, 360, 10)
    )
    deviations = "blade,deviation\n" + "".join(f"{k},{0.01 * (k % 3 - 1)}\n" for k in range(1, 13))
    tables = {
        "table.csv": TABLE, "survey.csv": survey, "blades.csv": deviations, "places.csv": PLACES,
        "picks.csv": "freq_hz\n371.2\n402.5\n", "profile.csv": PROFILE,
    }  # fmt: skip
    for name, text in tables.items():
        (folder / name).write_text(text, encoding="utf-8")


def write_models(folder: Path) -> None:
    """Studies, scenes, bases for them, a result and the row of a run."""
    study = STUDY.replace('survey = "survey.csv"\nn_max = 4\ndegree = 1', "harmonics = [{p = 8, cos = 0.001}]")
    assert FREE in study
    texts = {
        "study.toml": study, "update.toml": UPDATE.format(t=2e-3), "wheel.toml": WHEEL.partition("[[")[0],
        "tied.toml": TIED, "sweep.toml": SWEEP.format(k=1e4), "rim.toml": RIM,
        "interactions.toml": RIM.replace("hz = 20.0", "hz = 20.0\nscan = {from_hz = 5.0, to_hz = 40.0, steps = 8}"),
        "mistuning.toml": (DATA / "studies" / "mistuning.toml").read_text(encoding="utf-8"),
    }  # fmt: skip
    texts |= {f"{name}.toml": (DATA / "scenes" / f"{name}.toml").read_text(encoding="utf-8") for name in SCENES}
    for name, text in texts.items():
        (folder / name.rpartition("/")[2]).write_text(text, encoding="utf-8")
    ct.ModalBody(
        omega=[2400.0, 15000.0], zeta=[0.002, 0.002], channels=("span", "flap"), rows=[[0.1, 0.2], [2.0, 0.5]],
        S=[[2e-8, 0.0], [0.0, 6e-8]],
    ).save(folder / "blade.npz")  # fmt: skip
    ring = ct.bodies.ThinRing(radius=0.25, width=0.05, height=4e-3, E=210e9, rho=7800.0, k_r=2e7, k_t=2e6, zeta=0.005)
    ct.bodies.ring_modes(ring, 2).truncated(8e4).save(folder / "casing.npz")
    bricks = grid_mesh("hexahedron20", (2, 1, 1), lambda u: u * [0.2, 0.1, 0.05], groups={"root": (0, 0.0)})
    part = cf.Solid(mesh=bricks, material=STEEL, supports={"root": cf.Clamped()})
    basis = cf.reduce(part, cf.modal.AtNodes((12,)), modes=2, method="craig-bampton")
    basis.save(folder / "craig_bampton.npz")
    ct.run(ct.load_scene(folder / "coulomb_oscillator.toml")).save(folder / "result.npz")
    write_checked(folder / "run.json", "row", {"rms": 1.25e-4, "closings": 12, "failed": ""}, format="sample")


def read_study(path: Path) -> object:
    """Contents of a study, with all files that it names read and built."""
    return load_study(path, wheel=True).file


def read_scene(path: Path) -> object:
    """Contents of a scene, with all files that it names read."""
    return ct.load_scene(path).what


MESHES = ("mesh.inp", "tied.inp", "mesh.bdf", "shells.bdf", "mesh.msh", "text41.msh", "binary.msh", "mesh.vtu",
          "mesh.cdb", "shells.cdb", "mesh.unv")  # fmt: skip
PARTS = ("part.pch", "part.op4", "binary.op4", "part.npz", "part.mat", "part.h5", "part_K.mtx", "abaqus_K.mtx",
         "dense_K.mtx", "part.sti", "part.dof")  # fmt: skip
STUDIES = ("study.toml", "update.toml", "mistuning.toml", "wheel.toml", "tied.toml")
READERS: dict[str, Reader] = {
    "frfs.csv": read_frfs, "frfs.npz": read_frfs, "frfs.h5": read_frfs, "scan.npz": ScanRecord.load,
    "identified.npz": Identified.load, "table.csv": cf.FrequencyTable.from_csv, "survey.csv": cf.SurveyField.from_csv,
    "blades.csv": read_deviations, "places.csv": read_places, "picks.csv": read_picks, "profile.csv": read_profile,
    "blade.npz": ct.ModalBody.load, "craig_bampton.npz": ModalBasis.load, "result.npz": Result.load,
    "run.json": read_row, "sweep.toml": lambda path: load_sweep(path).runs,
    "cyclic.inp": read_wheel, "sector.inp": read_wheel, "pair.toml": load_stability,
    "interactions.toml": load_interactions, "rod_on_obstacle.toml": load_cycles,
} | {
    **{f"{name}.uff": cf.uff.read_uff for name in UFF}, **dict.fromkeys(MESHES, read_mesh),
    **dict.fromkeys(PARTS, read_part), **dict.fromkeys(STUDIES, read_study),
    **dict.fromkeys(("rim.toml", *(f"{name}.toml" for name in SCENES[2:])), read_scene),
}  # fmt: skip


def write_samples(folder: Path) -> None:
    """All files, and the files that they name."""
    write_meshes(folder)
    write_matrices(folder)
    write_tests(folder)
    write_models(folder)
