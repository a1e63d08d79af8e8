"""A node of a sky-view table as one SIMD register of eight lanes.

numba leaves LLVM's vectorisation of straight-line code off (see `solver.four_lanes`); the
look-up of a texel is straight-line code on a node's eight numbers, and is said to LLVM directly.

Importing this module imports numba.
"""

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

_FLOAT, _INT = ir.FloatType(), ir.IntType(32)
_NODE = ir.VectorType(_FLOAT, 8)
# Sums keep their order, so that every vector width gives the same digits.
_FLAGS = ("nnan", "ninf", "nsz", "contract")
_Value = Any


@intrinsic
def shade_texel(typingctx, out, place, mie_phase, nodes, near, far, across, along):  # type: ignore[no-untyped-def]
    """out[place:+3] = the radiance between four nodes of fourth roots.

    `nodes` is flat; the nodes are those that begin at `near`, `near` + 8, `far` and `far` + 8,
    `across` the share of the second of each pair, `along` that of the second pair. The first four
    numbers of a node are light with its phase, the others aerosol's, to be multiplied by
    `mie_phase`. Indices are the caller's to keep inside.
    """

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        def pointer(argument: int, index: _Value) -> _Value:
            array = context.make_array(signature.args[argument])(context, builder, args[argument])
            return builder.gep(array.data, [index])

        def node(index: _Value) -> _Value:
            return builder.load(builder.bitcast(pointer(3, index), _NODE.as_pointer()), align=4)

        def between(first: _Value, second: _Value, share: _Value) -> _Value:
            change = builder.fsub(second, first, flags=_FLAGS)
            return builder.fadd(first, builder.fmul(share, change, flags=_FLAGS), flags=_FLAGS)

        next_node = args[4].type(8)
        share = _splat(builder, args[6])
        rows = [between(node(at), node(builder.add(at, next_node)), share) for at in args[4:6]]
        light = between(*rows, _splat(builder, args[7]))
        for _ in range(2):
            light = builder.fmul(light, light, flags=_FLAGS)
        for lane in range(3):
            phased, aerosol = (builder.extract_element(light, _INT(k)) for k in (lane, lane + 4))
            aerosol = builder.fmul(args[2], aerosol, flags=_FLAGS)
            total = builder.fadd(phased, aerosol, flags=_FLAGS)
            builder.store(total, pointer(0, builder.add(args[1], args[1].type(lane))))
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    return types.void(out, index, real, nodes, index, index, real, real), codegen


def _splat(builder: _Value, scalar: _Value) -> _Value:
    undefined = ir.Constant(_NODE, ir.Undefined)
    first = builder.insert_element(undefined, scalar, _INT(0))
    return builder.shuffle_vector(
        first, undefined, ir.Constant(ir.VectorType(_INT, 8), [_INT(0)] * 8)
    )
