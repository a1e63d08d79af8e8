"""The panel of the moon: its phase and place, when it rises and sets, and jumps to its events.

The window imports it by the entry point `vrut_lite.panels`; nothing else here imports Qt.
"""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from math import degrees

from PySide6.QtWidgets import QLabel, QPushButton, QWidget

from night_sky.events import next_full_moon, next_rise_and_set, next_solar_eclipse
from night_sky.sky_axes import Watch, watch
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.kernel.messages import ClockMoved, SetClock
from vrut_lite.messages.night import NightLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.panel_kit import Session, aligned_form
from vrut_lite.place_time import Place, local_text
from vrut_lite.quantities import COMPUTING, degrees_text, lux_text
from vrut_lite.sky.moon_phase import phase_text

_NONE_SOON = "not within two days"
_BELOW = "below the horizon"
_NEVER = datetime(1, 1, 1, tzinfo=UTC)
# How long there being no event is taken to last.
_HOLDS = timedelta(hours=1)


class MoonPanel(QWidget):
    """Looks rise and set up when it is seen and one of them has passed, or the place changed."""

    title = "Moon"

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self._looked_up: tuple[SetPlace | None, datetime, datetime] = None, _NEVER, _NEVER
        self.phase, self.place, self.light = (QLabel(COMPUTING) for _ in range(3))
        self.rise, self.set = QLabel(COMPUTING), QLabel(COMPUTING)
        self.full = QPushButton("Next full moon")
        self.eclipse = QPushButton("Next solar eclipse here")
        form = aligned_form(self)
        form.setContentsMargins(10, 10, 10, 10)
        for name, field in (
            ("Phase", self.phase),
            ("Place", self.place),
            ("Above the air", self.light),
            ("Next rise", self.rise),
            ("Next set", self.set),
        ):
            form.addRow(name, field)
        form.addRow(self.full)
        form.addRow(self.eclipse)
        self.full.clicked.connect(lambda _: self._jump(next_full_moon))
        self.eclipse.clicked.connect(lambda _: self._jump(lambda at: next_solar_eclipse(at).at))
        session.listen(NightLightChanged, self._show)

    def _show(self, message: NightLightChanged) -> None:
        moon = message.moon
        if moon is None:
            self.phase.setText("not seen")
            self.place.setText(_BELOW)
            self.light.setText("none")
        else:
            self.phase.setText(phase_text(moon.lit_fraction, moon.waxes))
            height, azimuth = degrees(moon.place.apparent_elevation_rad), moon.place.azimuth_rad
            self.place.setText(
                f"{degrees_text(height)} high, azimuth {degrees_text(degrees(azimuth))}"
            )
            lux = float(luminance(moon.irradiance_rgb)) * LUMENS_PER_WATT
            self.light.setText(f"{lux_text(lux)}, facing it")
        self._look_up()

    def _look_up(self) -> None:
        clock, place = self._session.last(ClockMoved), self._session.last(SetPlace)
        if clock is None or place is None or not self.isVisible():
            return
        of, since, until = self._looked_up
        # Rise and set stay valid from the instant of the look-up to the first of them.
        if of == place and since <= clock.instant < until:
            return
        found = next_rise_and_set(_watch(clock.instant, place))
        first = min(filter(None, found), default=clock.instant + _HOLDS)
        self._looked_up = place, clock.instant, first
        for label, instant in zip((self.rise, self.set), found, strict=True):
            where = Place(place.latitude_deg, place.longitude_deg)
            label.setText(_NONE_SOON if instant is None else local_text(instant, where))

    def _jump(self, event: Callable[[Watch], datetime]) -> None:
        clock, place = self._session.last(ClockMoved), self._session.last(SetPlace)
        if clock is not None and place is not None:
            self._session.send(SetClock(instant=event(_watch(clock.instant, place))))


def _watch(instant: datetime, place: SetPlace) -> Watch:
    return watch(instant, place.latitude_deg, place.longitude_deg, place.altitude_m)
