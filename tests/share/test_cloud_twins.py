"""The page's frozen clouds, by Node.js and by its shader, against the program's maps."""

import base64
import contextlib

import moderngl
import numpy as np
import pytest
from full_screen import full_screen
from scipy.ndimage import gaussian_filter
from share.cloud_maps import COARSE, COMPONENTS, FINE, GLOW_NODES, CloudMaps
from share.page_file import packed
from share.page_sky import about_clouds, cloud_arrays
from share.shared_scene import direction_of
from share.sun_places import SunPlaces, equatorial

PLACES = SunPlaces(0.87, 0.3, declinations=3, hours=24, dusk_azimuths=4)
HEIGHT, NORTH = 0.5, 2.0
SUN = np.array(direction_of(NORTH - PLACES.north_offset_rad, HEIGHT))
KEY = np.array([3.0, 2.5, 2.0])
LEVEL = np.array([1.5, 1.7, 2.0])
NIGHT, SCALE = 0.25, 0.5


@pytest.fixture(scope="module")
def maps():
    """Random maps without steps between nodes, with terms of one byte and of two."""
    random = np.random.default_rng(4)

    def smooth(edge):
        found = gaussian_filter(random.normal(size=(edge, edge)), 5.0)
        return (found - found.min()) / np.ptp(found)

    terms = np.stack([smooth(COARSE) - 0.5 for _ in range(COMPONENTS)])
    terms[0] *= 60000.0
    terms[1:] *= 200.0
    by_sun = random.normal(size=(len(PLACES.heights), COMPONENTS, 3))
    by_night = random.normal(size=(COMPONENTS, 3))
    by_sun[:, 0] /= 3e4
    by_night[0] /= 3e4
    glow = np.broadcast_to(random.uniform(0.0, 9.0, (GLOW_NODES, 3)), (2, GLOW_NODES, 3))
    return CloudMaps(
        places=PLACES,
        passed=(65535.0 * smooth(FINE)).astype(np.uint16),
        kept=(255.0 * smooth(FINE)).astype(np.uint8),
        finer=(255.0 * smooth(FINE)).astype(np.uint8),
        terms=terms.astype(np.int16),
        by_sun=(by_sun / 50.0).astype(np.float32),
        by_night=(by_night / 50.0).astype(np.float32),
        glow=np.ascontiguousarray(glow, np.float32),
    )


@pytest.fixture(scope="module")
def upper():
    found = np.random.default_rng(7).normal(size=(400, 3))
    found[:, 1] = np.abs(found[:, 1])
    # Some beside the sun, where the glow is steep.
    found[:100] = SUN + 0.1 * found[:100]
    return found / np.linalg.norm(found, axis=1, keepdims=True)


@pytest.fixture(scope="module")
def clear(upper):
    return np.random.default_rng(8).uniform(0.0, 4.0, upper.shape)


@pytest.fixture(scope="module")
def expected(maps, upper, clear):
    """Radiance behind the clouds under a sun and a share of the night."""
    own = maps.coefficients(HEIGHT, NORTH) * LEVEL + NIGHT * maps.by_night
    found = maps.sky(upper, clear, own, [(SUN, KEY)])
    assert (found > 0.0).mean() > 0.6
    return found


def lit(node, maps, script, given):
    """The output of a script about a page's clouds, read from the bytes of the page."""
    declination, hour = equatorial(HEIGHT, NORTH, PLACES.latitude_rad)
    body = {"trueRad": HEIGHT, "northRad": NORTH, "declination": declination, "hour": hour}
    body |= {"share": [1, 1, 1], "towards": SUN.tolist(), "rays": KEY.tolist()}
    light = """
        import { PageData } from './src/data.js';
        import { Clouds } from './src/clouds.js';
        import * as THREE from 'three';
        const bytes = readFileSync('content.bin'), start = bytes.byteOffset;
        const data = new PageData(bytes.buffer.slice(start, start + bytes.length));
        const clouds = new Clouds(data, { level: () => given.level });
        given.body.towards = new THREE.Vector3(...given.body.towards);
        clouds.update([given.body], given.night, given.scale);
    """
    told = {"body": body, "level": LEVEL.tolist(), "night": NIGHT, "scale": SCALE, **given}
    return node(light + script, told, packed({"clouds": about_clouds(maps)}, cloud_arrays(maps)))


def test_clouds_are_put_before_the_sky_alike(node, maps, upper, clear, expected):
    """By the sum that lights the page's open ground."""
    script = """
        const towards = given.directions.map((d) => new THREE.Vector3(...d));
        const radiance = Float64Array.from(given.clear);
        clouds.cover(clouds.seen(towards), radiance);
        const passed = towards.map((d) => clouds.transmittance(d));
        console.log(JSON.stringify([Array.from(radiance), passed]));
    """
    given = {"directions": upper.tolist(), "clear": clear.ravel().tolist()}
    radiance, passed = lit(node, maps, script, given)
    assert np.reshape(radiance, (-1, 3)) == pytest.approx(expected, rel=2e-3, abs=2e-3)
    assert passed == pytest.approx(maps.transmittance(upper), abs=1e-5)


@pytest.mark.gl
def test_a_picture_has_the_same_clouds(node, gl_owner, maps, upper, clear, expected):
    """By the page's own shader and its textures, whose weights a processor rounds to bytes."""
    script = """
        import { FULL_SCREEN, HEAD, SKY } from './src/shaders.js';
        const halves = {}, { uniforms, defines } = clouds;
        for (const name of ['cloud_about', 'cloud_light', 'cloud_glow']) {
            const { data, width, height } = uniforms[name].value.image;
            halves[name] = [Buffer.from(data.buffer).toString('base64'), width, height];
        }
        const [first] = SKY.split('vec3 sky_radiance');
        console.log(JSON.stringify([FULL_SCREEN, HEAD, first, defines, halves]));
    """
    vertex, head, sky, defines, halves = lit(node, maps, script, {})
    lines = "\n".join(["#version 300 es", *(f"#define {k} {v}" for k, v in defines.items()), ""])
    main = """
        uniform sampler2D directions, clear;
        out vec4 colour;
        void main() {
            ivec2 p = ivec2(gl_FragCoord.xy);
            vec3 sky = texelFetch(clear, p, 0).rgb;
            colour = vec4(behind_clouds(sky, texelFetch(directions, p, 0).rgb), 1.0);
        }
    """
    others = {"COLUMNS": "48.0", "ROWS": "48.0", "LOWER": "16.0"}
    lines += "".join(f"#define {name} {value}\n" for name, value in others.items())
    size = len(upper), 1

    def drawn(context):
        with contextlib.ExitStack() as kept:

            def made(resource):
                kept.callback(resource.release)
                return resource

            program = made(
                context.program(
                    vertex_shader=lines + vertex, fragment_shader=lines + head + sky + main
                )
            )
            textures = {
                name: made(context.texture(size, 3, values.astype("f4").tobytes(), dtype="f4"))
                for name, values in (("directions", upper), ("clear", clear))
            }
            for name, (content, width, height) in halves.items():
                texels = base64.b64decode(content)
                textures[name] = made(context.texture((width, height), 4, texels, dtype="f2"))
                textures[name].repeat_x = textures[name].repeat_y = False
            for unit, (name, texture) in enumerate(textures.items()):
                smooth = moderngl.LINEAR if name in halves else moderngl.NEAREST
                texture.filter = smooth, smooth
                texture.use(unit)
                program[name] = unit
            program["cloud_scale"] = 1.0 / SCALE
            program["body_count"] = 1
            program["cloud_suns"] = [tuple(SUN), (0.0, 1.0, 0.0)]
            program["cloud_rays"] = [tuple(KEY), (0.0, 0.0, 0.0)]
            return full_screen(context, made, program, size)

    found = gl_owner.call(drawn)[:, :3]
    assert found == pytest.approx(expected, rel=0.02, abs=0.1)
