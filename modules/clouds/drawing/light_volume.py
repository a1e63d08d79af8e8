"""Textures of the light inside clouds: the light volume and the transport tables."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from clouds.model.cloud_field import cloud_field
from clouds.model.cloud_light_volume import light_volume
from clouds.model.cloud_transport import scatterer, transport_tables
from vrut_lite.frame_part import PartGl
from vrut_lite.messages.clouds import CloudLayer
from vrut_lite.numeric_types import Vector

# As cloud_light.glsl binds them.
_VOLUME_UNIT, _SOURCE_UNIT, _PHASE_UNIT = 5, 6, 7
SAMPLER = "light_diffuse"
_MOST = 6e4  # of 16 bits


class CloudLightVolume:
    """Made and used on the GL thread only."""

    def __init__(self, gl: PartGl):
        context = self._context = gl.context
        self._diffuse_unit = gl.unit(SAMPLER)
        source = transport_tables().source.astype(np.float16)
        views, above = source.shape[3], source.shape[2]
        self._source = context.texture3d(
            (views, above, source.shape[0] * source.shape[1]), 4, source.tobytes(), dtype="f2"
        )
        nodes = scatterer("droplets").phase.shape[1::-1]
        self._phase = context.texture(nodes, 3, dtype="f4", alignment=1)
        for texture in (self._source, self._phase):
            _smooth(context, texture)
        self._source.repeat_z = False
        # Depths and diffuse light.
        self._volumes: list[Any] = []

    def fill(self, layer: CloudLayer, sun: Vector, centre_m: NDArray[np.float64]) -> None:
        """The light in a layer around a place (2,), world x and z."""
        particles = scatterer(layer.particles)
        self._phase.write(particles.phase.astype(np.float32).tobytes(), alignment=1)
        field = cloud_field(layer, (float(centre_m[0]), 0.0, float(centre_m[1])))
        towards = np.asarray(sun, dtype=float)
        made = light_volume(field, towards, particles.diffused)
        texels = [np.clip(part, -_MOST, _MOST) for part in (made.depths, made.diffuse)]
        if not self._volumes:
            self._volumes = [
                self._context.texture3d(part.shape[2::-1], part.shape[3], dtype="f2", alignment=1)
                for part in texels
            ]
            for texture in self._volumes:
                _smooth(self._context, texture)
                texture.repeat_z = False
        for texture, part in zip(self._volumes, texels, strict=True):
            texture.write(part.astype(np.float16).tobytes(), alignment=1)

    def bind(self) -> None:
        """Set the inputs of the light in clouds."""
        depths, diffuse = self._volumes
        depths.use(location=_VOLUME_UNIT)
        diffuse.use(location=self._diffuse_unit)
        self._source.use(location=_SOURCE_UNIT)
        self._phase.use(location=_PHASE_UNIT)

    def release(self) -> None:
        """Free the GL objects."""
        for thing in (self._source, self._phase, *self._volumes):
            thing.release()


def _smooth(context: Any, texture: Any) -> None:
    texture.filter = (context.LINEAR, context.LINEAR)
    texture.repeat_x = texture.repeat_y = False
