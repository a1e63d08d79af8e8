"""What the light depends on: of equal recipes nothing is made twice."""

import msgspec

from bruneton_sky.settings import BrunetonSkySettings
from bruneton_sky.solver_rungs import SolverRung
from vrut_lite.kernel.messages import AmbientChanged, Derived, SunLightChanged, Vector


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
    on_scene = product in (SunLightChanged, AmbientChanged)
    return light_recipe(recipe) if on_scene else recipe


def light_recipe(recipe: Recipe) -> Recipe:
    """What the light on the scene depends on."""
    return msgspec.structs.replace(recipe, altitude_m=0.0)
