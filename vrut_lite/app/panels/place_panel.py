"""The place: by a city's name, by coordinates, by a click on the map."""

import math

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QWidget,
)

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.sun_day_finder import place_of
from vrut_lite.app.panels.cities import City, all_cities, find_cities
from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.app.panels.world_map import WorldMap
from vrut_lite.app.widgets import aligned_form, faint_label, heading, panel_column
from vrut_lite.errors import UserError
from vrut_lite.geometry.frames import enu_from_world
from vrut_lite.kernel.messages import ClockMoved, Input, SetClock
from vrut_lite.messages.place import HIGHEST_M, LOWEST_M, SetPlace
from vrut_lite.messages.sun import SunMoved
from vrut_lite.place_time import parse_place, same_hour_elsewhere, time_zone_at
from vrut_lite.quantities import DEGREE, degrees_text

# Nearer than this a place is named after a city.
_NEAR_KM = 25.0
_KM_PER_DEGREE = 111.2


class PlacePanel(QWidget):
    """Edits `SetPlace`: the point, and the scene's north offset.

    The clock shows the same hour at a new place: 18:40 stays 18:40. `found_place` is emitted when
    a typed place, or one of the list, is gone to.
    """

    found_place = Signal()

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._place: SetPlace | None = None
        self.search = QLineEdit()
        self.search.setPlaceholderText("City, or latitude, longitude, altitude")
        self.search.setClearButtonEnabled(True)
        self.search.setAccessibleName("place")
        self.found = QListWidget()
        self.found.setVisible(False)
        self.found.setMaximumHeight(130)
        self.map = WorldMap()
        self.name, self.zone = heading(), faint_label(wraps=True)
        self.latitude_deg = NumberField(-90.0, 90.0, DEGREE, decimals=4)
        self.longitude_deg = NumberField(-180.0, 180.0, DEGREE, decimals=4)
        self.altitude_m = NumberField(LOWEST_M, HIGHEST_M, "m", decimals=0)
        self.altitude_m.slider.hide()
        self.north_deg = NumberField(-180.0, 180.0, DEGREE, decimals=1)
        self._lay_out()
        self._connect()
        session.listen(SetPlace, self._show)
        session.listen(SunMoved, self._show_sun)

    def go_to_city(self, city: City) -> None:
        """Move to a city."""
        self._send(city.latitude_deg, city.longitude_deg, city.altitude_m)

    def _lay_out(self) -> None:
        column = panel_column(self)
        for part in (self.search, self.found, self.map, self.name, self.zone):
            column.addWidget(part)
        form = aligned_form()
        for title, field, tip in (
            ("Latitude", self.latitude_deg, "North is positive"),
            ("Longitude", self.longitude_deg, "East is positive"),
            ("Altitude", self.altitude_m, "Of the ground above the sea"),
            ("North offset", self.north_deg, "How far the scene's -Z axis points clockwise of "
             "true north"),
        ):  # fmt: skip
            field.setToolTip(tip)
            form.addRow(title, field)
        column.addLayout(form)
        column.addStretch(1)

    def _connect(self) -> None:
        self.search.textEdited.connect(self._suggest)
        self.search.returnPressed.connect(self._enter)
        self.found.itemClicked.connect(self._pick)
        self.found.itemActivated.connect(self._pick)
        self.map.place_chosen.connect(
            lambda latitude, longitude: self._send(latitude, longitude, 0.0)
        )
        for field in (self.latitude_deg, self.longitude_deg, self.altitude_m, self.north_deg):
            field.edited.connect(lambda _: self._send_fields())

    # --- user input --------------------------------------------------------------------------

    def _suggest(self, text: str) -> None:
        self.found.clear()
        for city in find_cities(text):
            item = QListWidgetItem(city.title)
            item.setData(Qt.ItemDataRole.UserRole, city)
            self.found.addItem(item)
        self.found.setVisible(self.found.count() > 0)

    def _enter(self) -> None:
        """Go to the first matching city, or to coordinates."""
        text = self.search.text().strip()
        cities = find_cities(text)
        if cities:
            self._choose(cities[0])
            return
        try:
            place = parse_place(text)
        except UserError as error:
            is_name = not any(letter.isdigit() for letter in text)
            self._session.problem.emit(
                f"'{text}' is not among the {len(all_cities())} cities known here: write latitude, "
                "longitude as 50.0755, 14.4378" if is_name else str(error)
            )  # fmt: skip
            return
        self._send(place.latitude_deg, place.longitude_deg, place.altitude_m)
        self.found_place.emit()

    def _pick(self, item: QListWidgetItem) -> None:
        self._choose(item.data(Qt.ItemDataRole.UserRole))

    def _choose(self, city: City) -> None:
        self.search.setText(city.title)
        self.found.hide()
        self.go_to_city(City(*city))
        self.found_place.emit()

    def _send_fields(self) -> None:
        self._send(self.latitude_deg.value, self.longitude_deg.value, self.altitude_m.value)

    def _send(self, latitude_deg: float, longitude_deg: float, altitude_m: float) -> None:
        place = SetPlace(
            latitude_deg=latitude_deg,
            longitude_deg=longitude_deg,
            altitude_m=altitude_m,
            north_offset_rad=math.radians(self.north_deg.value),
        )
        self._session.send(place, *self._same_hour(place))

    def _same_hour(self, place: SetPlace) -> list[Input]:
        """The clock's new instant where another zone's clocks would show another hour."""
        clock = self._session.last(ClockMoved)
        if clock is None or self._place is None:
            return []
        instant = same_hour_elsewhere(clock.instant, place_of(self._place), place_of(place))
        return [] if instant == clock.instant else [SetClock(instant=instant)]

    # --- messages ----------------------------------------------------------------------------

    def _show(self, place: SetPlace) -> None:
        self._place = place
        self.latitude_deg.show_value(place.latitude_deg)
        self.longitude_deg.show_value(place.longitude_deg)
        self.altitude_m.show_value(place.altitude_m)
        self.north_deg.show_value(math.degrees(place.north_offset_rad))
        self.map.show_place(place.latitude_deg, place.longitude_deg)
        self.name.setText(name_of(place))
        self.zone.setText(f"Time zone {time_zone_at(place_of(place)).key}")

    def _show_sun(self, sun: SunMoved) -> None:
        """Shade the night side of the map."""
        if self._place is not None:
            self.map.show_sun(*point_below(sun, self._place))


def name_of(place: SetPlace) -> str:
    """The nearest city, or the coordinates."""
    cities = all_cities()
    latitude = np.array([city.latitude_deg for city in cities])
    longitude = np.array([city.longitude_deg for city in cities])
    east = (longitude - place.longitude_deg + 180.0) % 360.0 - 180.0
    away_km = _KM_PER_DEGREE * np.hypot(
        latitude - place.latitude_deg, east * math.cos(math.radians(place.latitude_deg))
    )
    nearest = int(np.argmin(away_km))
    if away_km[nearest] <= _NEAR_KM:
        return cities[nearest].title
    north, east_letter = "NS"[place.latitude_deg < 0], "EW"[place.longitude_deg < 0]
    return (
        f"{degrees_text(abs(place.latitude_deg), 2)} {north}, "
        f"{degrees_text(abs(place.longitude_deg), 2)} {east_letter}"
    )


def point_below(sun: SunMoved, place: SetPlace) -> tuple[float, float]:
    """Latitude and longitude in degrees of the point below the sun."""
    east, north, up = enu_from_world(sun.direction, place.north_offset_rad)
    latitude, longitude = math.radians(place.latitude_deg), math.radians(place.longitude_deg)
    # From east, north, up at the place to the Earth's own axes.
    along = up * math.cos(latitude) - north * math.sin(latitude)
    x = along * math.cos(longitude) - east * math.sin(longitude)
    y = along * math.sin(longitude) + east * math.cos(longitude)
    z = up * math.sin(latitude) + north * math.cos(latitude)
    return math.degrees(math.asin(min(max(z, -1.0), 1.0))), math.degrees(math.atan2(y, x))
