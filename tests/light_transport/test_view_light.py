"""Light for the pixels of a still: made when it is asked for, and the light of the place."""

import msgspec
import numpy as np
import pytest
from boxes import box, floor, hour, quads
from light_stage import COARSE, WANT, LightStage, Look, Shine, Show, box_file, lights, of_kind
from light_transport.giving_up import always
from light_transport.messages import BakeGrown
from light_transport.tolerance import quality_for
from light_transport.transport import SceneTransport
from light_transport.view import point_light
from light_transport.view.point_light import light_at
from light_transport.view.view_light import view_light
from light_transport.view.view_smoothing import PointGrid, smoothed

from vrut_lite.kernel.messages import Demand
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.light_map import ALL_RAYS, BESIDE_POINTS
from vrut_lite.messages.view_light import ViewLightChanged

WANT_VIEW = Demand(consumer="still", message=ViewLightChanged.__name__)
NO_VIEW = Demand(consumer="still", message=ViewLightChanged.__name__, size=0)
LOOK = Look(eye_m=(3.0, 4.0, 5.0))


def want_rays(size):
    return msgspec.structs.replace(WANT, size=size)


@pytest.fixture
def stage(tmp_path):
    """A cube of 2 m about the origin under a sky of radiance 1, and its light map."""
    stage = LightStage()
    stage.tell(*COARSE, Shine(radiance=1.0), WANT, Show(path=str(box_file(tmp_path))))
    yield stage
    stage.kernel.close()


def views(said):
    return [message for message in said if isinstance(message, ViewLightChanged)]


def test_points_have_the_light_of_where_they_lie(stage):
    """The top of a free cube sees all of the sky, a side half of it; beside the cube is nothing."""
    (view,) = views(stage.tell(LOOK, WANT_VIEW))
    view.check()
    view.check_arrays()
    plane = view.plane.values
    light = view.light.values.astype(float) * [*[view.radiance_scale] * 3, 1.0]
    top = plane[..., 1] > 0.9
    side = plane.any(axis=-1) & (np.abs(plane[..., 1]) < 0.1)
    assert min(top.sum(), side.sum()) > 10
    assert not plane[0, 0].any()
    assert light[top][:, :3] == pytest.approx(np.pi, rel=0.02)
    assert light[side][:, :3] == pytest.approx(np.pi / 2.0, rel=0.1)
    assert light[top][:, 3] == pytest.approx(1.0, abs=0.02)
    # The eye is 3 m above the top.
    assert plane[top][:, 3] == pytest.approx(-3.0, abs=1e-4)


def test_nothing_is_made_that_nobody_wants(stage):
    """Without a demand, after its end, and before there is a view."""
    assert not views(stage.tell(LOOK))
    assert views(stage.tell(WANT_VIEW))
    assert not views(stage.tell(NO_VIEW, Look(eye_m=(0.0, 1.0, 6.0)), Shine(radiance=2.0)))


def test_a_view_with_lamps_is_finished_by_its_map(stage, tmp_path):
    """Its points are told to be known by the map alone, so that all else is finished."""
    show = Show(path=str(box_file(tmp_path, "lit.obj")), with_lamp=True)
    found = views(stage.tell(show, LOOK, WANT_VIEW))
    assert found
    found[-1].check()
    found[-1].check_arrays()
    assert not found[-1].plane.values.any()


def test_beside_points_of_a_still_half_the_maps_rays_do(tmp_path):
    """They light its points by patches of many texels, whose noise nobody sees: the points' light
    is that of all rays within 1 %. A demand that wants all rays afterwards has them."""
    stage = LightStage()
    beside, every = (want_rays(size) for size in (BESIDE_POINTS, ALL_RAYS))
    show = Show(path=str(box_file(tmp_path, boxes=((0.0, 2.0), (2.5, 2.0)))))
    said = stage.tell(*COARSE, Shine(radiance=1.0), beside, LOOK, WANT_VIEW, show)
    full = quality_for(0.1, "draft").rays
    (light,), (view,) = lights(said), views(said)
    assert (light.rays, view.rays) == (full // 2, full)
    assert of_kind(said, BakeGrown)[-1].rays_wanted == full // 2
    said = stage.tell(every)
    finer, again = lights(said)[-1], views(said)[-1]
    assert (finer.rays, again.rays) == (full, full)
    by_half, by_all = (
        each.light.values[..., 1].astype(float) * each.radiance_scale for each in (view, again)
    )
    np.testing.assert_allclose(by_half, by_all, rtol=0.01, atol=0.01 * by_all.max())
    stage.kernel.close()


def test_lamps_are_lit_by_all_rays(tmp_path):
    """Their still has no points: what it shows is the map."""
    stage = LightStage()
    show = Show(path=str(box_file(tmp_path, "lit.obj")), with_lamp=True)
    said = stage.tell(*COARSE, Shine(radiance=1.0), want_rays(BESIDE_POINTS), show)
    assert lights(said)[-1].rays == quality_for(0.1, "draft").rays
    stage.kernel.close()


def test_another_view_and_another_hour_have_light_of_their_own(stage):
    """Each once, of the present light."""
    (first,) = views(stage.tell(LOOK, WANT_VIEW))
    (other,) = views(stage.tell(Look(eye_m=(0.0, 1.0, 6.0))))
    assert other.camera != first.camera
    (brighter,) = views(stage.tell(Shine(radiance=2.0)))
    ratio = brighter.light.values[..., 1].astype(float).max() * brighter.radiance_scale
    ratio /= other.light.values[..., 1].astype(float).max() * other.radiance_scale
    assert ratio == pytest.approx(2.0, rel=0.02)


def test_a_sheet_without_a_back_hides_the_sky_of_what_is_below():
    """Below its edge half of the sky is hidden, below its middle all, as it hides the sun."""
    transport = SceneTransport(*quads(floor(-2, 2, -2, 2), floor(-1, 0, -1, 1, y=0.01)))
    transport.add_rays(32)
    places = np.array([[-0.5, 1e-4, 0.0], [0.0, 1e-4, 0.0], [0.5, 1e-4, 0.0]])
    up = np.tile([0.0, 1.0, 0.0], (3, 1))
    found = light_at(transport, places, up, transport.light(hour(1.0)), rays=512)
    assert found.irradiance_rgb[:, 1] / np.pi == pytest.approx([0.0, 0.5, 1.0], abs=0.02)
    assert found.free[0] < 0.02
    assert found.free[2] == 1.0


def test_rays_are_spared_where_their_noise_is_not_seen(monkeypatch):
    """A box on a floor under an even sky: a third of the rays for what is even, the others below
    the box's walls; light is that of all rays everywhere."""
    transport = SceneTransport(*quads(*box((-1, 0, -1), (1, 2, 1)), floor(-9, 9, -9, 9)))
    transport.add_rays(32)
    camera = MoveCamera(
        eye_m=(0.0, 6.0, 8.0), target_m=(0.0, 0.0, 0.0), vertical_field_of_view_rad=0.8
    )
    traced = []

    def light_of(transport, places_m, *rest, **named):
        traced.append(len(places_m))
        return light_at(transport, places_m, *rest, **named)

    def drawn():
        traced.clear()
        now = hour(1.0)
        return view_light(
            transport, now, transport.light(now), camera, (64, 48), 1, 192, 1, always
        ).light

    monkeypatch.setattr(point_light, "light_at", light_of)
    fast, counted = drawn(), list(traced)
    monkeypatch.setattr(point_light, "UNSEEN_NOISE", 0.0)
    full = drawn()
    assert counted[0] == traced[0] == traced[1]
    assert 0 < counted[1] < 0.5 * counted[0]
    seen = full[..., 1] > 0.0
    assert np.array_equal(seen, fast[..., 1] > 0.0)
    off = fast[seen][:, 1] / full[seen][:, 1] - 1.0
    assert np.abs(off.mean()) < 0.003
    assert np.sqrt((off**2).mean()) < 0.02
    assert np.quantile(np.abs(off), 0.99) < 0.06


def test_a_point_that_alone_met_a_small_bright_thing_does_not_stand_out():
    """A level plane under even light; one point of it met something bright by one of its rays, so
    that its error is as large as its excess. What it found is spread, not lost."""
    rows, columns = np.indices((21, 21))
    place = np.stack([0.01 * columns, 0.0 * rows, 0.01 * rows], axis=-1).astype(np.float32)
    plane = np.zeros((21, 21, 4), np.float32)
    plane[..., 1] = 1.0
    light, error = np.ones((21, 21, 4), np.float32), np.full((21, 21), 0.02, np.float32)
    light[10, 10, :3], error[10, 10] = 2.0, 1.0
    room = np.full((21, 21), 10.0, np.float32)
    found = smoothed(light, PointGrid(plane, place), room, error, always)
    assert found[10, 10, 1] < 1.1
    assert found[..., 1].sum() == pytest.approx(light[..., 1].sum(), rel=1e-3)
