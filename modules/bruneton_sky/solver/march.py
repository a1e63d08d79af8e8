"""Full-size tables from a solved field: every ray of a table marched once."""

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.solver.air import groups_of_air
from bruneton_sky.solver.source_field import SourceField
from bruneton_sky.solver.view import sky_irradiance, source_of_group
from bruneton_sky.tables.parametrisations import (
    Coordinates,
    Year,
    irradiance_state,
    node_coordinates,
    parametrisation_of,
)
from bruneton_sky.tables.sizes import TableSizes, refuse_fog
from vrut_lite.numeric_types import FloatArray

SingleArray = NDArray[np.float32]


def march_tables(
    field: SourceField, sizes: TableSizes | None = None, year: Year = "2017"
) -> tuple[SingleArray, SingleArray]:
    """Tables of scattering and single Mie, (altitude, mu, nu, mu_s, C) each.

    W m^-2 sr^-1 nm^-1. The first holds light scattered once by molecules without its phase
    function, and all later orders over Rayleigh's; the second light scattered once by aerosol,
    without its phase function. `year` names the parametrisation.

    Raises:
        ValueError: the atmosphere has fog.
    """
    from bruneton_sky.solver.view_kernels import march_rays

    refuse_fog(field.atmosphere)
    size = sizes or TableSizes()
    axes = np.ix_(*(node_coordinates(count) for count in size.scattering_shape))
    at = parametrisation_of(year).to_state(field.atmosphere, size, Coordinates(*axes))
    altitude, mu_s, nu = at.altitude_m.ravel(), at.mu_s.ravel(), at.nu.ravel()
    mu = np.ascontiguousarray(at.mu.reshape(size.altitude, size.mu))
    hits = np.ascontiguousarray(np.broadcast_to(at.hits_ground, (1, size.mu, 1, 1)).ravel())
    shape = (*size.scattering_shape, len(field.atmosphere.wavelength_nm))
    scattering, mie = np.empty(shape, np.float32), np.empty(shape, np.float32)
    own = field.sizes
    for group, air in enumerate(groups_of_air(field.atmosphere)):
        march_rays(
            air, altitude, mu, hits, mu_s, nu, field.transmittance[group],
            source_of_group(field, group), (own.steps, own.single_bins, own.multiple_bins),
            4 * group, scattering, mie,
        )  # fmt: skip
    return scattering, mie


def irradiance_table(field: SourceField, sizes: TableSizes | None = None) -> FloatArray:
    """The sky's irradiance (altitude, mu_s, C) on a level surface, without the direct sun.

    Raises:
        ValueError: the atmosphere has fog.
    """
    refuse_fog(field.atmosphere)
    size = sizes or TableSizes()
    shape = size.irradiance_altitude, size.irradiance_mu_s
    axes = np.ix_(*(node_coordinates(count) for count in shape))
    altitude, mu_s = irradiance_state(field.atmosphere, shape, *axes)
    return sky_irradiance(field, altitude.ravel(), mu_s.ravel(), field.sizes.node_bins)
