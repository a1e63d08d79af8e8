"""Products of the card beside those of the processor: the worst texel, and its place.

Differences are over the larger of the processor's value and a hundredth of its largest.
"""

from collections.abc import Callable
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from bruneton_sky import preset, single_scattering
from bruneton_sky.air_volume import air_volume
from bruneton_sky.air_volume.gpu import air_volume_job
from bruneton_sky.published.gpu_pipeline import GpuPipeline
from bruneton_sky.published.gpu_single_scattering import single_scattering_cube_job
from bruneton_sky.published.pipeline.pipeline import run_pipeline
from bruneton_sky.sky_view import fill_cube, sky_view
from bruneton_sky.sky_view.gpu import sky_view_job
from bruneton_sky.sky_view.table_on_card import table_cube_job, table_on_card
from clouds.genera import Genus
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie.gpu_cube import gpu_cube_job
from dynamic_skylight.hosek_wilkie.sky import half_scale
from light_transport.rays.mirror_rays import mirror_parts
from light_transport.surfaces.surfaces import surfaces_of
from light_transport.tolerance import TransportSizes
from light_transport.transport import SceneTransport
from numpy.typing import ArrayLike

from vrut_lite.geometry.colour import three_sample_scale
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.messages.gpu_job import TexelFormat
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.packing import packed
from vrut_lite.sky.air_sum import LitAir, air_of_bodies
from vrut_lite.sky.air_volume import light_of
from vrut_lite_lab.bench.gl import GlTexture, close_gl, gl_owner
from vrut_lite_lab.bench.light_on_card import LightOnCard
from vrut_lite_lab.bench.paths.frame import SCENES
from vrut_lite_lab.bench.paths.light_map import hour_of_bench
from vrut_lite_lab.bench.paths.sky_view import solved
from vrut_lite_lab.bench.paths.tables import DEMO, SIZES, air
from vrut_lite_lab.bench.skies import sun_at
from vrut_lite_lab.card_check import night_and_clouds
from vrut_lite_lab.card_check.parts import Keep

_SUNS_DEG = (60.0, 4.0, -4.0)
_HEIGHTS_M = {0.0: "", 3e3: ", from 3 km", 4e5: ", from 400 km"}
_TWILIGHT_DEG = (0.0, -2.0, -8.0, -30.0)
_BLACK = np.zeros(3)
_FULL_MOON, _AIRGLOW = 2.5e-6, 3e-7
_OF_LARGEST = 1e-2
# Sizes and formats: the processor's, and a card's own.
_Cube = tuple[int, TexelFormat]
_HOSEK_WILKIE: tuple[_Cube, ...] = ((256, "rgba16f"), (1024, "rgba16f"), (1024, "rgba32f"))
_SKY_VIEW: tuple[_Cube, ...] = ((256, "rgba16f"), (512, "rgba32f"))
_SCENES = ("work/indoor.glb", "street.obj", "pavilion.gltf")
_TEXELS_OF_MAP, _RAYS, _PATCH_TEXELS, _BOUNCES_LEFT = 15_000, 64, 3.0, 1e-7
_TEXELS: dict[TexelFormat, str] = {"rgba16f": "float16", "rgba32f": "float32"}


def measure(_folder: Path, keep: Keep) -> None:
    """Compare all products."""
    found: dict[str, Any] = {}
    for name, compare in _products().items():
        try:
            found[name] = compare()
        except Exception as error:  # The other products are compared too.
            found[name] = {"error": f"{type(error).__name__}: {error}"[:500]}
        keep(found)
    close_gl()


def _products() -> dict[str, Callable[[], dict[str, Any]]]:
    made: dict[str, Callable[[], dict[str, Any]]] = {}
    for size, format in _HOSEK_WILKIE:
        name = f"Hosek and Wilkie's cube {size}², {_TEXELS[format]}"
        made[name] = partial(_hosek_wilkie, size, format)
    for sun_deg in _TWILIGHT_DEG:
        name = f"twilight's cube 512², float32, sun {sun_deg:g}°"
        made[name] = partial(_twilight, sun_deg)
    made["moonlit night's cube 256², float32"] = _night
    for genus in night_and_clouds.GENERA:
        made[f"clouds in a cube 64², {genus}"] = partial(_clouds, genus)
    for sun_deg in _SUNS_DEG:
        for size, format in _SKY_VIEW:
            name = f"sky-view cube {size}², {_TEXELS[format]}, sun {sun_deg:g}°"
            made[name] = partial(_sky_view, sun_deg, size, format)
        for altitude_m, place in _HEIGHTS_M.items():
            name = f"sky-view table and cube 512², float32{place}, sun {sun_deg:g}°"
            made[name] = partial(_sky_by_table, sun_deg, altitude_m)
        made[f"air volume, sun {sun_deg:g}°"] = partial(_air_volume, sun_deg)
    made["air volume of moon, sun -10° and glow"] = _moonlit_air
    for sun_deg in _SUNS_DEG[:2]:
        made[f"light scattered once, cube 64², sun {sun_deg:g}°"] = partial(_once, sun_deg)
    for scene in _SCENES:
        for name in ("texels", "mirrors"):
            made[f"light between surfaces, {scene}: {name}"] = partial(_light, scene, name)
    for table in ("transmittance", "irradiance", "scattering", "single_mie"):
        made[f"published table: {table}"] = partial(_table, table)
    return made


def _difference(card: ArrayLike, processor: ArrayLike) -> dict[str, Any]:
    card, processor = np.asarray(card, float), np.asarray(processor, float)
    scale = np.maximum(np.abs(processor), _OF_LARGEST * np.abs(processor).max())
    apart = np.abs(card - processor) / scale
    where = np.unravel_index(np.argmax(np.where(np.isnan(apart), np.inf, apart)), apart.shape)
    return {
        "worst": float(apart[where]),
        "where": [int(index) for index in where],
        "card": float(card[where]),
        "processor": float(processor[where]),
        "rms": float(np.sqrt(np.mean(apart**2))),
        "not_finite": int(np.count_nonzero(~np.isfinite(card))),
    }


def _hosek_wilkie(size: int, format: TexelFormat) -> dict[str, Any]:
    sky = HosekWilkieSky(turbidity=3.0, albedo=0.1, sun_elevation_rad=0.5)
    scale = half_scale(sky.brightest)
    job = gpu_cube_job("check", "cube", sky, 0.5, _BLACK, size, scale, format=format)
    cube = GlTexture(job, scale)().read()
    up = texel_directions(size)[..., 1] > 0.0
    return _difference(np.where(up[..., None], cube, 0.0), sky.cube_map(size, 0.5) * up[..., None])


def _twilight(sun_deg: float) -> dict[str, Any]:
    light = night_and_clouds.evening(sun_deg)
    job, scale = night_and_clouds.twilight_job(light, 512)
    return _difference(GlTexture(job, scale)().read(), light.background(512))


def _night() -> dict[str, Any]:
    night = night_and_clouds.moonlit_night()
    asked = night.gpu_background(256, "rgba32f")
    assert asked is not None
    job, background = asked
    made = GlTexture(job, background.scale)().read()
    return _difference(made, np.asarray(night.background(256).cube))


def _clouds(genus: Genus) -> dict[str, Any]:
    made = GlTexture(night_and_clouds.cloud_job(genus, 64))().read()
    return _difference(made, night_and_clouds.sky_behind(genus, 64))


def _sky_view(sun_deg: float, size: int, format: TexelFormat) -> dict[str, Any]:
    view = sky_view(solved("clear air"), 2.0, sun_at(sun_deg))
    job, scale = sky_view_job(view, size, _BLACK, "check", "cube", format=format)
    return _difference(GlTexture(job, scale)().read(), fill_cube(view, size, _BLACK))


def _sky_by_table(sun_deg: float, altitude_m: float) -> dict[str, Any]:
    field, sun, size = solved("clear air"), sun_at(sun_deg), 512
    table = table_on_card(field, altitude_m, sun)
    job = table_cube_job(table, size, _BLACK, 1.0, "check", "cube")
    expected = fill_cube(sky_view(field, altitude_m, sun), size, _BLACK)
    return _difference(GlTexture(job)().read(), expected)


def _air_volume(sun_deg: float) -> dict[str, Any]:
    where = (solved("clear air"), 2.0, sun_at(sun_deg), 1.2e5)
    job, volume = air_volume_job(*where, "check", "air")
    expected = air_volume(*where)
    light = light_of(expected).astype(float) * expected.radiance_scale
    made = GlTexture(job, volume.radiance_scale)().read()
    return _difference(made.reshape(light.shape), light)


def _moonlit_air() -> dict[str, Any]:
    """The air of a full moon, a sun at -10 degrees and a glow, each body over its brightest."""
    parts, expected = [], []
    for body_deg, share, glow in ((40.0, _FULL_MOON, _AIRGLOW), (-10.0, 1.0, 0.0)):
        where = (solved("clear air"), 2.0, sun_at(body_deg), 1.2e5)
        job, volume = air_volume_job(*where, "check", "air")
        factor = np.full(3, share * volume.radiance_scale)
        parts.append(LitAir(job, factor, np.full(3, glow)))
        by_processor = air_volume(*where)
        light = light_of(by_processor).astype(float) * (share * by_processor.radiance_scale)
        light[0] += glow
        expected.append(light)
    job_of_all = air_of_bodies(parts)
    assert job_of_all is not None
    made = GlTexture(job_of_all)().read().reshape(2, *expected[0].shape)
    brightest = [light.max() for light in expected]
    return _difference(
        np.stack([body / most for body, most in zip(made, brightest, strict=True)]),
        np.stack([light / most for light, most in zip(expected, brightest, strict=True)]),
    )


def _once(sun_deg: float) -> dict[str, Any]:
    clear, sun, size = preset("earth-clear"), sun_at(sun_deg), 64
    job = single_scattering_cube_job(
        "check", "cube", clear, 0.0, sun, size, rule="gauss-legendre", samples=12, format="rgba32f"
    )
    directions = texel_directions(size)
    up = directions[..., 1] > 0.0
    towards = directions[up]
    nu = np.clip(towards @ sun, -1.0, 1.0)
    light = single_scattering(clear, 0.0, towards[:, 1], sun[1], nu, samples=12)
    exact = np.asarray(light * three_sample_scale(clear.wavelength_nm, 3.0))
    return _difference(GlTexture(job)().read()[up], exact)


def _light(scene: str, name: str) -> dict[str, Any]:
    transport, found = _lit(scene)
    return _difference(found[name], getattr(transport.light(hour_of_bench(60.0)), name))


@lru_cache(maxsize=1)
def _lit(scene: str) -> tuple[SceneTransport, dict[str, Any]]:
    """A bake, and the light that the card computes of it; the processor's bounces converge."""
    opened = packed(load_scene(str(SCENES / scene)))
    surfaces = surfaces_of(opened)
    sizes = TransportSizes(None, _TEXELS_OF_MAP, _PATCH_TEXELS, _BOUNCES_LEFT)
    transport = SceneTransport.of_scene(opened, surfaces, sizes)
    transport.add_mirrors(mirror_parts(opened, surfaces))
    transport.add_rays(_RAYS)
    return transport, LightOnCard(transport, hour_of_bench(60.0))().read()


def _table(name: str) -> dict[str, Any]:
    return _difference(*(getattr(tables, name) for tables in _tables()))


_TABLES: list[Any] = []


def _tables() -> list[Any]:
    """By the card and by the processor, in the published form, at a quarter of the size."""
    if not _TABLES:
        sizes = SIZES["quarter"]
        pipeline = gl_owner().call(lambda context: GpuPipeline(context, sizes))
        _TABLES.append(gl_owner().call(lambda _: pipeline.run(air(DEMO), 4)))
        _TABLES.append(run_pipeline(air(DEMO), sizes, 4))
    return _TABLES
