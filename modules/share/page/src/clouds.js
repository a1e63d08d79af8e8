// Clouds that stand still while the sun moves: the twin of share/cloud_maps.py, which says how its
// maps are laid out.
import * as THREE from 'three';
import { wholes } from './light.js';
import { placeWeights } from './places.js';
import { clamp } from './sky.js';

/** @typedef {import('./sky.js').Body & import('./places.js').At & {towards: THREE.Vector3, rays: number[]}} Lit
 * A body with its direction, and its irradiance in a clear sky. */

const toHalf = THREE.DataUtils.toHalfFloat;

/** A texture of half floats, four a texel. @param {Uint16Array<ArrayBuffer>} halves
 * @param {number} width @param {number} height */
function textureOf(halves, width, height) {
  const found = new THREE.DataTexture(halves, width, height, THREE.RGBAFormat, THREE.HalfFloatType);
  found.magFilter = found.minFilter = THREE.LinearFilter;
  found.needsUpdate = true;
  return found;
}

/** First of four neighbours in a map, and the weights of the next column and row.
 * @param {THREE.Vector3} d not below the horizon @param {number} edge of the map */
function nodeOf({ x, y, z }, edge) {
  const length = Math.abs(x) + Math.max(y, 0) + Math.abs(z);
  const [column, row] = [x + z, x - z].map((v) => (0.5 + 0.5 * clamp(v / length, -1, 1)) * (edge - 1));
  const k = Math.min(Math.floor(column), edge - 2), i = Math.min(Math.floor(row), edge - 2);
  return { at: i * edge + k, u: column - k, v: row - i };
}

/** @param {Float32Array} map @param {{at: number, u: number, v: number}} node @param {number} edge */
function between(map, { at, u, v }, edge) {
  return (1 - v) * ((1 - u) * map[at] + u * map[at + 1])
    + v * ((1 - u) * map[at + edge] + u * map[at + edge + 1]);
}

export class Clouds {
  /** @param {import('./data.js').PageData} data @param {import('./sky.js').SkyTable} table */
  constructor(data, table) {
    const { clouds } = data.header, [fine] = data.shape('cloud_passed'), [, terms, coarse] = data.shape('cloud_terms');
    this.about = clouds;
    this.table = table;
    this.fine = fine;
    this.coarse = coarse;
    this.terms = terms;
    const both = data.array('cloud_kept'), area = fine * fine;
    /** Transmittance, the share of the clear sky's light that is left, and the coarse light's factor. */
    this.passed = Float32Array.from(data.array('cloud_passed'), (c) => (c / 65535) ** 2);
    this.kept = Float32Array.from(both.subarray(0, area), (c) => c / 255);
    this.finer = Float32Array.from(both.subarray(area), (c) => c / 255 * clouds.finer);
    this.steps = wholes(data.array('cloud_terms'));
    /** Coefficients of the sun's places, then of the night. */
    this.coefficients = data.array('cloud_light');
    const glow = data.array('cloud_glow'), nodes = glow.length / 6;
    this.nodes = nodes;
    this.wideGlow = glow.subarray(3 * nodes);
    /** @type {Lit[]} */
    this.bodies = [];
    /** Light that clouds send, W m^-2 sr^-1, channel by channel. */
    this.light = [0, 1, 2].map(() => new Float32Array(coarse * coarse));
    const halves = new Uint16Array(4 * area), narrow = new Uint16Array(4 * nodes);
    for (let i = 0; i < area; ++i) {
      [this.passed, this.kept, this.finer].forEach((map, c) => { halves[4 * i + c] = toHalf(map[i]); });
    }
    for (let i = 0; i < 3 * nodes; ++i) narrow[4 * Math.floor(i / 3) + i % 3] = toHalf(glow[i]);
    this.halves = new Uint16Array(4 * coarse * coarse);
    /** @type {Record<string, THREE.IUniform>} */
    this.uniforms = {
      cloud_about: { value: textureOf(halves, fine, fine) },
      cloud_light: { value: textureOf(this.halves, coarse, coarse) },
      cloud_glow: { value: textureOf(narrow, nodes, 1) },
      cloud_scale: { value: 1 },
      cloud_suns: { value: [new THREE.Vector3(0, 1, 0), new THREE.Vector3(0, 1, 0)] },
      cloud_rays: { value: [new THREE.Vector3(), new THREE.Vector3()] },
    };
    this.defines = {
      CLOUDS: 1, CLOUD_FINE: fine.toFixed(1), CLOUD_COARSE: coarse.toFixed(1), CLOUD_NODES: nodes.toFixed(1),
      CLOUD_POWER: clouds.glow_power.toFixed(4), CLOUD_GLOW_RAD: clouds.glow_rad.toFixed(6),
    };
  }

  /** Share of light from a direction that passes. @param {THREE.Vector3} d */
  transmittance(d) {
    return between(this.passed, nodeOf(d, this.fine), this.fine);
  }

  /** Lights the clouds. @param {Lit[]} bodies those that shine @param {number} night its share
   * @param {number} scale of the texture's values */
  update(bodies, night, scale) {
    this.bodies = bodies;
    const { terms, coarse, coefficients, light, halves, steps } = this, area = coarse * coarse, count = 3 * terms;
    const sum = new Float64Array(count), last = coefficients.length - count;
    for (let k = 0; k < count; ++k) sum[k] = night * coefficients[last + k];
    for (const body of bodies) {
      const level = this.table.level(body.trueRad).map((v, c) => v * body.share[c]);
      for (const [place, weight] of placeWeights(this.about.places, body)) {
        for (let k = 0; k < count; ++k) sum[k] += weight * level[k % 3] * coefficients[place * count + k];
      }
    }
    light.forEach((map, c) => {
      map.fill(0);
      for (let k = 0; k < terms; ++k) {
        const factor = sum[3 * k + c], first = k * area;
        for (let i = 0; i < area; ++i) map[i] += factor * steps[first + i];
      }
      for (let i = 0; i < area; ++i) halves[4 * i + c] = toHalf(clamp(map[i] * scale, -65504, 65504));
    });
    this.uniforms.cloud_light.value.needsUpdate = true;
    this.uniforms.cloud_scale.value = 1 / scale;
    bodies.forEach(({ towards, rays }, n) => {
      this.uniforms.cloud_suns.value[n].copy(towards);
      this.uniforms.cloud_rays.value[n].set(...rays);
    });
  }

  /** What stays the same of directions from hour to hour. @param {THREE.Vector3[]} directions */
  seen(directions) {
    return directions.map((d) => {
      const at = nodeOf(d, this.fine), passed = clamp(between(this.passed, at, this.fine), 1e-9, 1);
      return {
        d, low: nodeOf(d, this.coarse), kept: between(this.kept, at, this.fine),
        finer: between(this.finer, at, this.fine), bends: -(passed ** this.about.glow_power) * Math.log(passed),
      };
    });
  }

  /** Puts the clouds before radiances of the sky, in directions that stand for a wide angle.
   * @param {ReturnType<Clouds['seen']>} rays @param {Float64Array} radiance is changed */
  cover(rays, radiance) {
    const { coarse, nodes, wideGlow, light } = this, found = [0, 0, 0];
    rays.forEach(({ d, low, kept, finer, bends }, n) => {
      for (let c = 0; c < 3; ++c) found[c] = radiance[3 * n + c] * kept + finer * between(light[c], low, coarse);
      for (const { towards, rays: irradiance } of this.bodies) {
        const angle = Math.acos(clamp(d.dot(towards), -1, 1));
        const node = Math.sqrt(clamp(angle / this.about.glow_rad, 0, 1)) * (nodes - 1);
        const k = Math.min(Math.floor(node), nodes - 2), t = node - k;
        for (let c = 0; c < 3; ++c) {
          found[c] += bends * irradiance[c] * ((1 - t) * wideGlow[3 * k + c] + t * wideGlow[3 * k + 3 + c]);
        }
      }
      for (let c = 0; c < 3; ++c) radiance[3 * n + c] = Math.max(found[c], 0);
    });
  }
}
