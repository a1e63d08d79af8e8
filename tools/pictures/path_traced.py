"""Every bundled scene in the GL frame and path-traced, side by side, and what differs.

    python -m tools.pictures.path_traced SHEET.jpg [SCENE ...]

Prague, 21 June, turbidity 3 and ground of albedo 0.1, no air; both backends are told the same.
Printed are Markdown tables: HDR-FLIP and the difference in luminance by region, and single balls
without neighbours or ground. Needs the extra `ref`; some half an hour of one core. Scenes are
files in scenes/, all of `DRAWN` without any; the sheet is saved after each row.
"""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import flip_evaluator
import msgspec
import numpy as np
from numpy.typing import NDArray
from path_tracer.settings import PathTracerSettings
from path_tracer.subject import Subject
from path_tracer.tracer import Tracer
from scipy.ndimage import minimum_filter

from tools.pictures.darkness import no_ambient, no_background, no_sun
from tools.pictures.drawing import SKIES, Captioned, scene_project, sheet
from vrut_lite.array import Array
from vrut_lite.commands.engines import EngineHost
from vrut_lite.daylight.scene import SceneOpened
from vrut_lite.daylight.scene_state import SceneState
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.pictures.display import display_picture
from vrut_lite.project import Project, daylight_inputs, view_inputs
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.passes import mesh_renderer
from vrut_lite.render.pyrender_backend import PyrenderBackend

DRAWN = ("sundial.toml", "street.toml", "spheres.glb", "pavilion.gltf", "large/terrain.toml",
         "large/hall.toml", "work/ground.glb", "work/indoor.glb")  # fmt: skip
# Lit through windows, which few paths find.
INDOORS = ("large/hall.toml", "work/indoor.glb")
HOURS = ("07:00", "12:30", "20:00")
REGIONS = ("sunlit", "shadowed", "sky")
SIZE, SAMPLES, INDOOR_SAMPLES, DIRECT_SAMPLES = (240, 150), 48, 64, 24
_BALL_SIZE, _BALL_SAMPLES = (128, 128), 32
_BESIDE_RAD = np.radians(40.0)
Picture = NDArray[np.float32]


class Case(NamedTuple):
    """One scene, sky and hour: radiance (h, w, 3) of the frame and of the path tracer.

    `direct` has light that met one surface; `sun` and `sun_frame` only that of the sun of it,
    `bare` and `bare_frame` that on surfaces without coats, and `sun_principled` on principled
    BSDFs. `regions` are masks (h, w), without the pixels at their edges.
    """

    caption: str
    frame: Picture
    traced: Picture
    direct: Picture
    sun: Picture
    sun_frame: Picture
    bare: Picture
    bare_frame: Picture
    sun_principled: Picture
    regions: dict[str, NDArray[np.bool_]]
    ev100: float


def project_of(scene: str, sky: str, hour: str) -> Project:
    """A scene under a sky at an hour."""
    return scene_project(
        scene,
        place="50.0755,14.4378,200",
        at=f"2026-06-21T{hour}",
        slots={"sky": sky},
        settings={sky: {"turbidity": 3.0, "albedo": 0.1}},
        size=SIZE,
        air=False,
    )


def cases(gl: PyrenderBackend, scene: str, sky: str) -> Iterator[Case]:
    """The scene under the sky at all hours."""
    host = EngineHost("path-tracer", project_of(scene, sky, HOURS[0]))
    try:
        for hour in HOURS:
            project = project_of(scene, sky, hour)
            host.inject(*daylight_inputs(project), *view_inputs(project))
            host.settle()
            caption = f"{Path(scene).stem} {hour} {SKIES[sky]}"
            samples = INDOOR_SAMPLES if scene in INDOORS else SAMPLES
            yield case(gl, host.state, caption, samples)
    finally:
        host.close()


def case(gl: PyrenderBackend, state: SceneState, caption: str, samples: int) -> Case:
    """The frame's and the path tracer's pictures of a scene."""
    by_sun = replace(state, background=no_background(), ambient=no_ambient())
    by_sky = replace(state, key_light=no_sun())
    sun = traced(by_sun, DIRECT_SAMPLES, max_bounces=1)
    frame = gl.draw(state)
    with patch.object(mesh_renderer, "DIELECTRIC_F0", 0.0):
        bare_frame = gl.draw(by_sun).radiance
    return Case(
        caption=caption,
        frame=frame.radiance,
        traced=traced(state, samples),
        direct=sun + traced(by_sky, DIRECT_SAMPLES, max_bounces=1),
        sun=sun,
        sun_frame=gl.draw(by_sun).radiance,
        bare=traced(by_sun, 8, max_bounces=1, surfaces="bare", sun="sharp"),
        bare_frame=bare_frame,
        sun_principled=traced(by_sun, 8, max_bounces=1, surfaces="principled"),
        regions=regions_of(state),
        ev100=frame.ev100,
    )


def traced(state: SceneState, samples: int, **settings: Any) -> Picture:
    """The path tracer's radiance."""
    picture = Tracer(Subject(state), PathTracerSettings(spp=samples, **settings)).trace(0, samples)
    assert picture is not None
    return picture


def regions_of(state: SceneState) -> dict[str, NDArray[np.bool_]]:
    """Where sky without the sun is seen, where all of a pixel is in the sun, and where none is.

    The sun's disc is some pixels wide: how much of it a frame's few samples a pixel meet is chance.
    """
    above = (texel_directions(64)[..., 1:2] > 0.0) * np.ones(3)
    # No surface may be met: what the eye sees of the sky is 1, and all else black.
    unlit = replace(state, key_light=no_sun())
    sky = traced(replace(unlit, background=uniform(above)), 8, max_bounces=0)
    bare = traced(replace(unlit, background=uniform(np.ones_like(above))), 8, max_bounces=0)
    by_sun = replace(state, background=no_background())
    lit = luminance(traced(by_sun, 8, max_bounces=1, sun="sharp"))
    disc = luminance(traced(by_sun, 8, max_bounces=0))
    things = bare.max(axis=-1) == 0.0
    return {
        "sky": _inner((sky.min(axis=-1) > 0.999) & (disc == 0.0)),
        "sunlit": _inner(things & (lit > 0.05 * np.quantile(lit, 0.95)) & (lit > 0.0)),
        "shadowed": _inner(things & (lit == 0.0)),
    }


def uniform(cube: NDArray[np.float64]) -> BackgroundChanged:
    """A background of a cube map (6, n, n, 3)."""
    return msgspec.structs.replace(no_background(), cube=Array(cube.astype(np.float16)))


def _inner(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return np.asarray(minimum_filter(mask, 3, mode="nearest"))


def difference(picture: Picture, reference: Picture, mask: NDArray[np.bool_]) -> float:
    """Relative difference of the mean luminance in a region; NaN where it hardly is one."""
    if mask.sum() < 100 or not np.any(reference[mask] > 0.0):
        return float("nan")
    return float(luminance(picture[mask]).mean() / luminance(reference[mask]).mean() - 1.0)


def flip(picture: Picture, reference: Picture) -> float:
    """Mean HDR-FLIP (Andersson et al. 2021), 0 for equal pictures."""
    clipped = [np.maximum(image, 0.0).astype(np.float32) for image in (reference, picture)]
    return float(flip_evaluator.evaluate(*clipped, "HDR")[1])


def row(drawn: Case) -> str:
    """A line of the first table."""
    cells = [f"{flip(drawn.frame, drawn.traced):.3f}", f"{flip(drawn.frame, drawn.direct):.3f}"]
    for region in REGIONS:
        mask = drawn.regions[region]
        for reference in (drawn.traced, drawn.direct)[: 1 if region == "sky" else 2]:
            cells.append(_percent(difference(drawn.frame, reference, mask)))
        if region == "sunlit":
            for picture, reference in (
                (drawn.sun_frame, drawn.sun),
                (drawn.bare_frame, drawn.bare),
                (drawn.sun_frame, drawn.sun_principled),
            ):
                cells.append(_percent(difference(picture, reference, mask)))
    return f"| {drawn.caption} | " + " | ".join(cells) + " |"


def _percent(value: float) -> str:
    return "–" if np.isnan(value) else f"{100.0 * value:+.1f} %"


HEADER = [
    "| scene, hour, sky | FLIP | FLIP, direct | sunlit | sunlit, direct | sunlit, sun alone "
    "| the same, no coats | the same, principled | shadowed | shadowed, direct | sky |",
    "|---" * 11 + "|",
]


def balls(gl: PyrenderBackend) -> list[str]:
    """Lines of a table: each ball of the spheres alone, where nothing hides or lights it."""
    project = project_of("spheres.glb", "dynamic_skylight", HOURS[1])
    host = EngineHost("path-tracer", project)
    host.inject(*daylight_inputs(project), *view_inputs(project))
    host.settle()
    state = host.state
    assert state.scene is not None
    geometry, materials = state.scene.geometry, state.scene.materials.all()
    lines = ["| ball | sun | sky |", "|---|---|---|"]
    for part, mesh in enumerate(geometry.part_mesh.values):
        extent = np.ptp(geometry.world_triangles(part).reshape(-1, 3), axis=0)
        if not np.allclose(extent, 1.0, atol=0.02):
            continue
        alone = _alone(state, state.scene, part)
        by_sun = replace(alone, background=no_background(), ambient=no_ambient())
        mask = _disc_mask(_BALL_SIZE)
        cells = []
        for shown in (by_sun, replace(alone, key_light=no_sun())):
            picture = gl.draw(shown).radiance
            cells.append(_percent(difference(picture, traced(shown, _BALL_SAMPLES), mask)))
        name = materials[geometry.mesh(mesh).material].name
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    host.close()
    return lines


def _alone(state: SceneState, scene: SceneOpened, part: int) -> SceneState:
    """One part without ground, a sphere, filling the picture, seen 40 degrees beside the sun."""
    assert state.key_light is not None
    assert state.camera is not None
    corners = scene.geometry.world_triangles(part).reshape(-1, 3)
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    centre = 0.5 * (lower + upper)
    sun = np.array(state.key_light.direction)
    across = np.cross(sun, [0.0, 1.0, 0.0])
    away = sun + np.tan(_BESIDE_RAD) * across / np.linalg.norm(across)
    eye = centre + 4.0 * away / np.linalg.norm(away)
    camera = msgspec.structs.replace(
        state.camera,
        eye_m=tuple(map(float, eye)),
        target_m=tuple(map(float, centre)),
        vertical_field_of_view_rad=0.3,
    )
    geometry = msgspec.structs.replace(
        scene.geometry,
        part_mesh=Array(scene.geometry.part_mesh.values[part : part + 1]),
        world_from_part=Array(scene.geometry.world_from_part.values[part : part + 1]),
    )
    bounds = {"lower_m": tuple(lower.tolist()), "upper_m": tuple(upper.tolist())}
    shown = msgspec.structs.replace(scene, geometry=geometry, ground=None, **bounds)
    return replace(state, scene=shown, moved_camera=camera, size_px=_BALL_SIZE)


def _disc_mask(size: tuple[int, int]) -> NDArray[np.bool_]:
    """Pixels that a ball of radius 0.5 m at 4 m covers, without its edge."""
    across = (2.0 * np.arange(size[0]) + 1.0) / size[0] - 1.0
    x, y = np.meshgrid(across, -across)
    return np.asarray(np.hypot(x, y) < 0.9 * np.tan(np.arcsin(0.5 / 4.0)) / np.tan(0.15))


def captioned(drawn: Case) -> list[Captioned]:
    """Frame and path-traced picture, at one exposure."""
    return [
        (f"{drawn.caption}, {told}", display_picture(radiance, drawn.ev100))
        for told, radiance in (("frame", drawn.frame), ("path-traced", drawn.traced))
    ]


def main(path: Path, scenes: Sequence[str]) -> None:
    """Draw and trace these scenes and the balls, write the sheet, print the tables."""
    owner = GlOwner()
    gl = PyrenderBackend(owner)
    pictures: list[Captioned] = []
    print("\n".join(HEADER))
    for scene in scenes:
        for sky in SKIES:
            for drawn in cases(gl, scene, sky):
                pictures += captioned(drawn)
                print(row(drawn), flush=True)
            sheet(pictures, 2 * len(HOURS)).save(path, quality=80)
    print("\n" + "\n".join(balls(gl)))
    gl.close()
    owner.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:] or DRAWN)
