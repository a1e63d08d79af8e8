"""Spectral radiance along rays by the kernel of the sky-view table."""

import numpy as np
from bruneton_sky.phase import mie_phase
from bruneton_sky.sky_view import GroundColours
from bruneton_sky.sky_view.rays import SkyViewRays
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
    colour = np.eye(4, dtype=np.float32).ravel()
    black = GroundColours(
        np.array([-1.0, 1.0], np.float32), np.ones(4, np.float32), np.zeros(32, np.float32)
    )
    one_kind, nodes = np.ones((2, 4), np.float32), np.zeros((len(nu), nu.shape[1] * 8), np.float32)
    add_rows(
        air, rows.altitude_m, rows.mu, rows.hits, rows.mu_s.astype(np.float32), nu,
        field.transmittance[0], source_of_group(field, 0), counts, colour, colour, one_kind, black,
        nodes,
    )  # fmt: skip
    by_kind = nodes.reshape(*nu.shape, 2, 4)[..., : len(field.atmosphere.wavelength_nm)]
    phase = mie_phase(field.atmosphere, rows.nu)[..., None]
    return np.asarray(by_kind[:, :, 0] + by_kind[:, :, 1] * phase, dtype=float)
