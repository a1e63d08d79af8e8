"""Sessions with light transport replay: the same layout, the same rounds, the same light."""

import io
import random
from datetime import UTC, datetime, timedelta

import pytest
from dynamic_skylight.module import DynamicSkyLight
from light_stage import box_file, lights
from light_transport import module as light_transport
from light_transport.messages import NAME
from light_transport.module import LightTransport
from long_parameters import mostly_long

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Demand, RestartModule, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay
from vrut_lite.scene.manager import SceneManager
from vrut_lite.sky.sky_sum import SkySum

MODULES = [DynamicSkyLight, LightTransport, SceneManager, SkySum]
NOON = datetime(2026, 6, 21, 11, tzinfo=UTC)
BEGIN = (
    SetSetting(module=NAME, name="quality", value="draft"),
    SetSetting(module=NAME, name="texel_m", value=1.0),
    SetPlace(latitude_deg=50.0, longitude_deg=14.0),
    SetClock(instant=NOON),
    Demand(consumer="test", message="SurfaceLightChanged"),
)


def recorded(tmp_path, play):
    """The journal of a session on a live kernel with threads, and what was said in it."""
    kernel, stream, said = Kernel(), io.BytesIO(), []
    for module in MODULES:
        kernel.add_module(module)
    kernel.tap(lambda message, _: said.append(message))
    recorder = Recorder(kernel, stream)
    for message in BEGIN:
        kernel.inject(message)
    play(kernel)
    kernel.pump_until_idle()
    recorder.close()
    kernel.close()
    path = tmp_path / "session.mcap"
    path.write_bytes(stream.getvalue())
    return Journal(path), said


def test_a_session_with_scene_and_hours_replays(tmp_path):
    """Digest for digest, with a cache that is full by then, and with an empty one."""

    def play(kernel):
        kernel.inject(LoadScene(path=str(box_file(tmp_path))))
        kernel.pump_until_idle()
        for hour in range(3):
            kernel.inject(SetClock(instant=NOON + timedelta(hours=hour)))
            kernel.pump_until_idle()

    journal, said = recorded(tmp_path, play)
    assert len(lights(said)) >= 4
    assert Replay(journal, MODULES).run().difference is None
    for path in (tmp_path / "cache").rglob("*.arrays"):
        path.unlink()
    outcome = Replay(journal, MODULES).run()
    assert outcome.difference is None
    assert not outcome.by_value


def test_a_scene_of_many_triangles_replays(tmp_path, monkeypatch):
    """Its first light by probes, then its map."""
    monkeypatch.setattr(light_transport, "_MANY_TRIANGLES", 0)

    def play(kernel):
        two = box_file(tmp_path, boxes=((0.0, 2.0), (5.0, 1.0)))
        kernel.inject(LoadScene(path=str(two)))

    journal, said = recorded(tmp_path, play)
    assert len({light.layout_key for light in lights(said)}) == 2
    outcome = Replay(journal, MODULES).run()
    assert outcome.difference is None
    assert not outcome.by_value


@pytest.mark.parametrize("seed", mostly_long(range(8), lambda seed: seed == 0))
def test_random_sessions_replay(tmp_path, seed):
    """Scenes, hours, settings and restarts at any moment, while rounds and hours are under way."""
    rng = random.Random(seed)
    files = [
        str(box_file(tmp_path, f"{n}.obj", boxes=((0.0, 1.0 + n),), colour=0.2 + 0.3 * n))
        for n in range(2)
    ]

    def play(kernel):
        for _ in range(12):
            kernel.inject(
                rng.choice(
                    [
                        LoadScene(path=rng.choice(files)),
                        SetClock(instant=NOON + timedelta(hours=rng.uniform(-6.0, 6.0))),
                        SetSetting(module=NAME, name="on", value=rng.random() < 0.6),
                        SetSetting(module=NAME, name="texel_m", value=rng.choice([0.7, 1.0])),
                        RestartModule(module=NAME),
                    ]
                )
            )
            if rng.random() < 0.5:
                kernel.pump()
            else:
                kernel.pump_until_idle()

    journal, _ = recorded(tmp_path, play)
    outcome = Replay(journal, MODULES).run()
    assert outcome.difference is None
    assert not outcome.by_value
