"""Half shadows of finished stills beside the path tracer's, in the sun's own light alone.

    python -m vrut_lite_lab.path_traced.soft_shadows SHEET.webp [--spp N]

Columns of the sheet are the finished still under a sun without width, under the sun, and the path
tracer's picture. A Markdown table is printed of an edge that climbs over level ground: its width
from 10 to 90 % of the light, at five heights. Nothing is kept on disk; all takes some minutes of
one core.
"""

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from vrut_lite.installed_parts import heard_with
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged
from vrut_lite.numeric_types import FloatArray
from vrut_lite.pictures.display import display_picture
from vrut_lite.pictures.exposure import ev100_of
from vrut_lite.project import CameraView, Project, daylight_inputs, load_project, view_inputs
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.pyrender_backend import PyrenderBackend
from vrut_lite.scene.scene_state import NO_PARTS, SceneState
from vrut_lite.studio.engines import EngineHost
from vrut_lite_lab.path_traced.truths import SUN, lit_by, traced
from vrut_lite_lab.pictures.darkness import relit
from vrut_lite_lab.pictures.drawing import SCENES, Captioned, sheet
from vrut_lite_lab.scenes import trials
from vrut_lite_lab.scenes.gltf_writer import GltfWriter
from vrut_lite_lab.scenes.shapes import box, polygon

SIZE, STRIP = (300, 190), (96, 12)
HEIGHTS_M = (0.1, 0.4, 1.5, 4.0, 9.0)
# An edge that climbs, and how far the sheet reaches that it ends.
LOW, HIGH, DEEP_M = np.array([0.0, 0.02, 8.0]), np.array([0.0, 11.0, -8.0]), 6.0
_POINT_RAD = 1e-6
_NOON = "2026-06-21T12:30"


def climb() -> bytes:
    """The sheet above level ground."""
    writer = GltfWriter()
    grey = writer.material("grey", (0.4, 0.4, 0.4), double_sided=True)
    beyond = np.array([DEEP_M, 0.0, 0.0])
    writer.place("sheet", writer.mesh("sheet", [(polygon([LOW, HIGH, HIGH + beyond, LOW + beyond]),
                                                 grey)]))  # fmt: skip
    floor = box((-9.0, -0.1, -14.0), (9.0, 0.0, 9.0))
    writer.place("floor", writer.mesh("floor", [(floor, grey)]))
    writer.camera((-7.0, 6.0, 9.0), (1.0, 0.0, -4.0), 0.9)
    return writer.glb()


def projects(folder: Path) -> dict[str, Project]:
    """What the sheet shows, by captions; the climbing edge first."""
    (folder / "climb.glb").write_bytes(climb())
    (folder / "courtyard.glb").write_bytes(trials.courtyard())
    terrain = load_project(SCENES / "large/terrain.toml")
    hut = CameraView(eye_m=(-150.0, 502.0, 46.0), target_m=(-172.0, 494.5, 26.0))
    found = {
        "an edge that climbs": Project(scene=str(folder / "climb.glb"), at=_NOON),
        "courtyard": Project(scene=str(folder / "courtyard.glb"), at=_NOON),
        "satellite": msgspec.structs.replace(
            load_project(SCENES / "large/planet.toml"), at="2026-06-21T08:00"
        ),
        "spruces and hut": msgspec.structs.replace(terrain, camera=hut, at="2026-06-28T08:00"),
        "pavilion": Project(scene=str(SCENES / "pavilion.gltf"), at="2026-06-21T18:00"),
    }
    return {name: msgspec.structs.replace(p, size=SIZE, air=False) for name, p in found.items()}


def state_of(project: Project) -> SceneState:
    """The scene in the light of the sun alone."""
    host = EngineHost("path-tracer", project)
    try:
        host.inject(*daylight_inputs(project), *view_inputs(project))
        host.settle()
        return replace(lit_by(host.state, "sun"), parts=NO_PARTS)
    finally:
        host.close()


def finished(state: SceneState) -> SceneState:
    """The state of a finished still, of whose points nothing is known: all light is the sun's."""
    assert state.camera is not None
    asked = StillAsked(camera=state.camera, size_px=state.size_px)
    points = ViewLightChanged.without_points(asked, "none", 1, "soft shadows")
    return replace(state, parts=heard_with(state.parts, points))


def row(gl: PyrenderBackend, name: str, state: SceneState, spp: int) -> list[Captioned]:
    """Three pictures at one exposure, that of what the sun lights."""
    assert state.key_light is not None
    point = msgspec.structs.replace(state.key_light, angular_radius_rad=_POINT_RAD)
    still = finished(state)
    frame = gl.draw(still).radiance
    ev100 = ev100_of(state.exposure, frame[frame.max(axis=-1) > 0.0][None])
    radiances = {
        "a sun without width": gl.draw(relit(still, key_light=point)).radiance,
        "finished still": frame,
        "path tracer": traced(state, SUN, spp),
    }
    return [
        (f"{name}: {said}", display_picture(radiance, ev100))
        for said, radiance in radiances.items()
    ]


def widths(gl: PyrenderBackend, state: SceneState, spp: int) -> list[str]:
    """Lines of the table."""
    assert state.key_light is not None
    lines = [
        "| edge above the ground, m | width in the still, mm | traced, mm | ratio |",
        "|---" * 4 + "|",
    ]
    sun = np.array(state.key_light.direction)
    for height_m in HEIGHTS_M:
        on_edge = LOW + (HIGH - LOW) * (height_m - LOW[1]) / (HIGH[1] - LOW[1])
        foot = on_edge - sun * (height_m / sun[1])
        end = LOW - sun * (LOW[1] / sun[1])
        along = (foot - end) / np.linalg.norm(foot - end)
        # From above, so that the shadow's edge goes up the picture, and from below the sheet.
        away_m = min(0.8, 0.7 * height_m)
        eye = foot + np.array([0.0, away_m, 0.0]) - 1e-3 * away_m * along
        view = 6.0 * height_m * state.key_light.angular_radius_rad / away_m * STRIP[1] / STRIP[0]
        camera = MoveCamera(eye_m=tuple(eye), target_m=tuple(foot), vertical_field_of_view_rad=view)
        close = replace(state, moved_camera=camera, size_px=STRIP)
        step_m = away_m * 2.0 * np.tan(0.5 * view) / STRIP[1]
        ours, true = (
            1e3 * step_m * _width_px(picture[..., 1])
            for picture in (gl.draw(finished(close)).radiance, traced(close, SUN, 8 * spp))
        )
        lines.append(f"| {height_m} | {ours:.1f} | {true:.1f} | {ours / true:.2f} |")
    return lines


def _width_px(picture: NDArray[np.float32]) -> float:
    """From 10 to 90 % of the light, of a strip whose middle column is half lit."""
    light: FloatArray = picture.mean(axis=0, dtype=float)
    light = light if light[0] < light[-1] else light[::-1]
    edge = len(light) // 16
    low, high = light[:edge].mean(), light[-edge:].mean()
    rising = np.maximum.accumulate((light - low) / (high - low))
    return float(np.ptp(np.interp([0.1, 0.9], rising, np.arange(len(rising)))))


def main() -> None:
    """Draw, trace, print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("sheet", type=Path)
    parser.add_argument("--spp", type=int, default=64)
    chosen = parser.parse_args()
    owner = GlOwner()
    gl = PyrenderBackend(owner)
    pictures: list[Captioned] = []
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, project) in enumerate(projects(Path(folder)).items()):
            state = state_of(project)
            if number == 0:
                print("\n".join(widths(gl, state, chosen.spp)))
            pictures += row(gl, name, state, chosen.spp)
    sheet(pictures, 3).save(chosen.sheet, quality=80)
    gl.close()
    owner.close()


if __name__ == "__main__":
    main()
