"""The panel of daylight numbers: lux, daylight factor and sky view on the work planes of a scene.

The window imports it by the entry point `vrut_lite.panels`. The first measurement makes the matrix
of the sensors, which takes seconds; then each hour takes a tenth of one, and follows the clock.
"""

from collections.abc import Callable
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from threading import Event
from typing import TYPE_CHECKING

import numpy as np
from light_transport.public import hour_of, unless
from PySide6.QtCore import QEvent, Signal
from PySide6.QtGui import QHideEvent, QMouseEvent, QShowEvent
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QProgressBar, QPushButton, QWidget

from daylight_numbers.matrix.sensors import SensorGrid, Sensors
from daylight_numbers.pictures import drawn_grid, grid_of_plane
from vrut_lite.errors import GivenUp
from vrut_lite.geometry.false_colours import Scale, scale_of
from vrut_lite.kernel.messages import ClockMoved, Demand, SetSetting, SettingChanged
from vrut_lite.lazy import lazy
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.sky import SkyRadianceChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.tolerance import DEFAULT_TOLERANCE, SetTolerance
from vrut_lite.numeric_types import FloatArray
from vrut_lite.panel_kit import (
    Chooser,
    FittedPicture,
    Legend,
    Session,
    faint_label,
    make_timer,
    panel_column,
)
from vrut_lite.place_time import Place, local_text
from vrut_lite.quantities import figure, lux_text, percent_text

if TYPE_CHECKING:
    from daylight_numbers.now import NumbersNow
    from daylight_numbers.work import DaylightWork

# scipy takes a third of a second to import, which the window need not wait for.
_now, _work = lazy("daylight_numbers.now"), lazy("daylight_numbers.work")
_CONSUMER = "daylight numbers"
_LIGHT = (SkyRadianceChanged, SkyLightChanged)
_SKY_SIZE = 128
_HEIGHT_M, _STEP_M = 0.85, 0.5
_REST_MS, _UNDER_LINES = 150, 3
_IDLE = (
    f"Sensors stand {_HEIGHT_M} m above the floors of rooms, or above open ground, every {_STEP_M} "
    "m. The first measurement takes half a minute or less; then it follows the hour."
)
_STOPPED = "Stopped: nothing new was measured."
_AT_WORK = "Rays from the sensors, and light between surfaces \N{HORIZONTAL ELLIPSIS}"
_HINT_PX = (280, 240)


@dataclass(frozen=True, eq=False)
class MeasuredHour:
    """The numbers of an hour."""

    work: "DaylightWork"
    numbers: "NumbersNow"
    instant: datetime


def _percents(percent: float) -> str:
    """A daylight factor: percent, with two decimals."""
    return percent_text(0.01 * percent, 2)


_KINDS: dict[str, tuple[Callable[[MeasuredHour], FloatArray], Callable[[float], str]]] = {
    "Illuminance": (lambda found: found.numbers.light.total, lux_text),
    "Daylight factor": (lambda found: found.numbers.daylight_factor_percent, _percents),
    "Sky view": (lambda found: found.numbers.sky_view, percent_text),
}


class DaylightPanel(QWidget):
    """A button, the plan of a work plane in false colours, and values under the pointer."""

    title = "Daylight numbers"
    keys = "Shift+L"

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._thread = ThreadPoolExecutor(1, "vrut-lite daylight numbers")
        self._given_up = Event()
        self._is_busy = False
        self._is_outdated = False
        self.measured: MeasuredHour | None = None
        self._of_scene: SceneOpened | None = None
        self.measure = QPushButton("Measure")
        self.measure.setToolTip("Lux of this hour, daylight factor and sky view on work planes")
        self.progress = QProgressBar()
        self.progress.setRange(0, 0)
        self.progress.hide()
        self.facts = faint_label(_IDLE, wraps=True)
        self.kind, self.plane = Chooser(), Chooser()
        self.kind.addItems(list(_KINDS))
        self.kind.setAccessibleName("what the plan shows")
        self.plane.setAccessibleName("work plane")
        self.plane.hide()
        self.view, self.legend = PlaneView(), Legend()
        self.under = faint_label("", wraps=True)
        # The plan stays where it is while the text comes and goes.
        self.under.setMinimumHeight(_UNDER_LINES * self.under.fontMetrics().lineSpacing())
        self.over_scene = QCheckBox("illuminance over the scene")
        self.over_scene.setToolTip(
            "The picture in false colours, with its own legend: View, Illuminance"
        )
        row = QHBoxLayout()
        row.addWidget(self.kind, 1)
        row.addWidget(self.plane, 1)
        column = panel_column(self)
        above: tuple[QWidget, ...] = (self.measure, self.progress, self.facts)
        for part in above:
            column.addWidget(part)
        column.addLayout(row)
        column.addWidget(self.view, 1)
        below: tuple[QWidget, ...] = (self.legend, self.under, self.over_scene)
        for part in below:
            column.addWidget(part)
        self._follows = make_timer(self, _REST_MS, self._follow, once=True)
        self._connect()

    def _connect(self) -> None:
        session = self._session
        self.measure.clicked.connect(self.start)
        self.kind.currentIndexChanged.connect(self._draw)
        self.plane.currentIndexChanged.connect(self._draw)
        self.view.pointed.connect(self._tell)
        self.over_scene.clicked.connect(
            lambda on: session.send(
                SetSetting(module="scene", name="shows", value="illuminance" if on else "picture")
            )
        )
        session.listen(SettingChanged, self._setting_changed)
        session.listen(SceneOpened, self._scene_opened)
        session.listen(SkyLightChanged, lambda _: self._follows.start())
        session.closing.connect(self._end)

    def showEvent(self, event: QShowEvent) -> None:
        """Ask for the light of the sky."""
        self._demand(on=True)

    def hideEvent(self, event: QHideEvent) -> None:
        """Take the demand back."""
        if not self._session.has_ended:
            self._demand(on=False)

    def start(self) -> None:
        """Measure the present hour, beside the window's work; while that goes on, stop it."""
        scene, light = self._session.last(SceneOpened), self._present_light()
        clock = self._session.last(ClockMoved)
        if self._is_busy:
            self._stop()
            self.facts.setText(_STOPPED)
            return
        if scene is None or light is None or clock is None:
            self.facts.setText("There is no scene, or no sky: nothing can be measured yet.")
            return
        known = self.measured.work if self.measured is not None else None
        tolerance = self._session.last(SetTolerance) or SetTolerance(tolerance=DEFAULT_TOLERANCE)
        self._is_busy, self._is_outdated = True, False
        self._show_busy(known is None)
        given_up = self._given_up
        measure = partial(
            _measure, scene, known, light, clock.instant, tolerance.tolerance, given_up
        )
        self._session.follow(
            self._thread.submit(measure),
            partial(self._take, given_up),
            lambda line: self._fail(given_up, line),
        )

    # --- messages ----------------------------------------------------------------------------

    def _demand(self, on: bool) -> None:
        """No background is asked for: nobody looks."""
        size = _SKY_SIZE if on else 0
        self._session.send(
            *(
                Demand(
                    consumer=_CONSUMER,
                    message=kind.__name__,
                    size=size if kind is SkyRadianceChanged or not on else None,
                )
                for kind in _LIGHT
            )
        )

    def _present_light(self) -> SkyLightChanged | None:
        light = self._session.last(SkyLightChanged)
        return None if light is None or light.radiance is None else light

    def _scene_opened(self, scene: SceneOpened) -> None:
        """Drop the numbers of another scene."""
        if self._of_scene is not None and scene.content_key == self._of_scene.content_key:
            return
        self._of_scene = scene
        self._stop()
        self.measured = None
        self.plane.clear()
        self.plane.hide()
        self.view.show_nothing()
        self.legend.show_values([])
        self.under.clear()
        self.facts.setText(_IDLE)

    def _setting_changed(self, message: SettingChanged) -> None:
        if (message.module, message.name) == ("scene", "shows"):
            self.over_scene.setChecked(message.value == "illuminance")

    def _follow(self) -> None:
        """Another hour or sky, once it rests."""
        if self._is_busy:
            self._is_outdated = True
        elif self.measured is not None and self.isVisible():
            self.start()

    def _take(self, given_up: Event, measured: MeasuredHour) -> None:
        if given_up is not self._given_up:
            return
        self._rest()
        self.measured = measured
        names = list(measured.work.sensors.names)
        if [self.plane.itemText(n) for n in range(self.plane.count())] != names:
            self.plane.clear()
            self.plane.addItems(names)
        self.plane.setVisible(len(names) > 1)
        self._draw()
        if self._is_outdated:
            self._follow()

    def _fail(self, given_up: Event, line: str) -> None:
        if given_up is not self._given_up:
            return
        self._rest()
        self.facts.setText(line)

    def _stop(self) -> None:
        self._given_up.set()
        self._given_up = Event()
        self._rest()

    def _rest(self) -> None:
        self._is_busy = False
        self._show_busy(False)

    def _show_busy(self, busy: bool) -> None:
        self.progress.setVisible(busy)
        self.measure.setText("Stop" if busy else "Measure")
        if busy:
            self.facts.setText(_AT_WORK)

    def _end(self) -> None:
        self._given_up.set()
        self._thread.shutdown(wait=False, cancel_futures=True)

    # --- the picture -------------------------------------------------------------------------

    def _draw(self) -> None:
        plane = self.plane.currentIndex()
        if self.measured is None or plane < 0:
            return
        values_of, said = _KINDS[self.kind.currentText()]
        values = values_of(self.measured)
        scale = self.view.show_plane(self.measured.work.sensors, values, plane)
        shown = [said(scale.at(share)) for share in (0.0, 0.5, 1.0)]
        self.legend.show_values(shown if scale.high > 0.0 else [])
        place = self._session.last(SetPlace)
        assert place is not None
        when = local_text(self.measured.instant, Place(place.latitude_deg, place.longitude_deg))
        self.facts.setText(f"{when}; {summary(self.measured, plane)}")

    def _tell(self, sensor: int) -> None:
        self.under.setText(
            "" if self.measured is None or sensor < 0 else sensor_text(self.measured, sensor)
        )


def summary(measured: MeasuredHour, plane: int) -> str:
    """The plane's means and extremes."""
    here = measured.work.sensors.plane == plane
    lux, factor = measured.numbers.light.total[here], measured.numbers.daylight_factor_percent[here]
    return (
        f"{here.sum():,} sensors: mean {lux_text(lux.mean())}, least {figure(lux.min())}, most "
        f"{figure(lux.max())}; daylight factor (CIE 16) mean {_percents(factor.mean())}, median "
        f"{_percents(float(np.median(factor)))}"
    )


def sensor_text(measured: MeasuredHour, sensor: int) -> str:
    """The numbers of one sensor, with the standard errors that rays leave."""
    numbers, light = measured.numbers, measured.numbers.light
    return (
        f"{figure(light.total[sensor])} \N{PLUS-MINUS SIGN} {light.noise[sensor]:.2g} lx "
        f"(sun {figure(light.sun[sensor])}, sky {figure(light.sky[sensor])}, surfaces "
        f"{figure(light.surfaces[sensor])}); daylight factor "
        f"{numbers.daylight_factor_percent[sensor]:.2f} \N{PLUS-MINUS SIGN} "
        f"{numbers.daylight_factor_error_percent[sensor]:.1g} %; sky view "
        f"{percent_text(numbers.sky_view[sensor])}"
    )


def _measure(
    scene: SceneOpened,
    known: "DaylightWork | None",
    light: SkyLightChanged,
    instant: datetime,
    tolerance: float,
    given_up: Event,
) -> MeasuredHour:
    """On the panel's own thread."""
    go_on = unless(given_up.is_set)
    try:
        work = known or _work.work_of(scene, SensorGrid(_HEIGHT_M, _STEP_M), tolerance, go_on)
        return MeasuredHour(work, _now.numbers_now(work, hour_of(light), go_on=go_on), instant)
    except GivenUp:
        raise CancelledError from None


class PlaneView(FittedPicture):
    """North (-z) is up. `pointed` emits the number of the sensor under the pointer, or -1."""

    pointed = Signal(int)

    def __init__(self) -> None:
        super().__init__("plan of a work plane", _HINT_PX)
        self._sensor = np.full((1, 1), -1)
        self.setMouseTracking(True)

    def show_plane(self, sensors: Sensors, values: FloatArray, plane: int) -> Scale:
        """Show values (P,) on one of the planes; the scale is that of all planes."""
        scale = scale_of(values)
        self._sensor = grid_of_plane(sensors, plane)
        shown = np.where(self._sensor >= 0, values[self._sensor], np.nan)
        self.show_pixels(drawn_grid(shown, scale))
        return scale

    def show_nothing(self) -> None:
        """Show no plane."""
        self._sensor = np.full((1, 1), -1)
        self.show_pixels(None)

    def sensor_at(self, x: float, y: float) -> int:
        """The sensor at a point of the widget; -1 for none."""
        place = self.picture_place
        if not place.contains(int(x), int(y)):
            return -1
        rows, columns = self._sensor.shape
        row = int((y - place.y()) / place.height() * rows)
        column = int((x - place.x()) / place.width() * columns)
        return int(self._sensor[min(row, rows - 1), min(column, columns - 1)])

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Tell the sensor under the pointer."""
        self.pointed.emit(self.sensor_at(event.position().x(), event.position().y()))

    def leaveEvent(self, event: QEvent) -> None:
        """No sensor is under it."""
        self.pointed.emit(-1)
