"""Casings that differ from a perfect one by Fourier series around the circumference, and the series of their fields."""

from dataclasses import replace
from typing import Any

import numpy as np

from casingfem.io.arrays import Array
from casingfem.modal.family.point_forms import known_supports
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.field.random import RandomField
from casingfem.structure.shell.shell import Shell


def perfect_shell(shell: Shell) -> Shell:
    """The shell without any field, on the same mesh."""
    fields: dict[str, Any] = {f"{name}_defect": None for name in shell.defects}
    return replace(shell, **fields)


def is_family(shell: Shell) -> bool:
    """Whether a casing is perfect except for Fourier series around, with free, clamped or embedded edges."""
    even = all(terms_of(field) is not None for field in shell.defects.values())
    return bool(shell.defects) and even and perfect_shell(shell).axisymmetric and known_supports(shell)


def terms_of(field: Field) -> list[FourierField] | None:
    """The Fourier series whose sum is a field; None if a part is no series or varies along the axis."""
    if isinstance(field, RandomField):
        return [field.fit]
    if isinstance(field, SumField):
        parts = [terms_of(each) for each in field.fields]
        return None if None in parts else [term for part in parts for term in part or ()]
    if isinstance(field, FourierField) and field.cos.shape[1] == 1 and field.spline is None and field.reach is None:
        return [field]
    return None


def coefficients(field: Field, p_max: int) -> Array:
    """F of f = sum_p F[p] e^(i p theta), p from -p_max to p_max: (2 p_max + 1,).

    >>> coefficients(FourierField.of({2: (0.4, 0.2)}), 2).tolist()
    [(0.2+0.1j), 0j, 0j, 0j, (0.2-0.1j)]
    """
    series = np.zeros(2 * p_max + 1, dtype=complex)
    for term in terms_of(field) or ():
        half = 0.5 * (term.cos[:, 0] - 1j * term.sin[:, 0])
        np.add.at(series, p_max + term.p, half)
        np.add.at(series, p_max - term.p, half.conj())
    return series
