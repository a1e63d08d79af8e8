"""Random hours, airs and observers for the Bruneton sky, and the converged sky of each.

An atmosphere is solved once with converged sizes, for some half a minute; under it many suns and
observers are looked at. Haze is drawn evenly in the logarithm of turbidity from 1 to 10, albedo
from 0 to 1; a third of the suns stand between 6 degrees below the horizon and the horizon, the
others anywhere above; half of the observers stand, the others are up to 12 km high.
"""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.single_scattering_kernels import fast_scattered_without_phase
from bruneton_sky.solver import SolverSizes, SourceField, multiple_scattering, solve
from numpy.typing import NDArray

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.numeric_types import FloatArray

# Directions are the texels of so small a cube that lie above the horizon.
EDGE = 20
VIEWS = 15
_HIGHEST_M, _LOWEST_M = 12_000.0, 10.0
_TRUE_ORDERS, _TRUE_TOLERANCE, _TRUE_NODES = 40, 1e-3, 48


class View(NamedTuple):
    """An observer and a sun (elevation and world azimuth)."""

    height_m: float
    elevation_rad: float
    azimuth_rad: float

    @property
    def sun(self) -> FloatArray:
        """Unit vector (3,) to the sun, in world axes."""
        level = np.cos(self.elevation_rad)
        return np.array(
            [
                level * np.sin(self.azimuth_rad),
                np.sin(self.elevation_rad),
                -level * np.cos(self.azimuth_rad),
            ]
        )


class Air(NamedTuple):
    """An atmosphere and those who look at it."""

    settings: BrunetonSkySettings
    views: tuple[View, ...]


def two_sets(count: int, seeds: tuple[int, int]) -> tuple[list[Air], list[Air]]:
    """So many atmospheres in each: drawn at random, and dealt in turn by their haze."""
    drawn = [air for seed in seeds for air in random_airs(count, seed)]
    drawn.sort(key=lambda air: air.settings.turbidity or 0.0)
    return drawn[::2], drawn[1::2]


def random_airs(count: int, seed: int) -> list[Air]:
    """So many of each, always the same for a seed."""
    rng = np.random.default_rng(seed)
    return [_air(rng) for _ in range(count)]


def _air(rng: np.random.Generator) -> Air:
    settings = BrunetonSkySettings(
        turbidity=float(10.0 ** rng.uniform(0.0, 1.0)), albedo=float(rng.uniform(0.0, 1.0))
    )
    return Air(settings, tuple(_view(rng, index) for index in range(VIEWS)))


def _view(rng: np.random.Generator, index: int) -> View:
    low, high = (-6.0, 0.0) if index % 3 == 0 else (0.0, 90.0)
    aloft = 10.0 ** rng.uniform(np.log10(_LOWEST_M), np.log10(_HIGHEST_M))
    elevation_rad = float(np.radians(rng.uniform(low, high)))
    azimuth_rad = float(rng.uniform(-np.pi, np.pi))
    return View(float(aloft) if index % 2 else 0.0, elevation_rad, azimuth_rad)


def sky_texels(air: Air, view: View) -> NDArray[np.bool_]:
    """Which texels (6, EDGE, EDGE) look above the ground's horizon."""
    radius_m = atmosphere_of(air.settings).ground_radius_m
    above: NDArray[np.bool_] = texel_directions(EDGE)[..., 1] > float(
        horizon_mu(radius_m, view.height_m)
    )
    return above


def true_skies(air: Air, kept: Path | None = None) -> list[FloatArray]:
    """Radiance (n, 3) of each view's `sky_texels`; looked for in a folder first, and left there."""
    file = None if kept is None else kept / f"{air.settings.turbidity:.9f}.npz"
    if file is not None and file.exists():
        with np.load(file) as arrays:
            return [arrays[f"{index}"] for index in range(len(air.views))]
    atmosphere = atmosphere_of(air.settings)
    sizes = SolverSizes.converged()
    field = solve(atmosphere, _TRUE_ORDERS, sizes, all_orders=True, tolerance=_TRUE_TOLERANCE)
    skies = [evaluated(field, air, view) for view in air.views]
    if file is not None:
        kept_arrays: dict[str, Any] = {f"{index}": sky for index, sky in enumerate(skies)}
        np.savez(file, **kept_arrays)
    return skies


def evaluated(field: SourceField, air: Air, view: View) -> FloatArray:
    """Radiance (n, 3) of `sky_texels`, each ray by itself: light scattered once by the exact rule,
    light scattered more from the field's source."""
    atmosphere = field.atmosphere
    directions = texel_directions(EDGE)[sky_texels(air, view)]
    order = np.argsort(directions[:, 1], kind="stable")
    mu, mu_s = directions[order, 1], float(view.sun[1])
    nu = np.clip(directions[order] @ view.sun, -1.0, 1.0)
    rayleigh, mie = fast_scattered_without_phase(
        atmosphere, view.height_m, mu, mu_s, nu, _TRUE_NODES
    )
    once = rayleigh * rayleigh_phase(nu)[:, None] + mie * mie_phase(atmosphere, nu)[:, None]
    more = multiple_scattering(field, view.height_m, mu, mu_s, nu)
    sky = np.empty((len(mu), 3))
    sky[order] = rgb_from_spectrum(once + more, atmosphere.wavelength_nm, 3.0)
    return np.maximum(sky, 0.0)
