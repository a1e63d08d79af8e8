"""Single scattering by the textbook rules of Galaj and Wojciechowski 2019, and converged.

Without quirks it is `bruneton_sky.single_scattering` in the study's air, by any of its rules.
With `Quirks` it repeats the deviations of the authors' program from the integral, one
by one or all together.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from bruneton_sky.geometry import altitude_along, distance_to_top
from bruneton_sky.optical_path import optical_depth_to_top
from bruneton_sky.phase import rayleigh_phase
from bruneton_sky.published.classical_rules import accumulate, checked_intervals, rule_nodes
from bruneton_sky.published.single_scattering import Rule, single_scattering

from vrut_lite.atmosphere.aerosol import cornette_shanks_phase
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.framework.atmosphere import STUDY, StudyAtmosphere
from vrut_lite_lab.study.models.model import cosines

TITLES: dict[str, str] = {
    "gauss-legendre": "Gauss-Legendre",
    "midpoint": "Midpoint",
    "trapezoid": "Trapezoid",
    "simpson": "Simpson",
}
# At 16 nodes the rule errs by 1e-9; twice as many leave room for lower suns.
_CONVERGED_NODES = 32
# How many numbers a part of the directions may need: 64 MB of each array.
_LARGEST_ARRAY = 8_000_000


class Quirks(NamedTuple):
    """Faults of the published program, all of them by default.

    Attributes:
        whole_share: the optical depth up to a node holds the node's whole own share.
        eye_sun_length: the path from every node to the sun has the length that it would have
            under the sun's zenith angle at the eye: it ends short of the top of the air or
            beyond it.
        white_aerosol: aerosol scatters all that it extinguishes: its albedo is 1 and not 0.8.
    """

    whole_share: bool = True
    eye_sun_length: bool = True
    white_aerosol: bool = True


PUBLISHED = Quirks()


@dataclass(frozen=True, eq=False)
class SingleScattering:
    """The sky of light scattered once, without the ground's.

    Args:
        rule: `gauss-legendre`, `midpoint`, `trapezoid` or `simpson`.
        samples: nodes of `gauss-legendre`, else intervals (view, light).
        quirks: the published program's deviations to repeat; only for the textbook rules.

    Raises:
        ValueError: from `sky_radiance`, for samples that do not suit the rule.
    """

    rule: Rule
    samples: int | tuple[int, int]
    quirks: Quirks | None = None
    air: StudyAtmosphere = STUDY

    @property
    def name(self) -> str:
        """As in `trapezoid-16x8`, `gauss-legendre-8`, `trapezoid-8x128-published`."""
        counts = "x".join(str(n) for n in np.atleast_1d(self.samples))
        return "-".join([self.rule, counts, *self._words("published", "-")])

    @property
    def title(self) -> str:
        """As in `Trapezoid 16 × 8`."""
        counts = " × ".join(str(n) for n in np.atleast_1d(self.samples))
        remark = "".join(f" ({word})" for word in self._words("as published", " "))
        return f"{TITLES[self.rule]} {counts}{remark}"

    def sky_radiance(
        self,
        sun_zenith_rad: float,
        view_zenith_rad: FloatArray,
        relative_azimuth_rad: FloatArray,
    ) -> FloatArray:
        """Radiance (n, 40)."""
        mu, mu_s, nu = cosines(sun_zenith_rad, view_zenith_rad, relative_azimuth_rad)
        nodes = int(np.atleast_1d(self.samples)[0]) + 1
        parts = max(1, int(np.ceil(nodes * nu.size * nu.itemsize * 5 / _LARGEST_ARRAY)))
        pairs = zip(np.array_split(mu, parts), np.array_split(nu, parts), strict=True)
        return np.concatenate([self._some(some_mu, mu_s, some_nu) for some_mu, some_nu in pairs])

    def sun_irradiance(self, sun_zenith_rad: float) -> FloatArray:
        """Irradiance (40,) by the exact optical depth; none from a sun below the horizon.

        The published program has no more than a placeholder for it.
        """
        return sun_irradiance(self.air, sun_zenith_rad)

    def _some(self, mu: FloatArray, mu_s: float, nu: FloatArray) -> FloatArray:
        if self.quirks is None:
            air = self.air.bruneton_atmosphere()
            return single_scattering(air, 0.0, mu, mu_s, nu, self.rule, self.samples)
        intervals = checked_intervals(self.rule, self.samples)
        return quirky_radiance(self.air, mu, mu_s, nu, self.rule, intervals, self.quirks)

    def _words(self, all_of_them: str, space: str) -> list[str]:
        """The quirks in a word, or in one for each."""
        if self.quirks is None:
            return []
        if self.quirks == PUBLISHED:
            return [all_of_them]
        on = (name for name, is_on in self.quirks._asdict().items() if is_on)
        return [name.replace("_", space) for name in on]


def converged() -> SingleScattering:
    """Single scattering without an error of quadrature."""
    return SingleScattering("gauss-legendre", _CONVERGED_NODES)


def sun_irradiance(air: StudyAtmosphere, sun_zenith_rad: float) -> FloatArray:
    """Irradiance (40,) of a plane at sea level that faces the sun, W m^-2 nm^-1."""
    if sun_zenith_rad > np.pi / 2:
        return np.zeros(air.solar_irradiance.size)
    depth = optical_depth_to_top(air.bruneton_atmosphere(), 0.0, float(np.cos(sun_zenith_rad)))
    return np.asarray(air.solar_irradiance * np.exp(-depth))


def quirky_radiance(
    air: StudyAtmosphere,
    mu: FloatArray,
    mu_s: float,
    nu: FloatArray,
    rule: str,
    intervals: tuple[int, int],
    quirks: Quirks,
) -> FloatArray:
    """Radiance (n, 40) at sea level by a textbook rule, with some or all of the quirks."""
    fraction, weight = rule_nodes(rule, intervals[0])
    ground, top = air.ground_radius_m, air.top_altitude_m
    length = distance_to_top(ground, top, 0.0, mu)[:, None]
    distance = length * fraction
    altitude = np.maximum(altitude_along(ground, np.zeros_like(length), mu[:, None], distance), 0.0)
    density = _densities(air, altitude)
    amount = density * length * weight
    view_path = (
        amount.cumsum(-1)
        if quirks.whole_share
        else accumulate(rule, density, length / intervals[0])
    )
    mu_s_there = (ground * mu_s + distance * nu[:, None]) / (ground + altitude)
    metres = distance_to_top(ground, top, altitude, mu_s if quirks.eye_sun_length else mu_s_there)
    sun_rule = rule_nodes(rule, intervals[1])
    scattered = np.zeros((2, mu.size, air.solar_irradiance.size))
    for node in range(fraction.size):
        there = altitude[:, node], mu_s_there[:, node], metres[:, node]
        rayleigh_m, mie_m = view_path[..., node] + _light_path(air, *there, sun_rule)
        depth = rayleigh_m[:, None] * air.rayleigh_scattering + mie_m[:, None] * air.mie_extinction
        scattered += amount[..., node, None] * np.exp(-depth)
    aerosol = air.mie_extinction if quirks.white_aerosol else air.mie_scattering
    rayleigh, mie = rayleigh_phase(nu)[:, None], cornette_shanks_phase(nu, air.mie_g)[:, None]
    source = scattered[0] * air.rayleigh_scattering * rayleigh + scattered[1] * aerosol * mie
    return np.asarray(source * air.solar_irradiance)


def _light_path(
    air: StudyAtmosphere,
    altitude_m: FloatArray,
    mu_s: FloatArray,
    length_m: FloatArray,
    nodes_and_weights: tuple[FloatArray, FloatArray],
) -> FloatArray:
    """Optical paths (2, n) in m of lengths (n,) toward the sun; infinite through the ground."""
    fraction, weight = nodes_and_weights
    distance = length_m[:, None] * fraction
    altitude = altitude_along(air.ground_radius_m, altitude_m[:, None], mu_s[:, None], distance)
    path = _densities(air, np.maximum(altitude, 0.0)) @ weight * length_m
    return np.where((altitude < 0.0).any(axis=-1), np.inf, path)


def _densities(air: StudyAtmosphere, altitude_m: FloatArray) -> FloatArray:
    """Relative densities (2, ...) of molecules and aerosol."""
    heights = air.rayleigh_scale_height_m, air.mie_scale_height_m
    return np.stack([np.exp(-altitude_m / height) for height in heights])
