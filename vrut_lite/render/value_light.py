"""Values of a light map as its light: what programs look up is then the value itself."""

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.array import Array
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.messages.light_map import SurfaceLightChanged
from vrut_lite.messages.light_map_values import noise, noise_of_pair, texel_edges_m
from vrut_lite.messages.picture import SetExposure
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.pictures.exposure import ev100_of
from vrut_lite.pictures.picture import Picture
from vrut_lite.pictures.value_picture import value_pixels, values_of
from vrut_lite.scene.scene_state import SceneState, Shown

# Look-ups reach so many texels beside those that are known.
_BESIDE = 2
# Share of a pixel's samples that must show a surface.
_LEAST_COVERED = 0.5


class ValueLight:
    """The values of a state's light map, made once for each map or light."""

    def __init__(self) -> None:
        self._of: tuple[object, ...] = ()
        self._light: SurfaceLightChanged | None = None

    def of(self, state: SceneState) -> SurfaceLightChanged | None:
        """Light whose red is the value that the state shows; None where none is known."""
        of = (state.shows, state.light_map, state.surface_light, state.coarser_light)
        if len(self._of) != len(of) or any(a is not b for a, b in zip(of, self._of, strict=True)):
            self._of, self._light = of, _values(state)
        return self._light


def in_false_colours(resolved: Float32Array, shows: Shown) -> Picture:
    """The picture of what programs said (h, w, 4): alpha is the share of a pixel with a value."""
    value: NDArray[np.floating] = resolved[..., 0]
    if shows == "illuminance":
        value = luminance(resolved[..., :3]) * LUMENS_PER_WATT
    covered = (resolved[..., 3] >= _LEAST_COVERED) & (value > 0.0)
    share = np.where(covered, resolved[..., 3], 1.0)
    values = np.where(covered, value / share, np.nan).astype(np.float32)
    found = values_of(values, shows)
    each = np.repeat(np.nan_to_num(values)[..., None], 3, axis=-1)
    return Picture(each, value_pixels(found), ev100_of(SetExposure(), each), found)


def _values(state: SceneState) -> SurfaceLightChanged | None:
    laid, light, scene = state.light_map, state.surface_light, state.scene
    if laid is None or light is None or scene is None:
        return None
    probes = None
    if state.shows == "texels":
        texels = texel_edges_m(laid, scene)
        if laid.probes is not None:
            assert light.probes is not None
            probes = np.full(light.probes.shape[:4], max(laid.probes.step_m))
    else:
        coarser = state.coarser_light
        if coarser is None:
            return None
        texels = noise_of_pair(light, coarser)
        if light.probes is not None and coarser.probes is not None:
            one, other = (
                each.probes.values[..., :3].astype(float) * each.radiance_scale
                for each in (light, coarser)
                if each.probes is not None
            )
            rows = noise(one.reshape(1, -1, 3), other.reshape(1, -1, 3), light.rays / coarser.rays)
            probes = rows.reshape(light.probes.shape[:4])
    return msgspec.structs.replace(
        light,
        texels=Array(_light(_grown(texels))),
        probes=None if probes is None else Array(_light(probes)),
        radiance_scale=1.0,
        visible_sky=None,
        mirrors=None,
    )


def _grown(values: FloatArray) -> FloatArray:
    """Values (h, w) whose zeros have the largest value beside them."""
    for _ in range(_BESIDE):
        height, width = values.shape
        wide = np.pad(values, 1)
        boxes = [wide[i : i + height, j : j + width] for i in range(3) for j in range(3)]
        values = np.where(values > 0.0, values, np.max(boxes, axis=0))
    return values


def _light(values: FloatArray) -> NDArray[np.float16]:
    rgba = np.repeat(np.asarray(values)[..., None], 4, axis=-1).astype(np.float16)
    rgba[..., 3] = 1.0
    return rgba
