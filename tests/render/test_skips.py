"""Work that a frame leaves out: the picture stays within one step of 8 bits, the counters tell."""

from dataclasses import fields, replace

import numpy as np
import pytest
import trimesh
from scene_stage import light, look, square, surface
from stateful_backend import opened

from vrut_lite.messages.ground_disc import GroundDisc
from vrut_lite.messages.picture import SetExposure
from vrut_lite.messages.section import section_of
from vrut_lite.render.still_picture import FEWER_SHIFTS_PX
from vrut_lite.scene.loading import load_scene
from vrut_lite.scene.scene_state import FrameSkips

pytestmark = pytest.mark.gl
SIZE = (96, 64)
GROUND = GroundDisc((0.0, 0.0), 0.0, 300.0)
NOTHING = FrameSkips(**{field.name: False for field in fields(FrameSkips)})
SUN = {"sun_direction": (0.5, 0.6, 0.3), "sun_irradiance": (120.0, 100.0, 70.0)}


@pytest.fixture
def backend(gl_backend):
    return gl_backend(size_px=SIZE, exposure=SetExposure(mode="manual", ev100=14.0))


@pytest.fixture(scope="module")
def boxes(tmp_path_factory):
    """Eight boxes in a ring around the origin."""
    scene = trimesh.Scene()
    for turn in np.arange(8) * np.pi / 4:
        box = trimesh.creation.box((1, 2, 1))
        box.apply_translation((6 * np.cos(turn), 1, 6 * np.sin(turn)))
        scene.add_geometry(box)
    path = tmp_path_factory.mktemp("scene") / "boxes.glb"
    scene.export(path)
    return load_scene(path)


def gradient_sky():
    up = np.linspace(5.0, 1.0, 16)[None, :, None, None]
    return np.broadcast_to(up * np.array([0.6, 0.8, 1.2]), (6, 16, 16, 3))


def counts(backend, draw):
    """The picture, and what one draw added to the counters: done, skipped."""
    before = backend.counters.done.copy(), backend.counters.skipped.copy()
    picture = draw()
    return picture, backend.counters.done - before[0], backend.counters.skipped - before[1]


# What is looked at, and which work that spares: name of the skip, of the work, of the reason.
VIEWS = [
    ("into the open", (0, 1.7, 0), (5, 1.5, 1), "meshes", "mesh", "mesh: out of view"),
    ("down", (2, 3, 2), (2.2, 0, 2.1), "sky", "sky sample", "sky sample: covered"),
    ("at a wall", (4.4, 1, 0), (6, 1, 0), "sky", "sky sample", "sky sample: covered"),
]


@pytest.mark.parametrize(("_name", "eye", "target", "skip", "work", "reason"), VIEWS)
def test_what_the_view_cannot_show_is_not_drawn(
    backend, boxes, _name, eye, target, skip, work, reason
):
    """The same picture with and without; without the skip the work is done."""
    backend.change(scene=opened(boxes, GROUND))
    light(backend, gradient_sky(), **SUN)
    picture, done, skipped = counts(backend, lambda: look(backend, eye, target, 0.5))
    backend.change(skips=replace(FrameSkips(), **{skip: False}))
    full, all_done, none_skipped = counts(backend, backend.draw)
    assert skipped[reason] > 0
    assert none_skipped[reason] == 0
    assert done[work] + skipped[reason] == all_done[work]
    difference = np.abs(picture.display.astype(int) - full.display.astype(int))
    assert difference.max() <= 1


def test_looking_at_the_ground_draws_no_sky_and_filters_none(backend, boxes):
    """Bare matte ground, in two parts, fills the picture: no sample of sky, no reflection of it."""
    backend.change(scene=opened(boxes, GROUND))
    light(backend, gradient_sky(), **SUN)
    _, done, skipped = counts(backend, lambda: look(backend, (2, 3, 2), (2.2, 0, 2.1), 0.5))
    assert done["sky sample"] == 0
    assert skipped["sky sample: covered"] == SIZE[0] * SIZE[1] * len(FEWER_SHIFTS_PX)
    assert done["mesh"] == 2
    assert done["reflection slice"] == 0
    assert skipped["reflection: nothing in view mirrors"] == 1


def test_a_plain_scene_pays_for_nothing_that_it_has_not(backend, boxes):
    """Boxes under a sun: no lamp, pane, cut, cloud or air is drawn, and nothing is compiled for
    them; a scene cut by a plane shows that this would be seen here."""
    backend.change(scene=opened(boxes, GROUND))
    light(backend, gradient_sky(), **SUN)
    _, done, _ = counts(backend, lambda: look(backend, (0, 1.7, 0), (5, 1.5, 1)))
    plain = {"picture", "sky sample", "mesh", "shadow map", "upload", "reflection slice"}
    assert {name for name, times in done.items() if times} <= plain
    assert "SECTION" not in compiled(backend)
    others = {"LAMPS", "TERMS", "GLASS", "GLASS_SHADOW", "BACKDROP", "SHEEN", "CLEARCOAT", "UNLIT"}
    assert not compiled(backend) & others
    backend.change(section=section_of("x", 0.0, "below"))
    backend.draw()
    assert "SECTION" in compiled(backend)


def compiled(backend):
    """What the programs of meshes are compiled with."""
    programs = backend.backend._frame._passes.meshes._program_cache._program_cache
    return {name for key in programs for name, _ in key[2:]}


def test_the_shadow_map_is_drawn_once_for_one_sun_and_never_at_night(backend, boxes):
    """A moving camera does not move shadows; a moving sun or another scene does."""
    night = {"sun_direction": (0.5, -0.1, 0.3), "sun_irradiance": (0.0,) * 3}
    view = ((0, 1.7, 0), (5, 1.5, 1))
    backend.change(scene=opened(boxes, GROUND))
    steps = [SUN, SUN, {**SUN, "sun_direction": (0.5, 0.61, 0.3)}, night]
    drawn = []
    for sun in steps:
        light(backend, gradient_sky(), **sun)
        drawn.append(counts(backend, lambda: look(backend, *view))[1]["shadow map"])
    assert drawn == [1, 0, 1, 0]
    light(backend, gradient_sky(), **SUN)
    backend.change(scene=opened(boxes, GROUND))
    assert counts(backend, backend.draw)[1]["shadow map"] == 1
    assert backend.counters.skipped["shadow map: no sun to cast one"] == 1
    assert backend.counters.skipped["shadow map: same scene, same sun"] == 1


@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_all_skips_together_leave_the_picture(backend, tmp_path, metallic):
    """Frames of a sky that drifts by less than is seen: as if all were done each time."""
    path = square(tmp_path, surface(metallic, 0.4))
    backend.change(scene=opened(path, GROUND))
    shown = {}
    for skips in (FrameSkips(), NOTHING):
        backend.change(skips=skips)
        for factor in (1.0, 1.002, 1.004):
            light(backend, gradient_sky() * factor, **SUN)
            shown[skips] = look(backend, (0.3, 0.8, 0.6), (0, 0, 0)).display.astype(int)
    assert np.abs(shown[FrameSkips()] - shown[NOTHING]).max() <= 1


@pytest.mark.parametrize("scale", [0.05, 1.0, 5e5])
def test_culling_is_the_same_at_any_scale(backend, tmp_path, scale):
    """A room's corner or a planet's: what is skipped never shows."""
    scene = trimesh.Scene()
    for x in (-3, 0, 3):
        ball = trimesh.creation.icosphere(subdivisions=2, radius=scale)
        scene.add_geometry(ball.apply_translation((x * scale, 0, 0)))
    path = tmp_path / "balls.glb"
    scene.export(path)
    backend.change(scene=opened(path))
    light(backend, gradient_sky(), **SUN)
    eye, target = np.array([0.0, 0.0, 4.0]) * scale, np.array([2.2, 0.0, 0.0]) * scale
    picture, _, skipped = counts(backend, lambda: look(backend, eye, target, 0.4))
    backend.change(skips=NOTHING)
    full = backend.draw()
    assert skipped["mesh: out of view"] == 1
    assert np.abs(picture.display.astype(int) - full.display.astype(int)).max() <= 1


@pytest.mark.gl
def test_only_what_changed_is_uploaded(backend, boxes):
    """Parts are told apart by identity: a picture again and a moved camera upload nothing."""
    backend.change(scene=opened(boxes, GROUND))
    light(backend, gradient_sky(), **SUN)
    view = (2.0, 3.0, 2.0), (2.2, 0.0, 2.1)

    def uploads(draw):
        _, done, skipped = counts(backend, draw)
        return done["upload"], skipped["upload: unchanged"]

    # Scene, background, light of the sky and what frame parts hear; no polarisation.
    assert uploads(lambda: look(backend, *view)) == (4, 1)
    assert uploads(backend.draw) == (0, 5)
    assert uploads(lambda: look(backend, (3.0, 3.0, 2.0), view[1])) == (0, 5)
    light(backend, 2.0 * gradient_sky(), **SUN)
    assert uploads(backend.draw) == (2, 3)
