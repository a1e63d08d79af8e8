"""When a shadow falls so at a place: instants, and the spans of time that fit its errors."""

from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, timedelta, tzinfo

import numpy as np

from shadow_clock.crossings import Curve, crossings, highest, with_extremes
from shadow_clock.measured_shadow import MeasuredShadow
from vrut_lite.numeric_types import FloatArray
from vrut_lite.place_time import Place
from vrut_lite.sky.day_events import civil_day
from vrut_lite.sky.sun_track import SunTrack
from vrut_lite.sky.suns import Suns

# Spacing of samples, over which the sun moves 1.25 degrees, and how far they reach beyond the days:
# spans that fit may begin before midnight.
_SAMPLE_S, _BEYOND_S = 300.0, 43_200.0
_SAMPLES_IN_SPAN = 65
# Misfit below which the shadow counts as exactly the measured one.
EXACT = 1e-4


@dataclass(frozen=True)
class ShadowTime:
    """An instant (UTC) at which the shadow falls so, and the span around it that fits the errors.

    Attributes:
        instant: the exact one; without any in the span, the one that fits best.
        earliest, latest: the ends of the span.
        misfit: difference over what fits, the largest of bearing and ratio: 0 exact, 1 at the edge.
        bearing_deg: of the shadow then, clockwise from true north.
        length_ratio: of the shadow then.
        elevation_deg: apparent, of the sun's centre.
    """

    instant: datetime
    earliest: datetime
    latest: datetime
    misfit: float
    bearing_deg: float
    length_ratio: float
    elevation_deg: float


class ShadowDays:
    """The sun at a place over whole civil days, and the shadows that it casts."""

    def __init__(self, first: date, last: date, place: Place, time_zone: tzinfo):
        """Sample the sun from the first day's midnight to the last day's end."""
        self.place, self.time_zone = place, time_zone
        self._is_one_day = first == last
        self._start_s = civil_day(first, time_zone)[0].timestamp()
        self._end_s = civil_day(last, time_zone)[1].timestamp()
        begin, end = self._start_s - _BEYOND_S, self._end_s + _BEYOND_S
        self._track = SunTrack(begin, end)
        self._samples = np.append(np.arange(begin, end, _SAMPLE_S), end)

    def suns(self, seconds: FloatArray) -> Suns:
        """The suns (n,) at seconds (n,) since 1970 UTC."""
        return self._track.suns(seconds, *self.place)

    def times(self, shadow: MeasuredShadow) -> list[ShadowTime]:
        """The instants of the days at which the shadow falls so, in order."""
        exact = self._exact(shadow)
        spans = self._spans(shadow, exact)
        found = []
        for low, high in spans:
            inside = exact[(exact >= low) & (exact <= high)]
            if shadow.bearing_deg is not None and shadow.length_ratio is not None:
                inside = inside[:0]
            best = inside if inside.size else self._best(shadow, low, high)
            found += [self._time(shadow, at, low, high) for at in best.tolist()]
        return sorted(
            (one for one in found if self._start_s <= one.instant.timestamp() < self._end_s),
            key=lambda one: one.instant,
        )

    def why_none(self, shadow: MeasuredShadow) -> str:
        """The reason why the shadow never falls so in these days."""
        inside = (self._samples >= self._start_s) & (self._samples < self._end_s)
        at = self._samples[inside]
        suns = self.suns(at)
        height = suns.apparent_elevation_rad
        top = int(np.argmax(height))
        if height[top] <= 0.0:
            return (
                "the sun stays below the horizon: at its highest, "
                f"{np.degrees(height[top]):.1f} degrees, at {self._clock(at[top])}"
            )
        up = height > 0.0
        parts = []
        if shadow.length_ratio is not None and shadow.ratio_misfit(suns)[up].min() > 1.0:
            low, high = float(height[up].min()), float(height[top])
            if shadow.elevation_rad > high:
                parts.append(
                    f"no shadow is shorter than {1.0 / np.tan(high):.3g} of the height, at "
                    f"{self._clock(at[top])}"
                )
            else:
                lowest = int(np.flatnonzero(up)[np.argmin(height[up])])
                parts.append(
                    f"no shadow is longer than {1.0 / np.tan(low):.3g} of the height, at "
                    f"{self._clock(at[lowest])}"
                )
        if shadow.bearing_deg is not None and shadow.bearing_misfit(suns)[up].min() > 1.0:
            opposite = np.where(up, np.inf, shadow.bearing_misfit(suns))
            at_night = int(np.argmin(opposite))
            if opposite[at_night] <= 1.0:
                parts.append(
                    f"the sun is below the horizon, at {np.degrees(height[at_night]):.1f} degrees, "
                    f"when a shadow would point to {shadow.bearing_deg % 360.0:g} degrees, at "
                    f"{self._clock(at[at_night])}"
                )
            else:
                parts.append(f"no shadow ever points to {shadow.bearing_deg % 360.0:g} degrees")
        return ", and ".join(parts) or self._apart(shadow)

    def _apart(self, shadow: MeasuredShadow) -> str:
        """The reason where bearing and ratio each fit, but never together."""
        if not self._is_one_day:
            return "bearing and ratio each fit, but on no day at the same time"
        alone = replace(shadow, length_ratio=None), replace(shadow, bearing_deg=None)
        bearing, ratio = (
            " and ".join(self._clock(one.instant.timestamp()) for one in self.times(part))
            for part in alone
        )
        return f"the bearing fits at {bearing}, the ratio at {ratio}, and never both"

    def _exact(self, shadow: MeasuredShadow) -> FloatArray:
        """Instants (k,) of the bearing and of the ratio, each by itself, with the sun up."""
        found = [np.zeros(0)]
        if shadow.bearing_deg is not None:
            at = crossings(lambda s: shadow.across(self.suns(s)), self._samples)
            found.append(at[shadow.points_along(self.suns(at))])
        if shadow.length_ratio is not None:
            found.append(crossings(lambda s: shadow.higher(self.suns(s)), self._samples))
        at = np.sort(np.concatenate(found))
        return np.asarray(at[self.suns(at).apparent_elevation_rad > 0.0])

    def _spans(self, shadow: MeasuredShadow, exact: FloatArray) -> list[tuple[float, float]]:
        """The spans of time in which the sun is up and all that was measured fits."""
        curve = self._fits(shadow)
        samples = np.unique(np.concatenate([self._samples, exact]))
        samples = with_extremes(curve, samples)
        edges = np.concatenate([samples[:1], crossings(curve, samples), samples[-1:]])
        middles = curve(0.5 * (edges[1:] + edges[:-1]))
        fits = np.flatnonzero(middles > 0.0)
        return [(float(edges[i]), float(edges[i + 1])) for i in fits]

    def _fits(self, shadow: MeasuredShadow) -> Curve:
        """Positive (...,) where the sun is up and all misfits are below 1."""

        def curve(seconds: FloatArray) -> FloatArray:
            suns = self.suns(seconds)
            worst = np.max(shadow.misfits(suns), axis=0)
            return np.asarray(np.minimum(1.0 - worst, suns.apparent_elevation_rad))

        return curve

    def _best(self, shadow: MeasuredShadow, low: float, high: float) -> FloatArray:
        """The instant (1,) of a span with the least sum of squared misfits."""

        def badness(seconds: FloatArray) -> FloatArray:
            return np.sum(np.square(shadow.misfits(self.suns(seconds))), axis=0)

        at = np.linspace(low, high, _SAMPLES_IN_SPAN)
        best = int(np.argmin(badness(at)))
        around = at[[max(best - 1, 0)]], at[[min(best + 1, len(at) - 1)]]
        return highest(badness, *around, np.array([-1.0]))

    def _time(self, shadow: MeasuredShadow, at: float, low: float, high: float) -> ShadowTime:
        suns = self.suns(np.array([at]))
        elevation = float(suns.apparent_elevation_rad[0])
        return ShadowTime(
            instant=_utc(at),
            earliest=_utc(low),
            latest=_utc(high),
            misfit=float(np.max(shadow.misfits(suns))),
            bearing_deg=float(np.degrees(suns.azimuth_rad[0]) + 180.0) % 360.0,
            length_ratio=float(1.0 / np.tan(elevation)),
            elevation_deg=float(np.degrees(elevation)),
        )

    def _clock(self, seconds: float) -> str:
        local = _utc(float(seconds)).astimezone(self.time_zone)
        return f"{local:%H:%M}" if self._is_one_day else f"{local:%H:%M} on {local:%Y-%m-%d}"


def _utc(seconds: float) -> datetime:
    return datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=seconds)
