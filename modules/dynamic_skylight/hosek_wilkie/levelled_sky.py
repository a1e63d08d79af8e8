"""The model at another level than published, for a sky of equal haze."""

from numpy.typing import ArrayLike

from dynamic_skylight.hosek_wilkie.coefficients import Quantity
from dynamic_skylight.hosek_wilkie.sky import HosekWilkieSky
from vrut_lite.numeric_types import FloatArray


class LevelledSky(HosekWilkieSky):
    """`HosekWilkieSky` whose sky is multiplied by a level; the disc is the model's own."""

    def __init__(
        self, turbidity: float, albedo: ArrayLike, sun_elevation_rad: float, level: float = 1.0
    ):
        super().__init__(turbidity, albedo, sun_elevation_rad)
        self._level = level

    def _formula(self, quantity: Quantity) -> tuple[FloatArray, FloatArray]:
        distribution, mean_radiance = super()._formula(quantity)
        return distribution, self._level * mean_radiance
