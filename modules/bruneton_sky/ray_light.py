"""Light along rays in float64: single scattering and the solved source function, integrated.

Each ray has the nodes of the rule "GL-y-exp" (see `quadrature`) between its perigee, the edges of
the planet's shadow and its end, with optical depths in closed form. Light scattered twice or more
is the solver's source function at the nodes times the scattering coefficient (Bruneton and Neyret
2008, equations 7 and 10).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.field_tables import table_of_field
from bruneton_sky.geometry import (
    Ray,
    altitude_along,
    distance_to_ground,
    distance_to_top,
    end_of_ray,
    make_ray,
    y_along,
)
from bruneton_sky.optical_path import optical_depth, optical_depth_to_top
from bruneton_sky.phase import (
    molecules_phase,
    molecules_polarisation,
    particles_phase,
    particles_polarisation,
)
from bruneton_sky.quadrature import sun_cosine, view_nodes
from bruneton_sky.single_scattering_kernels import fast_by_name
from bruneton_sky.solver import SourceField
from bruneton_sky.solver.between_suns import light_over_lines, sun_bend
from bruneton_sky.solver.delta_m import forward_shares
from bruneton_sky.solver.grid import SunGrid
from bruneton_sky.solver.polarisation import harmonics_at, molecules_terms, polarised_degree
from bruneton_sky.solver.wavelength_groups import LANES, dense_layer, is_thick_haze, is_veiled
from vrut_lite.numeric_types import FloatArray

SingleArray = NDArray[np.float32]
# Nodes on each segment of a ray: in clear air and haze they leave 1e-3 at most, in thick haze 1e-3.
# In fog of visibility 200 m they leave 1e-4, at 50 m up to 3 % of rays that sink slowly into it.
# Rms error with the sun 6 degrees down: 3e-3 at a stratospheric depth of 0.02, 0.026 at 0.15.
_NODES, _IN_THICK_HAZE, _BELOW_VEIL, _IN_FOG = 16, 24, 32, 64
# Sine below which a direction is vertical: rounding of its cosine makes 3e-8.
_VERTICAL_SINE = 1e-7


def light_along(
    field: SourceField,
    altitude_m: FloatArray,
    mu: FloatArray,
    mu_s: FloatArray,
    nu: FloatArray,
    distance_m: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Radiance (n, C) that the air adds along rays, and transmittance (n, C) to their ends.

    Args:
        field: the solved atmosphere.
        altitude_m: (n,) of the rays' starts, inside the atmosphere.
        mu, mu_s: cosines (n,) of the zenith angles of ray and sun at the start.
        nu: cosines (n,) of the angle between ray and sun.
        distance_m: (n,) to the rays' ends; a ray ends at the ground or at the top of the
            atmosphere at the latest.

    Returns:
        Radiance in W m^-2 sr^-1 nm^-1, without that of the ground, and transmittance.
    """
    way = _way(field.thinned, altitude_m, mu, mu_s, nu, distance_m)
    once = sum(way.scattering[name] * phase for name, phase in _phases(field, way).items())
    again = _scattered_again(field, way, source_at(field, *way.place))
    # The harmonics' sum may fall below zero by a trace where there is almost no light.
    return way.summed(once * way.sunlight + np.maximum(again, 0.0)), way.transmittance


def polarised_light_along(
    field: SourceField,
    altitude_m: FloatArray,
    mu: FloatArray,
    mu_s: FloatArray,
    nu: FloatArray,
    distance_m: FloatArray,
) -> FloatArray:
    """Q and U (2, n, C) of `light_along`, at azimuths from 0 to pi: see `solver.polarisation`.

    Arguments as for `light_along`; the field has Q and U of all orders. In the zenith and the nadir
    the plane of the view is that of the sun. Light scattered again is polarised by no more than its
    radiance at any point.
    """
    way, air = _way(field.thinned, altitude_m, mu, mu_s, nu, distance_m), field.atmosphere
    phases = _phases(field, way)
    once = way.scattering["molecules"] * phases.pop("molecules")
    once = once * molecules_polarisation(air, way.nu)[:, None]
    for name, phase in phases.items():
        made, _ = particles_polarisation(air, name, way.nu)
        once = once + way.scattering[name] * phase * made
    turns = np.stack(_plane_turns(mu, mu_s, nu))[:, way.which, None]
    polarised = _scattered_again(field, way, polarised_source_at(field, *way.place))
    radiance = _scattered_again(field, way, source_at(field, *way.place))
    length = np.hypot(*polarised)
    most = np.minimum(np.maximum(radiance, 0.0), length)
    polarised *= np.divide(most, length, out=np.zeros_like(length), where=length > 0.0)
    return np.stack([way.summed(part) for part in turns * once * way.sunlight + polarised])


class _Way(NamedTuple):
    """Nodes (m,) of all rays (n,), in order.

    `which`: the node's ray. `altitude_m`, `mu`, `mu_s`: of the ray and of the sun there; `nu`.
    `scattering`: coefficients (m, C) in 1/m by name; `sunlight` (m, C): irradiance there. `weight`
    (m, C): length in m times the transmittance from the ray's start.
    """

    which: NDArray[np.intp]
    altitude_m: FloatArray
    mu: FloatArray
    mu_s: FloatArray
    nu: FloatArray
    scattering: dict[str, FloatArray]
    sunlight: FloatArray
    weight: FloatArray
    transmittance: FloatArray

    @property
    def place(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """The places and directions at which a source function is looked up."""
        return self.altitude_m, self.mu, self.mu_s, self.nu

    def summed(self, light: FloatArray) -> FloatArray:
        """Light (m, C) that is scattered in 1 m at each node, as radiance (n, C)."""
        radiance = np.zeros_like(self.transmittance)
        first = np.flatnonzero(np.diff(self.which, prepend=-1))
        if first.size:
            radiance[self.which[first]] = np.add.reduceat(light * self.weight, first, axis=0)
        return radiance


def _way(
    air: Atmosphere,
    altitude_m: FloatArray,
    mu: FloatArray,
    mu_s: FloatArray,
    nu: FloatArray,
    distance_m: FloatArray,
) -> _Way:
    """The nodes of rays; arguments as for `light_along`."""
    ray = make_ray(air.ground_radius_m, altitude_m, mu)
    end = _ends(air, ray, distance_m)
    nodes = view_nodes(air, ray, mu_s, nu, _nodes(air), end)
    # Most segments have no length: by day a ray is one segment or two.
    which, column = np.nonzero(nodes.metres)
    altitude, y = nodes.altitude_m[which, column], nodes.y[which, column]
    here = Ray(*(part[which] for part in ray))
    sun = sun_cosine(here, altitude, y, mu_s[which], nu[which])
    along = y * np.sqrt(y * y + 2.0 * here.perigee_radius_m)
    sunlight = np.exp(-optical_depth_to_top(air, altitude, sun)) * np.asarray(air.solar_irradiance)
    passed = np.exp(-optical_depth(air, here, altitude, y))
    return _Way(
        which,
        altitude,
        np.clip(along / (air.ground_radius_m + altitude), -1.0, 1.0),
        sun,
        nu[which],
        scattering_at(air, altitude),
        sunlight * nodes.lit[which, column, None],
        nodes.metres[which, column, None] * passed,
        np.exp(-optical_depth(air, ray, *end)),
    )


def _phases(field: SourceField, way: _Way) -> dict[str, FloatArray]:
    """Phase functions (m, C or 1) of all that scatters, per unit of scattering in thinned air."""
    air, phases = field.thinned, {"molecules": molecules_phase(field.atmosphere, way.nu)[:, None]}
    for name, peak in forward_shares(field.atmosphere, field.sizes.degree).items():
        if name in way.scattering:
            phases[name] = particles_phase(air, name, way.nu) / (1.0 - peak)
    return phases


def _scattered_again(field: SourceField, way: _Way, source: FloatArray) -> FloatArray:
    """Light (..., m, C) scattered in 1 m, of sources (..., 2, m, C) of molecules, particles."""
    particles = sum(part for name, part in way.scattering.items() if name != "molecules")
    both = np.stack(np.broadcast_arrays(way.scattering["molecules"], particles))
    return np.asarray((source * both).sum(axis=-3))


def scattered_once(
    field: SourceField, altitude_m: float, mu: FloatArray, mu_s: float, nu: FloatArray, samples: int
) -> FloatArray:
    """Radiance (n, C) of the light that is shown scattered once, towards one observer.

    On the depths of thinned air, with the whole phase function of each kind of particle. `mu`, `nu`
    (n,); `samples`: nodes per segment.
    """
    air = field.thinned
    light = fast_by_name(air, altitude_m, mu, mu_s, nu, samples)
    radiance = light.pop("molecules") * molecules_phase(air, nu)[:, None]
    peaks = forward_shares(field.atmosphere, field.sizes.degree)
    for name, part in light.items():
        radiance = radiance + part * particles_phase(air, name, nu) / (1.0 - peaks[name])
    return np.asarray(radiance)


def _nodes(air: Atmosphere) -> int:
    if air.foggy:
        return _IN_FOG
    if is_veiled(air):
        return _BELOW_VEIL
    return _IN_THICK_HAZE if is_thick_haze(air) else _NODES


def _ends(air: Atmosphere, ray: Ray, distance_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Altitude and y (n,) where rays end."""
    planet, top_m = air.ground_radius_m, air.top_altitude_m
    hits = ray.hits_ground()
    # For a ray that misses the ground the formula for its distance may overflow.
    down = distance_to_ground(planet, ray.altitude_m, np.where(hits, ray.mu, -1.0))
    length = np.where(hits, down, distance_to_top(planet, top_m, ray.altitude_m, ray.mu))
    way = np.minimum(distance_m, length)
    altitude, y = end_of_ray(ray, top_m)
    cut = distance_m < length
    cut_altitude = np.clip(altitude_along(planet, ray.altitude_m, ray.mu, way), 0.0, top_m)
    y_cut = np.clip(y_along(ray, way), ray.y, np.maximum(y, ray.y))
    return np.where(cut, cut_altitude, altitude), np.where(cut, y_cut, y)


def scattering_at(atmosphere: Atmosphere, altitude_m: FloatArray) -> dict[str, FloatArray]:
    """Scattering coefficients (n, C) in 1/m of the atmosphere's scatterers, by name."""
    return {
        kind.name: kind.density(altitude_m)[:, None] * kind.scattering
        for kind in atmosphere.scatterers()
    }


def source_at(
    field: SourceField, altitude_m: FloatArray, mu: FloatArray, mu_s: FloatArray, nu: FloatArray
) -> FloatArray:
    """The source function (2, n, C) of molecules and aerosol at points; see `SourceField`."""
    air = field.atmosphere
    height = _altitude_place(air, altitude_m)
    sun = SunGrid(air, field.sizes.mu_s).place(mu_s)
    turn = _turn_cosine(mu, mu_s, nu)
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    rayleigh, mie = _tables(field)
    out = np.zeros((2, mu.size, len(air.wavelength_nm)))
    if rayleigh.size:
        values = _blend(rayleigh, (height, sun))
        terms = np.stack(
            [np.ones_like(mu), 3.0 * mu * mu - 1.0, mu * sine * turn, sine**2 * (2 * turn**2 - 1)]
        )
        out[0] = np.einsum("tn,ntc->nc", terms, values)
    if mie.size:
        places = height, 0.5 * mu + 0.5, np.sqrt(0.5 * (1.0 - turn)), sun
        out[1] = _blend(mie, places)
    return out * _level(field, height, sun)


def polarised_source_at(
    field: SourceField, altitude_m: FloatArray, mu: FloatArray, mu_s: FloatArray, nu: FloatArray
) -> FloatArray:
    """Q and U (2, 2, n, C) of `source_at`; of particles by their harmonics, without tables."""
    air = field.atmosphere
    height = _altitude_place(air, altitude_m)
    sun = SunGrid(air, field.sizes.mu_s).place(mu_s)
    (rayleigh, _), polarised = _tables(field), _polarised_table(field)
    out = np.zeros((2, 2, mu.size, len(air.wavelength_nm)))
    turn = np.arccos(_turn_cosine(mu, mu_s, nu))
    if rayleigh.size:
        terms = molecules_terms(mu, turn)
        out[:, 0] = np.einsum("ptn,ntc->pnc", terms, _blend(rayleigh[:, :, 1:], (height, sun)))
    if polarised.size:
        terms = harmonics_at(polarised_degree(field.sizes), mu, turn)
        out[:, 1] = np.einsum("pkhn,nkhc->pnc", terms, _blend(polarised, (height, sun)))
    return out * _level(field, height, sun)


def _turn_cosine(mu: FloatArray, mu_s: FloatArray, nu: FloatArray) -> FloatArray:
    """Cosine (n,) of the azimuth from the sun; 1 where view or sun are vertical."""
    sines = np.sqrt((1.0 - mu) * (1.0 + mu)), np.sqrt((1.0 - mu_s) * (1.0 + mu_s))
    level = np.maximum(sines, _VERTICAL_SINE)
    turn = np.clip((nu - mu * mu_s) / np.prod(level, axis=0), -1.0, 1.0)
    return np.where(np.min(sines, axis=0) > _VERTICAL_SINE, turn, 1.0)


def _plane_turns(mu: FloatArray, mu_s: FloatArray, nu: FloatArray) -> tuple[FloatArray, FloatArray]:
    """cos(2 chi), sin(2 chi) (n,) of the scattering plane: see `polarisation_kernels`."""
    turn = np.arccos(_turn_cosine(mu, mu_s, nu))
    sun_sine = np.sqrt((1.0 - mu_s) * (1.0 + mu_s))
    theta = mu * sun_sine * np.cos(turn) - np.sqrt((1.0 - mu) * (1.0 + mu)) * mu_s
    chi = np.arctan2(-sun_sine * np.sin(turn), theta)
    return np.cos(2.0 * chi), np.sin(2.0 * chi)


def _level(field: SourceField, height: FloatArray, sun: FloatArray) -> FloatArray:
    """The light (n, C) between two suns over that of lines; places as in `source_at`."""
    bends = _bends(field)
    if not bends.size:
        return np.ones((1, 1))
    place = sun * (bends.shape[1] - 1)
    low = np.minimum(place.astype(np.intp), bends.shape[1] - 2)
    far = place - low
    i = np.minimum((height * (len(bends) - 1)).astype(np.intp), len(bends) - 2)
    u = (height * (len(bends) - 1) - i)[:, None]
    bend = (1.0 - u) * bends[i, low] + u * bends[i + 1, low]
    return light_over_lines(bend, far[:, None])


@table_of_field
def _bends(field: SourceField) -> FloatArray:
    """`sun_bend` of each wavelength's group (altitudes, suns, C)."""
    mu_s, groups = SunGrid(field.atmosphere, field.sizes.mu_s).mu_s, range(len(field.rayleigh))
    by_group = [sun_bend(field.rayleigh[k], field.mie[k], mu_s) for k in groups]
    count = len(field.atmosphere.wavelength_nm)
    by_lane = np.repeat(np.stack(by_group, axis=-1), LANES, axis=-1)[..., :count]
    return np.asarray(by_lane, dtype=float)


def _altitude_place(air: Atmosphere, altitude_m: FloatArray) -> FloatArray:
    """Place (n,) in [0, 1] on the source's axis of altitudes: see `solver.altitude_kernels`."""
    radius, top = air.ground_radius_m, air.top_altitude_m
    squares = altitude_m * (2.0 * radius + altitude_m) / (top * (2.0 * radius + top))
    place = np.sqrt(np.clip(squares, 0.0, 1.0))
    reach_m, share = dense_layer(air)
    in_layer = np.expm1(-altitude_m / reach_m) / np.expm1(-top / reach_m)
    return np.asarray(place + share * (in_layer - place))


@table_of_field
def _tables(field: SourceField) -> tuple[SingleArray, SingleArray]:
    """The source function of molecules (altitudes, suns, 4, C), and that of aerosol (altitudes, mu,
    azimuths, suns, C), all wavelengths side by side; empty without aerosol."""
    count = len(field.atmosphere.wavelength_nm)
    rayleigh = np.moveaxis(_by_sun(field.rayleigh, count), 1, 2)
    return np.ascontiguousarray(rayleigh), _by_sun(field.mie, count)


@table_of_field
def _polarised_table(field: SourceField) -> SingleArray:
    """Coefficients of Q and U of aerosol (altitudes, suns, 2, harmonics, C); empty without."""
    assert field.polarised is not None
    by_sun = _by_sun(field.polarised, len(field.atmosphere.wavelength_nm))
    return np.ascontiguousarray(np.moveaxis(by_sun, 3, 1))


def _by_sun(table: SingleArray, count: int) -> SingleArray:
    """(groups, ..., suns * 4) as (..., suns, C)."""
    by_group = table.reshape(*table.shape[:-1], table.shape[-1] // LANES, LANES)
    joined = np.moveaxis(by_group, 0, -2)
    joined = joined.reshape(*joined.shape[:-2], len(table) * LANES)
    return np.ascontiguousarray(joined[..., :count])


def _blend(table: SingleArray, places: tuple[FloatArray, ...]) -> FloatArray:
    """Values (n, ...) between nodes along the first axes, at places in [0, 1]; linear."""
    low, share = [], []
    for place, size in zip(places, table.shape, strict=False):
        low.append(np.minimum((place * (size - 1)).astype(np.intp), size - 2))
        share.append(place * (size - 1) - low[-1])
    rest = (1,) * (table.ndim - len(places))
    out = np.zeros((places[0].size, *table.shape[len(places) :]))
    for corner in np.ndindex(*(2,) * len(places)):
        sides = zip(corner, share, strict=True)
        weight = np.prod([part if side else 1.0 - part for side, part in sides], axis=0)
        index = tuple(near + side for near, side in zip(low, corner, strict=True))
        out += weight.reshape(-1, *rest) * table[index]
    return out
