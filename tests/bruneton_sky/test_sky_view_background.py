"""The view from aloft, pixel by pixel: the shader in a frame against the table in float64."""

from functools import lru_cache

import msgspec
import numpy as np
import pytest
import trimesh
from bruneton_sky import Atmosphere
from bruneton_sky.background import (
    Surroundings,
    ambient_coefficients,
    background_cube,
    surroundings,
)
from bruneton_sky.light import background_with
from bruneton_sky.sky_view import SkyView, level_direction
from bruneton_sky.sky_view.table_on_card import table_on_card, table_view_shader
from bruneton_sky.solver import SolverSizes, SourceField, solve
from bruneton_sky.sun_light import disc_light
from directions import towards
from numpy.typing import NDArray
from stateful_backend import StatefulBackend, opened

from vrut_lite.array import Array
from vrut_lite.errors import UserError
from vrut_lite.message_codec import arrays_of, decode, to_plain
from vrut_lite.messages.camera import MoveCamera, look_at
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.render.still_picture import FEWER_SHIFTS_PX
from vrut_lite.sky.sky_of_hour import SunDisc

COARSE = SolverSizes(
    altitude=8, mu_s=8, direction_mu=8, direction_azimuth=8, degree=4, source_mu=8,
    source_azimuth=4, steps=12, node_bins=6, single_bins=12, multiple_bins=6,
)  # fmt: skip
WIDTH, HEIGHT, FIELD_OF_VIEW_RAD = 160, 90, 0.8
RADIUS_RAD = Atmosphere.earth().sun_angular_radius_rad


@lru_cache(maxsize=1)
def field() -> SourceField:
    """A coarsely solved Earth: any numbers will do."""
    return solve(Atmosphere.earth(), 2, COARSE)


def direction(elevation_deg: float, azimuth_deg: float = 25.0) -> NDArray[np.float64]:
    return towards(elevation_deg, azimuth_deg)


def looked_up(view: SkyView, d: NDArray[np.float64]) -> NDArray[np.float64]:
    """Radiance (..., 3) of the table in directions (..., 3): bilinear between fourth roots, in
    float64, as the docstrings of `sky_view` and `rays` have it."""
    above, below, columns = view.shape
    level = d[..., 0] ** 2 + d[..., 2] ** 2
    total = 1.0 + np.abs(d[..., 1])
    height = np.where(d[..., 1] < 0.0, level / total, total) - view.depth[0]
    up = height >= 0.0
    share = np.where(up, height / (view.depth[1] - view.depth[0]), -height / view.depth[0])
    share = np.minimum(share, 1.0)
    bend = np.where(up, 0.5 if view.depth[1] <= 1.0 else 0.85, 1.0)
    x = np.where(share < bend, np.sqrt(share * bend), 1.0 - np.sqrt((1.0 - share) * (1.0 - bend)))
    row = x * np.where(up, above - 1, below - 1)
    i = np.minimum(row.astype(int), np.where(up, above, below) - 2)
    sun_azimuth = level_direction(view.sun_direction)
    chord = d[..., [0, 2]] / np.sqrt(level)[..., None] - sun_azimuth
    column = 0.5 * np.hypot(chord[..., 0], chord[..., 1]) * (columns - 1)
    k = np.minimum(column.astype(int), columns - 2)
    u, v = (row - i)[..., None], (column - k)[..., None]
    nodes = view.nodes.astype(float).reshape(above + below, columns, 8)
    i = np.where(up, i, i + above)
    near = nodes[i, k] * (1.0 - v) + nodes[i, k + 1] * v
    far = nodes[i + 1, k] * (1.0 - v) + nodes[i + 1, k + 1] * v
    light = (near * (1.0 - u) + far * u) ** 4
    nodes, place = (
        np.linspace(0.0, 1.0, len(view.bands.phase)),
        np.sqrt(0.5 - 0.5 * np.clip(d @ view.sun_direction, -1.0, 1.0)),
    )
    phase = np.stack([np.interp(place, nodes, band) for band in view.bands.phase.T], axis=-1)
    colour = view.bands.colour.astype(float)[:, :3]
    return np.maximum(light[..., :3] + (phase * light[..., 4:]) @ colour, 0.0)


@pytest.fixture(scope="module")
def backend(gl_owner, tmp_path_factory):
    """A frame in which there is nothing but the sky: the scene is behind the camera."""
    from vrut_lite.render.pyrender_backend import PyrenderBackend

    path = tmp_path_factory.mktemp("scene") / "dot.glb"
    trimesh.creation.box((0.01,) * 3).apply_translation((0.0, -900.0, 0.0)).export(path)
    backend = PyrenderBackend(gl_owner)
    yield StatefulBackend(backend, size_px=(WIDTH, HEIGHT), scene=opened(path))
    backend.close()


def background_message(around: Surroundings, size: int) -> BackgroundChanged:
    """The background that the module posts for these surroundings."""
    return background_with(around, background_cube(around, size)).message("test")


def show(backend, around: Surroundings, **changes) -> None:
    """Light the frame with these surroundings."""
    sun = tuple(map(float, around.view.sun_direction))
    background = msgspec.structs.replace(background_message(around, 16), **changes)
    key_light = SunDisc(around.sun_irradiance_rgb, RADIUS_RAD).message(sun, "test")
    ambient = AmbientChanged(irradiance_sh_rgb=Array(ambient_coefficients(around)), source="test")
    backend.change(background=background, key_light=key_light, ambient=ambient)
    backend.backend.prepare(backend.state)


def look(backend, pitch_deg, azimuth_deg=0.0, field_of_view_rad=FIELD_OF_VIEW_RAD):
    """Radiance (h, w, 3) of the picture, and the directions (h, w, 3) of its pixels."""
    target = 1000.0 * direction(pitch_deg, azimuth_deg)
    backend.change(
        moved_camera=MoveCamera(
            eye_m=(0.0, 0.0, 0.0),
            target_m=tuple(map(float, target)),
            vertical_field_of_view_rad=field_of_view_rad,
        )
    )
    return backend.draw().radiance, pixel_rays(target, field_of_view_rad)


def pixel_rays(target, field_of_view_rad, shift_px=(0.0, 0.0)):
    """Directions (h, w, 3) of what the pixels of a picture show, shifted so far right and up."""
    tangent = np.tan(0.5 * field_of_view_rad)
    x = (np.arange(WIDTH) + 0.5 + shift_px[0]) / WIDTH * 2.0 - 1.0
    y = 1.0 - (np.arange(HEIGHT) + 0.5 - shift_px[1]) / HEIGHT * 2.0
    across, up = np.meshgrid(x * tangent * WIDTH / HEIGHT, y * tangent)
    eye = np.stack([across, up, -np.ones_like(up)], axis=-1)
    rays = eye @ look_at(np.zeros(3), target)[:3, :3]
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


@pytest.mark.gl
@pytest.mark.parametrize("sun_deg", [40.0, 3.0, -6.0])
@pytest.mark.parametrize(
    ("height_m", "pitch_deg"), [(11.0, 0.0), (12_000.0, -3.0), (4e5, -19.0), (3e6, -47.0)]
)
def test_a_pixel_is_the_table_there(backend, height_m, pitch_deg, sun_deg):
    """Every pixel is the float64 look-up in its direction within 1e-3 of the larger of its value
    and a thousandth of the brightest, but for those that the horizon cuts, which are a mixture."""
    around = surroundings(field(), height_m, direction(sun_deg))
    show(backend, around)
    picture, rays = look(backend, pitch_deg)
    height = rays[..., 1] + 1.0 - around.view.depth[0]
    pixel = FIELD_OF_VIEW_RAD / HEIGHT
    whole = (np.abs(height) > 1.5 * pixel) & (
        rays @ around.view.sun_direction < np.cos(2.0 * RADIUS_RAD + pixel)
    )
    # A still is the mean of pictures that are shifted within a pixel.
    shown = (
        pixel_rays(direction(pitch_deg, 0.0), FIELD_OF_VIEW_RAD, each) for each in FEWER_SHIFTS_PX
    )
    exact = np.mean([looked_up(around.view, each) for each in shown], axis=0)
    error = np.abs(picture - exact) / np.maximum(exact, 1e-3 * exact.max())
    assert whole.mean() > 0.9
    assert error[whole].max() < 1e-3
    assert (height < 0.0).any()
    assert (height > 0.0).any()


@pytest.mark.gl
@pytest.mark.parametrize(("height_m", "pitch_deg"), [(12_000.0, -3.0), (4e5, -19.0)])
def test_a_pixel_is_the_same_where_a_card_makes_the_table(backend, height_m, pitch_deg):
    """As the sun moves, with nothing of the processor's table in the message; and after the shader
    has been away."""
    for sun_deg in (40.0, -6.0):
        around = surroundings(field(), height_m, direction(sun_deg))
        table = table_on_card(field(), height_m, direction(sun_deg))
        made = table_view_shader(table, around.disc)
        show(backend, around)
        expected, _ = look(backend, pitch_deg)
        for view in (made, None, made):
            show(backend, around, view=view)
        picture, _ = look(backend, pitch_deg)
        apart = np.abs(picture - expected) / np.maximum(expected, 1e-3 * expected.max())
        assert apart.max() < 1e-3
        assert sum(array.values.size for _, array in made.buffers) < around.view.nodes.size


@pytest.mark.gl
def test_a_table_that_no_driver_compiles_is_reported_and_the_cube_is_drawn(backend):
    """As a shader that does not."""
    around = surroundings(field(), 4e5, direction(30.0))
    show(backend, around, view=None)
    coarse, _ = look(backend, -19.0)
    made = table_view_shader(table_on_card(field(), 4e5, direction(30.0)), around.disc)
    (program,) = made.programs
    broken = msgspec.structs.replace(program, compute_shader="no GLSL")
    other = made.source + "\n"
    with pytest.raises(UserError, match="its cube map is shown instead"):
        show(backend, around, view=msgspec.structs.replace(made, source=other, programs=(broken,)))
    np.testing.assert_array_equal(look(backend, -19.0)[0], coarse)


@pytest.mark.gl
def test_the_cube_map_stays_for_reflections(backend):
    """With and without a shader the message's cube is the same; without, the picture is its."""
    around = surroundings(field(), 4e5, direction(30.0))
    show(backend, around)
    sharp, _ = look(backend, -19.0)
    show(backend, around, view=None)
    coarse, _ = look(backend, -19.0)
    assert np.abs(sharp - coarse).max() > 0.1 * sharp.max()
    assert background_message(around, 16).view is not None
    assert background_message(surroundings(field(), 2.0, direction(30.0)), 16).view is None


@pytest.mark.gl
def test_a_shader_that_does_not_compile_is_reported_once_and_the_cube_is_drawn(backend):
    """One sentence for one text; the picture is that of the cube map, then and later."""
    around = surroundings(field(), 4e5, direction(30.0))
    show(backend, around, view=None)
    coarse, _ = look(backend, -19.0)
    broken = msgspec.structs.replace(background_message(around, 16).view, source="no GLSL")
    with pytest.raises(UserError, match="its cube map is shown instead"):
        show(backend, around, view=broken)
    np.testing.assert_array_equal(look(backend, -19.0)[0], coarse)
    show(backend, around, view=broken)
    np.testing.assert_array_equal(look(backend, -19.0)[0], coarse)
    show(backend, around)
    assert np.abs(look(backend, -19.0)[0] - coarse).max() > 0.1 * coarse.max()


def solid_angle() -> float:
    return float(4.0 * np.pi * np.sin(0.5 * RADIUS_RAD) ** 2)


@pytest.mark.gl
def test_in_space_the_disc_is_whole(backend):
    """No air is before the sun: the mean of its disc is the solar irradiance above the air over
    its solid angle, within 2 % for pixels that the edge cuts."""
    air, sun = Atmosphere.earth(), direction(20.0)
    show(backend, surroundings(field(), 4e5, sun))
    picture, rays = look(backend, 20.0, 25.0, 0.02)
    inside = rays @ sun > np.cos(RADIUS_RAD)
    whole = disc_light(air, 4e5, float(sun[1])).irradiance_rgb[0]
    np.testing.assert_allclose(picture[inside].mean(axis=0), whole / solid_angle(), rtol=0.02)


@pytest.mark.gl
def test_the_planet_hides_the_sun(backend):
    """From 400 km the horizon is 19.8 degrees below the level: a sun at -19 shines through the
    limb, redder; of one at -21 nothing is left; of one on the horizon the upper half, exactly
    to the horizon."""
    ground_deg = -float(np.degrees(np.arccos(6360.0 / 6760.0)))
    discs = {}
    for sun_deg in (-10.0, -19.0, -21.0, ground_deg):
        sun = direction(sun_deg)
        around = surroundings(field(), 4e5, sun)
        show(backend, around)
        discs[sun_deg], rays = look(backend, sun_deg, 25.0, 0.02)
    brightest = {sun_deg: disc.max(axis=(0, 1)) for sun_deg, disc in discs.items()}
    sky = 100.0
    assert brightest[-10.0].min() > 1e5
    ratio = brightest[-19.0] / brightest[-10.0]
    assert ratio[0] > ratio[2]
    assert brightest[-21.0].max() < sky
    below = rays[..., 1] + 1.0 < around.view.depth[0] - 3e-4
    assert discs[ground_deg][below].max() < sky


def test_the_disc_s_light_is_that_of_the_air_before_it():
    """Continuous at the air's top, fading downward through the limb, and finite from anywhere up
    to the moon's distance, with its nodes in order."""
    air = Atmosphere.earth()
    inside, outside = (disc_light(air, h, 0.3).irradiance_rgb for h in (59_999.0, 60_001.0))
    np.testing.assert_allclose(inside, outside, rtol=1e-6)
    grazing = -np.sqrt(1.0 - (6_360.0 / 6_760.0) ** 2)
    through = disc_light(air, 4e5, grazing)
    assert (np.diff(through.irradiance_rgb, axis=0) >= 0.0).all()
    for height_m in (11.0, 60_000.0, 4e5, 4e8):
        for mu_s in (-1.0, -0.5, 0.0, 1.0):
            light = disc_light(air, height_m, mu_s)
            assert np.isfinite(light.irradiance_rgb).all()
            assert (np.diff(light.depth) > 0.0).all()


def test_a_journal_keeps_the_shader():
    """Recorded and read back, arrays and all."""
    around = surroundings(field(), 4e5, direction(30.0))
    background = background_message(around, 8)
    kept = {array.digest: array for array in arrays_of(background)}
    assert len(kept) == 4
    plain = msgspec.json.decode(msgspec.json.encode(to_plain(background)))
    assert decode(BackgroundChanged, plain, lambda handle: kept[handle["$array"]]) == background
