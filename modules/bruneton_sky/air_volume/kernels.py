"""The air along the rows of a volume, slice by slice: matter first, then the light it scatters.

A slice is one bin of the solver's kind: what scatters in it is summed over fine steps, and the
light comes from its centre of mass. A row's columns share its bins.

Importing this module imports numba.
"""

import math

import numpy as np

from bruneton_sky.solver.bin_kernels import Bins
from bruneton_sky.solver.cell_kernels import HALF, ONE, ZERO, empty_cells, fast, inner, set_suns
from bruneton_sky.solver.first_order_kernels import gather_first
from bruneton_sky.solver.later_order_kernels import empty_slab, gather_later
from bruneton_sky.solver.packed_bins import BIN_FLOATS, pack_bin
from bruneton_sky.solver.ray_kernels import (
    absorber_density,
    altitude_along,
    hits_ground,
    layer_density,
    mean_density,
    molecules_density,
    ray_length,
    tent_density,
)

_f4 = np.float32
# A slice that scatters less than this share of all slices before it is left out.
NEGLIGIBLE = 1e-6
# Numbers of a slice in the GPU's buffer.
SLICE_FLOATS = BIN_FLOATS + 12


@fast
def slice_rows(air, altitude, mu, distance, steps, centre, weight, passed):  # type: ignore[no-untyped-def]
    """The matter of rays (rows,) between distances (rows, slices + 1), the first of them 0.

    Each slice is marched in `steps` steps. `centre` (rows, slices, 4), `weight` (rows, slices,
    2, 4): see `Bins`. `passed` (rows, slices, 4): transmittance up to each slice's end.
    """
    light = np.empty(4)
    for i in range(mu.size):
        level = math.inf
        if hits_ground(air, altitude[i], mu[i]):
            level = ray_length(air, altitude[i], mu[i], True)
        light[:] = 1.0
        for k in range(distance.shape[1] - 1):
            start, stop = distance[i, k], distance[i, k + 1]
            middle = min(max(level, start), stop)
            here, matter = centre[i, k], weight[i, k]
            here[:] = 0.0
            matter[:] = 0.0
            if middle > start:
                _march(air, altitude[i], mu[i], start, middle, steps, light, here, matter)
            if stop > middle:
                count = 1 if level < math.inf else steps
                _march(air, altitude[i], mu[i], middle, stop, count, light, here, matter)
            _place_centre(air, altitude[i], mu[i], 0.5 * (start + stop), here)
            for c in range(light.size):
                passed[i, k, c] = light[c]


@inner
def _march(air, altitude, mu, start, stop, steps, light, centre, weight):  # type: ignore[no-untyped-def]
    """Add the matter between two distances; below level 0 it is that of level 0."""
    radius, metres = air.ground_radius_m + altitude, (stop - start) / steps
    near = max(altitude_along(radius, altitude, mu, start), 0.0)
    for s in range(steps):
        at = start + (s + 0.5) * metres
        middle = max(altitude_along(radius, altitude, mu, at), 0.0)
        far = max(altitude_along(radius, altitude, mu, at + 0.5 * metres), 0.0)
        molecules = metres * molecules_density(air, near, middle, far)
        aerosol = metres * mean_density(near, middle, far, air.mie_scale_height_m)
        aloft = metres * layer_density(near, middle, far, air.aloft_scale_height_m)
        fog = metres * layer_density(near, middle, far, air.fog_scale_height_m)
        high = metres * tent_density(air, near, middle, far)
        absorber = metres * absorber_density(air, middle)
        mass = _add_step(air, molecules, aerosol, aloft, fog, high, absorber, light, weight)
        centre[0] += mass * at
        centre[3] += mass
        near = far


@inner
def _add_step(air, molecules, aerosol, aloft, fog, high, absorber, light, weight):  # type: ignore[no-untyped-def]
    """Add a step's matter, given in m, to the weights and dim the light; the sum of the additions.

    Its mean transmittance is that of an exponential.
    """
    mass = 0.0
    for c in range(4):
        depth = air.extinction[0, c] * molecules + air.extinction[1, c] * aerosol
        depth += air.extinction[2, c] * absorber + air.extinction[3, c] * fog
        depth += air.extinction[4, c] * aloft + air.extinction[5, c] * high
        passed = math.exp(-depth)
        seen = light[c] * ((1.0 - passed) / depth if depth > 1e-5 else 1.0 - 0.5 * depth)
        clear = seen * air.scattering[0, c] * molecules
        haze = air.scattering[1, c] * aerosol + air.scattering[2, c] * aloft
        haze += air.scattering[3, c] * fog + air.scattering[4, c] * high
        haze *= seen
        weight[0, c] += clear
        weight[1, c] += haze
        mass += clear + haze
        light[c] *= passed
    return mass


@inner
def _place_centre(air, altitude, mu, middle, centre):  # type: ignore[no-untyped-def]
    """Distance, altitude and cosine of a slice's centre of mass."""
    radius = air.ground_radius_m + altitude
    distance = centre[0] / centre[3] if centre[3] > 0.0 else middle
    there = altitude_along(radius, altitude, mu, distance)
    cosine = (radius * mu + distance) / (air.ground_radius_m + there)
    centre[0], centre[1] = distance, min(max(there, 0.0), air.top_altitude_m)
    centre[2] = min(max(cosine, -1.0), 1.0)


@fast
def light_rows(  # type: ignore[no-untyped-def]
    air, altitude, mu, mu_s, nu, distance, centre, weight, transmittance, source, colour, channels,
    lanes, out
):  # fmt: skip
    """Add the light of the slices up to each slice's end to `out` (3, slices, rows, columns, 3).

    Of light scattered twice and more, once by molecules, without their phase function, and once by
    particles, over that of the channel. `transmittance`, `source`: of a group of wavelengths of a
    `SourceField`. `colour` (rows, slices, 4, 3) turns the four wavelengths into red, green, blue.
    `channels`, `lanes`: see `ChannelPhases`; of the group.
    """
    columns, kinds = mu_s.shape[1], lanes.shape[1] // 4
    cells, slab, end = empty_cells(columns), empty_slab(source), np.empty(5)
    row = np.empty(transmittance.shape[1], _f4)
    some, light = np.empty(4 * (1 + kinds) * columns, _f4), np.empty((3, 4 * columns), _f4)
    phase, inverse = np.empty((4 * columns, kinds), _f4), np.empty((columns, 3), _f4)
    for i in range(mu.size):
        set_suns(cells, mu_s[i], nu[i])
        _set_phases(nu[i], channels, lanes, phase, inverse)
        light[:] = ZERO
        mass = 0.0
        for k in range(centre.shape[1]):
            mass += centre[i, k, 3]
            if centre[i, k, 3] > NEGLIGIBLE * mass:
                bins = Bins(distance[i, k : k + 2], centre[i, k : k + 1], weight[i, k : k + 1], end)
                gather_first(air, altitude[i], mu[i], bins, cells, transmittance, row, some)
                for m in range(4 * columns):
                    light[1, m] += some[m]
                    for kind in range(kinds):
                        light[2, m] += some[4 * columns * (1 + kind) + m] * phase[m, kind]
                gather_later(air, altitude[i], bins, cells, source, slab, light[0])
            _add_colours(light, colour[i, k], inverse, out[:, k, i])


@inner
def _set_phases(nu, channels, lanes, phase, inverse):  # type: ignore[no-untyped-def]
    """Phase functions (cells * 4, kinds) at cosines (cells,), 1 over the channels' (cells, 3)."""
    last = len(channels) - 2
    for n in range(nu.size):
        place = math.sqrt(max((ONE - nu[n]) * HALF, ZERO)) * _f4(last + 1)
        i = min(int(place), last)
        far = place - _f4(i)
        for c in range(4):
            for k in range(phase.shape[1]):
                here = lanes[i, 4 * k + c]
                phase[4 * n + c, k] = here + far * (lanes[i + 1, 4 * k + c] - here)
        for c in range(3):
            here = channels[i, c] + far * (channels[i + 1, c] - channels[i, c])
            inverse[n, c] = ONE / max(here, _f4(1e-30))


@inner
def _add_colours(light, colour, inverse, out):  # type: ignore[no-untyped-def]
    """Add the colours of three kinds of light (3, cells * 4) to `out` (3, cells, 3)."""
    for n in range(out.shape[1]):
        for part in range(3):
            a, b = light[part, 4 * n], light[part, 4 * n + 1]
            c, d = light[part, 4 * n + 2], light[part, 4 * n + 3]
            for channel in range(3):
                sum_ab = a * colour[0, channel] + b * colour[1, channel]
                sum_cd = c * colour[2, channel] + d * colour[3, channel]
                over = inverse[n, channel] if part == 2 else ONE
                out[part, n, channel] += (sum_ab + sum_cd) * over


@fast
def settle_colours(light, molecules, turn, phase):  # type: ignore[no-untyped-def]
    """Make colours (3, slices, rows, columns, 3) no less than zero.

    A low sun's light off aerosol lies outside the gamut: what it lacks the molecules' makes up
    for, as in the sky, and what that lacks light scattered again. `molecules` (rows,
    columns): their phase function, `turn` the sine of half the angle to the sun, where `phase` (n,
    3) is that of aerosol.
    """
    for k in range(light.shape[1]):
        for i in range(light.shape[2]):
            for n in range(light.shape[3]):
                place = turn[i, n] * _f4(len(phase) - 1)
                a = min(int(place), len(phase) - 2)
                far = place - _f4(a)
                for c in range(3):
                    shaded, direct = light[0, k, i, n, c], light[1, k, i, n, c]
                    aerosol = light[2, k, i, n, c]
                    here = phase[a, c] + far * (phase[a + 1, c] - phase[a, c])
                    direct += min(aerosol, ZERO) * here / molecules[i, n]
                    shaded = max(shaded + min(direct, ZERO) * molecules[i, n], ZERO)
                    direct, aerosol = max(direct, ZERO), max(aerosol, ZERO)
                    light[0, k, i, n, c], light[1, k, i, n, c] = shaded, direct
                    light[2, k, i, n, c] = aerosol


@fast
def pack_slices(air, distance, centre, weight, colour, out):  # type: ignore[no-untyped-def]
    """Fill `out` (rows, slices, SLICE_FLOATS), zeros, in the order of `Slice` in air_volume.comp.

    Arguments as for `light_rows`.
    """
    share = np.empty((4, 4))
    for i in range(out.shape[0]):
        mass = 0.0
        for k in range(out.shape[1]):
            here, packed = centre[i, k], out[i, k]
            for c in range(4):
                for channel in range(3):
                    packed[BIN_FLOATS + 4 * channel + c] = colour[i, k, c, channel]
            mass += here[3]
            if here[3] > NEGLIGIBLE * mass:
                start, stop = distance[i, k], distance[i, k + 1]
                pack_bin(air, start, stop, here, weight[i, k], share, packed)
