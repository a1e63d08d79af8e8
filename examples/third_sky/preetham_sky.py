"""Preetham, Shirley and Smits' clear sky (1999) and sun, and a hazy air before things."""

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.atmosphere.aerosol import optical_depth_of_turbidity
from vrut_lite.messages.air import AirVolume
from vrut_lite.sky.air_volume import AirGrid, node_rays, slice_shares
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.sky.sky_of_hour import Background, MotionThreshold, Sky, SunDisc
from vrut_lite.messages.sun import SunMoved
from vrut_lite.geometry.colour import SRGB_FROM_XYZ, rgb_from_spectrum, solar_irradiance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import horizontal_irradiance, irradiance_coefficients
from vrut_lite.kernel.module import Manifest

# Appendix A.2: A to E of Y, x and y by turbidity and 1; the zenith's x and y by its powers.
PEREZ = np.array([
    0.1787, -0.3554, -0.0227, 0.1206, -0.0670, -1.4630, 0.4275, 5.3251, -2.5771, 0.3703,
    -0.0193, -0.0665, -0.0004, -0.0641, -0.0033, -0.2592, 0.0008, 0.2125, -0.8989, 0.0452,
    -0.0167, -0.0950, -0.0079, -0.0441, -0.0109, -0.2608, 0.0092, 0.2102, -1.6537, 0.0529,
]).reshape(3, 2, 5)  # fmt: skip
ZENITH = np.array([
    0.00166, -0.00375, 0.00209, 0.0, -0.02903, 0.06377, -0.03202, 0.00394, 0.11693, -0.21196,
    0.06052, 0.25886, 0.00275, -0.00610, 0.00317, 0.0, -0.04214, 0.08970, -0.04153, 0.00516,
    0.15346, -0.26756, 0.06670, 0.26688,
]).reshape(2, 3, 4)  # fmt: skip
SUN_NM, RGB_NM = np.linspace(400.0, 700.0, 31), np.array([610.0, 550.0, 465.0])
HEIGHTS_M = np.array([8000.0, 1200.0])  # Over which molecules and haze thin to a third.


class Settings(msgspec.Struct, frozen=True):
    albedo: Annotated[float, msgspec.Meta(ge=0, le=1, description="Of the ground")] = 0.1


class PreethamQuality(NamedTuple):
    cube_size: int  # Texels, where a consumer names no size.
    share: float  # Share of the light that skipped moves of sun and eye may change.


class PreethamSky(SkyModule):
    manifest = Manifest(name="preetham_sky", title="Preetham sky", version="1",
                        provides=("sky",), requires=("sun",))  # fmt: skip
    settings_type = Settings

    def quality(self, tolerance):
        return PreethamQuality(int(np.clip(16.0 / tolerance, 64, 512)), 0.1 * tolerance)

    def light(self, hour, quality, prepared):
        turbidity = float(np.clip(self.haze.turbidity, 2.0, 8.0))  # Where the model is good.
        return PreethamLight(self.settings.albedo, turbidity, hour.sun, hour.sun_azimuth_rad)


@dataclass(frozen=True)
class PreethamLight(Sky):  # Equal skies are not posted twice: compare by value.
    albedo: float
    turbidity: float
    at: SunMoved
    azimuth_rad: float

    def background(self, size):
        directions = texel_directions(size)
        lit = horizontal_irradiance(self.radiance(texel_directions(64)))
        lit += self.sun().irradiance_rgb * max(self.at.direction[1], 0.0)
        ground = self.albedo / np.pi * lit
        sky = np.where(directions[..., 1:2] > 0.0, self.radiance(directions), ground)
        return Background(sky.astype(np.float32), ground)

    def sun(self):
        sine, t = max(self.at.direction[1], 0.0), self.turbidity
        air_mass = 1.0 / (sine + 0.15 * (np.degrees(np.arcsin(sine)) + 3.885) ** -1.253)
        depth = 0.008735 * (SUN_NM / 1000.0) ** -4.08 + optical_depth_of_turbidity(t, SUN_NM)
        light = rgb_from_spectrum(solar_irradiance(SUN_NM) * np.exp(-depth * air_mass), SUN_NM)
        return SunDisc(np.maximum(light, 0.0) * self.at.visible_disc_fraction)

    def ambient(self):
        return irradiance_coefficients(self.background(64).cube)

    def unseen(self, hour, quality):  # Over 0.02 rad dusk dims, over 1200 m haze thins, to a third.
        return MotionThreshold(sun_rad=0.02 * quality.share, eye_m=1200.0 * quality.share)

    def air(self, eye_height_m, reach_m):  # It adds the horizon's light as it takes that behind.
        grid = AirGrid(eye_height_m, 6.36e6, 6e4, reach_m, rows_above=24, rows_below=12)
        rays = node_rays(grid, 16, self.at.direction[1])
        metres = slice_shares(16, eye_height_m)[:, None] * rays.span_m
        start, climb = rays.altitude_m[:, None], (metres * rays.mu)[..., None]
        rise = np.where(np.abs(climb) < 0.1, 0.1, np.maximum(climb, -500.0 - start))
        fall = np.exp(-start / HEIGHTS_M) - np.exp(-(start + rise) / HEIGHTS_M)
        haze = optical_depth_of_turbidity(self.turbidity, RGB_NM) / HEIGHTS_M[1]
        at_ground = np.stack([1.24062e-6 * (RGB_NM / 1000.0) ** -4.0, haze])
        turn = self.azimuth_rad + 2.0 * np.arcsin(np.linspace(0.0, 1.0, 16))
        light = np.zeros((3, 16, 24 + 12, 16, 3), dtype=np.float16)
        light[0] = self.radiance(np.stack([np.sin(turn), 0.02 + 0.0 * turn, -np.cos(turn)], -1))
        return AirVolume(
            light=Array(light), radiance_scale=1.0, columns=16, **grid._asdict(),
            extinction=Array((fall * HEIGHTS_M / rise @ at_ground).astype(np.float32)),
            aerosol_phase=Array(np.zeros((2, 3), np.float32)), sun_direction=self.at.direction,
        )  # fmt: skip

    def radiance(self, direction):
        """Linear sRGB (..., 3) in W m^-2 sr^-1 (appendix A.2); below the horizon as on it."""
        t, angle = self.turbidity, np.arccos(max(self.at.direction[1], 0.0))
        chi = (4.0 / 9.0 - t / 120.0) * (np.pi - 2.0 * angle)
        luminance = 1000.0 * ((4.0453 * t - 4.9710) * np.tan(chi) - 0.2155 * t + 2.4192)
        dusk = 10.0 ** (np.degrees(min(self.at.apparent_elevation_rad, 0.0)) / 2.8)
        xy = ZENITH @ angle ** np.arange(3, -1, -1) @ [t * t, t, 1.0]
        gamma = np.arccos(np.clip(direction @ np.array(self.at.direction), -1.0, 1.0))[..., None]
        relative = perez(t, direction[..., 1:2].clip(0.001), gamma) / perez(t, 1.0, angle)
        y_, x, y = np.moveaxis(relative * [luminance * dusk / 683.0, *xy], -1, 0)
        xyz = np.stack([x, y, 1.0 - x - y], axis=-1) * (y_ / y)[..., None]
        return np.maximum(xyz @ SRGB_FROM_XYZ.T, 0.0)


def perez(turbidity, up, gamma):
    a, b, c, d, e = (PEREZ[:, 0] * turbidity + PEREZ[:, 1]).T
    return (1.0 + a * np.exp(b / up)) * (1.0 + c * np.exp(d * gamma) + e * np.cos(gamma) ** 2)
