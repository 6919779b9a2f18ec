"""Eight numbers at a time in compiled loops: a type that numba maps to one vector register.

Loops over arrays that may overlap are not vectorised by the compiler, and short loops over runs are unrolled into
scalars; written with these few operations they are vectors on any machine (on narrower ones, in several parts).
"""

from __future__ import annotations

import operator
from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, models, register_model
from numba.np import arrayobj

from contact.jit import plain

WIDTH = plain.WIDTH
configured: Any = numba.config
SHAPE: Any = ir.VectorType(ir.DoubleType(), WIDTH)
FAST = ("contract", "nsz")  # as the loops: products may be contracted


class VectorType(types.Type):
    """Type of eight double precision numbers."""

    def __init__(self) -> None:
        super().__init__(name=f"vector of {WIDTH}")


VECTOR = VectorType()


class VectorModel(models.PrimitiveModel):
    """Representation in the compiler: one vector register, or several narrower ones."""

    def __init__(self, manager: Any, kind: Any) -> None:
        prepare: Any = super().__init__
        prepare(manager, kind, SHAPE)


register_model(VectorType)(VectorModel)


def _pointer(context: Any, builder: Any, kind: Any, array: Any, first: Any) -> Any:
    make: Any = arrayobj.make_array
    data = make(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [first]), SHAPE.as_pointer())


def _contiguous(array: Any) -> None:
    if array.layout != "C":
        raise TypeError(f"found an array of layout {array.layout}, expected a contiguous one")


def _load(typing: Any, array: Any, first: Any) -> Any:
    _contiguous(array)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        found = builder.load(_pointer(context, builder, signature.args[0], args[0], args[1]))
        found.align = 8
        return found

    return VECTOR(array, types.intp), generate


def _put(typing: Any, array: Any, first: Any, vector: Any) -> Any:
    _contiguous(array)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        place = _pointer(context, builder, signature.args[0], args[0], args[1])
        builder.store(args[2], place).align = 8
        return context.get_dummy_value()

    return types.void(array, types.intp, VECTOR), generate


def _same(typing: Any, number: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        first, none = ir.Constant(ir.IntType(32), 0), ir.Constant(SHAPE, ir.Undefined)
        places = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
        return builder.shuffle_vector(builder.insert_element(none, args[0], first), none, places)

    return VECTOR(types.float64), generate


def _eight(typing: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any, g: Any, h: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        made = ir.Constant(SHAPE, ir.Undefined)
        for i, number in enumerate(args):
            made = builder.insert_element(made, number, ir.Constant(ir.IntType(32), i))
        return made

    return VECTOR(*[types.float64] * WIDTH), generate


def _entry(typing: Any, array: Any, place: Any) -> Any:
    _contiguous(array)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        make: Any = arrayobj.make_array
        data = make(signature.args[0])(context, builder, args[0]).data
        return builder.load(builder.gep(data, [args[1]]))

    return array.dtype(array, types.intp), generate


def _larger(typing: Any, first: Any, second: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", args[0], args[1]), args[0], args[1])

    return VECTOR(VECTOR, VECTOR), generate


def _below_zero(typing: Any, vector: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        found = builder.fcmp_unordered("<", args[0], ir.Constant(SHAPE, [0.0] * WIDTH))
        bits = builder.bitcast(found, ir.IntType(WIDTH))
        return builder.icmp_unsigned("!=", bits, ir.Constant(ir.IntType(WIDTH), 0))

    return types.boolean(VECTOR), generate


def _total(typing: Any, vector: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        part, size = args[0], WIDTH
        while size > 1:  # with single numbers the compiler would make one chain of sums
            size //= 2
            kind, none = ir.VectorType(ir.IntType(32), size), ir.Constant(part.type, ir.Undefined)
            low, high = (
                builder.shuffle_vector(part, none, ir.Constant(kind, list(range(first, first + size))))
                for first in (0, size)
            )
            part = builder.fadd(low, high)
        return builder.extract_element(part, ir.Constant(ir.IntType(32), 0))

    return types.float64(VECTOR), generate


# load(array, k): entries k .. k+7 of a contiguous array, counted flat; put(array, k, v) writes them; same(x): x eight
# times; eight(a, b, ...): these numbers; total(v): the sum; larger(v, w): by entry, w's where one is NaN;
# below_zero(v): whether some entry is, or NaN; entry(array, k): entry k, counted flat, which spares the arithmetic of
# indices that may be negative
load: Any = intrinsic(_load)
put: Any = intrinsic(_put)
same: Any = intrinsic(_same)
eight: Any = intrinsic(_eight)
total: Any = intrinsic(_total)
larger: Any = intrinsic(_larger)
below_zero: Any = intrinsic(_below_zero)
entry: Any = intrinsic(_entry)


if configured.DISABLE_JIT:
    load, put, same, eight, total = plain.load, plain.put, plain.same, plain.eight, plain.total
    larger, below_zero, entry = plain.larger, plain.below_zero, plain.entry


make_signature: Any = signature


def _operation(symbol: Any, instruction: str) -> None:
    """Define an operator on two vectors."""

    class Two(ConcreteTemplate):
        cases: Any = (make_signature(VECTOR, VECTOR, VECTOR),)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return getattr(builder, instruction)(args[0], args[1], flags=FAST)

    typed: Any = infer_global
    typed(symbol)(Two)
    lowered: Any = lower_builtin
    lowered(symbol, VECTOR, VECTOR)(generate)


for _symbol, _instruction in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul")):
    _operation(_symbol, _instruction)
