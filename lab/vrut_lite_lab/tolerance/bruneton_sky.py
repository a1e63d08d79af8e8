"""The sizes that the Bruneton sky chooses by the tolerance, and the airs that they are measured in.

Haze of the default type is drawn evenly in the logarithm of turbidity from 1 to 10, albedo from 0
to 1; a third of the suns stand between 6 degrees below the horizon and the horizon, the others
anywhere above; half of the observers stand on the ground, the others are up to 12 km high. The
truth is solved with converged sizes (half a minute of CPU for an air and all its views), light
scattered once exactly.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from bruneton_sky.geometry import horizon_mu
from bruneton_sky.ray_light import scattered_once
from bruneton_sky.settings import BrunetonSkySettings, atmosphere_of
from bruneton_sky.sky_view import SkyView, fill_cube, sky_view
from bruneton_sky.solver import SolverSizes, SourceField, multiple_scattering, solve
from bruneton_sky.solver_job import solve_air
from bruneton_sky.solver_rungs import SOLVER_RUNGS, counted_work, rung_sizes
from bruneton_sky.tolerance import FRONTS, TABLES, BrunetonQuality, quality_for
from bruneton_sky.unseen_moves import sun_step_rad
from numpy.typing import NDArray

from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.panorama import sample_sky
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.tolerance.knobs import Knob, ToleranceKnobs, Truth, picture_error

# Directions are the texels of so small a cube that lie above the horizon.
EDGE = 20
VIEWS = 15
CUBE_SIZES = (64, 96, 128, 192, 256, 384, 512)
_HIGHEST_M, _LOWEST_M = 12_000.0, 10.0
_TRUE_ORDERS, _TRUE_TOLERANCE, _TRUE_NODES = 40, 1e-3, 48
# Sizes of the truth and of the rays by which a solution is looked at: by usual rays (12 bins) deep
# twilight errs by 0.5 to 0.7 %, by these 0.04 %.
_TRUE_SIZES = SolverSizes.converged()
# Edge of the cube map that smaller ones are compared with, and how many directions are looked up.
_TRUE_SIZE, _LOOK_UPS = 1024, 4096
# Rays of a usual table, and steps along each: a table's work is rays times steps.
_USUAL_ROWS, _USUAL_STEPS = 80, 48
_SEEDS = (1, 2)
_BLACK = np.zeros(3)


class TrialView(NamedTuple):
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


class ViewedAtmosphere(NamedTuple):
    """An atmosphere, and the views that it is seen from."""

    settings: BrunetonSkySettings
    views: tuple[TrialView, ...]


_TIMED = TrialView(0.0, 0.8, 0.3)


def two_sets(pictures: int) -> tuple[list[ViewedAtmosphere], list[ViewedAtmosphere]]:
    """Airs with so many views in each set: drawn at random, and dealt in turn by their haze."""
    count = -(-pictures // VIEWS)
    drawn = [air for seed in _SEEDS for air in random_airs(count, seed)]
    drawn.sort(key=lambda air: air.settings.turbidity or 0.0)
    return drawn[::2], drawn[1::2]


def random_airs(count: int, seed: int) -> list[ViewedAtmosphere]:
    """So many airs, always the same for a seed."""
    rng = np.random.default_rng(seed)
    return [_air(rng) for _ in range(count)]


def _air(rng: np.random.Generator) -> ViewedAtmosphere:
    settings = BrunetonSkySettings(
        turbidity=float(10.0 ** rng.uniform(0.0, 1.0)),
        albedo=float(rng.uniform(0.0, 1.0)),
    )
    return ViewedAtmosphere(settings, tuple(_view(rng, index) for index in range(VIEWS)))


def _view(rng: np.random.Generator, index: int) -> TrialView:
    low, high = (-6.0, 0.0) if index % 3 == 0 else (0.0, 90.0)
    aloft = 10.0 ** rng.uniform(np.log10(_LOWEST_M), np.log10(_HIGHEST_M))
    elevation_rad = float(np.radians(rng.uniform(low, high)))
    azimuth_rad = float(rng.uniform(-np.pi, np.pi))
    return TrialView(float(aloft) if index % 2 else 0.0, elevation_rad, azimuth_rad)


def true_skies(air: ViewedAtmosphere) -> Truth:
    """Radiance (n, 3) of each view's sky texels, by converged sizes."""
    field = solve(atmosphere_of(air.settings), _TRUE_ORDERS, _TRUE_SIZES, True, _TRUE_TOLERANCE)
    return [evaluated(field, air, view) for view in air.views]


def evaluated(field: SourceField, air: ViewedAtmosphere, view: TrialView) -> FloatArray:
    """Radiance (n, 3) of a view's sky texels, each ray by itself: light scattered once by the
    exact rule, light scattered more from the field's source by many bins, whatever its own."""
    rays = {"steps": _TRUE_SIZES.steps, "multiple_bins": _TRUE_SIZES.multiple_bins}
    field = replace(field, sizes=replace(field.sizes, **rays))
    directions = texel_directions(EDGE)[_sky_texels(air, view)]
    order = np.argsort(directions[:, 1], kind="stable")
    mu, mu_s = directions[order, 1], float(view.sun[1])
    nu = np.clip(directions[order] @ view.sun, -1.0, 1.0)
    once = scattered_once(field, view.height_m, mu, mu_s, nu, _TRUE_NODES)
    more = multiple_scattering(field, view.height_m, mu, mu_s, nu)
    sky = np.empty((len(mu), 3))
    sky[order] = rgb_from_spectrum(once + more, field.atmosphere.wavelength_nm, 3.0)
    return np.maximum(sky, 0.0)


def _sky_texels(air: ViewedAtmosphere, view: TrialView) -> NDArray[np.bool_]:
    """Which texels (6, EDGE, EDGE) look above the ground's horizon."""
    radius_m = atmosphere_of(air.settings).ground_radius_m
    horizon = float(horizon_mu(radius_m, view.height_m))
    return np.asarray(texel_directions(EDGE)[..., 1] > horizon)


def air_errors(
    air: ViewedAtmosphere, skies: Sequence[FloatArray], quality: BrunetonQuality
) -> list[float]:
    """Error of each view at this quality, with the largest move of the sun that is left out."""
    field = solve_air(atmosphere_of(air.settings), rung=quality.solver)
    return [
        picture_error(_shown(field, air, view, quality), sky)
        for view, sky in zip(air.views, skies, strict=True)
    ]


def _shown(
    field: SourceField, air: ViewedAtmosphere, view: TrialView, quality: BrunetonQuality
) -> NDArray[np.floating]:
    """The shown sky (n, 3): looked up in the cube map; from aloft, in the table."""
    g = field.atmosphere.mie_g
    strayed = view._replace(
        elevation_rad=view.elevation_rad + sun_step_rad(view.elevation_rad, g, quality.sun_change)
    )
    table: SkyView = sky_view(field, view.height_m, strayed.sun, TABLES[quality.table])
    texels = _sky_texels(air, view)
    if view.height_m > 0.0:
        return fill_cube(table, EDGE, _BLACK)[texels]
    directions = texel_directions(EDGE)[texels]
    return sample_sky(fill_cube(table, quality.cube_size, _BLACK), directions)


def _solver_errors(air: ViewedAtmosphere, skies: Truth) -> FloatArray:
    atmosphere = atmosphere_of(air.settings)
    fields = [solve_air(atmosphere, rung=rung) for rung in SOLVER_RUNGS]
    return np.array(
        [
            [picture_error(evaluated(field, air, view), sky) for field in fields]
            for view, sky in zip(air.views, skies, strict=True)
        ]
    )


def _table_errors(air: ViewedAtmosphere, _skies: Truth) -> FloatArray:
    """Against the same solution looked at ray by ray."""
    field = _usual(air.settings)
    errors = []
    for view in air.views:
        exact, texels = evaluated(field, air, view), _sky_texels(air, view)
        tables = (sky_view(field, view.height_m, view.sun, finer) for finer in TABLES.values())
        errors.append(
            [picture_error(fill_cube(table, EDGE, _BLACK)[texels], exact) for table in tables]
        )
    return np.array(errors)


def _cube_errors(air: ViewedAtmosphere, _skies: Truth) -> FloatArray:
    """Of look-ups between texels above the level, in every third view, against a fine map."""
    field, directions = _usual(air.settings), texel_directions(_TRUE_SIZE)
    chosen = np.random.default_rng(0).choice(
        np.flatnonzero(directions[..., 1].ravel() > 0.0), _LOOK_UPS, replace=False
    )
    looked = directions.reshape(-1, 3)[chosen]
    errors = []
    for view in air.views[::3]:
        table = sky_view(field, view.height_m, view.sun)
        exact = fill_cube(table, _TRUE_SIZE, _BLACK).reshape(-1, 3)[chosen]
        maps = (fill_cube(table, size, _BLACK) for size in CUBE_SIZES)
        errors.append([picture_error(sample_sky(cube, looked), exact) for cube in maps])
    return np.array(errors)


@lru_cache(maxsize=2)
def _usual(settings: BrunetonSkySettings) -> SourceField:
    return solve_air(atmosphere_of(settings), rung="usual")


def _table_work(name: str) -> float:
    return float(round(_USUAL_ROWS * TABLES[name]) * round(_USUAL_STEPS * TABLES[name]))


@lru_cache(maxsize=1)
def _timed_view() -> SkyView:
    return _timed_table(1.0)


def _timed_table(finer: float) -> SkyView:
    return sky_view(_usual(BrunetonSkySettings()), _TIMED.height_m, _TIMED.sun, finer)


_TIMED_AIR = atmosphere_of(BrunetonSkySettings())
KNOBS = ToleranceKnobs(
    fronts=FRONTS,
    knobs={
        "solver": Knob(
            SOLVER_RUNGS,
            _solver_errors,
            lambda rung: counted_work(rung_sizes(_TIMED_AIR, rung)),
            lambda rung: solve_air(_TIMED_AIR, rung=rung),
        ),
        "table": Knob(
            tuple(TABLES), _table_errors, _table_work, lambda name: _timed_table(TABLES[name])
        ),
        "cube_size": Knob(
            CUBE_SIZES,
            _cube_errors,
            lambda size: 6.0 * size * size,
            lambda size: fill_cube(_timed_view(), size, _BLACK),
        ),
    },
    samples=two_sets,
    truth=true_skies,
    picture_errors=lambda air, skies, tolerance: air_errors(air, skies, quality_for(tolerance)),
    # A solution to 1 % takes seconds, and there are twenty of them.
    tolerances=(0.3, 0.1, 0.05, 0.03, 0.02, 0.01),
)
