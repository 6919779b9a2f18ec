"""Identifiability of parameters: singular values of the Jacobian, scaled by the prior widths of the parameters.

J are the derivatives of the weighted residuals. D is the width of each parameter before the test: its prior's sigma, or
without a prior the standard deviation of a uniform distribution between the bounds, their distance over sqrt 12.

    J D = U S V^T:   a singular value s reduces the width along V to 1/sqrt(1 + s^2) of its prior value.

Directions with s < 1 are determined by the prior or the bounds, not by the data.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.updating.parameters import Parameter
from contact.io.columns import Column, table_lines, word
from contact.io.reported import Reported

SEEN = 1.0  # singular value above which the data state more than was known
NAMED = 0.3  # a parameter's share from which it is named in a direction


def widths(vary: Sequence[Parameter]) -> FloatArray:
    """Width of each parameter's prior, in the solver's units, (parameters,)."""
    return np.array(
        [p.sigma if p.sigma is not None else (p.to_internal(p.upper) - p.to_internal(p.lower)) / 12**0.5 for p in vary]
    )


COLUMNS = (
    Column("singular", "Singular value: width of the direction before the test over its width from the data alone.",
           lambda found: found.singular, head="singular value", format=".4g"),
    Column("left_rel", "Width of the direction after the test over that before.",
           lambda found: 1.0 / np.hypot(1.0, found.singular), head="left", format=".3f"),
    Column("direction", "Main parameters of the direction with their shares, in widths before the test.",
           lambda found: [found.words(k) for k in range(len(found.singular))], format=word),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Identifiability(Reported):
    """Singular values and directions of a Jacobian.

    Attributes
    ----------
    names
        The parameters.
    singular
        Singular values, largest first, (parameters,).
    directions
        Their directions as columns, in widths of the parameters, (parameters, parameters).
    left
        Ratio of each parameter's standard deviation after the test, from data and prior width, to that before,
        (parameters,).
    """

    COLUMNS: ClassVar = COLUMNS

    names: tuple[str, ...]
    singular: FloatArray
    directions: FloatArray
    left: FloatArray

    @property
    def rank(self) -> int:
        """Number of directions that the data determine."""
        return int(np.count_nonzero(self.singular > SEEN))

    @property
    def unseen(self) -> tuple[str, ...]:
        """Parameters whose uncertainty the table reduces by less than a tenth."""
        return tuple(name for name, left in zip(self.names, self.left, strict=True) if left > 0.9)

    def words(self, k: int) -> str:
        """Text for one direction: its main parameters with their shares."""
        column = self.directions[:, k]
        column = column * np.sign(column[np.abs(column).argmax()])
        shown = [i for i in np.argsort(-np.abs(column)) if abs(column[i]) > NAMED]
        return " ".join(f"{column[i]:+.2f} {self.names[i]}" for i in shown)

    def to_json(self) -> dict[str, object]:
        """Plain data."""
        return {
            "rank": self.rank,
            "singular": self.singular.tolist(),
            "left": self.left.tolist(),
            "unseen": list(self.unseen),
            "directions": [self.words(k) for k in range(len(self.names))],
        }

    def __repr__(self) -> str:
        """A row for each direction, and the parameters that the table does not determine."""
        lines = table_lines(self.COLUMNS, self.records())
        lines.append(f"the data determine {self.rank} of {len(self.names)} directions")
        if self.unseen:
            lines.append(f"the table contains no information on {', '.join(self.unseen)}")
        return "\n".join(lines)


def identifiability(vary: Sequence[Parameter], jacobian: FloatArray) -> Identifiability:
    """Identifiability from a Jacobian (residuals, parameters) of the data's weighted residuals.

    >>> two = [Parameter(name=f"material.{name}", lower=0.0, upper=12**0.5) for name in ("E", "rho")]
    >>> identifiability(two, np.array([[10.0, -10.0]])).singular.round(6).tolist()
    [14.142136, 0.0]
    """
    width = widths(vary)
    scaled = jacobian * width
    _, s, rows = np.linalg.svd(scaled, full_matrices=True)
    singular = np.zeros(len(vary))
    singular[: len(s)] = s[: len(vary)]
    left = np.sqrt(np.sum(rows.T**2 / (1.0 + singular**2), axis=1))
    return Identifiability(names=tuple(p.name for p in vary), singular=singular, directions=rows.T, left=left)
