"""Array types of all packages, and functions that make arrays and mappings of frozen dataclasses read-only.

Most arrays are real. Arrays that may be complex for sensitivities (complex step) are annotated `Array`.
"""

import copyreg
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

K = TypeVar("K")
V = TypeVar("V")
Array: TypeAlias = NDArray[Any]
FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]


def frozen(values: Array) -> Array:
    """Return a read-only copy of an array, for the fields of frozen dataclasses.

    >>> frozen(np.zeros(2)).flags.writeable
    False
    """
    copy = np.array(values)
    copy.setflags(write=False)
    return copy


def freeze(value: object, *names: str) -> None:
    """Make arrays of a frozen dataclass read-only copies, from its `__post_init__`."""
    for name in names:
        object.__setattr__(value, name, frozen(getattr(value, name)))


def read_only(mapping: Mapping[K, V]) -> MappingProxyType[K, V]:
    """Return a read-only copy of a mapping, for the fields of frozen dataclasses; it pickles and copies.

    >>> import pickle
    >>> pickle.loads(pickle.dumps(read_only({"base": 1})))
    mappingproxy({'base': 1})
    """
    return MappingProxyType(dict(mapping))


# Python does not document how its own read-only mapping is pickled or copied
copyreg.pickle(MappingProxyType, lambda mapping: (read_only, (dict(mapping),)))
