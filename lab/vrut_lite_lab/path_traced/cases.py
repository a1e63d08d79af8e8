"""Which scenes, hours and skies are compared, and the state that both backends draw of each."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import msgspec
import numpy as np
from light_transport.hour.illumination import Illumination

from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.project import Project, daylight_inputs, view_inputs
from vrut_lite.scene.scene_state import SceneState
from vrut_lite.studio.engines import EngineHost
from vrut_lite_lab.pictures.drawing import SCENES, SKIES, scene_project

DRAWN = ("street.toml", "large/hall.toml", "work/indoor.glb", "pavilion.gltf", "spheres.glb",
         "large/terrain.toml", "sundial.toml", "work/ground.glb")  # fmt: skip
HOURS = ("07:00", "12:30", "20:00")
SIZE = (240, 150)
# Of a truth, per pixel: region means are then right to well below 1 %. Light through windows is
# found by few paths.
SAMPLES = 32
MORE_SAMPLES = {"street": 64, "hall": 128, "indoor": 128, "staircase": 64, "corridor": 64,
                "thin_room": 64, "colour_bleeding": 64}  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A scene (a file in scenes/, or a path), a sky's module and an hour of 21 June in Prague."""

    scene: str
    sky: str
    hour: str

    @property
    def name(self) -> str:
        """Of files."""
        return f"{Path(self.scene).stem}-{self.sky}-{self.hour.replace(':', '')}"

    @property
    def caption(self) -> str:
        """For people."""
        return f"{Path(self.scene).stem} {self.hour} {SKIES[self.sky]}"

    @property
    def samples(self) -> int:
        """Of a truth, per pixel."""
        return MORE_SAMPLES.get(Path(self.scene).stem, SAMPLES)

    @cached_property
    def project(self) -> Project:
        """Turbidity 3, albedo 0.1, no air."""
        return scene_project(
            self.scene,
            place="50.0755,14.4378,200",
            at=f"2026-06-21T{self.hour}",
            slots={"sky": self.sky},
            settings={self.sky: {"turbidity": 3.0, "albedo": 0.1}},
            size=SIZE,
            air=False,
        )

    @cached_property
    def content(self) -> str:
        """Digest of the scene's file and of the project that frames it."""
        digest = hashlib.blake2b(digest_size=4)
        for path in sorted({str(SCENES / self.scene), self.project.scene}):
            digest.update(Path(path).read_bytes())
        return digest.hexdigest()


def states(
    scene: str, sky: str, hours: tuple[str, ...] = HOURS, size: tuple[int, int] = SIZE
) -> Iterator[tuple[Case, SceneState]]:
    """The state to draw at each hour, from one kernel."""
    cases = [Case(scene, sky, hour) for hour in hours]
    host = EngineHost("path-tracer", cases[0].project)
    try:
        for case in cases:
            project = msgspec.structs.replace(case.project, size=size)
            host.inject(*daylight_inputs(project), *view_inputs(project))
            host.settle()
            yield case, host.state
    finally:
        host.close()


def light_of_state(state: SceneState) -> Illumination:
    """The light of a state's scene, in plain arrays."""
    sky, key_light, ambient = state.background, state.key_light, state.ambient
    assert sky is not None
    assert key_light is not None
    assert ambient is not None
    return Illumination(
        sky=decode_float16(sky.cube.values, sky.radiance_scale),  # type: ignore[union-attr]
        ground_radiance_rgb=sky.ground_radiance_rgb,
        ground_albedo_rgb=state.ground_albedo_rgb,
        key_direction=key_light.direction,
        key_irradiance_rgb=key_light.irradiance_rgb,
        open_sky=np.asarray(ambient.irradiance_sh_rgb.values, float),
    )
