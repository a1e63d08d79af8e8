"""Rays through a sphere of air, in altitudes: no difference of large squares is ever formed.

The state of a point is its altitude above the ground and the cosine mu of its zenith angle.
A ray is described by y, where y^2 is the altitude above the ray's perigee and y is negative
where the ray descends: the altitude on the ray is perigee + y^2, the distance from the
perigee y sqrt(y^2 + 2 p), the path length ds = 2 (y^2 + p) / sqrt(y^2 + 2 p) dy. An
exponential atmosphere is then an exact Gaussian in y, at the horizon as at the zenith.

All functions broadcast. Altitudes and distances are in metres.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.numeric_types import FloatArray


class Ray(NamedTuple):
    """A ray from `altitude_m` in the direction with cosine `mu`.

    `perigee_radius_m` is the distance of its line from the planet's centre,
    `perigee_altitude_m` the altitude there, `y` the start in the units explained above.
    """

    altitude_m: FloatArray
    mu: FloatArray
    radius_m: FloatArray
    perigee_radius_m: FloatArray
    perigee_altitude_m: FloatArray
    y: FloatArray

    def hits_ground(self) -> NDArray[np.bool_]:
        """Whether the ray, followed forward, meets the ground."""
        return (self.mu < 0) & (self.perigee_altitude_m <= 0)


class RaysInAir(NamedTuple):
    """Rays (n,) by the state where they are first inside the air.

    `entry_m` is how far that is from where they start, 0 inside the air; the other values of a ray
    that misses the air are undefined.
    """

    altitude_m: FloatArray
    mu: FloatArray
    mu_s: FloatArray
    entry_m: FloatArray
    misses: NDArray[np.bool_]


def make_ray(ground_radius_m: float, altitude_m: ArrayLike, mu: ArrayLike) -> Ray:
    """The ray from an altitude in a direction, with its perigee."""
    altitude = np.asarray(altitude_m, dtype=float)
    cosine = np.asarray(mu, dtype=float)
    radius = ground_radius_m + altitude
    sine = np.sqrt((1.0 - cosine) * (1.0 + cosine))
    # r - p, without cancellation: r (1 - sine) = r mu^2 / (1 + sine).
    y_squared = radius * cosine * cosine / (1.0 + sine)
    return Ray(
        altitude,
        cosine,
        radius,
        radius * sine,
        altitude - y_squared,
        np.copysign(np.sqrt(y_squared), cosine),
    )


def y_at_top(ray: Ray, top_altitude_m: float) -> FloatArray:
    """y where the ray leaves the atmosphere, as if there were no ground."""
    # top - perigee, without cancellation for an observer near the top.
    y = np.sqrt(np.maximum(top_altitude_m - ray.altitude_m + ray.y * ray.y, 0.0))
    # Rounding may put the end a hair before the start of a ray of no length.
    return np.maximum(y, ray.y)


def end_of_ray(ray: Ray, top_altitude_m: float) -> tuple[FloatArray, FloatArray]:
    """Altitude and y where the ray leaves the atmosphere or meets the ground."""
    hits = ray.hits_ground()
    y_ground = np.maximum(-np.sqrt(np.maximum(-ray.perigee_altitude_m, 0.0)), ray.y)
    y = np.where(hits, y_ground, y_at_top(ray, top_altitude_m))
    return np.where(hits, 0.0, top_altitude_m), y


def y_along(ray: Ray, distance_m: ArrayLike) -> FloatArray:
    """y (...,) after a distance along the ray; see above."""
    along = ray.radius_m * ray.mu + np.asarray(distance_m, dtype=float)
    p = ray.perigee_radius_m
    return along / np.sqrt(np.maximum(p + np.sqrt(p * p + along * along), 1e-300))


def horizon_mu(ground_radius_m: float, altitude_m: ArrayLike) -> FloatArray:
    """Cosine of the zenith angle at which the ground begins."""
    h = np.asarray(altitude_m, dtype=float)
    return -np.sqrt(h * (2.0 * ground_radius_m + h)) / (ground_radius_m + h)


def distance_to_top(
    ground_radius_m: float, top_altitude_m: float, altitude_m: ArrayLike, mu: ArrayLike
) -> FloatArray:
    """Distance along a ray to the top of the atmosphere."""
    h = np.asarray(altitude_m, dtype=float)
    b = (ground_radius_m + h) * np.asarray(mu, dtype=float)
    c = (top_altitude_m - h) * (2.0 * ground_radius_m + top_altitude_m + h)
    # A node of a ray that ends at the top may lie above it by a rounding.
    root = np.sqrt(np.maximum(b * b + c, 0.0))
    far = root + np.abs(b)
    near = np.divide(c, far, out=np.zeros_like(far), where=far > 0)
    return np.where(b > 0, near, far)


def distance_to_ground(ground_radius_m: float, altitude_m: ArrayLike, mu: ArrayLike) -> FloatArray:
    """Distance along a ray that meets the ground; meaningless for one that does not."""
    h = np.asarray(altitude_m, dtype=float)
    b = (ground_radius_m + h) * np.asarray(mu, dtype=float)
    c = h * (2.0 * ground_radius_m + h)
    far = np.abs(b) + np.sqrt(np.maximum(b * b - c, 0.0))
    return np.divide(c, far, out=np.zeros_like(far), where=far > 0)


def altitude_along(
    ground_radius_m: float, altitude_m: ArrayLike, mu: ArrayLike, distance_m: ArrayLike
) -> FloatArray:
    """Altitude after a distance along a ray."""
    h, cosine, d = (np.asarray(v, dtype=float) for v in (altitude_m, mu, distance_m))
    radius = ground_radius_m + h
    step = d * (d + 2.0 * radius * cosine)
    return h + step / (np.sqrt(step + radius * radius) + radius)


def entry_to_air(
    ground_radius_m: float, top_altitude_m: float, along_m: FloatArray, impact_m: FloatArray
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Where rays from above the atmosphere enter it.

    Args:
        along_m: (...,) r mu at the start of the ray, r the distance from the planet's centre.
        impact_m: (...,) r sqrt(1 - mu^2), the distance of the ray's line from the centre.

    Returns:
        Distance (...,) in m to the entry, cosine mu (...,) of the zenith angle there, and whether
        (...,) the ray misses the atmosphere, where the other two are undefined.
    """
    top_radius = ground_radius_m + top_altitude_m
    half_chord = np.sqrt(np.maximum((top_radius - impact_m) * (top_radius + impact_m), 0.0))
    misses = (along_m >= 0.0) | (impact_m >= top_radius)
    return np.maximum(-along_m - half_chord, 0.0), -half_chord / top_radius, misses


def rays_in_air(
    ground_radius_m: float,
    top_altitude_m: float,
    altitude_m: FloatArray,
    mu: FloatArray,
    mu_s: FloatArray,
    nu: FloatArray,
) -> RaysInAir:
    """Rays (n,) from any altitude, from where they are first inside the air."""
    outside = altitude_m > top_altitude_m
    radius, sine = ground_radius_m + altitude_m, np.sqrt((1.0 - mu) * (1.0 + mu))
    entry, entry_mu, misses = entry_to_air(
        ground_radius_m, top_altitude_m, radius * mu, radius * sine
    )
    entry = np.where(outside & ~misses, entry, 0.0)
    altitude = np.minimum(altitude_m, top_altitude_m)
    sun = np.clip((radius * mu_s + entry * nu) / (ground_radius_m + altitude), -1.0, 1.0)
    return RaysInAir(
        altitude,
        np.where(outside, entry_mu, mu),
        np.where(outside, sun, mu_s),
        entry,
        outside & misses,
    )


def in_earth_shadow(
    ground_radius_m: float | FloatArray, altitude_m: ArrayLike, mu_s: ArrayLike
) -> NDArray[np.bool_]:
    """Whether the planet hides the sun's centre from a point."""
    h, cosine = np.asarray(altitude_m, dtype=float), np.asarray(mu_s, dtype=float)
    tangent = (ground_radius_m + h) * cosine
    return (cosine < 0) & (tangent * tangent >= h * (2.0 * ground_radius_m + h))


def shadow_boundary(ray: Ray, mu_s: ArrayLike, nu: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Distances along a ray to where it crosses the edge of the planet's shadow.

    Negative without such a crossing. The edge is a cylinder along the sun's direction; crossings on
    its sunward side do not count.
    """
    sun, cosine = np.asarray(mu_s, dtype=float), np.asarray(nu, dtype=float)
    r, h = ray.radius_m, ray.altitude_m
    ground_radius = r - h
    a = (1.0 - cosine) * (1.0 + cosine)
    b = r * (ray.mu - sun * cosine)
    c = h * (r + ground_radius) - (r * sun) ** 2
    a, b, c = np.broadcast_arrays(a, b, c)
    discriminant = b * b - a * c
    q = -(b + np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), b))
    none = np.full(q.shape, -1.0)
    crossings = []
    for numerator, denominator in ((q, a), (c, q)):
        usable = (discriminant > 0) & (np.abs(denominator) > np.abs(numerator) * 1e-9)
        s = np.divide(numerator, denominator, out=none.copy(), where=usable)
        behind_planet = r * sun + s * cosine < 0
        crossings.append(np.where((s > 0) & behind_planet, s, -1.0))
    return crossings[0], crossings[1]
