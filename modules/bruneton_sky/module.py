"""The Bruneton sky on the bus: multiple scattering in a spherical atmosphere.

A changed atmosphere is solved by a background job; until it ends the previous atmosphere's sky
stays, by day a draft of the new one's. A moved sun or eye needs no such job: the sky-view table is
made on the spot. No 4-D table is ever made here, since one observer's altitude is shown.
"""

from dataclasses import replace
from math import radians
from typing import ClassVar, get_args

import msgspec

from bruneton_sky.light import NAME, BrunetonLight, ScatteringInputs, SurroundingsMemo
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of, ground_of_air, haze_of_air
from bruneton_sky.solver_job import solve_air
from bruneton_sky.solver_rungs import SolverRung
from bruneton_sky.tolerance import BrunetonQuality, quality_for
from vrut_lite import __version__
from vrut_lite.kernel.module import Link, Manifest
from vrut_lite.messages.sun import Body, SunMoved
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.sky.sky_of_hour import Prepared, SkyInputs, Work

# Settings of where a sky is computed, which do not change the sky.
_NOT_AIR = {"cube_device": "cpu"}
# By day a draft is the same to the eye: its luminance is off by 0.4 to 0.7 % rms, by 3 % at most.
# In twilight it is too dark.
_BY_DAY_RAD = radians(5.0)


class BrunetonSky(SkyModule):
    """The sky, sunlight and air for the sun of SunMoved."""

    manifest: ClassVar[Manifest] = Manifest(
        name=NAME,
        title="Clear sky (atmosphere)",
        version=__version__,
        provides=("sky",),
        requires=("sun",),
    )
    settings_type: ClassVar[type[msgspec.Struct]] = BrunetonSkySettings
    settings: BrunetonSkySettings
    # A spectrum has more wavelengths than are solved for the picture.
    spectrum_is_slow = True

    def __init__(self, link: Link, settings: BrunetonSkySettings):
        super().__init__(link, settings)
        self._shown: ScatteringInputs | None = None
        # Sun and moon take turns.
        self._memos = {body: SurroundingsMemo(self.counters) for body in get_args(Body)}

    def quality(self, tolerance: float) -> BrunetonQuality:
        """Rungs and sizes by the measured fronts."""
        return quality_for(tolerance)

    def prepare(self, ground_altitude_m: float, quality: BrunetonQuality) -> Work:
        """Solve the atmosphere of the settings, under the place's haze, above its ground."""
        settings = msgspec.structs.replace(self.settings, **_NOT_AIR)
        haze, ground = haze_of_air(settings, self.haze), ground_of_air(settings, self.ground)
        atmosphere = atmosphere_of(settings, ground_altitude_m, haze, ground)

        air = ScatteringInputs(settings, ground_altitude_m, quality.solver, haze, ground)

        def solved(rung: SolverRung) -> Work:
            of = replace(air, rung=rung)
            return Work(solve_air, (atmosphere, settings.orders, rung), of=of)

        sun, shown = self.link.last(SunMoved), self._shown
        is_day = sun is not None and sun.apparent_elevation_rad > _BY_DAY_RAD
        is_other = shown is not None and replace(shown, rung=air.rung) != air
        drafted = is_day and is_other and not atmosphere.foggy and air.rung != "draft"
        return solved(air.rung)._replace(first=solved("draft") if drafted else None)

    def light(self, hour: SkyInputs, quality: BrunetonQuality, prepared: Prepared) -> BrunetonLight:
        """The light of the solved atmosphere, which may be older than the settings."""
        self._shown = prepared.of
        return BrunetonLight(
            of=prepared.of,
            solved=prepared.result,
            sun_direction=hour.sun.direction,
            visible_disc_fraction=hour.sun.visible_disc_fraction,
            eye_height_m=hour.eye_height_m,
            table=quality.table,
            memo=self._memos[hour.body],
        )
