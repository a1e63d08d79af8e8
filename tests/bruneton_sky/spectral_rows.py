"""Spectral radiance along rays by the kernel of the sky-view table."""

import numpy as np
from bruneton_sky.sky_view import GroundColours
from bruneton_sky.sky_view.rays import SkyViewRays
from bruneton_sky.sky_view.table import aerosol_bands, row_bins
from bruneton_sky.sky_view.table_kernels import add_rows
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.source_field import source_of_group
from bruneton_sky.solver.wavelength_groups import groups_of_air
from numpy.typing import NDArray


def total_radiance(
    field: SourceField, rows: SkyViewRays, counts: tuple[int, int, int]
) -> NDArray[np.float64]:
    """Radiance (rows, columns, C) of at most four wavelengths before a black ground."""
    (air,), nu = groups_of_air(field.atmosphere), rows.nu.astype(np.float32)
    bands, colour = aerosol_bands(field, 0.0), np.eye(4, dtype=np.float32).ravel()
    kinds, wavelengths = (
        np.zeros((*bands.kinds.shape[1::-1], 4)),
        len(field.atmosphere.wavelength_nm),
    )
    kinds[..., :wavelengths] = bands.kinds.swapaxes(0, 1)
    lanes = kinds.reshape(len(kinds), -1).astype(np.float32)
    black = GroundColours(
        np.array([-1.0, 1.0], np.float32), np.ones(4, np.float32), np.zeros(32, np.float32)
    )
    nodes = np.zeros((len(nu), nu.shape[1] * 8), np.float32)
    fine, coarse = row_bins(air, rows, slice(None), counts)
    add_rows(
        air, rows.altitude_m, rows.mu, rows.hits, rows.mu_s.astype(np.float32), nu,
        field.transmittance[0], source_of_group(field, 0), fine, coarse,
        colour, colour, lanes, black, nodes,
    )  # fmt: skip
    by_kind = nodes.reshape(*nu.shape, 2, 4)[..., :wavelengths].astype(float)
    place = np.sqrt(np.maximum(0.5 - 0.5 * rows.nu, 0.0)) * (len(bands.phase) - 1)
    nodes_at = np.arange(len(bands.phase))
    phase = [np.interp(place, nodes_at, bands.phase[:, c]) for c in range(wavelengths)]
    return np.asarray(by_kind[:, :, 0] + by_kind[:, :, 1] * np.stack(phase, axis=-1))
