"""The Prague sky of Wilkie et al. 2021, from the file of coefficients that its authors publish.

The file is brought by the user; PRAGUE_SKY names it. For each visibility, albedo, altitude, height
of the sun and channel it holds a sum of products, of a piecewise linear function of the angle from
the sun and one of the angle from the zenith (from the Earth's shadow, the sun below 0), times a
function of the zenith angle.
"""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vrut_lite.geometry.colour import integration_matrix
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.peers.airs import GROUND_ALBEDO, continental
from vrut_lite_lab.study.peers.ours import cpu
from vrut_lite_lab.study.peers.peer import NotHere, PeerShot
from vrut_lite_lab.study.peers.views import HEIGHT, SkyViewpoint, of_picture

VARIABLE = "PRAGUE_SKY"
_GROUND_RADIUS_M, _EYE_M = 6_378_000.0, 50.0
# Contrast at which a black thing is lost in haze (Koschmieder), at 550 nm.
_KOSCHMIEDER, _NM = 3.912, 550.0


class PragueSky(NamedTuple):
    """The content of a file.

    Attributes:
        visibility_km, albedo, altitude_m, sun_deg: nodes of what it was computed for.
        channel_nm: lower edges (C + 1,) of the channels, and the last one's upper edge.
        sun_rad, zenith_rad, emphasis_rad: nodes of the functions.
        values: a field for each function, of shape (visibilities, albedos, altitudes, suns, C).
    """

    visibility_km: FloatArray
    albedo: FloatArray
    altitude_m: FloatArray
    sun_deg: FloatArray
    channel_nm: FloatArray
    sun_rad: FloatArray
    zenith_rad: FloatArray
    emphasis_rad: FloatArray
    values: NDArray[np.void]

    def radiance(
        self,
        directions: FloatArray,
        sun_direction: Sequence[float],
        altitude_m: float,
        visibility_km: float,
        albedo: float,
    ) -> FloatArray:
        """Radiance (..., C) that comes to an eye from unit directions (..., 3), in axes with y up.

        What lies outside the nodes is that of the nearest.
        """
        sun = np.asarray(sun_direction, float)
        sun_rad = float(np.arcsin(sun[1]))
        height_m = altitude_m + _EYE_M
        away_m = _GROUND_RADIUS_M + height_m
        # Directions are lifted so that the horizon lies level.
        lift = np.sqrt(away_m**2 - _GROUND_RADIUS_M**2) / away_m
        lifted = directions + np.array([0.0, lift, 0.0])
        lifted /= np.linalg.norm(lifted, axis=-1, keepdims=True)
        zenith = _angle(lifted[..., 1])
        level = np.array([sun[0], 0.0, sun[2]]) / max(np.hypot(sun[0], sun[2]), 1e-12)
        across_rad = sun_rad + np.pi / 2
        shadow = np.cos(across_rad) * level + np.array([0.0, np.sin(across_rad), 0.0])
        along = _angle(lifted @ shadow) if sun_rad < 0.0 else zenith
        at_sun = _between(_angle(directions @ sun), self.sun_rad)
        at_zenith = _between(along, self.zenith_rad)
        at_emphasis = _between(zenith, self.emphasis_rad)
        found = np.zeros((*directions.shape[:-1], len(self.channel_nm) - 1))
        wanted = visibility_km, albedo, height_m, float(np.degrees(sun_rad))
        for share, corner in self._corners(wanted):
            for channel, values in enumerate(corner):
                terms = values["terms"]
                sums = np.zeros(directions.shape[:-1])
                for term in terms:
                    across = term["zenith"].astype(float) / term["scale"]
                    sums += _at(term["sun"].astype(float), at_sun) * _at(across, at_zenith)
                sums *= _at(values["emphasis"].astype(float), at_emphasis)
                found[..., channel] += share * np.maximum(sums, 0.0)
        return found

    def to_rgb(self) -> FloatArray:
        """Matrix (C, 3) to linear sRGB; a channel is even."""
        fine_nm = np.arange(self.channel_nm[0], self.channel_nm[-1]) + 0.5
        which = np.searchsorted(self.channel_nm, fine_nm, "right") - 1
        return (which == np.arange(len(self.channel_nm) - 1)[:, None]) @ integration_matrix(
            tuple(fine_nm.tolist())
        )

    def _corners(self, wanted: tuple[float, ...]) -> Iterator[tuple[float, NDArray[np.void]]]:
        """Shares and channels of the nodes around a visibility, albedo, altitude and sun."""
        nodes = self.visibility_km, self.albedo, self.altitude_m, self.sun_deg
        pairs = [_between(np.array(v), n) for v, n in zip(wanted, nodes, strict=True)]
        for upper in np.ndindex(2, 2, 2, 2):
            shares = [f if u else 1.0 - f for u, (_, f) in zip(upper, pairs, strict=True)]
            share = float(np.prod(shares))
            if share > 0.0:
                at = tuple(int(i) + u for u, (i, _) in zip(upper, pairs, strict=True))
                yield share, self.values[at]


def read_prague(path: Path) -> PragueSky:
    """The file's part of radiance; what follows it, transmittance and polarisation, is not read.

    Raises:
        NotHere: there is no such file, or it is another.
    """
    try:
        with path.open("rb") as file:

            def whole() -> int:
                (value,) = np.fromfile(file, "<i4", 1)
                if not 1 <= value <= 10_000:
                    raise ValueError(value)
                return int(value)

            def nodes() -> FloatArray:
                return np.fromfile(file, "<f8", whole())

            visibility, albedo, altitude, sun = (nodes() for _ in range(4))
            channels = whole()
            start_nm, width_nm = np.fromfile(file, "<f8", 2)
            rank = whole()
            by_sun, by_zenith, emphasis = nodes(), nodes(), nodes()
            term = [
                ("sun", "<f2", len(by_sun)),
                ("scale", "<f8"),
                ("zenith", "<f2", len(by_zenith)),
            ]
            kind = np.dtype([("terms", term, rank), ("emphasis", "<f2", len(emphasis))])
            shape = len(visibility), len(albedo), len(altitude), len(sun), channels
            values = np.memmap(file, kind, "r", file.tell(), shape)
    except OSError as error:
        raise NotHere(f"{VARIABLE} cannot be read: {error.strerror or error}") from None
    except ValueError:
        raise NotHere(f"{VARIABLE} is no file of the Prague sky's coefficients") from None
    edges_nm = start_nm + width_nm * np.arange(channels + 1)
    nodes_rad = by_sun, by_zenith, emphasis
    return PragueSky(visibility, albedo, altitude, sun, edges_nm, *nodes_rad, values)


@dataclass
class Prague:
    """The model at the visibility of the air that all models of a haze are compared in."""

    air: str = "continental"
    name: str = "prague"
    title: str = "Prague 2021, its coefficients read here"
    cannot: str = "a sun below -4.2°; above 15 km; ozone, other aerosols, layers"
    grey: bool = False

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """As far as the file goes."""
        if not os.environ.get(VARIABLE):
            raise NotHere(
                f"its coefficients are not on the registries: let {VARIABLE} name the file "
                "(cgg.mff.cuni.cz/publications/skymodel-2021)"
            )
        sky = read_prague(Path(os.environ[VARIABLE]))
        air = continental()
        at = int(np.argmin(np.abs(np.array(air.wavelength_nm) - _NM)))
        per_km = 1000.0 * (air.rayleigh_scattering[at] + air.mie_extinction[at])
        directions, to_rgb = lat_long_directions(HEIGHT), sky.to_rgb()

        def picture(view: SkyViewpoint) -> FloatArray:
            light = partial(sky.radiance, directions, view.sun_direction, view.altitude_m)
            return light(_KOSCHMIEDER / per_km, GROUND_ALBEDO) @ to_rgb

        found = {}
        for view in views:
            if view.sun_deg >= sky.sun_deg[0] and view.altitude_m <= sky.altitude_m[-1]:
                seen, spent_s = cpu(partial(picture, view))
                found[view] = PeerShot(of_picture(seen, view), spent_s)
        return found

    def prepared_s(self) -> float:
        """Nothing."""
        return 0.0


def _angle(cosine: FloatArray) -> FloatArray:
    return np.arccos(np.clip(cosine, -1.0, 1.0))


def _between(value: FloatArray, nodes: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
    """The node before each value, and the share of the way to the next."""
    if len(nodes) == 1:
        return np.zeros(value.shape, np.intp), np.zeros(value.shape)
    inside = np.clip(value, nodes[0], nodes[-1])
    index = np.clip(np.searchsorted(nodes, inside, "right") - 1, 0, len(nodes) - 2)
    return index, (inside - nodes[index]) / (nodes[index + 1] - nodes[index])


def _at(values: FloatArray, place: tuple[NDArray[np.intp], FloatArray]) -> FloatArray:
    index, share = place
    return values[index] + share * (values[index + 1] - values[index])
