"""Arrays of bodies and contacts that lack a row, have one too many or a number that is none: every one is refused."""

from dataclasses import fields, replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

BODY = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.1, 0.2], channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)))
RIM = ct.RotatingRim(ring(), blade(), clearance=-1e-5, speed_hz=5.0, casing_velocity=np.ones(len(ring().omega)))
WHOLE = {
    "a modal body": ring(imperfect=0.01),
    "a body of matrices": ct.LinearBody(
        M=np.array([1.0, 2.0, 0.5]), K=np.diag([3.0, 2.0, 1.0]), C=np.diag([0.3, 0.0, 0.1]),
        load=np.array([0.0, -1.0, 0.5]), Q=np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]), gap0=np.array([0.05, 0.1]),
        velocity=np.array([1.0, 0.0, 2.0]), displacement=np.array([0.01, 0.02, -0.03]),
    ),
    "a patch": ct.Patch(
        body=BODY, normal=("x", "y", "x"), load=[0.0, 1.0], displacement=[0.1, 0.2], velocity=[0.1, 0.3],
        clearance=[0.1, 0.2, 0.4], slide=[[0.1], [0.3], [-0.2]], tangent=(("y",), ("x",), ("y",)),
    ),
    "a speed": ct.Speed(time=[0.0, 1.0, 2.0], hz=[1.0, 3.0, 4.0]),
    "a table of forces": ct.laws.ForceTable(depth=[0.0, 1e-6, 3e-6], force=[0.0, 2.0, 11.0]),
    "a rim": RIM,
    "a closed contact": ct.gaps.rim_contact(replace(RIM, casing_velocity=None), mu=0.1),
    "a disk": ct.gaps.BladedDisk(
        blades=5, freq_hz=100.0, modal_mass=0.4, coupling=0.05, mistuning=np.linspace(-0.02, 0.03, 5)
    ),
    "cases": ct.stability.Cases(casing=np.ones((2, 3)), blade=np.ones(2), mu=np.array([0.1, 0.2])),
}  # fmt: skip


def arrays(whole):
    """Fields that are arrays of numbers, dense."""
    for field in fields(whole):
        value = getattr(whole, field.name)
        dense = value.toarray() if hasattr(value, "toarray") else value
        if isinstance(dense, np.ndarray) and dense.dtype.kind == "f" and dense.size:
            yield field.name, dense


def damaged(array):
    """An array without its last row or column, with its last row twice, with a nan and with an infinity."""
    yield from (np.delete(array, -1, axis=axis) for axis in range(array.ndim))
    yield np.concatenate([array, array[-1:]])
    for value in (np.nan, np.inf):
        spoilt = array.copy()
        spoilt.flat[array.size // 2] = value
        yield spoilt


@pytest.mark.parametrize("name", WHOLE)
def test_damaged_arrays_are_refused(name):
    whole, examined = WHOLE[name], 0
    for field, array in arrays(whole):
        for spoilt in damaged(array):
            if (name, field, np.shape(spoilt)) == ("cases", "casing", (2, 2)):
                continue  # for another casing
            with pytest.raises(ct.InputError) as caught:
                replace(whole, **{field: spoilt})
            assert "found" in str(caught.value), field
            assert "expected" in str(caught.value), field
            examined += 1
    assert examined >= 3
