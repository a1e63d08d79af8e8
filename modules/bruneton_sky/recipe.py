"""What the light depends on: of equal recipes nothing is made twice."""

import msgspec

from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.solver_rungs import SolverRung
from bruneton_sky.tolerance import Quality
from bruneton_sky.unseen_moves import altitude_step_m, same_to_the_eye
from vrut_lite.daylight.sky import AmbientChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.kernel.messages import Derived
from vrut_lite.numeric_types import Vector


class AirKey(msgspec.Struct, frozen=True):
    """All that the scattered light depends on, for any sun and observer."""

    settings: BrunetonSkySettings
    ground_altitude_m: float
    rung: SolverRung = "usual"


class Recipe(msgspec.Struct, frozen=True):
    """All that the light depends on: equal recipes make equal light."""

    air: AirKey
    sun_direction: Vector
    visible_disc_fraction: float
    altitude_m: float
    table: str = "usual"


def recipe_of(product: type[Derived], recipe: Recipe) -> Recipe:
    """What a product depends on: the scene's light does not depend on who looks."""
    on_scene = product in (KeyLightChanged, AmbientChanged)
    return light_recipe(recipe) if on_scene else recipe


def light_recipe(recipe: Recipe) -> Recipe:
    """What the light on the scene depends on."""
    return msgspec.structs.replace(recipe, altitude_m=0.0)


def unless_seen(now: Recipe, shown: Recipe, quality: Quality) -> Recipe:
    """The recipe of now, with sun and observer where they are shown if nobody sees them move."""
    if now == shown:
        return now
    atmosphere = atmosphere_of(now.air.settings, now.air.ground_altitude_m)
    step_m = quality.altitude_steps * altitude_step_m(shown.altitude_m, atmosphere)
    stays = abs(now.altitude_m - shown.altitude_m) <= step_m
    sun_stays = same_to_the_eye(
        shown.sun_direction, now.sun_direction, atmosphere.mie_g, quality.sun_change
    )
    return msgspec.structs.replace(
        now,
        altitude_m=shown.altitude_m if stays else now.altitude_m,
        sun_direction=shown.sun_direction if sun_stays else now.sun_direction,
    )
