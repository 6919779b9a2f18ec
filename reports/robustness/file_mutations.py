"""Damaged files for every reader: what is refused, what reads as before, and where what is read differs.

`python -m reports.robustness.file_mutations [--quick] [--out DIR]`. One small file of each kind is damaged in one place
a time, seeded, by the damages of `uff_mutations` and by flipped bits, and read by the package's own reader, in
processes that are killed beyond 10 s or 2 GB. A refusal is the package's own error; anything else raised is a
traceback. What is accepted is compared with what the whole file holds: where it differs, the table
`file_mutations_differ.csv` says in what. A digit that becomes another no reader of plain numbers can see.
"""

import os
import resource
import signal
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.experiment.frf.files import read_frfs
from casingfem.structure.imported.grid import grid_mesh
from casingfem.structure.imported.read import read_mesh
from casingfem.study.load import load_any
from reports.robustness.broken.files import FREE, STUDY
from reports.robustness.set_kills import SWEEP
from reports.robustness.uff_mutations import DAMAGES
from reports.tables import Row, command_line, show, write

EACH, QUICK, BATCH = 400, 20, 20
SECONDS, BYTES = 10, 2e9
OWN = (ct.InputError, ct.NumericsError, cf.errors.InputError, cf.errors.NumericsError)
TABLE = (
    "# SYNTHETIC\nmode,n,freq_hz,sigma_hz,angle_deg,zeta\n1,8,371.2,0.4,12.0,0.0021\n2,8,373.9,0.4,,\n3,7,402.5,0.4,,\n"
)
Reader = Callable[[Path], object]


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
    """Whole files by kind: bytes, ending, reader."""
    angles = np.arange(0, 360, 10)
    survey = "# SYNTHETIC\ntheta_deg,z_m,radius_m\n" + "".join(
        f"{a},{z},{0.5 - 0.2 * z:.4f}\n" for z in (0.0, 0.2) for a in angles
    )
    study = STUDY.replace('survey = "survey.csv"\nn_max = 4\ndegree = 1', "harmonics = [{p = 8, cos = 0.001}]")
    assert FREE in study
    body().save(folder / "body.npz")
    frfs().save(folder / "frfs.npz")
    frfs().to_csv(folder / "frfs.csv")
    return {
        "table.csv": (TABLE.encode(), ".csv", cf.FrequencyTable.from_csv),
        "survey.csv": (survey.encode(), ".csv", cf.SurveyField.from_csv),
        "frfs.csv": ((folder / "frfs.csv").read_bytes(), ".csv", read_frfs),
        "frfs.npz": ((folder / "frfs.npz").read_bytes(), ".npz", read_frfs),
        "body.npz": ((folder / "body.npz").read_bytes(), ".npz", ct.ModalBody.load),
        "study.toml": (study.encode(), ".toml", lambda path: load_any(path).file),
        "scene.toml": (SWEEP.format(k=1e4).encode(), ".toml", lambda path: ct.load_scene(path).what),
        "mesh.inp": (inp().encode(), ".inp", read_mesh),
        "mesh.bdf": (bdf().encode(), ".bdf", read_mesh),
        "mesh.msh": (msh().encode(), ".msh", read_mesh),
    }


def leaves(value: object, name: str = "") -> Iterator[tuple[str, object]]:
    """What a read value holds, place by place."""
    if isinstance(value, np.ndarray):
        yield name, (value.shape, value.tobytes())
    elif hasattr(value, "model_dump"):
        yield from leaves(value.model_dump(), name)
    elif is_dataclass(value):
        for f in fields(value):
            if f.name not in ("path", "source"):
                yield from leaves(getattr(value, f.name), f"{name}.{f.name}")
    elif isinstance(value, dict) or hasattr(value, "items"):
        for key, part in dict(value).items():  # type: ignore[call-overload]
            yield from leaves(part, f"{name}.{key}")
    elif isinstance(value, list | tuple):
        for part in value:
            yield from leaves(part, name)
        yield f"{name} (count)", len(value)
    else:
        yield name, repr(value)


def flipped(data: bytes, rng: np.random.Generator) -> bytes:
    """One bit changed."""
    place = int(rng.integers(len(data)))
    return data[:place] + bytes([data[place] ^ 1 << int(rng.integers(8))]) + data[place + 1 :]


def mutants(data: bytes, name: str, each: int) -> list[tuple[str, bytes]]:
    """Damaged copies, the damages in turn."""
    rng = np.random.default_rng([20264, *name.encode()])
    text = b"\n" in data and not data.startswith(b"PK")
    suited = [d for d in DAMAGES if text and d not in ("wrong count", "D exponents")] + ["bit flipped"] * 3
    chosen = [suited[k % len(suited)] for k in range(each)]
    return [(d, flipped(data, rng) if d == "bit flipped" else DAMAGES[d](data, rng, ())) for d in chosen]


def judged(reader: Reader, path: Path, whole: dict[str, object]) -> tuple[str, str]:
    """What a reader makes of a file: refused, same, differs (and where), traceback (and what)."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = dict(leaves(reader(path)))
    except OWN:
        return "refused", ""
    except OSError:
        return "refused", ""
    except Exception as error:
        return "TRACEBACK", f"{type(error).__name__}: {str(error)[:80]}"
    if found == whole:
        return "same", ""
    said = any(isinstance(entry.message, cf.errors.ModelWarning) for entry in caught)
    where = sorted(name for name in whole.keys() | found.keys() if whole.get(name) != found.get(name))
    return "differs, warned" if said else "differs", ", ".join(where[:3])


def work(pipe: Connection, name: str, batch: list[tuple[str, bytes]]) -> None:
    """Judge a batch, in a child: an answer for each file as it comes."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        data, ending, reader = kinds(folder)[name]
        path = folder / f"file{ending}"
        path.write_bytes(data)
        whole = dict(leaves(reader(path)))
        resource.setrlimit(resource.RLIMIT_AS, (int(BYTES) + used(),) * 2)
        for damage, mutant in batch:
            path.write_bytes(mutant)
            signal.alarm(SECONDS)
            pipe.send((damage, *judged(reader, path, whole)))
            signal.alarm(0)
    pipe.close()


def used() -> int:
    """Address space of this process [bytes]."""
    pages = Path("/proc/self/statm").read_text().split()[0] if Path("/proc/self/statm").exists() else "0"
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def verdicts(name: str, each: int) -> Iterator[tuple[str, str, str]]:
    """Damage, verdict and detail of each mutant; a child that does not answer hangs or has died of it."""
    with tempfile.TemporaryDirectory() as place:
        todo = mutants(kinds(Path(place))[name][0], name, each)
    context = get_context("spawn")
    while todo:
        here, there = context.Pipe(duplex=False)
        batch = todo[: BATCH * 20]
        child = context.Process(target=work, args=(there, name, batch))
        child.start()
        there.close()
        done = 0
        try:
            while True:
                yield here.recv()
                done += 1
        except EOFError:
            child.join()
        if done < len(batch):
            yield batch[done][0], "HANG OR DEATH", f"exit {child.exitcode}"
            done += 1
        todo = todo[done:]


def main(out: Path, quick: bool = False) -> list[Row]:
    """Damage every kind of file, count, and list what differs."""
    rows: list[Row] = []
    differ: Counter[tuple[str, ...]] = Counter()
    with tempfile.TemporaryDirectory() as place:
        names = list(kinds(Path(place)))
    for name in names:
        counts: Counter[str] = Counter()
        for damage, verdict, detail in verdicts(name, QUICK if quick else EACH):
            counts[verdict] += 1
            if verdict not in ("refused", "same"):
                differ[name, damage, verdict, detail] += 1
        outcomes = ("refused", "same", "differs, warned", "differs", "TRACEBACK", "HANG OR DEATH")
        faults = counts["TRACEBACK"] + counts["HANG OR DEATH"]
        rows.append(
            {"file": name, "mutants": sum(counts.values()), **{o: counts[o] for o in outcomes}, "failed": faults}
        )
    show("Damaged files", rows)
    listed: list[Row] = [
        dict(zip(("file", "damage", "verdict", "in"), key, strict=True)) | {"times": times}
        for key, times in sorted(differ.items())
    ]
    write(out / "file_mutations.csv", rows)
    if listed:
        write(out / "file_mutations_differ.csv", listed)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
