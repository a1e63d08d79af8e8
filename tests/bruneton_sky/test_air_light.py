"""The air before things: closed forms, darkness, and the sky that it ends in.

lab/tests/air holds the volume to a reference in float64 and to Monte Carlo.
"""

from dataclasses import replace

import numpy as np
import pytest
from bruneton_sky.air_volume import AirSizes, air_is_seen, air_volume
from bruneton_sky.phase import rayleigh_phase
from bruneton_sky.sky_view import fill_cube, sky_view
from bruneton_sky.solver import solve
from directions import towards
from solved_air import field, found

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.sky.air_volume import light_of, look_up_air


@pytest.mark.parametrize("sun_deg", [-16.0, -17.3, -18.0])
def test_no_sunlight_in_the_planets_shadow(sun_deg: float) -> None:
    """In deep twilight the first hundred kilometres lie in the planet's shadow, as high as they
    reach: light scattered once is zero there. Rounding that left 6e-8 of each slice lit made air
    18 degrees after sunset up to 23 % too red."""
    volume = air_volume(field(), 2.0, towards(sun_deg), 1e5)
    assert light_of(volume)[0].max() > 0.0
    assert not light_of(volume)[1:].any()


def test_even_air_has_the_light_of_the_closed_form() -> None:
    """Air of one density everywhere, light scattered once, the sun in the zenith: along the level
    sunlight and density do not change, so that L(s) = E T_sun P(0) (1 - T(s)), T = exp(-beta s).
    Molecules alone, on a planet so large and with scale heights so great that nothing bends; on one
    ten times as large float32 would lose the path to the top, sqrt(1 + 2 h / r) - 1."""
    base = field().atmosphere
    air = replace(
        base,
        ground_radius_m=6.36e9,
        rayleigh_scale_height_m=1e12,
        mie_scattering=0.0,
        mie_extinction=0.0,
        absorption_extinction=0.0,
        ground_albedo=0.0,
        rayleigh_scattering=(2e-6, 3e-6, 4e-6, 8e-6),
    )
    solved = solve(air, 1)
    beta, sun = np.asarray(air.rayleigh_scattering), np.asarray(air.solar_irradiance)
    overhead = np.exp(-beta * (air.top_altitude_m - 1000.0))
    metres = np.array([300.0, 3e4, 3e5])
    lost = -np.expm1(-beta * metres[:, None])
    expected = rgb_from_spectrum(sun * overhead * rayleigh_phase(0.0) * lost, air.wavelength_nm)
    volume = air_volume(solved, 1000.0, towards(90.0), 4e5)
    ours, _ = found(volume, towards(0.0, 40.0), metres)
    assert ours == pytest.approx(expected, rel=3e-3)


@pytest.mark.parametrize("elevation_deg", [35.0, 3.0, -3.0])
def test_air_to_its_end_is_the_sky(elevation_deg: float) -> None:
    """Upwards without end the air must be the sky that the sky-view table shows: 99 % of texels
    within 1 %, so that no line shows where a mountain ends."""
    solved, sun = field(), towards(elevation_deg)
    directions = texel_directions(32)
    up = directions[..., 1] > 0.0
    sky = fill_cube(sky_view(solved, 2.0, sun), 32, np.zeros(3))[up]
    light = look_up_air(air_volume(solved, 2.0, sun, 1e7), directions[up], np.full(up.sum(), 1e9))
    scale = np.maximum(sky.max(axis=-1, keepdims=True), 1e-3 * sky.max())
    error = np.abs(light.shaded + light.sunlit - sky) / scale
    assert np.quantile(error, 0.99) < 1e-2
    assert error.mean() < 2e-3


def test_arrays_have_the_sizes_asked_for() -> None:
    """The arrays of the message have the shapes of `AirSizes`."""
    sizes = AirSizes(5, 4, 3, 6)
    volume = air_volume(field(), 2.0, towards(30.0), 1e4, sizes)
    assert light_of(volume).shape == (3, 5, 7, 6, 3)
    assert light_of(volume).dtype == np.float16
    assert volume.extinction.shape == (5, 7, 3)
    assert volume.extinction.dtype == np.float32
    assert (volume.rows_above, volume.rows_below) == (4, 3)


def test_only_air_thick_enough_is_seen() -> None:
    """A metre of clear air hides nothing and a kilometre does; from space the air within reach
    counts, which is none before the things do."""
    air = field().atmosphere
    assert not air_is_seen(air, 2.0, 1.0)
    assert air_is_seen(air, 2.0, 1000.0)
    assert not air_is_seen(air, 55_000.0, 1000.0)
    assert not air_is_seen(air, 4e8, -1.0)
