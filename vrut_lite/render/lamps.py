"""The lamps of a frame on the GPU: a block of numbers, tables of luminaires and shadow maps."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.kernel.work_counters import WorkCounters
from vrut_lite.messages.lamps import MOST_DRAWN, NONE, TABLE_SHAPE, SceneLamps
from vrut_lite.numeric_types import Float32Array
from vrut_lite.render.gl_owner import bind_permanent_framebuffer
from vrut_lite.render.passes.lamp_shadows import EDGE_PX, FACE_SHARE, FACES, LampShadows
from vrut_lite.render.passes.mesh_renderer import MeshRenderer
from vrut_lite.render.pyrender_scene import PyrenderScene
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.uniform_blocks import LAMPS

# As lamps.glsl binds them.
_SHADOW_UNIT, _TABLE_UNIT = 24, 25
_SHARPEST_RAMP = 1e-3


class LampsOnGpu:
    """The brightest lamps of a scene; made and used on the GL thread only."""

    def __init__(self, context: Any, counters: WorkCounters):
        self._context = context
        self._counters = counters
        self._block = context.buffer(reserve=LAMPS.size_bytes)
        self._shadows = LampShadows(context, counters)
        self._tables: Any = None
        self._lamps: SceneLamps | None = None

    @property
    def defines(self) -> Defines:
        """What programs of meshes are compiled with."""
        return () if self._lamps is None else ("LAMPS",)

    def show(self, lamps: SceneLamps | None) -> None:
        """Light meshes with these from the next frame on."""
        self._lamps = lamps
        self._release_tables()
        if lamps is None:
            self._shadows.release()
            return
        tables = lamps.tables.values
        if len(tables) == 0:
            tables = np.ones((1, *TABLE_SHAPE), np.float32)
        size = (TABLE_SHAPE[1], TABLE_SHAPE[0], len(tables))
        self._tables = self._context.texture_array(size, 1, tables.tobytes(), dtype="f4")
        self._tables.filter = (self._context.LINEAR, self._context.LINEAR)
        self._tables.repeat_x = self._tables.repeat_y = False

    def update(
        self,
        meshes: MeshRenderer,
        scene: PyrenderScene,
        eye_m: NDArray[np.float64],
        always: bool,
    ) -> None:
        """Draw the shadow maps where the scene is another, and hand all to the shaders."""
        if self._lamps is None:
            self._counters.skip("lamps: none in the scene")
            return
        count = min(self._lamps.count, MOST_DRAWN)
        shadows = self._shadows.update(meshes, scene, self._lamps, count, always)
        self._block.write(
            LAMPS.packed(
                lamps=_rows(self._lamps, count, eye_m),
                count=count,
                depth_scale=self._shadows.depth.scale,
                depth_offset=self._shadows.depth.offset,
                face_share=FACE_SHARE,
                tiles=(FACES, count),
                texel=2.0 / (FACE_SHARE * EDGE_PX),
            )
        )
        self._block.bind_to_uniform_block(LAMPS.binding)
        shadows.use(location=_SHADOW_UNIT)
        self._tables.use(location=_TABLE_UNIT)
        self._counters.did("lamp", count)

    def release(self) -> None:
        """Free the GL objects; another framebuffer must be bound."""
        self._shadows.release()
        self._release_tables()
        self._block.release()

    def _release_tables(self) -> None:
        if self._tables is not None:
            bind_permanent_framebuffer(self._context)
            self._tables.release()
        self._tables = None


def _rows(lamps: SceneLamps, count: int, eye_m: NDArray[np.float64]) -> Float32Array:
    """A matrix (4, 4) a lamp, MOST_DRAWN of them, whose columns are what LAMPS says."""
    rows = np.zeros((MOST_DRAWN, 4, 4))
    for lamp in range(count):
        axis, across, side = lamps.axes.values[lamp]
        inner, outer = lamps.cone_cos.values[lamp]
        table = int(lamps.table.values[lamp])
        turn = np.sign(np.cross(across, axis) @ side)
        rows[lamp] = [
            [*(lamps.position_m.values[lamp] - eye_m), 1.0 / max(inner - outer, _SHARPEST_RAMP)],
            [*axis, outer],
            [*across, -1.0 if table == NONE else float(table)],
            [*lamps.intensity_rgb.values[lamp], turn],
        ]
    return np.swapaxes(rows, 1, 2).astype(np.float32)
