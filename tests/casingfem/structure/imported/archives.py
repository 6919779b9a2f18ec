"""Small Ansys archives, in the fixed columns of their blocks."""

import casingfem as cf

PLACES = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def nodes_block(start=21):
    rows = [f"{start + k:8d}{0:8d}" + "".join(f"{x:10.3f}" for x in row) for k, row in enumerate(PLACES)]
    return [f"NBLOCK,6,SOLID,{len(rows):8d},{len(rows):8d}", "(2i8,6e10.3)", *rows, "N,R5.3,LOC,       -1,"]


def row(material, kind, number, nodes, width=9):
    numbers = [material, kind, 1, 1, 0, 0, 0, 0, len(nodes), 0, number, *nodes]
    return ["".join(f"{n:{width}d}" for n in numbers[k : k + 19]) for k in range(0, len(numbers), 19)]


def elements_block(*rows):
    body = [line for one in rows for line in one]
    return [f"EBLOCK,19,SOLID,{len(rows):8d},{len(rows):8d}", "(19i9)", *body, "       -1"]


BRICK = row(4, 7, 300, range(21, 29))
PART = ["/PREP7", "ET,7,185", *nodes_block(), *elements_block(BRICK)]


def read(folder, lines):
    (folder / "a.cdb").write_text("\n".join(lines) + "\n")
    return cf.read_mesh(folder / "a.cdb")
