"""The shown light map: messages that the scene manager demands, and that belong together."""

import msgspec
import numpy as np
import pytest
import trimesh
from light_transport.drawing.mapped_scene import FewerRaysLight, layout_in, mapped_scene

from vrut_lite.array import Array
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.lifecycle import FAULTS_UNTIL_SUSPENSION
from vrut_lite.kernel.messages import EnableModule, RestartModule, Tick
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.messages.light_map import LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged
from vrut_lite.scene.backend import SceneView
from vrut_lite.scene.manager import SceneManager


class Transport(Module):
    """Posts what a test gives it."""

    manifest = Manifest(name="transport", title="Transport", version="1", provides=("light_map",))
    given: tuple = ()

    @handles(Tick)
    def on_tick(self, message: Tick) -> None:
        for post in type(self).given:
            self.link.post(post)


@pytest.fixture
def stage(tmp_path):
    """A kernel with a manager, its view, a way to post, and two scenes of one part."""
    files = []
    for number in (1, 2):
        files.append(str(tmp_path / f"{number}.glb"))
        trimesh.creation.box((number, 2, 2)).export(files[-1])
    kernel, view = Kernel(), SceneView()
    kernel.add_module(Transport)
    kernel.add_module(SceneManager, view=view)
    kernel.pump()

    def post(*messages):
        Transport.given = messages
        kernel.inject(Tick(elapsed_s=0.1))
        kernel.pump_until_idle()
        return view.state

    def load(number):
        kernel.inject(LoadScene(path=files[number]))
        kernel.pump_until_idle()
        return view.state.scene

    return kernel, view, post, load


def laid(scene, key="layout", parts=1):
    return LightMapLaid(
        content_key=scene.content_key, layout_key=key, size_px=(4, 4),
        shapes=Array(np.zeros((0, 5), np.int64)), source_vertex=Array(np.zeros(0, np.int32)),
        uv=Array(np.zeros((0, 2), np.float32)), triangles=Array(np.zeros((0, 3), np.int32)),
        part_shape=Array(np.full(parts, -1, np.int32)),
        part_corner_px=Array(np.zeros((parts, 2), np.int32)),
        ground=None, probes=None, source="test",
    )  # fmt: skip


def lit(layout):
    return SurfaceLightChanged(
        layout_key=layout.layout_key, texels=Array(np.ones((4, 4, 4), np.float16)), probes=None,
        radiance_scale=1.0, rays=1, source="test",
    )  # fmt: skip


def known(state):
    """The layout and the light that are shown."""
    heard = state.parts.get("light_transport", {})
    lit_scene = mapped_scene(heard)
    return layout_in(heard), None if lit_scene is None else lit_scene.light


def test_light_on_surfaces_is_asked_for_where_there_are_surfaces(stage):
    """Without a scene nobody is to bake anything."""
    kernel, _, _, load = stage
    kinds = (LightMapLaid, SurfaceLightChanged)
    assert [kernel.wanted(kind) for kind in kinds] == [None, None]
    load(0)
    assert all(kernel.wanted(kind) is not None for kind in kinds)


def test_where_no_backend_draws_a_light_map_none_is_baked(stage, tmp_path):
    """A path tracer finds the light between surfaces by itself."""
    load_file = LoadScene(path=str(tmp_path / "1.glb"))
    kernel = Kernel()
    kernel.add_module(SceneManager, lights_surfaces=False)
    kernel.inject(load_file)
    kernel.pump_until_idle()
    assert kernel.wanted(CloudsChanged) is not None
    assert kernel.wanted(SurfaceLightChanged) is None


def test_map_and_light_of_the_open_scene_are_kept(stage):
    """Each as it was posted, also where the light comes again by itself."""
    _, _, post, load = stage
    layout = laid(load(0))
    state = post(layout)
    assert known(state) == (layout, None)
    for light in (lit(layout), msgspec.structs.replace(lit(layout), rays=2)):
        state = post(light)
        assert known(state)[0] is layout
        assert known(state)[1] is light


def test_light_of_another_scene_or_layout_is_dropped(stage):
    """Texels of other surfaces would show as nonsense."""
    _, _, post, load = stage
    scene = load(0)
    layout = laid(scene)
    assert known(post(laid(scene, parts=2)))[0] is None
    assert known(post(msgspec.structs.replace(layout, content_key="other")))[0] is None
    state = post(layout, lit(laid(scene, "later")))
    assert known(state) == (layout, None)
    assert known(post(lit(layout)))[1] is not None
    # A finer layout: the light of the last one no longer lies where it says.
    assert known(post(laid(scene, "finer")))[1] is None


def test_light_by_fewer_rays_is_kept_for_the_noise_of_its_hour(stage):
    """The difference of two hours, or of two layouts, is no noise."""
    _, _, post, load = stage
    layout = laid(load(0))
    first, second, later = (
        msgspec.structs.replace(lit(layout), rays=rays, sky_level=level)
        for rays, level in ((1, 5.0), (2, 5.0), (4, 6.0))
    )
    assert post(layout, first).shown(FewerRaysLight) is None
    assert post(second).shown(FewerRaysLight).light is first
    assert post(later).shown(FewerRaysLight) is None
    assert post(first).shown(FewerRaysLight) is None


def test_light_of_a_view_is_kept_until_other_light_comes(stage):
    """Rays of its points are of one hour and one map."""
    _, _, post, load = stage
    layout = laid(load(0))
    view = StillAsked(camera=MoveCamera(eye_m=(0, 1, 2), target_m=(0, 1, 0)), size_px=(8, 8))

    def points(key):
        return ViewLightChanged.without_points(view, key, 1, "test")

    assert post(layout, lit(layout), points("other")).shown(ViewLightChanged) is None
    asked = points(layout.layout_key)
    assert post(asked).shown(ViewLightChanged) is asked
    assert post(lit(layout)).shown(ViewLightChanged) is None


def test_another_scene_drops_the_light_and_the_same_again_keeps_it(stage):
    """A scene is known by its content, whatever its file is called."""
    _, view, post, load = stage
    layout = laid(load(0))
    light = lit(layout)
    post(layout, light)
    load(0)
    assert known(view.state)[1] is light
    load(1)
    assert known(view.state) == (None, None)


def test_a_restarted_manager_shows_the_same_light(stage):
    """The picture must not change because a module began anew."""
    kernel, view, post, load = stage
    layout = laid(load(0))
    light = lit(layout)
    post(layout, light)
    kernel.inject(RestartModule(module="scene"))
    kernel.pump_until_idle()
    assert known(view.state)[1] is light


def test_without_its_holder_the_open_sky_lights_surfaces(stage):
    """Nobody would change the last light with the hour: it goes, and comes with a holder."""
    kernel, view, post, load = stage
    layout = laid(load(0))
    light = lit(layout)
    post(layout, light)
    enabled(kernel, False)
    assert known(view.state) == (None, None)
    load(0)
    assert known(view.state) == (None, None)
    enabled(kernel, True)
    assert known(post(layout, light))[1] is light


def test_a_holder_that_fails_takes_its_light_along(stage, monkeypatch):
    """After three faults the kernel suspends it, and nothing updates what it said last."""
    kernel, view, post, load = stage
    layout = laid(load(0))
    post(layout, lit(layout))
    monkeypatch.setattr(Transport, "given", (None,))
    for _ in range(FAULTS_UNTIL_SUSPENSION):
        assert known(view.state)[1] is not None
        kernel.inject(Tick(elapsed_s=0.1))
        kernel.pump_until_idle()
    assert kernel.last_fault("transport").suspended
    assert known(view.state) == (None, None)


def enabled(kernel, enabled):
    kernel.inject(EnableModule(module="transport", enabled=enabled))
    kernel.pump_until_idle()
