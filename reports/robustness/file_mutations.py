"""Damaged files for every reader: what is refused, what reads as before, and where what is read differs.

`python -m reports.robustness.file_mutations [--quick] [--out DIR]`. One small file of each kind (`sample_files.py`) is
damaged in one place a time, seeded, by the damages of `uff_mutations` and by flipped bits, and read by the package's
own reader, in processes that are killed beyond 10 s or 2 GB. A refusal is the package's own error; anything else
raised is a traceback. What is accepted is compared with what the whole file holds: where it differs, the table
`file_mutations_differ.csv` says in what. A digit that becomes another no reader of plain numbers can see.
"""

import os
import resource
import signal
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from reports.robustness.sample_files import Reader, kinds
from reports.robustness.uff_mutations import DAMAGES
from reports.tables import Row, command_line, show, write

EACH, QUICK, BATCH = 400, 20, 20
SECONDS, BYTES = 10, 2e9
OWN = (ct.InputError, ct.NumericsError, cf.errors.InputError, cf.errors.NumericsError)


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
    text = b"\n" in data and not data.startswith((b"PK", b"\x89HDF", b"MATLAB"))
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
        data, file, reader = kinds(folder)[name]
        path = folder / file
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
