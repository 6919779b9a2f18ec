"""Rules by which a value of `schema.py` may be accepted, checked against the answers where possible.

A value may be the key's own or its default; of a range that the key allows, with its sign or 0; so small that the
answer is that of 0; a seed; a list that is empty; or a key that has no effect in that file, for a stated reason, so
that the answer is that of the file. Huge values have no rule but the last.
"""

import math
import re
from collections.abc import Mapping
from typing import Protocol

Place = tuple[str | int, ...]
ALIKE = 1e-6  # relative: between the answers for a tiny value and for 0
TURNED = re.compile(
    r".*(angle_deg|doublet|split_rel|phase|peak_over_noise\[\d+\])"
)  # of modes that any small number turns
DIGESTS = re.compile(r".*\.(sha256|matrices)")  # of the file's text and of the matrices, which any change changes
WORDS = (".scheme",)  # messages about the friction of a sense of rotation, which a rim at rest does not have
# command, key: reason why the key has no effect on the answer
NO_EFFECT = {
    ("rub", r"speed\.scan\..*"): "only stability and interactions read it",
    ("interactions", r"speed\.hz|record\..*"): "it runs its own speeds and stores its own states",
    ("sweep", r"mass\[1\]\.velocity"): "the sweep varies it",
    ("", r".*most_steps"): "a limit that the run does not reach",
    ("", r".*\.force_(hz|deg)"): "the force is 0",
    ("", r"casing\.(scatter|seed)"): "a seed without scatter",
    ("", r"rig\.test\.part"): "exact responses have no bursts",
}


# command, key: reason why the answer for a tiny value is right, if 0 is refused or has another meaning
TINY = {
    ("interactions", r"speed\.scan\.from_hz"): "any speed above 0 may be the first of a scan",
    ("cycles", r"speed\.to_hz"): "any speed above 0; the branches end at most_points, far above it",
    (
        "cycles",
        r"contact\.out_of_roundness\[1\]\.cos",
    ): "a harmonic p sets the period to 1/p turn at any amplitude",
}


class Damaged(Protocol):
    """A case: its command, key, kind of damage, value, and the value of the key where it is left out."""

    @property
    def command(self) -> str:
        """Of the file."""

    @property
    def path(self) -> Place:
        """Of the key."""

    @property
    def key(self) -> str:
        """The same as the file writes it."""

    @property
    def damage(self) -> str:
        """Its kind."""

    @property
    def value(self) -> object:
        """Value of the key."""

    @property
    def usual(self) -> tuple[object, ...]:
        """Value in the file, and the default."""


def rule(
    case: Damaged, equal: bool, answers: Mapping[tuple[Place, str], Mapping[str, object]], same: Mapping[str, object]
) -> str:
    """The rule by which an accepted case is right; empty where there is none."""
    own, default = case.usual
    if case.value == own:
        return "the file's own value" if equal else ""
    if case.value == default:
        return "the default"
    if equal:
        for (command, pattern), reason in NO_EFFECT.items():
            if command in ("", case.command) and re.fullmatch(pattern, case.key):
                return reason
    if case.path[-1] in ("seed", "draw"):
        return "any whole number"
    if case.damage == "tiny":
        for (command, pattern), reason in TINY.items():
            if command == case.command and re.fullmatch(pattern, case.key):
                return reason
        zero = answers.get((case.path, "zero"))
        return "as 0" if zero is not None and alike(answers[case.path, "tiny"], zero, same) else ""
    if case.damage in ("negative", "zero"):
        return "in the range of the key"
    return "none of them" if case.damage == "empty list" else ""


def alike(found: Mapping[str, object], zero: Mapping[str, object], same: Mapping[str, object]) -> bool:
    """Whether two answers agree in all that two runs of the file have in common."""
    return all(
        near(str(found.get(name)), str(zero.get(name)))
        for name in same
        if not (name.endswith(WORDS) or TURNED.fullmatch(name) or DIGESTS.fullmatch(name))
    )


def near(a: str, b: str) -> bool:
    """Whether two leaves are one, or numbers that agree.

    >>> near("1.0", "1.0000000001"), near("1.0", "1.1"), near("'word'", "'words'")
    (True, False, False)
    """
    if a == b:
        return True
    try:
        return math.isclose(float(a), float(b), rel_tol=ALIKE, abs_tol=1e-12)
    except ValueError:
        return False
