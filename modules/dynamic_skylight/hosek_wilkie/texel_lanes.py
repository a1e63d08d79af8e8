"""Four texels at once from the two tables of a sky, in the processor's vectors.

A texel's colours lie side by side in the tables, so that one load brings a coefficient of all
three. numba has no vectors: these are written in LLVM's own terms. Where the processor's are
narrower LLVM takes several; each lane is rounded by itself, so that no digit depends on it.
"""

from typing import Any

import numpy as np

from vrut_lite.lazy import lazy
from vrut_lite.njit import cgutils, intrinsic, types

ir = lazy("llvmlite.ir")
TEXELS = 4
LARGEST_HALF = 65504.0
# In bits of a float32: half an ulp of a half, less one; bits that a half lacks.
_ROUND, _SHIFT = 0x0FFF, 13
# Brings the exponent's bias of a float32 to that of a half, and subnormal numbers to subnormal.
_REBIAS = 2.0**-112
# 2^f for |f| <= 1/2, constant first; errs by 3e-6, a thousandth of a tone.
_EXP2 = np.polynomial.Chebyshev.interpolate(np.exp2, 4, domain=[-0.5, 0.5]).convert(
    kind=np.polynomial.Polynomial
)
_LARGEST_EXPONENT, _LARGEST_BYTE = 100.0, 255.0
_ROUNDER, _MANTISSA_BITS = 1.5 * 2**23, 23


@intrinsic
def look_up_zenith(  # type: ignore[no-untyped-def]
    _context, factors, terms, table, first, share, texel, twin
):
    """Writes Z to `factors` and Z H sqrt(cos theta) to `terms` (4 n,), for a texel and its twin.

    `first` and `share` as `zenith_place` returns them for the flat `table`.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        found = lanes.quadratic(
            [lanes.load(2, arguments[3], 8 * power, 8) for power in range(3)],
            lanes.spread(arguments[4], 8),
        )
        for output in (0, 1):
            half = lanes.part(found, range(4 * output, 4 * output + 4))
            for place in arguments[5:]:
                lanes.store(half, output, builder.mul(place, place.type(4)))
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    return types.void(factors, terms, table, index, real, index, index), build


@intrinsic
def shade_texels(  # type: ignore[no-untyped-def]
    _context, out, place, table, first, share, texel, factors, terms
):
    """Writes out[place:+12], the sky of four texels from `texel` on; out[place + 12] may be spoilt.

    `first` (n,) and `share` (n,) are the texels' places in the flat glow `table`; `factors` and
    `terms` (4 n,) are those of `look_up_zenith`. Radiance below 0 becomes 0. `out` is float32;
    uint16, bits of the nearest half, ties to even; or uint8, 255 (1 - 2^-x) of a radiance x.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        pairs = [_light_of_pair(builder, lanes, arguments[5], pair) for pair in (0, 2)]
        kind = signature.args[0].dtype
        if kind == types.float32:
            # Each store's pad is overwritten by the next.
            for k in range(TEXELS):
                part = lanes.part(pairs[k // 2], range(4 * (k % 2), 4 * (k % 2) + 4))
                lanes.store(part, 0, builder.add(arguments[1], arguments[1].type(3 * k)))
        else:
            encode = lanes.halves if kind == types.uint16 else lanes.bytes
            colours = [4 * k + c for k in range(TEXELS) for c in range(3)]
            lanes.store(lanes.part(encode(lanes.joined(*pairs)), colours), 0, arguments[1])
        return context.get_dummy_value()

    index = types.uintp
    return types.void(out, index, table, first, share, index, factors, terms), build


def _light_of_pair(builder: Any, lanes: Any, texel: Any, pair: int) -> Any:
    """Radiance of two texels, a pad after each."""
    size = texel.type
    texel = builder.add(texel, size(pair))
    at = [texel, builder.add(texel, size(1))]
    places = [builder.zext(lanes.number(3, k), size) for k in at]
    shares = lanes.joined(*[lanes.spread(lanes.number(4, k), 4) for k in at])
    powers = [lanes.joined(*[lanes.load(2, k, 4 * power, 4) for k in places]) for power in range(3)]
    column = builder.mul(texel, size(4))
    factor, term = (lanes.load(argument, column, 0, 8) for argument in (6, 7))
    light = lanes.sum_of_product(lanes.quadratic(powers, shares), factor, term)
    return lanes.larger(light, 0.0)


class _Lanes:
    """Writes instructions on vectors of single precision."""

    def __init__(self, context: Any, builder: Any, signature: Any, arguments: Any):
        self._builder = builder
        self._data = [
            context.make_array(kind)(context, builder, value).data
            if isinstance(kind, types.Array)
            else None
            for kind, value in zip(signature.args, arguments, strict=True)
        ]

    def number(self, argument: int, index: Any) -> Any:
        return self._builder.load(self._builder.gep(self._data[argument], [index]))

    def load(self, argument: int, index: Any, offset: int, count: int) -> Any:
        place = self._builder.add(index, index.type(offset))
        pointer = self._builder.gep(self._data[argument], [place])
        kind = ir.VectorType(ir.FloatType(), count)
        return self._builder.load(self._builder.bitcast(pointer, kind.as_pointer()), align=4)

    def store(self, vector: Any, argument: int, index: Any) -> None:
        pointer = self._builder.gep(self._data[argument], [index])
        pointer = self._builder.bitcast(pointer, vector.type.as_pointer())
        self._builder.store(vector, pointer, align=1)

    def part(self, vector: Any, lanes: Any) -> Any:
        undefined = ir.Constant(vector.type, ir.Undefined)
        return self._builder.shuffle_vector(vector, undefined, _integers(lanes))

    def joined(self, first: Any, second: Any) -> Any:
        return self._builder.shuffle_vector(first, second, _integers(range(2 * first.type.count)))

    def spread(self, number: Any, count: int) -> Any:
        undefined = ir.Constant(ir.VectorType(ir.FloatType(), count), ir.Undefined)
        one = self._builder.insert_element(undefined, number, ir.IntType(32)(0))
        return self.part(one, [0] * count)

    def sum_of_product(self, first: Any, second: Any, third: Any) -> Any:
        """Rounded once where the processor can: alike in every format, unlike a loose product."""
        kind = first.type
        function = cgutils.get_or_insert_function(
            self._builder.module,
            ir.FunctionType(kind, [kind] * 3),
            f"llvm.fmuladd.v{kind.count}f32",
        )
        return self._builder.call(function, [first, second, third])

    def quadratic(self, powers: list[Any], share: Any) -> Any:
        constant, linear, square = powers
        return self.sum_of_product(share, self.sum_of_product(share, square, linear), constant)

    def larger(self, vector: Any, least: float) -> Any:
        bound = _floats(vector, least)
        return self._builder.select(self._builder.fcmp_ordered(">", vector, bound), vector, bound)

    def smaller(self, vector: Any, most: float) -> Any:
        bound = _floats(vector, most)
        return self._builder.select(self._builder.fcmp_ordered("<", vector, bound), vector, bound)

    def halves(self, vector: Any) -> Any:
        """Bits of the nearest half: integers alone, as not every processor has halves."""
        builder = self._builder
        scaled = builder.fmul(self.smaller(vector, LARGEST_HALF), _floats(vector, _REBIAS))
        bits = _as_integers(builder, scaled)
        count = vector.type.count
        shift = _integers([_SHIFT] * count)
        odd = builder.and_(builder.lshr(bits, shift), _integers([1] * count))
        bits = builder.add(builder.add(bits, _integers([_ROUND] * count)), odd)
        return builder.trunc(builder.lshr(bits, shift), ir.VectorType(ir.IntType(16), count))

    def bytes(self, vector: Any) -> Any:
        """255 (1 - 2^-x), rounded; adding 1.5 * 2^23 rounds to an integer in the low bits."""
        builder, count = self._builder, vector.type.count
        x = self.smaller(vector, _LARGEST_EXPONENT)
        rounder = _floats(vector, _ROUNDER)
        shifted = builder.fsub(rounder, x)
        part = builder.fsub(builder.fsub(rounder, shifted), x)
        power = _floats(vector, _EXP2.coef[-1])
        for coefficient in _EXP2.coef[-2::-1]:
            power = self.sum_of_product(power, part, _floats(vector, coefficient))
        exponent = builder.shl(_as_integers(builder, shifted), _integers([_MANTISSA_BITS] * count))
        power = builder.add(_as_integers(builder, power), exponent)
        power = builder.bitcast(power, vector.type)
        tone = self.sum_of_product(
            _floats(vector, -_LARGEST_BYTE), power, _floats(vector, _LARGEST_BYTE + 0.5)
        )
        whole = builder.fptosi(tone, ir.VectorType(ir.IntType(32), count))
        return builder.trunc(whole, ir.VectorType(ir.IntType(8), count))


def _integers(values: Any) -> Any:
    numbers = [ir.IntType(32)(value) for value in values]
    return ir.Constant(ir.VectorType(ir.IntType(32), len(numbers)), numbers)


def _floats(like: Any, value: float) -> Any:
    return ir.Constant(like.type, [float(np.float32(value))] * like.type.count)


def _as_integers(builder: Any, vector: Any) -> Any:
    return builder.bitcast(vector, ir.VectorType(ir.IntType(32), vector.type.count))
