// The light map of an hour: a sum of basis maps, whose coefficients depend on where the sun stands.
import * as THREE from 'three';
import { placeWeights } from './places.js';
import { fullScreen, LIGHT_FRAGMENT } from './shaders.js';

export class LightMap {
  /** @param {import('./data.js').PageData} data @param {import('./sky.js').SkyTable} table
   * @param {boolean} soft whether a processor draws: it then sums the maps here, in a third of the
   *   time that it takes by a shader */
  constructor(data, table, soft) {
    const about = data.header.basis;
    this.about = about;
    this.places = data.header.places;
    this.table = table;
    /** Coefficients of a place: clusters by terms by channels. */
    this.count = about.clusters * about.terms * 3;
    /** Coefficients of the sun's places in steps, of which each term of a cluster has its own. */
    this.sun = summed(data.array('sun'), this.count);
    this.steps = data.array('sun_step');
    this.shares = data.array('share_weights');
    /** Weights of the share of the sky's light, those of the sources in the share of their light. */
    this.shareWeights = new Float64Array(about.share_components);
    const extra = data.array('night_and_lamps');
    /** Numbers of places of the sky's light, and of those of rays behind clouds. */
    this.skies = this.shares.length / about.share_components;
    this.rays = this.sun.length / this.count - this.skies;
    this.glow = extra.subarray(0, this.count);
    this.lamps = extra.subarray(this.count);
    const [planes, height, width] = data.shape('planes');
    this.size = [width, height];
    const from = data.array('planes'), terms = wholes(data.array('terms'));
    this.values = new Float64Array(4 * about.clusters * about.terms);
    /** What sums the basis maps up. */
    this.map = soft ? new MapSum(about, from, terms, width, height)
      : new MapPass(about, from, terms, planes, width, height);
    this.texture = this.map.texture;
    /** Factor from the map's values to W m^-2. */
    this.scale = 1;
  }

  /** Adds the coefficients of a body, W m^-2.
   * @param {import('./sky.js').Body & {declination: number, hour: number, northRad: number}} body
   * @param {number} passed share of its rays behind clouds, whose light has places of its own
   * @param {Float64Array} into */
  add(body, passed, into) {
    const level = this.table.level(body.trueRad).map((v, c) => v * body.share[c]), { rays } = this;
    const add = (/** @type {number} */ place, /** @type {number} */ weight) => {
      const start = place * this.count, factors = level.map((v) => weight * v);
      for (let k = 0, i = 0; k < this.count; k += 3, ++i) {
        const step = this.steps[i];
        for (let c = 0; c < 3; ++c) into[k + c] += factors[c] * step * this.sun[start + k + c];
      }
    };
    for (const [place, weight] of placeWeights(this.places, body)) {
      add(place, weight);
      if (place < rays && passed > 0) add(this.skies + place, weight * passed);
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
    this.map.update(this.values, this.shareWeights, renderer);
  }
}

/** Coefficients of places, of differences to the place before: the twin of
 * share/sun_coefficients.py. @param {Uint8Array} codes low bytes, then high ones
 * @param {number} count coefficients of a place */
export function summed(codes, count) {
  const found = new Int16Array(codes.length / 2);
  for (let i = 0; i < found.length; ++i) {
    const folded = codes[i] | codes[found.length + i] << 8;
    found[i] = (i < count ? 0 : found[i - count]) + (folded & 1 ? ~(folded >> 1) : folded >> 1);
  }
  return found;
}

/** Whole steps of terms. @param {Uint8Array} bytes low ones, then high ones; both count from 128 */
export function wholes(bytes) {
  const found = new Int16Array(bytes.length / 2);
  for (let i = 0; i < found.length; ++i) found[i] = bytes[i] + 256 * bytes[found.length + i] - 32896;
  return found;
}

/** Planes as a texture, four a layer.
 * @template {Uint8Array<ArrayBuffer> | Int16Array<ArrayBuffer>} Kind
 * @param {Kind} planes one after the other @param {Kind} texels zeros, for all layers
 * @param {number} width @param {number} height */
function layered(planes, texels, width, height) {
  const area = width * height;
  for (let at = 0, p = 0; at < planes.length; at += area, ++p) {
    const base = 4 * area * (p >> 2) + (p & 3);
    for (let i = 0; i < area; ++i) texels[base + 4 * i] = planes[at + i];
  }
  const found = new THREE.DataArrayTexture(texels, width, height, texels.length / (4 * area));
  found.magFilter = found.minFilter = THREE.NearestFilter;
  found.needsUpdate = true;
  return found;
}

/** The sum of the basis maps by a shader. */
class MapPass {
  /** @param {any} about the header's basis @param {Uint8Array<ArrayBuffer>} from planes one after the other
   * @param {Int16Array<ArrayBuffer>} wholes of the terms, alike @param {number} planes
   * @param {number} width @param {number} height */
  constructor(about, from, wholes, planes, width, height) {
    const layer = 4 * width * height;
    const basis = layered(from, new Uint8Array(layer * Math.ceil(planes / 4)), width, height);
    const terms = layered(wholes, new Int16Array(layer * about.terms / 4), width, height);
    terms.format = THREE.RGBAIntegerFormat;
    terms.type = THREE.ShortType;
    terms.internalFormat = 'RGBA16I';
    this.values = new Float32Array(4 * about.clusters * about.terms);
    this.coefficients = new THREE.DataTexture(this.values, about.terms, about.clusters,
      THREE.RGBAFormat, THREE.FloatType);
    this.target = new THREE.WebGLRenderTarget(width, height, {
      type: THREE.HalfFloatType, depthBuffer: false,
      magFilter: THREE.LinearFilter, minFilter: THREE.LinearFilter,
    });
    this.texture = this.target.texture;
    this.pass = fullScreen(LIGHT_FRAGMENT, {
      basis: { value: basis }, terms: { value: terms }, coefficients: { value: this.coefficients }, share_weights: { value: null },
    }, { TERMS: about.terms, COMPONENTS: about.share_components, LEAST_RATIO: about.share_least.toFixed(4), CODES: about.codes_per_stop.toFixed(4), POWER: about.power.toFixed(4) });
  }

  /** A graphics card sums all texels always. */
  /** @param {Uint8Array | null} _texels */
  choose(_texels) {}

  complete() {}

  /** @param {Float64Array} values coefficients, four a term, a row a cluster
   * @param {Float64Array} weights of the share's components @param {THREE.WebGLRenderer} renderer */
  update(values, weights, renderer) {
    this.values.set(values);
    this.coefficients.needsUpdate = true;
    this.pass.material.uniforms.share_weights.value = weights;
    this.pass.draw(renderer, this.target);
  }
}

/** Values of planes, texel by texel.
 * @template {Uint8Array | Int16Array} Kind
 * @param {Kind} planes one after the other @param {Kind} found zeros
 * @param {number[]} used places of texels @param {number} area of a plane @returns {Kind} */
function byTexel(planes, found, used, area) {
  const count = found.length / used.length;
  for (let k = 0; k < count; ++k) {
    for (let t = 0; t < used.length; ++t) found[t * count + k] = planes[k * area + used[t]];
  }
  return found;
}

/** The sum of the basis maps on the processor: the twin of LIGHT_FRAGMENT. */
export class MapSum {
  /** @param {any} about the header's basis @param {Uint8Array} planes one after the other
   * @param {Int16Array} wholes of the terms, alike @param {number} width @param {number} height */
  constructor(about, planes, wholes, width, height) {
    const area = width * height, components = about.share_components;
    this.terms = about.terms;
    this.components = components;
    /** Smallest ratio of a share of the sky's light to its mean. */
    this.least = about.share_least;
    const used = [];
    for (let i = 0; i < area; ++i) if (planes[i]) used.push(i);
    /** Places of used texels in the map. */
    this.places = Uint32Array.from(used);
    this.clusters = this.places.map((i) => planes[area + i]);
    this.factors = Float32Array.from(used, (i) => 2 ** ((planes[i] - 255) / about.codes_per_stop));
    this.shares = Float32Array.from(used, (i) => ((256 * planes[2 * area + i] + planes[3 * area + i]) / 65535) ** 2);
    /** Codes of components and whole steps of terms, texel by texel. */
    this.codes = byTexel(planes.subarray(4 * area), new Uint8Array(used.length * components), used, area);
    this.wholes = byTexel(wholes, new Int16Array(used.length * about.terms), used, area);
    // Doubles, for a sum of singles converts each of them.
    this.decoded = Float64Array.from({ length: 256 }, (_, code) => {
      const share = (code - 128) / 127;
      return Math.sign(share) * Math.abs(share) ** about.power;
    });
    /** Numbers of all used texels, and of those that are summed. */
    this.all = this.places.map((_, t) => t);
    this.numbers = this.all;
    /** @type {Uint8Array | null} */
    this.marks = null;
    this.values = new Float64Array();
    this.weights = new Float64Array();
    this.halves = new Uint16Array(4 * area);
    this.texture = new THREE.DataTexture(this.halves, width, height, THREE.RGBAFormat, THREE.HalfFloatType);
    this.texture.magFilter = this.texture.minFilter = THREE.LinearFilter;
  }

  /** Chooses the texels of the next sums. @param {Uint8Array | null} texels marks; null for all */
  choose(texels) {
    if (texels !== this.marks) this.numbers = texels ? this.all.filter((t) => texels[this.places[t]]) : this.all;
    this.marks = texels;
  }

  /** Sums what the last choice has left out. */
  complete() {
    if (!this.marks) return;
    this.choose(null);
    this.update(this.values, this.weights);
  }

  /** @param {Float64Array} values coefficients, four a term, a row a cluster
   * @param {Float64Array} weights of the share's components */
  update(values, weights) {
    Object.assign(this, { values, weights });
    const { places, clusters, factors, shares, codes, decoded, wholes, halves, terms, components, least, numbers } = this;
    const half = THREE.DataUtils.toHalfFloat;
    for (const t of numbers) {
      let ratio = 1, r = 0, g = 0, b = 0, c = 4 * terms * clusters[t], at = components * t, own = terms * t;
      for (let k = 0; k < components; ++k) ratio += decoded[codes[at++]] * weights[k];
      // Four terms at once: a processor waits for each number that is added to a sum.
      for (let k = 0; k < terms; k += 4, c += 16, own += 4) {
        const k0 = wholes[own], k1 = wholes[own + 1], k2 = wholes[own + 2], k3 = wholes[own + 3];
        r += (k0 * values[c] + k1 * values[c + 4]) + (k2 * values[c + 8] + k3 * values[c + 12]);
        g += (k0 * values[c + 1] + k1 * values[c + 5]) + (k2 * values[c + 9] + k3 * values[c + 13]);
        b += (k0 * values[c + 2] + k1 * values[c + 6]) + (k2 * values[c + 10] + k3 * values[c + 14]);
      }
      const factor = factors[t], into = 4 * places[t];
      halves[into] = half(Math.min(Math.max(r * factor, 0), 65504));
      halves[into + 1] = half(Math.min(Math.max(g * factor, 0), 65504));
      halves[into + 2] = half(Math.min(Math.max(b * factor, 0), 65504));
      halves[into + 3] = half(shares[t] * Math.max(ratio, least));
    }
    this.texture.needsUpdate = true;
  }
}
