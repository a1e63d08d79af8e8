"""Somebody who draws the engine's states elsewhere, as a headset does."""

import time
from datetime import timedelta

from window_driver import NOON, PATIENCE_MS, SUNDIAL_AT_NOON, HeadlessStage

from vrut_lite.app.engine.engine import Engine
from vrut_lite.app.engine.revision_news import ENDED, PICTURE
from vrut_lite.kernel.messages import SetClock
from vrut_lite.messages.camera import MoveCamera


class Watching:
    """An engine that is watched, and what it showed, drew and closed, in order."""

    def __init__(self):
        self.shown, self.pictures, self.ends = [], [], []
        watching = self

        class Stage(HeadlessStage):
            def close(self):
                watching.ends.append("stage")
                super().close()

        self.engine = Engine(Stage, self._tell)
        self.engine.start()
        self.engine.send(
            *SUNDIAL_AT_NOON, MoveCamera(eye_m=(3.0, 1.0, 4.0), target_m=(0.0, 0.0, 0.0))
        )

    def _tell(self, key, value):
        if key == PICTURE:
            self.pictures.append(value)
        elif key == ENDED:
            self.ends.append("engine")

    def show(self, state):
        self.shown.append(state)

    def close(self):
        self.ends.append("watcher")

    def until(self, condition):
        end_s = time.monotonic() + PATIENCE_MS / 1000
        while not condition():
            assert time.monotonic() < end_s
            time.sleep(0.005)


def test_a_watcher_is_shown_each_state_and_closed_before_the_stage():
    """States are whole and of one hour each; meanwhile no picture is finished, which would keep
    the GL thread for longer than a frame; thereafter one is."""
    watching = Watching()
    engine = watching.engine
    watching.until(lambda: bool(watching.pictures) and watching.pictures[-1].still)
    engine.watch(watching)
    watching.until(lambda: bool(watching.shown))
    suns = {watching.shown[-1].key_light.direction}
    watching.pictures.clear()
    for hours in (1, 2, 3):
        engine.send(SetClock(instant=NOON + timedelta(hours=hours)))
        watching.until(lambda: watching.shown[-1].key_light.direction not in suns)
        suns.add(watching.shown[-1].key_light.direction)
        assert not watching.shown[-1].missing
    # Longer than the rest after which a picture would be finished.
    watching.until(lambda: bool(watching.pictures))
    time.sleep(0.5)
    assert not any(picture.still for picture in watching.pictures)
    engine.watch(None)
    watching.until(lambda: watching.pictures[-1].still)
    engine.watch(watching)
    engine.stop()
    assert engine.join(PATIENCE_MS / 1000)
    assert watching.ends == ["watcher", "stage", "engine"]
