"""Run time and error of the fast solver of multiple scattering, stage by stage.

    python -m vrut_lite_bench.bruneton_solver

One thread, CPU time, the least of all rounds: that is what other work on the machine disturbs
least. Set OPENBLAS_NUM_THREADS=1. Errors are against the solver's converged sizes, which the
tests hold to Monte Carlo truth.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator

import numpy as np
from bruneton_sky import Atmosphere
from bruneton_sky.kernels import fast_scattered_without_phase
from bruneton_sky.phase import mie_phase, rayleigh_phase
from bruneton_sky.single_scattering import single_scattering
from bruneton_sky.solver import (
    SolverSizes,
    SourceField,
    irradiance_table,
    march_tables,
    multiple_scattering,
    single_scattering_fast,
    solve,
)
from bruneton_sky.tables.parametrisations import State, node_states
from bruneton_sky.tables.sizes import TableSizes

from vrut_lite.numeric_types import FloatArray

SKY_VIEW = (128, 32)
# The daylight thesis (Hvezda 2020), table 5.2: precomputation on a GTX 1060.
THESIS_MS = 1138.0
# Of all cells, so small a part of the brightest at the same sun is dark.
_FLOOR = 1e-3
_FIRST_CALL = """
import time
start = time.process_time()
import numba
numba.njit(lambda x: x + 1)(1)
numba_s = time.process_time() - start
from bruneton_sky import Atmosphere
from bruneton_sky.solver import irradiance_table, march_tables, multiple_scattering, solve
start = time.process_time()
field = solve(Atmosphere.earth())
march_tables(field)
irradiance_table(field)
multiple_scattering(field, 0.0, [0.5], 0.5, [0.5])
print(numba_s, time.process_time() - start)
"""


def run_times(rounds: int = 9) -> dict[str, float]:
    """Seconds of CPU of each stage, four orders, tables of the published sizes."""
    air = Atmosphere.earth()
    field = solve(air)
    mu, nu = _sky_view_rays(0.5)
    return {
        "solve": _least(lambda: solve(air), rounds),
        "march of the tables": _least(lambda: march_tables(field), rounds),
        "irradiance table": _least(lambda: irradiance_table(field), rounds),
        "sky view, multiple part": _least(
            lambda: multiple_scattering(field, 500.0, mu, 0.5, nu), 10 * rounds
        ),
        "sky view, single part by bins": _least(
            lambda: single_scattering_fast(field, 500.0, mu, 0.5, nu), 10 * rounds
        ),
        "sky view, single part by the rule, 16 nodes": _least(
            lambda: fast_scattered_without_phase(air, 500.0, mu, 0.5, nu, 16), rounds
        ),
    }


def table_errors(all_orders: bool = False) -> dict[str, tuple[float, float]]:
    """Mean and 99th percentile of the relative error of all light in the tables, by sun."""
    air, sizes = Atmosphere.earth(), TableSizes()
    state = node_states(air, sizes, "2017")
    exact = _table_radiance(solve(air, sizes=SolverSizes.converged()), state)
    ours = _table_radiance(solve(air, all_orders=all_orders), state)
    brightest = exact.max(axis=(0, 1, 2), keepdims=True)
    error = np.abs(ours - exact) / np.maximum(exact, _FLOOR * brightest)
    mu_s = state.mu_s.ravel()
    bands = {
        "day, mu_s > 0.1": mu_s > 0.1,
        "sun within 6 degrees of the horizon": np.abs(mu_s) <= 0.1,
        "night, mu_s < -0.1": mu_s < -0.1,
    }
    return {
        name: (float(error[..., band, :].mean()), float(np.percentile(error[..., band, :], 99)))
        for name, band in bands.items()
    }


def first_calls() -> tuple[float, float, float]:
    """Seconds of CPU: starting numba, all kernels with compilation, and from the cache."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
        answers = [
            subprocess.run(
                [sys.executable, "-c", _FIRST_CALL],
                env=environment,
                capture_output=True,
                text=True,
                check=True,
            ).stdout.split()
            for _ in range(3)
        ]
    cached = min(float(answer[1]) for answer in answers[1:])
    return float(answers[1][0]), float(answers[0][1]), cached


def report() -> Iterator[str]:
    """A Markdown table of times, and the errors beside them."""
    spent = run_times()
    yield "| stage | CPU ms |\n|---|---:|"
    for name, seconds in spent.items():
        yield f"| {name} | {seconds * 1e3:.1f} |"
    tables = ("solve", "march of the tables", "irradiance table")
    total_ms = 1e3 * sum(spent[name] for name in tables)
    yield f"| full-size tables, four orders | {total_ms:.0f} |"
    yield f"The thesis took {THESIS_MS:.0f} ms on its graphics card."
    yield "| all light of four orders against converged | mean | 99th percentile |\n|---|---:|---:|"
    for band, (mean, most) in table_errors().items():
        yield f"| {band} | {mean:.4f} | {most:.4f} |"
    start_s, compiled_s, cached_s = first_calls()
    yield f"numba starts in {start_s * 1e3:.0f} ms; then the first tables take"
    yield f"{cached_s * 1e3:.0f} ms from the compile cache, {compiled_s:.1f} s with compilation"
    yield from _single_rays()


def _single_rays() -> Iterator[str]:
    """What light scattered once in the tables misses of the exact rule, by day."""
    air, sizes = Atmosphere.earth(), TableSizes(altitude=5, mu=24, nu=6, mu_s=12)
    state = node_states(air, sizes, "2017")
    ours = _table_radiance(solve(air, orders=1), state, sizes)
    h, mu, mu_s, nu = np.broadcast_arrays(state.altitude_m, state.mu, state.mu_s, state.nu)
    exact = single_scattering(air, h, mu, mu_s, nu, samples=24)
    day = (mu_s > 0.1) & (h < air.top_altitude_m)
    # Along the horizon only the table knows whether a ray stops at the ground.
    day[:, [0, -1]] = False
    error = np.abs(ours - exact)[day] / np.maximum(exact, _FLOOR * exact.max())[day]
    yield f"light scattered once, by day: mean error {error.mean():.4f}"


def _table_radiance(
    field: SourceField, state: State, sizes: TableSizes | None = None
) -> FloatArray:
    scattering, mie = march_tables(field, sizes)
    nu = np.broadcast_to(state.nu, scattering.shape[:-1])[..., None]
    return np.asarray(scattering * rayleigh_phase(nu) + mie * mie_phase(field.atmosphere, nu))


def _sky_view_rays(mu_s: float) -> tuple[FloatArray, FloatArray]:
    rows, columns = SKY_VIEW
    mu = np.repeat(np.linspace(-1.0, 1.0, rows), columns)
    turn = np.tile(np.linspace(0.0, np.pi, columns), rows)
    return mu, mu * mu_s + np.sqrt((1.0 - mu**2) * (1.0 - mu_s**2)) * np.cos(turn)


def _least(run: Callable[[], object], rounds: int) -> float:
    least = float("inf")
    for _ in range(rounds):
        start = time.process_time()
        run()
        least = min(least, time.process_time() - start)
    return least


if __name__ == "__main__":
    for text in report():
        print(text, flush=True)
