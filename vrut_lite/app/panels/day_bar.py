"""The day as a bar: coloured by its light, with events to click and a cursor to drag."""

from collections.abc import Callable
from datetime import datetime, timedelta

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QKeyEvent,
    QLinearGradient,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPixmap,
    QPolygonF,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from vrut_lite.app import theme
from vrut_lite.app.engine.day import Day
from vrut_lite.app.engine.moon_day import MoonDay
from vrut_lite.quantities import degrees_text

# The colour of daylight by the sun's elevation in degrees, from night to a high sun.
_LIGHT = (
    (-18.0, "#0b0d18"), (-12.0, "#141a33"), (-6.0, "#2f3a66"), (-3.0, "#70587c"),
    (-0.8, "#c87a52"), (2.5, "#e6ac6a"), (8.0, "#d8cfae"), (18.0, "#a5c4dc"),
    (40.0, "#7fb2e4"), (65.0, "#92c4f2"),
)  # fmt: skip
_MARGIN_PX, _TOP_PX, _BAND_PX, _FOOT_PX = 16, 26, 26, 20
_REACH_PX = 7.0
_LABELLED = ("sunrise", "noon", "sunset")
# The moon is up along a line at the band's foot.
_MOON, _MOON_PX = QColor("#dfe4f0"), 3
_STEP, _WIDE_STEP = timedelta(minutes=5), timedelta(hours=1)


class DayBar(QWidget):
    """`instant_chosen` emits the instant that was clicked, dragged or stepped to."""

    instant_chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._day: Day | None = None
        self._moon: MoonDay | None = None
        # All but the cursor as painted last, with its size and font; None if it must be repainted.
        self._behind = QPixmap()
        self._looks: tuple[object, ...] | None = None
        self._stops: list[tuple[float, QColor]] = []
        self._instant: datetime | None = None
        self._dragging = False
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName("time of day")
        self.setCursor(Qt.CursorShape.PointingHandCursor)

    def sizeHint(self) -> QSize:
        """Marks above, the band, hours below."""
        return QSize(600, _TOP_PX + _BAND_PX + _FOOT_PX)

    def minimumSizeHint(self) -> QSize:
        """Wide enough for the hours' labels."""
        return QSize(320, self.sizeHint().height())

    def show_day(self, day: Day) -> None:
        """Draw this day."""
        self._day, self._looks = day, None
        shares = day.seconds / day.length_s
        # A gradient stop each ten minutes.
        self._stops = [
            (min(1.0, float(share)), light_colour(float(elevation_deg)))
            for share, elevation_deg in zip(shares[::2], day.elevation_deg[::2], strict=True)
        ]
        self.update()

    def show_moon(self, moon: MoonDay | None) -> None:
        """Mark when the moon rises and sets, and underline while it is up."""
        self._moon, self._looks = moon, None
        self.update()

    @property
    def _marks(self) -> dict[str, datetime]:
        """The events of sun and moon."""
        assert self._day is not None
        return self._day.marks | ({} if self._moon is None else self._moon.marks)

    def show_instant(self, instant: datetime) -> None:
        """Move the cursor to an instant."""
        self._instant = instant
        self.update()

    @property
    def is_dragging(self) -> bool:
        """Whether the cursor is being dragged."""
        return self._dragging

    def place_of(self, instant: datetime) -> QPointF:
        """The point of an instant on the band's middle line."""
        assert self._day is not None
        x = _MARGIN_PX + self._day.share_of(instant) * self._way_px
        return QPointF(x, _TOP_PX + 0.5 * _BAND_PX)

    def mark_place(self, name: str) -> QPointF:
        """The point to click for an event."""
        assert self._day is not None
        return QPointF(self.place_of(self._marks[name]).x(), _TOP_PX - 5.0)

    @property
    def _way_px(self) -> float:
        return max(1.0, self.width() - 2.0 * _MARGIN_PX)

    # --- user input --------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Go to an event, or begin to drag."""
        if self._day is None or event.button() != Qt.MouseButton.LeftButton:
            return
        mark = self._mark_at(event.position())
        if mark is not None:
            self.instant_chosen.emit(self._marks[mark])
            return
        self._dragging = True
        self._drag_to(event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the cursor."""
        if self._dragging:
            self._drag_to(event.position())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End the drag."""
        self._dragging = False

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Five minutes a notch."""
        self._go(_STEP * (event.angleDelta().y() / 120.0))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows go five minutes, with Ctrl an hour; Home and End to sunrise and sunset."""
        step = _WIDE_STEP if event.modifiers() & Qt.KeyboardModifier.ControlModifier else _STEP
        ways = {Qt.Key.Key_Left: -step, Qt.Key.Key_Right: step}
        marks = {Qt.Key.Key_Home: "sunrise", Qt.Key.Key_End: "sunset"}
        key = Qt.Key(event.key())
        if key in ways:
            self._go(ways[key])
        elif key in marks and self._day is not None and marks[key] in self._day.marks:
            self.instant_chosen.emit(self._day.marks[marks[key]])
        else:
            super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        """Show the tooltip of the point under the pointer."""
        if event.type() == QEvent.Type.ToolTip and self._day is not None:
            position = QPointF(event.pos())  # type: ignore[attr-defined]
            QToolTip.showText(event.globalPos(), self._tip(position), self)  # type: ignore[attr-defined]
            return True
        return super().event(event)

    def _tip(self, position: QPointF) -> str:
        assert self._day is not None
        mark = self._mark_at(position)
        if mark is not None:
            when = self._marks[mark].astimezone(self._day.zone)
            return f"{mark} {when:%H:%M:%S}"
        instant = self._instant_at(position)
        local = instant.astimezone(self._day.zone)
        return f"{local:%H:%M}, sun {degrees_text(self._day.elevation_at(instant))}"

    def _instant_at(self, position: QPointF) -> datetime:
        assert self._day is not None
        return self._day.instant_at((position.x() - _MARGIN_PX) / self._way_px)

    def _drag_to(self, position: QPointF) -> None:
        self._instant = self._instant_at(position)
        self.instant_chosen.emit(self._instant)
        self.update()

    def _go(self, way: timedelta) -> None:
        if self._instant is not None:
            self.instant_chosen.emit(self._instant + way)

    def _mark_at(self, position: QPointF) -> str | None:
        """The mark within reach, above the band."""
        if self._day is None or position.y() >= _TOP_PX:
            return None
        near = {
            name: abs(self.place_of(when).x() - position.x()) for name, when in self._marks.items()
        }
        name = min(near, key=lambda mark: near[mark], default=None)
        # The labels beside the marks can be clicked too.
        reach_px = 34.0 if name in _LABELLED and position.y() < _TOP_PX - 8 else _REACH_PX
        return name if name is not None and near[name] <= reach_px else None

    # --- painting ----------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint band, hours and events, kept from last time, and the cursor."""
        band = QRectF(_MARGIN_PX, _TOP_PX, self._way_px, _BAND_PX)
        ratio = self.devicePixelRatioF()
        looks = self.size(), ratio, self.font()
        if self._looks != looks:
            self._looks, self._behind = looks, QPixmap(self.size() * ratio)
            self._behind.setDevicePixelRatio(ratio)
            self._behind.fill(Qt.GlobalColor.transparent)
            self._paint_behind(self._behind, band)
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._behind)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._day is not None and self._instant is not None:
            self._paint_hand(painter, band, self._instant)

    def _paint_behind(self, pixmap: QPixmap, band: QRectF) -> None:
        """All that stays while time plays."""
        painter = QPainter(pixmap)
        painter.setFont(self.font())
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._day is None:
            painter.fillRect(band, QColor(theme.BACKGROUND))
            return
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(self._gradient(band))
        painter.drawRoundedRect(band, 4, 4)
        self._paint_hours(painter, band)
        self._paint_marks(painter)
        if self._moon is not None:
            self._paint_moon(painter, band, self._moon)

    def _gradient(self, band: QRectF) -> QLinearGradient:
        gradient = QLinearGradient(band.topLeft(), band.topRight())
        gradient.setStops(self._stops)
        return gradient

    def _paint_hours(self, painter: QPainter, band: QRectF) -> None:
        assert self._day is not None
        sparse = 3 if band.width() < 560 else 2 if band.width() < 900 else 1
        for instant in _whole_hours(self._day):
            local = instant.astimezone(self._day.zone)
            x = self.place_of(instant).x()
            labelled = local.hour % sparse == 0
            painter.setPen(QPen(QColor(theme.FAINT if labelled else theme.LINE), 1))
            painter.drawLine(QPointF(x, band.bottom() + 1), QPointF(x, band.bottom() + 4))
            if labelled:
                place = QRectF(x - 20, band.bottom() + 4, 40, _FOOT_PX - 4)
                painter.drawText(place, Qt.AlignmentFlag.AlignCenter, f"{local:%H}")

    def _paint_marks(self, painter: QPainter) -> None:
        assert self._day is not None
        for name, when in self._day.marks.items():
            x = self.place_of(when).x()
            labelled = name in _LABELLED
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(theme.ACCENT if labelled else theme.FAINT))
            half, height = (4.5, 7.0) if labelled else (3.0, 5.0)
            tip = QPointF(x, _TOP_PX - 1)
            painter.drawPolygon(
                QPolygonF([tip, tip + QPointF(-half, -height), tip + QPointF(half, -height)])
            )
            if labelled:
                painter.setPen(QColor(theme.TEXT))
                local = when.astimezone(self._day.zone)
                place = QRectF(x - 60, 0, 120, _TOP_PX - 9)
                painter.drawText(place, Qt.AlignmentFlag.AlignCenter, f"{name} {local:%H:%M}")

    def _paint_moon(self, painter: QPainter, band: QRectF, moon: MoonDay) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(_MOON)
        for since, until in moon.up:
            left, right = (band.left() + share * band.width() for share in (since, until))
            painter.drawRect(QRectF(left, band.bottom() - _MOON_PX, right - left, _MOON_PX))
        for when in moon.marks.values():
            painter.drawEllipse(QPointF(self.place_of(when).x(), _TOP_PX - 4.5), 2.8, 2.8)

    def _paint_hand(self, painter: QPainter, band: QRectF, instant: datetime) -> None:
        x = self.place_of(instant).x()
        if not band.left() - 1 <= x <= band.right() + 1:
            return
        colour = QColor(theme.ACCENT if self.hasFocus() or self._dragging else "#ffffff")
        painter.setPen(QPen(QColor(0, 0, 0, 150), 4))
        painter.drawLine(QPointF(x, band.top() - 1), QPointF(x, band.bottom() + 1))
        painter.setPen(QPen(colour, 2))
        painter.drawLine(QPointF(x, band.top() - 2), QPointF(x, band.bottom() + 2))
        painter.setPen(QPen(QColor(theme.BACKGROUND), 1))
        painter.setBrush(colour)
        painter.drawEllipse(QPointF(x, band.center().y()), 6, 6)


def light_colour(elevation_deg: float) -> QColor:
    """The bar's colour for a solar elevation."""
    heights = [height for height, _ in _LIGHT]
    colours = [QColor(colour) for _, colour in _LIGHT]

    def mixed(channel: Callable[[QColor], float]) -> float:
        return float(np.interp(elevation_deg, heights, [channel(colour) for colour in colours]))

    return QColor.fromRgbF(mixed(QColor.redF), mixed(QColor.greenF), mixed(QColor.blueF))


def _whole_hours(day: Day) -> list[datetime]:
    """Instants of whole hours on the clock, both midnights included."""
    hours = round(day.length_s / 3600.0)
    return [day.start + timedelta(hours=hour) for hour in range(hours + 1)]
