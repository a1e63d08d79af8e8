"""Eight boxes or triangles at once against one ray, in the processor's vectors.

numba has no vectors, and LLVM finds none in a loop that ends in a choice: here they are written in
LLVM's own terms. Where vectors are narrower LLVM takes several. Each lane is rounded by itself, so
that the result does not depend on their width.
"""

from typing import Any

import numpy as np
from llvmlite import ir

from vrut_lite.njit import intrinsic, types

LANES = 8
# Barycentric margin beyond edges, so that no ray slips between two neighbouring triangles.
_BEYOND = float(np.float32(2e-6))
_ONE_AND_BEYOND = float(np.float32(1.0) + np.float32(2e-6))
_VECTOR = ir.VectorType(ir.FloatType(), LANES)
_INDEX = ir.IntType(64)
# A product and its sum may be rounded once.
_ROUNDED_ONCE = ("contract",)


@intrinsic
def lowest(typing: Any, bits: Any) -> Any:
    """The number of the lowest bit that is set; some bit is."""

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        found = builder.cttz(arguments[0], ir.Constant(ir.IntType(1), 1))
        return builder.zext(found, _INDEX)

    return types.int64(types.int32), build


@intrinsic
def boxes_entered(
    typing: Any, boxes: Any, node: Any, nears: Any, at: Any, ray: Any, far: Any
) -> Any:
    """Bits of the boxes (K, 6, LANES) of a node that a ray enters before `far`.

    Fills in the distances from place `at` of `nears` on. `ray`: three numbers each of its origin
    and of the inverse of its direction.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        numbers = lanes.numbers(4)
        end, near = lanes.spread(arguments[5]), lanes.constant(0.0)
        for axis in range(3):
            origin, inverse = lanes.spread(numbers[axis]), lanes.spread(numbers[3 + axis])
            lower, upper = (lanes.row(0, 1, 6, axis + edge) for edge in (0, 3))
            backwards = builder.fcmp_ordered("<", inverse, lanes.constant(0.0))
            first = builder.select(backwards, upper, lower)
            last = builder.select(backwards, lower, upper)
            first = lanes.product(lanes.difference(first, origin), inverse)
            last = lanes.product(lanes.difference(last, origin), inverse)
            near = builder.select(builder.fcmp_ordered(">", first, near), first, near)
            end = builder.select(builder.fcmp_ordered("<", last, end), last, end)
        lanes.store(near, 2, arguments[3], 0)
        return lanes.bits(builder.fcmp_ordered("<=", near, end))

    return types.int32(boxes, types.int64, nears, types.int64, ray, types.float32), build


@intrinsic
def triangles_crossed(
    typing: Any, blocks: Any, block: Any, found: Any, at: Any, ray: Any, far: Any
) -> Any:
    """Bits of the triangles of a block that a ray meets before `far` (Moeller and Trumbore 1997).

    `blocks` (B, 9, LANES): a corner and the two edges that begin there. Fills in distances, then
    barycentric u, then v, LANES each, from place `at` of `found` on. `ray`: three numbers each of
    its origin and direction.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        numbers = [lanes.spread(number) for number in lanes.numbers(4)]
        origin, direction = numbers[:3], numbers[3:]
        rows = [lanes.row(0, 1, 9, row) for row in range(9)]
        corner, edge, other = rows[:3], rows[3:6], rows[6:]
        p = lanes.cross(direction, other)
        # Where it is 0 what follows is no number, and compares as missed.
        inverse = builder.fdiv(lanes.constant(1.0), lanes.dot(edge, p))
        s = [lanes.difference(a, b) for a, b in zip(origin, corner, strict=True)]
        q = lanes.cross(s, edge)
        distance, u, v = (
            lanes.product(lanes.dot(a, b), inverse) for a, b in ((other, q), (s, p), (direction, q))
        )
        least, most = lanes.constant(-_BEYOND), lanes.constant(_ONE_AND_BEYOND)
        crossed = builder.fcmp_ordered("<=", least, u)
        for lower, sign, upper in (
            (least, "<=", v),
            (builder.fadd(u, v), "<=", most),
            (lanes.constant(0.0), "<", distance),
            (distance, "<", lanes.spread(arguments[5])),
        ):
            crossed = builder.and_(crossed, builder.fcmp_ordered(sign, lower, upper))
        for number, values in enumerate((distance, u, v)):
            lanes.store(values, 2, arguments[3], LANES * number)
        return lanes.bits(crossed)

    return types.int32(blocks, types.int64, found, types.int64, ray, types.float32), build


class _Lanes:
    """Writes instructions on LANES numbers of single precision."""

    def __init__(self, context: Any, builder: Any, signature: Any, arguments: Any):
        self._context, self._builder = context, builder
        self._types, self._arguments = signature.args, arguments

    def numbers(self, argument: int) -> list[Any]:
        """The members of an argument that is a tuple."""
        whole = self._arguments[argument]
        count = self._types[argument].count
        return [self._builder.extract_value(whole, number) for number in range(count)]

    def constant(self, number: float) -> Any:
        """It in all lanes."""
        return ir.Constant(_VECTOR, [number] * LANES)

    def spread(self, number: Any) -> Any:
        """It in all lanes."""
        one = self._builder.insert_element(
            ir.Constant(_VECTOR, ir.Undefined), number, ir.IntType(32)(0)
        )
        everywhere = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
        return self._builder.shuffle_vector(one, ir.Constant(_VECTOR, ir.Undefined), everywhere)

    def row(self, array: int, index: int, rows: int, row: int) -> Any:
        """A row (LANES) of an array (N, rows, LANES), which lies in one piece."""
        first = self._builder.mul(self._arguments[index], _INDEX(rows * LANES))
        place = self._builder.add(first, _INDEX(row * LANES))
        loaded = self._builder.load(self._place(array, place))
        loaded.align = 4
        return loaded

    def store(self, values: Any, array: int, at: Any, beyond: int) -> None:
        """Write lanes so far `beyond` a place of an array."""
        place = self._place(array, self._builder.add(at, _INDEX(beyond)))
        self._builder.store(values, place).align = 4

    def _place(self, array: int, place: Any) -> Any:
        struct = self._context.make_array(self._types[array])
        data = struct(self._context, self._builder, self._arguments[array]).data
        return self._builder.bitcast(self._builder.gep(data, [place]), _VECTOR.as_pointer())

    def bits(self, lanes: Any) -> Any:
        """A bit for each lane."""
        packed = self._builder.bitcast(lanes, ir.IntType(LANES))
        return self._builder.zext(packed, ir.IntType(32))

    def product(self, a: Any, b: Any) -> Any:
        """a b."""
        return self._builder.fmul(a, b, flags=_ROUNDED_ONCE)

    def difference(self, a: Any, b: Any) -> Any:
        """a - b."""
        return self._builder.fsub(a, b, flags=_ROUNDED_ONCE)

    def dot(self, a: list[Any], b: list[Any]) -> Any:
        """The product of two vectors of three."""
        x, y, z = (self.product(p, q) for p, q in zip(a, b, strict=True))
        both = self._builder.fadd(x, y, flags=_ROUNDED_ONCE)
        return self._builder.fadd(both, z, flags=_ROUNDED_ONCE)

    def cross(self, a: list[Any], b: list[Any]) -> list[Any]:
        """The vector product of two vectors of three."""
        return [
            self.difference(
                self.product(a[(k + 1) % 3], b[(k + 2) % 3]),
                self.product(a[(k + 2) % 3], b[(k + 1) % 3]),
            )
            for k in range(3)
        ]
