"""The clouds of a year: a column for each day, a row for each hour; a click goes there."""

from datetime import UTC, datetime, timedelta

import numpy as np
from PySide6.QtCore import QEvent, QRectF, QSize, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from vrut_lite.app import theme
from vrut_lite.messages.weather import SetWeather
from vrut_lite.quantities import W_M2, percent_text

_MARGIN_PX, _HEIGHT_PX = 16, 26
# Clear and overcast, by day; nights are as much darker as the sun's light is less.
_CLEAR, _OVERCAST, _NIGHT = (64, 132, 214), (212, 214, 216), (18, 22, 36)


class YearStrip(QWidget):
    """`instant_chosen` emits the middle of the hour that was clicked, in the shown year."""

    instant_chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._weather: SetWeather | None = None
        self._image = QImage()
        self._instant: datetime | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName("clouds of the year")
        self.hide()

    def sizeHint(self) -> QSize:
        """As wide as the bar of the day, a pixel for each hour."""
        return QSize(600, _HEIGHT_PX)

    def show_weather(self, weather: SetWeather) -> None:
        """Show this year; without cloud cover in the file nothing is shown."""
        self._weather = weather
        self.setVisible(bool(weather.cloud_cover))
        if weather.cloud_cover:
            pixels = cloud_pixels(weather)
            height, width, _ = pixels.shape
            kind = QImage.Format.Format_RGB888
            # A copy, which owns its bytes.
            self._image = QImage(pixels.tobytes(), width, height, 3 * width, kind).copy()
        self.update()

    def show_instant(self, instant: datetime) -> None:
        """Mark the day of an instant."""
        self._instant = instant
        self.update()

    @property
    def _way_px(self) -> float:
        return max(1.0, self.width() - 2.0 * _MARGIN_PX)

    def instant_at(self, x: float, y: float) -> datetime:
        """The middle of the hour at a point."""
        assert self._weather is not None
        days = len(self._weather.cloud_cover) // 24
        day = int(np.clip((x - _MARGIN_PX) / self._way_px * days, 0, days - 1))
        hour = int(np.clip(y / self.height() * 24, 0, 23))
        year = (self._instant or datetime.now(UTC)).year
        local = datetime(year, 1, 1, tzinfo=UTC) + timedelta(days=day, hours=hour + 0.5)
        return local - timedelta(hours=self._weather.utc_offset_h)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Go to the hour."""
        if self._weather is not None:
            self.instant_chosen.emit(self.instant_at(event.position().x(), event.position().y()))

    def event(self, event: QEvent) -> bool:
        """Show the hour under the pointer, and the file's faults."""
        if event.type() == QEvent.Type.ToolTip and self._weather is not None:
            at = event.pos()  # type: ignore[attr-defined]
            when = self.instant_at(at.x(), at.y())
            hour = self._weather.hour_at(when)
            local = when + timedelta(hours=self._weather.utc_offset_h, minutes=30)
            text = (
                f"{self._weather.name}, {local:%d %B}, hour {local.hour or 24}: "
                f"{percent_text(hour.cloud_cover or 0.0)} cloud, "
                f"{hour.direct_normal_w_m2:,.0f} + {hour.diffuse_horizontal_w_m2:,.0f} {W_M2}"
            )
            text = "\n".join((text, *self._weather.lacks))
            QToolTip.showText(event.globalPos(), text, self)  # type: ignore[attr-defined]
            return True
        return super().event(event)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the year, and a line through the shown day."""
        if self._weather is None or self._image.isNull():
            return
        painter = QPainter(self)
        painter.drawImage(QRectF(_MARGIN_PX, 1, self._way_px, self.height() - 2), self._image)
        if self._instant is not None:
            share = self._weather.row_at(self._instant) / len(self._weather.cloud_cover)
            x = _MARGIN_PX + share * self._way_px
            painter.setPen(QPen(QColor(theme.ACCENT), 2))
            painter.drawLine(int(x), 0, int(x), self.height())


def cloud_pixels(weather: SetWeather) -> np.ndarray:
    """Colours (24, days, 3) uint8 of the hours of a year, the first hour of a day on top."""
    cover = np.array(weather.cloud_cover).reshape(-1, 24).T[..., None]
    light = np.array(weather.diffuse_horizontal_w_m2) + np.array(weather.direct_normal_w_m2)
    day = np.clip(light.reshape(-1, 24).T[..., None] / 60.0, 0.0, 1.0)
    shown = np.array(_CLEAR) * (1.0 - cover) + np.array(_OVERCAST) * cover
    return np.ascontiguousarray(np.array(_NIGHT) * (1.0 - day) + shown * day, dtype=np.uint8)
