"""What the frame leaves out, one thing after another: direct light, the sun alone, single balls.

    python -m vrut_lite_lab.path_traced.details [--sky NAME] [SCENE ...]

Both backends are told the same of each part of the light. Traced pictures are kept as truths are;
the balls of spheres.glb stand alone in the void, so that nothing hides or lights them.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from unittest.mock import patch

import msgspec
import numpy as np

from vrut_lite.array import Array
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.render.gl_owner import GlOwner
from vrut_lite.render.passes import mesh_renderer
from vrut_lite.render.pyrender_backend import PyrenderBackend
from vrut_lite.scene.scene_state import SceneState
from vrut_lite_lab.path_traced.cases import DRAWN, Case, states
from vrut_lite_lab.path_traced.regions import Mask, difference, flip, regions_of
from vrut_lite_lab.path_traced.truths import (
    BARE_SUN,
    DIRECT,
    DIRECT_SAMPLES,
    SUN,
    TRUTH,
    Light,
    lit_by,
    traced,
    truth,
)
from vrut_lite_lab.pictures.drawing import SKIES

HEADER = [
    "| scene, hour, sky | FLIP, direct | sunlit, direct | shadowed, direct | sunlit, sun alone "
    "| the same, no coats |",
    "|---" * 6 + "|",
]
_BALL_SIZE, _BALL_SAMPLES = (128, 128), 32
_BESIDE_RAD = np.radians(40.0)
_BALL_LIGHTS: tuple[Light, ...] = ("sun", "sky")


def row(gl: PyrenderBackend, case: Case, state: SceneState) -> str:
    """A line of the first table."""
    regions = regions_of(case, state)
    direct = truth(case, state, DIRECT, DIRECT_SAMPLES)
    frame = gl.draw(state).radiance
    by_sun = lit_by(state, "sun")
    sun, sun_frame = truth(case, state, SUN, DIRECT_SAMPLES), gl.draw(by_sun).radiance
    bare = truth(case, state, BARE_SUN, DIRECT_SAMPLES)
    with patch.object(mesh_renderer, "DIELECTRIC_F0", 0.0):
        bare_frame = gl.draw(by_sun).radiance
    cells = [
        f"{flip(frame, direct):.3f}",
        _percent(difference(frame, direct, regions["sunlit"])),
        _percent(difference(frame, direct, regions["shadowed"])),
        _percent(difference(sun_frame, sun, regions["sunlit"])),
        _percent(difference(bare_frame, bare, regions["sunlit"])),
    ]
    return f"| {case.caption} | " + " | ".join(cells) + " |"


def balls(gl: PyrenderBackend, state: SceneState) -> list[str]:
    """Lines of the second table: each ball of the spheres alone."""
    assert state.scene is not None
    geometry, materials = state.scene.geometry, state.scene.materials.all()
    lines = ["| ball | sun | sky |", "|---|---|---|"]
    for part, mesh in enumerate(geometry.part_mesh.values):
        extent = np.ptp(geometry.world_triangles(part).reshape(-1, 3), axis=0)
        if not np.allclose(extent, 1.0, atol=0.02):
            continue
        alone, mask = _alone(state, state.scene, part), _disc_mask(_BALL_SIZE)
        cells = []
        for light in _BALL_LIGHTS:
            picture = gl.draw(lit_by(alone, light)).radiance
            reference = traced(alone, replace(TRUTH, light=light), _BALL_SAMPLES)
            cells.append(_percent(difference(picture, reference, mask)))
        name = materials[geometry.mesh(int(mesh)).material].name
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
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


def _disc_mask(size: tuple[int, int]) -> Mask:
    """Pixels that a ball of radius 0.5 m at 4 m covers, without its edge."""
    across = (2.0 * np.arange(size[0]) + 1.0) / size[0] - 1.0
    x, y = np.meshgrid(across, -across)
    return np.asarray(np.hypot(x, y) < 0.9 * np.tan(np.arcsin(0.5 / 4.0)) / np.tan(0.15))


def _percent(value: float) -> str:
    return "–" if np.isnan(value) else f"{100.0 * value:+.1f} %"


def tell(gl: PyrenderBackend, scenes: Sequence[str], skies: Sequence[str]) -> None:
    """Print both tables."""
    print("\n".join(HEADER))
    for scene in scenes:
        for sky in skies:
            for case, state in states(scene, sky):
                print(row(gl, case, state), flush=True)
    for _, state in states("spheres.glb", skies[0], ("12:30",)):
        print("\n" + "\n".join(balls(gl, state)))


def main() -> None:
    """Draw, trace and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("scenes", nargs="*", default=DRAWN)
    parser.add_argument("--sky", choices=list(SKIES), action="append")
    chosen = parser.parse_args()
    owner = GlOwner()
    gl = PyrenderBackend(owner)
    tell(gl, chosen.scenes, chosen.sky or list(SKIES))
    gl.close()
    owner.close()


if __name__ == "__main__":
    main()
