"""The small table of near air against all of the air, on a planet that is not Earth."""

import msgspec
import numpy as np
import pytest
from air.frame_part import AirPart
from air.near_air import reach_m
from air_phases import lobe
from air_stage import air_of, volume_of
from scene_stage import look, square
from stateful_backend import opened
from term_stage import material
from test_air_frame import EYE, scene_of, show_light, uniform_sky, wall

from vrut_lite.messages.air import SecondLight
from vrut_lite.sky.air_volume import node_rays, slice_shares

pytestmark = pytest.mark.gl
PLANET = {"ground_radius_m": 2.1e6, "top_altitude_m": 3e4, "reach_m": 1e5}
SUN = np.array([0.48, 0.36, -0.8])
# At the ground, and how fast air thins.
EXTINCTION_PER_M, SCALE_M = np.array([4e-5, 7e-5, 15e-5]), 5e3


def planet_air(altitude_m=1.7, **changes):
    """Haze that thins with height, whose light changes with direction."""
    nodes = {"slices": 24, "rows_above": 24, "rows_below": 16, "columns": 16}
    known = PLANET | nodes | {"observer_altitude_m": altitude_m, "sun_direction": tuple(SUN)}
    plain = volume_of(1e-5, 1.0, **known, **changes)
    rays = node_rays(plain, plain.columns, SUN[1])
    metres = slice_shares(plain.extinction.shape[0], altitude_m)[:, None] * rays.span_m
    along = np.linspace(0.0, 1.0, 65) * metres[..., None]
    height_m = np.clip(altitude_m + along * rays.mu[:, None], 0.0, None)
    density = np.exp(-height_m / SCALE_M).mean(axis=-1)
    columns = np.arange(plain.columns)[:, None]
    light = 4.0 + np.sin(3.0 * rays.mu)[:, None, None] + np.cos(0.4 * columns)
    light = light * np.array([1.0, 1.5, 2.0])
    return volume_of(
        density[..., None] * EXTINCTION_PER_M,
        light,
        direct=3.0 * light,
        aerosol=0.5 * light,
        aerosol_phase=lobe(0.7, 0.05, 0.3, angles=512),
        **known,
        **changes,
    )


@pytest.mark.parametrize("bodies", [1, 2])
@pytest.mark.parametrize("albedo", [0.0, 1.0])
@pytest.mark.parametrize("share", [0.05, 0.5])
def test_before_near_walls_the_small_table_is_all_of_the_air(
    gl_backend, tmp_path, monkeypatch, albedo, share, bodies
):
    """Black and white walls at parts of its reach, from below the horizon to above: within 1e-3 of
    what is seen, or 1e-4 of the sky."""
    volume = planet_air()
    if bodies == 2:
        moon = SecondLight(light=volume.light, radiance_scale=2.0, direction=(-0.6, 0.0, -0.8))
        volume = msgspec.structs.replace(volume, second=moon)
    distance_m = share * reach_m(volume)
    backend = gl_backend(size_px=(48, 32))
    backend.change(scene=opened(scene_of(tmp_path, wall(distance_m, albedo))))
    show_light(backend, uniform_sky(4.0))
    backend.hear(air_of(volume))
    view = EYE, np.add(EYE, (0.1, 0.05, -1.0)), 0.6
    near = look(backend, *view).radiance
    monkeypatch.setattr(AirPart, "air_defines_on", lambda *_: ())
    whole = look(backend, *view).radiance
    np.testing.assert_allclose(near, whole, rtol=1e-3, atol=4e-4)
    assert np.any(near != whole)


def test_glass_in_air_is_drawn_again(gl_backend, tmp_path):
    """The blending of glass does not outlast it: the small table has two targets, which cannot be
    blended so. The second picture is the first."""
    backend = gl_backend(size_px=(32, 32))
    pane = material(transmission={"transmissionFactor": 1.0})
    backend.change(scene=opened(square(tmp_path, pane)))
    backend.hear(air_of(planet_air()))
    show_light(backend, uniform_sky(4.0))
    view = (0.0, 2.0, 0.5), (0.0, 0.0, 0.0), 0.3
    first, second = (look(backend, *view).radiance for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_near_is_where_air_is_thin_and_alike():
    """By the thickest channel; nowhere for an eye in space, nor where each slice differs."""
    even = volume_of(EXTINCTION_PER_M, 1.0, **PLANET)
    assert reach_m(even) == pytest.approx(0.02 / 15e-5, rel=1e-5)
    assert reach_m(volume_of(EXTINCTION_PER_M, 1.0, **PLANET | {"observer_altitude_m": 1e6})) == 0.0
    ragged = EXTINCTION_PER_M * np.array([1.0, 3.0] * 4)[:, None, None]
    assert reach_m(volume_of(ragged, 1.0, **PLANET)) < 0.1 * reach_m(even)
