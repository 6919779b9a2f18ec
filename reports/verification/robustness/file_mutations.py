"""Damaged files for every reader: numbers that are refused, read unchanged, or read with differences.

`python -m reports.verification.robustness.file_mutations [--quick] [--count N] [--seed N] [--out DIR]`. A small file of
each kind (`sample_files.py`) is damaged in one place a time, seeded (`damages.py`), and read by the package's own
reader, in processes that are killed beyond 10 s of processor time, 60 s in all, or 2 GB. A refusal is the package's own
error; anything else raised is a traceback. Accepted contents are compared with those of the undamaged file; the table
`file_mutations_differ.csv` lists the differences. No reader of plain numbers can detect a digit that is replaced by
another.
"""

import os
import resource
import shutil
import signal
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import fields, is_dataclass
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from unittest import mock

import numpy as np
from scipy.sparse import issparse

import casingfem as cf
import contact as ct
from casingfem.experiment.frf import files
from casingfem.io import probe
from casingfem.io.arrays import Array
from casingfem.structure.imported import read
from casingfem.structure.imported.matrix import arrays
from reports.tables import Row, command_line, show, write
from reports.verification.robustness.damages import suited
from reports.verification.robustness.sample_files import READERS, Reader, write_samples

COUNT, QUICK = 100_000, 20
SECONDS, WALL, BYTES = 10, 60, 2e9
OWN = (ct.InputError, ct.NumericsError, cf.errors.InputError, cf.errors.NumericsError)
OWN_WARNINGS = (cf.errors.ModelWarning, ct.scene.SceneWarning)
OUTCOMES = ("refused", "same", "differs, warned", "differs", "TRACEBACK", "HANG OR DEATH")
Mutant = tuple[str, bytes]
Verdict = tuple[str, str, str]


def leaves(value: object, name: str = "") -> Iterator[tuple[str, object]]:
    """All entries of a read value by their place."""
    if isinstance(value, np.ndarray):
        yield name, (value.shape, value.dtype.str, value.tobytes())
    elif issparse(value):
        whole = value.tocoo()  # type: ignore[attr-defined]
        yield from leaves((np.asarray(whole.shape), whole.row, whole.col, whole.data), name)
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
        for k, part in enumerate(value):
            yield from leaves(part, f"{name}[{k}]")
        yield f"{name} (count)", len(value)
    else:
        yield name, repr(value)


def mutants(data: bytes, name: str, each: int, seed: int) -> list[Mutant]:
    """Damaged copies, the damages in turn."""
    rng = np.random.default_rng([seed, *name.encode()])
    damages = list(suited(data).items())
    chosen = (damages[k % len(damages)] for k in range(each))
    return [(damage, change(data, rng)) for damage, change in chosen]


def judged(reader: Reader, path: Path, whole: dict[str, object]) -> tuple[str, str]:
    """Outcome of reading a file: refused, same, differs (and where), traceback (and which)."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = dict(leaves(reader(path)))
    except OWN:
        return "refused", ""
    except Exception as error:
        if isinstance(error, OSError) and error.filename is not None:
            return "refused", ""
        return "TRACEBACK", f"{type(error).__name__}: {ascii(str(error))[1:-1][:80]}"
    stray = [entry for entry in caught if not isinstance(entry.message, OWN_WARNINGS)]
    if stray:
        return "TRACEBACK", f"{stray[0].category.__name__}: {ascii(str(stray[0].message))[1:-1][:80]}"
    if found == whole:
        return "same", ""
    where = sorted(name for name in whole.keys() | found.keys() if whole.get(name) != found.get(name))
    return "differs, warned" if caught else "differs", ", ".join(where[:3])


def forked(path: Path, module: str, function: str) -> str:
    """`casingfem.io.probe.fault_of` without the start of a Python: the child is a copy of this process."""
    call = getattr(import_module(module), function)  # loaded here once, not in each child
    child = os.fork()
    if child == 0:
        code = 1
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (int(probe.SECONDS) + 1,) * 2)
            call(path)
            code = 0
        except MemoryError:
            pass
        except BaseException:
            code = 0
        finally:
            os._exit(code)
    return "its reader took too long or too much, or crashed" if os.waitpid(child, 0)[1] else ""


def handed_over(path: Path, module: str, function: str) -> dict[str, Array]:
    """`casingfem.io.probe.arrays_of` likewise: a copy of this process reads, and hands over its arrays."""
    call = getattr(import_module(module), function)
    with tempfile.TemporaryFile() as stream:
        child = os.fork()
        if child == 0:
            code = 1
            try:
                resource.setrlimit(resource.RLIMIT_CPU, (int(probe.SECONDS) + 1,) * 2)
                code = probe.give(stream, call, path)
                stream.flush()
            finally:
                os._exit(code)
        status = os.waitpid(child, 0)[1]
        if os.WIFSIGNALED(status) or os.WEXITSTATUS(status) not in (0, probe.REFUSED):
            raise probe.UnreadableError("its reader took too long or too much, or crashed")
        stream.seek(0)
        return probe.taken(stream)


def work(pipe: Connection, samples: Path, name: str, batch: list[Mutant]) -> None:
    """Judge a batch, in a child: an answer for each file as it comes."""
    with tempfile.TemporaryDirectory() as place, ExitStack() as stack:
        stack.enter_context(mock.patch.object(read, "fault_of", forked))
        for reader in (files, arrays):  # each has the name of its own
            stack.enter_context(mock.patch.object(reader, "arrays_of", handed_over))
        folder = Path(place) / "files"
        shutil.copytree(samples, folder)
        path, reader = folder / name, READERS[name]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            whole = dict(leaves(reader(path)))
        resource.setrlimit(resource.RLIMIT_AS, (int(BYTES) + used(),) * 2)
        for damage, mutant in batch:
            path.write_bytes(mutant)
            signal.setitimer(signal.ITIMER_PROF, SECONDS)
            signal.alarm(WALL)
            answer = judged(reader, path, whole)
            signal.setitimer(signal.ITIMER_PROF, 0)
            signal.alarm(0)
            pipe.send((damage, *answer))
    pipe.close()


def used() -> int:
    """Address space of this process in use [bytes]."""
    pages = Path("/proc/self/statm").read_text().split()[0] if Path("/proc/self/statm").exists() else "0"
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def verdicts(samples: Path, name: str, todo: list[Mutant]) -> Iterator[Verdict]:
    """Damage, verdict and detail of each mutant; the reader hangs or has crashed in a child that does not answer.

    A child is a fork of this process, which has loaded all that the readers need, and judges until it dies.
    """
    context = get_context("fork")
    while todo:
        here, there = context.Pipe(duplex=False)
        child = context.Process(target=work, args=(there, samples, name, todo))
        child.start()
        there.close()
        done = 0
        try:
            while True:
                yield here.recv()
                done += 1
        except EOFError:
            child.join()
        if done < len(todo):
            yield todo[done][0], "HANG OR DEATH", f"exit {child.exitcode}"
            done += 1
        todo = todo[done:]


def main(out: Path, quick: bool = False, count: int = COUNT, seed: int = 20264) -> list[Row]:
    """Damage every kind of file, count, and list what differs."""
    each = QUICK if quick else -(-count // len(READERS))
    rows: list[Row] = []
    differ: Counter[tuple[str, ...]] = Counter()
    with tempfile.TemporaryDirectory() as place:
        samples = Path(place)
        write_samples(samples)
        for name in READERS:
            counts: Counter[str] = Counter()
            for damage, verdict, detail in verdicts(
                samples, name, mutants((samples / name).read_bytes(), name, each, seed)
            ):
                counts[verdict] += 1
                if verdict not in ("refused", "same"):
                    differ[name, damage, verdict, detail] += 1
            faults = counts["TRACEBACK"] + counts["HANG OR DEATH"]
            total = sum(counts.values())
            rows.append({"file": name, "mutants": total, **{o: counts[o] for o in OUTCOMES}, "failed": faults})
    show("Damaged files", rows)
    print(f"\n{sum(int(str(row['mutants'])) for row in rows)} damaged files of {len(rows)} kinds")
    write(out / "file_mutations.csv", rows)
    listed: list[Row] = [
        dict(zip(("file", "damage", "verdict", "in"), key, strict=True)) | {"times": times}
        for key, times in sorted(differ.items())
    ]
    if listed:
        write(out / "file_mutations_differ.csv", listed)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main, count=(COUNT, "damaged files in all"), seed=(20264, "seed of the damages"))
