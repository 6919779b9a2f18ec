"""One field of a universal file out of its range: the error names line, field, what was found, what is expected."""

import numpy as np
import pytest

import casingfem as cf
from reports.verification.robustness.uff_samples import elements, function, nodes, shape

PARTS = {
    "164": {"units": cf.uff.Units(1, "SI", 1.0, 1.0, 1.0, 0.0)},
    "2411": {"nodes": nodes()},
    "82": {"lines": [cf.uff.TraceLine(number=1, name="rim", color=3, nodes=np.array([1, 2, 0, 3]))]},
    "2412": {"elements": elements()},
    "55": {"shapes": [shape(1)]},
    "58": {"functions": [function(even=True, is_complex=True, double=False)]},
}
FIRST = "the label of the first"
CASES = {  # set, its line from 0, first column, width, what is there then, words
    "factor": ("164", 1, 0, 25, "0.0", "factors above 0"),
    "label 0": ("2411", 0, 0, 10, "0", "found label 0; expected labels from 1, each used once"),
    "label twice": ("2411", 2, 0, 10, FIRST, "again; expected labels from 1, each used once"),
    "no nodes of a line": ("82", 0, 10, 10, "0", "found 0 nodes; expected 1 or more"),
    "more nodes than said": ("82", 0, 10, 10, "3", "nodes beyond the 3 of the header"),
    "a node below 0": ("82", 2, 10, 10, "-2", "found node -2; expected nodes from 1, or 0 for a gap in the line"),
    "no nodes of an element": ("2412", 0, 50, 10, "0", "found 0 nodes; expected"),
    "a label of an element": ("2412", 0, 0, 10, "0", "found label 0; expected labels from 1"),
    "data type": ("55", 5, 40, 10, "3", "found data type 3; expected 2 (real) or 5 (complex)"),
    "characteristic": ("55", 5, 20, 10, "7", "found data characteristic 7; expected 0 to 6"),
    "characteristic below 0": ("55", 5, 20, 10, "-1", "found data characteristic -1; expected 0 to 6"),
    "values a node": ("55", 5, 50, 10, "0", "found 0 values a node; expected"),
    "integers": ("55", 6, 0, 10, "7", "up to 6 and 12"),
    "integers below 0": ("55", 6, 0, 10, "-1", "up to 6 and 12"),
    "reals": ("55", 6, 10, 10, "13", "up to 6 and 12"),
    "integers of a mode": ("55", 6, 0, 10, "1", "expected at least 2 and 4 for analysis type 2"),
    "a node of a shape": ("55", 8, 0, 10, "0", "found node 0; expected nodes from 1, each once"),
    "function type": ("58", 5, 0, 5, "99", "found function type 99; expected 0 to"),
    "direction": ("58", 5, 76, 4, "7", "found direction 7; expected -6 to 6"),
    "direction below": ("58", 5, 76, 4, "-7", "found direction -7; expected -6 to 6"),
    "data type of a function": ("58", 6, 0, 10, "3", "found data type 3; expected 2, 4 (real), 5 or 6 (complex)"),
    "no points": ("58", 6, 10, 10, "0", "found 0"),
    "spacing": ("58", 6, 20, 10, "2", "found spacing 2; expected 0 (uneven) or 1 (even)"),
    "step": ("58", 6, 43, 13, "0.0", "found the step 0 of an even abscissa; expected a step above 0"),
}


def lines_of(kind, path):
    """The lines of a file with one set; its own begin after the first two."""
    cf.uff.write_uff(path, **PARTS[kind])
    return path.read_text().splitlines()


@pytest.mark.parametrize("name", CASES)
def test_a_field_out_of_its_range_is_refused_with_its_line(name, tmp_path):
    kind, row, start, width, text, words = CASES[name]
    path = tmp_path / "part.uff"
    lines = lines_of(kind, path)
    assert cf.uff.read_uff(path) is not None
    at = next(k for k, line in enumerate(lines) if line.strip() == kind) + 1
    if text == FIRST:
        text = lines[at][:10].strip()
    whole = lines[at + row].ljust(80)
    lines[at + row] = (whole[:start] + text.rjust(width) + whole[start + width :]).rstrip()
    path.write_text("\n".join([*lines, ""]))
    with pytest.raises(cf.errors.InputError) as caught:
        cf.uff.read_uff(path)
    assert words in str(caught.value)
    assert "part.uff, line " in str(caught.value)


@pytest.mark.parametrize("count", [1, 8, 9])
def test_a_trace_line_of_one_node_or_more_comes_back(count, tmp_path):
    line = cf.uff.TraceLine(number=1, name="rim", color=3, nodes=np.arange(1, count + 1))
    (found,) = cf.uff.read_uff(cf.uff.write_uff(tmp_path / "line.uff", lines=[line])).lines
    assert found.nodes.tolist() == list(range(1, count + 1))


def test_a_name_of_a_line_of_the_geometry_has_at_most_80_letters(tmp_path):
    name = "".join(chr(97 + k % 26) for k in range(80))
    line = cf.uff.TraceLine(number=1, name=name, color=3, nodes=np.array([1, 2]))
    (found,) = cf.uff.read_uff(cf.uff.write_uff(tmp_path / "a.uff", lines=[line])).lines
    assert (found.name, found.number, found.color, found.nodes.tolist()) == (name, 1, 3, [1, 2])
    long = cf.uff.TraceLine(number=1, name=name + "x", color=3, nodes=np.array([1, 2]))
    with pytest.raises(ValueError, match="does not fit into 80 columns of a universal file"):
        cf.uff.write_uff(tmp_path / "a.uff", lines=[long])
