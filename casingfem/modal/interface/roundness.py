"""What contact needs to know of a rim's shape: its out-of-roundness, from a survey to the gap, and its thickness."""

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.modal.interface.chart_rows import rim_places
from casingfem.modal.interface.kinds import Rim
from casingfem.structure.shell.shell import Shell, require_shell

LEAST = 64  # angles at which the radius is read
ROUND_OFF = 1e-14  # of the radius


def rim_shape(shell: Shell, rim: Rim) -> FloatArray:
    """Deviation of each line's radius from its mean [m], d(theta) = sum_n c_n cos n theta + s_n sin n theta.

    Columns as the channels of a rim: cos0 .. cosN, sin1 .. sinN, N = `rim.n_max`; (lines, 2 N + 1). Round-off is zero.
    """
    N = rim.n_max
    count = max(LEAST, 4 * N)
    theta = 2.0 * np.pi * np.arange(count) / count
    found = []
    for place in rim_places(shell, rim):
        x = shell.geometry(np.full(count, place), theta).surface.x
        radius = np.hypot(x[0], x[1])
        waves = 2.0 * np.fft.rfft(radius - radius.mean())[: N + 1] / count
        waves[np.abs(waves) < ROUND_OFF * radius.mean()] = 0.0
        waves[0] = 0.0
        found.append(np.concatenate([waves.real, -waves.imag[1:]]))
    return np.array(found)


def rim_thickness(shell: Shell, rim: Rim) -> float:
    """Least thickness of the wall on a rim's lines [m]: linear theory carries deflections of part of it."""
    theta = 2.0 * np.pi * np.arange(LEAST) / LEAST
    places = rim_places(shell, rim)
    return float(min(shell.geometry(np.full(LEAST, place), theta).thickness.min() for place in places))


def out_of_roundness(casing: Shell, rim: Rim, *, line: int = 0) -> list[dict[str, float]]:
    """The rim's deviation from a circle as contact takes it: terms {p, cos, sin} [m], p from 1 to n_max.

    Positive where the radius is larger. `cf.reduce` stores the same in the basis, where a scene with
    `out_of_roundness = "basis"` finds it.

    Parameters
    ----------
    casing
        A shell whose radius field comes from a survey, harmonics, or a draw.
    rim
        Edge or lines, and the highest harmonic `n_max`.
    line
        Which of the rim's lines.

    Raises
    ------
    ModelError
        If the rim has no such line.

    Examples
    --------
    >>> import casingfem as cf
    >>> steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.5, height=0.2), thickness=3e-3, material=steel,
    ...                   supports={"base": cf.Clamped()}, radius_defect=cf.FourierField.of({3: 1e-3}))
    >>> terms = cf.out_of_roundness(casing, cf.Rim("top", n_max=4))
    >>> [(term["p"], round(term["cos"], 9)) for term in terms]
    [(3, 0.0005)]
    """
    require_shell(casing, "out_of_roundness")
    shapes = rim_shape(casing, rim)
    if not 0 <= line < len(shapes):
        raise ModelError("interface-lines", f"line must lie between 0 and {len(shapes) - 1} here, found {line!r}")
    c, N = shapes[line], rim.n_max
    return [{"p": p, "cos": float(c[p]), "sin": float(c[N + p])} for p in range(1, N + 1) if c[p] or c[N + p]]
