"""The page's own script, run by Node.js, against what it repeats of the program.

Without Node.js, or npm's packages in .page (`sh tools/bootstrap.sh page`), these are skipped.
"""

import contextlib
import subprocess
from datetime import UTC, datetime, timedelta
from pathlib import Path

import moderngl
import numpy as np
import pytest
from dynamic_skylight import sun_position
from full_screen import full_screen
from share.air_table import BELOW, VIEWS
from share.page_file import packed
from share.page_sky import about_places, about_sky
from share.page_stars import world_from_sky
from share.shared_scene import SunSky
from share.sky_table import COLUMNS, LOWER, UPPER, sky_table
from share.sun_coefficients import sun_coefficients
from share.sun_places import SunPlaces, equatorial

from vrut_lite.atmosphere.refraction import pressure_at_altitude_pa
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.pictures.exposure import metered_cd, metered_ev100
from vrut_lite.pictures.night_eye import adapted_cd

PLACES = ((50.0755, 14.4378, 200.0), (-33.9, 18.4, 20.0), (69.6, 18.9, 0.0))


def test_the_sun_stands_where_the_programs_sun_stands(node):
    """To 0.003 degrees, refraction included: both use astronomy-engine's ephemeris."""
    hours = [datetime(2026, 1, 3, tzinfo=UTC) + timedelta(hours=37.3 * k) for k in range(60)]
    for latitude, longitude, altitude in PLACES:
        place = {
            "latitude_deg": latitude,
            "longitude_deg": longitude,
            "altitude_m": altitude,
            "north_offset_rad": 0.0,
            "pressure_pa": pressure_at_altitude_pa(altitude),
        }
        given = {"place": place, "ms": [hour.timestamp() * 1000.0 for hour in hours]}
        script = """
            import { Ephemeris } from './src/sun.js';
            const ephemeris = new Ephemeris(given.place, null);
            console.log(JSON.stringify(given.ms.map((ms) => ephemeris.sun(new Date(ms)))));
        """
        for found, hour in zip(node(script, given), hours, strict=True):
            true = sun_position(hour, latitude, longitude, altitude_m=altitude)
            assert found["trueRad"] == pytest.approx(true.elevation_rad, abs=5e-5)
            assert found["apparentRad"] == pytest.approx(true.apparent_elevation_rad, abs=5e-5)
            turn = (found["azimuthRad"] - true.azimuth_rad + np.pi) % (2.0 * np.pi) - np.pi
            assert abs(turn) * np.cos(true.elevation_rad) < 5e-5
            # The places of light are found by declination and hour angle.
            by_angles = equatorial(true.elevation_rad, true.azimuth_rad, np.radians(latitude))
            assert found["declination"] == pytest.approx(by_angles[0], abs=2e-4)
            apart = (found["hour"] - by_angles[1] + np.pi) % (2.0 * np.pi) - np.pi
            assert abs(apart) < 3e-4


def test_a_picture_is_exposed_as_the_program_exposes_it(node):
    """Rooms with a window, streets and nights, to a hundredth of a stop."""
    random = np.random.default_rng(5)
    pictures = []
    for level in (1e-7, 1e-4, 0.1, 5.0, 80.0):
        values = level * random.lognormal(0.0, 1.2, 3000)
        values[: random.integers(1, 900)] *= 300.0
        pictures.append((np.sort(values).astype(np.float32), float(level * random.uniform(1, 9))))
    script = """
        import { adaptedCd, automaticEv } from './src/exposure.js';
        const found = given.map(([values, white]) => automaticEv(Float32Array.from(values), white));
        console.log(JSON.stringify(found.map((ev) => [ev, adaptedCd(ev)])));
    """
    found = node(script, [[values.tolist(), white] for values, white in pictures])
    for (ev, field_cd), (values, white) in zip(found, pictures, strict=True):
        assert ev == pytest.approx(metered_ev100(values, white), abs=0.01)
        assert field_cd == pytest.approx(adapted_cd(ev, "eye") or 0.0)
    assert {bool(field) for _, field in found} == {True, False}
    assert metered_cd(12.0, "eye") > 0.0


def test_light_is_interpolated_between_the_same_places(node):
    places = SunPlaces(float(np.radians(50.0)), 0.2)
    random = np.random.default_rng(6)
    suns = []
    for _ in range(40):
        elevation, azimuth = random.uniform(-0.4, 1.1), random.uniform(0.0, 2.0 * np.pi)
        declination, hour = equatorial(elevation, azimuth, places.latitude_rad)
        suns.append(
            {"trueRad": elevation, "northRad": azimuth, "declination": declination, "hour": hour}
        )
    script = """
        import { placeWeights } from './src/places.js';
        console.log(JSON.stringify(given.suns.map((sun) => placeWeights(given.places, sun))));
    """
    found = node(script, {"places": about_places(places), "suns": suns})
    for pairs, sun in zip(found, suns, strict=True):
        one, other = np.zeros((2, len(places.heights)))
        for place, weight in pairs:
            one[place] += weight
        for place, weight in places.weights(sun["trueRad"], sun["northRad"]):
            other[place] += weight
        assert one == pytest.approx(other, abs=1e-9)


def test_coefficients_of_the_suns_places_are_summed_alike(node):
    """Changes of either sign, in one byte and in two, from the very bytes of a page."""
    random = np.random.default_rng(8)
    values = random.normal(size=(6, 4, 2, 3)) * [[[1.0]], [[30.0]], [[1e-3]], [[0.0]]]
    spread = random.uniform(0.5, 9.0, (4, 2))
    coded = sun_coefficients(values.astype(np.float32), spread)
    script = """
        import { summed } from './src/light.js';
        const whole = summed(new Uint8Array(readFileSync('content.bin')), given.count);
        console.log(JSON.stringify(Array.from(whole)));
    """
    found = node(script, {"count": 24}, coded.codes.tobytes())
    made = np.reshape(found, values.shape) * coded.step[..., None]
    assert np.abs(coded.codes[1]).max() > 0
    assert made == pytest.approx(coded.decoded(), rel=1e-6)


def test_the_skys_table_is_read_alike(node):
    """Radiance in any direction, from the very bytes of a page."""
    skies = []
    for height in (-0.2, 0.0, 0.3, 1.0):
        direction = texel_directions(32)
        cube = np.exp(3.0 * direction @ np.array([0.6, 0.5, -0.62]))[..., None] * [1.0, 2.0, 3.0]
        key = np.full(3, max(height, 0.0))
        skies.append(
            SunSky(height, height, 0.8, cube.astype(np.float32), key, np.ones(3), np.ones(3))
        )
    table = sky_table(skies)
    random = np.random.default_rng(7)
    directions = random.normal(size=(50, 3))
    directions[:, 1] = np.abs(directions[:, 1])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    arrays = {
        "sky": table.radiance.view(np.uint16),
        "air": np.zeros((4, BELOW + LOWER + UPPER, COLUMNS, 4), np.uint16),
        "optical_depth": np.zeros((VIEWS, 3), np.uint16),
        "glow": np.zeros((2, 2, 2, 3), np.uint16),
    }
    content = packed({"sky": about_sky(table), "glow_scale": 1.0}, arrays)
    script = """
        import { PageData } from './src/data.js';
        import { SkyTable } from './src/sky.js';
        const bytes = readFileSync('content.bin');
        const start = bytes.byteOffset;
        const table = new SkyTable(new PageData(bytes.buffer.slice(start, start + bytes.length)));
        const body = { trueRad: 0.17, apparentRad: 0.17, azimuthRad: 2.0, share: [1, 1, 1] };
        const found = new Float64Array(3 * given.length);
        table.addRadiance(body, given.map(([x, y, z]) => ({ x, y, z })), found);
        console.log(JSON.stringify(Array.from(found)));
    """
    found = np.reshape(node(script, directions.tolist(), content), (-1, 3))
    assert found == pytest.approx(table.sky(directions, 0.17, 2.0), rel=1e-3)


class RandomMap:
    """Random codes, steps, weights and coefficients of a map, some of whose texels are unused."""

    clusters, terms, components, height, width = 4, 8, 5, 6, 7
    power, codes_per_stop, least = 1.7, 16.0, 0.1

    def __init__(self):
        random = np.random.default_rng(3)
        self.area = self.height * self.width
        self.planes = random.integers(0, 256, (4 + self.components, self.area), dtype=np.uint8)
        self.planes[0, ::5] = 0
        self.planes[1] = random.integers(0, self.clusters, self.area)
        self.wholes = random.integers(-32640, 32641, (self.terms, self.area), dtype=np.int16)
        self.wholes[1:] //= 250
        self.coefficients = random.normal(size=(self.clusters, self.terms, 3)) / 100.0
        self.coefficients[:, 0] /= 250.0
        self.weights = random.normal(size=self.components) * 0.3
        self.chosen = random.integers(0, 2, self.area)

    def expected(self):
        """Light and the sky's share (area, 4), in double precision."""
        share = (self.planes[4:].astype(float) - 128.0) / 127.0
        decoded = np.sign(share) * np.abs(share) ** self.power
        light = np.einsum("ka,akc->ac", self.wholes, self.coefficients[self.planes[1]])
        light *= 2.0 ** ((self.planes[0] - 255.0) / self.codes_per_stop)[:, None]
        mean = ((256.0 * self.planes[2] + self.planes[3]) / 65535.0) ** 2
        seen = mean * np.maximum(1.0 + self.weights @ decoded, self.least)
        found = np.column_stack([np.maximum(light, 0.0), seen])
        found[self.planes[0] == 0] = 0.0
        assert (found[:, :3].max(axis=1) > 0.0).any()
        return found

    def coefficients_of_four(self):
        return np.pad(self.coefficients, ((0, 0), (0, 0), (0, 1)))


def test_a_processors_sum_of_the_basis_is_that_of_its_codes(node):
    """To a half's precision, from the very bytes of a page."""
    given = RandomMap()
    shifted = given.wholes.astype(np.int32) + 128
    low_high = np.stack([shifted & 255, (shifted >> 8) + 128]).astype(np.uint8)
    about = {
        "terms": given.terms, "share_components": given.components, "power": given.power,
        "codes_per_stop": given.codes_per_stop, "share_least": given.least,
    }  # fmt: skip
    passed = {
        "about": about,
        "size": [given.width, given.height],
        "values": given.coefficients_of_four().ravel().tolist(),
        "weights": given.weights.tolist(),
        "chosen": given.chosen.tolist(),
    }
    script = """
        import { MapSum, wholes } from './src/light.js';
        import { halfValue } from './src/data.js';
        const content = readFileSync('content.bin');
        const first = (4 + given.about.share_components) * given.size[0] * given.size[1];
        const planes = content.subarray(0, first), steps = wholes(content.subarray(first));
        const sum = new MapSum(given.about, planes, steps, ...given.size);
        const seen = () => Array.from(sum.halves, halfValue);
        sum.choose(Uint8Array.from(given.chosen));
        sum.update(Float64Array.from(given.values), Float64Array.from(given.weights));
        const some = seen();
        sum.complete();
        console.log(JSON.stringify([some, seen()]));
    """
    content = given.planes.tobytes() + low_high.tobytes()
    some, found = np.reshape(node(script, passed, content), (2, given.area, 4))
    assert found == pytest.approx(given.expected(), rel=2e-3, abs=1e-6)
    # A moving picture has the sums of those texels alone that it shows.
    assert some == pytest.approx(found * given.chosen[:, None], rel=1e-6)


@pytest.mark.gl
def test_a_cards_sum_of_the_basis_is_that_of_its_codes(node, gl_owner):
    """To a half's precision, by the page's own shader."""
    given = RandomMap()
    script = """
        import { FULL_SCREEN, LIGHT_FRAGMENT } from './src/shaders.js';
        console.log(JSON.stringify([FULL_SCREEN, LIGHT_FRAGMENT]));
    """
    vertex, fragment = node(script, None)
    defines = {
        "TERMS": given.terms, "COMPONENTS": given.components,
        "CODES": f"{given.codes_per_stop:.4f}", "POWER": f"{given.power:.4f}",
        "LEAST_RATIO": f"{given.least:.4f}",
    }  # fmt: skip
    head = "\n".join(["#version 300 es", *(f"#define {k} {v}" for k, v in defines.items()), ""])

    def drawn(context):
        with contextlib.ExitStack() as kept:

            def made(resource):
                kept.callback(resource.release)
                return resource

            def layered(planes, dtype):
                layers = -(-len(planes) // 4)
                padded = np.zeros((4 * layers, given.area), planes.dtype)
                padded[: len(planes)] = planes
                content = padded.reshape(layers, 4, -1).transpose(0, 2, 1).tobytes()
                size = given.width, given.height, layers
                return made(context.texture_array(size, 4, content, alignment=1, dtype=dtype))

            program = made(
                context.program(vertex_shader=head + vertex, fragment_shader=head + fragment)
            )
            rows = given.coefficients_of_four().astype(np.float32).tobytes()
            textures = {
                "basis": layered(given.planes, "f1"),
                "terms": layered(given.wholes, "i2"),
                "coefficients": made(
                    context.texture((given.terms, given.clusters), 4, rows, dtype="f4")
                ),
            }
            for unit, (name, texture) in enumerate(textures.items()):
                texture.filter = moderngl.NEAREST, moderngl.NEAREST
                texture.use(unit)
                program[name] = unit
            program["share_weights"] = given.weights.tolist()
            return full_screen(context, made, program, (given.width, given.height))

    found = gl_owner.call(drawn)
    assert found == pytest.approx(given.expected(), rel=1e-3, abs=1e-4)


def test_the_sky_of_stars_turns_as_the_programs(node):
    """North and south, with the scene turned from north, at any hour of a star's day."""
    cases = [(1.3, 0.87, 0.0), (4.0, -0.6, 0.7), (0.0, 1.5, -2.0)]
    script = """
        import { worldFromSky } from './src/stars.js';
        console.log(JSON.stringify(given.map((one) => worldFromSky(...one))));
    """
    for found, case in zip(node(script, cases), cases, strict=True):
        assert np.reshape(found, (3, 3)) == pytest.approx(world_from_sky(*case), abs=1e-12)


def test_the_scripts_types_hold():
    """By TypeScript, from the comments; only where `tools/bootstrap.sh long` has installed it."""
    page = Path(__file__).parents[2] / ".page"
    compiler = page / "node_modules" / ".bin" / "tsc"
    if not compiler.exists():
        pytest.skip("needs npm's typescript and @types/three: sh tools/bootstrap.sh long")
    done = subprocess.run(
        [compiler, "--project", page], cwd=page, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout
