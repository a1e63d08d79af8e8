"""The Bruneton sky on the bus: multiple scattering in a spherical atmosphere.

A changed atmosphere is solved by a background job; until it ends the previous atmosphere's sky
stays. A moved sun or eye needs no such job: the sky-view table is made on the spot. No
4-D table is ever made here, since one observer's altitude is shown.
"""

from typing import ClassVar, get_args

import msgspec

from bruneton_sky.light import NAME, Air, BrunetonLight, SurroundingsMemo
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of, haze_of_air
from bruneton_sky.solver_job import solve_air
from bruneton_sky.tolerance import Quality, quality_for
from vrut_lite.daylight.sky_module import SkyModule
from vrut_lite.daylight.sky_of_hour import Hour, Prepared, Work
from vrut_lite.daylight.sun import Body
from vrut_lite.kernel.module import Link, Manifest

# Settings of where a sky is computed, which do not change the sky.
_NOT_AIR = {"cube_device": "cpu"}


class BrunetonSky(SkyModule):
    """The sky, sunlight and air for the sun of SunMoved."""

    manifest: ClassVar[Manifest] = Manifest(
        name=NAME,
        title="Bruneton sky",
        version="0.3.0",
        provides=("sky",),
        requires=("sun",),
    )
    settings_type: ClassVar[type[msgspec.Struct]] = BrunetonSkySettings
    settings: BrunetonSkySettings
    # Of more wavelengths than are solved for the picture.
    spectrum_is_slow = True

    def __init__(self, link: Link, settings: BrunetonSkySettings):
        super().__init__(link, settings)
        # Sun and moon take turns.
        self._memos = {body: SurroundingsMemo(self.ledger) for body in get_args(Body)}

    def quality(self, tolerance: float) -> Quality:
        """Rungs and sizes by the measured fronts."""
        return quality_for(tolerance)

    def prepare(self, ground_altitude_m: float, quality: Quality) -> Work:
        """Solve the atmosphere of the settings, under the place's haze."""
        settings = msgspec.structs.replace(self.settings, **_NOT_AIR)
        haze = haze_of_air(settings, self.haze)
        air = Air(settings, ground_altitude_m, quality.solver, haze)
        atmosphere = atmosphere_of(settings, ground_altitude_m, haze)
        return Work(solve_air, (atmosphere, settings.orders, quality.solver), of=air)

    def light(self, hour: Hour, quality: Quality, prepared: Prepared) -> BrunetonLight:
        """The light of the solved atmosphere, which may be older than the settings."""
        return BrunetonLight(
            of=prepared.of,
            solved=prepared.result,
            sun_direction=hour.sun.direction,
            visible_disc_fraction=hour.sun.visible_disc_fraction,
            eye_height_m=hour.eye_height_m,
            table=quality.table,
            memo=self._memos[hour.body],
        )
