"""The lamps' part of the frame: a block of numbers, tables of luminaires and shadow maps."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lamps.lamp_shadows import EDGE_PX, FACE_SHARE, FACES, LampShadows
from vrut_lite.frame_part import FramePart, Heard, IsFree, PartFrame, PartGl
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.lamps import MOST_DRAWN, NONE, TABLE_SHAPE, SceneLamps
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import Float32Array, FloatArray
from vrut_lite.uniform_block import UniformBlock

_BLOCK = "lamp_block.glsl"
_SHADOWS, _TABLES = "lamp_shadows", "lamp_tables"
_SHARPEST_RAMP = 1e-3
LAMPS = UniformBlock(
    "Lamps",
    "lamps",
    fields={
        "lamps": (
            f"mat4[{MOST_DRAWN}]",
            "columns: place from the eye and slope of the cone's ramp; axis and cosine of its end; "
            "direction of a table's angle 0 and number of the table, or -1; intensity and the sign "
            "of the direction of 90 degrees",
        ),
        "tiles": ("vec2", "of the shadow maps, across and down"),
        "count": ("float", "of the lamps"),
        "depth_scale": ("float", "of depth in the shadow maps"),
        "depth_offset": ("float", "over the distance along a face's axis"),
        "face_share": ("float", "of a tile that the cube's face takes"),
        "texel": ("float", "width of a texel of the maps a metre away, in metres"),
    },
)


class LampsPart(FramePart):
    """Lights surfaces with the brightest lamps of the scene.

    The counters count each as "lamp" in each picture, and skip scenes without lamps.
    """

    hears = (SceneOpened,)
    blocks = {_BLOCK: LAMPS}  # noqa: RUF012  (the base class says that it is the class's)
    samplers = (_SHADOWS, _TABLES)
    extra_lights = Path(__file__).parent / "shaders" / "extra_lights.glsl"

    def __init__(self, gl: PartGl):
        super().__init__(gl)
        self._binding = gl.block(_BLOCK).binding
        self._shadow_unit, self._table_unit = gl.unit(_SHADOWS), gl.unit(_TABLES)
        self._block = gl.context.buffer(reserve=LAMPS.size_bytes)
        self._shadows = LampShadows(gl)
        self._tables: Any = None
        self._lamps: SceneLamps | None = None

    @classmethod
    def extra_irradiance(
        cls,
        heard: Heard,
        camera: MoveCamera,
        point_m: FloatArray,
        normal: FloatArray,
        is_free: IsFree,
    ) -> FloatArray:
        """Irradiance (3,), W m^-2, of the lamps that are drawn, on a plane."""
        total, lamps = np.zeros(3), _lamps(heard)
        for lamp in range(0 if lamps is None else min(lamps.count, MOST_DRAWN)):
            assert lamps is not None
            away = lamps.position_m.values[lamp] - point_m
            reach_m = float(np.linalg.norm(away))
            if reach_m > 0.0 and normal @ away > 0.0 and is_free(away / reach_m, reach_m):
                total += lamps.irradiance_at(lamp, point_m, normal)
        return total

    def show(self, heard: Heard) -> None:
        """Light surfaces with these lamps from the next picture on."""
        self._lamps = _lamps(heard)
        self._release_tables()
        if self._lamps is None:
            self.gl.counters.skip("lamps: none in the scene")
            self._shadows.release()
            return
        tables = self._lamps.tables.values
        if len(tables) == 0:
            tables = np.ones((1, *TABLE_SHAPE), np.float32)
        size = (TABLE_SHAPE[1], TABLE_SHAPE[0], len(tables))
        context = self.gl.context
        self._tables = context.texture_array(size, 1, tables.tobytes(), dtype="f4")
        self._tables.filter = (context.LINEAR, context.LINEAR)
        self._tables.repeat_x = self._tables.repeat_y = False

    @property
    def is_seen(self) -> bool:
        """Whether the scene has lamps."""
        return self._lamps is not None

    def prepare(self, frame: PartFrame) -> None:
        """Draw the shadow maps if the scene is another, and bind everything for the shaders."""
        assert self._lamps is not None
        count = min(self._lamps.count, MOST_DRAWN)
        shadows = self._shadows.update(frame.casters, self._lamps, count)
        self._block.write(
            LAMPS.packed(
                lamps=_rows(self._lamps, count, frame.view.eye_m),
                count=count,
                depth_scale=self._shadows.depth.scale,
                depth_offset=self._shadows.depth.offset,
                face_share=FACE_SHARE,
                tiles=(FACES, count),
                texel=2.0 / (FACE_SHARE * EDGE_PX),
            )
        )
        self._block.bind_to_uniform_block(self._binding)
        shadows.use(location=self._shadow_unit)
        self._tables.use(location=self._table_unit)
        self.gl.counters.did("lamp", count)

    def release(self) -> None:
        """Free the GL objects."""
        self._shadows.release()
        self._release_tables()
        self._block.release()

    def _release_tables(self) -> None:
        if self._tables is not None:
            self._tables.release()
        self._tables = None


def _lamps(heard: Heard) -> SceneLamps | None:
    scene = heard.get(SceneOpened)
    assert scene is None or isinstance(scene, SceneOpened)
    return None if scene is None else scene.lamps


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
