"""The sum of one hour's light: sunlight, moonlight and the sky's own glow.

Scattering is linear in its source: the sky that the moon lights is that of a sun in the moon's
place, times moonlight over sunlight. So every sky module has moonlit nights, by its own model.
The factor is one number a channel; the moon's colour differs smoothly from the sun's.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.atmosphere.refraction import horizon_elevation
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.encoding import encode_float16, float16_scale
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance, irradiance_coefficients
from vrut_lite.messages.air import AirVolume, SecondLight
from vrut_lite.messages.gpu_job import GpuJob, TexelFormat
from vrut_lite.messages.gpu_texture import GpuTexture
from vrut_lite.messages.night import NO_ECLIPSE, MoonLight
from vrut_lite.messages.sky import NO_LAMPS
from vrut_lite.messages.sun import Body, SunMoved
from vrut_lite.numeric_types import Float32Array, FloatArray, Vector
from vrut_lite.sky.air_sum import LitAir, air_of_bodies
from vrut_lite.sky.air_volume import light_of
from vrut_lite.sky.cube_sum import glow_pass, scale_of_sum, sum_of_parts
from vrut_lite.sky.night_glow import glow_cube
from vrut_lite.sky.night_kernels import add_halves
from vrut_lite.sky.sky_of_hour import (
    Background,
    MotionThreshold,
    Sky,
    SkyInputs,
    SkySpectra,
    Spectrum,
    SunDisc,
)

# Edge (texels) of the cube from which the glow's irradiance on the scene is integrated.
_LIGHT_SIZE = 32
# Radiance of evenly lit air over dark ground, relative to the mean radiance that falls on it.
_AIR_GLOWS = 0.5
# Elevations of the sun (degrees): the night fades in from the first over the second, where it is
# 3e-4 of the light; the sun's light is gone at the third, after fading over the fourth.
_NIGHT_FROM_DEG, _FADES_IN_DEG, _SUN_GONE_DEG, _FADES_OUT_DEG = 0.5, 1.0, -19.0, 1.0
# Zenith luminance in totality relative to day (Dandekar and Turtle 1971).
_LEFT_IN_TOTALITY = 1e-4
# Share of the key light's skylight below which the other body is left out of the air. Near the
# moon its air is a hundred times as bright as on average: a thousandth of all at most.
_LEAST_SHARE = 1e-5
# Work of a texel of the glow's program, in trial pixels (`device_choice`).
_GLOW_TRIALS = 0.25


def night_share(sun: SunMoved) -> float:
    """The share of the night's light that is added: 0 by day, where the sun outshines it."""
    degrees = math.degrees(sun.elevation_rad)
    return min(max((_NIGHT_FROM_DEG - degrees) / _FADES_IN_DEG, 0.0), 1.0)


def sun_share(sun: SunMoved) -> float:
    """The share of the sun's light that is shown: 0 once it is too low to be told from night."""
    degrees = math.degrees(sun.elevation_rad)
    return min(max((degrees - _SUN_GONE_DEG) / _FADES_OUT_DEG, 0.0), 1.0)


def key_body(sun: SunMoved, moon: MoonLight | None, eye_height_m: float) -> Body:
    """The body that casts shadows: the sun while any of its disc is up, else the moon.

    An eye aloft, whose horizon lies lower, keeps the sun as long as it sees it.
    """
    if sun.visible_disc_fraction > 0.0 or moon is None or moon.place.visible_disc_fraction == 0.0:
        return "sun"
    if sun.elevation_rad > horizon_elevation(eye_height_m):
        return "sun"
    return "moon"


@dataclass(frozen=True)
class SkyAtNight(Sky):
    """Light of a sun that is low or set, and of the night.

    Attributes:
        by_sun: the sky of the sun alone; it also knows the ground and the air.
        by_moon: the sky of a sun in the moon's place; None where it gives no light.
        moon: the moon's light, with `by_moon`.
        glow: the map of `NightLightChanged`; None where unknown.
        share: share of the night's light, from 0 by day to 1.
        key: the body that casts shadows.
        sun_share: share of the sun's light that is shown; see the function.
        sun_left_rgb: share of the sun's light in an eclipse.
        horizon_rad: elevation of the eye's horizon, below 0 aloft.
        lamps: radiance of the lands around by their lamps.
    """

    by_sun: Sky
    by_moon: Sky | None
    moon: MoonLight | None
    glow: Array | None
    share: float
    key: Body
    sun_share: float = 1.0
    sun_left_rgb: Vector = NO_ECLIPSE
    horizon_rad: float = 0.0
    lamps: Vector = NO_LAMPS

    @property
    def sunlit(self) -> bool:
        """Whether any of the sun's light is left."""
        return self.sun_share > 0.0

    @cached_property
    def _sun_left(self) -> FloatArray:
        """Share (3,) of the sky's light: in totality air beyond the shadow lights it."""
        return self.sun_share * np.maximum(self.sun_left_rgb, _LEFT_IN_TOTALITY)

    @cached_property
    def _moon_share(self) -> FloatArray:
        assert self.moon is not None
        return self.share * np.asarray(self.moon.of_sunlight_rgb)

    @cached_property
    def _glow_ground(self) -> FloatArray:
        """Radiance (3,) of the ground by all of the glow."""
        if self.glow is None:
            return np.zeros(3)
        return np.asarray(self.by_sun.ground_albedo_rgb() / np.pi * _on_level(self.glow))

    def _dark_cube(self, like: Background, horizon_rad: float) -> Float32Array:
        """The glow's share over lit ground, a copy that may be changed."""
        assert not isinstance(like.cube, GpuTexture)
        if self.glow is None or not self._glows:
            return np.zeros(like.cube.shape, np.float32)
        glow = glow_cube(self.glow, like.cube.shape[1], self._lit_ground, horizon_rad)
        return glow * np.float32(self.share)

    @property
    def _lit_ground(self) -> Vector:
        red, green, blue = self._glow_ground.tolist()
        return red, green, blue

    # --- the sky ---------------------------------------------------------------------------

    def background(self, size: int) -> Background:
        """The sum of the cubes."""
        return self._sum(lambda sky: sky.background(size), self.horizon_rad)

    def background_on_ground(self, size: int) -> Background:
        """The sum of the cubes for an observer on the ground."""
        return self._sum(lambda sky: sky.background_on_ground(size))

    def gpu_background(self, size: int, format: TexelFormat) -> tuple[GpuJob, Background] | None:
        """The sum of the skies' own programs and the glow's, in single precision."""
        made = [(sky.gpu_background(size, "rgba32f"), share) for sky, share in self._lights]
        known = [(*asked, share) for asked, share in made if asked is not None]
        if len(known) < len(made):
            return None
        scales = [seen.scale * float(share.max()) for _, seen, share in known]
        if self._glows:
            assert self.glow is not None
            scales.append(float16_scale(self.share * float(self.glow.values.max())))
        scale = scale_of_sum(scales)
        job = sum_of_parts([(job, share * seen.scale / scale) for job, seen, share in known])
        if job is None:
            return None
        if self._glows:
            assert self.glow is not None
            where = size, self._lit_ground, self.share, scale, self.horizon_rad
            job = msgspec.structs.replace(job, then=(*job.then, glow_pass(self.glow, *where)))
        texture = GpuTexture(size=size, format=job.format, recipe=job.recipe)
        return job, self._together([seen for _, seen, _ in known], texture, scale)

    def card_cube_trials(self) -> float:
        """Those of the skies and of the glow."""
        of_skies = sum(sky.card_cube_trials() for sky, _ in self._lights)
        return of_skies + (_GLOW_TRIALS if self._glows else 0.0)

    def card_air_trials(self) -> float:
        """Those of the bodies that light the air."""
        return sum(sky.card_air_trials() for sky, _ in self._lights_of_air)

    def card_makes(self, product: str) -> bool:
        """Whether the sun's sky has a program for the product; the moon's is of the same kind."""
        return self.by_sun.card_makes(product)

    def _sum(
        self, background_of: Callable[[Sky], Background], horizon_rad: float = 0.0
    ) -> Background:
        skies = self._lights
        backgrounds = [background_of(sky) for sky, _ in skies]
        cube = self._dark_cube(backgrounds[0], horizon_rad)
        for more, (_, share) in zip(backgrounds, skies, strict=True):
            _add(cube, more, share)
        return self._together(backgrounds, cube)

    @property
    def _lights(self) -> list[tuple[Sky, FloatArray]]:
        """The skies and their shares (3,).

        After the sun's light is gone, the moon's sky states whether the ground is behind air.
        """
        by_sun = [(self.by_sun, self._sun_left)]
        if self.by_moon is None:
            return by_sun
        return [*(by_sun if self.sunlit else []), (self.by_moon, self._moon_share)]

    @property
    def _glows(self) -> bool:
        return self.glow is not None and self.share > 0.0

    def _together(
        self,
        backgrounds: list[Background],
        cube: Float32Array | GpuTexture,
        scale: float = 1.0,
    ) -> Background:
        """The background of the skies' backgrounds, with the sum of their cubes."""
        ground, seen = np.zeros(3), None
        for number, (one, (sky, share)) in enumerate(zip(backgrounds, self._lights, strict=True)):
            ground = ground + share * one.ground_rgb
            is_key = number == 0 or (sky is self.by_moon and self.key == "moon")
            if is_key and one.seen_sun_rgb is not None:
                seen = share * one.seen_sun_rgb
        if self.glow is not None:
            ground = ground + self.share * self._glow_ground
        through_air = backgrounds[0].ground_through_air
        return Background(cube, ground, scale, through_air, seen_sun_rgb=seen)

    def sun(self) -> SunDisc:
        """The key light."""
        if self.key == "sun" or self.by_moon is None or self.moon is None:
            sun = self.by_sun.sun()
            return sun._replace(irradiance_rgb=sun.irradiance_rgb * np.array(self.sun_left_rgb))
        moon = self.by_moon.sun()
        behind_air = self._moon_share * moon.irradiance_rgb
        direction = self.moon.place.direction
        radius = self.moon.angular_radius_rad
        return SunDisc(behind_air, radius, body="moon", direction=direction, haze=moon.haze)

    @cached_property
    def _ambient_by_sun(self) -> FloatArray:
        return np.asarray(self.by_sun.ambient())

    @cached_property
    def _ambient_by_moon(self) -> FloatArray:
        assert self.by_moon is not None
        return np.asarray(self.by_moon.ambient())

    def ambient(self) -> FloatArray:
        """The sum of the harmonics."""
        harmonics = np.zeros((25, 3))
        if self.sunlit:
            harmonics = harmonics + self._sun_left * self._ambient_by_sun
        if self.by_moon is not None:
            harmonics = harmonics + self._moon_share * self._ambient_by_moon
        if self.glow is not None:
            harmonics = harmonics + self.share * _harmonics(self.glow, self._lit_ground)
        return harmonics

    def polarisation(self, size: int) -> Float32Array | None:
        """The sum of sunlight's and moonlight's; the glow is unpolarised."""
        lights = [(self.by_sun, self._sun_left)]
        if self.by_moon is not None:
            lights.append((self.by_moon, self._moon_share))
        cubes = [(sky.polarisation(size), share) for sky, share in lights if share.any()]
        known = [cube * share.astype(np.float32) for cube, share in cubes if cube is not None]
        return np.asarray(sum(known)) if known else None

    def lamps_rgb(self) -> Vector:
        """The night's share of the lamps' radiance."""
        red, green, blue = self.lamps
        return self.share * red, self.share * green, self.share * blue

    def ground_albedo_rgb(self) -> FloatArray:
        """Albedo of the ground, from the sun's sky."""
        return self.by_sun.ground_albedo_rgb()

    def on_scene(self) -> object:
        """Light that no eye changes."""
        return (
            self.by_sun.on_scene(),
            None if self.by_moon is None else self.by_moon.on_scene(),
            replace(self, by_sun=_NOBODY, by_moon=None, horizon_rad=0.0),
        )

    def unseen(self, hour: SkyInputs, quality: object) -> MotionThreshold:
        """Limits of the sun's sky; the moon's are checked separately."""
        return self.by_sun.unseen(hour, quality)

    def spectrum(self, direction: tuple[float, float, float]) -> Spectrum:
        """Spectrum of the sun's light alone."""
        return self.by_sun.spectrum(direction)

    def spectra(self, size: int, wavelength_nm: tuple[float, ...]) -> SkySpectra | None:
        """Those of the sun's sky where it has all light, as in an eclipse; of a night none."""
        found = None if self.share > 0.0 else self.by_sun.spectra(size, wavelength_nm)
        if found is None:
            return None
        left = float(luminance(self._sun_left) / luminance(np.ones(3)))
        of_disc = float(luminance(self.sun_left_rgb) / luminance(np.ones(3)))
        return found._replace(
            cube=found.cube * np.float32(left),
            sun_irradiance=of_disc * found.sun_irradiance,
            ground_radiance=left * found.ground_radiance,
        )

    # --- the air ---------------------------------------------------------------------------

    def air(self, eye_height_m: float, reach_m: float) -> AirVolume | None:
        """The air in the light of both bodies, each in its own place, and the glow in it.

        Shadows are those of the key light; the other body's light is the volume's `second`.
        """
        lights = []
        for sky, share in self._lights_of_air:
            volume = sky.air(eye_height_m, reach_m)
            if volume is None:
                return None
            lights.append((volume, _share_of(volume, share)))
        (volume, light), *others = lights
        second = None
        for other, of_other in others:
            values, scale = encode_float16(of_other)
            second = SecondLight(
                light=Array(values), radiance_scale=scale, direction=other.sun_direction
            )
        light[0] += self._glow_of_air.astype(np.float32)
        values, scale = encode_float16(light)
        return msgspec.structs.replace(
            volume, light=Array(values), radiance_scale=scale, second=second
        )

    def gpu_air(self, eye_height_m: float, reach_m: float) -> tuple[GpuJob, AirVolume] | None:
        """The same by the skies' own programs, both bodies in one texture."""
        volumes, parts, glow = [], [], self._glow_of_air
        for sky, share in self._lights_of_air:
            asked = sky.gpu_air(eye_height_m, reach_m)
            if asked is None:
                return None
            job, volume = asked
            volumes.append(volume)
            parts.append(LitAir(job, volume.radiance_scale * share, glow))
            glow = np.zeros(3)
        job_of_all = air_of_bodies(parts)
        if job_of_all is None:
            return None
        texture = GpuTexture(
            size=job_of_all.size, format=job_of_all.format, recipe=job_of_all.recipe
        )
        volume, *others = volumes
        second = None
        for other in others:
            second = SecondLight(light=None, radiance_scale=1.0, direction=other.sun_direction)
        return job_of_all, msgspec.structs.replace(
            volume, light=texture, radiance_scale=1.0, second=second
        )

    @property
    def has_dark_body(self) -> bool:
        """Whether a body is left out of the air, for it lights it next to nothing."""
        return self.by_moon is not None and len(self._lights_of_air) == 1

    @cached_property
    def _lights_of_air(self) -> list[tuple[Sky, FloatArray]]:
        """Sky and share (3,) of one body that lights the air, or two, the key light's first."""
        by_sun = self.by_sun, self._sun_left
        if self.by_moon is None:
            return [by_sun]
        by_moon = self.by_moon, self._moon_share
        sun, moon = (
            float((share * ambient[0]).mean()) if share.any() else 0.0
            for share, ambient in (
                (self._sun_left, self._ambient_by_sun),
                (self._moon_share, self._ambient_by_moon),
            )
        )
        first, other = (by_sun, sun), (by_moon, moon)
        if self.key == "moon":
            first, other = other, first
        if other[1] <= _LEAST_SHARE * first[1]:
            return [first[0]]
        return [first[0], other[0]] if first[1] > 0.0 else [other[0]]

    @property
    def _glow_of_air(self) -> FloatArray:
        """Radiance (3,) of air in the glow, isotropic and unshadowed."""
        if self.glow is None:
            return np.zeros(3)
        return np.asarray(_AIR_GLOWS / np.pi * self.share * _on_level(self.glow))


_NOBODY = Sky()
_BLACK = (0.0, 0.0, 0.0)


def _share_of(volume: AirVolume, share: FloatArray) -> Float32Array:
    """A share (3,) of a volume's light (3, slices, rows, columns, 3), W m^-2 sr^-1."""
    return light_of(volume).astype(np.float32) * (volume.radiance_scale * share).astype(np.float32)


# A map of the glow serves for minutes.
@lru_cache(maxsize=2)
def _on_level(glow: Array) -> FloatArray:
    """Irradiance (3,) of level ground by all of the glow."""
    return horizontal_irradiance(glow_cube(glow, _LIGHT_SIZE, _BLACK))


@lru_cache(maxsize=2)
def _harmonics(glow: Array, ground_rgb: Vector) -> FloatArray:
    """Harmonics (25, 3) of the irradiance by all of the glow over ground."""
    return irradiance_coefficients(glow_cube(glow, _LIGHT_SIZE, ground_rgb))


def _add(total: Float32Array, more: Background, share: FloatArray) -> None:
    """Add a share (3,) of a cube."""
    assert not isinstance(more.cube, GpuTexture)
    factor = (more.scale * share).astype(np.float32)
    if more.cube.dtype == np.float16:
        halves = more.cube.reshape(-1, 3).view(np.uint16)
        add_halves(total.reshape(-1, 3), halves, factor)
    elif factor.any():
        total += more.cube * factor
