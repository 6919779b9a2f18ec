"""Many arrays as one argument of a compiled loop: a table of their addresses.

Numba passes a NamedTuple by value: seven numbers for each array, in every call, thousands of words that are compiled
each time. A bundle is one address. Reading a field loads the array from the table; the loads are marked as constant, so
that the compiler moves them out of loops. Fields are read as those of the NamedTuple.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate

WORD = ir.IntType(64)
BYTES = ir.IntType(8).as_pointer()
FUNCTION: Any = types.WrapperAddressProtocol
# numba's extension points are not typed
configured: Any = numba.config
extending: Any = numba.extending
typeof: Any = numba.typeof
Type: Any = types.Type
Attributes: Any = AttributeTemplate
Primitive: Any = extending.models.PrimitiveModel
struct: Any = cgutils.create_struct_proxy
Words = list[int]
TYPES: dict[tuple[Any, ...], Any] = {}  # by what decides them; they live as long as the program


class Bundle:
    """A NamedTuple in the form for compiled loops, with references to the arrays of its table."""

    __slots__ = ("address", "held", "kind", "table")

    def __init__(self, values: Any) -> None:
        kinds: list[Any] = []
        words: Words = []
        held: list[Any] = [values]
        for value in values:
            _pack(value, kinds, words, held)
        self.kind = bundle_type(type(values), kinds)
        self.table = np.array(words, dtype=np.int64)
        self.held = held
        self.address = address_of(self.table)


class BundleType(Type):  # type: ignore[misc]
    """Type of a bundle: names and types of its fields, and the position in the table where each begins."""

    def __init__(self, name: str, fields: tuple[tuple[str, Any], ...]) -> None:
        self.fields = dict(fields)
        self.begin: dict[str, int] = {}
        at = 0
        for field, kind in fields:
            self.begin[field] = at
            at += _size(kind)
        super().__init__(name=f"{name}({', '.join(f'{field}: {kind}' for field, kind in fields)})")

    @property
    def literal_type(self) -> BundleType:
        """Literal type of an argument: for None, numba omits the branch that is not taken."""
        return self


def bundled(value: Any) -> Any:
    """Return a NamedTuple as a bundle, anything else unchanged; everything unchanged where numba does not compile."""
    return Bundle(value) if hasattr(value, "_fields") and not configured.DISABLE_JIT else value


def _size(kind: Any) -> int:
    """Words of a field: address, shape and strides of an array; one for any other type."""
    if not isinstance(kind, types.Array):
        return 1
    return 1 + int(kind.ndim) * (1 if kind.layout == "C" else 2)


def bundle_type(of: type[Any], kinds: Sequence[Any]) -> BundleType:
    """The type of the bundles of a NamedTuple class with these field types; made once."""
    key = (of, *map(id, kinds))
    found = TYPES.get(key)
    if found is None:
        found = TYPES[key] = BundleType(of.__name__, tuple(zip(of._fields, kinds, strict=True)))
    return found


def array_type(array: Any) -> Any:
    """Numba's type of an array, cached, since finding it takes most of the time of making a bundle.

    The type is the same for read-only and writable arrays; otherwise a loop would be compiled again for each
    combination.
    """
    key = (array.dtype.char, array.ndim, array.flags.num)
    found = TYPES.get(key)
    if found is None:
        found = TYPES[key] = typeof(array).copy(readonly=False)
    return found


def address_of(array: Any) -> int:
    """Address of the first entry of an array."""
    address: int = array.__array_interface__["data"][0]
    return address


def _pack(value: Any, kinds: list[Any], words: Words, held: list[Any]) -> None:
    """Add the type and the words of a field, and the objects that must live as long as the bundle."""
    if isinstance(value, np.ndarray):
        kinds.append(array_type(value))
        words += (address_of(value), *value.shape, *(() if kinds[-1].layout == "C" else value.strides))
    elif isinstance(value, tuple):
        inner = Bundle(value)
        kinds.append(inner.kind)
        words.append(inner.address)
        held.append(inner)
    elif isinstance(value, FUNCTION):
        kinds.append(function_type(type(value), value))
        words.append(value.__wrapper_address__())
    elif isinstance(value, float):
        kinds.append(types.float64)
        words += np.array([value]).view(np.int64).tolist()
    else:
        kinds.append(types.boolean if type(value) in (bool, np.bool_) else types.int64)
        words.append(int(value))


def function_type(of: type[Any], value: Any) -> Any:
    """Numba's type of a function that is called by its address; the same for all functions of a class."""
    found = TYPES.get((of,))
    if found is None:
        found = TYPES[(of,)] = typeof(value)
    return found


def _typeof(value: Bundle, _: Any) -> Any:
    return value.kind


@extending.register_model(BundleType)
class BundleModel(Primitive):  # type: ignore[misc]
    """The address of the table."""

    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, WORD.as_pointer())


def _unboxed(_: Any, value: Any, c: Any) -> Any:
    number = c.pyapi.object_getattr_string(value, "address")
    address = c.pyapi.long_as_voidptr(number)
    c.pyapi.decref(number)
    return extending.NativeValue(c.builder.bitcast(address, WORD.as_pointer()))


@extending.infer_getattr
class BundleAttributes(Attributes):  # type: ignore[misc]
    """Types of the fields."""

    key = BundleType

    def generic_resolve(self, kind: Any, field: str) -> Any:
        """Type of one field, None where there is no such field."""
        return kind.fields.get(field)


def _field(context: Any, builder: Any, kind: Any, table: Any, field: str) -> Any:
    def word(offset: int, into: Any = WORD) -> Any:
        place = builder.gep(table, [ir.Constant(WORD, kind.begin[field] + offset)], inbounds=True)
        found = builder.load(builder.bitcast(place, into.as_pointer()))
        found.set_metadata("invariant.load", builder.module.add_metadata([]))
        return found

    return _loaded(kind.fields[field], context, builder, word)


def _loaded(kind: Any, context: Any, builder: Any, word: Any) -> Any:
    """Value of a field of this type in compiled code; `word` loads a word of its table by number."""
    if isinstance(kind, BundleType):
        return word(0, WORD.as_pointer())
    if isinstance(kind, types.Array):
        return _array(kind, context, builder, word)
    if isinstance(kind, types.FunctionType):
        return _function(kind, context, builder, word)
    if kind == types.boolean:
        return builder.trunc(word(0), ir.IntType(1))
    return word(0, ir.DoubleType() if kind == types.float64 else WORD)


def _array(kind: Any, context: Any, builder: Any, word: Any) -> Any:
    """Array without an owner, made of few instructions: strides of a contiguous one follow from its shape."""
    model, item = context.data_model_manager[kind], kind.dtype.bitwidth // 8
    shape = [word(1 + i) for i in range(kind.ndim)]
    if kind.layout == "C":
        strides = [ir.Constant(WORD, item)]
        for length in shape[:0:-1]:
            strides.insert(0, builder.mul(strides[0], length))
    else:
        strides = [word(1 + kind.ndim + i) for i in range(kind.ndim)]
    count = shape[0]
    for length in shape[1:]:
        count = builder.mul(count, length)
    array = ir.Constant(model.get_value_type(), None)
    array = builder.insert_value(array, ir.Constant(WORD, item), model.get_field_position("itemsize"))
    array = builder.insert_value(array, count, model.get_field_position("nitems"))
    data = word(0, context.get_value_type(kind.dtype).as_pointer())
    array = builder.insert_value(array, data, model.get_field_position("data"))
    for name, lengths in (("shape", shape), ("strides", strides)):
        for i, length in enumerate(lengths):
            array = builder.insert_value(array, length, [model.get_field_position(name), i])
    return array


def _function(kind: Any, context: Any, builder: Any, word: Any) -> Any:
    function = struct(kind.get_precise())(context, builder)
    function.c_addr = word(0, BYTES)
    return function._getvalue()


extending.typeof_impl.register(Bundle)(_typeof)
extending.unbox(BundleType)(_unboxed)
extending.lower_getattr_generic(BundleType)(_field)
