"""Compiled look-up of a sky-view table for every texel of a cube map, in single precision.

A row of texels is worked in two passes over short buffers: coordinates in the table and in the
phase functions (a loop that vectorises over texels), and the bilinear look-up of a node's eight
numbers, one SIMD register. That is straight-line code, which numba does not vectorise:
`shade_texel` says it to LLVM directly. From above the air the limb may be as thin as a texel: there
the mean of a few samples is taken.

Importing this module imports numba: do it only where the first cube is filled.
"""

import math
from typing import Any

import numpy as np
from llvmlite import ir

from bruneton_sky.sky_view.rays import TURN_INSIDE, TURN_OUTSIDE
from vrut_lite.njit import SUMS_IN_ORDER, intrinsic, njit, types

# Numbers of one node: three of the light with its phase applied and a pad, four bands without.
NODE = 8
_f4 = np.float32
_ZERO, _ONE, _HALF = np.float32(0.0), np.float32(1.0), np.float32(0.5)
_SMALLEST = np.float32(1e-30)
# Samples of a texel in the limb, and a stride that puts no two into one row or column; the same for
# a limb about as thick as a texel.
SAMPLES, STRIDE = 5, 2
THIN_SAMPLES, THIN_STRIDE = 13, 5
# Texels above the horizon up to which the limb is supersampled; a thicker limb is smooth there.
LIMB_TEXELS = 6.0
_OPTIONS: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": SUMS_IN_ORDER,
}
_compiled = njit(**_OPTIONS)
# Faces with the horizon in their middle, whose s axes are level, and the other two.
SIDES, TOP, BOTTOM = (0, 1, 4, 5), 2, 3
# Contents of a row.
SKY, GROUND, DARK = 0, 1, 2
_FLOAT, _INT = ir.FloatType(), ir.IntType(32)
_NODE, _FOUR = ir.VectorType(_FLOAT, 8), ir.VectorType(_FLOAT, 4)
_FLAGS = tuple(sorted(SUMS_IN_ORDER))
_Value = Any


@_compiled
def fill_faces(  # type: ignore[no-untyped-def]
    nodes, shape, horizon, sun, phase, colour, axes, centres, ground, cube
):
    """Fill `cube` (6, n, n, 3) from `nodes` (rows * columns, 8); all float32.

    `shape` is (rows above the horizon, rows below, columns); without rows below, what lies
    below the level is `ground` (3,). `horizon` holds 1 + mu of the ground's horizon and of the
    air's end; `sun` the direction (3,) and its level part's direction (2,); `phase` and
    `colour` are those of `AerosolBands`, flat. `axes` (6, 3, 3): normal, s and t axis of each face.
    """
    size = centres.size
    row, first_node = np.empty(size, dtype=np.int32), np.empty(size, dtype=np.int32)
    columns, turned = np.empty((4, size), dtype=np.int32), np.empty(size, dtype=np.int32)
    across, fraction = np.empty((4, size), _f4), np.empty((3, size), _f4)
    level = np.empty(size, _f4)
    flat_nodes, out = nodes.reshape(-1), cube.reshape(6, size, 3 * size)
    ground_row = np.empty(3 * size, _f4)
    for j in range(size):
        for c in range(3):
            ground_row[3 * j + c] = ground[c]
    for side in range(4):
        face = SIDES[side]
        _place_columns(axes[face], centres, shape[2], sun, columns[side], across[side])
    for i in range(size):
        y = -centres[i]
        kind = _kind_of_row(axes[SIDES[0]], y, centres[i], shape, horizon)
        if kind == SKY:
            _place_rows(centres, y, shape, horizon, row, fraction[0])
        for side in range(4):
            face = SIDES[side]
            if kind == SKY:
                _place_turns(axes[face], centres, y, sun, phase.size, turned, fraction[2])
                for j in range(size):
                    first_node[j] = row[j] + columns[side, j]
                fraction[1, :] = across[side]
                _shade(
                    flat_nodes, shape[2], phase, colour, first_node, turned, fraction,
                    out[face, i],
                )  # fmt: skip
            else:
                _fill_row(out[face, i], ground_row, kind)
    for face in (TOP, BOTTOM):
        for i in range(size):
            kind = _kind_of_row(axes[face], axes[face, 0, 1], centres[i], shape, horizon)
            if kind != SKY:
                _fill_row(out[face, i], ground_row, kind)
                continue
            level[:] = centres[i]
            _place(
                axes[face], centres, level, shape, horizon, sun, phase.size,
                first_node, turned, fraction,
            )  # fmt: skip
            _shade(flat_nodes, shape[2], phase, colour, first_node, turned, fraction, out[face, i])
    if horizon[1] <= _ONE:
        _refine_limb(flat_nodes, shape, horizon, sun, phase, colour, axes, centres, cube)


@_compiled
def _kind_of_row(axes, y, t, shape, horizon):  # type: ignore[no-untyped-def]
    """Contents of a row of a face whose directions have the height y."""
    if shape[1] == 0 and y < _ZERO:
        return GROUND
    # An observer above the air sees no light above the air's edge. A row looks down most steeply in
    # its middle.
    return DARK if horizon[1] <= _ONE and _depth(axes, _ZERO, t) >= horizon[1] else SKY


@_compiled
def _fill_row(out, ground, kind):  # type: ignore[no-untyped-def]
    """A row (3 n,) of ground, or of no light."""
    for n in range(out.size):
        out[n] = ground[n] if kind == GROUND else _ZERO


@_compiled
def _refine_limb(  # type: ignore[no-untyped-def]
    nodes, shape, horizon, sun, phase, colour, axes, centres, cube
):
    """Put the mean of some samples into each texel that the limb crosses."""
    size = centres.size
    least, most = _limb_reach(horizon, size)
    thin = horizon[1] - horizon[0] < -_f4(2.0) * least
    samples, stride = (THIN_SAMPLES, THIN_STRIDE) if thin else (SAMPLES, STRIDE)
    s, t = np.empty(samples * size, np.float32), np.empty(samples * size, np.float32)
    first_node = np.empty(s.size, dtype=np.int32)
    fraction, turned = np.empty((3, s.size), dtype=np.float32), np.empty(s.size, np.int32)
    light = np.empty(3 * s.size, np.float32)
    chosen = np.empty(size, np.int64)
    for face in range(6):
        for i in range(size):
            count = _limb_texels(axes[face], centres, centres[i], horizon[0], least, most, chosen)
            if count == 0:
                continue
            for n in range(count):
                for k in range(samples):
                    across, down = 2 * k + 1, 2 * ((stride * k + stride // 2) % samples) + 1
                    offset = _f4(samples * size)
                    s[samples * n + k] = centres[chosen[n]] + _f4(across - samples) / offset
                    t[samples * n + k] = centres[i] + _f4(down - samples) / offset
            few = samples * count
            _place(
                axes[face], s[:few], t[:few], shape, horizon, sun, phase.size,
                first_node[:few], turned[:few], fraction[:, :few],
            )  # fmt: skip
            _shade(
                nodes, shape[2], phase, colour,
                first_node[:few], turned[:few], fraction[:, :few], light,
            )  # fmt: skip
            for n in range(count):
                for c in range(3):
                    total = _ZERO
                    for k in range(samples):
                        total += light[3 * (samples * n + k) + c]
                    cube[face, i, chosen[n], c] = total / _f4(samples)


@_compiled
def _limb_reach(horizon, size):  # type: ignore[no-untyped-def]
    """How 1 + mu of texels that the limb crosses may differ from the horizon's: from, to.

    `size` texels an edge: none reaches farther from its middle than the root of two over it.
    """
    reach = _f4(math.sqrt(2.0) / size)
    sine = _f4(math.sqrt(horizon[0] * (2.0 - horizon[0])))
    near = reach * (sine + reach)
    return -near, min(horizon[1] - horizon[0], _f4(LIMB_TEXELS) * near) + near


@_compiled
def _limb_texels(axes, centres, t, horizon, least, most, chosen):  # type: ignore[no-untyped-def]
    """How many texels of a row the limb crosses, and which: `chosen` (n,)."""
    count = 0
    y = axes[0, 1] + t * axes[2, 1]
    steepest, end = _depth(axes, _ZERO, t) - horizon, _depth(axes, centres[0], t) - horizon
    if y >= 0.0 or steepest >= most or end <= least:
        return count
    for j in range(centres.size):
        height = _depth(axes, centres[j], t) - horizon
        if least < height < most:
            chosen[count] = j
            count += 1
    return count


@_compiled
def _depth(axes, s, t):  # type: ignore[no-untyped-def]
    """1 + mu of a point of a face."""
    x = axes[0, 0] + s * axes[1, 0] + t * axes[2, 0]
    y = axes[0, 1] + s * axes[1, 1] + t * axes[2, 1]
    z = axes[0, 2] + s * axes[1, 2] + t * axes[2, 2]
    level = x * x + z * z
    length = math.sqrt(level + y * y)
    return level / (length * (length - y)) if y < 0 else _ONE + y / length


@_compiled
def _place(  # type: ignore[no-untyped-def]
    axes, s_at, t_at, shape, horizon, sun, phase_size, first_node, turned, fraction
):
    """Nodes of points of a face in the table and in the phase functions, and shares of the next.

    `s_at`, `t_at` (n,): where on the face, along its s and t axes. `phase_size`: of four numbers a
    node.
    """
    turns = np.int32(phase_size // 4 - 1)
    for j in range(s_at.size):
        s, t = s_at[j], t_at[j]
        x = axes[0, 0] + s * axes[1, 0] + t * axes[2, 0]
        y = axes[0, 1] + s * axes[1, 1] + t * axes[2, 1]
        z = axes[0, 2] + s * axes[1, 2] + t * axes[2, 2]
        level = x * x + z * z
        length = math.sqrt(level + y * y)
        first, fraction[0, j] = _row_place(y, level, length, shape, horizon)
        column, fraction[1, j] = _column_place(x, z, level, shape[2], sun)
        first_node[j] = first + column
        turned[j], fraction[2, j] = _turn_place(x, y, z, _ONE / length, turns, sun)


@_compiled
def _place_rows(s_at, y, shape, horizon, row, fraction):  # type: ignore[no-untyped-def]
    """First nodes of the table's rows, for directions of a side face at a height y: all four faces
    have the same."""
    for j in range(s_at.size):
        level = _ONE + s_at[j] * s_at[j]
        row[j], fraction[j] = _row_place(y, level, math.sqrt(level + y * y), shape, horizon)


@_compiled
def _place_columns(axes, s_at, columns, sun, column, fraction):  # type: ignore[no-untyped-def]
    """Columns of the table, for a side face: they do not depend on the height."""
    for j in range(s_at.size):
        x, z = axes[0, 0] + s_at[j] * axes[1, 0], axes[0, 2] + s_at[j] * axes[1, 2]
        column[j], fraction[j] = _column_place(x, z, _ONE + s_at[j] * s_at[j], columns, sun)


@_compiled
def _place_turns(axes, s_at, y, sun, phase_size, turned, fraction):  # type: ignore[no-untyped-def]
    """Nodes of the phase functions, for directions of a side face at a height y."""
    turns = np.int32(phase_size // 4 - 1)
    for j in range(s_at.size):
        x, z = axes[0, 0] + s_at[j] * axes[1, 0], axes[0, 2] + s_at[j] * axes[1, 2]
        inverse = _ONE / math.sqrt(_ONE + s_at[j] * s_at[j] + y * y)
        turned[j], fraction[j] = _turn_place(x, y, z, inverse, turns, sun)


@njit(inline="always", **_OPTIONS)
def _row_place(y, level, length, shape, horizon):  # type: ignore[no-untyped-def]
    """First node of the row below a direction, and the share of the next row."""
    above, below, columns = shape
    rise, fall = _ONE / (horizon[1] - horizon[0]), _ONE / horizon[0]
    turn = _f4(TURN_OUTSIDE if horizon[1] <= _ONE else TURN_INSIDE)
    # 1 + mu without cancellation at the nadir, where a far observer has all of the planet.
    depth, inverse = length + abs(y), _ONE / length
    w = level * inverse / depth if y < 0 else depth * inverse
    height = w - horizon[0]
    if below == 0:
        # A texel on the level may fall below it by a last digit.
        height = max(height, _ZERO)
    share = min(abs(height) * (rise if height >= 0 else fall), _ONE)
    if height < 0:
        row = math.sqrt(share)
    elif share < turn:
        row = math.sqrt(share * turn)
    else:
        row = _ONE - math.sqrt((_ONE - share) * (_ONE - turn))
    row = row * np.float32(above - 1 if height >= 0 else below - 1)
    last = above - 2 if height >= 0 else below - 2
    i = min(np.int32(row), np.int32(last))
    return np.int32((i if height >= 0 else i + above) * columns), row - np.float32(i)


@njit(inline="always", **_OPTIONS)
def _column_place(x, z, level, columns, sun):  # type: ignore[no-untyped-def]
    """Column of the table before a direction, and the share of the next."""
    # Half the chord between the level directions is the sine of half the azimuth.
    scale = _ONE / math.sqrt(max(level, _SMALLEST))
    along, across = x * scale - sun[3], z * scale - sun[4]
    column = _HALF * math.sqrt(along * along + across * across) * np.float32(columns - 1)
    k = min(np.int32(column), np.int32(columns - 2))
    return k, column - np.float32(k)


@njit(inline="always", **_OPTIONS)
def _turn_place(x, y, z, inverse, turns, sun):  # type: ignore[no-untyped-def]
    """Node of the phase functions before a direction, and the share of the next."""
    # Half the chord to the sun is the sine of half the angle: exact beside it.
    dx, dy, dz = x * inverse - sun[0], y * inverse - sun[1], z * inverse - sun[2]
    at = min(_HALF * math.sqrt(dx * dx + dy * dy + dz * dz), _ONE) * np.float32(turns)
    first = min(np.int32(at), turns - np.int32(1))
    return first, at - np.float32(first)


@_compiled
def _shade(nodes, columns, phase, colour, first_node, turned, fraction, row):  # type: ignore[no-untyped-def]
    """Radiance (n * 3,) of the texels; the table holds fourth roots: see `table`."""
    node, three, four = np.uintp(NODE), np.uintp(3), np.uintp(4)
    below = np.uintp(columns) * node
    for j in range(first_node.size):
        near = np.uintp(first_node[j]) * node
        shade_texel(
            row, np.uintp(j) * three, nodes, near, near + below, fraction[1, j], fraction[0, j],
            phase, np.uintp(turned[j]) * four, fraction[2, j], colour,
        )  # fmt: skip


@intrinsic
def shade_texel(  # type: ignore[no-untyped-def]
    typingctx, out, place, nodes, near, far, across, along, phase, turned, turn, colour
):
    """out[place:+3] = the radiance between four nodes of fourth roots.

    `nodes` is flat; the nodes are those that begin at `near`, `near` + 8, `far` and `far` + 8,
    `across` the share of the second of each pair, `along` that of the second pair. The first four
    numbers of a node are light with its phase, the others bands of aerosol's, to be multiplied by
    the phase functions between `turned` and the next node, `turn` its share, and by the bands'
    colours. `phase` and `colour` are flat. Indices are the caller's to keep inside.
    """

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        def pointer(argument: int, index: _Value) -> _Value:
            array = context.make_array(signature.args[argument])(context, builder, args[argument])
            return builder.gep(array.data, [index])

        def node(index: _Value) -> _Value:
            return builder.load(builder.bitcast(pointer(2, index), _NODE.as_pointer()), align=4)

        def four(argument: int, index: _Value) -> _Value:
            at = builder.bitcast(pointer(argument, index), _FOUR.as_pointer())
            return builder.load(at, align=4)

        def half(light: _Value, first: int) -> _Value:
            mask = ir.Constant(ir.VectorType(_INT, 4), [_INT(first + k) for k in range(4)])
            return builder.shuffle_vector(light, ir.Constant(_NODE, ir.Undefined), mask)

        def between(first: _Value, second: _Value, share: _Value) -> _Value:
            change = builder.fsub(second, first, flags=_FLAGS)
            return builder.fadd(first, builder.fmul(share, change, flags=_FLAGS), flags=_FLAGS)

        size = args[3].type
        share = _splat(builder, args[5])
        rows = [between(node(at), node(builder.add(at, size(8))), share) for at in args[3:5]]
        light = between(*rows, _splat(builder, args[6]))
        for _ in range(2):
            light = builder.fmul(light, light, flags=_FLAGS)
        phases = between(
            four(7, args[8]), four(7, builder.add(args[8], size(4))), _splat(builder, args[9], 4)
        )
        bands = builder.fmul(half(light, 4), phases, flags=_FLAGS)
        total = half(light, 0)
        for band in range(4):
            one = _splat(builder, builder.extract_element(bands, _INT(band)), 4)
            coloured = builder.fmul(one, four(10, size(4 * band)), flags=_FLAGS)
            total = builder.fadd(total, coloured, flags=_FLAGS)
        # Between the nodes a colour may leave the gamut by a trace.
        none = ir.Constant(_FOUR, [0.0] * 4)
        total = builder.select(builder.fcmp_ordered(">", total, none), total, none)
        first = ir.Constant(ir.VectorType(_INT, 2), [_INT(0), _INT(1)])
        two = builder.shuffle_vector(total, ir.Constant(_FOUR, ir.Undefined), first)
        builder.store(two, builder.bitcast(pointer(0, args[1]), two.type.as_pointer()), align=4)
        third = builder.extract_element(total, _INT(2))
        builder.store(third, pointer(0, builder.add(args[1], size(2))))
        return context.get_dummy_value()

    index, real = types.uintp, types.float32
    arguments = out, index, nodes, index, index, real, real, phase, index, real, colour
    return types.void(*arguments), codegen


def _splat(builder: _Value, scalar: _Value, lanes: int = 8) -> _Value:
    undefined = ir.Constant(ir.VectorType(_FLOAT, lanes), ir.Undefined)
    first = builder.insert_element(undefined, scalar, _INT(0))
    everywhere = ir.Constant(ir.VectorType(_INT, lanes), [_INT(0)] * lanes)
    return builder.shuffle_vector(first, undefined, everywhere)
