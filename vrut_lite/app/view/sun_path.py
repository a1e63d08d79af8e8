"""The sun's paths of the day and of the solstices, and the moon's, drawn over the picture."""

from datetime import timedelta

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen

from vrut_lite.app import theme
from vrut_lite.app.engine.day import Day
from vrut_lite.app.engine.moon_day import MoonDay
from vrut_lite.app.view.solstices import SOLSTICES, sun_circle
from vrut_lite.app.view.view_projection import project_directions
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved

_MARGIN = 0.2
_SOLSTICE_COLOUR, _MOON_COLOUR = "#c9d8ec", "#aab6d6"


class SunPath(QObject):
    """The arc above the horizon, dotted below; a dot and a number each full hour."""

    changed = Signal()

    def __init__(self, parent: QObject | None = None):
        super().__init__(parent)
        self.shown = False
        self._day: Day | None = None
        self._sun: SunMoved | None = None
        self._moon_day: MoonDay | None = None
        self._moon: NightLightChanged | None = None
        self._solstices: dict[str, NDArray[np.float64]] = {}

    def show(self, shown: bool) -> None:
        """Draw it, or not."""
        self.shown = shown
        self.changed.emit()

    def set_day(self, day: Day) -> None:
        """Show the path of this day."""
        self._day = day
        self.changed.emit()

    def set_place(self, place: SetPlace) -> None:
        """Show the solstices of this place."""
        self._solstices = {name: sun_circle(place, tilt) for name, tilt in SOLSTICES.items()}
        self.changed.emit()

    def set_sun(self, sun: SunMoved) -> None:
        """Mark the sun's position."""
        self._sun = sun
        self.changed.emit()

    def set_moon_day(self, moon: MoonDay | None) -> None:
        """Show the moon's path of the day."""
        self._moon_day = moon
        self.changed.emit()

    def set_moon(self, night: NightLightChanged) -> None:
        """Mark the moon's position."""
        self._moon = night
        self.changed.emit()

    def paint(self, painter: QPainter, place: QRectF, camera: MoveCamera) -> None:
        """Draw over a picture of this camera that fills `place`."""
        if not self.shown or self._day is None:
            return
        day = self._day
        points = project_directions(day.direction, camera, place.width() / place.height())
        up = day.direction[:, 1] >= 0.0
        colour = QColor(theme.ACCENT)
        for above, style in ((True, Qt.PenStyle.SolidLine), (False, Qt.PenStyle.DotLine)):
            painter.setPen(QPen(colour, 1.6 if above else 1.0, style))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawPath(_path(points, up == above, place))
        self._paint_solstices(painter, place, camera)
        self._paint_hours(painter, place, camera)
        if self._sun is not None:
            self._paint_body(painter, place, camera, self._sun, 9.0)
        if self._moon_day is not None:
            self._paint_moon(painter, place, camera, self._moon_day.direction)

    def _paint_solstices(self, painter: QPainter, place: QRectF, camera: MoveCamera) -> None:
        for name, directions in self._solstices.items():
            points = project_directions(directions, camera, place.width() / place.height())
            up = directions[:, 1] >= 0.0
            colour = QColor(_SOLSTICE_COLOUR)
            painter.setPen(QPen(colour, 1.0, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawPath(_path(points, up, place))
            seen = [
                n for n in np.flatnonzero(up) if np.all((points[n] > 0.02) & (points[n] < 0.98))
            ]
            if seen:
                # Where the arc is highest in the picture.
                best = min(seen, key=lambda n: points[n][1])
                painter.drawText(_on(place, points[best]) + QPointF(6, -6), f"21 {name}")

    def _paint_hours(self, painter: QPainter, place: QRectF, camera: MoveCamera) -> None:
        day = self._day
        assert day is not None
        hours = [day.start + timedelta(hours=h) for h in range(round(day.length_s / 3600.0))]
        seconds = [(hour - day.start).total_seconds() for hour in hours]
        directions = np.stack(
            [np.interp(seconds, day.seconds, day.direction[:, axis]) for axis in range(3)], axis=-1
        )
        points = project_directions(directions, camera, place.width() / place.height())
        for hour, direction, point in zip(hours, directions, points, strict=True):
            if direction[1] < 0.0 or not _inside(point):
                continue
            spot = _on(place, point)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(theme.ACCENT))
            painter.drawEllipse(spot, 2.5, 2.5)
            painter.setPen(QColor(theme.ACCENT))
            painter.drawText(spot + QPointF(5, -5), f"{hour.astimezone(day.zone):%H}")

    def _paint_moon(
        self,
        painter: QPainter,
        place: QRectF,
        camera: MoveCamera,
        directions: NDArray[np.float64],
    ) -> None:
        points = project_directions(directions, camera, place.width() / place.height())
        painter.setPen(QPen(QColor(_MOON_COLOUR), 1.2, Qt.PenStyle.DashDotLine))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPath(_path(points, directions[:, 1] >= 0.0, place))
        seen = [n for n in np.flatnonzero(directions[:, 1] >= 0.0) if _inside(points[n])]
        if seen:
            painter.drawText(_on(place, points[seen[len(seen) // 2]]) + QPointF(6, -6), "moon")
        moon = None if self._moon is None else self._moon.moon
        if moon is not None and moon.place.visible_disc_fraction > 0.0:
            self._paint_body(painter, place, camera, moon.place, 7.0)

    def _paint_body(
        self, painter: QPainter, place: QRectF, camera: MoveCamera, body: SunMoved, radius_px: float
    ) -> None:
        """A ring where a body stands."""
        aspect = place.width() / place.height()
        (point,) = project_directions([body.direction], camera, aspect)
        if _inside(point):
            painter.setPen(QPen(QColor("#ffffff"), 1.5))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(_on(place, point), radius_px, radius_px)


def _path(points: np.ndarray, chosen: np.ndarray, place: QRectF) -> QPainterPath:
    """Lines between neighbours that are both chosen and near the picture."""
    path = QPainterPath()
    pen_down = False
    for point, wanted in zip(points, chosen, strict=True):
        if not (wanted and _inside(point)):
            pen_down = False
            continue
        spot = _on(place, point)
        if pen_down:
            path.lineTo(spot)
        else:
            path.moveTo(spot)
        pen_down = True
    return path


def _inside(point: np.ndarray) -> bool:
    """Whether a point is in the picture or just beside it; nan is not."""
    return bool(np.all((point > -_MARGIN) & (point < 1.0 + _MARGIN)))


def _on(place: QRectF, point: np.ndarray) -> QPointF:
    return QPointF(
        place.left() + float(point[0]) * place.width(),
        place.top() + float(point[1]) * place.height(),
    )
