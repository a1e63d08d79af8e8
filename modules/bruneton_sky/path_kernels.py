"""One ray and the matter along it, compiled: float64, parameters as arguments.

The formulas are those of `geometry` and `optical_path`, which explain them. The scaled
complementary error function is a polynomial here (relative error 1.3e-9), so kernels and their
twins differ by some 1e-9. A ray is a tuple: altitude, radius, perigee radius, perigee altitude,
y, radius * mu.

Importing this module imports numba.
"""

import math

from vrut_lite.njit import njit

# erfcx(x) = P(t) / (1 + 2 x) with t = (x - 4) / (x + 4), for x >= 0; constant first.
ERFCX = (
    1.232995117440,
    -0.139621113854,
    0.015379768723,
    0.068096941417,
    -0.101040940771,
    0.093734073444,
    -0.066319044089,
    0.037161482871,
    -0.016230391983,
    0.005047229283,
    -0.000709132787,
    -0.000220404494,
    0.000114208173,
    -0.000008625303,
)
_GAUSS_3 = math.sqrt(0.6)
compiled = njit(cache=True, nogil=True, error_model="numpy")


@compiled
def make_ray(ground_radius, altitude, mu):  # type: ignore[no-untyped-def]
    """Altitude, radius, perigee radius, perigee altitude, y, radius * mu."""
    radius = ground_radius + altitude
    sine = math.sqrt((1.0 - mu) * (1.0 + mu))
    y_squared = radius * mu * mu / (1.0 + sine)
    y = math.copysign(math.sqrt(y_squared), mu)
    return altitude, radius, radius * sine, altitude - y_squared, y, radius * mu


@compiled
def jacobian(p, y):  # type: ignore[no-untyped-def]
    """Metres of path per unit of y; p is the perigee's radius."""
    squared = y * y + 2.0 * p
    return 2.0 * (y * y + p) / math.sqrt(squared) if squared > 0 else 0.0


@compiled
def exponential_path(ray, d0, h1, y1, d1, scale, share=1.0):  # type: ignore[no-untyped-def]
    """Path in m through a density share * exp(-altitude / scale), d0 at the start and d1 at
    altitude h1, y1."""
    h0, r, p, perigee, y0, _ = ray
    root = math.sqrt(scale)
    tail0, tail1 = d0 * _erfcx(abs(y0) / root), d1 * _erfcx(abs(y1) / root)
    if y0 >= 0:
        t0 = tail0 - tail1
    elif y1 <= 0:
        t0 = tail1 - tail0
    else:
        t0 = 2.0 * share * math.exp(-max(perigee, 0.0) / scale) - tail0 - tail1
    t0 *= math.sqrt(math.pi) * root
    y0_squared = y0 * y0
    t1 = scale * (d0 * y0 - d1 * y1) + (0.5 * scale - y0_squared) * t0
    t2 = -scale * y1 * (h1 - h0) * d1 + (1.5 * scale - y0_squared) * t1 + scale * y0_squared * t0
    inverse_q = 1.0 / (r + p)
    a1 = 1.0 / r - 0.5 * inverse_q
    a2 = inverse_q * (0.375 * inverse_q - 0.5 / r)
    return max(r * math.sqrt(inverse_q) * (t0 + a1 * t1 + a2 * t2), 0.0)


@compiled
def exponential_layers_path(ray, d0, h1, y1, d1, layers):  # type: ignore[no-untyped-def]
    """The same through layers of several scale heights, as `ExponentialLayers.array` has them."""
    perigee, path, ends = ray[3], 0.0, (d0, h1, y1, d1)
    for k in range(layers.shape[1]):
        # The lowest layer reaches down without end, the highest up.
        near, far, above, below = 0.0, math.inf, 0.0, layers[3, k]
        if k + 1 < layers.shape[1]:
            if layers[0, k + 1] <= perigee:
                continue
            far, above = math.sqrt(layers[0, k + 1] - perigee), layers[3, k + 1]
        if k > 0:
            near = math.sqrt(max(layers[0, k] - perigee, 0.0))
        share, scale = layers[1, k], layers[2, k]
        if near == 0.0:
            path += _layer_piece(ray, -far, above, far, above, ends, share, scale)
        else:
            path += _layer_piece(ray, -far, above, -near, below, ends, share, scale)
            path += _layer_piece(ray, near, below, far, above, ends, share, scale)
    return path


@compiled
def _layer_piece(ray, from_y, from_d, to_y, to_d, ends, share, scale):  # type: ignore[no-untyped-def]
    """Path through an exponential between two y, of which the ray may hold a part."""
    h0, r, p, perigee, y0, along = ray
    d0, h1, y1, d1 = ends
    begin, stop = max(from_y, y0), min(to_y, y1)
    if stop <= begin:
        return 0.0
    low, high = h0, h1
    if begin > y0:
        low, d0 = perigee + begin * begin, from_d
    if stop < y1:
        high, d1 = perigee + stop * stop, to_d
    piece = low, r - h0 + low, p, perigee, begin, along
    return exponential_path(piece, d0, high, stop, d1, scale, share)


@compiled
def layers_density(layers, altitude):  # type: ignore[no-untyped-def]
    """Density of the layers at an altitude."""
    k = layer_at(layers[0], altitude)
    return layers[1, k] * math.exp(-altitude / layers[2, k])


@compiled
def layer_at(bases, altitude):  # type: ignore[no-untyped-def]
    """Index of the layer that an altitude lies in; bases rise."""
    layer = 0
    while layer + 1 < bases.size and bases[layer + 1] <= altitude:
        layer += 1
    return layer


@compiled
def _erfcx(x):  # type: ignore[no-untyped-def]
    t = (x - 4.0) / (x + 4.0)
    # Two chains, which a processor adds side by side.
    even, odd, squared = 0.0, 0.0, t * t
    for k in range(len(ERFCX) - 2, -1, -2):
        even = even * squared + ERFCX[k]
        odd = odd * squared + ERFCX[k + 1]
    return (even + t * odd) / (1.0 + 2.0 * x)


@compiled
def layered_path(ray, end, node_altitude, density):  # type: ignore[no-untyped-def]
    """Path in m through a piecewise linear density, from the start of a ray to y = end."""
    perigee, start, path = ray[3], ray[4], 0.0
    for k in range(node_altitude.size - 1):
        low, high = node_altitude[k], node_altitude[k + 1]
        if high <= perigee:
            continue
        slope = (density[k + 1] - density[k]) / (high - low)
        near, far = math.sqrt(max(low - perigee, 0.0)), math.sqrt(high - perigee)
        offset = density[k] + slope * (perigee - low)
        path += _layer_branch(ray[2], max(near, start), min(far, end), offset, slope)
        path += _layer_branch(ray[2], max(-far, start), min(-near, end), offset, slope)
    return path


@compiled
def _layer_branch(p, from_y, to_y, offset, slope):  # type: ignore[no-untyped-def]
    half, middle = 0.5 * (to_y - from_y), 0.5 * (from_y + to_y)
    if half <= 0:
        return 0.0
    path = 0.0
    for k in range(3):
        y = middle + half * _GAUSS_3 * (k - 1)
        path += (8.0 if k == 1 else 5.0) / 9.0 * jacobian(p, y) * (offset + slope * y * y)
    return half * path
