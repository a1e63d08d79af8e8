"""The sun's elevation and azimuth, shown and editable; the moon's place, phase and light."""

from datetime import datetime, tzinfo
from math import degrees

from PySide6.QtWidgets import QDoubleSpinBox, QLabel, QWidget

from vrut_lite.app.engine.moon_day import MoonDay
from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.sun_day_finder import SunDayFinder
from vrut_lite.app.widgets import aligned_form
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.messages import ClockMoved, SetClock
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.sky_light import SkyLightChanged
from vrut_lite.messages.sun import SunMoved
from vrut_lite.quantities import COMPUTING, DEGREE, degrees_text, lux_text
from vrut_lite.sky.moon_phase import phase_text

_TWILIGHTS = ((-6.0, "civil twilight"), (-12.0, "nautical twilight"),
              (-18.0, "astronomical twilight"))  # fmt: skip
_NO_SUN = "none, it is below the horizon"
_ECLIPSED = "none, the moon hides it"
_NO_MOON = "below the horizon"


class SunPanel(QWidget):
    """A typed angle sets the clock to the hour at which the sun has it."""

    def __init__(self, session: Session, scout: SunDayFinder):
        super().__init__()
        self._session, self._scout = session, scout
        self.elevation = _angle(-90.0, 90.0, "Type an elevation: the nearest hour that has it")
        self.azimuth = _angle(
            0.0, 360.0, "From north, clockwise; type an azimuth: the nearest hour that has it"
        )
        self.phase, self.sunlight, self.skylight = (QLabel(COMPUTING) for _ in range(3))
        self.moon, self.moon_hours = QLabel(COMPUTING), QLabel(COMPUTING)
        for label in (self.sunlight, self.skylight, self.moon, self.moon_hours):
            label.setWordWrap(True)
        form = aligned_form(self)
        form.setContentsMargins(10, 10, 10, 10)
        form.addRow("Elevation", self.elevation)
        form.addRow("Azimuth", self.azimuth)
        form.addRow("Phase", self.phase)
        form.addRow("Sun, facing it", self.sunlight)
        form.addRow("Sky, level ground", self.skylight)
        form.addRow("Moon", self.moon)
        form.addRow("Moon is up", self.moon_hours)
        self.elevation.valueChanged.connect(lambda _: self._go_to_elevation())
        self.azimuth.valueChanged.connect(lambda _: self._go_to_azimuth())
        session.listen(SunMoved, self._show_sun)
        session.listen(SkyLightChanged, self._show_light)
        session.listen(NightLightChanged, self._show_moon)
        scout.moon_changed.connect(self._show_moon_hours)

    def _go_to_elevation(self) -> None:
        day, now = self._scout.day, self._now()
        if day is None or now is None:
            return
        wanted = self.elevation.value()
        lowest, highest = day.elevation_deg.min(), day.elevation_deg.max()
        self._go_to(
            day.when_elevation(wanted, now),
            f"the sun never stands at {degrees_text(wanted, 2)} on this day: it goes from "
            f"{degrees_text(lowest, 2)} to {degrees_text(highest, 2)}",
        )

    def _go_to_azimuth(self) -> None:
        day, now = self._scout.day, self._now()
        if day is None or now is None:
            return
        wanted = self.azimuth.value()
        self._go_to(
            day.when_azimuth(wanted, now),
            f"the sun never stands at azimuth {degrees_text(wanted, 2)} on this day",
        )

    def _go_to(self, instant: datetime | None, refusal: str) -> None:
        if instant is not None:
            self._session.send(SetClock(instant=instant))
            return
        self._session.problem.emit(refusal)
        sun = self._session.last(SunMoved)
        if sun is not None:
            self._show_sun(sun)

    def _now(self) -> datetime | None:
        clock = self._session.last(ClockMoved)
        return None if clock is None else clock.instant

    def _show_sun(self, sun: SunMoved) -> None:
        elevation_deg = degrees(sun.elevation_rad)
        _show(self.elevation, elevation_deg)
        _show(self.azimuth, degrees(sun.azimuth_rad) % 360.0)
        self.phase.setText(phase_of(sun))

    def _show_light(self, light: SkyLightChanged) -> None:
        lux = float(luminance(light.key_light.irradiance_rgb)) * LUMENS_PER_WATT
        moon = "moon, " if light.key_light.body == "moon" else ""
        sun = self._session.last(SunMoved)
        hidden = _ECLIPSED if sun is not None and sun.visible_disc_fraction > 0.0 else _NO_SUN
        self.sunlight.setText(moon + lux_text(lux) if lux > 0.0 else hidden)
        up = evaluate_irradiance(light.ambient.irradiance_sh_rgb.values, [0.0, 1.0, 0.0])
        self.skylight.setText(lux_text(float(luminance(up)) * LUMENS_PER_WATT))

    def _show_moon(self, night: NightLightChanged) -> None:
        moon = night.moon
        if moon is None:
            self.moon.setText(_NO_MOON)
            return
        height_deg = degrees(moon.place.apparent_elevation_rad)
        self.moon.setText(
            f"{phase_text(moon.lit_fraction, moon.waxes)}; {degrees_text(height_deg)} high, "
            f"azimuth {degrees_text(degrees(moon.place.azimuth_rad))}"
        )

    def _show_moon_hours(self, moon: MoonDay | None) -> None:
        day = self._scout.day
        if moon is not None and day is not None:
            self.moon_hours.setText(up_text(moon, day.zone))
        elif not self._session.catalogue.holders.get("night"):
            self.moon_hours.setText("no module makes the night")


def up_text(moon: MoonDay, zone: tzinfo) -> str:
    """When the moon rises and sets on a day, in the order of the day."""
    if not moon.marks:
        return "all day" if moon.up else "not today"
    words = {"moonrise": "from", "moonset": "until"}
    marks = sorted(moon.marks.items(), key=lambda mark: mark[1])
    return ", ".join(f"{words[name]} {when.astimezone(zone):%H:%M}" for name, when in marks)


def phase_of(sun: SunMoved) -> str:
    """Day while the disc is seen, then a twilight or night by the sun's geometric elevation."""
    if sun.visible_disc_fraction > 0.0:
        return "day"
    elevation_deg = degrees(sun.elevation_rad)
    return next((name for lowest, name in _TWILIGHTS if elevation_deg >= lowest), "night")


def _angle(low: float, high: float, tip: str) -> QDoubleSpinBox:
    spin = QDoubleSpinBox()
    spin.setRange(low, high)
    spin.setDecimals(2)
    spin.setSuffix(DEGREE)
    spin.setKeyboardTracking(False)
    spin.setToolTip(tip)
    # Shown in place of the lowest value, until the first one comes.
    spin.setSpecialValueText(COMPUTING)
    spin.setValue(low)
    return spin


def _show(spin: QDoubleSpinBox, value: float) -> None:
    # A text that is being typed stays.
    if spin.hasFocus() and spin.lineEdit().isModified():
        return
    spin.blockSignals(True)
    spin.setSpecialValueText("")
    spin.setValue(value)
    spin.blockSignals(False)
