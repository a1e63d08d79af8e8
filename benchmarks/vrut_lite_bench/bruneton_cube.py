"""From a moved sun, camera or setting to a new cube map: CPU time, and error beside it.

    OPENBLAS_NUM_THREADS=1 python -m vrut_lite_bench.bruneton_cube

Times are minima of one thread's CPU time. Errors are those of the sky's texels against direct
evaluation with converged sizes (Gauss-Legendre with 48 nodes for light scattered once), over the
larger of the value and a thousandth of the brightest: mean, and what 99 % stay below.
"""

import time
from collections.abc import Callable

import numpy as np
from bruneton_sky.background import background_cube, surroundings
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.kernels import fast_scattered_without_phase
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.sky_view import fill_cube, sky_view
from bruneton_sky.solver import SolverSizes, SourceField, multiple_scattering, solve
from numpy.typing import NDArray

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions

SKIES = {
    "turbidity 3": BrunetonSkySettings(),
    "clear": BrunetonSkySettings(preset="earth-clear"),
    "turbidity 10": BrunetonSkySettings(turbidity=10.0),
}
ELEVATIONS_DEG = (60.0, 30.0, 10.0, 2.0, 0.0, -3.0, -6.0, -9.0, -12.0)
HEIGHTS_M = (0.0, 2000.0, 12_000.0)
_SIZE = 48


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
        field = solve(atmosphere, all_orders=True)
        exact = solve(atmosphere, all_orders=True, sizes=SolverSizes.converged())
        for height_m in HEIGHTS_M:
            cells = (error(field, exact, height_m, e) for e in ELEVATIONS_DEG)
            row = " ".join(f"{100 * mean:5.2f}/{100 * most:5.2f}" for mean, most in cells)
            print(f"{name:>13} {height_m:7g} {row}")


def print_times() -> None:
    """CPU time of each part."""
    atmosphere = atmosphere_of(BrunetonSkySettings())
    field = solve(atmosphere, all_orders=True)
    ground = np.zeros(3)
    print("CPU time, ms")
    for name, height_m, elevation_deg in (
        ("on the ground, sun 35 deg", 0.0, 35.0),
        ("on the ground, sun -3 deg", 0.0, -3.0),
        ("at 2 km, sun 35 deg", 2e3, 35.0),
        ("in space, sun 35 deg", 1e6, 35.0),
    ):
        direction = sun(elevation_deg)
        view = sky_view(field, height_m, direction)
        table_ms = least_ms(lambda h=height_m, d=direction: sky_view(field, h, d))  # type: ignore[misc]
        fills = {n: least_ms(lambda v=view, n=n: fill_cube(v, n, ground)) for n in (256, 1024)}  # type: ignore[misc]
        print(
            f"{name:>26}: table {table_ms:5.2f}, cube 256^2 {fills[256]:5.2f}, 1024^2 "
            f"{fills[1024]:6.1f}; moved sun or camera to 256^2 {table_ms + fills[256]:5.2f}"
        )
    direction = sun(35.0)

    def picture() -> object:
        made = solve(atmosphere, all_orders=True, tolerance=1e-3)
        return fill_cube(sky_view(made, 0.0, direction), 256, ground)

    print(f"{'changed atmosphere':>26}: to a 256^2 cube {least_ms(picture, 5):.1f}")


if __name__ == "__main__":
    print_times()
    print_errors()
