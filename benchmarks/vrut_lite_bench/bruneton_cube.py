"""From a moved sun, camera or setting to a new cube map: CPU time, and error beside it.

    OPENBLAS_NUM_THREADS=1 python -m vrut_lite_bench.bruneton_cube

Times are minima of one thread's CPU time, of what the module does (`solve_air`, `surroundings`,
`background_cube`) and of its parts. Errors are those of the sky's texels as the module makes
them against direct evaluation with converged sizes and all orders (Gauss-Legendre with 48 nodes
for light scattered once), over the larger of the value and a thousandth of the brightest: mean, and
what 99 % stay below.
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np
from bruneton_sky.background import Surroundings, background_cube, surroundings
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.kernels import fast_scattered_without_phase
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of, spectral_atmosphere_of
from bruneton_sky.sky_view import fill_cube, sky_view
from bruneton_sky.solver import SolverSizes, SourceField, multiple_scattering, solve
from bruneton_sky.solver_job import solve_air
from numpy.typing import NDArray

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.encoding import encode_float16

SKIES = {
    "turbidity 3": BrunetonSkySettings(),
    "clear": BrunetonSkySettings(preset="earth-clear"),
    "turbidity 10": BrunetonSkySettings(turbidity=10.0),
}
ELEVATIONS_DEG = (60.0, 30.0, 10.0, 2.0, 0.0, -3.0, -6.0, -9.0, -12.0)
HEIGHTS_M = (0.0, 2000.0, 12_000.0)
_SIZE = 48
# Of the truth: orders at most, and the change of all light at which they end.
_TRUE_ORDERS, _TRUE_TOLERANCE = 40, 2e-3


def least_ms(work: Callable[[], object], repeats: int = 9) -> float:
    """Minimum CPU time in ms, after one call that may compile."""
    work()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return 1e3 * min(times)


def sun(elevation_deg: float) -> NDArray[np.float64]:
    """Direction (3,) to the sun."""
    elevation = np.radians(elevation_deg)
    return np.array([0.6 * np.cos(elevation), np.sin(elevation), -0.8 * np.cos(elevation)])


def error(
    field: SourceField, exact: SourceField, height_m: float, elevation_deg: float
) -> tuple[float, float]:
    """Mean and 99th percentile of the relative error of the sky above the horizon."""
    atmosphere, direction = field.atmosphere, sun(elevation_deg)
    cube = background_cube(surroundings(field, height_m, direction), _SIZE)
    directions = texel_directions(_SIZE)
    sky = directions[..., 1] > float(horizon_mu(atmosphere.ground_radius_m, height_m))
    mu = directions[sky][:, 1]
    order = np.argsort(mu)
    mu, nu = mu[order], np.clip(directions[sky][order] @ direction, -1.0, 1.0)
    rayleigh, mie = fast_scattered_without_phase(
        atmosphere, height_m, mu, float(direction[1]), nu, 48
    )
    once = rayleigh * rayleigh_phase(nu)[:, None] + mie * mie_phase(atmosphere, nu)[:, None]
    more = multiple_scattering(exact, height_m, mu, float(direction[1]), nu)
    want = rgb_from_spectrum(once + more, atmosphere.wavelength_nm, 3.0)
    differences = np.abs(cube[sky][order] - want) / np.maximum(want, 1e-3 * want.max())
    return float(differences.mean()), float(np.quantile(differences, 0.99))


def print_errors() -> None:
    """A table of errors by sky, height and sun."""
    print("error of the sky, mean / 99 %, in percent")
    print(f"{'sky':>13} {'height':>7} " + " ".join(f"{e:>11g}" for e in ELEVATIONS_DEG))
    for name, settings in SKIES.items():
        atmosphere = atmosphere_of(settings)
        field = solve_air(atmosphere)
        exact = solve(atmosphere, _TRUE_ORDERS, SolverSizes.converged(), True, _TRUE_TOLERANCE)
        for height_m in HEIGHTS_M:
            cells = (error(field, exact, height_m, e) for e in ELEVATIONS_DEG)
            row = " ".join(f"{100 * mean:5.2f}/{100 * most:5.2f}" for mean, most in cells)
            print(f"{name:>13} {height_m:7g} {row}")


def print_times() -> None:
    """CPU time of each part, and of all that a moved sun, camera or setting takes."""
    print("CPU time, ms: table, cube; the whole message for a moved sun, moved camera")
    settings = SKIES["turbidity 3"]
    atmosphere, sunlight = atmosphere_of(settings), spectral_atmosphere_of(settings)
    field = solve_air(atmosphere)
    ground = np.zeros(3)
    for height_m in (0.0, 100.0, 5e3, 50e3, 4e5, 3e6):
        for elevation_deg in (40.0, 5.0, -4.0):
            at = partial(surroundings, field, height_m, sun(elevation_deg), 1.0, sunlight)
            known = at()
            table_ms = least_ms(partial(sky_view, field, height_m, sun(elevation_deg)))
            cube_ms = least_ms(partial(fill_cube, known.view, 256, ground))
            sun_ms = least_ms(partial(_message, at))
            camera_ms = least_ms(partial(_message, at, known))
            print(
                f"{height_m:9g} m, sun {elevation_deg:3g} deg: {table_ms:4.2f}, {cube_ms:4.2f}; "
                f"{sun_ms:4.2f}, {camera_ms:4.2f}"
            )
    print("changed atmosphere to the message, sun at 35 degrees: solving, all at 0 and 2000 m")
    for name, other in SKIES.items():
        print(f"{name:>13}: {_changed_ms(other)}")


def _message(around: Callable[..., Surroundings], *known: Surroundings) -> object:
    return encode_float16(background_cube(around(*known), 256))


def _changed_ms(settings: BrunetonSkySettings) -> str:
    atmosphere, sunlight = atmosphere_of(settings), spectral_atmosphere_of(settings)

    def message(height_m: float) -> object:
        around = surroundings(solve_air(atmosphere), height_m, sun(35.0), 1.0, sunlight)
        return encode_float16(background_cube(around, 256))

    works = (partial(solve_air, atmosphere), partial(message, 0.0), partial(message, 2000.0))
    return ", ".join(f"{least_ms(work, 5):.0f}" for work in works)


if __name__ == "__main__":
    print_times()
    print_errors()
