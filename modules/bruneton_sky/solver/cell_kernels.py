"""Cells: the suns for which a ray is computed, all at once.

A cell is one sun as seen from a ray: its zenith cosine mu_s at the ray's start, and the cosine
nu of the angle between them, which stays the same along the ray. Cells come in long arrays, so
that the compiler works on sixteen at a time: a first pass finds the place of each in a table, a
second adds the values there.

The second pass takes the four wavelengths of a cell as one SIMD register. numba leaves LLVM's
vectorisation of straight-line code off, and a loop over four lanes is too short for its loop
vectoriser: `add_two` and `add_four` say it to LLVM directly. Their arrays are float32, contiguous
and flat; their callers keep indices inside.

Importing this module imports numba.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numpy.typing import NDArray

from vrut_lite.njit import SUMS_IN_ORDER, cgutils, intrinsic, njit, types

_OPTIONS: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": SUMS_IN_ORDER}
# For kernels that only kernels call: without the wrappers for Python they compile faster.
_NO_WRAPPERS: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
fast = njit(nogil=True, **_OPTIONS)
# Kernels that make no arrays and return none: their arrays are their caller's, so that none counts
# references. The counters are atomic and took a third of a table's time.
inner = njit(_nrt=False, **_NO_WRAPPERS, **_OPTIONS)
# Kernels that do. An inner kernel must not call them: it would never free what they return.
making = njit(_nrt=True, **_NO_WRAPPERS, **_OPTIONS)
_f4 = np.float32
ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
_LANES = ir.VectorType(ir.FloatType(), 4)
_FLAGS = tuple(sorted(SUMS_IN_ORDER))
_Value = Any


class Cells(NamedTuple):
    """Arrays over cells (n,), float32 but for `offset` and `sun`.

    `mu_s`, `nu`: the suns. The rest is scratch of the passes: `offset` into a table and its node
    `sun`, the shares `along` and `across` of the next nodes, `moved`, by how much squared the sun's
    cosine changes, and `shadow_from`, `shadow_to`, the distances between which the ray lies in the
    planet's shadow.
    """

    mu_s: NDArray[np.float32]
    nu: NDArray[np.float32]
    offset: NDArray[np.int32]
    sun: NDArray[np.int32]
    along: NDArray[np.float32]
    across: NDArray[np.float32]
    moved: NDArray[np.float32]
    shadow_from: NDArray[np.float32]
    shadow_to: NDArray[np.float32]


@making
def empty_cells(count):  # type: ignore[no-untyped-def]
    """Arrays for `count` cells."""
    return Cells(
        np.empty(count, _f4), np.empty(count, _f4), np.empty(count, np.int32),
        np.empty(count, np.int32), np.empty(count, _f4), np.empty(count, _f4),
        np.empty(count, _f4), np.empty(count, _f4), np.empty(count, _f4),
    )  # fmt: skip


@making
def some_cells(cells, start, stop):  # type: ignore[no-untyped-def]
    """The cells from `start` to before `stop`."""
    return Cells(
        cells.mu_s[start:stop], cells.nu[start:stop], cells.offset[start:stop],
        cells.sun[start:stop], cells.along[start:stop], cells.across[start:stop],
        cells.moved[start:stop],
        cells.shadow_from[start:stop], cells.shadow_to[start:stop],
    )  # fmt: skip


@inner
def set_suns(cells, mu_s, nu):  # type: ignore[no-untyped-def]
    """Give each cell its cosines to the sun; a loop, which compiles sooner than `[:] =`."""
    for k in range(mu_s.size):
        cells.mu_s[k], cells.nu[k] = mu_s[k], nu[k]


@inner
def fill_cells(mu, sun, turn_cosine, cells):  # type: ignore[no-untyped-def]
    """All suns (n,) at all azimuths from the view, azimuth first, as seen along mu."""
    sine = math.sqrt(max((1.0 - mu) * (1.0 + mu), 0.0))
    for k in range(sun.size):
        across = sine * math.sqrt(max((1.0 - sun[k]) * (1.0 + sun[k]), 0.0))
        for p in range(turn_cosine.size):
            cells.mu_s[p * sun.size + k] = sun[k]
            cells.nu[p * sun.size + k] = mu * sun[k] + across * turn_cosine[p]


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


@intrinsic
def add_weighed(typingctx, out, place, weight, tables, offset, w00, w01, w10, w11):  # type: ignore[no-untyped-def]
    """out[place:+4] += weight[:4] * a blend of four tables (a tuple) at offset:+4."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        kinds = (*signature.args[:3], *signature.args[3], *signature.args[4:])
        tables = cgutils.unpack_tuple(builder, args[3], 4)
        values = [*args[:3], *tables, *args[4:]]
        load, store, splat = _tools(context, builder, types.void(*kinds), values)
        none = args[4].type(0)
        products = [(splat(blend), load(3 + k, args[4])) for k, blend in enumerate(args[5:])]
        light = _sum(builder, products)
        store(0, args[1], _sum(builder, [(load(2, none), light)], load(0, args[1])))
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    return types.void(out, index, weight, tables, index, real, real, real, real), codegen


@intrinsic
def set_polynomial(typingctx, out, place, rows, offset, x):  # type: ignore[no-untyped-def]
    """out[place:+4] = a + x (b + x c), of the numbers of three rows (a tuple) at offset:+4."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        kinds = (*signature.args[:2], *signature.args[2], *signature.args[3:])
        values = [*args[:2], *cgutils.unpack_tuple(builder, args[2], 3), *args[3:]]
        load, store, splat = _tools(context, builder, types.void(*kinds), values)
        power = splat(args[4])
        a, b, c = (load(2 + k, args[3]) for k in range(3))
        store(0, args[1], _sum(builder, [(power, _sum(builder, [(power, c)], b))], a))
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    return types.void(out, index, rows, index, real), codegen


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
        product = builder.fmul(factor, value, flags=_FLAGS)
        total = product if total is None else builder.fadd(total, product, flags=_FLAGS)
    return total
