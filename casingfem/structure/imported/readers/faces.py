"""Faces of elements as Abaqus and CalculiX name them: S1, S2, ... of solids; SPOS, SNEG, E1, ... of shells."""

import re

TETRA = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # S1 to S4
WEDGE = ((0, 1, 2), (3, 5, 4), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))  # S1 to S5
CUBE = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))  # S1 to S6
SOLID = {"tetra": TETRA, "wedge": WEDGE, "hexahedron": CUBE}
FLAT = {"triangle": 3, "quad": 4}
NAMED = re.compile(r"(SPOS|SNEG)|([SE])(\d)")


def face_corners(kind: str, face: str, *, plane: bool = False) -> tuple[int, ...]:
    """Local corners of a face of an element; of a shell's sides all of them, of its edges two; () where it has none.

    Edges are E1 to E4 (Abaqus) or S3 to S6 (CalculiX, whose S1 and S2 are the sides), and S1 to S4 of elements in a
    `plane`.

    >>> face_corners("hexahedron20", "S1"), face_corners("quad8", "SPOS"), face_corners("triangle", "E3")
    ((0, 1, 2, 3), (0, 1, 2, 3), (2, 0))
    """
    shape, found = kind.rstrip("0123456789"), NAMED.fullmatch(face)
    if found is None:
        return ()
    if shape in SOLID:
        faces = SOLID[shape]
        return faces[int(found[3]) - 1] if found[2] == "S" and 1 <= int(found[3]) <= len(faces) else ()
    count = FLAT.get(shape, 0)
    if found[1] or (found[2] == "S" and not plane and found[3] in "12"):
        return tuple(range(count))
    edge = int(found[3]) - (1 if plane or found[2] == "E" else 3)
    return (edge, (edge + 1) % count) if 0 <= edge < count else ()
