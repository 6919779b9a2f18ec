"""Parameters of an update: a named number of a structure (`addresses.py`), its bounds and its prior."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from casingfem.errors import InputError
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.shell.shell import Shell
from casingfem.updating.addresses import address_of, with_value
from casingfem.updating.numbers import Address, SpringHarmonic, named_numbers
from contact.io.keys import Key
from contact.io.reported import Reported


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """A number that an update may vary.

    Parameters
    ----------
    name
        Address of the number (`updating.addresses`).
    lower, upper
        Bounds, in the parameter's own unit.
    sigma
        Prior standard deviation about the start value; in decades for a log parameter; None for no prior.
    log
        Vary the decimal logarithm; bounds and values are not logarithmic.

    >>> Parameter(name="material.E", lower=150e9, upper=250e9, sigma=10e9).lower
    150000000000.0
    """

    name: Annotated[str, Key("name of a number of the model, such as material.E")]
    lower: Annotated[float, Key("lower bound [unit of the parameter]")]
    upper: Annotated[float, Key("upper bound [unit of the parameter]")]
    sigma: Annotated[
        float | None, Key("prior standard deviation [unit of the parameter; decades if log]", "positive")
    ] = None
    log: Annotated[bool, Key("whether the decimal logarithm is varied")] = False

    def __post_init__(self) -> None:
        if not (np.isfinite(self.lower) and np.isfinite(self.upper) and self.lower < self.upper):
            found = f"{self.lower!r}, {self.upper!r}"
            raise InputError(f"{self.name}: bounds must be finite with lower < upper, found {found}")
        if self.log and self.lower <= 0.0:
            raise InputError(f"{self.name}: found lower = {self.lower!r}, expected a bound above 0, as log = true")
        if self.sigma is not None and not self.sigma > 0.0:
            raise InputError(f"{self.name}: sigma must be positive, found {self.sigma!r}")

    def to_internal(self, value: Any) -> Any:
        """The solver's variable of a value (log10 for a log parameter)."""
        return np.log10(value) if self.log else value

    def from_internal(self, x: Any) -> Any:
        """The value of a solver's variable."""
        return 10.0**x if self.log else x


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class NamedNumbers(Reported):
    """The numbers of a structure that may be varied: addresses, current values, units."""

    name: tuple[str, ...]
    value: tuple[float, ...]
    unit: tuple[str, ...]

    def columns(self) -> dict[str, tuple[Any, ...]]:
        """One row for each number."""
        return {"name": self.name, "value": self.value, "unit": self.unit}


def parameters(structure: Shell | MeshStructure) -> NamedNumbers:
    """Every number of a structure that `update` may vary, by the address that `Parameter` takes.

    Only existing harmonics of fields and springs are listed; others may also be named, and start at 0.

    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.3), thickness=3e-3,
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> cf.updating.parameters(casing)
    NamedNumbers, 6 rows
    name               value  unit
    material.E       2.1e+11  Pa
    material.nu          0.3  -
    material.rho        7800  kg/m^3
    shell.thickness    0.003  m
    chart.radius         0.5  m
    chart.height         0.3  m
    """
    named = named_numbers(structure)
    values = (float(np.real(address_of(structure, name).value(structure))) for name in named)
    return NamedNumbers(tuple(named), tuple(values), tuple(named.values()))


def check_parameters(shell: Shell | MeshStructure, vary: Sequence[Parameter]) -> None:
    """Refuse parameters that repeat an address, start outside their bounds, or have invalid bounds.

    Raises
    ------
    InputError
        With the name of the parameter.
    """
    seen: dict[Address, str] = {}
    for parameter in vary:
        address = address_of(shell, parameter.name)
        moved = address.each if isinstance(address, SpringHarmonic) else (address,)
        for other in {seen[number] for number in moved if number in seen}:
            alias = "a second time" if other == parameter.name else f"and {other}, which changes the same number"
            raise InputError(f"{parameter.name}: found this parameter {alias}, expected it once; remove one")
        seen |= dict.fromkeys(moved, parameter.name)
        start = address.value(shell)
        if not parameter.lower <= start <= parameter.upper:
            expected = f"expected a value within its bounds, {parameter.lower:.6g} to {parameter.upper:.6g}"
            raise InputError(f"{parameter.name}: found the value {start:.6g} in the model, {expected}")
        for side in ("lower", "upper"):
            try:
                with_value(shell, parameter.name, getattr(parameter, side))
            except ValueError as error:
                bound = getattr(parameter, side)
                raise InputError(f"{parameter.name}: {side} = {bound:.6g} is not possible: {error}") from error
