"""The CUDA device of this machine, or the sentence that states what is missing."""

from __future__ import annotations

from types import FunctionType
from typing import Any

from contact.base.errors import InputError

FEWEST = "a CUDA device with its driver, and the extra gpu (pip install 'casingfem[gpu]')"
ELSE = "run ct.run_many on the processor: it gives the same results"


def cuda_module() -> Any:
    """`numba.cuda`; NUMBA_ENABLE_CUDASIM=1 makes it a simulator, which needs no device.

    Raises
    ------
    InputError
        No device, no driver, or the extra is not installed.
    """
    try:
        import numba.cuda
    except Exception as error:  # the package fails in many ways where libraries of the driver are missing
        raise InputError(f"gpu: found no numba.cuda ({error}), expected {FEWEST}; or {ELSE}") from error
    cuda: Any = numba.cuda
    if not cuda.is_available():
        raise InputError(f"gpu: found no CUDA device, expected {FEWEST}; or {ELSE}")
    return cuda


def simulated() -> bool:
    """Whether `numba.cuda` is the simulator."""
    import numba

    configured: Any = numba.config
    return bool(configured.ENABLE_CUDASIM)


def on_device(function: Any, **others: Any) -> Any:
    """A scalar function of the step loops as device code; `others` are the functions that it calls, by name."""
    import numba.cuda

    cuda: Any = numba.cuda
    plain = getattr(function, "py_func", function)
    own = FunctionType(plain.__code__, {**plain.__globals__, **others}, plain.__name__)
    return cuda.jit(device=True, inline="always" if not simulated() else False)(own)
