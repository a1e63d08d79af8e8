"""Each picture shows one hour, sky and light, for any inputs at any pace."""

import random
import threading
import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from vrut_lite.app.engine.engine import Engine
from vrut_lite.app.engine.revision_news import PICTURE, PROBLEM
from vrut_lite.app.engine.stage import GlStage
from vrut_lite.host import Host
from vrut_lite.kernel.messages import (
    ChooseSlot,
    Demand,
    EnableModule,
    JobResult,
    SetClock,
    SetSetting,
)
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.picture import Resize
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import LoadScene
from vrut_lite.messages.sky import AmbientChanged
from vrut_lite.messages.weather import SetWeather

flip_evaluator = pytest.importorskip(
    "flip_evaluator", reason="the package flip-evaluator of the extra ref is missing"
)

pytestmark = pytest.mark.gl

SCENE = str(Path(__file__).parents[2] / "scenes/work/room.glb")
DAY = datetime(2026, 6, 21, tzinfo=UTC)
SIZE = (96, 64)
PATIENCE_S = 240.0
# Longest time from an input to its picture on a busy machine.
BUSY_S = 15.0
BEGINNING = (
    Resize(width_px=SIZE[0], height_px=SIZE[1]),
    SetPlace(latitude_deg=50.0, longitude_deg=14.4),
    SetClock(instant=DAY + timedelta(hours=11)),
    LoadScene(path=SCENE),
)
# Mean HDR-FLIP beside a picture of the same revision that nobody hurried.
LARGEST_FLIP = 0.05


def year():
    shines = np.tile(np.repeat([0.0, 1.0, 0.0], [6, 12, 6]), 365)
    return SetWeather(
        path="bright",
        name="bright",
        latitude_deg=50.0,
        longitude_deg=14.4,
        altitude_m=200.0,
        utc_offset_h=1.0,
        direct_normal_w_m2=tuple(600.0 * shines),
        diffuse_horizontal_w_m2=tuple(150.0 * shines),
        dew_point_c=(11.0,) * 8760,
    )


def random_input(chance):
    """A random input; hours are the most frequent."""
    kinds = {
        "hour": 8, "place": 1, "sky": 1, "weather": 1, "clouds": 1, "haze": 2, "camera": 2,
        "size": 1, "panel": 1, "module": 1, "light": 1,
    }  # fmt: skip
    match chance.choices(list(kinds), kinds.values())[0]:
        case "hour":
            return SetClock(instant=DAY + timedelta(hours=chance.uniform(0.0, 24.0)))
        case "place":
            latitude_deg, longitude_deg = chance.choice([(50.0, 14.4), (-33.9, 151.2), (70, 25)])
            return SetPlace(latitude_deg=latitude_deg, longitude_deg=longitude_deg)
        case "sky":
            skies = ("dynamic_skylight", "bruneton_sky", "weather_sky")
            return ChooseSlot(slot="sky", module=chance.choice(skies))
        case "weather":
            return year()
        case "clouds":
            coverage = chance.choice([0.0, 0.5])
            return SetSetting(module="clouds", name="coverage", value=coverage)
        case "haze":
            return SetHaze(optical_depth_550=chance.uniform(0.05, 0.6))
        case "camera":
            x_m = chance.uniform(-0.3, 0.3)
            return MoveCamera(eye_m=(x_m, 1.6, 1.5), target_m=(0.0, 1.2, -2.0))
        case "size":
            return Resize(width_px=SIZE[0], height_px=chance.choice([SIZE[1], 80]))
        case "panel":
            size = chance.choice([None, 0])
            return Demand(consumer="panel", message=AmbientChanged.__name__, size=size)
        case "module":
            return EnableModule(module="night_sky", enabled=chance.random() < 0.7)
    return SetSetting(module="light_transport", name="on", value=chance.random() < 0.8)


class HurriedWindow:
    """The window's engine, what it drew, and the inputs of each revision."""

    def __init__(self):
        self.pictures, self.admitted, self.problems = [], [], []
        self.rested = threading.Event()
        self.engine = Engine(self._opened, self._told, deadline_s=PATIENCE_S)
        self.engine.start()

    def _opened(self):
        self.stage, self.drawn = GlStage(), None
        draw, kernel = self.stage.draw, self.stage.kernel

        def noted(state, *arguments):
            self.drawn = state
            return draw(state, *arguments)

        def admit(message):
            if not isinstance(message, JobResult):
                self.admitted.append((kernel.revision, message))

        self.stage.draw = noted
        kernel.watch_admission(admit)
        return self.stage

    def _told(self, key, value):
        if key == PICTURE:
            self.pictures.append((value, self.drawn))
            if value.still:
                self.rested.set()
        elif key[0] == PROBLEM:
            self.problems.append(value)

    def rest(self):
        """Wait until nothing more is drawn, and no light grows finer.

        A busy machine shows nothing for seconds after an input; some inputs change nothing at all.
        """
        count, end_s = 0, time.monotonic()
        while count != len(self.pictures) or self._waits(end_s):
            if count != len(self.pictures):
                count, end_s = len(self.pictures), time.monotonic() + BUSY_S
            self.rested.clear()
            self.rested.wait(1.0)

    def _waits(self, end_s):
        """Whether the last picture is to be followed, or, until `end_s`, is older than an input."""
        if not self.pictures:
            return True
        last = self.pictures[-1][0]
        is_older = any(number > last.revision for number, _ in self.admitted)
        return bool(last.refining or last.drafts) or (is_older and time.monotonic() < end_s)

    def see_another(self):
        """Wait until one more picture is shown; not for long, as an input may change nothing."""
        count, end_s = len(self.pictures), time.monotonic() + 0.5
        while len(self.pictures) == count and time.monotonic() < end_s:
            time.sleep(0.01)

    def close(self):
        self.engine.stop()
        assert self.engine.join(PATIENCE_S)


class Reference:
    """A host that takes the same inputs one after the other, each at rest."""

    def __init__(self):
        self.host = Host()

    def picture(self, inputs, state, still):
        for message in inputs:
            self.host.inject(message)
            self.host.settle()
        shown = replace(
            self.host.state,
            size_px=state.size_px,
            moved_camera=state.moved_camera,
            exposure=state.exposure,
        )
        return self.host.draw_state(shown, still).radiance


def flip(one, other):
    """Mean HDR-FLIP; 0 where both are black."""
    level = max(float(one.mean()), float(other.mean()))
    if level <= 0.0:
        return 0.0
    scaled = [np.maximum(image / level, 0.0).astype(np.float32) for image in (other, one)]
    return float(flip_evaluator.evaluate(*scaled, "HDR")[1])


def hurried(seed, count, more=()):
    """Pictures of a random session, with what they show, and its inputs."""
    chance, window = random.Random(seed), HurriedWindow()
    try:
        window.engine.send(*BEGINNING, *more)
        window.rest()
        for number in range(count):
            window.engine.send(random_input(chance))
            if number % 3:
                time.sleep(chance.choice([0.0, 0.03, 0.1]))
            else:
                window.see_another()
        window.rest()
    finally:
        window.close()
    return window


def check_session(seed, count, more=()):
    window = hurried(seed, count, more)
    assert not window.problems, window.problems
    revisions = [shown.revision for shown, _ in window.pictures]
    assert revisions == sorted(revisions)
    reference, inputs = Reference(), list(window.admitted)
    errors = []
    try:
        for revision in dict.fromkeys(revisions):
            # A draft says that it is one.
            of_it = [
                (shown, state)
                for shown, state in window.pictures
                if shown.revision == revision and not shown.drafts
            ]
            taken = [message for number, message in inputs if number <= revision]
            inputs = [entry for entry in inputs if entry[0] > revision]
            for shown, state in {shown.still: (shown, state) for shown, state in of_it}.values():
                wanted = reference.picture(taken, state, shown.still)
                taken = []
                error = flip(shown.picture.radiance, wanted)
                errors.append((error, revision, shown.still, shown.refining))
    finally:
        reference.host.close()
    return errors


def test_every_picture_in_a_hurried_session_is_that_of_its_revision_at_rest():
    """Light of noon never stands under a sky of night, nor clouds in the light of before.

    The radiance is compared, so that exposures do not matter.
    """
    errors = check_session(4, 10)
    assert len(errors) >= 3
    assert max(errors)[0] <= LARGEST_FLIP


@pytest.mark.long
@pytest.mark.parametrize("seed", range(2, 22))
def test_so_it_is_in_other_sessions(seed):
    errors = check_session(seed, 40)
    assert max(errors)[0] <= LARGEST_FLIP


@pytest.mark.long
@pytest.mark.parametrize("seed", [4, 5, 6])
def test_so_it_is_where_the_card_lights_surfaces(seed):
    """Its light is computed when a picture of its revision is drawn."""
    by_card = SetSetting(module="light_transport", name="device", value="gpu")
    errors = check_session(seed, 15, (by_card,))
    assert len(errors) >= 3
    assert max(errors)[0] <= LARGEST_FLIP
