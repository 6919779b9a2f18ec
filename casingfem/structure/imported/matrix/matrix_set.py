"""M, K and maybe C, K4 and G of a part with the meaning of their rows, in the units of their file."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from contact.io.brief import brief

STIFFNESS_AND_MASS = {"K": re.compile("STIF"), "M": re.compile("MASS")}
WORDS = STIFFNESS_AND_MASS | {
    "C": re.compile("DAMP|DMPV"),
    "K4": re.compile("DMPS"),
    "G": re.compile("GYRO|CORIOLIS"),
}  # DMPV, DMPS: Abaqus
OF_A_SET = re.compile(r"(K4|[KMB])([A-Z])\2X?\d?")  # Nastran's names: KAA, MGGX, BXX1, K4AA
LETTERS = {
    "K4": re.compile("K4"),
    "K": re.compile("K"),
    "M": re.compile("M"),
    "C": re.compile("[BC]"),
    "G": re.compile("G$"),
}
ROLES = ("K", "M", "C", "K4", "G")
NEEDED = ("K", "M")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class MatrixSet:
    """Matrices of one part, (n, n) each; K, M, C and K4 symmetric if the file states it.

    Attributes
    ----------
    K, M, C, K4, G
        Stiffness, mass, viscous damping, structural damping (the imaginary part of the stiffness), gyroscopic matrix
        per rad/s (skew); C, K4 and G are None if absent.
    dofs
        Node and direction of each row, (n, 2): 1 to 3 along x, y, z, 4 to 6 about them, 0 a scalar.
    points
        Node -> position, (3,).
    axes
        Node -> directions of its own x, y, z in the axes of the points, rows (3, 3); other nodes have those axes.
    source
        Name of the file, for messages.
    left_out
        Names of other matrices in the files.
    boundary
        Nodes at which the part is joined to others, if the files state them: the grids of EXTRN cards.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> found = cf.modal.structure_matrices(plate)
    >>> found.K.shape == found.M.shape, found.dofs[0].tolist()
    (True, [3, 1])
    """

    K: csc_array
    M: csc_array
    C: csc_array | None = None
    K4: csc_array | None = None
    G: csc_array | None = None
    dofs: IntArray
    points: Mapping[int, FloatArray] = field(default_factory=dict)
    axes: Mapping[int, FloatArray] = field(default_factory=dict)
    source: str = "matrices"
    left_out: tuple[str, ...] = ()
    boundary: tuple[int, ...] = ()

    __repr__ = brief

    def __post_init__(self) -> None:
        shapes = {name: A.shape for name, A in self.named.items()}
        n = len(self.dofs)
        if set(shapes.values()) != {(n, n)}:
            found = ", ".join(f"{name} of {shape[0]} x {shape[1]}" for name, shape in shapes.items())
            raise ModelError("matrix-size", f"{self.source}: found {found}, and {n} dofs")
        if not n:
            raise fault(self.source, "found no entries and no dofs")
        rows, counts = np.unique(self.dofs, axis=0, return_counts=True)
        if counts.max() > 1:
            node, direction = rows[counts.argmax()].tolist()
            found = f"found direction {direction} of node {node} in two rows, expected it in one"
            raise ModelError("matrix-dofs", f"{self.source}: {found}")

    @property
    def named(self) -> dict[str, csc_array]:
        """The existing matrices by their letters."""
        named = {"K": self.K, "M": self.M, "C": self.C, "K4": self.K4, "G": self.G}
        return {name: A for name, A in named.items() if A is not None}


def fault(source: str, message: str) -> ModelError:
    """An error about a malformed file."""
    return ModelError("matrix-file", f"{source}: {message}")


def roles_of(names: Sequence[str], source: str) -> dict[str, str]:
    """Names of K, M, C, K4 and G in a set: KAAX, MAAX, BAAX, K4AAX; k.mtx, m.mtx; job_STIF1, job_MASS1.

    If several fit, Nastran's names of its sets are used: KAA, KGG, KXX, not KASMX.

    Raises
    ------
    ModelError
        `matrix-names` if there is no K or M, or several.

    >>> roles_of(["KAAX", "MAAX", "K4AAX", "PAX"], "part.pch")
    {'K': 'KAAX', 'M': 'MAAX', 'K4': 'K4AAX'}
    >>> roles_of(["KAA", "KASMX", "MAA", "MASMX"], "part.op4")
    {'K': 'KAA', 'M': 'MAA'}
    """
    found: dict[str, str] = {}
    roles = [role_of(name) for name in names]
    for role in ROLES:
        fitting = [name for name, own in zip(names, roles, strict=True) if own == role]
        if len(fitting) > 1:
            fitting = [name for name in fitting if OF_A_SET.fullmatch(name.upper())] or fitting
        if len(fitting) > 1 or (not fitting and role in NEEDED):
            have = ", ".join(names) or "none"
            text = f"found the matrices {have}; {len(fitting)} of these names mean {role}, expected one"
            raise ModelError("matrix-names", f"{source}: {text}")
        if fitting:
            found[role] = fitting[0]
    return found


def role_of(name: str) -> str:
    """K, M, C, K4 or G from a word in a name; the word begins the first or last part of the name. "" if there is none.

    >>> role_of("job_STIF1"), role_of("kit_M"), role_of("KAAX"), role_of("K4XX1"), role_of("PAX")
    ('K', 'M', 'K', 'K4', '')
    """
    upper = name.upper()
    by_word = [role for role, pattern in WORDS.items() if pattern.search(upper)]
    last = re.split(r"[_.-]", upper)[-1]
    by_letter = [role for part in (last, upper) for role, pattern in LETTERS.items() if pattern.match(part)]
    return [*by_word, *by_letter, ""][0]


def is_part(name: str) -> bool:
    """Whether a name is certainly that of K, M, C, K4 or G: one of Nastran's sets, or the letter alone."""
    upper = name.upper()
    return OF_A_SET.fullmatch(upper) is not None or upper in ("B", *ROLES)


def without_null(matrices: Mapping[str, Any]) -> dict[str, Any]:
    """Square matrices without null ones of 1 x 1, which Nastran writes for a purged, that is zero, matrix."""
    square = {name: A for name, A in matrices.items() if A.shape[0] == A.shape[1]}
    return {name: A for name, A in square.items() if A.shape != (1, 1) or csc_array(A).count_nonzero()}


def from_triples(
    rows: IntArray, columns: IntArray, values: FloatArray, size: int, *, symmetric: bool = False
) -> csc_array:
    """A matrix from its entries, numbered from 0.

    If every entry is given only on one side of the diagonal, in any row order, the other side is mirrored. A
    `symmetric` one may have some entries on both sides; the others are mirrored.
    """
    full = coo_array((values, (rows, columns)), shape=(size, size)).tocsr()
    places = coo_array((np.ones(len(rows)), (rows, columns)), shape=(size, size)).tocsr()
    on_both_sides = (places.T > 0).multiply(places > 0)
    one_sided = on_both_sides.nnz == on_both_sides.diagonal().sum()
    if symmetric or one_sided:
        full = full + full.T - full.multiply(places.T > 0)
    full = csc_array(full)
    full.eliminate_zeros()
    return full
