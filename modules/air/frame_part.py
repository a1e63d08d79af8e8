"""The air's part of the frame.

Surfaces and sky apply the air where they are shaded (shaders/air.glsl). Each fragment knows how
far it is, so that edges with several samples and meshes that let light through come out right,
and no pass over all samples has to read a depth buffer.
"""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from air.air_textures import SAMPLERS, AirOnGpu
from air.block import AIR, BLOCK
from air.near_air import NEAR_SAMPLERS, NearAirTable, second_light
from vrut_lite.frame_part import SUN_GLOW_RAD, FramePart, Heard, PartFrame, PartGl
from vrut_lite.messages.air import AirChanged

_SHAFT_SHADOW = "shaft_shadow_map"


class AirPart(FramePart):
    """Draws the air before surfaces and sky; the counters count "air" and "light shafts"."""

    hears = (AirChanged,)
    blocks = {BLOCK: AIR}  # noqa: RUF012  (the base class says that it is the class's)
    samplers = (*SAMPLERS, *NEAR_SAMPLERS, _SHAFT_SHADOW)
    through_air = Path(__file__).parent / "shaders" / "through_air.glsl"
    switch = "air"

    def __init__(self, gl: PartGl):
        super().__init__(gl)
        self._air = AirOnGpu(gl)
        self._near = NearAirTable(gl)
        self._shadow_unit = gl.unit(_SHAFT_SHADOW)
        # Eye (3,) of the picture, and distance from it up to which the table holds.
        self._eye_m, self._near_m = np.zeros(3), 0.0
        # Where surfaces shade the glow: towards the sun (3,), in world axes.
        self._sun_direction: NDArray[np.float64] | None = None

    def show(self, heard: Heard) -> None:
        """Draw this air from the next picture on."""
        message = heard.get(AirChanged)
        assert message is None or isinstance(message, AirChanged)
        self._air.show(None if message is None else message.volume)

    @property
    def is_seen(self) -> bool:
        """Whether there is air to be seen."""
        return self._air.volume is not None

    def prepare(self, frame: PartFrame) -> None:
        """Bind the air of this picture, and the table of near air unless there are shafts.

        Without shafts, surfaces in the glow around the sun shade the air before them: otherwise
        the glow would lie on the hill that hides the sun.
        """
        volume = self._air.volume
        assert volume is not None
        self._air.bind(frame)
        self._eye_m, self._near_m = frame.view.eye_m, 0.0
        self._sun_direction = None
        if frame.shadow is not None:
            frame.shadow.texture.use(location=self._shadow_unit)
        if frame.light_shafts:
            self.gl.counters.did("light shafts")
        else:
            self._near_m = self._near.draw(volume, frame.view)
            if frame.shadow is not None:
                self._sun_direction = np.array(volume.sun_direction)
                self.gl.counters.did("air: shade in the sun's glow")
        self.gl.counters.did("air")

    @property
    def air_defines(self) -> tuple[str, ...]:
        """Whether two bodies light the air."""
        return () if self._air.volume is None else second_light(self._air.volume)

    def air_defines_on(self, centre_m: NDArray[np.float64], radius_m: float) -> tuple[str, ...]:
        """Whether all of a mesh is near, or else part of it in the glow around the sun."""
        away_m = centre_m - self._eye_m
        distance_m = float(np.linalg.norm(away_m))
        if distance_m + radius_m <= self._near_m:
            return ("NEAR_AIR",)
        if self._sun_direction is None:
            return ()
        if distance_m > radius_m:
            to_sun_rad = math.acos(np.clip(away_m @ self._sun_direction / distance_m, -1.0, 1.0))
            if to_sun_rad > SUN_GLOW_RAD + math.asin(radius_m / distance_m):
                return ()
        return ("SHADED_GLOW",)

    def release(self) -> None:
        """Free the GL objects."""
        self._air.release()
        self._near.release()
