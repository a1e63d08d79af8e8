"""BRE 209 (2022), clause by clause: light of windows, and what a new building takes of it.

Littlefair, King, Howlett, Ticleanu and Longfield 2022, "Site layout planning for daylight and
sunlight", third edition, sections 2.2, 3.2 and 3.3.
"""

from collections.abc import Mapping, Sequence

from daylight_numbers.rooms import SIDES
from daylight_numbers.standards.compliance import Clause, at_most, met_text
from daylight_numbers.standards.site_change import GARDEN_H, GardenSun, RoomSky, SiteChange
from daylight_numbers.standards.windows import WindowLight
from vrut_lite.quantities import percent_text

NEEDS_WEATHER = "not assessed: needs --weather"
NEEDS_BEFORE = "not assessed: needs --before"
# Vertical sky component, and shares of sunny hours of the year and of winter.
_VSC_PERCENT, _ANNUAL_SHARE, _WINTER_SHARE = 27.0, 0.25, 0.05
# Share of its former value below which a loss is noticeable, and least loss of sunny hours, as a
# share of all of the year's.
_FORMER, _LEAST_LOSS = 0.8, 0.04
_GARDEN_AREA = 0.5


def bre_clauses(
    names: Mapping[int, str],
    windows: Mapping[int, Sequence[WindowLight]],
    change: SiteChange | None,
    gardens: Mapping[str, GardenSun],
    has_weather: bool,
) -> list[Clause]:
    """Rows of windows and rooms by the number of their work plane, and of gardens by name."""
    rows = []
    for plane, of_room in windows.items():
        former = [None] * len(of_room) if change is None else change.windows[plane]
        for now, before in zip(of_room, former, strict=True):
            where = f"{names[plane]}, {SIDES[now.side]}, {now.azimuth_deg:.0f}°"
            rows += [_sky(where, now), _sky_loss(where, before, now)]
            rows += _sun(where, before, now, has_weather)
        rows.append(_no_sky_line(names[plane], None if change is None else change.skies[plane]))
    for name, garden in gardens.items():
        rows.append(_garden(name, garden))
    return rows


def _sky(where: str, window: WindowLight) -> Clause:
    low, high = window.vsc_range_percent
    found = f"{window.vsc_percent:.1f} % ({low:.1f} to {high:.1f})"
    verdict = met_text(window.vsc_percent >= _VSC_PERCENT)
    return Clause("2.2 vertical sky component", where, f"{_VSC_PERCENT:g} %", found, verdict)


def _sky_loss(where: str, before: WindowLight | None, now: WindowLight) -> Clause:
    clause, asks = "2.2 loss of skylight", f"{_VSC_PERCENT:g} %, or {_FORMER:g} of before"
    if before is None:
        return Clause(clause, where, asks, "", NEEDS_BEFORE)
    kept = _kept(before.vsc_percent, now.vsc_percent)
    found = f"{before.vsc_percent:.1f} to {now.vsc_percent:.1f} %, {kept:.2f}"
    is_met = now.vsc_percent >= _VSC_PERCENT or at_most(_FORMER, kept)
    return Clause(clause, where, asks, found, met_text(is_met))


def _sun(
    where: str, before: WindowLight | None, now: WindowLight, has_weather: bool
) -> list[Clause]:
    clauses = "3.2 probable sunlight hours", "3.2 loss of sunlight"
    asks = (
        "25 % of the year's, 5 % in winter",
        f"the same, or {_FORMER:g} of before, or a loss of 4 % of the year's at most",
    )
    annual, winter = now.annual_share, now.winter_share
    if annual is None or winter is None:
        lack = "no hour of the file is sunny" if has_weather else NEEDS_WEATHER
        return [
            Clause(clause, where, asked, "", lack)
            for clause, asked in zip(clauses, asks, strict=True)
        ]
    found = f"{percent_text(annual, 1)}, winter {percent_text(winter, 1)}"
    is_met = annual >= _ANNUAL_SHARE and winter >= _WINTER_SHARE
    away = "not asked: faces away from the sun"
    verdict = met_text(is_met) if now.faces_sun else away
    rows = [Clause(clauses[0], where, asks[0], found, verdict)]
    if before is None or before.annual_share is None or before.winter_share is None:
        return [*rows, Clause(clauses[1], where, asks[1], "", NEEDS_BEFORE)]
    kept = _kept(before.annual_share, annual), _kept(before.winter_share, winter)
    of_year = annual >= _ANNUAL_SHARE or at_most(_FORMER, kept[0])
    of_winter = winter >= _WINTER_SHARE or at_most(_FORMER, kept[1])
    is_small = at_most(before.annual_share - annual, _LEAST_LOSS)
    found = (
        f"{percent_text(before.annual_share, 1)} to {percent_text(annual, 1)}, winter "
        f"{percent_text(before.winter_share, 1)} to {percent_text(winter, 1)}"
    )
    verdict = met_text((of_year and of_winter) or is_small) if now.faces_sun else away
    return [*rows, Clause(clauses[1], where, asks[1], found, verdict)]


def _no_sky_line(name: str, sky: RoomSky | None) -> Clause:
    clause, asks = "2.2 no-sky line", f"{_FORMER:g} of the former area that sees sky"
    if sky is None:
        return Clause(clause, name, asks, "", NEEDS_BEFORE)
    found = f"{percent_text(sky.before, 1)} to {percent_text(sky.after, 1)} of the plane"
    return Clause(clause, name, asks, found, met_text(at_most(_FORMER, _kept(*sky))))


def _garden(name: str, garden: GardenSun) -> Clause:
    asks = f"{GARDEN_H:g} h on 21 March on half of the area, or on {_FORMER:g} of before"
    found = percent_text(garden.after, 1)
    is_met = at_most(_GARDEN_AREA, garden.after)
    if garden.before is not None:
        found = f"{percent_text(garden.before, 1)} to {found}"
        is_met = is_met or at_most(_FORMER, _kept(garden.before, garden.after))
    return Clause("3.3 sun in gardens", name, asks, found, met_text(is_met))


def _kept(before: float, now: float) -> float:
    """Share of a former value; all of nothing is kept."""
    return now / before if before > 0.0 else 1.0
