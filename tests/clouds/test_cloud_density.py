"""The shaders' clouds are those of model/cloud_density.py: density and shadow, point by point."""

import msgspec
import numpy as np
import pytest
from cloud_stage import rough_layer
from clouds.drawing.layer_textures import SHADERS
from clouds.model.cloud_density import density, sun_transmittance
from clouds.model.cloud_density_kernels import density_at
from clouds.model.cloud_field import cloud_field
from clouds.model.cloud_light import ClearLight

from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.render.shader_files import shader_source
from vrut_lite.render.tiles import Patience

pytestmark = pytest.mark.gl
EYE = np.array([4321.0, 700.0, -98765.0])
SUN = (0.36, 0.8, 0.48)
LIGHT = ClearLight(SUN, (90.0, 80.0, 70.0), np.zeros((25, 3)))
COUNT = 512


def probe(context, body):
    """A compute shader that gives a number for each point of a buffer."""
    names = "cloud_density.glsl", "cloud_textures.glsl", "sun_factor.glsl"
    sources = [shader_source(SHADERS / name) for name in names]
    return context.compute_shader(
        "\n".join(
            [
                "#version 430 core",
                "layout(local_size_x = 64) in;",
                *reversed(sources),
                "layout(std430, binding = 3) readonly buffer Points { vec4 points[]; };",
                "layout(std430, binding = 4) writeonly buffer Out { float values[]; };",
                "void main() { uint i = gl_GlobalInvocationID.x; vec4 p = points[i];",
                f"  values[i] = {body}; }}",
            ]
        )
    )


def ask(owner, layer, points, body):
    """What GLSL says at points (n, 4), the cloud shadow map bound."""

    def work(context):
        from clouds.drawing.cloud_shadow import CloudShadowMap
        from clouds.drawing.layer_textures import CloudsOnGpu, CloudSurroundings

        from vrut_lite.render.frame_parts import PartRenderer

        counters = WorkCounters()
        gl = PartRenderer(context, counters, Patience(counters), print)
        clouds, shadow = CloudsOnGpu(gl), CloudShadowMap(gl)
        clouds.show(layer)
        assert shadow.bind([clouds], [LIGHT], np.zeros(3), CloudSurroundings(EYE, 0.0, 1e-3))
        clouds.bind_noises()
        shader = probe(context, body)
        given = context.buffer(points.astype(np.float32).tobytes())
        out = context.buffer(reserve=4 * len(points))
        given.bind_to_storage_buffer(3)
        out.bind_to_storage_buffer(4)
        shader.run(len(points) // 64)
        values = np.frombuffer(out.read(), np.float32).astype(float)
        context.simple_framebuffer((1, 1)).use()
        for thing in (clouds, shadow, shader, given, out, gl):
            thing.release()
        return values

    return owner.call(work)


def test_density_is_its_twins(gl_owner):
    """To 2 %: 8-bit noise, filtered with the GPU's 8 bits of sub-texel, times a sharpness of 5.

    The wind has blown for 56 years: float32 must not feel it.
    """
    layer = rough_layer(drift_m=(1.4e10 + 0.25, -3.2e9))
    random = np.random.default_rng(8)
    level = random.uniform(-20e3, 20e3, (COUNT, 2))
    over_base = random.uniform(20.0, 980.0, COUNT)
    points = np.column_stack([level, over_base, np.zeros(COUNT)])
    values = ask(gl_owner, layer, points, "cloud_density_at(p.xy, p.z, 0.0)")
    flat = np.column_stack([level[:, 0], layer.base_m - EYE[1] + over_base, level[:, 1]])
    # The shader was given the height over the base, the twin takes points: the planet bends.
    flat[:, 1] -= (level**2).sum(axis=1) / (2.0 * 6.36e6)
    twin = density(layer, EYE + flat, EYE)
    assert 0.1 < (twin > 0.0).mean() < 0.9
    assert np.abs(values - twin).max() < 0.1
    assert np.abs(values - twin).mean() < 0.005


def test_shadows_are_the_twins(gl_owner):
    """Transmittance along the sun at points on the ground: 0.05 in the mean.

    The map has texels of 16 m and more where the twin is sharp.
    """
    layer = rough_layer()
    random = np.random.default_rng(9)
    level = random.uniform(-3e3, 3e3, (64, 2))
    points = np.column_stack([level[:, 0], np.full(64, -690.0), level[:, 1], np.zeros(64)])
    values = ask(gl_owner, layer, points, "sun_factor(p.xyz)")
    twin = np.array([sun_transmittance(layer, EYE + point[:3], SUN) for point in points])
    assert twin.min() < 0.2
    assert twin.max() > 0.9
    assert np.abs(values - twin).mean() < 0.05


def test_a_point_in_the_layer_has_its_share(gl_owner):
    """Above the layer nothing is shaded, at half its height half the depth counts."""
    layer = msgspec.structs.replace(rough_layer(), threshold=-1.0, extinction_per_m=2e-3)
    heights = np.repeat([layer.base_m - 10.0, layer.base_m + 500.0, 2010.0], 64)
    level = np.tile(np.random.default_rng(2).uniform(-50.0, 50.0, (64, 2)), (3, 1))
    sun = np.array(SUN)
    # Three points on each of 64 rays to the sun.
    level = level + (heights - layer.base_m)[:, None] * (sun[[0, 2]] / sun[1])
    points = np.column_stack([level[:, 0], heights - EYE[1], level[:, 1], np.zeros(192)])
    below, inside, above = ask(gl_owner, layer, points, "sun_factor(p.xyz)").reshape(3, 64)
    np.testing.assert_allclose(inside, np.sqrt(below), rtol=0.02)
    np.testing.assert_allclose(above, 1.0)


@pytest.mark.parametrize("width_m", [30.0, 2000.0])
def test_density_of_a_wide_sample_is_the_cpus(gl_owner, width_m):
    """Mean density within a sample's width is the CPU kernels', as closely as at a point."""
    layer = rough_layer()
    random = np.random.default_rng(5)
    level, over_base = random.uniform(-20e3, 20e3, (COUNT, 2)), random.uniform(20.0, 980.0, COUNT)
    points = np.column_stack([level, over_base, np.zeros(COUNT)])
    values = ask(gl_owner, layer, points, f"cloud_density_at(p.xy, p.z, {width_m})")
    field = cloud_field(layer, EYE)
    places = zip(level, over_base, strict=True)
    twin = np.array([density_at(field, x, z, height, width_m) for (x, z), height in places])
    assert twin.max() > 0.3
    assert np.abs(values - twin).max() < 0.1
    assert np.abs(values - twin).mean() < 0.005
