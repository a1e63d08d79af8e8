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

from light_transport.rays.ray_table import LARGE_BITS, SMALL_BITS

# So many sums run side by side, each over every so many-th entry: one addition need not wait for
# the one before. Their order is always the same.
_SIDE_BY_SIDE = 4
_FLOAT = ir.FloatType()
_FOUR = ir.VectorType(_FLOAT, 4)


@intrinsic
def four_sums(_context, values, column, weight, first, last):  # type: ignore[no-untyped-def]
    """Four sums of weight[e] * values[column[e]] over entries e from `first` until `last`.

    `values` (C, 4) float32; `column` uint16 or int32, none negative; `weight` float32; all
    contiguous, the latter two of any shape, their entries counted as they lie in memory. Nothing is
    checked.
    """
    signature = types.UniTuple(types.float32, 4)(values, column, weight, types.int64, types.int64)
    return signature, _make


@intrinsic
def counted_sums(_context, values, entry, first, last):  # type: ignore[no-untyped-def]
    """The same over entries that hold a column and a count; see `ray_table.columns_and_rays`."""
    signature = types.UniTuple(types.float32, 4)(values, entry, types.int64, types.int64)
    return signature, _make_counted


def _make(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    values, column, weight, first, last = arguments
    value_type, column_type, weight_type, _, _ = signature.args
    columns = _data(context, builder, column_type, column)
    weights = _data(context, builder, weight_type, weight)

    def read(entry: Any) -> tuple[Any, Any]:
        at = _widened(builder, builder.load(builder.gep(columns, [entry])), first.type)
        return at, builder.load(builder.gep(weights, [entry]))

    rows = _data(context, builder, value_type, values)
    return _summed(context, builder, signature, rows, read, first, last)


def _make_counted(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    values, entries, first, last = arguments
    value_type, entry_type, _, _ = signature.args
    entries = _data(context, builder, entry_type, entries)
    bits = SMALL_BITS if entry_type.dtype == types.uint16 else LARGE_BITS

    def read(entry: Any) -> tuple[Any, Any]:
        word = _widened(builder, builder.load(builder.gep(entries, [entry])), ir.IntType(32))
        at = builder.and_(word, ir.Constant(word.type, (1 << bits) - 1))
        count = builder.add(builder.lshr(word, ir.Constant(word.type, bits)), word.type(1))
        return builder.zext(at, first.type), builder.uitofp(count, _FLOAT)

    rows = _data(context, builder, value_type, values)
    return _summed(context, builder, signature, rows, read, first, last)


def _widened(builder: Any, number: Any, to: Any) -> Any:
    return number if number.type == to else builder.zext(number, to)


def _summed(
    context: Any, builder: Any, signature: Any, rows: Any, read: Any, first: Any, last: Any
) -> Any:
    index, zero = first.type, ir.Constant(first.type, 0)
    sums = [cgutils.alloca_once_value(builder, ir.Constant(_FOUR, [0.0] * 4)) for _ in range(4)]

    def add(entry: Any, into: Any) -> None:
        at, share = read(entry)
        place = builder.gep(rows, [builder.shl(at, ir.Constant(index, 2))])
        found = builder.load(builder.bitcast(place, _FOUR.as_pointer()), align=4)
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
