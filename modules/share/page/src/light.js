// The light map of an hour: a sum of basis maps, whose coefficients depend on where the sun stands.
import * as THREE from 'three';
import { halfValue } from './data.js';
import { placeWeights } from './places.js';
import { fullScreen, LIGHT_FRAGMENT } from './shaders.js';

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
    this.sun = Float32Array.from(bits, (half) => halfValue(half) * about.sun_scale);
    this.shares = data.array('share_weights');
    /** Weights of the share of the sky's light, those of the sources in the share of their light. */
    this.shareWeights = new Float32Array(about.share_components);
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
      share_weights: { value: this.shareWeights },
    }, { TERMS: about.terms, COMPONENTS: about.share_components, CODES: about.codes_per_stop.toFixed(4), POWER: about.power.toFixed(4) });
    /** Factor from the map's values to W m^-2. */
    this.scale = 1;
  }

  /** Adds the coefficients of a body, W m^-2.
   * @param {import('./sky.js').Body & {declination: number, hour: number, northRad: number}} body
   * @param {Float64Array} into */
  add(body, into) {
    const level = this.table.level(body.trueRad);
    for (const [place, weight] of placeWeights(this.places, body)) {
      const start = place * this.count;
      for (let c = 0; c < 3; ++c) {
        const factor = weight * level[c] * body.share[c];
        for (let k = c; k < this.count; k += 3) into[k] += factor * this.sun[start + k];
      }
    }
  }

  /** How the sky's light is shared out by its sources; the night's glow is as the mean.
   * @param {(import('./sky.js').Body & {declination: number, hour: number, northRad: number})[]} bodies
   * @param {number} night its light, as those of bodies by their levels */
  share(bodies, night) {
    const count = this.shareWeights.length;
    const bright = bodies.map((body) => this.table.level(body.trueRad)[1] * body.share[1]);
    const all = bright.reduce((sum, one) => sum + one, Math.max(night, 1e-30));
    this.shareWeights.fill(0);
    bodies.forEach((body, number) => {
      for (const [place, weight] of placeWeights(this.places, body)) {
        for (let k = 0; k < count; ++k) {
          this.shareWeights[k] += bright[number] / all * weight * this.shares[place * count + k];
        }
      }
    });
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
