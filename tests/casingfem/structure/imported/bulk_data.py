"""Meshes of several kinds of cells as Nastran bulk data, for tests."""

import casingfem as cf

CARDS = {
    "tetra": "CTETRA", "tetra10": "CTETRA", "pyramid": "CPYRAM", "pyramid13": "CPYRAM", "wedge": "CPENTA",
    "wedge15": "CPENTA", "hexahedron": "CHEXA", "hexahedron20": "CHEXA", "quad": "CQUAD4", "triangle": "CTRIA3",
}  # fmt: skip
# places of the nodes that follow the corners, from the order of VTK: upright edges come before the upper ones
WEDGE15 = (*range(9), 12, 13, 14, 9, 10, 11)
BRICK20 = (*range(12), 16, 17, 18, 19, 12, 13, 14, 15)
# corners of the edges of each kind in the order of VTK, by whose middles its other nodes are
EDGES = {
    "tetra10": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "pyramid13": ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)),
    "wedge15": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    "hexahedron20": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
}


def line(*fields):
    """A card in free fields, eight to a line."""
    name, *rest = fields
    rows = [rest[k : k + 8] for k in range(0, len(rest), 8)]
    return "\n".join(
        ",".join([first, *map(str, row)]) for first, row in zip([name, *[""] * len(rows)], rows, strict=False)
    )


def bulk(points, blocks, held=()):
    """Bulk data of points (n, 3) and cells by kind, (kind, nodes from 0 with -1 for none) each, and grids of SPC 3."""
    text = ["BEGIN BULK", *(line("GRID", k + 1, "", *map(repr, x)) for k, x in enumerate(points.tolist()))]
    number = 0
    for kind, cells in blocks:
        order = {"wedge15": WEDGE15, "hexahedron20": BRICK20}.get(kind, range(len(cells[0]) if len(cells) else 0))
        for cell in cells:
            number += 1
            nodes = ["" if cell[k] < 0 else int(cell[k]) + 1 for k in order]
            text.append(line(CARDS[kind], number, 1, *nodes))
    text += [line("SPC1", 3, 123456, int(k) + 1) for k in held]
    return "\n".join([*text, "ENDDATA\n"])


def read(folder, points, blocks, held=()):
    """The mesh that is read from such a file."""
    path = folder / "mixed.bdf"
    path.write_text(bulk(points, blocks, held), encoding="utf-8")
    return cf.read_mesh(path)
