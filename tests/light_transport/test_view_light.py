"""Light for the pixels of a still: made when it is asked for, and the light of the place."""

import numpy as np
import pytest
from boxes import floor, hour, quads
from light_stage import COARSE, WANT, LightStage, Look, Shine, Show, box_file
from light_transport.bake import Bake
from light_transport.hour.free_points import light_at

from vrut_lite.daylight.view_light import ViewLightChanged
from vrut_lite.kernel.messages import Demand

WANT_VIEW = Demand(consumer="still", message=ViewLightChanged.__name__)
NO_VIEW = Demand(consumer="still", message=ViewLightChanged.__name__, size=0)
LOOK = Look(eye_m=(3.0, 4.0, 5.0))


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
    bake = Bake(*quads(floor(-2, 2, -2, 2), floor(-1, 0, -1, 1, y=0.01)))
    bake.add_rays(32)
    places = np.array([[-0.5, 1e-4, 0.0], [0.0, 1e-4, 0.0], [0.5, 1e-4, 0.0]])
    up = np.tile([0.0, 1.0, 0.0], (3, 1))
    found = light_at(bake, places, up, hour(1.0), rays=512)
    assert found.irradiance_rgb[:, 1] / np.pi == pytest.approx([0.0, 0.5, 1.0], abs=0.02)
    assert found.free[0] < 0.02
    assert found.free[2] == 1.0
