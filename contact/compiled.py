"""The only doorway to numba: one typed decorator, imported when a run starts and not before.

Numba's disk cache watches the file of a function but not the files of what it calls. The cache directory is
therefore named after the contents of every compiled source, so that no change can leave stale machine code.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn, TypeVar, cast

import numba
from numba.core import types
from numba.core.registry import CPUDispatcher

from contact.sealing import SealedPipeline

config: Any = numba.config
unliteral: Any = types.unliteral
Function = TypeVar("Function", bound=Callable[..., object])

ROOT = Path(__file__).parent
SOURCES = (
    Path(__file__),
    ROOT / "sealing.py",
    ROOT / "record.py",
    ROOT / "vector.py",
    ROOT / "model/band.py",
    *sorted((ROOT / "scheme/loop").glob("*.py")),
    *sorted((ROOT / "solver").glob("*.py")),
)


def cache_directory() -> Path:
    """Directory of the machine code of exactly these sources."""
    digest = hashlib.sha256(b"\0".join(source.read_bytes() for source in SOURCES)).hexdigest()
    base = config.CACHE_DIR or ROOT / "__pycache__"
    return Path(base) / f"contact-{digest[:12]}"


CACHE = str(cache_directory())
# no reference counts: loops are given all their arrays, and counting the views they take cost more than the steps
OPTIONS: Any = {
    "cache": True, "_nrt": False, "error_model": "numpy", "fastmath": {"reassoc", "contract", "nsz"},
}  # fmt: skip
# no way in from Python or C: unpacking a state's many arrays took a third of the time to compile
PART: Any = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def jit_entry(function: Function) -> Function:
    """Compile a step loop that Python calls and that allocates nothing to machine code, cached on disk.

    Sums may be reassociated and products contracted, so that reductions vectorise; NaN keeps its meaning,
    so that a run that diverges is seen. The same input gives bit-identical results on one machine.
    """
    return compiled(function, OPTIONS)


def jit_entry_allocating(function: Function) -> Function:
    """Compile a function that Python calls, else as `jit_allocating`."""
    return compiled(function, {**OPTIONS, "_nrt": True})


def jit(function: Function) -> Function:
    """Compile what only compiled functions call, else as `jit_entry`; raises TypeError when Python calls it."""
    return part(function, OPTIONS)


def jit_inside(function: Function) -> Function:
    """Compile a part of a step loop into its caller, else as `jit`: passing a state's many arrays costs more."""
    return part(function, {**OPTIONS, "forceinline": True})


def jit_allocating(function: Function) -> Function:
    """Compile a function that needs work arrays of its own (dense factors, lists of active contacts), else as `jit`."""
    return part(function, {**OPTIONS, "_nrt": True})


class Loop(CPUDispatcher):
    """A compiled function that is compiled once for whole numbers.

    Numba compiles for the literal 0 and again for the variable that begins with it, or for each number that is passed.
    """

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Types and template of a call from a compiled function."""
        known: Any = super()
        return known.get_call_template(
            [unliteral(kind) for kind in args], {name: unliteral(kind) for name, kind in kws.items()}
        )


class Part(Loop):
    """A compiled function without a way in from Python: a call from there would end the process."""

    def __call__(self, *_: object, **__: object) -> NoReturn:
        """Refuse."""
        raise TypeError(f"{self.py_func.__name__} is a part of compiled loops; found a call from Python")


def part(function: Function, options: dict[str, Any]) -> Function:
    """Compile for compiled callers alone; as it stands where numba is told not to compile."""
    return compiled(function, {**options, **PART}, Part)


def compiled(function: Function, options: dict[str, Any], kind: type[Loop] = Loop) -> Function:
    """Compile with numba, the cache in a directory named after the sources."""
    before = config.CACHE_DIR
    config.CACHE_DIR = CACHE
    try:
        made: Any = numba.njit(pipeline_class=SealedPipeline, **options)(function)
    finally:
        config.CACHE_DIR = before
    if isinstance(made, CPUDispatcher):
        made.__class__ = kind
    return cast(Function, made)
