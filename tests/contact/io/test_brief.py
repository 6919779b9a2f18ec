"""One line that describes a value: fields beside their defaults, lists and texts cut at their limits."""

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

import contact as ct


@dataclass(frozen=True, eq=False)
class Part:
    size: float = 1.0
    name: str = "part"
    values: Any = field(default_factory=lambda: np.zeros(2))
    more: Any = None
    hidden: int = field(default=0, repr=False)


class Word:
    def __init__(self, text):
        self.text = text

    def __repr__(self):
        return self.text


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, ""),
        ({"size": 1.0 / 3.0}, "size=0.333333"),
        ({"size": 12345678.0}, "size=1.23457e+07"),
        ({"name": "a b"}, "name='a b'"),
        ({"hidden": 5}, ""),
        ({"values": np.zeros(2)}, ""),
        ({"values": np.array([0.0, 1e-9])}, "values=array(2)"),
        ({"values": np.zeros(3)}, "values=array(3)"),
        ({"values": np.ones((3, 4))}, "values=array(3 x 4)"),
        ({"values": None}, "values=None"),
        ({"more": np.float64(2.5)}, "more=2.5"),
        ({"more": np.int64(7)}, f"more={np.int64(7)!r}"),
        ({"more": [1, 2, 3, 4]}, "more=[1, 2, 3, 4]"),
        ({"more": (1, 2, 3, 4, 5)}, "more=[1, 2, 3, 4, ... 5]"),
        ({"more": {"a": 0.5, "b": "c"}}, "more={a: 0.5, b: 'c'}"),
        ({"more": MappingProxyType({str(k): k for k in range(5)})}, "more={0: 0, 1: 1, 2: 2, 3: 3, ... 5}"),
        ({"more": Word("w" * 90)}, f"more={'w' * 90}"),
        ({"more": Word("w" * 91)}, "more=Word(...)"),
        ({"more": Word("first\nsecond")}, "more=first"),
        ({"size": 2.0, "more": True}, "size=2, more=True"),
    ],
)
def test_fields_beside_their_defaults_are_shown(changes, words):
    assert ct.io.brief(Part(**changes)) == f"Part({words})"


def test_a_class_of_ones_own_prints_so_also_within_a_value_of_the_package():
    @dataclass(frozen=True, slots=True)
    class Ramp:
        slope: float
        words: str = "ramp"

        __repr__ = ct.io.brief

    assert repr(Ramp(slope=2.0e5)) == "Ramp(slope=200000)"
    assert repr(ct.Scene(what=[ct.Wall(x=0.1)], law=Ramp(slope=2.0), t_end=0.5)) == (
        "Scene(what=[Wall(x=0.1)], law=Ramp(slope=2), t_end=0.5)"
    )
    with pytest.raises(TypeError, match="dataclass"):
        ct.io.brief(3.0)
