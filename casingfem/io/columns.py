"""Column names as laboratories write them: any case, units in brackets, common words.

`Frequency [Hz]`, `freq (Hz)`, `f_Hz`, `f/Hz` and `FREQ_HZ` name the same column. A unit is converted; a name whose unit
is missing or unknown is refused, and so are two names of one quantity.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from casingfem.errors import InputError
from casingfem.io.strict_csv import StrictCsv
from casingfem.io.together import together

Units = Mapping[str, tuple[str, float]]


class Quantity(NamedTuple):
    """Words for a quantity; for each unit the standard column name and the conversion factor, None without a unit."""

    name: str
    words: tuple[str, ...]
    units: Units = MappingProxyType({})

    @property
    def own(self) -> tuple[str, ...]:
        """The standard names for columns of this quantity."""
        return tuple(dict.fromkeys(name for name, _ in self.units.values())) or (self.name,)


def _units(name: str, **factors: float) -> dict[str, tuple[str, float]]:
    return {unit: (name, factor) for unit, factor in factors.items()}


_PI = 3.141592653589793
_HZ = _units("freq_hz", hz=1.0, khz=1e3, rpm=1.0 / 60.0) | {
    "rad/s": ("freq_hz", 0.5 / _PI), "1/s": ("freq_hz", 1.0), "1/min": ("freq_hz", 1.0 / 60.0),
}  # fmt: skip
_DEG, _RAD = ("deg", "°", "degree", "degrees"), ("rad", "radian", "radians")


def _lengths(stem: str) -> Units:
    return {
        "m": (f"{stem}_m", 1.0), "mm": (f"{stem}_mm", 1.0), "cm": (f"{stem}_mm", 10.0), "µm": (f"{stem}_mm", 1e-3),
        "um": (f"{stem}_mm", 1e-3), "in": (f"{stem}_mm", 25.4), "inch": (f"{stem}_mm", 25.4),
    }  # fmt: skip


def _angles(stem: str) -> Units:
    return dict.fromkeys(_DEG, (f"{stem}_deg", 1.0)) | dict.fromkeys(_RAD, (f"{stem}_rad", 1.0))


FREQUENCY = Quantity(
    "freq_hz", ("freq", "frequency", "f", "fn", "natural_frequency", "eigenfrequency", "frequenz", "eigenfrequenz"), _HZ
)
TABLE = (
    Quantity("mode", ("mode", "mode_no", "mode_nr", "mode_number", "no", "nr")),
    Quantity("n", ("n", "nd", "nodal_diameter", "nodal_diameters", "knotendurchmesser")),
    FREQUENCY,
    Quantity(
        "sigma_hz", ("sigma", "std", "stdev", "std_dev", "uncertainty", "sigma_f", "streuung", "unsicherheit"),
        _units("sigma_hz", hz=1.0, khz=1e3),
    ),
    Quantity(
        "angle_deg", ("angle", "orientation", "winkel"),
        dict.fromkeys(_DEG, ("angle_deg", 1.0)) | dict.fromkeys(_RAD, ("angle_deg", 180.0 / _PI)),
    ),
    Quantity(
        "zeta", ("zeta", "damping", "damping_ratio", "xi", "dämpfung", "daempfung"),
        dict.fromkeys(("%", "pct", "percent"), ("zeta", 0.01)) | dict.fromkeys(("-", "1"), ("zeta", 1.0)),
    ),
)  # fmt: skip
_METRES = {"m": 1.0, "mm": 1e-3, "cm": 1e-2}
MERIDIAN = (
    Quantity("radius_m", ("radius", "r"), _units("radius_m", **_METRES)),
    Quantity("z_m", ("z", "height", "höhe", "hoehe"), _units("z_m", **_METRES)),
)
PLACE = (
    Quantity("point", ("point", "node", "sensor", "punkt")),
    Quantity(
        "angle_deg", ("angle", "theta", "winkel"),
        dict.fromkeys(_DEG, ("angle_deg", 1.0)) | dict.fromkeys(_RAD, ("angle_deg", 180.0 / _PI)),
    ),
    *MERIDIAN,
)  # fmt: skip
SURVEY = (
    Quantity("theta", ("theta", "angle", "phi", "winkel", "azimuth"), _angles("theta")),
    Quantity("x", ("x",), _lengths("x")),
    Quantity("y", ("y",), _lengths("y")),
    Quantity("z", ("z", "height", "höhe", "hoehe"), _lengths("z")),
    Quantity("radius", ("radius", "r"), _lengths("radius")),
    Quantity("thickness", ("thickness", "wall_thickness", "wanddicke", "dicke"), _lengths("thickness")),
)

SECTIONS = (
    Quantity("section", ("section", "sec", "schnitt")),
    Quantity("z", ("z", "axial"), _lengths("z")),
    Quantity("r", ("r", "radius"), _lengths("r")),
    Quantity("theta_1", ("theta_1", "theta1"), _angles("theta_1")),
    Quantity("theta_2", ("theta_2", "theta2"), _angles("theta_2")),
)


def named(table: StrictCsv, quantities: Sequence[Quantity]) -> StrictCsv:
    """The table with the columns of some quantities under standard names, with converted units.

    Raises
    ------
    InputError
        Two columns have the same quantity, or a column lacks a unit or has an unknown one.
    """
    names, factors, wrong = dict.fromkeys(table.header, ""), dict[str, float](), list[InputError]()
    for quantity in quantities:
        exact = [name for name in table.header if name.lower().strip() in quantity.own]
        alike = [(name, *_parts(name, quantity)) for name in table.header if name not in exact]
        found = [(name, unit) for name, word, unit in alike if word in quantity.words]
        if exact:
            names.update((name, name.lower().strip()) for name in exact)
            continue
        if len(found) > 1:
            both = " and ".join(repr(name) for name, _ in found)
            wrong.append(
                _error(table, found[0][0], f"{both} for the same quantity", f"one column, {_wanted(quantity)}")
            )
        elif found and quantity.units and found[0][1] not in quantity.units:
            what = (
                f"an unknown unit in its name, {found[0][1]!r}"
                if found[0][1]
                else "a column without a unit in its name"
            )
            wrong.append(_error(table, found[0][0], what, _wanted(quantity)))
        elif found:
            ((name, unit),) = found
            names[name], factors[name] = quantity.units.get(unit, (quantity.name, 1.0))
    if wrong:
        raise together(wrong)
    own = {name: new or name for name, new in names.items()}
    return replace(
        table,
        header=tuple(own.values()),
        cells={own[name]: cells for name, cells in table.cells.items()},
        written={new: name for name, new in own.items()},
        factors={own[name]: factor for name, factor in factors.items()},
    )


def _parts(name: str, quantity: Quantity) -> tuple[str, str]:
    """Word and unit of a column's name in lower case; the unit is in brackets, or after _, a blank, / or ,."""
    text = name.strip().lower().replace("μ", "µ")
    bracket = re.fullmatch(r"(.*?)[\s_]*[\[(<](.*)[\])>]", text)
    word, unit = (bracket[1], bracket[2].strip()) if bracket else (text, "")
    if not bracket:
        for each in sorted(quantity.units, key=len, reverse=True):
            if re.search(rf"[\s_/,]{re.escape(each)}$", text):
                word, unit = text[: -len(each)], each
                break
    return re.sub(r"[\s_-]+", "_", word.strip(" _-./,:")), unit


def _wanted(quantity: Quantity) -> str:
    if not quantity.units:
        return quantity.name
    return f"{' or '.join(quantity.own)}, or {quantity.words[0]} [{'], ['.join(list(quantity.units)[:4])}]"


def _error(table: StrictCsv, column: str, found: str, expected: str) -> InputError:
    return table.refuse_header(column=column, found=found, expected=expected)
