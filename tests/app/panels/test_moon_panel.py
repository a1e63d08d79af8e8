"""The moon's panel, on a window's session."""

from datetime import UTC, datetime

import pytest
from night_sky.panel import MoonPanel

from vrut_lite.kernel.messages import ClockMoved, SetClock
from vrut_lite.messages.night import MoonLight, NightLightChanged
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved
from vrut_lite.sky.moon_phase import phase_text

NEW_YEAR = datetime(2026, 1, 1, 12, tzinfo=UTC)


class QuietSession:
    """Keeps what a panel sends, and tells it an hour and a place."""

    def __init__(self):
        self.sent, self.listener = [], None
        self.known = {
            ClockMoved: ClockMoved(instant=NEW_YEAR),
            SetPlace: SetPlace(latitude_deg=50.08, longitude_deg=14.44),
        }

    def listen(self, kind, listener):
        self.listener = listener

    def last(self, kind):
        return self.known.get(kind)

    def send(self, *inputs):
        self.sent += inputs


@pytest.fixture
def panel(qtbot):
    panel = MoonPanel(QuietSession())
    qtbot.addWidget(panel)
    panel.show()
    return panel


def test_phases_have_their_names():
    assert phase_text(0.01, True).startswith("new moon")
    assert phase_text(0.3, True) == "waxing crescent, 30 % lit"
    assert phase_text(0.5, False).startswith("last quarter")
    assert phase_text(0.8, False) == "waning gibbous, 80 % lit"
    assert phase_text(1.0, True).startswith("full moon")


def test_it_shows_the_moon_and_when_it_rises(panel):
    moon = MoonLight(
        place=SunMoved(
            direction=(0.0, 0.6, -0.8), azimuth_rad=0.0, elevation_rad=0.6435,
            apparent_elevation_rad=0.6435, visible_disc_fraction=1.0,
        ),
        irradiance_rgb=(5e-4, 4e-4, 3e-4), of_sunlight_rgb=(3e-6, 2e-6, 2e-6),
        angular_radius_rad=0.0045, lit_fraction=0.95, waxes=True,
    )  # fmt: skip
    panel._session.listener(
        NightLightChanged(instant=NEW_YEAR, moon=moon, glow_rgb=None, source="test")
    )
    assert panel.phase.text() == "waxing gibbous, 95 % lit"
    assert panel.place.text().startswith("36.9")
    assert "lx" in panel.light.text()
    # Prague, 1 January 2026: it rises at 14:07 or so, and sets next morning.
    assert panel.rise.text().startswith("2026-01-01")
    assert panel.set.text().startswith("2026-01-02")


def test_what_has_passed_is_not_the_next_one(panel):
    """Within the hour of a moonrise, and after the clock went back."""
    session = panel._session
    seen = []
    for hour, minute in ((12, 2), (12, 50), (12, 2)):
        at = datetime(2026, 1, 1, hour, minute, tzinfo=UTC)
        session.known[ClockMoved] = ClockMoved(instant=at)
        session.listener(NightLightChanged(instant=at, moon=None, glow_rgb=None, source="test"))
        seen.append(panel.rise.text()[:10])
    assert seen == ["2026-01-01", "2026-01-02", "2026-01-01"]


def test_a_jump_sets_the_clock(panel):
    panel.full.click()
    panel.eclipse.click()
    full, eclipse = (message.instant for message in panel._session.sent)
    assert all(isinstance(message, SetClock) for message in panel._session.sent)
    assert (full.month, full.day, full.hour) == (1, 3, 10)
    assert eclipse.date().isoformat() == "2026-08-12"
