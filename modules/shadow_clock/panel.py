"""The panel of a shadow: clicks in the scene or in an aerial picture, and the times that fit.

The window imports it by the entry point `vrut_lite.panels`.
"""

from datetime import datetime
from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QDoubleSpinBox,
    QFileDialog,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QWidget,
)

from shadow_clock.clickable_picture import ClickablePicture
from shadow_clock.clicks import ClickedShadow, shadow_in_picture, shadow_in_scene
from shadow_clock.measured_shadow import (
    BEARING_ERROR_DEG,
    MOST_RATIO,
    RATIO_ERROR,
    MeasuredShadow,
)
from shadow_clock.photo_facts import PhotoFacts, read_photo
from shadow_clock.times import ShadowDays, ShadowTime
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import ClockMoved, Demand, SetClock
from vrut_lite.messages.picture import PictureClicked
from vrut_lite.messages.place import SetPlace
from vrut_lite.numeric_types import Vector
from vrut_lite.panel_kit import (
    Chooser,
    Session,
    aligned_form,
    faint_label,
    panel_column,
)
from vrut_lite.place_time import Place, parse_instant, time_zone_at
from vrut_lite.quantities import DEGREE, degrees_text

_CONSUMER = "time from a shadow"
_SCENE, _PICTURE = "scene", "picture"
_HINTS = {
    _SCENE: (
        "Click the foot of an upright object in the scene.",
        "Click the tip of its shadow.",
        "Click the object's top for its height, or begin again with the next foot.",
    ),
    _PICTURE: (
        "Open a picture that looks straight down, and click the foot of an upright object in it.",
        "Click the tip of its shadow.",
        "Click the foot of another shadow to begin again.",
    ),
}
_TIP, _TOP = 1, 2


class ShadowPanel(QWidget):
    """Bearing and ratio, clicked or typed, and the times of the window's day that fit them."""

    title = "Time from a shadow"

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._points_m: list[Vector] = []
        self._day: tuple[SetPlace, str, ShadowDays] | None = None
        self._photo: PhotoFacts | None = None
        self.source = Chooser()
        self.source.addItem("Clicks in the scene", _SCENE)
        self.source.addItem("Clicks in an aerial picture", _PICTURE)
        self.hint = faint_label(wraps=True)
        self.open = QPushButton("Open picture...")
        self.picture = ClickablePicture()
        self.photo_says = QPushButton()
        self.up_deg = _number(0.0, 0.0, 360.0, DEGREE, "bearing of the picture's upward direction")
        self.find_up = QPushButton("Up by the window's hour")
        self.find_up.setToolTip(
            "The bearing of the picture's upward direction, if it was taken at the window's hour"
        )
        self.height_m = _number(0.0, 0.0, 1e4, " m", "height of the object", 2)
        self.height_m.setSpecialValueText("not known")
        self.pixel_m = _number(1.0, 1e-4, 1e4, " m", "width of a pixel on the ground", 4)
        self.has_bearing, self.has_ratio = QCheckBox("Bearing"), QCheckBox("Length / height")
        self.bearing_deg = _number(0.0, 0.0, 360.0, DEGREE, "bearing of the shadow", 2)
        self.ratio = _number(1.0, 1e-3, MOST_RATIO, "", "length of the shadow over the height", 3)
        self.bearing_error_deg = _number(
            BEARING_ERROR_DEG, 0.0, 90.0, DEGREE, "error of the bearing"
        )
        self.ratio_error = _number(
            100.0 * RATIO_ERROR, 0.0, 90.0, " %", "error of the length over the height"
        )
        self.times = QListWidget()
        self.times.setAccessibleName("times that fit the shadow")
        self.reason = faint_label(wraps=True)
        self._lay_out()
        self._connect()
        self._source_changed()

    def _lay_out(self) -> None:
        column, form = panel_column(self), aligned_form()
        for part in (self.source, self.hint, self.open, self.picture, self.photo_says):
            column.addWidget(part)
        self._of_picture = aligned_form()
        self._of_picture.addRow("Up is", self.up_deg)
        self._of_picture.addRow(self.find_up)
        self._of_picture.addRow("Height", self.height_m)
        self._of_picture.addRow("A pixel is", self.pixel_m)
        column.addLayout(self._of_picture)
        form.addRow(self.has_bearing, self.bearing_deg)
        form.addRow("\N{PLUS-MINUS SIGN}", self.bearing_error_deg)
        form.addRow(self.has_ratio, self.ratio)
        form.addRow("\N{PLUS-MINUS SIGN}", self.ratio_error)
        column.addLayout(form)
        column.addWidget(self.times, 1)
        column.addWidget(self.reason)
        self.photo_says.hide()

    def _connect(self) -> None:
        self.source.activated.connect(lambda _: self._source_changed())
        self.open.clicked.connect(lambda _: self._choose_picture())
        self.find_up.clicked.connect(lambda _: self._orient_picture())
        self.photo_says.clicked.connect(lambda _: self._go_to_photo())
        self.picture.changed.connect(self._picture_clicked)
        for field in (self.up_deg, self.height_m, self.pixel_m):
            field.valueChanged.connect(lambda _: self._picture_clicked())
        for box in (self.has_bearing, self.has_ratio):
            box.toggled.connect(lambda _: self._compute())
        for number in (self.bearing_deg, self.ratio, self.bearing_error_deg, self.ratio_error):
            number.valueChanged.connect(lambda _: self._compute())
        self.times.itemClicked.connect(self._go_to)
        self.times.itemActivated.connect(self._go_to)
        self._session.listen(PictureClicked, self._scene_clicked)
        self._session.listen(SetPlace, lambda _: self._compute())
        self._session.listen(ClockMoved, lambda _: self._day_changed())

    def showEvent(self, event: QShowEvent) -> None:
        """Ask for clicks in the scene."""
        self._demand()
        self._compute()

    def hideEvent(self, event: QHideEvent) -> None:
        """Take the demand back."""
        if not self._session.has_ended:
            self._demand()

    def show_picture(self, path: Path) -> None:
        """Show a picture to click in; its place and time are offered."""
        try:
            self._photo = read_photo(path)
        except UserError as error:
            self._session.problem.emit(str(error))
            return
        self.picture.show_photo(self._photo)
        said = {"time": self._photo.taken.replace("T", " "), "place": ""}
        if self._photo.place is not None:
            said["place"] = ", ".join(f"{angle:.4f}" for angle in self._photo.place)
        known = {name: text for name, text in said.items() if text}
        self.photo_says.setText(f"Go to its {' and '.join(known)}")
        self.photo_says.setToolTip("\n".join(known.values()))
        self.photo_says.setVisible(bool(known))

    # --- user input --------------------------------------------------------------------------

    def _source_changed(self) -> None:
        in_picture = self.source.currentData() == _PICTURE
        self._points_m.clear()
        for part in (self.open, self.picture):
            part.setVisible(in_picture)
        for row in range(self._of_picture.rowCount()):
            self._of_picture.setRowVisible(row, in_picture)
        self.photo_says.setVisible(in_picture and bool(self.photo_says.toolTip()))
        self._demand()
        self._tell_next()

    def _demand(self) -> None:
        wanted = self.isVisible() and self.source.currentData() == _SCENE
        self._session.send(
            Demand(consumer=_CONSUMER, message=PictureClicked.__name__, size=None if wanted else 0)
        )

    def _choose_picture(self) -> None:
        name, _ = QFileDialog.getOpenFileName(
            self, "Open a picture", "", "Pictures (*.jpg *.jpeg *.png *.tif *.tiff *.webp)"
        )
        if name:
            self.show_picture(Path(name))

    def _go_to_photo(self) -> None:
        assert self._photo is not None
        here = self._session.last(SetPlace)
        inputs: list[SetPlace | SetClock] = []
        if self._photo.place is not None:
            latitude, longitude = self._photo.place
            here = SetPlace(
                latitude_deg=latitude,
                longitude_deg=longitude,
                north_offset_rad=0.0 if here is None else here.north_offset_rad,
            )
            inputs.append(here)
        if self._photo.taken and here is not None:
            try:
                inputs.append(SetClock(instant=parse_instant(self._photo.taken, _place(here))))
            except UserError as error:
                self._session.problem.emit(str(error))
        self._session.send(*inputs)

    def _go_to(self, item: QListWidgetItem) -> None:
        instant: datetime = item.data(Qt.ItemDataRole.UserRole)
        self._session.send(SetClock(instant=instant))

    # --- clicks ------------------------------------------------------------------------------

    def _scene_clicked(self, click: PictureClicked) -> None:
        if not self.isVisible() or self.source.currentData() != _SCENE:
            return
        if len(self._points_m) > _TOP:
            self._points_m.clear()
        self._points_m.append(click.position_m)
        if len(self._points_m) > _TIP:
            foot, tip, *top = self._points_m
            place = self._session.last(SetPlace)
            north = 0.0 if place is None else place.north_offset_rad
            try:
                self._take(shadow_in_scene(foot, tip, top[0] if top else None, north))
            except UserError as error:
                self._points_m.pop()
                self._session.problem.emit(str(error))
        self._tell_next()

    def _picture_clicked(self) -> None:
        points = self.picture.points
        if len(points) > _TIP:
            try:
                height_px = self.height_m.value() / self.pixel_m.value()
                foot, tip = points
                self._take(shadow_in_picture(foot, tip, self.up_deg.value(), height_px or None))
            except UserError as error:
                self.picture.forget_last()
                self._session.problem.emit(str(error))
        self._tell_next()

    def _orient_picture(self) -> None:
        """Turn the picture so that the clicked shadow is that of the window's hour."""
        days, clock = self._days(), self._session.last(ClockMoved)
        if days is None or clock is None or len(self.picture.points) <= _TIP:
            self._session.problem.emit("click foot and tip of a shadow in the picture first")
            return
        suns = days.suns(np.array([clock.instant.timestamp()]))
        if suns.apparent_elevation_rad[0] <= 0.0:
            self._session.problem.emit("the sun is below the horizon at this hour: set another")
            return
        foot, tip = self.picture.points
        unturned = shadow_in_picture(foot, tip, 0.0, None).bearing_deg
        shadow_deg = float(np.degrees(suns.azimuth_rad[0])) + 180.0
        self.up_deg.setValue((shadow_deg - unturned) % 360.0)

    def _take(self, shadow: ClickedShadow) -> None:
        for widget in (self.bearing_deg, self.ratio, self.has_bearing, self.has_ratio):
            widget.blockSignals(True)
        self.bearing_deg.setValue(shadow.bearing_deg)
        self.has_bearing.setChecked(True)
        self.has_ratio.setChecked(shadow.length_ratio is not None)
        if shadow.length_ratio is not None:
            self.ratio.setValue(shadow.length_ratio)
        for widget in (self.bearing_deg, self.ratio, self.has_bearing, self.has_ratio):
            widget.blockSignals(False)
        self._compute()

    def _tell_next(self) -> None:
        source = self.source.currentData()
        count = len(self._points_m if source == _SCENE else self.picture.points)
        self.hint.setText(_HINTS[source][count % (_TOP + 1)])

    # --- the times -----------------------------------------------------------------------------

    def _day_changed(self) -> None:
        """Compute another day; the hour alone changes nothing."""
        if self._day is None or self._present_day() != self._day[:2]:
            self._compute()

    def _present_day(self) -> tuple[SetPlace, str] | None:
        place, clock = self._session.last(SetPlace), self._session.last(ClockMoved)
        if place is None or clock is None:
            return None
        return place, clock.instant.astimezone(time_zone_at(_place(place))).date().isoformat()

    def _days(self) -> ShadowDays | None:
        """The sun of the window's day and place."""
        present = self._present_day()
        if present is None:
            return None
        if self._day is None or self._day[:2] != present:
            where = _place(present[0])
            date = datetime.fromisoformat(present[1]).date()
            self._day = *present, ShadowDays(date, date, where, time_zone_at(where))
        return self._day[2]

    def _compute(self) -> None:
        if not self.isVisible() or (days := self._days()) is None:
            return
        self.times.clear()
        bearing = self.bearing_deg.value() if self.has_bearing.isChecked() else None
        ratio = self.ratio.value() if self.has_ratio.isChecked() else None
        if bearing is None and ratio is None:
            self.reason.clear()
            return
        shadow = MeasuredShadow(
            bearing, ratio, self.bearing_error_deg.value(), 0.01 * self.ratio_error.value()
        )
        found = days.times(shadow)
        for one in found:
            item = QListWidgetItem(_said(one, days))
            item.setData(Qt.ItemDataRole.UserRole, one.instant)
            self.times.addItem(item)
        self.reason.setText("" if found else f"None on this day: {days.why_none(shadow)}.")


def _number(
    value: float, low: float, high: float, unit: str, name: str, decimals: int = 1
) -> QDoubleSpinBox:
    spin = QDoubleSpinBox()
    spin.setRange(low, high)
    spin.setDecimals(decimals)
    spin.setSuffix(unit)
    spin.setValue(value)
    spin.setKeyboardTracking(False)
    spin.setAccessibleName(name)
    return spin


def _said(one: ShadowTime, days: ShadowDays) -> str:
    at, early, late = (
        f"{instant.astimezone(days.time_zone):%H:%M:%S}"
        for instant in (one.instant, one.earliest, one.latest)
    )
    return f"{at}   ({early[:5]} to {late[:5]}), sun {degrees_text(one.elevation_deg)} high"


def _place(message: SetPlace) -> Place:
    return Place(message.latitude_deg, message.longitude_deg, message.altitude_m)
