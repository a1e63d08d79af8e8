"""Sums of colours by lists of columns and weights: where an hour spends most of its time.

Four channels are one vector of the machine. numba makes vectors of loops over entries alone, and
here these jump through memory: so this loop is written in LLVM's own terms. It takes half the time
of the same loop in Python.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

# So many sums run side by side, each over every so many-th entry: one addition need not wait for
# the one before. Their order is always the same.
_SIDE_BY_SIDE = 4
_FLOAT = ir.FloatType()
_FOUR = ir.VectorType(_FLOAT, 4)


@intrinsic
def four_sums(_context, values, column, weight, first, last):  # type: ignore[no-untyped-def]
    """Four sums of weight[e] * values[column[e]] over entries e from `first` until `last`.

    `values` (C, 4) float32; `column` uint16 or int32, none negative; `weight` uint8 or float32; all
    contiguous, the latter two of any shape, their entries counted as they lie in memory. Nothing is
    checked.
    """
    signature = types.UniTuple(types.float32, 4)(values, column, weight, types.int64, types.int64)
    return signature, _make


def _make(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    values, column, weight, first, last = arguments
    value_type, column_type, weight_type, _, _ = signature.args
    rows = _data(context, builder, value_type, values)
    columns = _data(context, builder, column_type, column)
    weights = _data(context, builder, weight_type, weight)
    index, zero = first.type, ir.Constant(first.type, 0)
    sums = [cgutils.alloca_once_value(builder, ir.Constant(_FOUR, [0.0] * 4)) for _ in range(4)]

    def add(entry: Any, into: Any) -> None:
        at = builder.load(builder.gep(columns, [entry]))
        at = at if at.type == index else builder.zext(at, index)
        place = builder.gep(rows, [builder.shl(at, ir.Constant(index, 2))])
        found = builder.load(builder.bitcast(place, _FOUR.as_pointer()), align=4)
        share = builder.load(builder.gep(weights, [entry]))
        if weight_type.dtype != types.float32:
            share = builder.uitofp(builder.zext(share, ir.IntType(32)), _FLOAT)
        one = builder.insert_element(
            ir.Constant(_FOUR, ir.Undefined), share, ir.Constant(ir.IntType(32), 0)
        )
        share = builder.shuffle_vector(
            one, one, ir.Constant(ir.VectorType(ir.IntType(32), 4), [0] * 4)
        )
        flags = ("contract", "nnan", "ninf", "nsz")
        product = builder.fmul(found, share, flags=flags)
        builder.store(builder.fadd(builder.load(into), product, flags=flags), into)

    count = builder.sub(last, first)
    count = builder.select(builder.icmp_signed("<", count, zero), zero, count)
    together = builder.and_(count, ir.Constant(index, -_SIDE_BY_SIDE))
    step = ir.Constant(index, _SIDE_BY_SIDE)
    middle = builder.add(first, together)
    with cgutils.for_range_slice(builder, first, middle, step, index, inc=True) as (entry, _):
        for side, into in enumerate(sums):
            add(builder.add(entry, ir.Constant(index, side)), into)
    one_entry = ir.Constant(index, 1)
    with cgutils.for_range_slice(builder, middle, last, one_entry, index, inc=True) as (entry, _):
        add(entry, sums[0])
    a, b, c, d = (builder.load(into) for into in sums)
    total = builder.fadd(builder.fadd(a, b), builder.fadd(c, d))
    channels = [
        builder.extract_element(total, ir.Constant(ir.IntType(32), channel)) for channel in range(4)
    ]
    return context.make_tuple(builder, signature.return_type, channels)


def _data(context: Any, builder: Any, array_type: Any, array: Any) -> Any:
    """The address of a contiguous array's first element."""
    assert array_type.layout == "C"
    return context.make_array(array_type)(context, builder, value=array).data
