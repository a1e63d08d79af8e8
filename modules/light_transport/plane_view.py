"""One work plane from above: false colours with iso-lines, and the sensor under the pointer."""

import numpy as np
from PySide6.QtCore import QEvent, Signal
from PySide6.QtGui import QMouseEvent

from light_transport.daylight_numbers.plan_picture import drawn_grid, grid_of_plane
from light_transport.daylight_numbers.sensors import Sensors
from vrut_lite.geometry.false_colours import Scale, scale_of
from vrut_lite.numeric_types import FloatArray
from vrut_lite.panel_kit import FittedPicture

_HINT_PX = (280, 240)


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
