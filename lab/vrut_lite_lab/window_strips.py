"""Strips of the pictures that a window shows while hours, places, weather, clouds and haze change.

    QT_QPA_PLATFORM=offscreen python -m vrut_lite_lab.window_strips FOLDER [STRIP ...]

Each strip is one PNG with all pictures of one act, in order. A caption says when the picture came
(seconds after the act began), its hour in UTC, its revision beside the kernel's, its mean grey and
what it waits for.
"""

import sys
import tempfile
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageOps
from PySide6.QtCore import QEventLoop, QTimer
from PySide6.QtWidgets import QApplication

from vrut_lite.app.engine.engine import Shown
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.stage import GlStage, Stage
from vrut_lite.app.theme import apply_theme
from vrut_lite.app.window.kept import Kept
from vrut_lite.app.window.main_window import MainWindow
from vrut_lite.kernel.messages import ChooseSlot, Input, SetClock, SetSetting
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.weather import SetWeather
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import project_of_path
from vrut_lite.scene.backend import IsGivenUp
from vrut_lite.scene.scene_state import SceneState
from vrut_lite_lab.checkout import ROOT

_SCENES = ROOT / "scenes"
_DAY = datetime(2026, 6, 21, tzinfo=UTC)
_NOON, _NIGHT = _DAY + timedelta(hours=11.75), _DAY + timedelta(hours=21.5)
_THUMB, _COLUMNS, _MOST = (240, 150), 8, 64
# Time between two inputs of a drag, and without a picture until an act is over.
_HAND_S, _REST_S, _LIMIT_S = 0.03, 2.5, 60.0
# An act: at what time (s) which inputs are sent, or what else is done.
Step = tuple[float, tuple[Input, ...] | Callable[[MainWindow], Any]]


def _at(instant: datetime) -> tuple[Input, ...]:
    return (SetClock(instant=instant),)


def _night() -> Iterator[Step]:
    yield 0.0, _at(_NIGHT)


def _drag() -> Iterator[Step]:
    """From 23:30 to 13:45, local time, and back, in 1.2 s each."""
    hours = np.concatenate([np.linspace(21.5, 11.75, 40), np.linspace(11.75, 21.5, 40)])
    for number, hour in enumerate(hours):
        yield number * _HAND_S, _at(_DAY + timedelta(hours=float(hour)))


def _map() -> Iterator[Step]:
    yield 0.0, (SetPlace(latitude_deg=-33.9, longitude_deg=151.2),)


def _clouds() -> Iterator[Step]:
    """Clouds come; the light map's panel is then opened and closed twice."""
    yield 0.0, (SetSetting(module="clouds", name="coverage", value=0.5),)
    for number in range(4):
        yield 3.0 + 2.0 * number, lambda window: window.board.toggle("panel light_transport")


def _haze() -> Iterator[Step]:
    for number, depth in enumerate(np.linspace(0.1, 0.9, 40)):
        yield number * _HAND_S, (SetHaze(optical_depth_550=float(depth)),)


def _year() -> SetWeather:
    """A year whose every day has eight bright hours."""
    day = np.zeros(24)
    day[6:18] = 1.0
    shines = np.tile(day, 365)
    return SetWeather(
        path="bright",
        name="bright",
        latitude_deg=50.1,
        longitude_deg=14.4,
        altitude_m=200.0,
        utc_offset_h=1.0,
        direct_normal_w_m2=tuple(700.0 * shines),
        diffuse_horizontal_w_m2=tuple(120.0 * shines),
        dew_point_c=(11.0,) * 8760,
    )


class Strip(NamedTuple):
    """An act, the scene in which it is played, and inputs before it."""

    act: Callable[[], Iterator[Step]]
    scene: str = "pavilion.gltf"
    before: tuple[Input, ...] = ()


_BY_WEATHER = (ChooseSlot(slot="sky", module="weather_sky"), _year())
_BRUNETON = (ChooseSlot(slot="sky", module="bruneton_sky"),)
STRIPS = {
    "night": Strip(_night),
    "drag": Strip(_drag, before=_at(_NIGHT)),
    "map": Strip(_map),
    "weather": Strip(_night, before=_BY_WEATHER),
    "clouds": Strip(_clouds, scene="street.toml"),
    "haze": Strip(_haze, before=_BRUNETON),
}


class ShownFrame(NamedTuple):
    """A picture that was shown."""

    seconds: float
    picture: NDArray[np.uint8]
    caption: str


class NotedStage(GlStage):
    """A stage with OpenGL that remembers which state each picture shows."""

    def __init__(self) -> None:
        super().__init__()
        self.states: dict[int, SceneState] = {}

    def draw(self, state: SceneState, still: bool, is_given_up: IsGivenUp | None = None) -> Picture:
        """Draw a state and note it."""
        picture = super().draw(state, still, is_given_up)
        self.states[id(picture)] = state
        return picture


def frames_of(strip: Strip) -> list[ShownFrame]:
    """All pictures of an act, in a new window."""
    stages, frames = list[NotedStage](), list[ShownFrame]()
    began_s = last_s = perf_counter()
    waits = ""

    def open_stage() -> Stage:
        stages.append(NotedStage())
        return stages[0]

    session = Session(open_stage)

    def take(shown: Shown) -> None:
        nonlocal last_s, waits
        last_s = perf_counter()
        state, pixels = stages[0].states[id(shown.picture)], shown.picture.display
        key = state.key_light
        assert key is not None
        height = np.degrees(np.arcsin(key.direction[1]))
        waits = " ".join([*(f"draft:{name}" for name in shown.drafts), *shown.refining])
        revision = shown.revision
        kind = "finished" if shown.still else f"{pixels.shape[1]} px"
        caption = (
            f"{last_s - began_s:.2f} s  {key.body} {height:.1f}  r{revision}\n"
            f"grey {pixels.mean():.0f}  {kind}  {waits}"
        )
        small = ImageOps.pad(Image.fromarray(pixels), _THUMB, Image.Resampling.BILINEAR)
        frames.append(ShownFrame(last_s - began_s, np.asarray(small), caption))

    with tempfile.TemporaryDirectory() as folder:
        window = MainWindow(session, kept=Kept(Path(folder)))
        window.resize(1000, 700)
        window.show()
        session.start()
        project = project_of_path(str(_SCENES / strip.scene))
        window.files.open_project(msgspec.structs.replace(project, at=_NOON.isoformat()))
        session.picture_shown.connect(take)
        _run(lambda: bool(frames) and perf_counter() - last_s > _REST_S)
        if strip.before:
            last_s = perf_counter()
            session.send(*strip.before)
            _run(lambda: perf_counter() - last_s > _REST_S)
        frames[:-1] = []
        began_s = last_s = perf_counter()
        steps = list(strip.act())

        def over() -> bool:
            now_s = perf_counter()
            while steps and now_s - began_s >= steps[0][0]:
                step = steps.pop(0)[1]
                if callable(step):
                    step(window)
                else:
                    session.send(*step)
            # A busy machine shows nothing for seconds; the last picture says whether more come.
            return not (steps or waits) and len(frames) > 1 and now_s - last_s > _REST_S

        _run(over)
        window.close()
        _run(lambda: session.has_ended)
        session.join()
    return frames


def _run(is_over: Callable[[], bool]) -> None:
    """Let Qt work until something is so."""
    loop, watch = QEventLoop(), QTimer(interval=4)
    end_s = perf_counter() + _LIMIT_S
    watch.timeout.connect(lambda: loop.quit() if is_over() or perf_counter() > end_s else None)
    watch.start()
    loop.exec()


def sheet(frames: list[ShownFrame]) -> Image.Image:
    """The pictures in rows, each above its caption; of many every n-th."""
    frames = frames[:: -(-len(frames) // _MOST)]
    width, height = _THUMB[0] + 4, _THUMB[1] + 32
    rows = -(-len(frames) // _COLUMNS)
    page = Image.new("RGB", (width * _COLUMNS, height * rows), "white")
    draw = ImageDraw.Draw(page)
    for number, frame in enumerate(frames):
        x, y = number % _COLUMNS * width, number // _COLUMNS * height
        page.paste(Image.fromarray(frame.picture), (x, y))
        draw.text((x + 2, y + _THUMB[1] + 2), frame.caption, fill="black")
    return page


def main() -> None:
    """Write the strips."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    app = QApplication([])
    apply_theme(app)
    for name in sys.argv[2:] or STRIPS:
        frames = frames_of(STRIPS[name])
        sheet(frames).save(folder / f"{name}.png")
        print(name)
        for frame in frames:
            print("   ", frame.caption.replace("\n", "  "), flush=True)


if __name__ == "__main__":
    main()
