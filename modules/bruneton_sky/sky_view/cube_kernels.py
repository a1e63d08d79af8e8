"""Compiled look-up of a sky-view table for every texel of a cube map, in single precision.

A row of texels is worked in two passes over short buffers: coordinates in the table and the phase
function (a loop that vectorises over texels), and the bilinear look-up of a node's eight numbers,
one SIMD register. That is straight-line code, which numba does not vectorise: `shade_texel` says it
to LLVM directly. From above the air the limb may be as thin as a texel: there the mean of a few
samples is taken.

Importing this module imports numba: do it only where the first cube is filled.
"""

import math
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

from bruneton_sky.sky_view.rays import TURN_INSIDE, TURN_OUTSIDE
from vrut_lite.njit import SUMS_IN_ORDER, njit

# Numbers of one node: three of the light with its phase applied and a pad, three without, a pad.
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
_compiled = njit(cache=True, nogil=True, error_model="numpy", fastmath=SUMS_IN_ORDER)
_FLOAT, _INT = ir.FloatType(), ir.IntType(32)
_NODE = ir.VectorType(_FLOAT, 8)
_FLAGS = tuple(sorted(SUMS_IN_ORDER))
_Value = Any


@_compiled
def fill_faces(  # type: ignore[no-untyped-def]
    nodes, shape, horizon, sun, phase, axes, centres, ground, cube
):
    """Fill `cube` (6, n, n, 3) from `nodes` (rows * columns, 8); all float32.

    `shape` is (rows above the horizon, rows below, columns); without rows below, what lies
    below the level is `ground` (3,). `horizon` holds 1 + mu of the ground's horizon and of the
    air's end; `sun` the direction (3,) and its level part's direction (2,); `phase` what
    `mie_phase_parameters` gives. `axes` (6, 3, 3): normal, s and t axis of each face.
    """
    size = centres.size
    first_node = np.empty(size, dtype=np.int32)
    fraction = np.empty((2, size), dtype=np.float32)
    mie_phase, level = np.empty(size, dtype=np.float32), np.empty(size, dtype=np.float32)
    flat_nodes, rows = nodes.reshape(-1), cube.reshape(6, size, 3 * size)
    for face in range(6):
        for i in range(size):
            if shape[1] == 0 and axes[face, 0, 1] + centres[i] * axes[face, 2, 1] < 0.0:
                for j in range(size):
                    for c in range(3):
                        cube[face, i, j, c] = ground[c]
                continue
            if horizon[1] <= _ONE and _depth(axes[face], _ZERO, centres[i]) >= horizon[1]:
                # An observer above the air sees no light above the air's edge. A row looks down
                # most steeply in its middle.
                cube[face, i, :, :] = _ZERO
                continue
            level[:] = centres[i]
            _place(
                axes[face], centres, level, shape, horizon, sun, phase,
                first_node, fraction, mie_phase,
            )  # fmt: skip
            _shade(flat_nodes, shape[2], first_node, fraction, mie_phase, rows[face, i])
    if horizon[1] <= _ONE:
        _refine_limb(flat_nodes, shape, horizon, sun, phase, axes, centres, cube)


@_compiled
def _refine_limb(nodes, shape, horizon, sun, phase, axes, centres, cube):  # type: ignore[no-untyped-def]
    """Put the mean of some samples into each texel that the limb crosses."""
    size = centres.size
    least, most = _limb_reach(horizon, size)
    thin = horizon[1] - horizon[0] < -_f4(2.0) * least
    samples, stride = (THIN_SAMPLES, THIN_STRIDE) if thin else (SAMPLES, STRIDE)
    s, t = np.empty(samples * size, np.float32), np.empty(samples * size, np.float32)
    first_node = np.empty(s.size, dtype=np.int32)
    fraction = np.empty((2, s.size), dtype=np.float32)
    mie_phase, light = np.empty(s.size, np.float32), np.empty(3 * s.size, np.float32)
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
                axes[face], s[:few], t[:few], shape, horizon, sun, phase,
                first_node[:few], fraction[:, :few], mie_phase[:few],
            )  # fmt: skip
            _shade(nodes, shape[2], first_node[:few], fraction[:, :few], mie_phase[:few], light)
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
    axes, s_at, t_at, shape, horizon, sun, phase, first_node, fraction, mie_phase
):
    """Node and fractions of points of a face, and the phase function of their angle from the sun.

    `s_at`, `t_at` (n,): where on the face, along its s and t axes.
    """
    above, below, columns = shape
    rise, fall = _ONE / (horizon[1] - horizon[0]), _ONE / horizon[0]
    turn = _f4(TURN_OUTSIDE if horizon[1] <= _ONE else TURN_INSIDE)
    factor, bend, near, forward = phase
    for j in range(s_at.size):
        s, t = s_at[j], t_at[j]
        x = axes[0, 0] + s * axes[1, 0] + t * axes[2, 0]
        y = axes[0, 1] + s * axes[1, 1] + t * axes[2, 1]
        z = axes[0, 2] + s * axes[1, 2] + t * axes[2, 2]
        level = x * x + z * z
        length = math.sqrt(level + y * y)
        inverse = _ONE / length
        # 1 + mu without cancellation at the nadir, where a far observer has all of the planet.
        depth = length + abs(y)
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
        # Half the chord between the level directions is the sine of half the azimuth.
        scale = _ONE / math.sqrt(max(level, _SMALLEST))
        along, across = x * scale - sun[3], z * scale - sun[4]
        column = _HALF * math.sqrt(along * along + across * across) * np.float32(columns - 1)
        k = min(np.int32(column), np.int32(columns - 2))
        first_node[j] = (i if height >= 0 else i + above) * columns + k
        fraction[0, j] = row - np.float32(i)
        fraction[1, j] = column - np.float32(k)
        nu = (x * sun[0] + y * sun[1] + z * sun[2]) * inverse
        spread = near + forward * (_ONE - nu)
        mie_phase[j] = factor * (_ONE + bend * nu * nu) / (spread * math.sqrt(spread))


@_compiled
def _shade(nodes, columns, first_node, fraction, mie_phase, row):  # type: ignore[no-untyped-def]
    """Radiance (n * 3,) of the texels; the table holds fourth roots: see `table`."""
    node, three = np.uintp(NODE), np.uintp(3)
    below = np.uintp(columns) * node
    for j in range(mie_phase.size):
        near = np.uintp(first_node[j]) * node
        shade_texel(
            row, np.uintp(j) * three, mie_phase[j], nodes, near, near + below,
            fraction[1, j], fraction[0, j],
        )  # fmt: skip


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
