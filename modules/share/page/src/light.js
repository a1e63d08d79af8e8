// The light map of an hour: a sum of basis maps, whose coefficients depend on where the sun stands.
import * as THREE from 'three';
import { halfValue } from './data.js';
import { clamp, placed } from './sky.js';
import { fullScreen, LIGHT_FRAGMENT } from './shaders.js';

/** Weights of four even nodes about t (Catmull and Rom 1974). @param {number} t */
function cubic(t) {
  return [0.5 * t * (t * (2 - t) - 1), 0.5 * (t * t * (3 * t - 5) + 2),
    0.5 * t * (t * (4 - 3 * t) + 1), 0.5 * t * t * (t - 1)];
}

/** Share of a full turn, in [0, 1). @param {number} rad */
const turned = (rad) => ((rad / (2 * Math.PI)) % 1 + 1) % 1;

export class LightMap {
  /** @param {import('./data.js').PageData} data @param {import('./sky.js').SkyTable} table */
  constructor(data, table) {
    const about = data.header.basis;
    this.about = about;
    this.places = data.header.places;
    this.table = table;
    /** Coefficients of a place: clusters by terms by channels. */
    this.count = about.clusters * about.terms * 3;
    const bits = data.array('sun');
    this.sun = Float32Array.from(bits, halfValue);
    const extra = data.array('night_and_lamps');
    this.glow = extra.subarray(0, this.count);
    this.lamps = extra.subarray(this.count);
    const [planes, height, width] = data.shape('planes');
    this.size = [width, height];
    const layers = Math.ceil(planes / 4), area = width * height, from = data.array('planes');
    const texels = new Uint8Array(4 * area * layers);
    for (let p = 0; p < planes; ++p) {
      const base = 4 * area * (p >> 2) + (p & 3), at = p * area;
      for (let i = 0; i < area; ++i) texels[base + 4 * i] = from[at + i];
    }
    this.basis = new THREE.DataArrayTexture(texels, width, height, layers);
    this.basis.magFilter = this.basis.minFilter = THREE.NearestFilter;
    this.basis.needsUpdate = true;
    this.values = new Float32Array(4 * about.clusters * about.terms);
    this.coefficients = new THREE.DataTexture(this.values, about.terms, about.clusters,
      THREE.RGBAFormat, THREE.FloatType);
    this.target = new THREE.WebGLRenderTarget(width, height, {
      type: THREE.HalfFloatType, depthBuffer: false,
      magFilter: THREE.LinearFilter, minFilter: THREE.LinearFilter,
    });
    this.pass = fullScreen(LIGHT_FRAGMENT, {
      basis: { value: this.basis }, coefficients: { value: this.coefficients },
    }, { TERMS: about.terms, CODES: about.codes_per_stop.toFixed(4), POWER: about.power.toFixed(4) });
    /** Factor from the map's values to W m^-2. */
    this.scale = 1;
  }

  /** Places and weights for a body: the twin of share/sun_places.py.
   * @param {{trueRad: number, declination: number, hour: number, northRad: number}} at
   * @returns {[number, number][]} */
  weights(at) {
    const [low, high] = this.places.takes_over_rad;
    const day = clamp((at.trueRad - low) / (high - low), 0, 1);
    /** @type {[number, number][]} */
    const found = [];
    if (day > 0) this.byDay(at, day, found);
    if (day < 1) this.byDusk(at, 1 - day, found);
    return found;
  }

  /** @param {{declination: number, hour: number}} at @param {number} share
   * @param {[number, number][]} found */
  byDay(at, share, found) {
    const { declinations, hours, most_declination: most, day_nodes: nodes } = this.places;
    const v = clamp((at.declination + most) / (2 * most) * (declinations - 1), 0, declinations - 1);
    const u = turned(at.hour) * hours % hours;
    const row = Math.min(Math.floor(v), declinations - 2), column = Math.floor(u);
    const along = cubic(u - column);
    let across = cubic(v - row);
    if (row === 0) across = [0, across[1] + 2 * across[0], across[2] - across[0], across[3]];
    if (row === declinations - 2) across = [across[0], across[1] - across[3], across[2] + 2 * across[3], 0];
    for (let j = 0; j < 4; ++j) {
      if (!across[j]) continue;
      for (let i = 0; i < 4; ++i) {
        found.push([nodes[row + j - 1][(column + i - 1 + hours) % hours], share * across[j] * along[i]]);
      }
    }
  }

  /** @param {{trueRad: number, northRad: number}} at @param {number} share
   * @param {[number, number][]} found */
  byDusk(at, share, found) {
    const { dusk_rad: heights, dusk_azimuths: count, first_of_dusk: first } = this.places;
    const [row, t] = placed(heights, at.trueRad), u = turned(at.northRad) * count % count;
    const column = Math.floor(u), along = cubic(u - column);
    for (let j = 0; j < 2; ++j) {
      for (let i = 0; i < 4; ++i) {
        found.push([first + (row + j) * count + (column + i - 1 + count) % count,
          share * (j ? t : 1 - t) * along[i]]);
      }
    }
  }

  /** Adds the coefficients of a body, W m^-2.
   * @param {import('./sky.js').Body & {declination: number, hour: number, northRad: number}} body
   * @param {Float64Array} into */
  add(body, into) {
    const level = this.table.level(body.trueRad);
    for (const [place, weight] of this.weights(body)) {
      const start = place * this.count;
      for (let c = 0; c < 3; ++c) {
        const factor = weight * level[c] * body.share[c];
        for (let k = c; k < this.count; k += 3) into[k] += factor * this.sun[start + k];
      }
    }
  }

  /** Draws the map of these coefficients. @param {THREE.WebGLRenderer} renderer
   * @param {Float64Array} coefficients @param {number} bright light of the brightest texels, about */
  draw(renderer, coefficients, bright) {
    this.scale = bright;
    for (let i = 0; i < this.count / 3; ++i) {
      for (let c = 0; c < 3; ++c) this.values[4 * i + c] = coefficients[3 * i + c] / bright;
    }
    this.coefficients.needsUpdate = true;
    this.pass.draw(renderer, this.target);
  }
}
