"""Four wavelengths as one SIMD register, in two operations.

numba leaves LLVM's vectorisation of straight-line code off, and a loop over four lanes is too
short for its loop vectoriser: written out, four lanes would take four times the instructions.
These intrinsics say it to LLVM directly. Arrays are float32, contiguous and flat; indices are
the caller's to keep inside.

Importing this module imports numba.
"""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

_LANES = ir.VectorType(ir.FloatType(), 4)
_FAST = ("fast",)
_Value = Any


@intrinsic
def add_two(typingctx, out, place, table, offset, near, far, weight, first):  # type: ignore[no-untyped-def]
    """out[place:+4] += weight[first:+4] * (near * table[offset:+4] + far * table[offset+4:+4])."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        load, store, splat = _tools(context, builder, signature, args)
        step = args[3].type(4)
        here, next_one = load(2, args[3]), load(2, builder.add(args[3], step))
        light = _sum(builder, [(splat(args[4]), here), (splat(args[5]), next_one)])
        total = _sum(builder, [(load(6, args[7]), light)], load(0, args[1]))
        store(0, args[1], total)
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    return types.void(out, index, table, index, real, real, weight, index), codegen


@intrinsic
def add_four(typingctx, out, place, table, offset, across, w00, w01, w10, w11):  # type: ignore[no-untyped-def]
    """out[place:+4] += bilinear blend of table at offset, offset + 4, offset + across, and both."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        load, store, splat = _tools(context, builder, signature, args)
        step, far = args[3].type(4), builder.add(args[3], args[4])
        corners = [args[3], builder.add(args[3], step), far, builder.add(far, step)]
        products = [
            (splat(weight), load(2, corner))
            for weight, corner in zip(args[5:], corners, strict=True)
        ]
        store(0, args[1], _sum(builder, products, load(0, args[1])))
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    return types.void(out, index, table, index, index, real, real, real, real), codegen


def _tools(
    context: _Value, builder: _Value, signature: _Value, args: _Value
) -> tuple[Callable[..., _Value], Callable[..., None], Callable[..., _Value]]:
    """How to load and store four lanes of an argument that is an array, and to fill four."""

    def pointer(argument: int, index: _Value) -> _Value:
        array = context.make_array(signature.args[argument])(context, builder, args[argument])
        return builder.bitcast(builder.gep(array.data, [index]), _LANES.as_pointer())

    def load(argument: int, index: _Value) -> _Value:
        return builder.load(pointer(argument, index), align=4)

    def store(argument: int, index: _Value, value: _Value) -> None:
        builder.store(value, pointer(argument, index), align=4)

    def splat(scalar: _Value) -> _Value:
        undefined = ir.Constant(_LANES, ir.Undefined)
        first = builder.insert_element(undefined, scalar, ir.IntType(32)(0))
        mask = ir.Constant(ir.VectorType(ir.IntType(32), 4), [0, 0, 0, 0])
        return builder.shuffle_vector(first, undefined, mask)

    return load, store, splat


def _sum(builder: _Value, products: list[tuple[_Value, _Value]], start: _Value = None) -> _Value:
    total = start
    for factor, value in products:
        product = builder.fmul(factor, value, flags=_FAST)
        total = product if total is None else builder.fadd(total, product, flags=_FAST)
    return total
