"""Pictures whose light between surfaces the card computes, in the real host."""

import io
from datetime import UTC, datetime, timedelta
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from house_fixtures import CARD_NS
from light_transport.drawing import hour_on_card
from light_transport.drawing.hour_on_card import PIECE, HourOnCard
from light_transport.drawing.surface_light import SurfaceLightOnGpu
from light_transport.messages import NAME

from vrut_lite.array import Array
from vrut_lite.commands.headless_scene import modules_for
from vrut_lite.errors import UserError
from vrut_lite.host import Host
from vrut_lite.kernel.messages import ChooseSlot, Fault, SetClock, SetSetting
from vrut_lite.messages.late_array import LateArray
from vrut_lite.messages.light_map import SurfaceLightChanged
from vrut_lite.messages.picture import Resize, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.renderer import RendererTried
from vrut_lite.messages.scene import LoadScene
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay
from vrut_lite.render.eye_pictures import HeadsetEye
from vrut_lite.render.gl_owner import GlOwner

pytestmark = pytest.mark.gl

SCENES = Path(__file__).parents[2] / "scenes"
INDOOR, PAVILION = str(SCENES / "work/indoor.glb"), str(SCENES / "pavilion.gltf")
NOON = datetime(2026, 6, 21, 11, tzinfo=UTC)
SIZE = Resize(width_px=96, height_px=64)
BEGIN = (
    SetSetting(module=NAME, name="quality", value="draft"),
    SetSetting(module=NAME, name="texel_m", value=0.3),
    SetPlace(latitude_deg=50.0, longitude_deg=14.4),
    SIZE,
)
CARD = RendererTried(renderer="a card", trial_ns=0.05)


def by(device):
    return SetSetting(module=NAME, name="device", value=device)


@pytest.fixture
def host():
    with Host() as host:
        host.inject(*BEGIN, SetClock(instant=NOON), LoadScene(path=INDOOR), by("gpu"))
        host.settle()
        yield host


def light(host):
    return host.kernel.last(SurfaceLightChanged)


def choice(host):
    return host.kernel.seats[NAME].module.devices["light"]


def apart(one, other):
    """The largest difference of displayed bytes, and of radiance beside the mean."""
    steps = np.abs(one.display.astype(int) - other.display).max()
    return steps, np.abs(one.radiance - other.radiance).max() / other.radiance.mean()


def check_same(host):
    """The picture with the card's light is that with the processor's, whose texels are halves."""
    assert isinstance(light(host).texels, LateArray)
    card = host.draw()
    host.inject(by("cpu"))
    processor = host.draw()
    assert isinstance(light(host).texels, Array)
    steps, radiance = apart(card, processor)
    assert steps <= 1
    assert radiance < 5e-3
    host.inject(by("gpu"))
    host.settle()
    return card


def differs_each_time(host, changes):
    """Each picture has the light that the processor finds, and is another than the one before."""
    seen = [check_same(host)]
    for change in changes:
        host.inject(change)
        host.settle()
        seen.append(check_same(host))
    for before, after in pairwise(seen):
        assert apart(before, after)[1] > 0.1


def test_no_picture_shows_a_map_of_before(host):
    """The hour moves, another module is the sky: pictures have the light of now."""
    moved = SetClock(instant=NOON + timedelta(hours=6))
    chosen = ChooseSlot(slot="sky", module="bruneton_sky")
    differs_each_time(host, (moved, chosen))


@pytest.mark.long
def test_no_picture_shows_the_map_of_another_scene(host):
    """Its tables are those of the scene that is open; clouds change its light too."""
    clouded = SetSetting(module="clouds", name="coverage", value=1.0)
    host.inject(SetSetting(module=NAME, name="texel_m", value=2.0))
    host.settle()
    differs_each_time(host, (LoadScene(path=PAVILION), clouded))


def test_a_moved_hour_uploads_no_texels(host, monkeypatch):
    """Its map is written by the card: a call that would upload one is an error."""
    host.draw()
    first = host.draw(still=False)

    def refused(*_):
        raise AssertionError("texels were uploaded")

    host.inject(SetClock(instant=NOON + timedelta(hours=5)))
    host.settle()
    monkeypatch.setattr(SurfaceLightOnGpu, "_open_sky_of", lambda self, _: self._open_sky)
    monkeypatch.setattr(SurfaceLightOnGpu, "_written", refused)
    monkeypatch.setattr(HourOnCard, "_brought", refused)
    done = host.frame_counters.done["hour on the card"]
    second = host.draw(still=False)
    assert host.frame_counters.done["hour on the card"] == done + 1
    assert apart(first, second)[1] > 0.1
    host.settle()


@pytest.fixture
def card_host():
    """A renderer that draws as a card does, at the end of a bake that no picture has shown."""
    with Host(gl=GlOwner(CARD_NS)) as host:
        host.inject(*BEGIN, SetClock(instant=NOON), LoadScene(path=INDOOR), by("gpu"))
        host.settle()
        yield host


def until_done(host, draw):
    """Draw while a bake's tables come, a piece a picture, and once more: all of these pictures."""
    done, pictures = host.frame_counters.done, []
    before = done["hour on the card"]
    while done["hour on the card"] == before:
        pieces = done[PIECE]
        pictures.append(draw())
        assert done[PIECE] - pieces == int(done["hour on the card"] == before)
    return pictures


def test_moving_pictures_show_the_last_light_while_a_bake_comes_to_the_card(card_host, monkeypatch):
    """None waits for all of it, and none is black: between surfaces they have the light of the
    picture before. With the last piece comes the picture of a bake that came whole, to the byte."""
    host, moved = card_host, SetClock(instant=NOON + timedelta(hours=1))
    monkeypatch.setattr(hour_on_card, "PIECE_BYTES", 300_000)
    host.inject(by("cpu"))
    last = host.draw(still=False)
    host.inject(by("gpu"))
    host.settle()
    begun = host.draw_now(still=False)
    assert np.array_equal(begun.radiance, last.radiance)
    # The sun is that of the new hour at once, the sky that is mirrored after twelve pictures.
    host.inject(moved)
    host.settle()
    *between, done = (picture.radiance for picture in until_done(host, lambda: moving(host)))
    assert len(between) > 20
    assert all(np.array_equal(radiance, between[-1]) for radiance in between[15:])
    assert between[0].mean() == pytest.approx(between[-1].mean(), rel=1e-2)
    assert 0.3 < between[-1].mean() / done.mean() < 0.99
    assert np.array_equal(moving(host).radiance, done)
    host.inject(by("cpu"))
    host.settle()
    host.draw_now(still=False)
    host.inject(by("gpu"))
    host.settle()
    pieces = host.frame_counters.done[PIECE]
    host.draw_now()
    assert host.frame_counters.done[PIECE] > pieces + 5
    assert np.array_equal(moving(host).radiance, done)


def moving(host):
    return host.draw_now(still=False)


def test_a_first_picture_has_the_processors_light_while_a_bake_comes_to_the_card(card_host):
    """There is no last light: under the open sky a room would be too bright, and else black."""
    first, *between, done = until_done(card_host, lambda: moving(card_host))
    assert all(np.array_equal(picture.radiance, first.radiance) for picture in between)
    assert 0.0 < apart(first, done)[1] < 5e-3


def test_both_eyes_of_a_frame_have_one_light_while_a_bake_comes_to_the_card(card_host):
    """A frame of two eyes brings one piece, and the new light is seen by both at once."""
    host = card_host
    host.inject(by("cpu"))
    host.draw(still=False)
    host.inject(SetClock(instant=NOON + timedelta(hours=1)), by("gpu"))
    host.inject(SetExposure(mode="manual", ev100=9.0))
    host.settle()

    def draw():
        return host.gl.call(lambda context: seen_by_two(context, host))

    pictures = until_done(host, draw)
    assert len(pictures) > 10
    assert all(np.array_equal(*eyes) for eyes in pictures)
    assert pictures[-1][0].mean() > pictures[-2][0].mean() + 2


def seen_by_two(context, host):
    """The bytes that two eyes at one place see."""
    textures = [context.texture((96, 64), 4) for _ in range(2)]
    eye_m = np.array(host.state.camera.eye_m)
    tangents = (-0.9, 0.9, -0.6, 0.6)
    host.draw_eyes(
        host.state,
        [HeadsetEye(eye_m, np.eye(3), tangents, (96, 64), texture.glo) for texture in textures],
    )
    found = [texture.read() for texture in textures]
    for texture in textures:
        texture.release()
    return [np.frombuffer(picture, np.uint8) for picture in found]


def test_numbers_are_the_processors_and_late(host, monkeypatch):
    """Who reads lux under the pointer gets the processor's, computed then and not before."""
    host.draw()
    assert "values" not in vars(light(host).texels)
    late = host.light_at_pixel(48, 60)
    assert "values" in vars(light(host).texels)
    host.inject(by("cpu"))
    host.settle()
    now = host.light_at_pixel(48, 60)
    np.testing.assert_allclose(late, now, rtol=2e-3)
    with pytest.raises(UserError, match="stay in the process"):
        _ = LateArray((1, 1, 4), ()).values


def test_the_processor_goes_on_where_the_card_fails(host, monkeypatch):
    """The picture is the processor's at once, one line says why, and the card is asked no more."""
    expected = host.draw()

    def fails(*_):
        raise RuntimeError("no such memory")

    monkeypatch.setattr(HourOnCard, "compute", fails)
    said = []
    host.kernel.tap(lambda message, _: said.append(message))
    host.inject(SetClock(instant=NOON + timedelta(hours=1)))
    host.settle()
    host.inject(SetClock(instant=NOON))
    host.settle()
    assert apart(host.draw_now(), expected)[0] <= 1
    host.kernel.pump_until_idle()
    host.faults.faults.clear()
    faults = [message for message in said if isinstance(message, Fault)]
    assert [(fault.module, "no such memory" in fault.error) for fault in faults] == [(NAME, True)]
    assert isinstance(light(host).texels, Array)
    assert choice(host) == (False, "the card failed", 0)
    monkeypatch.undo()
    for device in ("cpu", "gpu"):
        host.inject(by(device))
        host.settle()
    assert choice(host).on_card


def test_auto_chooses_by_the_trial_once_the_bake_is_done(host):
    """llvmpipe is no card; a card of 0.05 ns a pixel is, and a slow one is not."""
    host.inject(by("auto"))
    host.settle()
    assert choice(host).why == "a processor renders"
    host.inject(CARD)
    host.settle()
    assert choice(host).on_card
    assert choice(host).why.endswith("of 2 ms, trial 0.05 ns")
    assert isinstance(light(host).texels, LateArray)
    host.inject(RendererTried(renderer="a slow card", trial_ns=9.0))
    host.settle()
    assert not choice(host).on_card
    assert isinstance(light(host).texels, Array)


def test_intermediate_rounds_and_stills_are_the_processors():
    """Tables are uploaded once a bake; the light of a still is kept on disk."""
    with Host() as host:
        reasons = []
        host.kernel.tap(lambda message, _: reasons.append((message, choice_of(host))))
        host.inject(*BEGIN, SetClock(instant=NOON), by("gpu"), LoadScene(path=INDOOR))
        host.settle()
    lights = [(light, why) for light, why in reasons if isinstance(light, SurfaceLightChanged)]
    assert len(lights) >= 2
    assert [isinstance(light.texels, LateArray) for light, _ in lights] == [
        *(False for _ in lights[1:]),
        True,
    ]


def choice_of(host):
    seat = host.kernel.seats.get(NAME)
    return None if seat is None else seat.module.devices.get("light")


def test_a_session_on_a_card_replays_without_one(tmp_path):
    """The journal has the inputs of the card's light; a replay without OpenGL finds the same."""
    stream = io.BytesIO()
    with Host() as host:
        recorder = Recorder(host.kernel, stream)
        host.inject(*BEGIN, SetClock(instant=NOON), by("gpu"), LoadScene(path=INDOOR))
        host.draw()
        host.inject(SetClock(instant=NOON + timedelta(hours=3)))
        host.draw()
        assert isinstance(light(host).texels, LateArray)
        recorder.close()
    path = tmp_path / "session.mcap"
    path.write_bytes(stream.getvalue())
    journal = Journal(path)
    outcome = Replay(journal, modules_for(journal.setup)).run()
    assert outcome.difference is None
    assert not outcome.by_value
