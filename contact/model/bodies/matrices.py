"""Given matrices M, K, C, G, K4, checked and in SI: meaning of their rows, unit forces at a contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.io.units import units_of
from contact.model.bodies.matrix_checks import (
    DOUBLE,
    EYE,
    OPTIONAL,
    SKEW,
    Dof,
    asymmetry,
    check_minors,
    checked,
    checked_axes,
    checked_dof,
    rounding_of,
    skew_part,
    symmetric_part,
)

ROUND_OFF = 1e-12  # of a direction's components

Contact: TypeAlias = Sequence[int] | Sequence[Dof] | Mapping[str, Any]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Matrices:
    """Matrices in SI, and the meaning of their rows.

    `M`, `K` (n, n) sparse; `C` and `K4` (structural damping, the imaginary part of K) likewise or None. `G` is the
    gyroscopic matrix, skew: Omega G beside C at a speed Omega [rad/s]. `cross` is the skew part of a nonsymmetric
    stiffness, whose symmetric part is `K`; both None where there is none. `skew`: asymmetry of M and K. `dofs`
    (n,) pairs (node, direction), direction one of `DIRECTIONS`. `points` node -> position [m]; `axes` node ->
    directions of its own x, y, z in the axes of the points, rows (3, 3), for nodes whose dofs are along those.
    `rounding`: largest relative error of an entry of K by the precision in which it was stored.

    >>> found = Matrices.of(K=np.diag([4.0, 9.0]), M=np.eye(2), dofs=[(1, "x"), (1, "y")])
    >>> found.size, found.skew
    (2, (0.0, 0.0))
    """

    M: Any
    K: Any
    C: Any
    dofs: tuple[tuple[int, str], ...]
    points: Mapping[int, Array]
    skew: tuple[float, float]
    K4: Any = None
    G: Any = None
    cross: Any = None
    axes: Mapping[int, Array] = field(default_factory=dict)
    rounding: float = DOUBLE

    @staticmethod
    def of(
        M: Any,
        K: Any,
        C: Any = None,
        *,
        dofs: Sequence[Dof],
        points: Mapping[int, Sequence[float]] | None = None,
        units: str = "m-kg-s",
        K4: Any = None,
        G: Any = None,
        nonsymmetric: bool = False,
        axes: Mapping[int, Any] | None = None,
    ) -> Matrices:
        """Check matrices in any consistent units; raises InputError naming each fault.

        K and C must be symmetric unless they are given as `nonsymmetric`, such as with cross-coupled bearings.
        """
        from scipy.sparse import csc_array, diags_array

        try:
            system = units_of(units)
        except ValueError as error:
            raise InputError(str(error)) from None
        named = tuple(checked_dof(dof) for dof in dofs)
        if len(set(named)) < len(named):
            twice = next(dof for k, dof in enumerate(named) if dof in named[:k])
            raise InputError(f"dofs: found {twice[0]}.{twice[1]} twice, expected each dof once")
        size = [system.length if dof[1][0] == "r" else 1.0 for dof in named]  # a rotation times this is a length
        scale = csc_array(diags_array(np.array(size)))
        matrices: dict[str, Any] = {}
        skews: dict[str, float] = {}
        given = [
            ("M", M, system.mass), ("K", K, system.stiffness), ("C", C, system.damping), ("K4", K4, system.stiffness),
            ("G", G, system.mass),
        ]  # fmt: skip
        for name, A, unit in given:
            if A is None and name in OPTIONAL:
                matrices[name] = None
                continue
            if name == "G":
                found = skew_part(A, len(named))
            elif nonsymmetric and name in ("K", "C"):
                found = checked(name, A, len(named))
                skews[name] = asymmetry(found)
            else:
                found, skews[name] = symmetric_part(name, A, len(named))
            matrices[name] = csc_array(unit * (scale @ found @ scale))
        places = {int(node): system.length * np.asarray(x, dtype=float) for node, x in (points or {}).items()}
        for node, x in places.items():
            if x.shape != (3,) or not np.isfinite(x).all():
                raise InputError(
                    f"points: found {points[node] if points else x!r} for node {node}, expected finite x, y, z"
                )
        rounding = rounding_of(csc_array(K).data)
        M, K = matrices["M"], matrices["K"]
        cross = csc_array(0.5 * (K - K.T)) if skews["K"] > SKEW else None
        K = csc_array(0.5 * (K + K.T))
        check_minors(M, named)
        empty = np.flatnonzero((abs(M) + abs(K)).sum(axis=0) == 0.0)
        if empty.size:
            node, direction = named[int(empty[0])]
            found = f"found neither mass nor stiffness at {node}.{direction}, the first of {empty.size} such dofs"
            raise InputError(f"M, K: {found}, expected one or both: remove the rows and columns of these dofs")
        turned = {int(node): checked_axes(int(node), own) for node, own in (axes or {}).items()}
        return Matrices(
            M=M, K=K, C=matrices["C"], K4=matrices["K4"], G=matrices["G"], cross=cross, dofs=named, points=places,
            axes=turned, skew=(skews["M"], skews["K"]), rounding=rounding,
        )  # fmt: skip

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.dofs)

    def along(self) -> Array:
        """Direction of each row in the axes of the points, (n, 3); zero for a scalar."""
        directions = np.zeros((self.size, 3))
        for row, (node, direction) in enumerate(self.dofs):
            if direction != "q":
                directions[row] = self.axes.get(node, EYE)["xyz".index(direction[-1])]
        return directions

    def rigid_motions(self, about: Array | None = None) -> Array:
        """Translations along x, y, z and rotations about a point (the origin), (n, 6); these where points are known."""
        motions = np.zeros((self.size, 6))
        at = np.zeros(3) if about is None else about
        for row, ((node, direction), along) in enumerate(zip(self.dofs, self.along(), strict=True)):
            if len(direction) == 2:
                motions[row, 3:] = along
                continue
            motions[row, :3] = along
            if node in self.points:
                motions[row, 3:] = np.cross(self.points[node] - at, along)
        return motions

    def loads(self, contact: Contact) -> tuple[tuple[str, ...], Array]:
        """Channel names, and unit forces on them (n, channels)."""
        if isinstance(contact, Mapping):
            P = np.stack([np.asarray(row, dtype=float) for row in contact.values()], axis=1)
            if P.shape[0] != self.size:
                raise InputError(f"contact: found rows of {P.shape[0]} entries, expected {self.size}, one for each dof")
            return tuple(contact), P
        wanted: list[tuple[int, str]] = []
        for item in contact:
            if isinstance(item, tuple):
                wanted.append(checked_dof(item))
                continue
            own = [(int(item), axis) for axis in "xyz" if self.unit_force(int(item), axis) is not None]
            if not own:
                nodes = sorted({node for node, direction in self.dofs if direction in ("x", "y", "z")})
                named = ", ".join(map(str, nodes[:8])) + (f", ... {nodes[-1]}" if len(nodes) > 8 else "")
                raise InputError(f"contact: found node {item}, expected a node with a dof along x, y or z: {named}")
            wanted += own
        forces = [self.unit_force(node, direction) for node, direction in wanted]
        missing = [f"{node}.{axis}" for (node, axis), force in zip(wanted, forces, strict=True) if force is None]
        if missing or not wanted or len(set(wanted)) < len(wanted):
            found = f"{missing[0]}, which is not a dof" if missing else f"{wanted}"
            raise InputError(f"contact: found {found}, expected nodes or dofs of the matrices, each once")
        P = np.zeros((self.size, len(wanted)))
        for column, force in enumerate(forces):
            for row, share in (force or {}).items():
                P[row, column] = share
        return tuple(f"{node}.{direction}" for node, direction in wanted), P

    def unit_force(self, node: int, direction: str) -> dict[int, float] | None:
        """Row -> share of a unit force along x, y or z of the points' axes; None if the node lacks a needed dof."""
        kind = direction[:-1]
        own = {"q": 1.0}
        if direction != "q":
            shares = self.axes.get(node, EYE)[:, "xyz".index(direction[-1])]
            own = {kind + axis: float(v) for axis, v in zip("xyz", shares, strict=True) if abs(v) > ROUND_OFF}
        rows = {dof: row for row, dof in enumerate(self.dofs) if dof[0] == node}
        if not all((node, axis) in rows for axis in own):
            return None
        return {rows[node, axis]: share for axis, share in own.items()}
