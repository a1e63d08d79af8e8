"""What lights a place in a cloud, as textures: depths around the eye, the tables of transport."""

from typing import Any

import numpy as np

from vrut_lite.daylight.cloud_transport import scatterer, transport_tables
from vrut_lite.render.clouds.layer_textures import CloudsOnGpu
from vrut_lite.render.shader_files import defined, shader_source
from vrut_lite.render.unlocked import run_compute

# As cloud_light.glsl binds them.
_VOLUME_UNIT, _SOURCE_UNIT, _PHASE_UNIT = 5, 6, 7
_COLUMNS, _HEIGHTS, _GROUP = 160, 16, 8


class CloudLightVolume:
    """Made and used on the GL thread only; the block of the clouds must be bound."""

    def __init__(self, context: Any):
        self._context = context
        text = shader_source("cloud_volume.comp")
        self._fill = context.compute_shader(defined(text, {"FILL": 1}))
        self._sum = context.compute_shader(text)
        size = _COLUMNS, _COLUMNS, _HEIGHTS
        self._density = context.texture3d(size, 1, dtype="f2")
        # The edges of the heights: the outermost stay 0.
        nothing = np.zeros((_HEIGHTS + 1, _COLUMNS, _COLUMNS, 4), np.float16)
        self._depths = context.texture3d(nothing.shape[2::-1], 4, nothing.tobytes(), dtype="f2")
        source = transport_tables().source.astype(np.float16)
        views, above = source.shape[3], source.shape[2]
        self._source = context.texture3d(
            (views, above, source.shape[0] * source.shape[1]), 4, source.tobytes(), dtype="f2"
        )
        nodes = scatterer("droplets").phase.shape[1::-1]
        self._phase = context.texture(nodes, 3, dtype="f4", alignment=1)
        for texture in (self._density, self._depths, self._source, self._phase):
            texture.filter = (context.LINEAR, context.LINEAR)
            texture.repeat_x = texture.repeat_y = False
        for texture in (self._density, self._depths, self._source):
            texture.repeat_z = False

    def draw(self, clouds: CloudsOnGpu) -> None:
        """Sum the layer's depths for its sun, around its eye."""
        groups = _COLUMNS // _GROUP
        assert clouds.layer is not None
        phase = scatterer(clouds.layer.particles).phase.astype(np.float32)
        self._phase.write(phase.tobytes(), alignment=1)
        clouds.bind_noises()
        self._density.bind_to_image(0, read=False, write=True)
        run_compute(self._fill, groups, groups, 1)
        self._context.memory_barrier()
        self._density.use(location=0)
        self._depths.use(location=1)
        self._depths.bind_to_image(0, read=True, write=True)
        self._sum["heights"].value = float(_HEIGHTS)
        for way, heights in enumerate((range(_HEIGHTS - 1, -1, -1), range(_HEIGHTS))):
            self._sum["way"].value = way
            for height in heights:
                self._sum["height"].value = height
                run_compute(self._sum, groups, groups, 1)
                self._context.memory_barrier()

    def bind(self) -> None:
        """Set the inputs of the light in clouds."""
        self._depths.use(location=_VOLUME_UNIT)
        self._source.use(location=_SOURCE_UNIT)
        self._phase.use(location=_PHASE_UNIT)

    def release(self) -> None:
        """Free the GL objects."""
        for thing in (
            self._fill,
            self._sum,
            self._density,
            self._depths,
            self._source,
            self._phase,
        ):
            thing.release()
