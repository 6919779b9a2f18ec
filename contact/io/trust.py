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
        "contact and scheme have made energy, which no contact can",
        f"warning above {MADE:g} of the largest energy of the run (0.5 % of a speed), failure above {MUCH_MADE:g} "
        "(5 % of a speed); work of loads, drive and friction is not counted",
        "reduce dt; take Newmark (0.5, 0.55), Moreau-Jean or forward Lagrange, whose forces do not ring",
    ),
    "energy-open": Trouble(
        "the changes of energy do not add up to the work done",
        f"warning above {OPEN:g} of the largest energy: round-off of a million steps is below",
        "shorten the run or reduce dt; report the scene, since a scheme's own ledger closes to round-off",
    ),
    "growth-numerical": Trouble(
        "the growth of the motion depends on the step",
        "warning where half the step changes the growth by more than 10 % and more than both intervals, of a motion "
        "that is not irregular",
        "reduce dt until half the step gives the same growth",
    ),
    "load-unknown": Trouble(
        "a load that was given as a function is no finite number", "failure at the first step that meets one",
        "correct the function",
    ),
    "motion-overflow": Trouble(
        "the motion is no finite number any more", "failure at the step that overflows",
        "reduce dt; check units, stiffness and start",
    ),
    "motion-radius": Trouble(
        "rim and tip moved by more than a tenth of the radius", "failure above 0.1 of the radius: no linear model "
        "describes such a motion; a warning with on_limit = \"flag\"",
        "search for the cause of the growth: friction above the lean, an interaction, a mistyped unit",
    ),
    "motion-rotor": Trouble(
        "a rotor without a casing moved further than linear theory describes", "failure above a tenth of the shaft's "
        "length, above 2.5 m where no length is known, or above the stated limit; a warning with on_limit = \"flag\"",
        "reduce the unbalance or the speed, add damping, put the rotor into a casing, or state rotor.limit",
    ),
    "motion-unbounded": Trouble(
        "a gap moved by a million times what start and load could do", "failure above 1e6: the motion feeds on itself",
        "reduce dt or friction; check stiffness and units",
    ),
    "never-begins": Trouble(
        "something that was asked for begins after the end of the run", "warning where its first change is at or after "
        "t_end", "lengthen t_end, or give its instants in seconds from the start",
    ),
    "penetration": Trouble(
        "bodies overlap deeply", f"warning above {DEEP:g} of the shortest rod, the beam or the radius, failure above "
        f"{TOO_DEEP:g}: linear theory describes strains of a per cent",
        "reduce dt, or take a stiffer contact spring",
    ),
    "slip-reverses": Trouble(
        "a single tip moved along faster than the rim, so that its slip changed sign", "warning from the first step on",
        "possible at low speed or high friction; else check speed, friction and the compliance of the blade",
    ),
    "spin-beyond": Trouble(
        "a rotor whose speed follows from its torques left the speeds that the run was made for",
        "failure above 1e-3 of the range from standstill to spin.most_hz, 1.2 times the speed at the start by default",
        "give [spin] a larger most_hz; of a rotor that is driven backwards, start at a speed of that sense",
    ),
    "step-too-long": Trouble(
        "the step is long for something that was asked for",
        "warning above 0.2 of the Nyquist limit (fewer than ten steps a period), or a step longer than the passage of "
        "a wave or a place; above 0.5 (fewer than four steps) the run is refused",
        "take the step that the message names",
    ),
    "tip-moves-along": Trouble(
        "a tip moved so far along the rim that its curvature changes the gap", "warning above 0.1 of the clearance",
        "read the gap with care: the gap law leaves curvature out",
    ),
    "turning-fast": Trouble(
        "a body turns much faster than its modes were computed for",
        f"warning where the stiffness by speed changes a frequency of its basis by more than {FAST:g} of it; "
        "up to there frequencies err by less than 1e-6; without gyroscopic_higher and stiffness_higher, by about 1e-3",
        "compute the modes at the speed: give the study a [rotation], and reduce again",
    ),
    "turning-unmodelled": Trouble(
        "a casing turns whose basis has no matrices of rotation",
        "warning where turning = \"casing\" and the basis has no gyroscopic matrix",
        "reduce the casing again; a basis of your own needs gyroscopic and stiffness_by_speed",
    ),
    "turning-unstated": Trouble(
        "the scene does not state which side turns", "warning where a basis has matrices of rotation, or gravity or a "
        "whirl acts, and the speed is not 0",
        "give [speed] turning = \"casing\" for a rig whose casing turns, \"blades\" for a rotor in a casing at rest",
    ),
    "unconverged": Trouble(
        "contact forces were not found, or not to the accuracy of the law",
        f"failure where a step has no solution, where updates end with a gap above {UNSETTLED:g} of the largest, or "
        f"where forces leave {MUCH_LEFT:g} of a contact's motion; warning above {LEFT:g} of it",
        "reduce dt or friction, allow more updates, or let contacts yield",
    ),
    "wall-deflection": Trouble(
        "the rim deflected by more than half of its wall", "failure above 0.5 of the wall, to which linear theory is "
        "valid; a warning with on_limit = \"flag\"",
        "search for the cause of the growth: friction above the lean, an interaction, a mistyped unit",
    ),
})  # fmt: skip
OF_LIMITS = MappingProxyType({
    "wall": "wall-deflection", "radius": "motion-radius", "gap": "motion-unbounded", "energy": "energy-grows",
    "overflow": "motion-overflow", "rotor": "motion-rotor",
})  # fmt: skip


class SceneWarning(UserWarning):
    """Warning of a scene that runs although its result may mislead; the message ends with remedy and code.

    >>> str(SceneWarning("never-begins", "rub.toml: closing: found 3 s"))[:48]
    'rub.toml: closing: found 3 s: lengthen t_end, or'
    """

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(f"{message}: {TROUBLES[code].remedy} [{code}]")

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
