"""Fields over the mid-surface: small scalar deviations as functions of (z, theta).

A field describes the difference between a perfect and a real casing: relative radius deviation, relative thickness, or
an embedding that varies around the edge. Its evaluation gives six exact numbers: the value, and the first and second
derivatives in z [m] and theta [rad].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import ModelError
from casingfem.io.arrays import Array


class FieldValues(NamedTuple):
    """A field and its exact derivatives at points: six arrays of one shape, z in m, theta in rad.

    >>> import casingfem as cf
    >>> found = cf.field.FourierField.of({2: (1e-3, 0.0)}).derivatives(np.zeros(1), np.zeros(1))
    >>> found.value.tolist(), found.d_theta_theta.tolist()
    ([0.001], [-0.004])
    """

    value: Array
    d_z: Array
    d_theta: Array
    d_zz: Array
    d_z_theta: Array
    d_theta_theta: Array


@runtime_checkable
class Field(Protocol):
    """Interface of a field on a structure; an object with these two methods is sufficient.

    >>> import casingfem as cf
    >>> lobes: Field = cf.field.FourierField.of({2: (1e-3, 0.0)})
    >>> lobes.derivatives(np.zeros(1), np.zeros(1)).value.tolist()
    [0.001]
    """

    def derivatives(self, z: ArrayLike, theta: ArrayLike) -> FieldValues:
        """Value and derivatives at z [m], theta [rad], broadcast against each other."""

    def rotated(self, angle: float) -> Field:
        """Rotate the field by +angle [rad] about the axis: f(z, theta - angle)."""


def relative(field: Field | None, a: ArrayLike, b: ArrayLike) -> Array:
    """1 + f at parameters (a, b); 1 without a field."""
    return np.ones(np.broadcast(a, b).shape) if field is None else 1.0 + field.derivatives(a, b).value


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SumField:
    """The sum of fields of any kind, evaluated term by term; nested sums are flattened.

    Examples
    --------
    >>> from casingfem.structure.field.fourier import FourierField
    >>> a = FourierField(p=[2], cos=[[0.0, 1.0]], sin=[[0.0, 0.0]], z_half=2.0)
    >>> b = FourierField(p=[3], cos=[[0.0, 1.0]], sin=[[0.0, 0.0]], z_half=4.0)
    >>> float((a + b).derivatives(z=1.0, theta=0.0).value)
    0.75
    """

    fields: tuple[Field, ...]

    def __post_init__(self) -> None:
        flat = [part for own in self.fields for part in (own.fields if isinstance(own, SumField) else (own,))]
        if not flat:
            raise ModelError("field-coefficients", "SumField: found no fields, expected at least one")
        object.__setattr__(self, "fields", tuple(flat))

    def derivatives(self, z: ArrayLike, theta: ArrayLike) -> FieldValues:
        """Add the terms' values and derivatives."""
        terms = [field.derivatives(z, theta) for field in self.fields]
        return FieldValues(*(sum(parts[1:], start=parts[0]) for parts in zip(*terms, strict=True)))

    def rotated(self, angle: float) -> SumField:
        """Rotate every term by +angle [rad]."""
        return SumField(tuple(field.rotated(angle) for field in self.fields))

    @property
    def max_harmonic(self) -> int | None:
        """The highest harmonic of all terms; None if a term does not state it."""
        known = [getattr(field, "max_harmonic", None) for field in self.fields]
        numbers = [n for n in known if n is not None]
        return max(numbers) if len(numbers) == len(known) else None

    @property
    def n_resolved(self) -> int | None:
        """The highest harmonic that all surveyed terms resolve; None if no term is a survey."""
        known = [n for field in self.fields if (n := getattr(field, "n_resolved", None)) is not None]
        return min(known, default=None)

    def __add__(self, other: Field) -> SumField:
        return SumField((self, other))

    def __repr__(self) -> str:
        return "SumField of\n" + "\n".join(repr(field) for field in self.fields)
