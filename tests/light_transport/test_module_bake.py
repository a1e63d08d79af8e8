"""The module on the bus: what it does when, and what it leaves alone."""

import math
import threading

import msgspec
import numpy as np
import pytest
from light_stage import (
    COARSE,
    NO_MORE,
    WANT,
    LightStage,
    Shine,
    Show,
    box_file,
    layouts,
    lights,
    of_kind,
)
from light_transport import module
from light_transport.layout import part_shapes
from light_transport.layout.mesh_shapes import charts_of, stretched
from light_transport.messages import BakeGrown
from light_transport.tolerance import quality_for

from vrut_lite.kernel.messages import EnableModule, RestartModule, SetSetting
from vrut_lite.messages.light_map import NOT_MAPPED, LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.scene import SceneOpened

NOON = Shine(radiance=1.0, irradiance=3.0)


@pytest.fixture
def stage(tmp_path):
    stage = LightStage()
    stage.tell(*COARSE)
    yield stage
    stage.kernel.close()
    assert stage.kernel.last_fault("light_transport") is None


@pytest.fixture
def two(tmp_path):
    """Two boxes with air between."""
    return Show(path=str(box_file(tmp_path, "two.obj", boxes=((0.0, 2.0), (5.0, 1.0)))))


@pytest.fixture
def scene(tmp_path):
    return Show(path=str(box_file(tmp_path)))


def irradiance(light: SurfaceLightChanged):
    return light.texels.values[..., :3].astype(float) * light.radiance_scale


def test_nothing_is_done_without_demand(stage, scene):
    """Who wants no light on surfaces pays nothing: no layout, no rays, no demand on the sky."""
    said = stage.tell(scene, NOON)
    assert said == []
    assert not stage.counters.done
    assert stage.counters.skipped["light map: unwanted or switched off"] >= 1
    assert stage.kernel.wanted(SurfaceLightChanged) is None


def test_light_grows_in_rounds_that_double(stage, scene):
    """The first light comes by few rays; each round is told, and at the end all rays are there."""
    said = stage.tell(NOON, WANT, scene)
    (laid,) = layouts(said)
    assert laid.content_key == stage.kernel.last(SceneOpened).content_key
    assert [m.rays for m in of_kind(said, BakeGrown)] == [64, 128]
    light = lights(said)
    assert light[0].rays == 64
    assert light[-1].rays == quality_for(0.1, "draft").rays
    for message in (laid, *light):
        message.check()
        message.check_arrays()
    assert {m.layout_key for m in light} == {laid.layout_key}
    width, height = laid.size_px
    assert light[-1].texels.shape == (height, width, 4)
    assert irradiance(light[-1]).max() <= 1.01 * math.pi * 1.0 + 3.0
    assert irradiance(light[-1]).max() > 0.5 * math.pi


def test_light_waits_for_as_many_rays_as_a_demand_names(stage, two, monkeypatch):
    """A still shows no light of fewer rays: neither probes nor rounds are lit, and the last light
    is that which rounds come to."""
    monkeypatch.setattr(module, "_MANY_TRIANGLES", 0)
    said = stage.tell(NOON, msgspec.structs.replace(WANT, size=4096), two)
    (light,) = lights(said)
    assert len(layouts(said)) == 1
    assert [m.rays for m in of_kind(said, BakeGrown)] == [64, 128]
    assert "probes" not in stage.counters.done
    assert stage.counters.skipped["hour: more rays are awaited"] >= 1
    by_rounds = LightStage()
    assert lights(by_rounds.tell(*COARSE, NOON, WANT, two))[-1] == light
    by_rounds.kernel.close()


def test_a_scene_of_matt_things_has_no_mirrors(stage, scene):
    """Nothing glossy: no cubes are laid or lit, and the counters count it."""
    said = stage.tell(NOON, WANT, scene)
    assert [laid.mirrors for laid in layouts(said)] == [None]
    assert {light.mirrors for light in lights(said)} == {None}
    assert stage.counters.skipped["mirrors: nothing in the scene is glossy"] == 1


def test_glossy_things_have_cubes_in_layout_and_light(stage, tmp_path):
    """A smooth box sees the ground around it, about half of its cube, black under this sky."""
    path = box_file(tmp_path)
    material = path.with_name("boxes.obj.mtl")
    material.write_text(material.read_text().replace("Ns 1\n", "Ns 5000\n"))
    said = stage.tell(NOON, WANT, Show(path=str(path), with_ground=True))
    (laid,), light = layouts(said), lights(said)[-1]
    assert laid.mirrors.part.values.tolist() == [0]
    assert light.fits(laid)
    cubes = light.mirrors.values.astype(float)
    met = cubes[..., 3] > 0.0
    # Openings to the sky have a distance too, that of what stands around them.
    assert (laid.mirrors.nearness.values[met] > 0.0).all()
    assert 0.2 < met.mean() < 0.55
    assert (cubes[met][:, :3] == 0.0).all()


def test_what_takes_long_to_lay_out_is_lit_by_probes_first(stage, two, monkeypatch):
    """First light needs no charts. The map replaces it with light of its own, at one stroke."""
    monkeypatch.setattr(module, "_MANY_TRIANGLES", 0)
    told = [LightMapLaid, SurfaceLightChanged]
    said = [m for m in stage.tell(NOON, WANT, two) if type(m) in told]
    assert [type(m) for m in said[:4]] == told * 2
    probes, first, laid, light = said[:4]
    assert not len(probes.shapes.values)
    assert (probes.part_shape.values == NOT_MAPPED).all()
    assert len(laid.shapes.values)
    assert first.fits(probes)
    assert light.fits(laid)
    for message in (probes, first):
        message.check()
        message.check_arrays()
    top = first.probes.values[..., 2, 3].astype(float)
    assert top[:, -1].max() > 0.95
    assert stage.counters.done["probes"] == stage.counters.done["layout"] == 1


def test_probes_that_all_lie_inside_a_body_light_nothing(stage, scene, monkeypatch):
    """One box fills its bounds: it waits for its map."""
    monkeypatch.setattr(module, "_MANY_TRIANGLES", 0)
    assert len(layouts(stage.tell(NOON, WANT, scene))) == 1
    assert stage.counters.skipped["probes: all lie inside bodies"] == 1


def test_an_hour_between_probes_and_map_lights_the_probes(stage, two, monkeypatch):
    """The layout takes seconds: time plays on meanwhile."""
    monkeypatch.setattr(module, "_MANY_TRIANGLES", 0)
    went_on, may_go_on = threading.Event(), threading.Event()

    def waiting(mesh, stretch):
        went_on.set()
        assert may_go_on.wait(60.0)
        return stretched(mesh, stretch)

    monkeypatch.setattr(part_shapes, "stretched", waiting)
    stage.tell(WANT, NOON)
    stage.said.clear()
    stage.kernel.inject(two)
    while not went_on.is_set() or not lights(stage.said):
        stage.kernel.pump()
    stage.kernel.inject(Shine(radiance=2.0))
    while len(lights(stage.said)) < 2:
        stage.kernel.pump()
    may_go_on.set()
    stage.kernel.pump_until_idle()
    (probes, laid), light = layouts(stage.said), lights(stage.said)
    assert light[0].fits(probes)
    assert light[1].fits(probes)
    assert light[-1].fits(laid)


def test_an_hour_lights_the_same_map(stage, scene):
    """A new sky costs no layout and no rays, and twice the sky is twice the light."""
    before = irradiance(lights(stage.tell(WANT, scene, Shine(radiance=1.0)))[-1])
    rounds = stage.counters.done["round"]
    (light,) = stage.tell(Shine(radiance=2.0))[-1:]
    np.testing.assert_allclose(irradiance(light), 2.0 * before, rtol=2e-3, atol=1e-3)
    assert stage.counters.done["round"] == rounds
    assert stage.counters.done["layout"] == 1


def test_an_hour_that_nobody_would_tell_apart_is_left_out(stage, scene):
    """A sun that creeps by a hundredth of a degree lights the scene as before."""
    stage.tell(WANT, scene, NOON)
    done = stage.counters.done["hour"]
    angle = math.radians(0.01)
    said = stage.tell(
        Shine(radiance=1.0, irradiance=3.0, sun=(math.sin(angle), math.cos(angle), 0.0))
    )
    assert lights(said) == []
    assert stage.counters.done["hour"] == done
    assert stage.counters.skipped["hour: it looks like the one before"] >= 1
    assert lights(stage.tell(Shine(radiance=1.0, irradiance=3.0, sun=(1.0, 0.0, 0.0))))


def test_another_scene_begins_anew(stage, scene, tmp_path):
    """Rays of a scene that was closed meanwhile bring nothing, and the new one is laid out."""
    other = Show(path=str(box_file(tmp_path, "two.obj", boxes=((0.0, 2.0), (5.0, 1.0)))))
    stage.tell(WANT, NOON)
    stage.said.clear()
    for message in (scene, other):
        stage.kernel.inject(message)
    stage.kernel.pump_until_idle()
    (laid,) = layouts(stage.said)
    assert laid.content_key == stage.kernel.last(SceneOpened).content_key
    assert {m.layout_key for m in lights(stage.said)} == {laid.layout_key}
    assert layouts(stage.tell(scene))[0].layout_key != laid.layout_key


@pytest.mark.parametrize("change", ["scene", "texels"])
def test_a_layout_under_way_is_given_up(stage, scene, tmp_path, monkeypatch, change):
    """Opening another scene or changing a size cancels a layout, which can take seconds."""
    two = Show(path=str(box_file(tmp_path, "two.obj", boxes=((0.0, 2.0), (5.0, 1.0)))))
    finer = SetSetting(module="light_transport", name="texel_m", value=0.25)
    began, may_go_on, steps = threading.Event(), threading.Event(), []

    def cut(surface, texel_m):
        steps.append("cut")
        return charts_of(surface, texel_m)

    def waiting(mesh, stretch):
        steps.append("stretch")
        began.set()
        assert may_go_on.wait(60.0)
        return stretched(mesh, stretch)

    monkeypatch.setattr(part_shapes, "stretched", waiting)
    monkeypatch.setattr(part_shapes, "charts_of", cut)
    stage.tell(WANT, NOON)
    stage.said.clear()
    stage.kernel.inject(two)
    stage.kernel.pump()
    assert began.wait(60.0)
    stage.kernel.inject(scene if change == "scene" else finer)
    stage.kernel.pump()
    may_go_on.set()
    stage.kernel.pump_until_idle()
    # After the step that the first layout was in, the next is the second one's first.
    assert steps[:3] == ["stretch", "stretch", "cut"]
    (laid,) = layouts(stage.said)
    assert laid.content_key == stage.kernel.last(SceneOpened).content_key


def test_switched_off_the_map_is_taken_back(stage, scene):
    """A layout of no scene says so; switched on again the same light comes again."""
    on = stage.tell(WANT, NOON, scene)
    off = stage.set("on", False)
    (nothing,) = layouts(off)
    nothing.check()
    nothing.check_arrays()
    assert nothing.content_key == ""
    assert stage.tell(Shine(radiance=5.0)) == []
    stage.tell(NOON)
    again = stage.set("on", True)
    assert layouts(again) == layouts(on)
    assert lights(again)[-1] == lights(on)[-1]


def test_light_ends_with_the_demand(stage, scene):
    """When the last consumer leaves, nothing goes on."""
    stage.tell(WANT, NOON, scene)
    stage.tell(NO_MORE)
    done = stage.counters.done.copy()
    assert stage.tell(Shine(radiance=5.0), scene) == []
    assert stage.counters.done == done


def test_settings_begin_anew_only_where_the_map_changes(stage, scene):
    """Other texels need another layout; more rays alone go on from those that are there."""
    stage.tell(WANT, NOON, scene)
    (laid,) = layouts(stage.set("texel_m", 0.25))
    assert laid.size_px[0] * laid.size_px[1] > 400
    assert stage.set("texel_m", 0.25) == []


def test_a_disabled_module_gives_its_slot_up_and_takes_it_again(stage, scene):
    """Whoever draws then knows that the light is nobody's; enabled, the same light comes again."""
    before = stage.tell(WANT, NOON, scene)
    assert stage.kernel.slots.holder("light_map") == "light_transport"
    stage.tell(EnableModule(module="light_transport", enabled=False))
    assert stage.kernel.slots.holder("light_map") == ""
    again = stage.tell(EnableModule(module="light_transport", enabled=True))
    assert lights(again)[-1] == lights(before)[-1]


def test_a_restarted_module_goes_on(stage, scene):
    """The demand outlives the instance."""
    before = stage.tell(WANT, NOON, scene)
    again = stage.tell(RestartModule(module="light_transport"))
    assert lights(again)[-1] == lights(before)[-1]


def test_without_light_there_are_rays_and_no_message(stage, scene):
    """Before the sky has spoken the bake goes on; its first word is enough for an hour.

    The layout is told with the light: a frame would be drawn anew for it alone.
    """
    said = stage.tell(WANT, scene)
    assert layouts(said) == lights(said) == []
    said = stage.tell(NOON)
    assert len(layouts(said)) == 1
    assert lights(said)[-1].rays == quality_for(0.1, "draft").rays


def test_a_scene_without_surfaces_is_no_fault(stage, scene):
    """Nothing but sky has nothing to light."""
    said = stage.tell(WANT, NOON, Show(path=scene.path, with_parts=False))
    assert layouts(said) == lights(said) == []
    assert stage.counters.skipped["light map: a scene without surfaces"] == 1


def test_the_ground_is_lit_too(stage, scene):
    """The disc that a scene stands on is darker beside the box than far away from it."""
    said = stage.tell(WANT, Shine(radiance=1.0), Show(path=scene.path, with_ground=True))
    (laid,) = layouts(said)
    x, y = laid.ground.corner_px
    edge = laid.ground.edge_px
    open_share = lights(said)[-1].texels.values[y : y + edge, x : x + edge, 3].astype(float)
    assert open_share[0, 0] > 0.97
    assert open_share.min() < 0.3
