"""Fourier series of random imperfections from points in the unit cube."""

from dataclasses import dataclass

import numpy as np

from casingfem.io.arrays import Array, FloatArray
from casingfem.modal.family.family import coefficients, terms_of
from casingfem.structure.field.field import Field, SumField
from casingfem.structure.field.random import RandomField, Spectrum, is_random
from casingfem.structure.shell.shell import Shell


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RandomSeries:
    """The fields of a shell as functions of random numbers: amplitude and phase of each harmonic.

    Attributes
    ----------
    quantities : of the fields, l
    fixed : the part that is not random, F (l, 2 p_max + 1) from -p_max to p_max
    spectra : quantity and spectrum of each random part

    Examples
    --------
    >>> import casingfem as cf
    >>> lab = cf.field.RandomField.example(thickness=0.01, radius=0.5, seed=7, scale=0.1, p_max=8)
    >>> tube = cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.3), thickness=0.01, radius_defect=lab,
    ...                 material=cf.Material(E=210e9, nu=0.3, rho=7800.0), mesh=cf.ShellMesh(order=5, rows=1, around=9))
    >>> own = RandomSeries.of(tube)
    >>> own.dimension, own.series(cf.chance.points(3, range(4), own.dimension)).shape
    (14, (4, 1, 17))
    """

    quantities: tuple[str, ...]
    fixed: Array
    spectra: tuple[tuple[str, Spectrum], ...]

    @classmethod
    def of(cls, shell: Shell) -> "RandomSeries":
        """The random fields of a shell, which must be Fourier series around the circumference."""
        parts = {name: flat(field) for name, field in shell.defects.items()}
        terms = [term for field in shell.defects.values() for term in terms_of(field) or ()]
        p_max = max((int(term.p.max()) for term in terms), default=0)
        fixed = [
            np.sum([coefficients(part, p_max) for part in own if not is_random(part)], axis=0)
            if not all(map(is_random, own))
            else np.zeros(2 * p_max + 1, dtype=complex)
            for own in parts.values()
        ]
        spectra = [
            (name, part.spectrum) for name, own in parts.items() for part in own if isinstance(part, RandomField)
        ]
        return cls(quantities=tuple(parts), fixed=np.array(fixed), spectra=tuple(spectra))

    @property
    def dimension(self) -> int:
        """Number of random numbers for a draw."""
        return 2 * sum(len(spectrum.p) for _, spectrum in self.spectra)

    @property
    def groups(self) -> dict[str, int]:
        """Indices of the random numbers of each random quantity, in order."""
        found: dict[str, int] = {}
        for name, spectrum in self.spectra:
            found[name] = found.get(name, 0) + 2 * len(spectrum.p)
        return found

    def series(self, u: FloatArray) -> Array:
        """F (draws, l, 2 p_max + 1) of points u (draws, dimension)."""
        found = np.repeat(self.fixed[None], len(u), axis=0)
        zero, first = found.shape[-1] // 2, 0
        for name, spectrum in self.spectra:
            line, p, last = self.quantities.index(name), spectrum.p, first + 2 * len(spectrum.p)
            size, turn = np.split(u[:, first:last], 2, axis=1)
            half = 0.5 * spectrum.amplitudes(size) * np.exp(-2j * np.pi * turn)
            found[:, line, zero + p] += half
            found[:, line, zero - p] += half.conj()
            first = last
        return found


def flat(field: Field) -> list[Field]:
    """The parts of a nested sum of fields as a list."""
    return [part for each in field.fields for part in flat(each)] if isinstance(field, SumField) else [field]
