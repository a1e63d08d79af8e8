"""The night: a moon that moves beside a sun that moves, and all stars of the catalogue in a frame.

A moved body is a clock a minute later, with the picture's cube of 256, key light and ambient light
made anew; nothing has a twin.
"""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from itertools import count

import numpy as np

from vrut_lite.array import Array
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.host import Host
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot, ClockMoved, Demand, SetClock
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.messages.night import SLOT, StarsChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.messages.sun import KeyLightChanged
from vrut_lite.project import Project, daylight_inputs, view_inputs
from vrut_lite_lab.bench.bench_path import BenchPath, Group, Spent, Work, WorkClock
from vrut_lite_lab.bench.gl import PassTimer, clock_name, close_gl, missing_gl, on_close, renderer
from vrut_lite_lab.bench.paths.frame import PAVILION, SCENES

SKIES = ("dynamic_skylight", "bruneton_sky")
# By a full moon, and by day; over Prague.
HOURS = {
    "sun": datetime(2026, 1, 3, 9, tzinfo=UTC),
    "moon": datetime(2026, 1, 3, 20, tzinfo=UTC),
}
CUBE, SIZE, STARS = 256, (960, 600), 41_411
_PRAGUE = SetPlace(latitude_deg=50.08, longitude_deg=14.44)


def groups(quick: bool) -> list[Group]:
    """Bodies under both skies, and a frame without stars and with them."""
    bodies = tuple(_body_path(body, sky) for sky in SKIES[: 1 if quick else 2] for body in HOURS)
    reason = missing_gl()
    frames = () if reason else tuple(_frame_path(stars) for stars in (0, STARS))
    left_out = {"a frame with stars": reason} if reason else {}
    return [
        _group("night-bodies", "A moved sun, a moved moon", "a move", bodies),
        _group("night-frame", "The pavilion by night", "a frame", frames, left_out),
    ]


def _group(
    name: str,
    title: str,
    unit: str,
    paths: tuple[BenchPath, ...],
    left_out: dict[str, str] | None = None,
) -> Group:
    return Group(
        name=name,
        title=title,
        unit=unit,
        norm="none: it has no twin",
        truth="none",
        paths=paths,
        left_out=left_out or {},
    )


def _body_path(body: str, sky: str) -> BenchPath:
    return BenchPath(
        name=f"moved {body}, {sky}", family=sky, prepare=lambda: _moves(body, sky), error=None
    )


def _moves(body: str, sky: str) -> Work:
    """Each call moves the clock by a minute, to and fro within four hours."""
    kernel, _ = daylight_kernel()
    kernel.inject(ChooseSlot(slot="sky", module=sky))
    kernel.inject(_PRAGUE)
    kernel.inject(Demand(consumer="bench", message=BackgroundChanged.__name__, size=CUBE))
    for kind in (KeyLightChanged, AmbientChanged):
        kernel.inject(Demand(consumer="bench", message=kind.__name__))
    instants = _minutes(HOURS[body])
    _move(kernel, next(instants))
    return lambda: _move(kernel, next(instants))


def _minutes(start: datetime) -> Iterator[datetime]:
    return (start + timedelta(minutes=n % 240) for n in count())


def _move(kernel: Kernel, instant: datetime) -> None:
    kernel.inject(SetClock(instant=instant))
    kernel.pump_until_idle()


class Crowd(Module):
    """As many stars above the horizon as the catalogue has in all."""

    manifest = Manifest(name="crowd_of_stars", title="Stars", version="1", provides=(SLOT,))

    @handles(ClockMoved)
    def clock_moved(self, _clock: ClockMoved) -> None:
        """Tell them all."""
        direction = np.random.default_rng(5).normal(size=(STARS, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        direction[:, 1] = np.abs(direction[:, 1])
        self.link.post(
            StarsChanged(
                direction=Array(direction.astype(np.float32)),
                irradiance_rgb=Array(np.full((STARS, 3), 1e-9, np.float32)),
                source=self.manifest.name,
            )
        )


def _frame_path(stars: int) -> BenchPath:
    """The whole frame; of the one with stars, the pass that draws them."""
    made: list[_Stage] = []

    def prepare() -> Work:
        made.append(_Stage())
        return lambda: None

    return BenchPath(
        name=f"the pass of {stars} stars" if stars else "all passes without stars",
        family="stars" if stars else "frame",
        parameters={"width": SIZE[0], "height": SIZE[1]},
        prepare=prepare,
        error=None,
        batch=f"{stars} stars",
        clock=WorkClock(clock_name(renderer()), _spent(made, bool(stars))),
        device="GPU",
    )


def _spent(made: list["_Stage"], stars: bool) -> Callable[[Work], Spent]:
    return lambda _work: Spent(None, *[made[-1].seconds(stars)] * 2)


class _Stage:
    """A host with the crowd above the pavilion; all passes are timed apart."""

    def __init__(self) -> None:
        close_gl()
        scene = str(SCENES / PAVILION)
        project = Project(scene=scene, at="2026-01-15T22:00", size=SIZE)
        self._host = Host()
        self._host.kernel.add_module(Crowd)
        self._host.inject(ChooseSlot(slot=SLOT, module=Crowd.manifest.name))
        self._host.inject(*daylight_inputs(project), *view_inputs(project))
        self._host.draw()
        self._timer = self._host.gl.call(PassTimer)
        self._host.measure_passes(self._timer)
        on_close(self._host.close)

    def seconds(self, stars: bool) -> float:
        """Of the stars' pass, or of all others."""
        self._timer.spent.clear()
        self._host.draw()
        of_stars = self._timer.spent.get("parts over the sky", 0.0)
        return of_stars if stars else sum(self._timer.spent.values()) - of_stars
