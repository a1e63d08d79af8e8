"""The clouds of a frame on the GPU: their noise as textures, and the block of numbers beside it."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_density import (
    noise_origin,
    warp_origin,
    weather_origin,
)
from clouds.model.cloud_grid import growth_of, volume_near_m
from clouds.model.cloud_light import ClearLight, light_from_below
from clouds.model.cloud_spread import spread_of
from clouds.model.cloud_transport import scatterer
from vrut_lite.atmosphere.haze_layer import HazeLayer
from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.atmosphere.sunlight import sunlight_at_altitude
from vrut_lite.frame_part import PartGl
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.uniform_block import UniformBlock

SHADERS = Path(__file__).parents[1] / "shaders"
BLOCK = "cloud_block.glsl"
# As cloud_density.glsl and cloud_light.glsl bind them.
_WEATHER_UNIT, _SHAPE_UNIT, _DETAIL_UNIT, _SUN_UNIT = 0, 1, 2, 3
_SUNS, _LOWEST_SUN = 256, -0.1
# Fields of `CloudForm` that the block has by the same names.
_OF_FORM = (
    "weather_periods_m", "second_share", "stretch", "lean", "growth", "least_height", "side_fade",
    "anvil", "base_fade", "top_fade", "fraying", "sharpness",
)  # fmt: skip


class CloudSurroundings(NamedTuple):
    """Further inputs of the clouds of a frame.

    Attributes:
        eye_m: (3,), world axes.
        ground_level_m: y of the ground behind the scene.
        pixel_rad: angle of a pixel of the cloud picture.
    """

    eye_m: NDArray[np.float64]
    ground_level_m: float
    pixel_rad: float


class ShadowPlane(NamedTuple):
    """Where the cloud shadow map lies: see cloud_shadow.py.

    `centre_m` (2,) is its middle, world x and z; `texels` are those of a side.
    """

    centre_m: NDArray[np.float64]
    near_m: float
    growth: float
    least_sine: float
    texels: int


class CloudsOnGpu:
    """The textures of one layer; made and used on the GL thread only."""

    def __init__(self, gl: PartGl):
        self._gl, self._context = gl, gl.context
        self._block = gl.block(BLOCK)
        self._numbers = gl.context.buffer(reserve=self._block.size_bytes)
        self._noises: list[Any] = []
        self._uploaded: tuple[NDArray, ...] = ()
        self._suns: Any = None
        self._sun_of: tuple[Any, ...] | None = None
        self.layer: CloudLayer | None = None

    @property
    def base_m(self) -> float:
        """Altitude of the layer's base."""
        assert self.layer is not None
        return self.layer.base_m

    def distance_m(self, altitude_m: float) -> float:
        """How far above or below the layer an altitude is; 0 in it."""
        assert self.layer is not None
        return max(self.layer.base_m - altitude_m, altitude_m - self.layer.top_m, 0.0)

    def show(self, layer: CloudLayer | None) -> None:
        """Show this layer from the next frame on; None where there are no clouds."""
        self.layer = layer
        if layer is None:
            return
        noises = layer.weather.values, layer.shape.values, layer.detail.values
        # The module keeps a seed's noises: the same object is on the GPU already.
        if [id(noise) for noise in noises] != [id(noise) for noise in self._uploaded]:
            self._upload(*noises)
            self._uploaded = noises

    def bind(
        self,
        light: ClearLight,
        sky_irradiance: NDArray[np.float64],
        around: CloudSurroundings,
        plane: ShadowPlane,
        covered_share: float,
    ) -> None:
        """Hand layer, light and surroundings to all shaders that are drawn with next.

        Args:
            light: on this layer.
            sky_irradiance: (3,), of level ground by sky and clouds.
            covered_share: of the sun that all layers hold back in the mean.
        """
        assert self.layer is not None
        sun_of = self.layer.base_m, self.layer.top_m, light.sun_passed, light.haze
        if sun_of != self._sun_of:
            self._light(*sun_of)
            self._sun_of = sun_of
        inputs = light, sky_irradiance, around, plane, covered_share
        self._numbers.write(packed_numbers(self._block, self.layer, *inputs))
        self.bind_again()

    def bind_again(self) -> None:
        """Hand what `bind` was given to the shaders that are drawn with next."""
        self._numbers.bind_to_uniform_block(self._block.binding)

    def bind_noises(self) -> None:
        """Set the inputs of the densities."""
        units = (_WEATHER_UNIT, _SHAPE_UNIT, _DETAIL_UNIT, _SUN_UNIT)
        for unit, texture in zip(units, [*self._noises, self._suns], strict=True):
            texture.use(location=unit)

    def release(self) -> None:
        """Free the GL objects."""
        self._release_textures()
        if self._suns is not None:
            self._suns.release()
        self._numbers.release()

    def _upload(self, weather: NDArray, shape: NDArray, detail: NDArray) -> None:
        self._release_textures()
        context = self._context
        self._noises = [
            context.texture(weather.shape, 1, weather.tobytes(), dtype="nu2", alignment=1),
            *(
                context.texture3d(volume.shape, 1, volume.tobytes(), alignment=1)
                for volume in (shape, detail)
            ),
        ]
        for texture in self._noises:
            self._gl.average_down(texture)
            texture.filter = (context.LINEAR_MIPMAP_LINEAR, context.LINEAR)
            texture.repeat_x = texture.repeat_y = True
        for volume in self._noises[1:]:
            volume.repeat_z = True

    def _light(
        self, base_m: float, top_m: float, passed: float, haze: tuple[HazeLayer, ...]
    ) -> None:
        """The sun at base and top, for all heights of the sun: denser towards the lowest."""
        row = np.linspace(0.0, 1.0, _SUNS)
        sines = _LOWEST_SUN + (1.0 - _LOWEST_SUN) * row * row
        table = passed * np.stack(
            [sunlight_at_altitude(level, sines, haze) for level in (base_m, top_m)]
        )
        if self._suns is None:
            self._suns = self._context.texture((_SUNS, 2), 3, dtype="f4", alignment=1)
            self._suns.filter = (self._context.LINEAR, self._context.LINEAR)
            self._suns.repeat_x = self._suns.repeat_y = False
        self._suns.write(table.astype(np.float32).tobytes(), alignment=1)

    def _release_textures(self) -> None:
        if self._noises:
            self._gl.leave_framebuffers()
            for texture in self._noises:
                texture.release()
        self._noises = []


def packed_numbers(
    block: UniformBlock,
    layer: CloudLayer,
    light: ClearLight,
    sky_irradiance: NDArray[np.float64],
    around: CloudSurroundings,
    plane: ShadowPlane,
    covered_share: float,
) -> bytes:
    """The bytes of a layer's block."""
    eye = around.eye_m
    level, form = eye[[0, 2]], layer.form
    base, top = layer.base_m, layer.top_m
    ground = min(around.ground_level_m, float(eye[1]))
    eye_altitude_m, spread = float(eye[1]), spread_of(layer)
    return block.packed(
        sun_direction=light.sun_direction,
        eye_radius_m=GROUND_RADIUS_M + eye_altitude_m,
        base_m=base,
        thickness_m=layer.thickness_m,
        extinction_per_m=layer.extinction_per_m,
        threshold=layer.threshold,
        weather_origin=weather_origin(layer, level),
        noise_origin=noise_origin(layer, level),
        diffused=scatterer(layer.particles).diffused,
        pixel_rad=around.pixel_rad,
        top_squares_m2=_squares_m2(top, eye_altitude_m),
        base_squares_m2=_squares_m2(base, eye_altitude_m),
        ground_squares_m2=_squares_m2(ground, eye_altitude_m),
        eye_altitude_m=eye_altitude_m,
        light_from_above=light.by_sky / np.pi,
        light_from_below=light_from_below(layer, light),
        covered_share=covered_share,
        shadow_origin_m=level - plane.centre_m,
        shadow_near_m=plane.near_m,
        shadow_growth=plane.growth,
        ground_by_sun=light.by_sun / light.on_ground,
        sun_slope=plane.least_sine,
        ground_by_sky=sky_irradiance / light.on_ground,
        shadow_texels=plane.texels,
        noise_periods_m=(form.shape_period_m, form.detail_period_m),
        warp_origin=warp_origin(layer, level),
        spread_most=np.sqrt(3.0) * np.array(spread.most),
        spread_log_half=spread.log_half,
        spread_power=spread.power,
        volume_near_m=volume_near_m(layer.thickness_m),
        volume_growth=growth_of(volume_near_m(layer.thickness_m)),
        **{name: getattr(form, name) for name in _OF_FORM},
    )


def _squares_m2(altitude_m: float, eye_altitude_m: float) -> float:
    """The difference of two radii's squares, factored."""
    radii_m = 2.0 * GROUND_RADIUS_M + altitude_m + eye_altitude_m
    return (altitude_m - eye_altitude_m) * radii_m
