// Sun and moon above the place, by astronomy-engine, with the refraction of
// vrut_lite/atmosphere/refraction.py.
import {
  Body, Equator, Horizon, Illumination, Observer, RotationAxis, Rotation_EQJ_HOR, SiderealTime, MakeTime, KM_PER_AU,
} from 'astronomy-engine';
import { clamp, interpolated } from './sky.js';

const DEG = Math.PI / 180;
const MEAN_RADIUS = Math.asin(696000 / 149597870.7);

/** @typedef {{trueRad: number, apparentRad: number, azimuthRad: number, declination: number,
 *   hour: number, northRad: number}} Place of a body: azimuth from the world's -Z, and from north */

/** Refraction of a geometric elevation (Saemundsson 1986). @param {number} rad @param {number} air */
function refraction(rad, air) {
  const h = rad / DEG, held = Math.max(h, -1);
  const arcminutes = Math.max(1.02 / Math.tan((held + 10.3 / (held + 5.11)) * DEG), 0);
  const x = clamp((h + 6) / 5, 0, 1);
  return arcminutes * air * x * x * (3 - 2 * x) / 60 * DEG;
}

/** Share of a disc above the horizon. @param {number} apparent @param {number} [radius] */
export function visible(apparent, radius = MEAN_RADIUS) {
  const t = clamp(apparent / radius, -1, 1);
  return clamp(0.5 + (t * Math.sqrt(1 - t * t) + Math.asin(t)) / Math.PI, 0, 1);
}

export class Ephemeris {
  /** @param {any} place of the header @param {any} moon table of the header */
  constructor(place, moon) {
    this.about = place;
    this.moonTable = moon;
    this.observer = new Observer(place.latitude_deg, place.longitude_deg, place.altitude_m);
    this.air = place.pressure_pa / 101000 * (283 / 283.15);
  }

  /** @param {Body} body @param {Date} date @returns {Place & {distanceKm: number}} */
  place(body, date) {
    const time = MakeTime(date);
    const found = Equator(body, time, this.observer, true, true);
    const { altitude, azimuth } = Horizon(time, this.observer, found.ra, found.dec);
    const sidereal = SiderealTime(time) + this.about.longitude_deg / 15;
    const trueRad = altitude * DEG;
    return {
      trueRad, apparentRad: trueRad + refraction(trueRad, this.air),
      azimuthRad: azimuth * DEG - this.about.north_offset_rad, northRad: azimuth * DEG,
      declination: found.dec * DEG, hour: (sidereal - found.ra) * 15 * DEG,
      distanceKm: found.dist * KM_PER_AU,
    };
  }

  /** @param {Date} date */
  sun(date) { return this.place(Body.Sun, date); }

  /** Place of the moon, and its light above the air as a share of the sun's. @param {Date} date */
  moon(date) {
    const at = this.place(Body.Moon, date), table = this.moonTable;
    if (!table) return { ...at, share: [0, 0, 0], lit: 0 };
    const { phase_angle: phase, phase_fraction: lit } = Illumination(Body.Moon, date);
    const near = (384400 / at.distanceKm) ** 2;
    const share = [0, 1, 2].map((c) => near
      * Math.exp(interpolated(table.phase_deg, table.log_share.map((/** @type {number[]} */ row) => row[c]), phase)));
    return { ...at, share, lit };
  }
}

/** The moon's own axes in the world's, one after the other: x to the mean Earth, z north.
 * night_sky/sky_axes.py. @param {Date} date @param {Observer} observer @param {number} northOffset radians */
export function moonAxes(date, observer, northOffset) {
  const time = MakeTime(date), axis = RotationAxis(Body.Moon, time), { rot } = Rotation_EQJ_HOR(time, observer);
  const ra = axis.ra * 15 * DEG, dec = axis.dec * DEG, spin = axis.spin * DEG;
  const north = [Math.cos(dec) * Math.cos(ra), Math.cos(dec) * Math.sin(ra), Math.sin(dec)];
  const node = [-Math.sin(ra), Math.cos(ra), 0], across = cross(north, node);
  const prime = node.map((v, k) => Math.cos(spin) * v + Math.sin(spin) * across[k]);
  const along = Math.cos(northOffset), aside = Math.sin(northOffset);
  return [prime, cross(north, prime), north].map((own) => {
    // Horizontal axes are north, west and up.
    const [n, w, up] = [0, 1, 2].map((j) => own[0] * rot[0][j] + own[1] * rot[1][j] + own[2] * rot[2][j]);
    return [-along * w - aside * n, up, -(along * n - aside * w)];
  });
}

/** @param {number[]} a @param {number[]} b */
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Share of the night's light (sky_at_night.py). @param {number} sunRad */
export const nightShare = (sunRad) => clamp(0.5 - sunRad / DEG, 0, 1);
/** Share of the sun's light that is left. @param {number} sunRad */
export const sunShare = (sunRad) => clamp(sunRad / DEG + 19, 0, 1);

/** Formatters of zones; making one takes as long as formatting fifty dates.
 * @type {Map<string, Intl.DateTimeFormat>} */
const formatters = new Map();

/** Minutes by which a zone's clock is before UTC. @param {string} zone @param {number} ms */
function offsetMinutes(zone, ms) {
  const formatter = formatters.get(zone) ?? new Intl.DateTimeFormat('en-US', {
    timeZone: zone, hourCycle: 'h23', year: 'numeric', month: 'numeric', day: 'numeric',
    hour: 'numeric', minute: 'numeric', second: 'numeric',
  });
  formatters.set(zone, formatter);
  const parts = formatter.formatToParts(ms);
  const get = (/** @type {string} */ name) => Number(parts.find((p) => p.type === name)?.value);
  const wall = Date.UTC(get('year'), get('month') - 1, get('day'), get('hour'), get('minute'), get('second'));
  return Math.round((wall - Math.floor(ms / 1000) * 1000) / 60000);
}

/** Instant of a wall clock. @param {string} zone @param {number} wall ms as if it were UTC */
export function instantOf(zone, wall) {
  let ms = wall - offsetMinutes(zone, wall) * 60000;
  ms = wall - offsetMinutes(zone, ms) * 60000;
  return new Date(ms);
}

/** Wall clock of an instant, ms as if it were UTC. @param {string} zone @param {number} ms */
export const wallOf = (zone, ms) => ms + offsetMinutes(zone, ms) * 60000;
