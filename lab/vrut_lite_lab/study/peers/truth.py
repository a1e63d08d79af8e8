"""The truth of an air: a finer rung of the solver along rays; below -6 degrees Monte Carlo."""

from functools import cache
from typing import NamedTuple

import numpy as np
from bruneton_sky import Atmosphere, SolvedSky
from bruneton_sky.solver import SourceField
from bruneton_sky.solver_job import solve_air
from bruneton_sky.solver_rungs import SolverRung

from vrut_lite.geometry.colour import luminance
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.monte_carlo import monte_carlo_stokes
from vrut_lite_lab.study.peers.airs import air
from vrut_lite_lab.study.peers.peer import PeerAir
from vrut_lite_lab.study.peers.views import LOWEST_SOLVED_DEG, SkyViewpoint, rays

_PATHS = 65_536
# Of the measured rays, these are followed by Monte Carlo.
_SOME = (slice(2, None, 6), slice(4, None, 14))


class Truth(NamedTuple):
    """Linear RGB of an air.

    Attributes:
        rgb: (rows, columns, 3) at `rays(view)`, of the solver.
        some: which of them the truth is known at; all but where it is Monte Carlo.
        at_some: linear RGB there.
        noise: standard error of its luminance, relative, root mean square.
    """

    rgb: FloatArray
    some: tuple[slice, slice]
    at_some: FloatArray
    noise: float


def truth(name: str, view: SkyViewpoint, paths: int = _PATHS) -> Truth:
    """The light of an air by name at a view."""
    here = air(name)
    rgb = seen_rgb(field(here.atmosphere, "finer"), here, view)
    everywhere = (slice(None), slice(None))
    if view.sun_deg >= LOWEST_SOLVED_DEG:
        return Truth(rgb, everywhere, rgb, 0.0)
    return _by_paths(here, view, rgb, paths)


def _by_paths(here: PeerAir, view: SkyViewpoint, rgb: FloatArray, paths: int) -> Truth:
    seen = rays(view)
    mu, nu = seen.mu[_SOME], seen.nu[_SOME]
    mu_s = view.sun_direction[1]
    light, _, _ = monte_carlo_stokes(
        here.atmosphere, view.altitude_m, mu.ravel(), mu_s, nu.ravel(), paths=paths
    )
    found = (light.total(1) @ here.to_rgb).reshape(*mu.shape, 3)
    # Wavelengths of a path share its noise: it is that of the batches' luminance.
    batches = np.asarray(luminance(light.batches.sum(axis=2) @ here.to_rgb))
    noise = np.std(batches, axis=0, ddof=1) / np.sqrt(len(batches)) / np.mean(batches, axis=0)
    return Truth(rgb, _SOME, found, float(np.sqrt(np.mean(noise**2))))


@cache
def field(atmosphere: Atmosphere, rung: SolverRung) -> SourceField:
    """The solved air."""
    return solve_air(atmosphere, rung=rung)


def seen_rgb(source: SourceField, here: PeerAir, view: SkyViewpoint) -> FloatArray:
    """Linear RGB (rows, columns, 3) along `rays(view)`, without the ground's own light."""
    seen = rays(view)
    light = SolvedSky(field=source).radiance(
        view.altitude_m, seen.mu, view.sun_direction[1], seen.nu
    )
    return light @ here.to_rgb
