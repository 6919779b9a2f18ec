"""Verdict of a run at one constant speed: unstable, resonance, safe or not decided.

The verdict is the growth of the run (`contact.stability.of_run`). A short run does not show a slow growth. If all
contacts stay closed, the motion is linear and has the growth of closed contact, whatever the run shows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, cast

import numpy as np

from contact.base.errors import InputError, NumericsError
from contact.io.decision import decision
from contact.model.gaps.limits import RIM, motion_limits
from contact.model.gaps.rub import Rub, rub_of
from contact.model.rotor.rotor import Rotor
from contact.model.rotor.rotor_rub import rotor_of
from contact.record.growth import STANDS, Check, Ending, RunGrowth, size_words
from contact.result import Result
from contact.run_many import Outcome
from contact.stability.of_run import disk_path, of_rotor_run, whirl_sense

Verdict = Literal["unstable", "not decided", "resonance", "safe"]
CALM = ("safe", "resonance")
CLOSED = 0.99  # of the time: a contact that stays closed
RESONANT = 3.0  # times the median amplitude of the runs that do not grow
APART = 2.0  # times: between motions that differ by more there may be a resonance
LATER = 4  # times the length of a first run: after which a contact that opens and closes has had time to stay closed
STILL = 1e-12  # of the radius: a smaller motion is round-off
FOLDS = 3.0  # e-folds of closed contact in a run that show: then a twentieth of the motion has become as large as it
SHORT = "the run is too short for its growth: lengthen t_end"
NUMERICAL = "the growth is numerical: reduce dt"
OTHER_RATE = {
    "irregular": "the motion is irregular: its growth differs from run to run",
    "depends on the step": "it grows at half the step too, at another rate: reduce dt",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedRun:
    """The scene at one constant speed: `speed_hz` [turns/s], its verdict, and the motion.

    `force_n`: largest contact force of a step [N]; `mode` the number of the blades' mode if the motion is mostly
    theirs and has no nodal diameters. `closed`: growth of closed contact [1/s]; `growth` of the run with its 95 %
    interval, nan without one; `amplitude_m` the largest deflection of the rim at the end of the run, `half_wall_s`
    the time at which it reaches half the wall; `n` is None if nothing moves or blades have no nodal diameters.
    `seconds` is the length of the run, `why` the reason if it does not decide. `check` is the result with half the
    step: "converged", "numerical", "irregular", "depends on the step", or "" for motions that do not grow. `state` is
    the end state of the motion, `steady` the relative variation of the largest deflection between windows of the last
    part; `contact` the fraction of the time in which the contact that touches most was closed. `limit_m` is the
    largest rim deflection that the linear model allows, for a run that passed it and was stopped; nan for others.
    `allowed_m` is that deflection for every run. `may_change` is that of the run's result. `opens`: whether some
    contact opens in the second half of the run; `slow`: whether the growth is that of closed contact, and the run does
    not show it.
    """

    speed_hz: float
    verdict: Verdict
    closed: float
    growth: float
    low: float
    high: float
    amplitude_m: float
    half_wall_s: float
    n: int | None
    wave: str
    body: str
    seconds: float = 0.0
    why: str = ""
    check: Check = ""
    state: Ending | None = None
    steady: float = math.nan
    contact: float = math.nan
    limit_m: float = math.nan
    allowed_m: float = math.nan
    may_change: bool = False
    force_n: float = math.nan
    mode: int | None = None
    opens: bool = True
    slow: bool = False

    @property
    def stopped(self) -> bool:
        """Whether the run passed a limit of the motion; its deflection is then outside the linear model."""
        return math.isfinite(self.limit_m)

    @property
    def hides(self) -> bool:
        """Whether the run is long enough for the growth of closed contact, and does not show it."""
        return self.slow and self.closed * self.seconds > FOLDS

    @property
    def shown_m(self) -> float:
        """Deflection of the rim [m], at most the limit at which a run was stopped."""
        return min(self.amplitude_m, self.limit_m) if self.stopped else self.amplitude_m

    @property
    def deflection(self) -> str:
        """Deflection of the rim in mm; "> limit" for a run that was stopped there; "" without a rim.

        >>> run = SpeedRun(speed_hz=20.0, verdict="unstable", closed=3.0, growth=9.0, low=8.0, high=10.0,
        ...                amplitude_m=5.45e-2, half_wall_s=0.2, n=4, wave="with", body="casing")
        >>> run.deflection, replace(run, limit_m=1.5e-3).deflection
        ('54.5', '> 1.5')
        """
        if not math.isfinite(self.amplitude_m):
            return ""
        return ("> " if self.stopped else "") + f"{1e3 * (self.limit_m if self.stopped else self.amplitude_m):.3g}"

    @property
    def note(self) -> str:
        """Reason why the verdict differs from the growth of closed contact, or is missing; empty if they agree.

        >>> run = SpeedRun(speed_hz=20.0, verdict="safe", closed=3.0, growth=0.1, low=-0.2, high=0.4, amplitude_m=2e-5,
        ...                half_wall_s=math.inf, n=4, wave="with", body="casing", state="bounded", steady=0.04,
        ...                contact=0.3)
        >>> run.note
        'The contact opens (closed 30 % of the time). The motion is bounded at 0.02 mm, steady within 4 %.'
        >>> replace(run, amplitude_m=0.0, contact=0.0).note
        'The contact never closes.'
        """
        if self.why:
            return f"{self.why[0].upper()}{self.why[1:]}."
        if self.verdict not in CALM or not (self.closed > 0.0 or self.growth > 0.0):
            return ""
        if not self.contact > 0.0:
            return "" if self.body == "rotor" else "The contact never closes."
        part = f"closed {100.0 * self.contact:.2g} %" if self.contact < CLOSED else "open for a small part"
        closed = f"The contact opens ({part} of the time)." if self.opens else "The contact stays closed."
        bounded = f"The motion is bounded at {size_words(self.amplitude_m, self.steady)}."
        ends = {"bounded": bounded, "decays": "The motion decays."}
        return " ".join(filter(None, [closed if self.closed > 0.0 else "", ends.get(self.state or "", "")]))


def judged(
    what: object, outcome: Outcome, speed_hz: float, pole: float, exact: bool | None
) -> SpeedRun:  # fmt: skip
    """The verdict of one run of `what` at a speed [turns/s].

    `pole` is the growth of closed contact [1/s]: exact, not exact if it holds on average over time, None if not at all.
    """
    outcome = _of_rotor(what, outcome)
    none = math.nan
    allowed = _allowed(what)
    run = SpeedRun(
        speed_hz=speed_hz, verdict="not decided", closed=pole, growth=none, low=none, high=none, amplitude_m=none,
        half_wall_s=none, n=None, wave="", body="", allowed_m=allowed,
    )  # fmt: skip
    if isinstance(outcome, InputError):
        return replace(run, why=f"the run was refused: {outcome}")
    result = outcome.result if isinstance(outcome, NumericsError) else outcome
    if result is None:
        return replace(run, why=f"the run failed: {outcome}")
    closed = float(np.max(result.contact_steps, initial=0)) / max(result.steps, 1)
    force = float(np.max(result.peak_force, initial=0.0))
    run = replace(run, seconds=result.steps * result.dt, contact=closed, force_n=force, opens=_opens(result))
    growth = result.growth
    if growth is not None:
        run = replace(
            run, growth=growth.rate, low=growth.low, high=growth.high, amplitude_m=growth.amplitude,
            half_wall_s=growth.time_to_half_wall, n=growth.nodal_diameters, body=growth.body,
            mode=growth.blade_mode,
            wave="" if growth.cause is None else _wave(growth.cause.travel), check=growth.check,
            state=growth.state, steady=growth.steady,
        )  # fmt: skip
    rotor = rotor_of(what)
    if rotor is not None:
        run = replace(run, body="rotor", n=1, wave=whirl_sense(disk_path(cast("Rotor | Rub", what), result.state), 1.0))
    passed = result.divergence is not None and result.divergence.limit in ("wall", "radius", "rotor")
    if passed:
        run = replace(run, limit_m=allowed)
    if isinstance(outcome, NumericsError) and not passed:
        return replace(run, why=f"the run failed: {outcome}")
    size = 1.0 if isinstance(what, Rotor) else rub_of(what).casing.line_radius(0)
    if growth is not None and growth.amplitude < STILL * size:
        return replace(run, verdict="safe", amplitude_m=0.0)
    verdict, why = _of_growth(growth, passed=passed)
    run = replace(run, verdict=verdict, why=why, may_change=may_change(result))
    return run if exact is None else _with_poles(run, exact=exact)


def may_change(result: Result) -> bool:
    """Whether a longer run may change the verdict of a run that no limit of the motion stopped.

    The run is too short to decide, or the motion grows while its contact opens and closes, which may bound it further
    on. Without contact, or with contact that stays closed, the motion is linear and grows on.
    """
    growth = result.growth
    if result.divergence is not None or growth is None:
        return result.divergence is None
    opens = growth.cause is not None and 0.0 < growth.cause.closed < CLOSED
    return growth.outcome == "undecided" or (growth.outcome == "grows" and opens)


def times_longer(run: SpeedRun, first: float, *, exact: bool | None) -> int:
    """Factor by which a run is continued because a longer one may change its verdict; 0 if none may.

    `first` [s] is the length of the first run, `exact` as in `judged`. A run whose contact opens may close it later. If
    closed contact grows fast enough to show, a motion that does not grow is therefore run LATER times as long.

    >>> run = SpeedRun(speed_hz=20.0, verdict="safe", closed=30.0, growth=0.1, low=-0.2, high=0.4, amplitude_m=2e-5,
    ...                half_wall_s=math.inf, n=4, wave="with", body="casing", seconds=0.5, contact=0.3)
    >>> longer = replace(run, seconds=2.0)
    >>> [times_longer(one, 0.5, exact=True) for one in (run, longer, replace(run, closed=-1.0))]
    [4, 0, 0]
    >>> [times_longer(replace(run, verdict=name, may_change=True), 0.5, exact=True) for name in ("unstable", "safe")]
    [4, 2]
    """
    if run.may_change:
        return 4 if run.verdict == "unstable" else 2
    closes = exact is not None and run.opens and run.contact > 0.0 and LATER * first * run.closed > FOLDS
    short = 0.0 < run.seconds < 0.999 * LATER * first
    return math.ceil(0.999 * LATER * first / run.seconds) if run.verdict in CALM and closes and short else 0


def decided(runs: Sequence[SpeedRun], even: Sequence[SpeedRun]) -> tuple[SpeedRun, ...]:
    """Runs whose motion does not grow: a resonance if it is large, else safe.

    Large means above `RESONANT` times the median amplitude of the runs at `even` speeds, or above the allowed
    deflection of the rim [m], half of its wall.
    """
    calm = [run.amplitude_m for run in even if run.verdict in CALM]
    most = RESONANT * float(np.median(calm)) if calm else math.inf
    return tuple(
        replace(run, verdict="safe")
        if run.verdict == "resonance" and not run.amplitude_m > min(most, run.allowed_m)
        else run
        for run in runs
    )


def disagree(one: SpeedRun, other: SpeedRun) -> bool:
    """Whether something may lie between two neighbouring runs: they differ in their verdict, or by APART in the motion.

    >>> run = SpeedRun(speed_hz=20.0, verdict="safe", closed=0.0, growth=0.0, low=0.0, high=0.0, amplitude_m=2e-5,
    ...                half_wall_s=math.inf, n=4, wave="with", body="casing")
    >>> [disagree(run, replace(run, amplitude_m=size)) for size in (3e-5, 5e-5)]
    [False, True]
    """
    small, large = sorted((one.shown_m, other.shown_m))
    return (one.verdict, one.slow) != (other.verdict, other.slow) or large > APART * small


def at_end_of_band(one: SpeedRun, other: SpeedRun, bands_hz: Sequence[tuple[float, float]]) -> bool:
    """Whether just one of two runs is in a band in which closed contact grows, and is unstable as the band states."""
    for low, high in bands_hz:
        first, then = (low <= run.speed_hz <= high for run in (one, other))
        if first != then and (one if first else other).verdict == "unstable":
            return True
    return False


def at_half_step(run: SpeedRun, fine: SpeedRun) -> SpeedRun:
    """The verdict of a run that hides the growth of closed contact, from the same run at half the step.

    >>> run = SpeedRun(speed_hz=20.0, verdict="unstable", closed=9.0, growth=0.1, low=-0.2, high=0.4, amplitude_m=2e-5,
    ...                half_wall_s=math.inf, n=4, wave="with", body="casing", seconds=1.0, opens=False, slow=True)
    >>> found = at_half_step(run, replace(run, verdict="safe", opens=True, slow=False))
    >>> found.verdict, found.why
    ('not decided', 'closed contact grows by 9 1/s, but not in this run; at half the step it opens: reduce dt')
    """
    if fine.hides or not fine.seconds > 0.0:
        return run
    if fine.verdict == "unstable" and not fine.slow:
        return replace(run, why=f"{run.why}; at half the step the motion grows", check="depends on the step")
    then = "it opens" if fine.opens else "the motion differs"
    why = f"closed contact grows by {run.closed:.2g} 1/s, but not in this run; at half the step {then}: reduce dt"
    return replace(run, verdict="not decided", why=why, check="numerical", slow=False)


def _opens(result: Result) -> bool:
    """Whether some contact is open at a stored state of the second half of a run, or for a part of one without states.

    A contact that opens only at the start is closed in the motion that remains. One that opens shortly in every period
    is not: the poles of closed contact do not hold there.
    """
    K = result.contact_steps.size
    if not (K and result.tip_force.size):
        return float(np.min(result.contact_steps, initial=result.steps)) < CLOSED * result.steps
    late = result.tip_force[len(result.tip_force) // 2 :]
    return bool((late.reshape(len(late), K, -1)[:, :, 0] == 0.0).any())


def _with_poles(run: SpeedRun, *, exact: bool) -> SpeedRun:
    """A run judged by the growth of closed contact if no contact opens and the run itself does not show the growth.

    >>> run = SpeedRun(speed_hz=20.0, verdict="safe", closed=0.3, growth=0.1, low=-0.2, high=0.4, amplitude_m=2e-5,
    ...                half_wall_s=math.inf, n=4, wave="with", body="casing", seconds=0.5, contact=1.0, opens=False)
    >>> [_with_poles(run, exact=exact).verdict for exact in (True, False)]
    ['unstable', 'not decided']
    >>> [_with_poles(one, exact=False).verdict for one in (replace(run, seconds=20.0), replace(run, opens=True))]
    ['safe', 'safe']
    """
    shown = run.closed * run.seconds
    silent = run.verdict in CALM or run.why == SHORT
    if run.opens or not run.closed > 0.0 or not silent or (not exact and shown > FOLDS):
        return run
    rotor = run.body == "rotor"
    what = "the free motion grows" if rotor else "the contact stays closed and grows"
    slow = f"{what} by {run.closed:.2g} 1/s, in this run by a factor of e^{shown:.2g}"
    if exact:
        why = f"closed contact grows by {run.closed:.2g} 1/s, which this run does not show" if shown > FOLDS else slow
        return replace(run, verdict="unstable", why=slow if rotor else why, may_change=False, slow=not rotor)
    return replace(run, verdict="not decided", why=f"{slow}: lengthen t_end", may_change=True)


def _of_growth(growth: RunGrowth | None, *, passed: bool) -> tuple[Verdict, str]:
    """Verdict of a run, and the reason if there is none; `passed`: whether the rim moved beyond half its wall."""
    outcome = "undecided" if growth is None else growth.outcome
    grows = decision(outcome, passed=passed)
    if grows is None:
        return "not decided", NUMERICAL if outcome == "numerical" else SHORT
    if grows:
        return "unstable", "" if growth is None else OTHER_RATE.get(growth.check, "")
    return ("safe" if outcome == "at rest" else "resonance"), ""


def _allowed(what: object) -> float:
    """Largest allowed deflection [m]: of a rim, of a rotor's disk in its casing, or of any node of a rotor alone."""
    if isinstance(what, Rotor):
        return what.limit
    rub: Rub = rub_of(what)
    return float(motion_limits(rub.casing.line_radius(0), math.inf if rub.rotor else rub.wall)[RIM])


def _of_rotor(what: object, outcome: Outcome) -> Outcome:
    """The outcome of a rotor's run, with the size of the motion that of its disk; other outcomes unchanged.

    The verdict of a rotor in its casing is that of the run; a rotor alone has none before this.
    """
    rotor = isinstance(what, Rotor) or (isinstance(what, Rub) and what.rotor is not None)
    if not rotor or isinstance(outcome, InputError):
        return outcome
    result = outcome.result if isinstance(outcome, NumericsError) else outcome
    if result is None:
        return outcome
    with np.errstate(all="ignore"):
        growth = of_rotor_run(cast("Rotor | Rub", what), result)
    if result.growth is not None and growth is not None:
        growth = replace(result.growth, amplitude=growth.amplitude, steady=growth.steady)
    result = replace(result, growth=growth)
    if not isinstance(outcome, NumericsError):
        return result
    outcome.result = result
    return outcome


def _wave(travel: float) -> str:
    if not math.isfinite(travel):
        return ""
    return "standing" if abs(travel) < STANDS else "with" if travel > 0.0 else "against"
