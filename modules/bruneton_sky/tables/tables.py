"""Precomputed tables of an atmosphere's light, with their look-ups."""

import numpy as np
from numpy.typing import ArrayLike

from bruneton_sky.tables import look_ups
from bruneton_sky.tables.rays import ViewState, view_from
from vrut_lite.arguments import as_numbers, as_vectors, check_shapes
from vrut_lite.geometry.colour import rgb_from_spectrum
from vrut_lite.numeric_types import FloatArray

# Squares of shorter vectors lose digits: their direction could not be normalised.
_IN_THE_EYE_M = 1e-100
_SKYLIGHT_EXPONENT = 3.0
_UNIT_SLACK = 1e-5
# Squares of larger components overflow.
_LONGEST = 1e100
# Largest coordinate of a point.
_FARTHEST_M = 1e15


class Tables(look_ups.TableArrays):
    """The light of an atmosphere, for every observer from the ground to space and every sun.

    In every method points are (..., 3) in metres from the planet's centre, directions unit
    vectors (..., 3), `sun` points to the sun; all broadcast. Spectral results (..., C) have one
    value per wavelength. An observer less than a millionth of the radius below the ground
    stands on it; directions may be off unit length by 1e-5.

    Look-ups are cubic along mu_s, linear along the other axes. In tables of the published sizes
    that `precompute` makes on the CPU, the sky's radiance errs by 0.2 to 0.5 % rms by day and by up
    to 2.4 %, most of it left by the 8 nodes of nu, looking down also by those of mu; mu_s leaves
    little but in twilight (2 to 4 % rms, single rays 30 %). Tables of the GPU and of
    `run_pipeline` err by up to 8 %: where mu and mu_s do not allow a node's nu, their light is over
    another phase function than the look-up uses. For 0.5 % everywhere use
    `bruneton_sky.solve`.

    Raises:
        ValueError: in methods, a point or a direction is unusable.
    """

    def sky_radiance(
        self, camera_m: ArrayLike, view: ArrayLike, sun: ArrayLike, shadow_length_m: ArrayLike = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """Radiance (..., C) of the air, W m^-2 sr^-1 nm^-1, and transmittance (..., C) to space.

        Neither the sun's disc nor the ground is in it; the transmittance is 0 where the ground
        is in the way. With a shadow length, the first so many metres of the ray give no light.
        """
        seen = self._view(camera_m, view, sun)
        shadow_m = _shadow(shadow_length_m, seen)
        return look_ups.sky_radiance(self, seen, shadow_m)

    def radiance_rgb(self, camera_m: ArrayLike, view: ArrayLike, sun: ArrayLike) -> FloatArray:
        """The sky's radiance (..., 3) in linear sRGB, W m^-2 sr^-1; below 0 outside the gamut."""
        radiance, _ = self.sky_radiance(camera_m, view, sun)
        return rgb_from_spectrum(radiance, self.atmosphere.wavelength_nm, _SKYLIGHT_EXPONENT)

    def radiance_to_point(
        self,
        camera_m: ArrayLike,
        point_m: ArrayLike,
        sun: ArrayLike,
        shadow_length_m: ArrayLike = 0.0,
    ) -> tuple[FloatArray, FloatArray]:
        """Radiance (..., C) of the air before a point, and transmittance (..., C) to there.

        With a shadow length, the last so many metres before the point give no light. A point
        that the ground hides counts as the ground in front of it.
        """
        camera, point = self._point("camera_m", camera_m), _checked_point("point_m", point_m, 0.0)
        check_shapes(camera_m=camera, point_m=point)
        way = point - camera
        distance = np.linalg.norm(way, axis=-1)
        there = distance[..., None] > _IN_THE_EYE_M
        # A point at the observer has no direction: any serves.
        direction = np.divide(way, distance[..., None], out=_upward(way), where=there)
        seen = self._view(camera, direction, sun)
        shadow_m = _shadow(shadow_length_m, seen)
        return look_ups.radiance_to_point(self, seen, distance, shadow_m)

    def ground_radiance(self, camera_m: ArrayLike, view: ArrayLike, sun: ArrayLike) -> FloatArray:
        """Radiance (..., C) of the bare ground seen through the air; 0 where no ground is seen.

        The ground is level, of the atmosphere's albedo, in the light of sun and sky. The air's
        own light in front of it is `sky_radiance`.
        """
        return look_ups.ground_radiance(self, self._view(camera_m, view, sun))

    def sun_and_sky_irradiance(
        self, point_m: ArrayLike, normal: ArrayLike, sun: ArrayLike
    ) -> tuple[FloatArray, FloatArray]:
        """Irradiance (..., C) of the sun and of the sky on a surface, W m^-2 nm^-1.

        The sun's is without shadows of things. The sky's is that on a level surface times the
        share (1 + n . up) / 2 of the sky that a tilted one sees.
        """
        point = self._point("point_m", point_m)
        facing, to_sun = _checked_direction("normal", normal), _checked_direction("sun", sun)
        check_shapes(point_m=point, normal=facing, sun=to_sun)
        return look_ups.sun_and_sky_irradiance(self, point, facing, to_sun)

    def _view(self, camera_m: ArrayLike, view: ArrayLike, sun: ArrayLike) -> ViewState:
        camera = self._point("camera_m", camera_m)
        along, to_sun = _checked_direction("view", view), _checked_direction("sun", sun)
        check_shapes(camera_m=camera, view=along, sun=to_sun)
        return view_from(self.atmosphere, camera, along, to_sun)

    def _point(self, name: str, value: ArrayLike) -> FloatArray:
        return _checked_point(name, value, self.atmosphere.ground_radius_m)


def _checked_point(name: str, value: ArrayLike, lowest_radius_m: float) -> FloatArray:
    """Points (..., 3) in m; refused where not finite or deeper than a millionth of the radius."""
    point = as_vectors(name, value, _FARTHEST_M)
    radius_m = np.linalg.norm(point, axis=-1)
    if np.any(radius_m < lowest_radius_m * (1.0 - 1e-6)):
        raise ValueError(
            f"{name} must not lie below the ground, {lowest_radius_m:g} m from the centre: "
            f"not {float(np.min(radius_m)):g} m from there"
        )
    return point


def _checked_direction(name: str, value: ArrayLike) -> FloatArray:
    """Unit vectors (..., 3), exact ones made of those that are nearly so."""
    direction = as_vectors(name, value, _LONGEST)
    length = np.linalg.norm(direction, axis=-1, keepdims=True)
    wrong = np.abs(length - 1.0) > _UNIT_SLACK
    if np.any(wrong):
        raise ValueError(f"{name} must be unit vectors, not {float(length[wrong][0]):g} long")
    return direction / length


def _shadow(shadow_length_m: ArrayLike, seen: ViewState) -> FloatArray:
    """Lengths (...,) in m that broadcast against the views."""
    shadow_m = as_numbers("shadow_length_m", shadow_length_m, 0.0, _FARTHEST_M, "m")
    check_shapes(shadow_length_m=shadow_m, rays=seen.state.mu_s)
    return shadow_m


def _upward(like: FloatArray) -> FloatArray:
    return np.broadcast_to([0.0, 0.0, 1.0], like.shape).copy()
