"""Kind of a frequency response (receptance, mobility, accelerance), from its unit or from codes of a universal file.

A response is the receptance times (j omega)^p: p = 0 for a displacement over a force, 1 for a velocity, 2 for an
acceleration.
"""

import re

from casingfem.experiment.uff.set_58 import Function

FORMS = {"receptance": 0, "mobility": 1, "accelerance": 2}
NO_UNITS = ("", "1", "NONE")
UNKNOWN = (0, 1)  # codes: unknown, general
RESPONSES = {8: "receptance", 11: "mobility", 12: "accelerance"}  # by code of the ordinate
FORCE = 13
QUANTITIES = {
    2: "stress", 3: "strain", 5: "temperature", 6: "heat flux", 8: "displacement", 9: "reaction force",
    11: "velocity", 12: "acceleration", 13: "excitation force", 15: "pressure", 16: "mass", 17: "time",
    18: "frequency", 19: "rpm", 20: "order", 21: "sound pressure", 22: "sound intensity", 23: "sound power",
}  # fmt: skip
_LENGTH = r"(n|u|µ|μ|m|c)?m|in(ch)?|mil|ft"
_UNITS = (
    (2, rf"({_LENGTH})/s(ec)?(\^?2|\*\*2|²|/s(ec)?)|g|gn"),
    (1, rf"({_LENGTH})/s(ec)?"),
    (0, _LENGTH),
)
_FORCE = r"(k|m|da)?N|lbf?|kgf|V"


def power_of_unit(unit: str) -> int | None:
    """Power of j omega from the unit of a response; None without a unit, ValueError for other quantities.

    >>> power_of_unit("(m/s^2)/N"), power_of_unit("mm/s"), power_of_unit("NONE")
    (2, 1, None)
    """
    above = re.sub(r"[ ()\[\]]", "", unit)
    if above.upper() in NO_UNITS:
        return None
    above = re.sub(rf"/({_FORCE})$|^1/({_FORCE})\*", "", above, flags=re.IGNORECASE)
    for power, pattern in _UNITS:
        if re.fullmatch(pattern, above, flags=re.IGNORECASE):
            return power
    raise ValueError(f"unit {unit!r}")


def form_of_codes(function: Function) -> str:
    """The form according to the codes of ordinate and denominator; "" if they leave it open."""
    over = function.axes.denominator.kind
    return RESPONSES.get(function.axes.ordinate.kind, "") if over in (FORCE, *UNKNOWN) else ""


def unit_of(function: Function) -> str:
    """Unit of the ordinate over that of its denominator, "" if the file has none."""
    ends = function.axes.ordinate, function.axes.denominator
    above, below = (axis.unit if axis.unit.upper() != "NONE" else "" for axis in ends)
    return f"({above or 1})/({below})" if below else above


def quantity_of(function: Function) -> str:
    """Quantity of a response without a unit that is not motion over force, from its codes; "" if they leave it open.

    It replaces the unit. Since no form follows from it, the user has to state one.
    """
    kinds = function.axes.ordinate.kind, function.axes.denominator.kind
    if unit_of(function) or form_of_codes(function) or all(kind in UNKNOWN for kind in kinds):
        return ""
    above, below = ("unknown" if kind in UNKNOWN else QUANTITIES.get(kind, f"code {kind}") for kind in kinds)
    return above if kinds[1] in UNKNOWN else f"{above}/{below}"
