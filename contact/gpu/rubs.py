"""Rubs of many casings on a CUDA device: runs of scenes whose rim has one tip, and their sums."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from contact.base.arrays import Array, Indices
from contact.base.errors import InputError
from contact.gpu.device import cuda_module, simulated
from contact.model.gaps.limits import RIM as RIM_LIMIT
from contact.model.gaps.limits import TIP as TIP_LIMIT
from contact.model.trig import Terms
from contact.prepared import Prepared, Scene, prepared
from contact.scheme.modal.batch import shape_of
from contact.scheme.modal.rub_stepper import RubStepper
from contact.scheme.modal.slot import Slot, slot_of

MOST_BYTES = 4_000_000_000  # of the arrays of the runs that are on the device together
STEPS = 4096  # of a launch
THREADS = 128  # of a block
REASONS = ("", "no force satisfies the contact law", "the tip passed its limit", "the rim may pass its limit")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DeviceRuns:
    """Ends and sums of runs on the device, one entry a scene.

    Attributes
    ----------
    q, d : modal displacements at the end and their last increments, (scenes, modes)
    steps, contact_steps : steps taken, and those with a force
    impulse, work, rotation, friction, damping, peak, penetration, residual : sums as of `ct.record`
    stopped : why a run ended early, "" for whole runs
    seconds : time of the launches

    Examples
    --------
    >>> zero = np.zeros(2)
    >>> sums = dict.fromkeys(("impulse", "work", "rotation", "friction", "damping", "peak"), zero)
    >>> whole = dict.fromkeys(("steps", "contact_steps"), zero.astype(int))
    >>> runs = DeviceRuns(q=np.zeros((2, 42)), d=np.zeros((2, 42)), penetration=zero, residual=zero, seconds=0.1,
    ...     stopped=("", "the rim may pass its limit"), **sums, **whole)
    >>> [number for number, why in enumerate(runs.stopped) if why]
    [1]
    """

    q: Array
    d: Array
    steps: Indices
    contact_steps: Indices
    impulse: Array
    work: Array
    rotation: Array
    friction: Array
    damping: Array
    peak: Array
    penetration: Array
    residual: Array
    stopped: tuple[str, ...]
    seconds: float


def device_runs(
    scenes: Sequence[Scene], *, most_bytes: int = MOST_BYTES, progress: Callable[[float], None] | None = None
) -> DeviceRuns:
    """Run scenes of rims with one tip on the CUDA device, each with its own bases, speed, clearance and friction.

    A thread takes one run. No samples are stored. A run ends early if no force is a solution, if the tip passes its
    limit, or if an upper bound of the rim's deflection passes half of the wall; `stopped` states which. `ct.run_many`
    runs such scenes with the exact deflection, growth and samples.

    Parameters
    ----------
    scenes
        Scenes for which `ct.run_many` uses its compiled loop of eight runs, with the same number of modes.
    most_bytes
        Memory of the device for arrays; more runs are taken one group after the other.
    progress
        Called with the share of the work that is done.

    Raises
    ------
    InputError
        No device (with what is missing), or scenes of another kind.

    Examples
    --------
    >>> import contact as ct
    >>> rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20, x=1.0, velocity=-1.0)
    >>> try:
    ...     device_runs([ct.Scene(what=[rod, ct.Wall()], t_end=1.0, courant=0.9)])
    ... except ct.InputError as error:  # of a machine without a device, or of a scene without a rim
    ...     str(error).startswith("gpu: ")
    True
    """
    cuda_module()
    ready = [prepared(scene) for scene in scenes]
    runs = [run_of(number, one) for number, one in enumerate(ready)]
    sizes = sorted({run.system.omega.size for run in runs})
    if len(sizes) != 1:
        raise InputError(f"gpu: found scenes of {sizes} modes, expected at least one scene, all with as many modes")
    slots = [slot_of(run) for run in runs]
    each = bytes_of_a_run(slots, sizes[0])
    group = max(THREADS, int(most_bytes / each))
    parts, seconds = [], 0.0
    for first in range(0, len(runs), group):
        chosen = slice(first, first + group)

        def share(done: float, first: int = first, size: int = len(runs[chosen])) -> None:
            if progress is not None:
                progress((first + done * size) / len(runs))

        part, took = advanced(ready[chosen], runs[chosen], slots[chosen], share)
        parts.append(part)
        seconds += took
    arrays = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    stopped = tuple(REASONS[status] for status in arrays.pop("status").tolist())
    return DeviceRuns(stopped=stopped, seconds=seconds, **arrays)


def run_of(number: int, ready: Prepared) -> RubStepper:
    """The stepper of a scene; raises InputError for one that the kernel does not know."""
    stepper = ready.stepper
    if not isinstance(stepper, RubStepper) or shape_of(stepper) is None:
        expected = "a rotating rim with one tip at constant speed, without coating: use ct.run_many"
        raise InputError(f"gpu: scene {number}: found another model of contact, expected {expected}")
    return stepper


def bytes_of_a_run(slots: Sequence[Slot], modes: int) -> int:
    """Memory of one run on the device."""
    terms = max(slot.normal.value.size + slot.tangent.value.size for slot in slots)
    return 8 * (terms + 11 * modes + 200)


def advanced(
    ready: Sequence[Prepared], runs: Sequence[RubStepper], slots: Sequence[Slot], progress: Callable[[float], None]
) -> tuple[dict[str, Array], float]:
    """Ends and sums of one group of runs, and the time of its launches [s]."""
    from contact.gpu import kernel as of

    cuda, count, modes = cuda_module(), len(runs), runs[0].system.omega.size
    normal, tangent = (table([getattr(slot, name) for slot in slots]) for name in ("normal", "tangent"))
    waves = int(max(normal[1].max(initial=0), tangent[1].max(initial=0))) // 2 + 1
    of_modes = [columns([getattr(run.state, name) for run in runs]) for name in ("q", "d", "al", "be", "c", "weight")]
    q, d, *coefficients = map(cuda.to_device, of_modes)
    number, whole = numbers(ready, runs, slots), np.zeros((of.WHOLE, count), dtype=np.int64)
    whole[of.END] = [one.count for one in ready]
    number, whole, sums = (cuda.to_device(part) for part in (number, whole, np.zeros((of.SUMS, count))))
    fixed = [cuda.to_device(part) for part in (columns([slot.reach for slot in slots]), *normal, *tangent)]
    new, Q, Q_next, T, wave = (
        cuda.device_array((rows, count)) for rows in (modes, modes + 4, modes + 4, modes, 2 * waves)
    )  # fmt: skip
    threads = 4 if simulated() else THREADS
    step, end = of.advance[(count + threads - 1) // threads, threads], max(one.count for one in ready)
    began = time.perf_counter()
    for first in range(0, end, STEPS):
        step(q, d, new, *coefficients, *fixed, Q, Q_next, T, wave, number, sums, whole, STEPS)
        cuda.synchronize()
        progress(min((first + STEPS) / end, 1.0))
    seconds = time.perf_counter() - began
    sums, whole = sums.copy_to_host(), whole.copy_to_host()
    names = ("impulse", "work", "rotation", "friction", "damping", "peak", "penetration", "residual")
    found = {
        "q": q.copy_to_host().T, "d": d.copy_to_host().T, "steps": whole[of.STEP], "status": whole[of.STATUS],
        "contact_steps": whole[of.CONTACT_STEPS], **dict(zip(names, sums, strict=False)),
    }  # fmt: skip
    return found, seconds


def columns(rows: Sequence[Array]) -> Array:
    """Arrays of the runs side by side, (entries, runs)."""
    return np.ascontiguousarray(np.stack(rows, axis=1))


def numbers(ready: Sequence[Prepared], runs: Sequence[RubStepper], slots: Sequence[Slot]) -> Array:
    """The numbers of each run, in the order of the kernel's rows."""
    from contact.gpu import kernel as of

    found = np.zeros((of.NUMBERS, len(runs)))
    for k, (one, run, slot) in enumerate(zip(ready, runs, slots, strict=True)):
        system, soft = slot.system, np.zeros(2)
        soft[: slot.rim.soft.shape[1]] = slot.rim.soft[0]
        limits = cast(Array, one.stepper.limits)
        found[: of.NOW, k] = (
            system.angle, system.speed, run.dt, system.radius * system.speed, run.state.mu[0], run.averaged,
            system.compliance_turns, limits[RIM_LIMIT], limits[TIP_LIMIT], *soft,
        )  # fmt: skip
        found[of.NOW :, k] = slot.memory
    return found


def table(parts: Sequence[Terms]) -> tuple[Any, ...]:
    """The sums of all runs with one list of terms: start of each sum, its waves, coefficients (terms, runs)."""
    top = max(int(part.wave.max(initial=0)) for part in parts) + 1
    own = [part.owner * top + part.wave for part in parts]
    keys = np.unique(np.concatenate(own))
    value = np.zeros((len(keys), len(parts)))
    for k, (part, key) in enumerate(zip(parts, own, strict=True)):
        value[np.searchsorted(keys, key), k] = part.value
    start = np.searchsorted(keys // top, np.arange(parts[0].sums + 1)).astype(np.int64)
    return start, (keys % top).astype(np.int64), value
