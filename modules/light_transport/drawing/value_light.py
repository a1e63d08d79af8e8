"""Values of a light map as its light: what programs look up is then the value itself."""

import msgspec
import numpy as np
from numpy.typing import NDArray

from light_transport.drawing.mapped_scene import MappedScene
from light_transport.drawing.texel_values import noise, noise_of_pair, texel_edges_m
from vrut_lite.array import Array
from vrut_lite.messages.light_map import SurfaceLightChanged
from vrut_lite.numeric_types import FloatArray

# Look-ups reach so many texels beside those that are known.
_BESIDE = 2


class ValueLight:
    """The values of a mapped scene, made once for each map or light."""

    def __init__(self) -> None:
        self._of: tuple[object, ...] = ()
        self._light: SurfaceLightChanged | None = None

    def of(
        self, shows: str, lit: MappedScene, fewer: SurfaceLightChanged | None
    ) -> SurfaceLightChanged | None:
        """Light whose red is the value that is shown: "texels", edges in metres, or "noise".

        `fewer`: light of the same hour by fewer rays. None where it is missing for the noise.
        """
        of = (shows, *lit, fewer)
        if len(self._of) != len(of) or any(a is not b for a, b in zip(of, self._of, strict=True)):
            self._of, self._light = of, _values(shows, lit, fewer)
        return self._light


def _values(
    shows: str, lit: MappedScene, fewer: SurfaceLightChanged | None
) -> SurfaceLightChanged | None:
    scene, laid, light = lit
    probes = None
    if shows == "texels":
        texels = texel_edges_m(laid, scene)
        if laid.probes is not None:
            assert light.probes is not None
            probes = np.full(light.probes.shape[:4], max(laid.probes.step_m))
    elif fewer is None:
        return None
    else:
        texels = noise_of_pair(light, fewer)
        if light.probes is not None and fewer.probes is not None:
            one, other = (
                each.probes.values[..., :3].astype(float) * each.radiance_scale
                for each in (light, fewer)
                if each.probes is not None
            )
            rows = noise(one.reshape(1, -1, 3), other.reshape(1, -1, 3), light.rays / fewer.rays)
            probes = rows.reshape(light.probes.shape[:4])
    return msgspec.structs.replace(
        light,
        texels=Array(_light(_grown(texels))),
        probes=None if probes is None else Array(_light(probes)),
        radiance_scale=1.0,
        sky_level=None,
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
