"""Whether the motion of a run grows, its rate, its wave and body, and the source of its energy."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from contact.io.outfiles import finite
from contact.io.trust import Flag

Ending = Literal["grows", "bounded", "decays", "undecided", "at rest"]
Outcome = Literal["grows", "numerical", "bounded", "decays", "undecided", "at rest"]
Check = Literal["", "converged", "numerical", "irregular", "depends on the step"]
AGREED = 0.1  # of the growth: largest change by half the step
NUMERICAL = 0.5  # of the growth: if half the step gives less, the step may cause it
STEADY = 0.02  # of the largest deflection: windows of a motion that may be periodic differ by less
VARIES = 0.25  # of it: of a motion whose windows differ by more, the smallest and the largest are stated
STANDS = 0.3  # share of one travelling wave below which the motion is a standing wave


def size_words(largest: float, steady: float) -> str:
    """Size [mm] of a bounded motion from its largest deflection [m] and the relative scatter of windows of it.

    >>> size_words(4e-5, 0.25), size_words(4e-5, 0.75)
    ('0.04 mm, steady within 25 %', '0.01 to 0.04 mm')
    """
    if steady > VARIES:
        return f"{1e3 * (1.0 - steady) * largest:.2g} to {1e3 * largest:.2g} mm"
    return f"{1e3 * largest:.3g} mm, steady within {100.0 * steady:.2g} %"


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """The motion with most of the energy at the end of a run, and its source of energy.

    `body` "casing" or "blades"; `n` its nodal diameters, None for blades that are not evenly spaced, for which `mode`
    is the number of their mode with most energy; `share` of the energy. `travel` from -1 to 1: the part of the wave
    that runs with the blades (1) or against them (-1) around the casing, in the casing's frame; nan if n = 0, or if the
    stored states are too far apart. `source`: the source of the largest work [J], such as "the turning rim" or
    "friction"; "" if there is none. `closed` is the fraction of the time in which the contact that touches most was
    closed.

    >>> Cause(body="casing", n=4, share=0.9, travel=1.0, source="friction", work=1.5, closed=0.5).words
    'the n = 4 motion of the casing, which travels with the rotation of the blades'
    """

    body: str
    n: int | None
    share: float
    travel: float
    source: str
    work: float
    closed: float
    mode: int | None = None

    @property
    def words(self) -> str:
        """Body, nodal diameters and direction, or the mode of a blade."""
        if self.mode is not None:
            return f"mode {self.mode} of the {self.body}"
        wave = f"the motion of the {self.body}" if self.n is None else f"the n = {self.n} motion of the {self.body}"
        if not math.isfinite(self.travel):
            return wave
        if abs(self.travel) < STANDS:
            return f"{wave}, a standing wave"
        return f"{wave}, which travels {'with' if self.travel > 0.0 else 'against'} the rotation of the blades"

    @property
    def source_words(self) -> str:
        """Source of energy of the motion, and the kind of contact that transmits it."""
        if not self.source:
            return ""
        share = "all the time" if self.closed > 0.99 else f"{100.0 * self.closed:.2g} % of the time"
        return f"Its energy comes from {self.source} ({self.work:.3g} J). The contact is closed {share}."


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class RunGrowth:
    """Growth of the motion of a run; `print` and a notebook show `words`.

    `rate` [1/s] of the amplitude, as the real part of a pole; that of the energy is twice as much. `low` and `high`:
    its 95 % interval, from scatter, autocorrelation and curvature of the fitted windows, and from the change by half
    the step. `state`: "grows", "bounded", "decays", "at rest", or "undecided" if the interval does not decide.
    `amplitude` [m] is the rim's largest deflection in the last part of the run, `steady` the relative difference of
    that in its windows; `since` [s] the start of this part. `time_to_half_wall` [s] from the start of the run, infinite
    if the motion does not grow or the wall is unknown. `half_step` is the growth [1/s] of the last part at half the
    step, `half_step_width` half its interval, and `check_share` the ratio of its steps to those of the run; nan without
    this check. `same_step` [1/s]: if the growth at half the step differs, that of the last part repeated at the same
    step from a slightly different start. `passes`: whether a run that passed a limit of its motion does so at half the
    step too; it is computed if the growth is not known, or half the step gives less than half of it, else None.

    >>> RunGrowth(rate=10.0, low=9.0, high=11.0, state="grows", amplitude=1e-4, steady=0.5, since=0.1,
    ...           time_to_half_wall=math.inf, cause=None, half_step=10.2).check
    'converged'
    """

    rate: float
    low: float
    high: float
    state: Ending
    amplitude: float
    steady: float
    since: float
    time_to_half_wall: float
    cause: Cause | None
    half_step: float = math.nan
    half_step_width: float = math.nan
    check_share: float = math.nan
    same_step: float = math.nan
    passes: bool | None = None

    def __repr__(self) -> str:
        return self.words

    @property
    def energy_rate(self) -> float:
        """Growth of the energy [1/s]."""
        return 2.0 * self.rate

    @property
    def body(self) -> str:
        """The body with most of the energy; "" if nothing moves."""
        return "" if self.cause is None else self.cause.body

    @property
    def nodal_diameters(self) -> int | None:
        """Nodal diameters of the motion with most of the energy."""
        return None if self.cause is None else self.cause.n

    @property
    def blade_mode(self) -> int | None:
        """Number of the blades' mode with most of the energy, if that motion has no nodal diameters."""
        return None if self.cause is None else self.cause.mode

    @property
    def converged(self) -> bool | None:
        """Whether half the step gives the same growth, to 10 % or within both intervals; None without this check.

        For a run without a known growth it states whether half the step passes the same limit. The interval of a
        growing motion is above 0, unless the motion has passed a limit while its rate is uncertain.

        >>> grows = RunGrowth(rate=10.0, low=9.8, high=10.2, state="grows", amplitude=1e-4, steady=1.0, since=0.1,
        ...                   time_to_half_wall=0.5, cause=None)
        >>> grows.converged, grows.checked(10.5, 0.1, 0.3).converged, grows.checked(2.0, 0.1, 0.3).converged
        (None, True, False)
        """
        return self._agrees(self.half_step) if math.isfinite(self.half_step) else self.passes

    def _agrees(self, other: float) -> bool:
        both = math.hypot(0.5 * (self.high - self.low), self.half_step_width)
        return abs(other - self.rate) <= max(AGREED * abs(self.rate), both)

    @property
    def irregular(self) -> bool:
        """Whether a slightly different start at the same step changes the growth, or gives that of half the step."""
        if self.converged is not False or not math.isfinite(self.same_step):
            return False
        nearer = abs(self.same_step - self.half_step) < abs(self.same_step - self.rate)
        return nearer or not self._agrees(self.same_step)

    @property
    def numerical(self) -> bool:
        """Whether half the step gives less than half of the growth, for a motion that is not irregular.

        A motion that passes the same limit at half the step grows there too. If its growth is not known, the limit
        alone decides.
        """
        less = not self.half_step + self.half_step_width >= NUMERICAL * self.rate
        return self.converged is False and less and not (self.irregular or self.passes)

    @property
    def outcome(self) -> Outcome:
        """The verdict that tables and pages show: `state`, but "numerical" if the growth is an effect of the step.

        >>> grows = RunGrowth(rate=10.0, low=9.8, high=10.2, state="grows", amplitude=1e-4, steady=1.0, since=0.1,
        ...                   time_to_half_wall=0.5, cause=None)
        >>> grows.outcome, grows.checked(2.0, 0.1, 0.3).outcome
        ('grows', 'numerical')
        """
        return "numerical" if self.numerical else self.state

    @property
    def check(self) -> Check:
        """Result of the check at half the step, in a word; "" without the check."""
        if self.converged is None:
            return ""
        if self.converged:
            return "converged"
        return "numerical" if self.numerical else "irregular" if self.irregular else "depends on the step"

    @property
    def flags(self) -> tuple[Flag, ...]:
        """A warning if the growth is an effect of the step."""
        if self.check not in ("numerical", "depends on the step"):
            return ()
        how = f"grows by {self.rate:.3g} 1/s" if math.isfinite(self.half_step) else "passes its limit"
        return (Flag(f"The motion {how}. {self.at_half_step}"[:-1], "growth-numerical"),)

    def checked(self, half_step: float, width: float, share: float) -> RunGrowth:
        """The same growth with that at half the step, and the half width of its interval.

        Where both agree, the interval also reaches to the growth without steps: contact that opens and closes has an
        error of first order in the step, of which half the step removes one half.

        >>> grows = RunGrowth(rate=10.0, low=9.8, high=10.2, state="grows", amplitude=1e-4, steady=1.0, since=0.1,
        ...                   time_to_half_wall=0.5, cause=None)
        >>> found = grows.checked(10.5, 0.1, 0.3)
        >>> found.low, found.high
        (9.8, 11.0)
        """
        found = replace(self, half_step=half_step, half_step_width=width, check_share=share)
        without = 2.0 * half_step - self.rate
        reached = without if without > 0.0 else half_step
        if not (found.converged and reached > 0.0):
            return found
        return replace(found, low=min(self.low, reached), high=max(self.high, reached))

    @property
    def words(self) -> str:
        """The verdict in sentences."""
        parts = self.verdict, self._periodic(), self._source(), self._wall_words(), self.at_half_step
        return " ".join(filter(None, parts))

    @property
    def verdict(self) -> str:
        """State of the motion, its growth rate, and its main component.

        >>> RunGrowth(rate=0.0, low=-0.1, high=0.1, state="bounded", amplitude=4e-5, steady=0.05, since=0.1,
        ...           time_to_half_wall=math.inf, cause=None).verdict
        'The motion is bounded: at the end of the run the rim deflects by 0.04 mm, steady within 5 %.'
        >>> RunGrowth(rate=42.0, low=-21.0, high=106.0, state="grows", amplitude=2e-3, steady=1.0, since=0.1,
        ...           time_to_half_wall=0.2, cause=None).verdict
        'The motion grows beyond its limit. Its rate is uncertain: 42 1/s (95 %: -21 to 106).'
        """
        between = f"{self.rate:,.4g} 1/s (95 %: {self.low:,.4g} to {self.high:,.4g})"
        mostly = "" if self.cause is None else f" It is mostly {self.cause.words}."
        if self.state == "grows" and self.low <= 0.0:
            return f"The motion grows beyond its limit. Its rate is uncertain: {between}.{mostly}"
        if self.state == "grows":
            return f"The motion grows by {between}.{mostly}"
        if self.state == "decays":
            return f"The motion decays by {-self.rate:.3g} 1/s (95 %: {-self.high:.3g} to {-self.low:.3g})."
        if self.state == "bounded":
            size = size_words(self.amplitude, self.steady)
            return f"The motion is bounded: at the end of the run the rim deflects by {size}.{mostly}"
        if self.state == "at rest":
            return "Nothing vibrates."
        if self.passes is not None:
            return f"The motion passes its limit too soon to fit a growth rate.{mostly}"
        return f"The run is too short to tell whether the motion grows: {between}. Lengthen t_end."

    def _periodic(self) -> str:
        """Whether the Floquet multipliers of a steady motion can be computed."""
        if not (self.state == "bounded" and self.steady < STEADY):
            return ""
        return "It may be periodic: `casingfem cycles` computes periodic motions and their growth (Floquet)."

    def _source(self) -> str:
        return self.cause.source_words if self.cause is not None and self.state == "grows" else ""

    def _wall_words(self) -> str:
        if not (self.state == "grows" and math.isfinite(self.time_to_half_wall)):
            return ""
        return f"The rim's deflection reaches half the wall at {self.time_to_half_wall:.3g} s."

    @property
    def at_half_step(self) -> str:
        """The growth at half the step, and its meaning; empty without the check."""
        if not math.isfinite(self.half_step):
            passed: dict[bool | None, str] = {
                None: "", True: "At half the step the motion passes this limit too: converged.",
                False: "At half the step the motion stays within this limit: its growth is numerical, reduce dt.",
            }  # fmt: skip
            return passed[self.passes]
        at = f"At half the step it grows by {self.half_step:.3g} 1/s"
        other = f"at the same step from a slightly different start by {self.same_step:.3g} 1/s"
        same = "converged" if self.low > 0.0 else "within the intervals of both steps"
        words: dict[Check, str] = {
            "": "", "converged": f"{at}: {same}.", "numerical": f"{at}: the growth is numerical, reduce dt.",
            "irregular": f"{at}, {other}: the motion is irregular, its growth differs from run to run.",
            "depends on the step": f"{at}: the growth depends on the step, reduce dt.",
        }  # fmt: skip
        return words[self.check]

    def to_dict(self) -> dict[str, object]:
        """JSON-ready."""
        numbers: dict[str, object] = {
            "growth_1_s": self.rate, "growth_low_1_s": self.low, "growth_high_1_s": self.high,
            "amplitude_m": self.amplitude, "steady_rel": self.steady, "since_s": self.since,
            "time_to_half_wall_s": self.time_to_half_wall, "growth_half_step_1_s": self.half_step,
            "growth_half_step_width_1_s": self.half_step_width, "growth_same_step_1_s": self.same_step,
            "check_share": self.check_share,
        }  # fmt: skip
        cause = self.cause
        found: dict[str, object] = {
            "state": self.state, "outcome": self.outcome, "converged": self.converged, "check": self.check,
            "words": self.words, **numbers,
        }  # fmt: skip
        if cause is not None:
            found |= {
                "body": cause.body, "n": cause.n, "blade_mode": cause.mode, "energy_share": cause.share,
                "travel": cause.travel, "source": cause.source, "source_work_J": cause.work,
                "closed_fraction": cause.closed,
            }  # fmt: skip
        plain: dict[str, object] = finite(found)
        return plain
