"""The light map and the probes of a frame on the GPU, and the block of numbers beside them.

The source of a mesh's light is compiled into its program: its own texels, the ground's chart,
probes, or the open sky without these.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.messages.light_map import GroundChart, LightMapLaid, ProbeGrid, SurfaceLightChanged
from vrut_lite.messages.sky import mean_level
from vrut_lite.messages.view_light import ViewLightChanged
from vrut_lite.render.gl_owner import bind_permanent_framebuffer
from vrut_lite.render.light import Light
from vrut_lite.render.open_irradiance import open_irradiance
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene
from vrut_lite.render.reflection_probes import MirrorCubes
from vrut_lite.render.relight_scale import age_factor
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.uniform_blocks import SURFACE_LIGHT

# As surface_light.glsl binds them.
_MAP_UNIT, _PROBE_UNIT, _OPEN_SKY_UNIT, _VISIBLE_SKY_UNIT = 5, 6, 7, 32
_VIEW_UNIT = 31
_UP = np.array([0.0, 1.0, 0.0])


class SurfaceLightOnGpu:
    """The textures of one hour's light; made and used on the GL thread only."""

    def __init__(self, context: Any):
        self._context = context
        self._block = context.buffer(reserve=SURFACE_LIGHT.size_bytes)
        self._laid: LightMapLaid | None = None
        self._light: SurfaceLightChanged | None = None
        self._open_sky: Any = None
        self._harmonics: NDArray | None = None
        self._map: Any = None
        self._visible_sky: Any = None
        self._visible_sky_is: Array | None = None
        self._probes: Any = None
        # Of points that a view shows their light, planes and what they mirror, and their message.
        self._view: Any = None
        self._view_is: ViewLightChanged | None = None
        self._mirrors = MirrorCubes(context)
        self._sees_sky: dict[PlacedPrimitive, bool] = {}

    def lay_out(self, laid: LightMapLaid | None) -> None:
        """Set the layout of the next light."""
        self._laid = laid

    def show(self, light: SurfaceLightChanged | None) -> None:
        """Upload the light of an hour in place of the last; None where there is none."""
        self._light = light
        self._sees_sky.clear()
        mirrors = None if light is None or self._laid is None else self._laid.mirrors
        self._mirrors.show(mirrors, light)
        if light is None:
            self._free()
            return
        self._map = self._written(self._map, light.texels.values, light.texels.shape[1::-1])
        self._show_visible_sky(light)
        if light.probes is not None:
            # The six faces one behind the other, each with all its slices.
            faces = np.moveaxis(light.probes.values, 3, 0)
            layers, rows, columns = faces.shape[0] * faces.shape[1], *faces.shape[2:4]
            self._probes = self._written(self._probes, faces, (columns, rows, layers))

    def show_view(self, light: ViewLightChanged | None) -> None:
        """Light what the next picture shows by points of its own; None or no points: by the map."""
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

    def defines(self, placed: PlacedPrimitive) -> Defines:
        """Defines of a mesh's program, by the source of its light."""
        if self._light is None or self._laid is None:
            return ()
        source = self._source(placed, self._laid)
        return (*source, "VIEW_LIGHT") if source and self._view is not None else source

    def _source(self, placed: PlacedPrimitive, laid: LightMapLaid) -> Defines:
        if placed.is_ground:
            return () if laid.ground is None else ("GROUND_LIGHT",)
        probes: Defines = () if laid.probes is None else ("LIGHT_PROBES",)
        mirror: Defines = ("MIRROR",) if self.mirrors(placed) else ()
        if placed.light_corner_px is None:
            return (*probes, *mirror) if probes else ()
        if placed.primitive.material.doubleSided:
            return ("LIGHT_MAP", "TWO_SIDED", *probes, *mirror)
        return ("LIGHT_MAP", *mirror) if self.sees_sky(placed) else ("LIGHT_MAP", "NO_SKY", *mirror)

    def mirrors(self, placed: PlacedPrimitive) -> bool:
        """Whether a mesh has a cube map of its surroundings."""
        return placed.mirror is not None and self._mirrors.there

    def upload_mirrors(self, seen: list[PlacedPrimitive]) -> int:
        """Bring the cubes of these meshes to the GPU; returns how many have some."""
        numbers = [placed.mirror for placed in seen if self.mirrors(placed)]
        for number in numbers:
            assert number is not None
            self._mirrors.upload(number)
        return len(numbers)

    def bind_mirror(self, placed: PlacedPrimitive, eye_m: NDArray[np.float64]) -> NDArray:
        """Hand a mesh its cubes; the eye (3,) as seen from their middle."""
        assert placed.mirror is not None
        return self._mirrors.bind(placed.mirror, eye_m)

    def sees_sky(self, placed: PlacedPrimitive) -> bool:
        """Whether a mesh may get light from the sky itself, and so from the sun."""
        if self._light is None or placed.light_corner_px is None or placed.light_end_px is None:
            return True
        if placed.primitive.material.doubleSided:
            return True
        if placed not in self._sees_sky:
            (left, top), (right, bottom) = placed.light_corner_px, placed.light_end_px
            share = self._light.texels.values[top:bottom, left:right, 3]
            self._sees_sky[placed] = bool(share.any())
        return self._sees_sky[placed]

    def bind(self, scene: PyrenderScene, light: Light, eye_m: NDArray[np.float64]) -> None:
        """Set light and layout for all meshes that are drawn next, relative to an eye (3,)."""
        if self._light is None or self._laid is None:
            return
        now, then = mean_level(light.irradiance_sh), self._light.sky_level
        age = 1.0 if then is None else age_factor(now, then)
        ground, probes = self._laid.ground or _NO_GROUND, self._laid.probes or _NO_PROBES
        self._block.write(
            SURFACE_LIGHT.packed(
                texel=1.0 / np.array(self._laid.size_px),
                radiance_scale=self._light.radiance_scale * age,
                ground_warp=ground.warp,
                ground_slope=np.sinh(ground.warp),
                ground_first=np.array(ground.corner_px) + 0.5,
                ground_eye_m=eye_m[[0, 2]] - scene.ground_centre_xz_m,
                ground_half_width_m=ground.half_width_m,
                ground_steps=ground.edge_px - 1,
                open_ground=evaluate_irradiance(light.irradiance_sh, _UP),
                probes_eye=(eye_m - probes.lower_m) / np.array(probes.step_m),
                probes_per_m=1.0 / np.array(probes.step_m),
                probe_counts=probes.counts,
                scene_m=2.0 * scene.radius_m,
                **self._view_fields(),
            )
        )
        self._block.bind_to_uniform_block(SURFACE_LIGHT.binding)
        self._map.use(location=_MAP_UNIT)
        self._visible_sky.use(location=_VISIBLE_SKY_UNIT)
        self._open_sky_of(light.irradiance_sh).use(location=_OPEN_SKY_UNIT)
        if self._laid.probes is not None:
            self._probes.use(location=_PROBE_UNIT)
        if self._view is not None:
            self._view.use(location=_VIEW_UNIT)

    def _view_fields(self) -> dict[str, Any]:
        light = self._view_is
        if light is None:
            return {"view_edge_px": 1.0, "view_height_px": 1.0, "view_scale": 1.0}
        return {
            "view_edge_px": light.edge_px,
            "view_height_px": light.size_px[1],
            "view_scale": light.radiance_scale,
        }

    def release(self) -> None:
        """Free the GL objects."""
        self.show_view(None)
        self._free()
        self._mirrors.release()
        self._release(self._open_sky)
        self._block.release()

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
        if texture is None or texture.size != size:
            self._release(texture)
            make = self._context.texture3d if len(size) == 3 else self._context.texture
            texture = make(size, values.shape[-1], dtype=f"f{values.itemsize}", alignment=1)
            texture.filter = (self._context.LINEAR, self._context.LINEAR)
            texture.repeat_x = texture.repeat_y = False
            if len(size) == 3:
                texture.repeat_z = False
        texture.write(np.ascontiguousarray(values).tobytes(), alignment=1)
        return texture

    def _free(self) -> None:
        self._release(self._map)
        self._release(self._probes)
        self._release(self._visible_sky)
        self._map = self._probes = self._visible_sky = self._visible_sky_is = None

    def _release(self, texture: Any) -> None:
        if texture is not None:
            bind_permanent_framebuffer(self._context)
            texture.release()


# Values for fields that no program reads.
_NO_GROUND = GroundChart(corner_px=(0, 0), edge_px=2, half_width_m=1.0, warp=1.0)
_NO_PROBES = ProbeGrid(lower_m=(0.0,) * 3, step_m=(1.0,) * 3, counts=(2, 2, 2))
