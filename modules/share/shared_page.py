"""A page of a project: its light, its sky, its geometry, and the error of its compression."""

import io
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from light_transport.public import MirrorRays, SceneTransport
from numpy.typing import NDArray
from PIL import Image

from share.air_table import air_table
from share.cloud_maps import CloudMaps
from share.clouds_seen import maps_of
from share.glb import glb_of
from share.light_basis import CLUSTERS, CODES_PER_STOP, LightBasis, light_basis
from share.light_maps import (
    MapValues,
    behind_clouds,
    glow_illumination,
    light_maps,
    traced,
)
from share.numbers import Numbers, numbers_of
from share.page_file import page_text
from share.page_light import HourError, PageLight, hour_error, hours_of
from share.page_night import PLANETS, planet_light, split_glow
from share.page_sky import about_clouds, about_places, about_sky, cloud_arrays, moon_table
from share.page_stars import TURNS_A_DAY, fixed_stars
from share.scene_mesh import groups_of
from share.shared_scene import SharedScene
from share.sky_shares import COMPONENTS, LEAST_RATIO, POWER, SkyShares, mean_codes, sky_shares
from share.sky_table import check_sky, sky_table
from share.sun_coefficients import sun_coefficients
from share.sun_places import SunPlaces, apparent
from vrut_lite.atmosphere.refraction import pressure_at_altitude_pa
from vrut_lite.frame_part import SUN_GLOW_RAD
from vrut_lite.geometry.encoding import encode_float16
from vrut_lite.geometry.false_colours import colours_at
from vrut_lite.geometry.reflection import reflectance_table
from vrut_lite.headless import Project, display_numbers, tracked
from vrut_lite.messages.camera import frame_bounds
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE
from vrut_lite.place_time import time_zone_at

# Geometric elevations (degrees) of the sun at which the sky is computed.
_HEIGHTS_DEG = (
    *(-19.0, -18.0, -16.5, -15.0, -13.5, -12.0, -10.5, -9.0, -8.0, -7.0, -6.0, -5.0, -4.0, -3.0),
    *(-2.5, -2.0, -1.5, -1.1, -0.85, -0.6, -0.3, 0.0, 0.4, 0.8, 1.3, 2.0, 3.0, 4.0, 5.5, 7.0, 9.0),
    *(11.0, 13.5, 16.0, 19.0, 22.5, 26.5, 31.0, 36.0, 41.0, 47.0, 53.0, 59.0, 65.0, 71.0, 77.0),
    *(83.0, 89.0),
)
# Number of hours of the day at which the error is measured.
_ERROR_HOURS = 12
_BYTES_OF_COLOURS = 64
# Passes on steps, given their name and number.
Follow = Callable[[Iterable[int], str, int], Iterable[int]]


@dataclass(frozen=True, eq=False)
class SharedPage:
    """A page's text, the errors of its light on the project's day, and modules left out."""

    text: str
    errors: list[HourError]
    texels: int
    terms: int
    left_out: tuple[str, ...]


def shared_page(
    project: Project,
    title: str,
    texels: int | None,
    terms: int,
    stills: list[tuple[str, bytes]],
    numbers: Path | None = None,
    follow: Follow = tracked,
) -> SharedPage:
    """The page of a project; `follow` shows the progress of the steps that it passes on.

    `numbers` is a folder of `vrut-lite daylight`.

    Raises:
        UserError: the scene cannot be read, has no surfaces or too many texels, or the numbers are
            not of it.
    """
    opened = SharedScene(project)
    try:
        found = None if numbers is None else numbers_of(numbers, opened.scene)
        return _page(opened, project, title, texels, terms, stills, found, follow)
    finally:
        opened.close()


def _page(
    opened: SharedScene,
    project: Project,
    title: str,
    texels: int | None,
    terms: int,
    stills: list[tuple[str, bytes]],
    numbers: Numbers | None,
    follow: Follow,
) -> SharedPage:
    scene, place = opened.scene, opened.place
    tolerance = DEFAULT_TOLERANCE if project.tolerance is None else project.tolerance
    left_out, frozen = opened.without_glows(), opened.freeze_clouds()
    disc, key = opened.disc, opened.light.key_light
    skies = opened.sun_skies(np.radians(_HEIGHTS_DEG))
    table = sky_table(skies)
    check_sky(table, opened.afternoon_sky())
    air = air_table(skies, table, math.dist(scene.lower_m, scene.upper_m))
    transport, mirrors = traced(scene, tolerance, texels, cloudy=frozen is not None)
    values = MapValues.of(transport)
    glows = opened.moonless_glows()
    # The light of a night is that of the mean.
    glow = None
    if glows:
        glow = np.mean([each.radiance_rgb for each in glows], axis=0).astype(np.float32)
    places = SunPlaces(math.radians(place.latitude_deg), place.north_offset_rad)
    pressure_pa = pressure_at_altitude_pa(place.altitude_m)

    def apparent_of(true_rad: float) -> float:
        return apparent(true_rad, pressure_pa)

    dark, clouds = glow_illumination(glow, table.albedo_rgb[-1]), None
    if frozen is not None:
        clouds = maps_of(
            frozen,
            table,
            places,
            apparent_of,
            dark,
            opened.light.ambient.lamps_rgb,
            lambda steps, count: follow(steps, "clouds under the sun's places", count),
        )
        dark = behind_clouds(dark, clouds, clouds.by_night).by_sky
    maps = light_maps(
        transport,
        values,
        table,
        places,
        apparent_of,
        dark,
        clouds,
        lambda steps: follow(steps, "light of the sun's places", len(places.heights)),
    )
    basis = light_basis(maps, terms)
    shares = sky_shares(maps.sky_share, places.heights > 0.0)
    coded_sun = sun_coefficients(basis.sun, basis.spread())
    sun = coded_sun.decoded()
    moons, albedo = opened.moons()
    moon = moon_table(moons)
    sightings = list(opened.star_sightings())
    stars = fixed_stars(sightings, places.latitude_rad, place.north_offset_rad, pressure_pa)
    page_light = PageLight(table, places, apparent_of, clouds, basis, sun)
    errors = [
        hour_error(opened, frozen, transport, values, page_light, instant, project.where())
        for instant in hours_of(project.instant(), _ERROR_HOURS)
    ]
    header: dict[str, Any] = {
        "title": title,
        "start": project.instant().isoformat(),
        "year_days": 365,
        "place": {
            "latitude_deg": place.latitude_deg,
            "longitude_deg": place.longitude_deg,
            "altitude_m": place.altitude_m,
            "north_offset_rad": place.north_offset_rad,
            "pressure_pa": pressure_pa,
            "zone": time_zone_at(project.where()).key,
            "text": _place_text(place.latitude_deg, place.longitude_deg),
        },
        "scene": _about_scene(scene),
        "views": _views(project, scene),
        "map": _about_map(transport, scene),
        "places": about_places(places),
        "basis": {
            "clusters": CLUSTERS,
            "terms": len(basis.terms),
            "power": POWER,
            "codes_per_stop": CODES_PER_STOP,
            "lamps_bright": float(maps.by_lamps.max()),
            "glow_bright": float(maps.by_glow.max()),
            "share_components": COMPONENTS,
            "share_least": LEAST_RATIO,
        },
        "sky": about_sky(table),
        **({} if clouds is None else {"clouds": about_clouds(clouds)}),
        "moon": moon,
        "glow_rad": SUN_GLOW_RAD,
        "glow_ground": list(dark.ground_radiance_rgb),
        "disc": {
            "angular_radius_rad": disc.angular_radius_rad,
            "even_radius_rad": key.even_radius_rad,
            "limb_darkening_rgb": [list(terms) for terms in disc.limb_darkening_rgb],
        },
        "mirrors": [],
        "numbers": None,
        "stars": None,
        "tone": display_numbers(),
        "false_colours": _false_colours(),
        "facts": _facts(errors, values, basis, clouds),
    }
    # Light fixed to the horizon, and light that turns with the stars.
    night = np.zeros((2, 2, 2, 3))
    if stars is not None and len(glows) > 2:
        where = stars.seconds, places.latitude_rad, place.north_offset_rad
        night = np.stack(split_glow(glows, stars.extinction, *where))
    elif glow is not None:
        night = np.stack([glow, np.zeros_like(glow)])
    glow_bits, glow_scale = encode_float16(night)
    header["glow_scale"] = glow_scale
    planes, terms_planes = _planes(basis, values, shares)
    arrays: dict[str, NDArray] = {
        "planes": planes,
        "terms": terms_planes,
        "sun": coded_sun.codes,
        "sun_step": coded_sun.step,
        "share_weights": shares.weights,
        "night_and_lamps": np.stack([basis.glow, basis.lamps]),
        "sky": table.radiance.view(np.uint16),
        "air": air.radiance.view(np.uint16),
        "optical_depth": air.optical_depth.view(np.uint16),
        "glow": glow_bits.view(np.uint16),
        "moon_albedo": _bytes(np.ones((1, 1)) if albedo is None else albedo),
        "visible_sky": _visible_sky(transport, planes.shape[1:]),
        "reflectance": _reflectance(),
    }
    if clouds is not None:
        arrays |= cloud_arrays(clouds)
    mirror_of: dict[int, int] = {}
    if mirrors is not None:
        header["mirrors"] = _about_mirrors(transport, mirrors)
        nearness = mirrors.nearness / transport.surfaces.radius_m
        arrays["mirror_nearness"] = nearness.astype(np.float16).view(np.uint16)
        mirror_of = {part: n for n, part in enumerate(mirrors.parts.part.tolist())}
    if stars is not None:
        at = place.latitude_deg, place.longitude_deg, place.altitude_m
        planets = planet_light(sightings, stars.extinction, at, place.north_offset_rad)
        header["stars"] = {
            "seconds": stars.seconds,
            "turns_a_day": TURNS_A_DAY,
            "extinction": stars.extinction.tolist(),
            "planets": PLANETS,
            "planet_light": None if planets is None else planets.tolist(),
        }
        arrays["stars"] = np.concatenate([stars.direction, stars.irradiance_rgb], axis=1).astype(
            np.float32
        )
    if numbers is not None:
        header["numbers"] = {
            "names": numbers.names,
            "units": numbers.units,
            "spacing_m": numbers.spacing_m,
        }
        arrays["numbers"] = numbers.values
        arrays["number_places"] = np.concatenate([numbers.place_m, numbers.direction], axis=1)
    glb = glb_of(
        groups_of(scene, transport.layout_message, mirror_of),
        scene.materials.all(),
        table.albedo_rgb[-1].tolist(),
    )
    text = page_text(title, header, arrays, glb, stills)
    return SharedPage(text, errors, len(values), len(basis.terms), left_out)


# --- light ----------------------------------------------------------------------------------------


def _planes(
    basis: LightBasis, values: MapValues, shares: SkyShares
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Planes (4 + C, h, w) of factors' codes, clusters, high and low bytes of the sky's mean share
    and the share's components, and planes (2, K, h, w) of the terms' low and high bytes.

    Bytes of components and terms count from 128. The probes' rows come after the map's.
    """
    width, height = values.size_px
    count = 0 if values.probes is None else int(np.prod(values.probes))
    rows = height + -(-count // width)
    where = np.concatenate([values.where, width * height + np.arange(count)])
    found = np.zeros((4 + len(shares.components), rows * width), np.uint8)
    found[4:] = 128
    found[0, where], found[1, where] = basis.factor_code, basis.cluster
    codes = mean_codes(shares.mean)
    found[2, where], found[3, where] = codes >> 8, codes & 255
    found[4:, where] = shares.components.astype(np.int16) + 128
    terms = np.full((2, len(basis.terms), rows * width), 128, np.uint8)
    whole = basis.terms.astype(np.int32) + 128
    terms[0][:, where] = whole & 255
    terms[1][:, where] = (whole >> 8) + 128
    return found.reshape(-1, rows, width), terms.reshape(2, -1, rows, width)


def _visible_sky(transport: SceneTransport, shape: tuple[int, ...]) -> NDArray[np.uint16]:
    """`SurfaceLightChanged.visible_sky` (h, w, 4) as bits of float16, on the rows of the planes.

    Bytes are too coarse: deep in a hall a thousandth of the sky is seen.
    """
    seen = transport.cache.visible_sky.values
    found = np.zeros((*shape, 4), np.float16)
    found[: seen.shape[0]] = seen
    return found.view(np.uint16)


def _bytes(share: NDArray[np.floating]) -> NDArray[np.uint8]:
    return np.rint(255.0 * np.clip(share, 0.0, 1.0)).astype(np.uint8)


def _reflectance() -> NDArray[np.uint16]:
    table = reflectance_table().astype(np.float16)
    return np.dstack([table, np.ones(table.shape[:2], np.float16)]).view(np.uint16)


# --- scene ----------------------------------------------------------------------------------------


def _about_scene(scene: SceneOpened) -> dict[str, Any]:
    size = math.dist(scene.lower_m, scene.upper_m)
    ground = scene.lower_m[1] if scene.ground is None else scene.ground.height_m
    clear = any(m.terms.transmits or m.alpha_mode == "BLEND" for m in scene.materials.all())
    return {
        "lower": list(scene.lower_m),
        "upper": list(scene.upper_m),
        "size_m": size,
        "ground_m": ground,
        "glass": clear,
        "lamps": scene.lamps is not None,
    }


def _views(project: Project, scene: SceneOpened) -> dict[str, Any]:
    camera = project.camera.camera() if project.camera else scene.camera
    if camera is None:
        camera = frame_bounds(scene.lower_m, scene.upper_m, 16.0 / 9.0)
    first = {
        "eye_m": list(camera.eye_m),
        "target_m": list(camera.target_m),
        "vertical_field_of_view_deg": math.degrees(camera.vertical_field_of_view_rad),
    }
    named = {
        name: {
            "eye_m": list(view.eye_m),
            "target_m": list(view.target_m),
            "vertical_field_of_view_deg": view.vertical_field_of_view_deg,
        }
        for name, view in project.views.items()
    }
    return {"first view": first, **named}


def _about_map(transport: SceneTransport, scene: SceneOpened) -> dict[str, Any]:
    laid = transport.layout_message
    found: dict[str, Any] = {"chart": None, "probes": None}
    if laid.ground is not None and scene.ground is not None:
        found["chart"] = {
            "corner_px": list(laid.ground.corner_px),
            "edge_px": laid.ground.edge_px,
            "half_width_m": laid.ground.half_width_m,
            "warp": laid.ground.warp,
            "centre_xz_m": list(scene.ground.centre_xz_m),
        }
    if laid.probes is not None:
        found["probes"] = {
            "lower_m": list(laid.probes.lower_m),
            "step_m": list(laid.probes.step_m),
            "counts": list(laid.probes.counts),
            "row": laid.size_px[1],
        }
    return found


def _about_mirrors(transport: SceneTransport, mirrors: MirrorRays) -> list[dict[str, Any]]:
    """Where each glossy part is seen from, and whether it then sees itself."""
    surfaces, parts = transport.surfaces, mirrors.parts
    centres_m = parts.centre * surfaces.radius_m + surfaces.centre_m
    return [
        {"centre_m": centre.tolist(), "hollow": bool(hollow)}
        for centre, hollow in zip(centres_m, parts.hollow, strict=True)
    ]


# --- words ----------------------------------------------------------------------------------------


def _place_text(latitude_deg: float, longitude_deg: float) -> str:
    north, east = "N" if latitude_deg >= 0 else "S", "E" if longitude_deg >= 0 else "W"
    return f"{abs(latitude_deg):.3f}° {north}, {abs(longitude_deg):.3f}° {east}"


def _facts(
    errors: list[HourError], values: MapValues, basis: LightBasis, clouds: CloudMaps | None
) -> list[str]:
    sky = "The sky is clear, and" if clouds is None else "The clouds stand still; the sky is"
    return [
        f"Light of {len(values):,} texels in {CLUSTERS} clusters of {len(basis.terms)} basis maps. "
        "Error of the light map against the scene's own, as shares of its mean (direct light of "
        "sun and moon is drawn by this page and is not counted):",
        *(error.line() for error in errors),
        f"Sun and moon by astronomy-engine. {sky} without the year's numbers.",
        "Made with vrut_lite. three.js, astronomy-engine and meshoptimizer have the MIT licence.",
    ]


def _false_colours() -> list[list[int]]:
    shares = np.linspace(0.0, 1.0, _BYTES_OF_COLOURS)
    pixels = np.asarray(colours_at(shares), np.uint8).reshape(-1, 3)
    return [[*map(int, row), 255] for row in pixels]


def webp(display: NDArray[np.uint8]) -> bytes:
    """A picture (h, w, 3) as WebP."""
    target = io.BytesIO()
    Image.fromarray(display).save(target, "WEBP", quality=80, method=4)
    return target.getvalue()
