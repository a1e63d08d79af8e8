"""The light of a light map on the GPU, and the block of numbers beside it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from light_transport.drawing import reflection_probes
from light_transport.drawing.hour_on_card import HourOnCard
from light_transport.drawing.light_block import BLOCK
from light_transport.drawing.mapped_scene import MappedScene
from light_transport.drawing.open_irradiance import open_irradiance
from vrut_lite.array import Array
from vrut_lite.frame_part import PartFrame, PartGl
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.light_map import GroundChart, ProbeGrid, SurfaceLightChanged
from vrut_lite.messages.view_light import ViewLightChanged
from vrut_lite.sky.relight_scale import age_factor

_MAP, _PROBES, _OPEN_SKY = "light_map", "light_probes", "open_sky"
_VISIBLE_SKY, _VIEW = "visible_sky", "view_points"
SAMPLERS = (_MAP, _PROBES, _OPEN_SKY, _VISIBLE_SKY, _VIEW, *reflection_probes.SAMPLERS)
_UP = np.array([0.0, 1.0, 0.0])


class SurfaceLightOnGpu:
    """The textures of one hour's light; made and used on the GL thread only."""

    def __init__(self, gl: PartGl):
        self._gl, self._context = gl, gl.context
        self._block = gl.block(BLOCK)
        self._buffer = gl.context.buffer(reserve=self._block.size_bytes)
        self._light: SurfaceLightChanged | None = None
        self._open_sky: Any = None
        self._harmonics: NDArray | None = None
        self._map: Any = None
        self._visible_sky: Any = None
        self._visible_sky_is: Array | None = None
        self._probes: Any = None
        # Light, planes and mirrored radiance of the points of a view, and their message.
        self._view: Any = None
        self._view_is: ViewLightChanged | None = None

    def show(self, light: SurfaceLightChanged, card: HourOnCard | None) -> None:
        """Upload the light of an hour in place of the last, unless it is there.

        With a `card` that has computed it nothing of it is uploaded.
        """
        if light is self._light:
            return
        self._light = light
        size_px = light.texels.shape[1::-1]
        if card is None:
            self._map = self._written(self._map, light.texels.values, size_px)
        else:
            self._map = self._made(self._map, size_px, 4, "f4")
            card.write_map(self._map)
        self._show_visible_sky(light)
        if light.probes is not None:
            # The six faces one behind the other, each with all its slices.
            slices, rows, columns, faces = light.probes.shape[:4]
            size = columns, rows, faces * slices
            if card is None:
                values = np.moveaxis(light.probes.values, 3, 0)
                self._probes = self._written(self._probes, values, size)
            else:
                self._probes = self._made(self._probes, size, 4, "f4")
                card.write_probes(self._probes)

    def show_view(self, light: ViewLightChanged | None) -> bool:
        """Upload the points of a view; returns whether there are any."""
        if light is None or light is not self._view_is:
            self._release(self._view)
            self._view = None
        if light is not None and self._view is None and light.plane.values.any():
            layers = np.stack([light.light.values, light.plane.values, *light.mirrored.values])
            # Row 0 at the bottom, as fragments count.
            values = layers[:, ::-1].astype(np.float32)
            self._view = self._written(None, values, (*values.shape[2:0:-1], len(values)))
            self._view.filter = (self._context.NEAREST, self._context.NEAREST)
        self._view_is = light
        return self._view is not None

    def bind(self, lit: MappedScene, frame: PartFrame) -> None:
        """Bind light, layout and sky for all surfaces of a picture."""
        scene, laid, light = lit
        eye_m, sky = frame.view.eye_m, frame.whole_sky
        harmonics = sky.irradiance_sh_rgb.values
        age = 1.0 if light.sky_level is None else age_factor(sky.level, light.sky_level)
        ground, probes = laid.ground or _NO_GROUND, laid.probes or _NO_PROBES
        middle_xz_m = (0.0, 0.0) if scene.ground is None else scene.ground.centre_xz_m
        across_m = float(np.linalg.norm(np.subtract(scene.upper_m, scene.lower_m)))
        self._buffer.write(
            self._block.packed(
                texel=1.0 / np.array(laid.size_px),
                radiance_scale=light.radiance_scale * age,
                ground_warp=ground.warp,
                ground_slope=np.sinh(ground.warp),
                ground_first=np.array(ground.corner_px) + 0.5,
                ground_eye_m=eye_m[[0, 2]] - middle_xz_m,
                ground_half_width_m=ground.half_width_m,
                ground_steps=ground.edge_px - 1,
                open_ground=evaluate_irradiance(harmonics, _UP),
                probes_eye=(eye_m - probes.lower_m) / np.array(probes.step_m),
                probes_per_m=1.0 / np.array(probes.step_m),
                probe_counts=probes.counts,
                scene_m=max(across_m, 2e-6),
                **self._view_fields(),
            )
        )
        self._buffer.bind_to_uniform_block(self._block.binding)
        bound = {
            _MAP: self._map,
            _VISIBLE_SKY: self._visible_sky,
            _OPEN_SKY: self._open_sky_of(harmonics),
            _PROBES: None if laid.probes is None else self._probes,
            _VIEW: self._view,
        }
        for sampler, texture in bound.items():
            if texture is not None:
                texture.use(location=self._gl.unit(sampler))
        # Another unit becomes the active one: textures that are made later take no map's place.
        self._map.use(location=0)

    def _view_fields(self) -> dict[str, Any]:
        light = self._view_is
        if light is None:
            return {"view_edge_px": 1.0, "view_height_px": 1.0, "view_scale": 1.0}
        return {
            "view_edge_px": light.edge_px,
            "view_height_px": light.size_px[1],
            "view_scale": light.radiance_scale,
        }

    def free(self) -> None:
        """Free the textures of the light."""
        for texture in (self._map, self._probes, self._visible_sky):
            self._release(texture)
        self._map = self._probes = self._visible_sky = self._visible_sky_is = None
        self._light = None
        self.show_view(None)

    def release(self) -> None:
        """Free the GL objects."""
        self.free()
        self._release(self._open_sky)
        self._buffer.release()

    def _show_visible_sky(self, light: SurfaceLightChanged) -> None:
        """Upload towards where texels see the sky, unless it is what hours before had."""
        known = light.visible_sky
        if known is not None and known is self._visible_sky_is:
            return
        if known is None:
            # The same in all directions.
            values = light.texels.values * np.array([0.0, 0.0, 0.0, 1.0], np.float16)
        else:
            values = known.values
        self._visible_sky = self._written(self._visible_sky, values, values.shape[1::-1])
        self._visible_sky_is = known

    def _open_sky_of(self, harmonics: NDArray) -> Any:
        """The table of `open_irradiance` of these harmonics (25, 3)."""
        if self._harmonics is None or not np.array_equal(harmonics, self._harmonics):
            self._harmonics = np.array(harmonics)
            # With an alpha of no use: llvmpipe looks up four numbers in less time than three.
            table = np.insert(open_irradiance(self._harmonics), 3, 1.0, axis=-1)
            self._open_sky = self._written(self._open_sky, table, table.shape[1::-1])
        return self._open_sky

    def _written(self, texture: Any, values: NDArray[Any], size: tuple[int, ...]) -> Any:
        """Values in a texture of that size: the one given, or a new one in its place."""
        texture = self._made(texture, size, values.shape[-1], f"f{values.itemsize}")
        texture.write(np.ascontiguousarray(values).tobytes(), alignment=1)
        return texture

    def _made(self, texture: Any, size: tuple[int, ...], channels: int, dtype: str) -> Any:
        """A texture of that size and type of texels: the one given, or a new one in its place."""
        kind = size, channels, dtype
        if texture is None or (texture.size, texture.components, texture.dtype) != kind:
            self._release(texture)
            make = self._context.texture3d if len(size) == 3 else self._context.texture
            texture = make(size, channels, dtype=dtype, alignment=1)
            texture.filter = (self._context.LINEAR, self._context.LINEAR)
            texture.repeat_x = texture.repeat_y = False
            if len(size) == 3:
                texture.repeat_z = False
        return texture

    def _release(self, texture: Any) -> None:
        if texture is not None:
            self._gl.leave_framebuffers()
            texture.release()


# Values for fields that no program reads.
_NO_GROUND = GroundChart(corner_px=(0, 0), edge_px=2, half_width_m=1.0, warp=1.0)
_NO_PROBES = ProbeGrid(lower_m=(0.0,) * 3, step_m=(1.0,) * 3, counts=(2, 2, 2))
