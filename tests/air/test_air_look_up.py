"""The shader's look-up of air against its twin in double precision."""

from pathlib import Path
from types import SimpleNamespace

import air
import numpy as np
import pytest
from air.air_textures import AirOnGpu
from air.near_air import second_light
from air_phases import lobe
from air_stage import EARTH_M, volume_of
from house_fixtures import filter_rounding

from vrut_lite.array import Array
from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.air import SecondLight
from vrut_lite.sky.air_volume import look_up_air

pytestmark = pytest.mark.gl
SHADERS = Path(air.__file__).parent / "shaders"
PROBE = """
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Rays { vec4 rays[]; };
layout(std430, binding = 2) writeonly buffer Light { vec4 light[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    AirLight found = air_before(air_ray(rays[i].xyz), rays[i].w);
    light[3u * i] = vec4(found.transmittance, 0.0);
    light[3u * i + 1u] = vec4(found.shaded, 0.0);
    light[3u * i + 2u] = vec4(found.sunlit, ground_distance_m(rays[i].xyz));
}
"""


def frame_at(eye_m, ground_level_m):
    """The picture's data that the look-up needs."""
    return SimpleNamespace(
        view=SimpleNamespace(eye_m=np.array([0.0, eye_m, 0.0])),
        size_px=(1, 1),
        ground_level_m=ground_level_m,
        ground_is_bare=True,
        shadow=None,
    )


def on_gpu(owner, volume, rays, ground_level_m=0.0):
    """What the shader finds for rays (n, 4), direction and distance: (n, 3, 4)."""
    from vrut_lite.render.frame_parts import PartRenderer
    from vrut_lite.render.shader_files import defined, shader_source
    from vrut_lite.render.tiles import Patience

    def work(context):
        counters = WorkCounters()
        textures = AirOnGpu(PartRenderer(context, counters, Patience(counters), print))
        textures.show(volume)
        textures.bind(frame_at(volume.observer_altitude_m, ground_level_m))
        source = "#version 430 core\n" + shader_source(SHADERS / "air.glsl") + PROBE
        probe = context.compute_shader(defined(source, dict.fromkeys(second_light(volume), 1)))
        given = context.buffer(rays.astype(np.float32).tobytes())
        found = context.buffer(reserve=48 * len(rays))
        given.bind_to_storage_buffer(1)
        found.bind_to_storage_buffer(2)
        probe.run(len(rays) // 64)
        light = np.frombuffer(found.read(), np.float32).reshape(-1, 3, 4).astype(float)
        for thing in (probe, given, found, textures):
            thing.release()
        return light

    return owner.call(work)


def random_volume(random, altitude_m, bodies=1):
    """Nodes that differ from their neighbours by as much as real ones do, in the light of one body
    or two."""
    nodes = {"slices": 24, "rows_above": 20, "rows_below": 16, "columns": 9}
    shape = (nodes["slices"], nodes["rows_above"] + nodes["rows_below"], nodes["columns"], 3)
    parts = {name: 8.0 + random.uniform(-2, 2, shape) for name in ("shaded", "direct", "aerosol")}
    extinction = 3e-5 * random.uniform(0.8, 1.2, (*shape[:2], 3))
    sun, moon = random.normal(size=(2, 3))
    second = None
    if bodies == 2:
        light = 4.0 + random.uniform(-1, 1, (3, *shape))
        second = SecondLight(
            light=Array(light.astype(np.float16)),
            radiance_scale=0.5,
            direction=tuple(moon / np.linalg.norm(moon)),
        )
    return volume_of(
        extinction,
        **parts,
        **nodes,
        radiance_scale=0.25,
        aerosol_phase=lobe(0.8, 0.01, 0.4, angles=1024),
        observer_altitude_m=altitude_m,
        reach_m=3e5,
        sun_direction=tuple(sun / np.linalg.norm(sun)),
        second=second,
    )


def directions(random, altitude_m, count):
    """Half anywhere, a quarter about the horizon, a quarter towards the planet."""
    far = EARTH_M / (EARTH_M + altitude_m)
    horizon = -np.sqrt(max(0.0, 1.0 - far * far))
    mu = np.concatenate(
        [
            random.uniform(-1, 1, count // 2),
            np.clip(horizon + random.normal(0, 0.02, count // 4), -1, 1),
            -np.sqrt(1.0 - (random.uniform(0, 1.01, count // 4) * far).clip(0, 1) ** 2),
        ]
    )
    turn = random.uniform(0, 2 * np.pi, mu.size)
    across = np.sqrt(1.0 - mu * mu)
    return np.stack([across * np.sin(turn), mu, -across * np.cos(turn)], axis=-1)


@pytest.mark.parametrize("bodies", [1, 2])
@pytest.mark.parametrize("altitude_m", [0.0, 1.7, 300.0, 12e3, 6e4, 61e3, 4e5, 3.6e7])
def test_the_shader_finds_what_the_twin_finds(gl_owner, altitude_m, bodies):
    """Any direction and distance, from the ground to a geostationary orbit: within 1e-3.

    Relative, or to light and transmittance behind much air (about 2, and 1); on a card also by the
    rounding of its filter on each of three axes, for neighbours that differ by 1.
    """
    random = np.random.default_rng(7)
    volume = random_volume(random, altitude_m, bodies)
    view = directions(random, altitude_m, 4096)
    # The rays as the shader gets them.
    view = view.astype(np.float32).astype(float)
    view /= np.linalg.norm(view, axis=-1, keepdims=True)
    metres = 10.0 ** random.uniform(-1, 8, len(view))
    metres = metres.astype(np.float32).astype(float)
    found = on_gpu(gl_owner, volume, np.concatenate([view, metres[:, None]], axis=-1))
    wanted = look_up_air(volume, view, metres)
    np.testing.assert_allclose(found[:, 0, :3], wanted.transmittance, atol=1e-3)
    for index, light in ((1, wanted.shaded), (2, wanted.sunlit)):
        within = 2e-3 + 3 * filter_rounding(gl_owner)
        np.testing.assert_allclose(found[:, index, :3], light, rtol=1e-3, atol=within)


def test_thin_air_keeps_its_relative_precision(gl_owner):
    """Before a thing at 0.1 m to 30 m the light added is k s d within 2e-3: no steps, no zero."""
    k, s = 2e-5, 40.0
    volume = volume_of(k, s)
    view = directions(np.random.default_rng(2), 1.7, 64)
    metres = np.geomspace(0.1, 30.0, len(view))
    found = on_gpu(gl_owner, volume, np.concatenate([view, metres[:, None]], axis=-1))
    np.testing.assert_allclose(found[:, 1, 0], k * s * metres, rtol=2e-3)


@pytest.mark.parametrize("altitude_m", [0.01, 1.7, 100.0, 3e3, 3e4, 4e5, 3.6e7])
def test_the_ground_is_where_the_sphere_is(gl_owner, altitude_m):
    """The distance to the planet, against float64: within 2e-3, and 5 % in the last thousandth.

    At the horizon distance goes like the root of the angle, of which single precision keeps 6e-8.
    """
    height, radius = altitude_m, EARTH_M
    edge = -np.sqrt(height * (2 * radius + height)) / (radius + height)
    below = edge - (1 + edge) * np.logspace(-5, -1, 32)
    mu = np.concatenate([np.linspace(-1.0, edge, 33)[:-1], below])
    view = np.stack([np.sqrt((1 - mu) * (1 + mu)), mu, 0 * mu], axis=-1).astype(np.float32)
    view = view.astype(float)
    found = on_gpu(
        gl_owner,
        volume_of(1e-5, 1.0, observer_altitude_m=altitude_m),
        np.concatenate([view, np.ones((len(mu), 1))], axis=-1),
    )[:, 2, 3]
    along = (radius + height) * view[:, 1]
    tangent = height * (2 * radius + height)
    wanted = tangent / (-along + np.sqrt(np.maximum(along * along - tangent, 0.0)))
    near = np.abs(view[:, 1] - edge) < 1e-3 * np.abs(edge)
    np.testing.assert_allclose(found[~near], wanted[~near], rtol=2e-3)
    np.testing.assert_allclose(found[near], wanted[near], rtol=0.05)
