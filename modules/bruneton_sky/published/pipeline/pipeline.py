"""Algorithm 1: runs algorithms 2 to 7 in their order."""

from collections.abc import Callable

import numpy as np

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import rayleigh_phase
from bruneton_sky.published.pipeline.first_order import (
    direct_irradiance,
    single_scattering,
    transmittance,
)
from bruneton_sky.published.pipeline.higher_orders import indirect_irradiance, multiple_scattering
from bruneton_sky.published.pipeline.scattering_density import scattering_density
from bruneton_sky.published.pipeline.setting import (
    Setting,
    light_scattered_often,
    light_scattered_once,
)
from bruneton_sky.tables.parametrisations import Year
from bruneton_sky.tables.sizes import TableSizes, refuse_untabled
from bruneton_sky.tables.tables import Tables
from vrut_lite.numeric_types import FloatArray

Observe = Callable[[str, int, FloatArray], None]


def run_pipeline(
    atmosphere: Atmosphere,
    sizes: TableSizes | None = None,
    orders: int = 4,
    parametrisation: Year = "2017",
    observe: Observe = lambda name, order, array: None,
) -> Tables:
    """The tables of an atmosphere.

    Args:
        orders: highest order of scattering and reflection, 1 or more.
        observe: called after every step with its name, order of scattering and array:
            transmittance (order 0); delta_irradiance (1: of the sun's disc; n: of the sky's light
            scattered n - 1 times), single_rayleigh and single_mie (1); scattering_density and
            delta_multiple_scattering (2 and more).

    Raises:
        ValueError: orders is below 1, there is fog, or the parametrisation does not exist.
    """
    if orders < 1:
        raise ValueError(f"orders must be 1 or more, not {orders}")
    refuse_untabled(atmosphere)
    setting = Setting(atmosphere, sizes or TableSizes(), parametrisation)
    clear = transmittance(setting)
    observe("transmittance", 0, clear)
    on_ground = direct_irradiance(setting, clear)
    observe("delta_irradiance", 1, on_ground)
    rayleigh, single_mie = single_scattering(setting, clear)
    observe("single_rayleigh", 1, rayleigh)
    observe("single_mie", 1, single_mie)

    light = light_scattered_once(atmosphere, rayleigh, single_mie)
    irradiance, scattering = np.zeros_like(on_ground), rayleigh.copy()
    phase = rayleigh_phase(setting.nodes().nu)[..., None]
    for order in range(2, orders + 1):
        density = scattering_density(setting, clear, light, on_ground)
        observe("scattering_density", order, density)
        on_ground = indirect_irradiance(setting, light)
        observe("delta_irradiance", order, on_ground)
        radiance = multiple_scattering(setting, clear, density)
        observe("delta_multiple_scattering", order, radiance)
        irradiance += on_ground
        scattering += radiance / phase
        light = light_scattered_often(radiance)
    return Tables(
        atmosphere=atmosphere,
        sizes=setting.sizes,
        orders=orders,
        parametrisation=parametrisation,
        transmittance=clear,
        irradiance=irradiance,
        scattering=scattering,
        single_mie=single_mie,
    )
