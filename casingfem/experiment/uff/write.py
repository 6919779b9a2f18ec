"""Write universal files: data sets 151, 164, 15 or 2411, 82, 2412, 55, 58 or 58b.

Text sets store the digits of their format: six in sets 15 and 55, and in 58 with singles; thirteen in 58 with doubles;
all in 2411 and 58b.
"""

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from casingfem.experiment.uff.nodes import BEAMS, HEADER_LINES, Elements, Nodes, TraceLine, Units
from casingfem.experiment.uff.set_55 import COMPLEX, REAL, Shape
from casingfem.experiment.uff.set_58 import Channel, Function
from casingfem.io.arrays import Array
from contact.io.outfiles import write_atomic

SHIFTED = 0.01  # of a step: how far the last abscissa may be off for the digits of a header
MARK = "    -1"


def write_uff(
    path: str | os.PathLike[str],
    *,
    header: Sequence[str] = (),
    units: Units | None = None,
    nodes: Nodes | None = None,
    nodes_set: Literal["15", "2411"] = "2411",
    lines: Iterable[TraceLine] = (),
    elements: Elements | None = None,
    shapes: Iterable[Shape] = (),
    functions: Iterable[Function] = (),
    binary: bool = False,
) -> Path:
    """Write a universal file, whole or not at all; `binary` writes functions as set 58b.

    Points [m] are written in SI units, or multiplied by the length factor of `units`, which set 164 then states.

    Raises
    ------
    ValueError
        The format has too few columns: for numbers of more than ten digits, or an even step with more digits.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> line = cf.uff.TraceLine(number=1, name="rim", color=3, nodes=np.array([1, 2, 0, 3]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     cf.uff.read_uff(cf.uff.write_uff(f"{folder}/rim.uff", lines=[line])).lines[0].nodes
    array([1, 2, 0, 3])
    """
    parts: list[bytes] = []
    if header:
        text = [*(_fitted(line, 80).rstrip() for line in header), *[""] * HEADER_LINES]
        parts.append(_text_set("151", text[:HEADER_LINES]))
    if units is not None:
        parts.append(_text_set("164", _units(units)))
    if nodes is not None:
        parts.append(_text_set(nodes_set, _nodes(nodes, nodes_set, (units or Units()).length)))
    parts += [_text_set("82", _trace_line(line)) for line in lines]
    if elements is not None:
        parts.append(_text_set("2412", _elements(elements)))
    parts += [_text_set("55", _shape(shape)) for shape in shapes]
    parts += [_function_set(function, binary=binary) for function in functions]
    if not parts:
        raise ValueError(f"{path}: found no data, expected at least one set")
    return write_atomic(Path(path), b"".join(parts))


def _text_set(number: str, lines: Sequence[str]) -> bytes:
    text = "\n".join([MARK, f"{number:>6}", *lines, MARK]) + "\n"
    return text.encode("utf-8")


def _whole(values: ArrayLike, width: int = 10) -> str:
    """Integers, right-aligned in fields of one width."""
    cells = [f"{value:{width}d}" for value in np.ravel(np.asarray(values, np.int64)).tolist()]
    if any(len(cell) > width for cell in cells):
        raise ValueError(f"{max(cells, key=len).strip()} does not fit into {width} columns of a universal file")
    return "".join(cells)


def _fitted(text: str, width: int) -> str:
    """Text, left-aligned in its columns."""
    if len(text) > width or not text.isprintable():
        raise ValueError(f"{text!r} does not fit into {width} columns of a universal file")
    return f"{text:<{width}}"


def _rows(cells: Sequence[str], each: int) -> list[str]:
    return ["".join(cells[k : k + each]) for k in range(0, len(cells), each)]


def _singles(values: ArrayLike) -> list[str]:
    return [f"{value:13.5E}" for value in np.ravel(np.asarray(values, np.float64)).tolist()]


def _doubles(values: ArrayLike) -> list[str]:
    return [f"{value:20.12E}" for value in np.ravel(np.asarray(values, np.float64)).tolist()]


def _units(units: Units) -> list[str]:
    factors = "".join(f"{value:25.16E}" for value in (units.length, units.force, units.temperature))
    name = _fitted(units.name, 20)
    return [f"{_whole(units.code)}{name}".rstrip(), factors, f"{units.temperature_offset:25.16E}"]


def _nodes(nodes: Nodes, number: str, length: float) -> list[str]:
    heads = np.column_stack([nodes.labels, nodes.systems, nodes.motions, np.full(len(nodes.labels), 8)])
    points = nodes.points * length
    if number == "15":
        return [_whole(head) + "".join(_singles(point)) for head, point in zip(heads, points, strict=True)]
    rows = ["".join(f"{value:25.16E}" for value in point) for point in points.tolist()]
    return [line for head, row in zip(heads, rows, strict=True) for line in (_whole(head), row)]


def _trace_line(line: TraceLine) -> list[str]:
    cells = [_whole(node) for node in line.nodes.tolist()]
    return [_whole([line.number, len(cells), line.color]), _fitted(line.name, 80).rstrip(), *_rows(cells, 8)]


def _elements(elements: Elements) -> list[str]:
    lines = []
    heads = zip(elements.labels.tolist(), elements.kinds.tolist(), elements.properties.tolist(), strict=True)
    for (label, kind, of), beam, nodes in zip(heads, elements.beams, elements.nodes, strict=True):
        lines.append(_whole([label, kind, *of, len(nodes)]))
        lines += [_whole(beam)] if kind in BEAMS else []
        lines += _rows([_whole(node) for node in nodes.tolist()], 8)
    return lines


def _interleaved(values: Array) -> Array:
    """Real and imaginary parts side by side along the last axis; real values unchanged."""
    if not np.iscomplexobj(values):
        return values
    return np.stack([values.real, values.imag], axis=-1).reshape(*values.shape[:-1], -1)


def _shape(shape: Shape) -> list[str]:
    form = COMPLEX if np.iscomplexobj(shape.values) else REAL
    head = [shape.model, shape.analysis, shape.characteristic, shape.quantity, form, shape.values.shape[1]]
    lines = [*_texts(shape.text), _whole(head)]
    lines.append(_whole([len(shape.integers), len(shape.reals), *shape.integers]))
    lines += _rows(_singles(shape.reals), 6) or [""]
    for node, values in zip(shape.nodes.tolist(), _interleaved(shape.values), strict=True):
        lines += [_whole(node), *_rows(_singles(values), 6)]
    return lines


def _texts(text: Sequence[str]) -> list[str]:
    """Five lines of text, NONE for missing ones."""
    return [*(_fitted(line, 80).rstrip() for line in text), *["NONE"] * 5][:5]


def _function_set(function: Function, *, binary: bool) -> bytes:
    header = _function_header(function)
    if not binary:
        return _text_set("58", [*header, *_function_rows(function)])
    form = "<f8" if function.double else "<f4"
    table = _interleaved(function.values[:, None])
    if not function.step:
        table = np.column_stack([function.x, table])
    data = table.astype(form).tobytes()
    first = f"{'58b':>7}{1:6d}{2:6d}{11:12d}{len(data):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    return "\n".join([MARK, first, *header, ""]).encode("utf-8") + data + f"{MARK}\n".encode()


def _function_rows(function: Function) -> list[str]:
    table = _interleaved(function.values[:, None])
    if function.step:
        return _rows(_doubles(table), 4) if function.double else _rows(_singles(table), 6)
    if not function.double:
        return _rows(_singles(np.column_stack([function.x, table])), 6)
    points = [x + "".join(_doubles(row)) for x, row in zip(_singles(function.x), table, strict=True)]
    return _rows(points, 1 if np.iscomplexobj(function.values) else 2)


def _function_header(function: Function) -> list[str]:
    """The eleven lines above the numbers."""
    number, version, case = function.numbers
    places = "".join(_channel(channel) for channel in (function.response, function.reference))
    single, double = (5, 6) if np.iscomplexobj(function.values) else (2, 4)
    even = function.step > 0.0
    start, step = (float(function.x[0]), function.step) if even else (0.0, 0.0)
    cells = [_most_digits(value) for value in (start, step, function.z)]
    off = abs(float(cells[0]) - start) + abs(float(cells[1]) - step) * (len(function.x) - 1)
    if off > SHIFTED * step:
        raise ValueError(
            f"the abscissa from {start!r} in steps of {step!r} has more digits than set 58 keeps: its last point would"
            f" be off by {off / step:.2g} steps; write fewer points, or step = 0 to write every abscissa"
        )
    axes = [
        f"{_whole(axis.kind)}{_whole(axis.exponents, 5)} {_fitted(axis.label, 20)} {_fitted(axis.unit, 20)}"
        for axis in function.axes
    ]
    return [
        *_texts(function.text),
        f"{_whole(function.kind, 5)}{_whole(number)}{_whole(version, 5)}{_whole(case)}{places}",
        f"{_whole([double if function.double else single, len(function.x), int(even)])}{''.join(cells)}",
        *axes,
    ]


def _channel(channel: Channel) -> str:
    return f" {_fitted(channel.name, 10)}{_whole(channel.node)}{_whole(channel.direction, 4)}"


def _most_digits(value: float) -> str:
    """Thirteen columns, right-aligned, with at least one blank: five decimals, or six if needed."""
    usual = f"{value:13.5E}"
    more = f"{value:13.6E}"
    return more if float(usual) != value and len(more.strip()) <= 12 else usual
