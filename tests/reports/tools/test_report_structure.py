"""The figures of the structure, on a small one of two packages."""

from pathlib import Path

import pytest

from reports.tools.imports_of_tests import PublicNames, internal_names
from reports.tools.structure import ROOT, Structure, circles, duplicates, entries, exported, measures, on_the_way

FILES = {
    "casingfem/__init__.py": "from casingfem.a.shell import Shell\nfrom casingfem.b import modes as modes, _hidden\n",
    "casingfem/a/__init__.py": "",
    "casingfem/a/shell.py": "from casingfem.a import mesh\n\nclass Shell:\n    pass\n",
    "casingfem/a/mesh.py": "def later():\n    from casingfem.a.shell import Shell\n    import casingfem.b\n",
    "casingfem/b.py": "import math\nfrom casingfem.a.mesh import later\n",
    "contact/__init__.py": "x = isinstance(1, int)\n\n\ny = isinstance(x, str)\n",
    "reports/a/__init__.py": "",
    "reports/a/one.py": "",
    "reports/out/copy.py": "",
    "reports/tables.py": "",
}


def built(folder: Path) -> Structure:
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return Structure(folder)


def test_figures_of_a_small_house(tmp_path):
    found = measures(built(tmp_path))
    assert found == {
        "modules": "6", "lines": "12", "median module": "2", "largest module": "3 casingfem.a.mesh",
        "largest folder": "3 casingfem/a", "folders over 25 modules": "0", "names of casingfem": "2",
        "names of contact": "0", "isinstance in contact": "2", "lines of contact": "2", "step loops of contact": "0",
        "modules of contact that use a friction coefficient": "0", "modules with one importer": "0", "duplicates": "0",
        "circles of modules": "1: 3 modules", "pairs of folders that import each other": "1",
        "largest circle of folders": "2", "modules of reports": "3", "modules of tests": "0",
        "largest folder of reports": "2 reports/a", "largest folder of tests": "",
        "tests that use public names only": "0 of 0", "internal names in tests": "0",
    }  # fmt: skip


def test_imports_inside_functions_count_and_names_represent_their_module(tmp_path):
    structure = built(tmp_path)
    assert structure.imports["casingfem.a.shell"] == {"casingfem.a.mesh"}
    assert structure.imports["casingfem.a.mesh"] == {"casingfem.a.shell", "casingfem.b"}
    assert exported(structure, "casingfem") == 2


def test_step_loops_are_entries_of_loops_that_advance_and_a_name_mu_is_a_friction_coefficient(tmp_path):
    files = {
        "contact/__init__.py": "mu = 1.0\n",
        "contact/loop/__init__.py": "",
        "contact/loop/a.py": "@jit_entry\ndef advance_a(x):\n    pass\n\n\n@jit\ndef advance_part(x):\n    pass\n",
        "contact/loop/b.py": "@jit_vectors\ndef advance_b(mu):\n    pass\n\n\n@jit_entry\ndef other():\n    pass\n",
        "contact/law.py": "def law(friction):\n    pass\n",
        "contact/use.py": "def use(law):\n    return law.mu\n",
        "contact/words.py": 'TEXT = "mu and friction"\n',
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    structure = Structure(tmp_path)
    assert (entries(structure), on_the_way(structure)) == (2, 3)


def test_circles_are_the_sets_that_reach_each_other():
    graph = {"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": {"d"}, "f": {"a"}}
    assert circles({name: frozenset(targets) for name, targets in graph.items()}) == [["a", "b", "c"], ["d", "e"]]


def test_a_duplicate_is_six_lines_that_are_twice():
    body = [f"x{k} = {k}" for k in range(6)]
    assert duplicates({"a": body, "b": ["y = 1", *body, "z = 1"]}) == 1
    assert duplicates({"a": body[:5], "b": body[:5]}) == 0
    assert duplicates({"a": [*body, *body]}) == 1


@pytest.mark.parametrize(
    ("text", "internal"),
    [
        ("import casingfem as cf\ncf.modes; cf.edge.Symmetry; cf.errors.InputError; cf.__version__", []),
        ("from casingfem import Shell, edge", []),
        ("from casingfem.cli import main", []),
        ("from casingfem.modal.modes import modes", ["casingfem.modal.modes.modes"]),
        ("def f():\n    from casingfem.modal.modes import modes", ["casingfem.modal.modes.modes"]),
        ("import casingfem.linalg.factor", ["casingfem.linalg.factor"]),
        ("from casingfem.cli import tables", ["casingfem.cli.tables"]),
        ("import casingfem as cf\ncf.edge.ring.Ring", ["casingfem.edge.ring.Ring", "casingfem.edge.ring"]),
        ("import contact as ct\nct.cycles.follow; ct.solver", ["contact.solver"]),
        ("monkeypatch.setattr('casingfem.io.npz.np', None)", ["casingfem.io.npz.np"]),
    ],
)
def test_names_that_are_not_in_a_stub_are_internal(text, internal):
    assert internal_names(text, PublicNames(ROOT)) == internal
