"""The host end to end, from settings, place and hour to a lit scene."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from vrut_lite.daylight_kernel import FaultCollector, daylight_kernel, demand_light
from vrut_lite.errors import UserError
from vrut_lite.geometry.encoding import decode_float16
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance, horizontal_irradiance
from vrut_lite.kernel.messages import ChooseSlot, EnableModule, SetSetting
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged, SunMoved
from vrut_lite.project import Project, daylight_inputs, view_inputs

SCENES = Path(__file__).parents[1] / "scenes"
SKIES = ("dynamic_skylight", "bruneton_sky")


@pytest.fixture
def kernel():
    kernel, failures = daylight_kernel()
    assert failures == []
    faults = FaultCollector(kernel)
    yield kernel
    assert faults.faults == []


def play(kernel, *inputs):
    for message in inputs:
        kernel.inject(message)
    kernel.pump_until_idle()


def at_noon(kernel, size=32, place="50.0755,14.4378"):
    demand_light(kernel, "test", size)
    play(kernel, *daylight_inputs(Project(at="2026-06-21T13:00", place=place)))


def cube_of(kernel):
    background = kernel.last(BackgroundChanged)
    return decode_float16(background.cube.values, background.radiance_scale)


def test_both_skies_are_found_by_entry_point(kernel):
    """The host finds the skies by entry point."""
    assert set(SKIES) <= set(kernel.seats)
    assert kernel.slots.holder("sky") == "dynamic_skylight"
    assert kernel.slots.holder("sun") == "dynamic_skylight"


def test_nothing_is_computed_without_demand(kernel):
    """Without demand place and hour move the sun, but no sky is computed."""
    play(kernel, *daylight_inputs(Project()))
    assert kernel.last(SunMoved) is not None
    assert kernel.last(BackgroundChanged) is None


def test_switching_the_sky_changes_background_light_and_ambient_together(kernel):
    """After the switch all three come from the new holder, and likewise back."""
    at_noon(kernel)
    for holder in ("bruneton_sky", "dynamic_skylight", "bruneton_sky"):
        play(kernel, ChooseSlot(slot="sky", module=holder))
        for kind in (BackgroundChanged, KeyLightChanged, AmbientChanged):
            assert kernel.last(kind).source == holder


def test_disabling_the_holder_lets_the_other_sky_take_over(kernel):
    """The other sky takes the slot when its holder is disabled."""
    at_noon(kernel)
    play(kernel, EnableModule(module="dynamic_skylight", enabled=False))
    assert kernel.slots.holder("sky") == "bruneton_sky"
    assert kernel.last(BackgroundChanged).source == "bruneton_sky"


@pytest.mark.parametrize("holder", SKIES)
def test_cube_ambient_and_ground_agree(kernel, holder):
    """E of the cube, E of the harmonics and the ground's radiance agree.

    The lower half is albedo / pi times sky plus sun, so that ground and horizon meet: 2 %.
    """
    play(kernel, ChooseSlot(slot="sky", module=holder))
    play(kernel, SetSetting(module=holder, name="albedo", value=0.3))
    at_noon(kernel, size=128)
    cube, sun = cube_of(kernel), kernel.last(KeyLightChanged)
    sky = horizontal_irradiance(cube)
    harmonics = kernel.last(AmbientChanged).irradiance_sh_rgb.values
    np.testing.assert_allclose(evaluate_irradiance(harmonics, [0.0, 1.0, 0.0]), sky, rtol=0.03)
    total = sky + np.array(sun.irradiance_rgb) * sun.direction[1]
    np.testing.assert_allclose(cube[3, 64, 64], 0.3 / np.pi * total, rtol=0.02)


@pytest.mark.parametrize("holder", SKIES)
@pytest.mark.parametrize("at", ["2026-06-21T01:00", "2026-06-21T21:40", "2026-12-21T08:00"])
def test_every_hour_has_a_finite_sky(kernel, holder, at):
    """Night and twilight are dark, never negative, never NaN."""
    play(kernel, ChooseSlot(slot="sky", module=holder))
    demand_light(kernel, "test", 16)
    play(kernel, *daylight_inputs(Project(at=at)))
    cube = cube_of(kernel)
    assert np.isfinite(cube).all()
    assert (cube >= 0).all()
    assert np.isfinite(kernel.last(KeyLightChanged).irradiance_rgb).all()


def test_a_demand_of_another_size_gets_it(kernel):
    """The largest demanded size is delivered."""
    at_noon(kernel, size=16)
    demand_light(kernel, "someone else", 48)
    kernel.pump_until_idle()
    assert kernel.last(BackgroundChanged).cube.shape == (6, 48, 48, 3)


@pytest.mark.gl
def test_a_scene_is_lit_warmer_in_the_evening_and_darker(tmp_path):
    """Ten minutes before sunset radiance is lower and redder than at noon."""
    from vrut_lite.host import Host

    path = tmp_path / "box.glb"
    trimesh.creation.box((2, 2, 2)).export(path)
    pictures = {}
    with Host(cube_size=64) as host:
        for at in ("2026-06-21T13:00", "2026-06-21T21:00"):
            project = Project(scene=str(path), at=at, size=(160, 90))
            host.inject(*daylight_inputs(project), *view_inputs(project))
            pictures[at] = host.draw()
        with pytest.raises(UserError, match="no such file"):
            host.load(str(tmp_path / "missing.glb"))
    noon, evening = (picture.radiance.mean(axis=(0, 1)) for picture in pictures.values())
    assert evening.sum() < 0.2 * noon.sum()
    assert evening[0] / evening[2] > 1.5 * noon[0] / noon[2]
    shown = [picture.display.mean() for picture in pictures.values()]
    assert all(60 < value < 200 for value in shown)


@pytest.mark.gl
def test_a_failing_scene_does_not_end_the_host(tmp_path):
    """After a scene that cannot be opened the next one opens."""
    from vrut_lite.host import Host

    path = tmp_path / "box.glb"
    trimesh.creation.box((2, 2, 2)).export(path)
    with Host(cube_size=16) as host:
        for _ in range(5):
            host.inject(LoadScene(path=str(tmp_path / "missing.glb")))
            with pytest.raises(UserError):
                host.settle()
        host.load(str(path))
