"""Sums the light that rows of the table receive from their columns: the sky's nodes, then patches.

Irradiance of patches by the sky is a mean over their rows: so rows come first, the bounces between
patches next, and their light on rows last. Each entry of the table is read once.

Most of an hour's time passes here. Four channels are one vector of the machine: numba makes vectors
of loops over entries alone, which jump through memory here. The loop is therefore written in LLVM's
own terms, which takes half the time of the same loop in Python.
"""

from typing import Any

import numpy as np
from llvmlite import ir

from light_transport.kernels import hot
from light_transport.rays.ray_table import LARGE_BITS, SMALL_BITS
from vrut_lite.njit import cgutils, intrinsic, types

# Entries added at once, as one vector, each to its own sum: their order is always the same.
_AT_ONCE = 4
_FLOAT, _INT = ir.FloatType(), ir.IntType(32)
_FOUR = ir.VectorType(_FLOAT, 4)
_FLAGS = ("contract", "nnan", "ninf", "nsz")


@hot
def sky_gathered(table, light, first, last, out):  # type: ignore[no-untyped-def]
    """Fill out[first:last] (N, 4): means over each row's rays of light (columns, 4) of nodes."""
    start, entry = table.start, table.entry
    for i in range(first, last):
        end = start[i] + np.int64(table.nodes[i])
        r, g, b, a = counted_sums(light, entry, start[i], end)
        scale = np.float32(1.0) / np.float32(max(table.valid[i], 1))
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = r * scale, g * scale, b * scale, a * scale


@hot
def patches_gathered(table, light, first, last, out):  # type: ignore[no-untyped-def]
    """Add to out[first:last] (N, 4) what the other columns of light (columns, 4) bring."""
    start, entry = table.start, table.entry
    for i in range(first, last):
        begin = start[i] + np.int64(table.nodes[i])
        r, g, b, a = counted_sums(light, entry, begin, start[i + 1])
        scale = np.float32(1.0) / np.float32(max(table.valid[i], 1))
        out[i, 0] += r * scale
        out[i, 1] += g * scale
        out[i, 2] += b * scale
        out[i, 3] += a * scale


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

    def columns_of(entry: Any, number: int) -> list[Any]:
        return _numbers_at(builder, columns, entry, number, column_type.dtype.bitwidth)

    def weights_of(entry: Any, number: int) -> Any:
        return _vector_at(builder, weights, entry, _FLOAT, number)

    rows = _data(context, builder, value_type, values)
    return _summed(context, builder, signature, rows, columns_of, weights_of, first, last)


def _make_counted(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    values, entries, first, last = arguments
    value_type, entry_type, _, _ = signature.args
    entries = _data(context, builder, entry_type, entries)
    bits = SMALL_BITS if entry_type.dtype == types.uint16 else LARGE_BITS
    word = ir.IntType(8 * (2 if entry_type.dtype == types.uint16 else 4))

    def columns_of(entry: Any, number: int) -> list[Any]:
        return _numbers_at(builder, entries, entry, number, bits)

    def counts_of(entry: Any, number: int) -> Any:
        found = _vector_at(builder, entries, entry, word, number)
        less_one = builder.lshr(found, _all(found.type, bits))
        wide = ir.VectorType(_INT, number)
        found = _widened(builder, less_one, wide)
        return builder.sitofp(builder.add(found, _all(wide, 1)), ir.VectorType(_FLOAT, number))

    rows = _data(context, builder, value_type, values)
    return _summed(context, builder, signature, rows, columns_of, counts_of, first, last)


def _widened(builder: Any, number: Any, to: Any) -> Any:
    return number if number.type == to else builder.zext(number, to)


def _all(vector: Any, value: float) -> Any:
    return ir.Constant(vector, [value] * vector.count)


def _vector_at(builder: Any, data: Any, entry: Any, kind: Any, number: int) -> Any:
    """So many numbers that follow each other from an entry on."""
    place = builder.bitcast(builder.gep(data, [entry]), ir.VectorType(kind, number).as_pointer())
    return builder.load(place, align=kind.width // 8 if isinstance(kind, ir.IntType) else 4)


def _numbers_at(builder: Any, data: Any, entry: Any, number: int, bits: int) -> list[Any]:
    """The lowest bits of so many numbers from an entry on, as 64-bit integers.

    They are cut out of words of 64 bits: as parts of a vector each would be moved by itself.
    """
    width, long = data.type.pointee.width, ir.IntType(64)
    at_once = min(number, 64 // width)
    word = ir.IntType(width * at_once)
    found = []
    for k in range(0, number, at_once):
        place = builder.gep(data, [builder.add(entry, ir.Constant(entry.type, k))])
        whole = builder.load(builder.bitcast(place, word.as_pointer()), align=width // 8)
        for part in range(at_once):
            # Machines are little-endian.
            one = builder.lshr(whole, ir.Constant(word, width * part))
            one = one if word == long else builder.zext(one, long)
            found.append(builder.and_(one, ir.Constant(long, (1 << bits) - 1)))
    return found


def _chosen(builder: Any, a: Any, b: Any, which: list[int]) -> Any:
    """The numbers of two vectors, counted through both."""
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(_INT, len(which)), which))


def _summed(
    context: Any,
    builder: Any,
    signature: Any,
    rows: Any,
    columns_of: Any,
    weights_of: Any,
    first: Any,
    last: Any,
) -> Any:
    index, zero = first.type, ir.Constant(first.type, 0)
    wide = ir.VectorType(_FLOAT, 4 * _AT_ONCE)
    sums = cgutils.alloca_once_value(builder, _all(wide, 0.0))
    rest = cgutils.alloca_once_value(builder, _all(_FOUR, 0.0))

    def rows_of(entry: Any, number: int) -> list[Any]:
        places = [
            builder.gep(rows, [builder.shl(column, ir.Constant(index, 2))])
            for column in columns_of(entry, number)
        ]
        return [
            builder.load(builder.bitcast(place, _FOUR.as_pointer()), align=4) for place in places
        ]

    def add(found: Any, share: Any, into: Any) -> None:
        product = builder.fmul(found, share, flags=_FLAGS)
        builder.store(builder.fadd(builder.load(into), product, flags=_FLAGS), into)

    count = builder.sub(last, first)
    count = builder.select(builder.icmp_signed("<", count, zero), zero, count)
    together = builder.and_(count, ir.Constant(index, -_AT_ONCE))
    step = ir.Constant(index, _AT_ONCE)
    middle = builder.add(first, together)
    with cgutils.for_range_slice(builder, first, middle, step, index, inc=True) as (entry, _):
        a, b, c, d = rows_of(entry, _AT_ONCE)
        eight = list(range(8))
        low, high = _chosen(builder, a, b, eight), _chosen(builder, c, d, eight)
        found, shares = _chosen(builder, low, high, list(range(16))), weights_of(entry, _AT_ONCE)
        add(found, _chosen(builder, shares, shares, [k // 4 for k in range(16)]), sums)
    single = ir.Constant(index, 1)
    with cgutils.for_range_slice(builder, middle, last, single, index, inc=True) as (entry, _):
        share = weights_of(entry, 1)
        add(rows_of(entry, 1)[0], _chosen(builder, share, share, [0] * 4), rest)
    total = builder.load(sums)
    for half in (8, 4):
        lower, upper = list(range(half)), list(range(half, 2 * half))
        one, other = (_chosen(builder, total, total, part) for part in (lower, upper))
        total = builder.fadd(one, other, flags=_FLAGS)
    total = builder.fadd(total, builder.load(rest), flags=_FLAGS)
    channels = [builder.extract_element(total, ir.Constant(_INT, channel)) for channel in range(4)]
    return context.make_tuple(builder, signature.return_type, channels)


def _data(context: Any, builder: Any, array_type: Any, array: Any) -> Any:
    """The address of a contiguous array's first element."""
    assert array_type.layout == "C"
    return context.make_array(array_type)(context, builder, value=array).data
