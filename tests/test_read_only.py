"""Values and results cannot be changed after they are made: arrays are read-only, tables are no dictionaries."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from tests.casingfem.test_refused_input import BEAM, ONE, PLATE, STEEL, TUBE
from tests.contact.model.test_damaged_bodies import WHOLE
from tests.contact.synthetic_rub import nodes, rim3, tips
from tests.contact.test_refused import RUB

FACE = cf.imported.grid_mesh(
    "quad9", (2, 2), lambda u: np.pad(u * [0.4, 0.2], ((0, 0), (0, 1))), groups={"root": (0, 0.0)}
)
OPEN = {"a body of matrices", "cases"}  # whose matrices are those that were given
NOTES = ("seconds", "provenance", "source", "extra", "grid")  # what is told of a computation beside its numbers
VALUES = {name: whole for name, whole in WHOLE.items() if name not in OPEN} | {
    "a casing": TUBE,
    "a blade": PLATE,
    "an imported part": BEAM,
    "an imported shell": cf.MeshShell(
        mesh=FACE, thickness=0.01, material=STEEL, supports={"root": cf.Clamped()}, thicknesses={}, materials={}
    ),
    "bolts": cf.Bolts(count=4, k=1e6, loose={2: 0.5}),
    "a field": cf.FourierField.of({2: 0.1, 3: (0.1, 0.2)}),
    "a rig": ONE,
    "responses": ONE.frfs([10.0, 20.0], sensors=[0], drives=[0]),
    "a table": cf.FrequencyTable.from_arrays(freq_hz=[100.0, 200.0], sigma_hz=[0.1, 0.2], n=[2, 3]),
    "air": cf.modal.Influence(offset=[0, 1], stiffness=[1.0, 2.0], damping=[1.0, 2.0]),
    "a rub": ct.Rub(rim3(), [nodes(1)], tips(1)),
    "a rub of a rotor": RUB,
}
RESULTS = {
    "a basis": lambda: cf.reduce(PLATE, cf.Tip(), modes=2, zeta=0.01),
    "modes of a part": lambda: cf.modes(BEAM, 2),
    "whirl frequencies": lambda: ct.rotor.campbell(RUB.rotor, [10.0, 20.0]),
    "a run": lambda: ct.run(WHOLE["a rim"], t_end=1e-3, dt=1e-5, record=ct.Record(every=5, state_every=5)),
}


def changeable(value, name, seen):
    """Names of the arrays, lists and dictionaries within a value that can be changed."""
    if id(value) in seen:
        return
    seen.add(id(value))
    if isinstance(value, np.ndarray):
        if value.flags.writeable and value.size:
            yield name
    elif isinstance(value, dict | list):
        yield name
    elif isinstance(value, Mapping):
        for key, entry in value.items():
            yield from changeable(entry, f"{name}[{key}]", seen)
    elif isinstance(value, tuple):
        for k, entry in enumerate(value):
            yield from changeable(entry, f"{name}[{k}]", seen)
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            if field.name not in NOTES:
                yield from changeable(getattr(value, field.name), f"{name}.{field.name}", seen)


@pytest.mark.parametrize("name", VALUES)
def test_values_cannot_be_changed(name):
    found = [place for place in changeable(VALUES[name], "", set()) if ".apart[1]" not in place]
    assert found == []


@pytest.mark.parametrize("name", RESULTS)
def test_results_cannot_be_changed(name):
    assert list(changeable(RESULTS[name](), "", set())) == []
