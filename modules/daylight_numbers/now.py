"""An hour at sensors: illuminance by sun, sky and surfaces, daylight factors and sky views.

Daylight factors are those of CIE's standard skies (ISO 15469:2004), whose luminance is relative.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from light_transport.public import NODES, CancelCheck, Illumination, SceneTransport, always

from daylight_numbers.glazing.glass import Glass
from daylight_numbers.matrix.measured_panes import MeasuredPanes
from daylight_numbers.matrix.operator import Operator, operator_of
from daylight_numbers.matrix.pane_bounces import PaneBounces
from daylight_numbers.matrix.sensor_rays import SKY, GlazedScene, ends_of, glazed
from daylight_numbers.matrix.sensors import Sensors
from daylight_numbers.sky_cells import cell_radiances, cell_weights
from daylight_numbers.work import RAYS_SHARE, DaylightWork, bounces_of, traced_transport
from vrut_lite.atmosphere.cie_skies import OVERCAST, general_sky
from vrut_lite.geometry.colour import LUMENS_PER_WATT, luminance
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.geometry.spherical_harmonics import irradiance_coefficients
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.numeric_types import Float32Array, FloatArray

_OFF = 1e-5
_RAYS_AT_ONCE = 1 << 18
CieSky = Literal["16", "1", "5"]
CIE_SKIES: tuple[CieSky, ...] = get_args(CieSky)
TITLES = {
    "16": "CIE sky type 16, traditional overcast",
    "1": "CIE sky type 1, overcast, steep gradation",
    "5": "CIE sky type 5, uniform luminance",
}
_CUBE = 64
_RADIANCE = 100.0
GROUND_ALBEDO = 0.2
# Patches twice as wide need a quarter of the texels.
_SHARE_OF_TEXELS = 0.25
_MOST_SENSORS = 48


@dataclass(frozen=True, eq=False)
class HourAtSensors:
    """Illuminance (P,) in lux of an hour: `sun` straight, `sky` and open ground, straight or by
    measured panes, and what `surfaces` of the scene send, among them measured panes in the sun;
    `noise` is the standard error that rays leave in the last two."""

    sun: FloatArray
    sky: FloatArray
    surfaces: FloatArray
    noise: FloatArray

    @property
    def total(self) -> FloatArray:
        """Illuminance (P,) by sun, sky and surfaces together."""
        return self.sun + self.sky + self.surfaces


def hour_at_sensors(
    transport: SceneTransport,
    glass: Glass,
    operator: Operator,
    sensors: Sensors,
    hour: Illumination,
) -> HourAtSensors:
    """The light of an hour."""
    radiances = np.vstack([cell_radiances(hour.sky), np.asarray(hour.ground_radiance_rgb)])
    radiosity = np.asarray(transport.column_light(hour)[NODES:-1, :3], float)
    towards = np.asarray(hour.key_direction, float)[None]
    key = np.asarray(hour.key_irradiance_rgb, float)
    of_sun = None
    if operator.bounces is not None:
        of_sun, more = light_by_panes(operator.bounces, radiances, radiosity, hour)
        radiosity += more
    nothing = np.zeros_like(radiosity), np.zeros_like(radiances)
    sky, _ = operator.irradiance(radiances, nothing[0])
    surfaces, _ = operator.irradiance(nothing[1], radiosity, of_sun)
    _, noise = operator.irradiance(radiances, radiosity, of_sun)
    sun = sun_shares(transport, glass, sensors, towards, operator.panes)[:, 0] * key
    return HourAtSensors(*(_lux(part) for part in (sun, sky, surfaces, noise)))


def light_by_panes(
    bounces: PaneBounces, radiances: FloatArray, radiosity: FloatArray, hour: Illumination
) -> tuple[FloatArray, FloatArray]:
    """Radiances (O, 3) of measured panes by the sun alone, and what they add to the radiosity
    (M, 3) of patches; see `PaneBounces.more_radiosity`."""
    towards = np.asarray(hour.key_direction, float)
    key = np.asarray(hour.key_irradiance_rgb, float)
    of_sun = bounces.panes.of_sun(towards[None]) * key
    more = bounces.more_radiosity(
        radiances, radiosity, of_sun, towards, key, hour.ground_albedo_rgb
    )
    return of_sun, more


def _lux(irradiance_rgb: FloatArray) -> FloatArray:
    return np.asarray(luminance(irradiance_rgb) * LUMENS_PER_WATT)


def sun_shares(
    transport: SceneTransport,
    glass: Glass,
    sensors: Sensors,
    directions: FloatArray,
    panes: MeasuredPanes | None = None,
) -> Float32Array:
    """Share (P, H, 3) of light from unit vectors (H, 3) that gets to sensors, times its cosine.

    Of measured panes what passes straight.
    """
    where = glazed(transport, glass)
    places = transport.in_radii(sensors.places_m) + _OFF * sensors.normals
    found = np.zeros((len(sensors), len(directions), 3), np.float32)
    cosine = sensors.normals @ np.asarray(directions, float).T
    above = (cosine > 0.0) & (np.asarray(directions)[:, 1] > 0.0)
    sensor, towards = np.nonzero(above)
    for first in range(0, len(sensor), _RAYS_AT_ONCE):
        some = slice(first, first + _RAYS_AT_ONCE)
        s, d = sensor[some], towards[some]
        got = sun_reaching(where, panes, places[s], np.asarray(directions)[d])
        found[s, d] = got * cosine[s, d, None]
    return found


def sun_reaching(
    where: GlazedScene, panes: MeasuredPanes | None, places: FloatArray, towards: FloatArray
) -> FloatArray:
    """Share (R, 3) of light from unit vectors (R, 3) that gets straight to places (R, 3) in radii,
    through glass, and through measured panes, which are opaque in `where`."""
    target, share = ends_of(where, places, towards)
    got = share[:, 0] * (target[:, 0] == SKY)[:, None]
    if panes is not None:
        hits = panes.met_by(target[:, 0], towards)
        met = np.flatnonzero(hits.met)[hits.straight > 0.0]
        beyond, through = ends_of(panes.opened, places[met], towards[met])
        passed = hits.straight[hits.straight > 0.0] * (beyond[:, 0] == SKY)
        got[met] = passed[:, None] * through[:, 0]
    return np.asarray(got)


def open_irradiance(hour: Illumination) -> FloatArray:
    """Irradiance (3,) of an hour's sky on open level ground, without the key light."""
    return np.asarray(cell_weights() @ cell_radiances(hour.sky))


def daylight_factor(
    transport: SceneTransport,
    glass: Glass,
    operator: Operator,
    sensors: Sensors,
    hour: Illumination,
) -> tuple[FloatArray, FloatArray]:
    """Daylight factor (P,) in percent under a sky without sun, and its standard error (P,)."""
    found = hour_at_sensors(transport, glass, operator, sensors, hour)
    outside = float(_lux(open_irradiance(hour)))
    return 100.0 * found.total / outside, 100.0 * found.noise / outside


def sky_view(operator: Operator) -> FloatArray:
    """Share (P,) of a sensor's hemisphere, weighted by the cosine, through which sky is seen.

    Glass counts by what it passes.
    """
    halves = [half.seen[0][:, :-1].sum(axis=1) for half in operator.halves]
    return np.asarray(sum(halves)).ravel() / (2.0 * np.pi)


def relative_luminance(sky: CieSky, sine: FloatArray) -> FloatArray:
    """Luminance over that of the zenith at directions whose height has this sine, 0 to 1."""
    shape = OVERCAST if sky == "16" else general_sky(int(sky))
    zenith = shape.relative_luminance(1.0, 0.0)
    return np.asarray(shape.relative_luminance(sine, 0.0) / zenith)


def cie_hour(sky: CieSky, ground_albedo: float) -> Illumination:
    """A white sky without sun, over ground of this albedo that all of the sky lights."""
    sine = texel_directions(_CUBE)[..., 1]
    luminance = _RADIANCE * relative_luminance(sky, np.maximum(sine, 0.0))
    steps = (np.arange(20_000) + 0.5) / 20_000
    level = 2.0 * np.pi * float(np.mean(_RADIANCE * relative_luminance(sky, steps) * steps))
    ground = ground_albedo * level / np.pi
    cube = np.where(sine >= 0.0, luminance, ground)
    cube = np.repeat(cube[..., None], 3, axis=-1).astype(np.float32)
    return Illumination(
        sky=cube,
        ground_radiance_rgb=(ground,) * 3,
        ground_albedo_rgb=(ground_albedo,) * 3,
        key_direction=(0.0, 1.0, 0.0),
        key_irradiance_rgb=(0.0, 0.0, 0.0),
        open_sky=irradiance_coefficients(cube),
    )


@dataclass(frozen=True, eq=False)
class NumbersNow:
    """Numbers of sensors (P): lux of the hour; daylight factor and its standard error in percent;
    share of the hemisphere, weighted by the cosine, through which the sky is seen."""

    light: HourAtSensors
    daylight_factor_percent: FloatArray
    daylight_factor_error_percent: FloatArray
    sky_view: FloatArray


def numbers_now(
    work: DaylightWork,
    hour: Illumination,
    cie_sky: CieSky = "16",
    ground_albedo: float = GROUND_ALBEDO,
    go_on: CancelCheck = always,
) -> NumbersNow:
    """The numbers of an hour.

    Args:
        work: `work_of` the scene: it takes seconds and serves all hours.
        hour: the light; see `jobs.hour_of` for that of messages.
        cie_sky: of the daylight factor.
        ground_albedo: under that sky.
        go_on: called between steps.

    Raises:
        GivenUp: by `go_on`.
    """
    of = work.transport, work.glass, work.operator, work.sensors
    light = hour_at_sensors(*of, hour)
    go_on()
    factor, error = daylight_factor(*of, cie_hour(cie_sky, ground_albedo))
    return NumbersNow(light, factor, error, sky_view(work.operator))


def patch_error(
    scene: SceneOpened,
    work: DaylightWork,
    glazing: Mapping[str, Glazing],
    tolerance: float,
    light: Illumination,
    factor: FloatArray,
) -> float:
    """How far daylight factors (P,) move with patches twice as wide: rms, a share of their mean.

    The error of the finer patches is about as large where it falls with their width, and smaller
    where it falls faster. Some evenly chosen sensors are asked; the noise of rays is in it.
    """
    chosen = np.arange(0, len(work.sensors), -(-len(work.sensors) // _MOST_SENSORS))
    panes = None if work.operator.panes is None else work.operator.panes.materials
    transport = traced_transport(scene, tolerance, _SHARE_OF_TEXELS, glazing=glazing, panes=panes)
    bounces = None if panes is None else bounces_of(transport, work.glass, panes)
    sensors, error = work.sensors.some(chosen), RAYS_SHARE * tolerance
    operator = operator_of(
        transport, work.glass, sensors, error, transport.threads, bounces=bounces
    )
    coarser, _ = daylight_factor(transport, work.glass, operator, sensors, light)
    moved = np.sqrt(np.mean((coarser - factor[chosen]) ** 2))
    return float(moved / max(factor[chosen].mean(), 1e-12))
