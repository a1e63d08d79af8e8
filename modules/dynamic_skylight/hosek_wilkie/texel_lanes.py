"""Texels of a row from the two tables of a sky, in the processor's vectors.

A single texel takes its piece of a table, the colours side by side. Eight neighbours of a large map
take one piece together: a lane is then a texel, its colours are three vectors, and each coefficient
is loaded once for all eight. numba has no vectors: these are written in LLVM's own terms. Where
the processor's are narrower LLVM takes several; each lane is rounded by itself, so that no digit
depends on it.
"""

from typing import Any

import numpy as np

from dynamic_skylight.hosek_wilkie.sky_tables import (
    COEFFICIENT,
    GLOW_DEGREE,
    GLOW_PER_UNIT,
    GLOW_REACH,
    ZENITH_DEGREE,
    ZENITH_PER_UNIT,
    ZENITH_REACH,
)
from vrut_lite.lazy import lazy
from vrut_lite.njit import cgutils, intrinsic, types

ir = lazy("llvmlite.ir")
# Texels of a block, which takes one piece of a table.
BLOCK = 8
LARGEST_HALF = 65504.0
# Bits of a float32 that are its exponent, and how many of its mantissa a half lacks.
_EXPONENT, _SHIFT = 0x7F800000, 13
# Halves below are subnormal, and have its steps.
_LEAST_NORMAL_HALF = 2.0**-14
# Times a number's power of two, in steps of halves there: the sum with the number is rounded to
# such steps, and in its lowest 16 bits are the half's mantissa and 2^14, which turns the bias of
# the exponent, in these bits, into that of a half.
_STEPS = (2.0**23 + 2**14 - 2**10) / 2**10
# 255 (1 - 2^-x) is 255 as a byte from here on.
_WHITE, _LARGEST_BYTE = 9.25, 255.0
# 2^-x up to `_WHITE` is (((q^2 + a)^2 + b)^2 + c)^2 with a quadratic q: its coefficients, the
# square's first, then a, b and c, by least squares, reweighted until the largest error, 5e-5 of a
# tone, is least. A product each: polynomials of this accuracy need two more.
_QUADRATIC = (0.00123195, -0.04857128, 0.7061016)
_OFFSETS = (0.76218732, -0.58763826, -0.00379297)
# Floats from here on are whole.
_WHOLE = 2.0**23


@intrinsic
def zenith_of_texel(_context, factors, table, piece, x, texel, twin):  # type: ignore[no-untyped-def]
    """Writes Z to factors[4 texel:+3] and to that of its twin; `zenith_piece` finds `piece`."""

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        piece, x = arguments[2:4]
        found = lanes.polynomial(1, piece, lanes.spread(x, COEFFICIENT), ZENITH_DEGREE)
        for texel in arguments[4:]:
            lanes.store(found, 0, builder.mul(texel, texel.type(COEFFICIENT)))
        return context.get_dummy_value()

    index = types.uintp
    return types.void(factors, table, index, types.float32, index, index), build


@intrinsic
def light_of_texel(  # type: ignore[no-untyped-def]
    _context, light, table, piece, x, factors, root, levels, texel
):
    """Writes Z (S + H sqrt(cos theta)), 0 where it is negative, to light[3 texel:+3].

    It spoils one more number.

    `glow_piece` finds `piece` and `x`; `root` is that of the cosine, `levels` (4,) H.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        piece, x, _, root, _, texel = arguments[2:]
        glow = lanes.polynomial(1, piece, lanes.spread(x, COEFFICIENT), GLOW_DEGREE)
        level = lanes.load(6, texel.type(0), 0, COEFFICIENT)
        both = lanes.sum_of_product(level, lanes.spread(root, COEFFICIENT), glow)
        factor = lanes.load(4, builder.mul(texel, texel.type(COEFFICIENT)), 0, COEFFICIENT)
        found = lanes.larger(builder.fmul(both, factor), 0.0)
        lanes.store(found, 0, builder.mul(texel, texel.type(3)))
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    return types.void(light, table, index, real, factors, real, levels, index), build


@intrinsic
def encode_numbers(_context, out, place, light, first):  # type: ignore[no-untyped-def]
    """Writes out[place:+16], `light` from `first` on, which is not negative.

    `out` is float32; uint16, bits of the nearest half, ties to even; or uint8, 255 (1 - 2^-x) of
    a radiance x.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        found = lanes.encoded(lanes.load(2, arguments[3], 0, 2 * BLOCK), signature.args[0].dtype)
        lanes.store(found, 0, arguments[1])
        return context.get_dummy_value()

    return types.void(out, types.uintp, light, types.uintp), build


@intrinsic
def zenith_of_blocks(  # type: ignore[no-untyped-def]
    _context, factors, stride, table, roots, inverse, piece, start, texel, twin
):
    """Writes Z of eight texels from `texel` on of a row of a large map, in reverse from `twin` on.

    The colours of `factors` lie `stride` numbers apart. Roots of the cosines and inverse lengths
    are known from `texel` on and written from `twin` on. The texels' piece of the flat `table`
    begins at `piece`; it starts at `start`.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        stride = arguments[1]
        piece, start, texel, twin = arguments[5:]
        root = lanes.load(3, texel, 0, BLOCK)
        lanes.store(lanes.reversed(root), 3, twin)
        lanes.store(lanes.reversed(lanes.load(4, texel, 0, BLOCK)), 4, twin)
        x = lanes.within(root, start, ZENITH_PER_UNIT / ZENITH_REACH)
        for colour in range(3):
            found = lanes.polynomial(2, piece, x, ZENITH_DEGREE, colour)
            lanes.store(found, 0, texel)
            lanes.store(lanes.reversed(found), 0, twin)
            texel, twin = builder.add(texel, stride), builder.add(twin, stride)
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    kinds = factors, index, table, roots, inverse, index, real, index, index
    return types.void(*kinds), build


@intrinsic
def place_block(  # type: ignore[no-untyped-def]
    _context, places, place, start, sign, across, inverse, texel, height, sun
):
    """Writes places[place:+8], of eight texels from `texel` on in their piece of the glow's table.

    Directions are (across (n,), 1, height) times `inverse` (n,); `sun` (3,) is in their axes.
    Chords are those to the sun or, with a `sign` of -1, to the point opposite; the piece starts
    at `start`.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        place, start, sign, _, _, texel, height, sun = arguments[1:]
        outwards = builder.fmul(lanes.load(5, texel, 0, BLOCK), lanes.spread(sign, BLOCK))
        minus = [
            lanes.spread(builder.fsub(height.type(-0.0), each), BLOCK)
            for each in cgutils.unpack_tuple(builder, sun)
        ]
        dx = lanes.sum_of_product(lanes.load(4, texel, 0, BLOCK), outwards, minus[0])
        dy = builder.fadd(outwards, minus[1])
        dz = lanes.sum_of_product(lanes.spread(height, BLOCK), outwards, minus[2])
        squared = lanes.sum_of_product(dx, dx, builder.fmul(dy, dy))
        chord = lanes.root(lanes.sum_of_product(dz, dz, squared))
        lanes.store(lanes.within(chord, start, GLOW_PER_UNIT / GLOW_REACH), 0, place)
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    return types.void(places, index, real, real, across, inverse, index, real, sun), build


@intrinsic
def light_of_block(  # type: ignore[no-untyped-def]
    _context, out, texel, table, piece, places, place, factors, stride, roots, levels
):
    """Writes out[3 texel:+24], eight texels of a row of a large map, as `encode_numbers` does.

    The light is Z (S + H sqrt(cos theta)), 0 where it is negative. The texels' piece begins at
    `piece` of the flat `table`, their places in it at places[place]. `factors` are those of
    `zenith_of_blocks`, `roots` (n,) those of the cosines, `levels` (4,) H.
    """

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        lanes = _Lanes(context, builder, signature, arguments)
        texel, _, piece, _, place, _, stride = arguments[1:8]
        x = lanes.load(4, place, 0, BLOCK)
        root = lanes.load(8, texel, 0, BLOCK)
        colours, column = [], texel
        for colour in range(3):
            glow = lanes.polynomial(2, piece, x, GLOW_DEGREE, colour)
            level = lanes.spread(lanes.number(9, texel.type(colour)), BLOCK)
            both = lanes.sum_of_product(level, root, glow)
            factor = lanes.load(6, column, 0, BLOCK)
            colours.append(lanes.larger(builder.fmul(both, factor), 0.0))
            column = builder.add(column, stride)
        place = builder.mul(texel, texel.type(3))
        for k, part in enumerate(lanes.interleaved(*colours)):
            found = lanes.encoded(part, signature.args[0].dtype)
            lanes.store(found, 0, builder.add(place, place.type(BLOCK * k)))
        return context.get_dummy_value()

    index = types.uintp
    kinds = out, index, table, index, places, index, factors, index, roots, levels
    return types.void(*kinds), build


def has_halves(context: Any) -> bool:
    """Whether the processor that is compiled for rounds to halves."""
    return "+f16c" in context.codegen().magic_tuple()[2].split(",")


class _Lanes:
    """Writes instructions on vectors of single precision."""

    def __init__(self, context: Any, builder: Any, signature: Any, arguments: Any):
        self._builder = builder
        self._has_halves = has_halves(context)
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

    def root(self, vector: Any) -> Any:
        kind = vector.type
        function = cgutils.get_or_insert_function(
            self._builder.module, ir.FunctionType(kind, [kind]), f"llvm.sqrt.v{kind.count}f32"
        )
        return self._builder.call(function, [vector])

    def within(self, vector: Any, start: Any, scale: float) -> Any:
        """Places in a piece, -1 to 1: `scale` times `vector`, and the piece's start."""
        start = self.spread(start, vector.type.count)
        return self.sum_of_product(vector, _floats(vector, scale), start)

    def reversed(self, vector: Any) -> Any:
        return self.part(vector, range(vector.type.count)[::-1])

    def polynomial(
        self, argument: int, first: Any, x: Any, degree: int, colour: int | None = None
    ) -> Any:
        """The piece of a table that begins at `first`: one colour a lane, or `colour` in all."""
        found = None
        for power in range(degree, -1, -1):
            if colour is None:
                loaded = self.load(argument, first, COEFFICIENT * power, x.type.count)
            else:
                at = self._builder.add(first, first.type(COEFFICIENT * power + colour))
                loaded = self.spread(self.number(argument, at), x.type.count)
            found = loaded if found is None else self.sum_of_product(found, x, loaded)
        return found

    def interleaved(self, red: Any, green: Any, blue: Any) -> list[Any]:
        """Three vectors of the colours of texels side by side."""
        count = red.type.count
        found = []
        for k in range(3):
            lanes = range(count * k, count * (k + 1))
            two = [lane // 3 + (count if lane % 3 == 1 else 0) for lane in lanes]
            three = [count + lane // 3 if lane % 3 == 2 else lane - count * k for lane in lanes]
            both = self._builder.shuffle_vector(red, green, _integers(two))
            found.append(self._builder.shuffle_vector(both, blue, _integers(three)))
        return found

    def encoded(self, light: Any, kind: Any) -> Any:
        """`light` in the numbers of `kind`."""
        if kind == types.float32:
            return light
        return self.halves(light) if kind == types.uint16 else self.bytes(light)

    def larger(self, vector: Any, least: float) -> Any:
        bound = _floats(vector, least)
        return self._builder.select(self._builder.fcmp_ordered(">", vector, bound), vector, bound)

    def smaller(self, vector: Any, most: float) -> Any:
        bound = _floats(vector, most)
        return self._builder.select(self._builder.fcmp_ordered("<", vector, bound), vector, bound)

    def halves(self, vector: Any) -> Any:
        """Bits of the nearest half, ties to even: by integers where the processor has no halves."""
        builder, count = self._builder, vector.type.count
        words = ir.VectorType(ir.IntType(16), count)
        clipped = self.smaller(vector, LARGEST_HALF)
        if self._has_halves:
            halves = builder.fptrunc(clipped, ir.VectorType(ir.HalfType(), count))
            return builder.bitcast(halves, words)
        bits = builder.and_(_as_integers(builder, clipped), _integers([_EXPONENT] * count))
        power = self.larger(builder.bitcast(bits, vector.type), _LEAST_NORMAL_HALF)
        rounded = self.sum_of_product(power, _floats(vector, _STEPS), clipped)
        exponent = builder.lshr(_as_integers(builder, power), _integers([_SHIFT] * count))
        return builder.trunc(builder.add(exponent, _as_integers(builder, rounded)), words)

    def bytes(self, vector: Any) -> Any:
        """255 (1 - 2^-x), rounded; a sum with 2^23 is an integer, which its low bits hold."""
        x, scale = self.smaller(vector, _WHITE), _LARGEST_BYTE ** (1 / 16)
        square, slope, constant = (_floats(vector, scale * number) for number in _QUADRATIC)
        root = self.sum_of_product(self.sum_of_product(x, square, slope), x, constant)
        for number in _OFFSETS:
            scale *= scale
            root = self.sum_of_product(root, root, _floats(vector, scale * number))
        minus = self._builder.fsub(_floats(vector, -0.0), root)
        tone = self.sum_of_product(minus, root, _floats(vector, _LARGEST_BYTE + _WHOLE))
        bits = _as_integers(self._builder, tone)
        return self._builder.trunc(bits, ir.VectorType(ir.IntType(8), vector.type.count))


def _integers(values: Any) -> Any:
    numbers = [ir.IntType(32)(value) for value in values]
    return ir.Constant(ir.VectorType(ir.IntType(32), len(numbers)), numbers)


def _floats(like: Any, value: float) -> Any:
    return ir.Constant(like.type, [float(np.float32(value))] * like.type.count)


def _as_integers(builder: Any, vector: Any) -> Any:
    return builder.bitcast(vector, ir.VectorType(ir.IntType(32), vector.type.count))
