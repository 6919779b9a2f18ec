"""Codes of problems with a run that ended or stopped, and the flags of a result.

A flag with `failed` means that the numbers do not solve the model: `run` raises, commands end with exit code 3.
Any other flag is a warning: the numbers solve the model, but the model or the step may not describe the machine.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Any, NamedTuple

MADE, MUCH_MADE = 0.01, 0.1  # of the largest energy: 0.5 % and 5 % of a speed
DEEP, TOO_DEEP = 0.01, 0.1  # of the body's length: a strain that linear theory describes, and one it does not
OPEN = 1e-8  # of the largest energy: round-off of a million steps is below
UNSETTLED = 1e-8  # of the largest gap
FAST = 0.4  # of a frequency: change by the speed up to which frequencies of a basis err by less than 1e-6
LEFT, MUCH_LEFT = 1e-6, 1e-2  # of a contact's free motion: the rest of a solve at double precision, and a wrong force


class Trouble(NamedTuple):
    """Meaning of a code, where it is raised and why, and the remedy."""

    meaning: str
    threshold: str
    remedy: str


TROUBLES = MappingProxyType({
    "energy-grows": Trouble(
        "contact and time integration added energy to the motion, which no real contact does",
        f"warning above {MADE:g} of the largest energy of the run (0.5 % of a speed), failure above {MUCH_MADE:g} "
        "(5 % of a speed); the work of loads, drive and friction is not counted",
        "reduce dt, or use Newmark (0.5, 0.55), Moreau-Jean or forward Lagrange, whose forces do not oscillate",
    ),
    "energy-open": Trouble(
        "the energy balance of the run does not close",
        f"warning above {OPEN:g} of the largest energy; rounding errors of a million steps are smaller",
        "shorten the run or reduce dt; if the warning remains, report the scene",
    ),
    "growth-numerical": Trouble(
        "the growth rate of the motion depends on the time step",
        "warning if half the step changes the growth rate by more than 10 % and by more than both confidence "
        "intervals, unless the motion is irregular",
        "reduce dt until half the step gives the same growth rate",
    ),
    "load-unknown": Trouble(
        "a load given as a function has a value that is not finite", "failure at the first step with such a value",
        "correct the function",
    ),
    "motion-overflow": Trouble(
        "the motion is no longer finite", "failure at the step that overflows",
        "reduce dt; check units, stiffness and initial state",
    ),
    "motion-radius": Trouble(
        "rim and tip moved by more than a tenth of the radius",
        "failure above 0.1 of the radius, where no linear model is valid; a warning with on_limit = \"flag\"",
        "find the cause of the growth: friction too high for the lean, a modal interaction, or a value in a wrong unit",
    ),
    "motion-rotor": Trouble(
        "a rotor without a casing moved beyond the limit of the linear model", "failure above a tenth of the shaft's "
        "length, above 2.5 m if no length is known, or above rotor.limit; a warning with on_limit = \"flag\"",
        "reduce the unbalance or the speed, add damping, add a casing, or set rotor.limit",
    ),
    "motion-unbounded": Trouble(
        "a gap changed by a million times what initial state and load can cause", "failure above 1e6 times",
        "reduce dt or friction; check stiffness and units",
    ),
    "never-begins": Trouble(
        "a change that the scene prescribes begins after the end of the run", "warning if its first change is at or "
        "after t_end", "increase t_end, or give the times in seconds from the start",
    ),
    "penetration": Trouble(
        "bodies overlap by more than the linear model permits", f"warning above {DEEP:g} of the shortest rod, the beam "
        f"or the radius, failure above {TOO_DEEP:g}; linear theory is valid for strains of about 1 %",
        "reduce dt, or use a stiffer contact spring",
    ),
    "slip-reverses": Trouble(
        "the slip of a single tip changed its sign: the tip moved faster along the rim than the rim itself",
        "warning from the first such step",
        "ignore this at low speed or high friction; otherwise check speed, friction and compliance of the blade",
    ),
    "spin-beyond": Trouble(
        "a rotor with [spin] left the range of speeds for which its modes were computed",
        "failure if the speed is outside 0 to spin.most_hz by more than 1e-3 of this range; by default most_hz is 1.2 "
        "times the initial speed",
        "set a higher spin.most_hz; if the drive turns the rotor backwards, start at a speed of that sign",
    ),
    "step-too-long": Trouble(
        "the time step is too long for a frequency, a passage or a decay in the scene",
        "warning above 0.2 of the Nyquist frequency (fewer than ten steps a period), or if the step is longer than the "
        "passage of a wave or a tip; the run is refused above 0.5 (fewer than four steps a period)",
        "use the step that the message gives",
    ),
    "tip-moves-along": Trouble(
        "a tip moved so far along the rim that the rim's curvature changes the gap",
        "warning above 0.1 of the clearance",
        "compare this motion with the clearance, because the gap law neglects the curvature of the rim",
    ),
    "turning-fast": Trouble(
        "a body rotates much faster than the speed at which its modes were computed",
        f"warning if the rotation changes a frequency of the basis by more than {FAST:g} of it; up to there "
        "frequencies err by less than 1e-6, or by about 1e-3 without gyroscopic_higher and stiffness_higher",
        "compute the modes at the speed: set [rotation] in the study, then reduce again",
    ),
    "turning-unmodelled": Trouble(
        "the casing rotates, but its basis has no matrices of rotation",
        "warning if turning = \"casing\" and the basis has no gyroscopic matrix",
        "reduce the casing again; a basis from another program needs the arrays gyroscopic and stiffness_by_speed",
    ),
    "turning-unstated": Trouble(
        "the scene does not state whether the casing or the blades rotate", "warning if a basis has matrices of "
        "rotation, or if gravity or a whirl acts, and the speed is not 0",
        "set speed.turning = \"casing\" for a rig with a rotating casing, \"blades\" for a rotor in a fixed casing",
    ),
    "unconverged": Trouble(
        "the contact forces were not found, or they are less accurate than the contact law requires",
        f"failure if a step has no solution, or if the error of the forces is above {MUCH_LEFT:g} of a contact's free "
        f"motion; warning above {LEFT:g} of it. Failure if the updates of an augmented Lagrangian leave a gap above "
        f"{MUCH_LEFT:g} of the largest; warning above {UNSETTLED:g} of it",
        "reduce dt or friction, allow more updates, or give the contacts a compliance",
    ),
    "wall-deflection": Trouble(
        "the rim deflected by more than half of its wall thickness",
        "failure above 0.5 of the wall thickness, the limit of linear theory; a warning with on_limit = \"flag\"",
        "find the cause of the growth: friction too high for the lean, a modal interaction, or a value in a wrong unit",
    ),
})  # fmt: skip
OF_LIMITS = MappingProxyType({
    "wall": "wall-deflection", "radius": "motion-radius", "gap": "motion-unbounded", "energy": "energy-grows",
    "overflow": "motion-overflow", "rotor": "motion-rotor",
})  # fmt: skip


class SceneWarning(UserWarning):
    """Warning of a scene that runs although its result may mislead; the message ends with remedy and code.

    >>> str(SceneWarning("never-begins", "rub.toml: closing: found 3 s"))[:48]
    'rub.toml: closing: found 3 s; increase t_end, or'
    """

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(f"{message}; {TROUBLES[code].remedy} [{code}]")

    def __reduce__(self) -> tuple[Any, ...]:
        return _warned, (self.code, str(self))


def _warned(code: str, words: str) -> SceneWarning:
    found = SceneWarning(code, "")
    found.args = (words,)
    return found


class Flag(str):
    """Text that ends with its code in brackets; `code` is one of `TROUBLES`, or "" in files of older versions.

    >>> flag = Flag("contact made 3 J of 2 J", "energy-grows", failed=True)
    >>> str(flag), flag.code, flag.failed
    ('contact made 3 J of 2 J [energy-grows]', 'energy-grows', True)
    """

    code: str
    failed: bool

    def __new__(cls, words: str, code: str = "", *, failed: bool = False) -> Flag:
        """Split the code from the end of the text."""
        if code and code not in TROUBLES:
            raise KeyError(code)
        whole = f"{words} [{code}]" if code and not words.endswith(f"[{code}]") else words
        flag = super().__new__(cls, whole)
        flag.code, flag.failed = code, failed
        return flag

    def __reduce__(self) -> tuple[Any, ...]:
        return _flag, (str(self), self.code, self.failed)

    def to_dict(self) -> dict[str, object]:
        """JSON-ready."""
        return {"code": self.code, "failed": self.failed, "message": str(self)}

    @staticmethod
    def of(stored: Any) -> Flag:
        """The flag of a file: a dictionary as from `to_dict`, or a text without a code."""
        if isinstance(stored, str):
            return Flag(stored)
        return _flag(stored["message"], stored["code"], bool(stored["failed"]))


def _flag(words: str, code: str, failed: bool) -> Flag:
    return Flag(words, code if code in TROUBLES else "", failed=failed)
