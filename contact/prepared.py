"""A run before its first step: the scene, its checks, the number of steps, the stored quantities."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from contact.base.arrays import require_positive
from contact.base.errors import InputError
from contact.io.brief import brief
from contact.io.trust import Flag
from contact.model.gaps.limits import RIM, TIP
from contact.model.gaps.rub import rub_of
from contact.model.law import Law, Unilateral
from contact.model.rotor.rotor import Rotor
from contact.problem import What, default_scheme, problem_of
from contact.record.energy import Stored
from contact.record.record import Record, sparse
from contact.resolved import MOST_STEPS, count_of, require_steps, resolved
from contact.scheme.modal.rub_stepper import RubStepper
from contact.scheme.protocol import Loaded, Problem, Scheme, Stepper

OnLimit = Literal["stop", "flag"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Scene:
    """A scene ready to run; every setting may be left out, or overridden in `run`.

    `on_limit` "stop": a run whose rim moves beyond half its wall, or whose numbers are wrong (a flag with `failed`),
    raises an error that contains the result so far. "flag": the run continues to a tenth of the radius and raises no
    error; `flags` of the result state what failed. A run of more than `most_steps` steps is refused.

    >>> import contact as ct
    >>> ball = ct.PointMass(mass=2.0, x=0.01, velocity=-1.0)
    >>> scene = ct.Scene(what=[ct.Wall(), ball], scheme=ct.MoreauJean(), t_end=0.02, dt=1e-4)
    >>> ct.run(scene).steps, ct.run(scene, dt=2e-4).steps
    (200, 100)
    """

    what: What
    law: Law | None = None
    scheme: Scheme | None = None
    t_end: float | None = None
    dt: float | None = None
    courant: float | None = None
    gravity: float = 0.0
    record: Record | None = None
    source: dict[str, str] = field(default_factory=dict)
    on_limit: OnLimit = "stop"
    most_steps: int = MOST_STEPS

    __repr__ = brief


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Prepared:
    """A run at t = 0: number of steps, stored quantities; `start` is its initial energy."""

    problem: Problem
    law: Law
    on_limit: OnLimit
    scheme: Scheme
    stepper: Stepper
    count: int
    record: Record
    source: dict[str, str]
    load_step: float
    overlap: float  # deepest at t = 0 [m]
    start: Stored
    flags: tuple[Flag, ...] = ()  # known before the first step
    marked: bool  # whether marks are kept, from which a part of the run can be repeated


def prepared(scene: Scene) -> Prepared:
    """Check a scene and prepare its start; raises InputError, LimitError."""
    problem = problem_of(scene.what, scene.gravity)
    law = scene.law or Unilateral()
    scheme = scene.scheme or default_scheme(problem, law)
    if scene.t_end is None:
        raise InputError("t_end: found none, expected the end of the run in seconds")
    require_positive(t_end=scene.t_end)
    require_steps(scene.most_steps)
    if scene.dt is not None and scene.dt > 0.0:
        count_of(scene.t_end, scene.dt, scene.most_steps)
    stepper = scheme.prepare(problem, law, dt=scene.dt, courant=scene.courant)
    if scene.on_limit not in ("stop", "flag"):
        raise InputError(f"on_limit: found {scene.on_limit!r}, expected 'stop' or 'flag'")
    if scene.on_limit == "flag":
        allow_far(stepper)
    count = count_of(scene.t_end, stepper.dt, scene.most_steps, stepper.size)
    given = "" if scene.courant is None else f"courant = {scene.courant:g}"
    flags = resolved(problem, law, stepper, scene.t_end, given)
    marked = isinstance(stepper, RubStepper) and law.coating is None
    stored = rub_of(problem) is not None or isinstance(problem, Rotor)
    record = scene.record or sparse(count, stepper.size if stored else 0)
    record.steps(dt=stepper.dt, count=count)  # raises before the first step, as the buffers do for channels
    return Prepared(
        problem=problem, law=law, on_limit=scene.on_limit, scheme=scheme, stepper=stepper,
        count=count, record=record, source=scene.source,
        load_step=stepper.dt**2 * (problem.load_response if isinstance(problem, Loaded) else 0.0),
        overlap=stepper.overlap, start=stepper.start,
        flags=flags, marked=marked,
    )  # fmt: skip


def allow_far(stepper: Stepper) -> None:
    """Let a rim deflect up to a tenth of the radius, as a tip may, instead of half its wall."""
    limits = stepper.limits
    if limits is not None and math.isfinite(limits[TIP]):
        limits[RIM] = limits[TIP]
