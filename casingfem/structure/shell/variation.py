"""What varies around a shell: harmonics of its fields, and the period that all of it shares."""

from itertools import chain

import numpy as np

from casingfem.io.arrays import Array
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.support import ElasticEdge, outer_support
from casingfem.structure.field.field import Field
from casingfem.structure.field.random import typical
from casingfem.structure.shell.parts import ShellParts


def outer_supports(shell: ShellParts) -> dict[str, object]:
    """Edge -> what holds it from outside, a ring's own support under a ring."""
    return {edge: outer_support(support) for edge, support in shell.supports.items()}


def field_samples(defect: Field) -> int:
    """Points around that show a field whole: four a wave of its highest harmonic, where it says which."""
    return 4 * max(64, 1 + int(getattr(defect, "max_harmonic", None) or 0))


def harmonic_amplitudes(shell: ShellParts, defect: Field) -> Array:
    """Largest amplitude of each harmonic 1, 2, ... around of a field over five heights; random parts are typical."""
    (a0, a1), _ = shell.chart.bounds
    points = field_samples(defect)
    theta = 2.0 * np.pi * np.arange(points) / points
    values = np.real(typical(defect).derivatives(np.linspace(a0, a1, 5)[:, None], theta[None, :]).value)
    return np.asarray(np.abs(np.fft.rfft(values, axis=1)).max(axis=0)[1 : points // 2])


def around_period(shell: ShellParts, floor: float = 1e-3) -> int:
    """The greatest common divisor of all that varies around: a mesh of as many elements shares its symmetry."""
    period = 0
    springs = [s.patterns.values() for s in outer_supports(shell).values() if isinstance(s, ElasticEdge)]
    for defect in (*shell.defects.values(), *chain.from_iterable(springs)):
        amplitude = harmonic_amplitudes(shell, defect)
        period = int(np.gcd.reduce([period, *(1 + np.flatnonzero(amplitude > floor * amplitude.max())).tolist()]))
    for support in outer_supports(shell).values():
        if isinstance(support, Bolts):
            period = int(np.gcd(period, support.period))
    return period


def finest_harmonic(shell: ShellParts, defect: Field, floor: float = 0.02) -> int:
    """The highest circumferential harmonic of a field above `floor` times its largest, by sampling."""
    amplitude = harmonic_amplitudes(shell, defect)
    above = np.flatnonzero(amplitude > floor * amplitude.max())
    return int(above[-1]) + 1 if amplitude.max() > 0.0 else 0
