"""Derivatives of squared frequencies by many numbers at once, against one central difference along all of them."""

from collections.abc import Callable, Sequence

import numpy as np

import casingfem as cf

Values = np.ndarray


def assert_slopes(
    shell: cf.Shell, found: cf.Modes, parameters: Sequence[cf.Parameter], *, part: float, within: float,
    of: Callable[[Values], Values] = lambda values: values,
) -> None:  # fmt: skip
    """Assert that omega^2 changes by the sum of all derivatives when all numbers change, to `within` of the largest.

    Each number changes by `part` of itself, or by up to ten times more or less, with alternating signs, so that no
    effect is below a hundredth of the change: a wrong derivative of any one shows. `of` picks or averages the modes.
    """
    count = len(found.omega)
    slopes = [np.diag(cf.updating.eigen_derivatives(found, [each])[0]) for each in parameters]
    at = [each.to_internal(cf.updating.get_value(shell, each.name)) for each in parameters]
    effects = np.array([np.abs(slope * x).max() for slope, x in zip(slopes, at, strict=True)])
    steps = part * np.clip(np.exp(np.mean(np.log(effects))) / effects, 0.1, 10.0) * (-1.0) ** np.arange(len(at))
    sides = []
    for side in (1.0, -1.0):
        moved = shell
        for each, x, step in zip(parameters, at, steps, strict=True):
            moved = cf.updating.with_value(moved, each.name, each.from_internal(x + side * step * abs(x)))
        sides.append(of(cf.modes(moved, count).omega ** 2))
    changes = np.array([of(slope * step * abs(x)) for slope, step, x in zip(slopes, steps, at, strict=True)])
    numeric = 0.5 * (sides[0] - sides[1])
    largest = np.abs(numeric).max()
    assert np.abs(changes).max(axis=1).min() > 0.009 * largest
    assert np.abs(changes.sum(axis=0) - numeric).max() < within * largest
