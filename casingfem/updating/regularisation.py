"""Regularisation of ill-posed parameters towards their start; the data determine its weight.

    min |r(x)|^2 + w^2 |(x - x0)/D|^2 over the parameters that are regularised, D their widths

- discrepancy (Morozov): the largest w at which the residuals are as large as their noise, |r|^2 = m; valid if the
  table's sigma are. If the misfit is larger for every w, the L-curve is used.
- l-curve (Hansen, SIAM Review 34, 1992, 561): the corner, the largest curvature of log |r| against log |(x - x0)/D|; it
  does not need the sigma.

Both examine the problem linearised at the last solution; the update is solved again until w does not change.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray
from casingfem.updating.addresses import HARMONIC
from casingfem.updating.identifiability import widths
from casingfem.updating.parameters import Parameter

Rule = Literal["discrepancy", "l-curve"]
WEIGHTS = np.logspace(-4.0, 4.0, 321)


@dataclass(frozen=True, slots=True, kw_only=True)
class Regularisation:
    """Parameters that are regularised, and the rule that sets the weight.

    Parameters
    ----------
    rule
        "discrepancy" or "l-curve".
    names
        The parameters; by default all harmonics of fields and springs.

    Raises
    ------
    InputError
        The rule is unknown.

    >>> Regularisation(rule="l-curve").names
    ()
    """

    rule: Rule = "discrepancy"
    names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.rule not in get_args(Rule):
            raise InputError(f"regularise: found {self.rule!r}, expected {' or '.join(get_args(Rule))}")

    def among(self, vary: Sequence[Parameter]) -> FloatArray:
        """One over the width of the regularised parameters, 0 for the others, (parameters,).

        Raises
        ------
        InputError
            A name is not varied, or there is nothing to regularise.
        """
        known = [p.name for p in vary]
        for name in self.names:
            if name not in known:
                raise InputError(f"regularise: found {name!r}, expected varied parameters: {', '.join(known)}")
        chosen = [p.name in self.names if self.names else is_harmonic(p.name) for p in vary]
        if not any(chosen):
            raise InputError("regularise: found no harmonic among the parameters; name the parameters to regularise")
        return np.where(chosen, 1.0 / widths(vary), 0.0)


def is_harmonic(name: str) -> bool:
    """Whether a parameter is a coefficient of a field or a pattern of springs."""
    return any(HARMONIC.match(part) for part in name.split("."))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Regularised:
    """The chosen weight and its rule; `curve` contains w, |r| and |(x - x0)/D| of the last linearisation."""

    rule: Rule
    weight: float
    names: tuple[str, ...]
    curve: FloatArray
    note: str = ""

    def __repr__(self) -> str:
        """One sentence."""
        note = f"; {self.note}" if self.note else ""
        names = ", ".join(self.names)
        return f"regularised with a weight of {self.weight:.3g}, from the {self.rule} rule: {names}{note}"


def trade_off(
    jacobian: FloatArray, residual: FloatArray, away: FloatArray, prior: FloatArray, inverse: FloatArray
) -> FloatArray:
    """|r| and |(x - x0)/D| of the linearised problem at each of WEIGHTS, rows (w, |r|, |D^-1 (x - x0)|).

    `away` is the present x - x0. `prior` is one over the sigma of parameters with priors. `inverse` is 1/D of the
    regularised parameters.
    """
    held = prior > 0.0
    J = np.vstack([jacobian, np.diag(prior)[held]])
    target = np.concatenate([jacobian @ away - residual, np.zeros(int(held.sum()))])  # J d = target, d = x - x0
    rows = []
    for w in WEIGHTS:
        A = np.vstack([J, w * np.diag(inverse)[inverse > 0.0]])
        b = np.concatenate([target, np.zeros(len(A) - len(J))])
        unit = np.linalg.norm(A, axis=0)
        unit[unit == 0.0] = 1.0
        d = np.linalg.lstsq(A / unit, b, rcond=1e-12)[0] / unit
        rows.append((w, np.linalg.norm(jacobian @ (d - away) + residual), np.linalg.norm(inverse * d)))
    return np.array(rows)


def corner(curve: FloatArray) -> float:
    """The weight of the L-curve's corner, where log |r| against log |x| turns most sharply to the right."""
    t = np.log(curve[:, 0])
    x, y = np.log(np.maximum(curve[:, 1], 1e-300)), np.log(np.maximum(curve[:, 2], 1e-300))
    dx, dy = np.gradient(x, t), np.gradient(y, t)
    bend = (dx * np.gradient(dy, t) - dy * np.gradient(dx, t)) / np.maximum((dx**2 + dy**2) ** 1.5, 1e-12)
    return float(curve[bend[2:-2].argmax() + 2, 0])


def chosen_weight(rule: Rule, curve: FloatArray, residuals: int) -> tuple[float, Rule, str]:
    """Choose the weight; return it with the rule that chose it and a note.

    >>> curve = np.column_stack([WEIGHTS, 10.0 * WEIGHTS / (1.0 + WEIGHTS), 1.0 / (1.0 + WEIGHTS)])
    >>> round(chosen_weight("discrepancy", curve, 25)[0], 2)  # |r| = 5
    1.0
    """
    below = curve[:, 1] ** 2 <= residuals
    if rule == "l-curve":
        return corner(curve), rule, ""
    if not below.any():
        least = float(curve[:, 1].min() / np.sqrt(residuals))
        note = f"the discrepancy rule needs residuals as small as their noise, but they are {least:.2f} times as large"
        return corner(curve), "l-curve", f"{note} at any weight"
    return float(curve[np.flatnonzero(below)[-1], 0]), rule, ""
