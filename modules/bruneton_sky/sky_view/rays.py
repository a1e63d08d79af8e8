"""Where a sky-view table looks: its rows and columns as rays through the air.

Rows above the ground's horizon are mu = mu_h + (mu_top - mu_h) u, those below
mu_h - (1 + mu_h) x^2, with x uniform in [0, 1]: dense toward the horizon on both sides, where
radiance changes fast. mu_top is the zenith for an observer inside the air, and the edge of the
air for one above it, whose rays start where they enter. Toward mu_top rows are dense too:

    u = x^2 / b up to x = b, and 1 - (1 - x)^2 / (1 - b) above it.

Radiance is smooth in the zenith angle, so that rows even in mu would be 13 degrees apart about
the zenith and 2 % wrong between them: inside the air b is 0.85. The limb changes at both ends
alike: from above b is a half. Columns are t = sin(phi / 2), uniform in [0, 1], dense toward the
sun's azimuth; the other half of the sky is its mirror image.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.geometry import entry_to_air
from vrut_lite.numeric_types import FloatArray

# Where rows begin to be dense toward mu_top: b above; the shader has them too (sky_view.glsl).
TURN_INSIDE, TURN_OUTSIDE = 0.85, 0.5


class SkyViewRays(NamedTuple):
    """Rays by row (n,) and column (c,).

    `altitude_m`, `mu`: where and how a ray starts in the air. `hits`: whether it ends on the
    ground. `mu_s`, `nu` (n, c): cosines of the sun's zenith angle at the start of the ray and
    of the angle between ray and sun. `depth` (2,): 1 + mu of the ground's horizon and of mu_top,
    for the observer.
    """

    altitude_m: FloatArray
    mu: FloatArray
    hits: NDArray[np.bool_]
    mu_s: FloatArray
    nu: FloatArray
    depth: FloatArray


def table_rows(
    atmosphere: Atmosphere,
    altitude_m: float,
    mu_s: float,
    above: int,
    below: int,
    columns: int,
) -> SkyViewRays:
    """The rays of a table with `above` and `below` rows above and below the horizon."""
    inside = altitude_m <= atmosphere.top_altitude_m
    depth = np.array([_depth(atmosphere, 0.0, altitude_m), 2.0])
    if not inside:
        depth[1] = _depth(atmosphere, atmosphere.top_altitude_m, altitude_m)
    up, down = np.linspace(0.0, 1.0, above), np.linspace(0.0, 1.0, below) ** 2
    turn = TURN_INSIDE if inside else TURN_OUTSIDE
    up = np.where(up < turn, up**2 / turn, 1.0 - (1.0 - up) ** 2 / (1.0 - turn))
    one_plus_mu = np.concatenate([depth[0] + (depth[1] - depth[0]) * up, depth[0] * (1.0 - down)])
    hits = np.arange(above + below) >= above
    cos_phi = 1.0 - 2.0 * np.linspace(0.0, 1.0, columns) ** 2
    mu = one_plus_mu - 1.0
    sine = np.sqrt(one_plus_mu * (2.0 - one_plus_mu))
    across = sine * np.sqrt((1.0 - mu_s) * (1.0 + mu_s))
    nu = np.clip((mu * mu_s)[:, None] + across[:, None] * cos_phi, -1.0, 1.0)
    if inside:
        start = np.full(mu.shape, altitude_m)
        return SkyViewRays(start, mu, hits, np.full(nu.shape, mu_s), nu, depth)
    return _entering(atmosphere, altitude_m, sine, mu, hits, mu_s, nu, depth)


def _depth(atmosphere: Atmosphere, tangent_altitude_m: float, altitude_m: float) -> float:
    """1 + mu of the ray that descends from an altitude to graze a lower one."""
    radius = atmosphere.ground_radius_m + altitude_m
    grazed = atmosphere.ground_radius_m + tangent_altitude_m
    sine = grazed / radius
    cosine = np.sqrt((altitude_m - tangent_altitude_m) * (radius + grazed)) / radius
    return float(sine * sine / (1.0 + cosine))


def _entering(
    atmosphere: Atmosphere,
    altitude_m: float,
    sine: FloatArray,
    mu: FloatArray,
    hits: NDArray[np.bool_],
    mu_s: float,
    nu: FloatArray,
    depth: FloatArray,
) -> SkyViewRays:
    """The rays of an observer above the air, from where they enter it."""
    radius = atmosphere.ground_radius_m + altitude_m
    top_m = atmosphere.top_altitude_m
    top_radius = atmosphere.ground_radius_m + top_m
    planet = atmosphere.ground_radius_m, top_m
    distance, mu_there, _ = entry_to_air(*planet, radius * mu, radius * sine)
    mu_s_there = (radius * mu_s + distance[:, None] * nu) / top_radius
    return SkyViewRays(
        np.full(mu.shape, top_m),
        mu_there,
        hits,
        np.clip(mu_s_there, -1.0, 1.0),
        nu,
        depth,
    )
