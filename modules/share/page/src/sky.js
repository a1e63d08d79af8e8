// The sky by the sun's height; share/sky_table.py says how its table is laid out.
import * as THREE from 'three';
import { halfValues } from './data.js';

/** @typedef {{trueRad: number, apparentRad: number, azimuthRad: number, share: number[]}} Body
 * A source of the sky's light: geometric and apparent height, azimuth from -Z clockwise, and its
 * light as a share of the sun's by channel. */

export const HALF_PI = Math.PI / 2;

/** @param {number} x @param {number} low @param {number} high */
export const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

/** @param {number} azimuth from -Z, clockwise @param {number} height @returns {THREE.Vector3} */
export function directionOf(azimuth, height) {
  const level = Math.cos(height);
  return new THREE.Vector3(level * Math.sin(azimuth), Math.sin(height), -level * Math.cos(azimuth));
}

/** Interpolated y of a rising x. @param {number[]} xs @param {number[]} ys @param {number} x */
export function interpolated(xs, ys, x) {
  const [i, t] = placed(xs, x);
  return ys[i] * (1 - t) + ys[i + 1] * t;
}

/** @param {number[]} xs rising @param {number} x @returns {[number, number]} */
export function placed(xs, x) {
  let i = 0;
  while (i < xs.length - 2 && x > xs[i + 1]) ++i;
  return [i, clamp((x - xs[i]) / (xs[i + 1] - xs[i]), 0, 1)];
}

export class SkyTable {
  /** @param {import('./data.js').PageData} data */
  constructor(data) {
    this.about = data.header.sky;
    this.bits = data.array('sky');
    const [layers, rows, columns] = data.shape('sky');
    this.layers = layers; this.rows = rows; this.columns = columns;
    this.lower = this.about.lower;
    this.texture = layered(this.bits, layers, rows, columns);
    this.values = halfValues(this.bits);
    this.air = layered(data.array('air'), layers, rows + this.about.below, columns, 4);
    const [views] = data.shape('optical_depth');
    this.opticalDepth = halves(data.array('optical_depth'), 1, views);
    const [, glowRows, glowColumns] = data.shape('glow');
    this.glow = layered(data.array('glow'), 2, glowRows, glowColumns);
    this.glow.wrapS = THREE.RepeatWrapping;
    this.glowValues = halfValues(data.array('glow'));
    this.glowSize = [glowRows, glowColumns];
    this.glowScale = data.header.glow_scale;
    /** From the world's axes to those that turn with the sky. */
    this.skyFromWorld = new THREE.Matrix3();
    /** Optical depth of the air before stars, towards the zenith. */
    this.extinction = new THREE.Vector3(...(data.header.stars?.extinction || [0, 0, 0]));
  }

  /** Level by channel at a geometric height of the sun. @param {number} trueRad */
  level(trueRad) {
    const [i, t] = placed(this.about.true_rad, trueRad);
    return [0, 1, 2].map((c) => Math.exp(
      (1 - t) * Math.log(this.about.level[i][c]) + t * Math.log(this.about.level[i + 1][c])));
  }

  /** A table's shares of the level, times the level. @param {string} name @param {number} trueRad */
  of(name, trueRad) {
    const [i, t] = placed(this.about.true_rad, trueRad), level = this.level(trueRad);
    const rows = this.about[name];
    return [0, 1, 2].map((c) => (rows[i][c] * (1 - t) + rows[i + 1][c] * t) * level[c]);
  }

  /** Albedo of open ground. @param {number} trueRad */
  albedo(trueRad) {
    const [i, t] = placed(this.about.true_rad, trueRad), rows = this.about.albedo;
    return [0, 1, 2].map((c) => rows[i][c] * (1 - t) + rows[i + 1][c] * t);
  }

  /** Radiances in directions above the horizon, one after the other. @param {Body} body
   * @param {THREE.Vector3[]} directions @param {Float64Array} into which they are added */
  addRadiance(body, directions, into) {
    const { rows, columns, lower, values } = this;
    const sun = Math.max(body.apparentRad, 0), side = Math.sin(body.azimuthRad), front = -Math.cos(body.azimuthRad);
    const [layer, t] = placed(this.about.true_rad, body.trueRad), area = 3 * rows * columns;
    const light = this.level(body.trueRad).map((v, c) => v * body.share[c]);
    directions.forEach((d, n) => {
      const height = Math.asin(clamp(d.y, 0, 1)), across = Math.max(Math.hypot(d.x, d.z), 1e-12);
      const angle = Math.acos(clamp((d.x * side + d.z * front) / across, -1, 1));
      const column = Math.sqrt(angle / Math.PI) * (columns - 1);
      const row = height < sun
        ? Math.acos(1 - 2 * clamp(height / sun, 0, 1)) / Math.PI * (lower - 1)
        : lower + Math.sqrt(clamp((height - sun) / Math.max(HALF_PI - sun, 1e-9), 0, 1)) * (rows - lower - 1);
      const r = Math.min(Math.floor(row), rows - 2), v = row - r;
      const k = Math.min(Math.floor(column), columns - 2), u = column - k;
      const first = layer * area + 3 * (r * columns + k), below = first + 3 * columns;
      for (let c = 0; c < 3; ++c) {
        let sum = 0;
        for (let i = 0; i < 2; ++i) {
          const at = first + i * area + c, under = below + i * area + c;
          sum += (i ? t : 1 - t) * ((1 - v) * ((1 - u) * values[at] + u * values[at + 3])
            + v * ((1 - u) * values[under] + u * values[under + 3]));
        }
        into[3 * n + c] += light[c] * sum;
      }
    });
  }

  /** Radiance of the night's glow. @param {THREE.Vector3} d */
  glowRadiance(d) {
    const [rows, columns] = this.glowSize;
    const row = clamp(Math.round(Math.asin(clamp(d.y, 0, 1)) / HALF_PI * rows - 0.5), 0, rows - 1);
    const turn = (Math.atan2(d.x, -d.z) / (2 * Math.PI) + 1) % 1;
    const column = Math.floor(turn * columns) % columns;
    const own = d.clone().applyMatrix3(this.skyFromWorld);
    const north = clamp(Math.floor((Math.asin(clamp(own.z, -1, 1)) / Math.PI + 0.5) * rows), 0, rows - 1);
    const east = Math.floor((Math.atan2(own.y, own.x) / (2 * Math.PI) + 1) % 1 * columns) % columns;
    const mass = airMass(clamp(d.y, 0, 1));
    return [0, 1, 2].map((c) => this.glowScale * (this.glowValues[(row * columns + column) * 3 + c]
      + Math.exp(-this.extinction.getComponent(c) * mass) * this.glowValues[((rows + north) * columns + east) * 3 + c]));
  }
}

/** Relative air mass (Kasten and Young 1989). @param {number} sine of the height */
const airMass = (sine) => 1 / (sine + 0.50572 * (Math.asin(sine) * 180 / Math.PI + 6.07995) ** -1.6364);

/** @param {Uint16Array} bits @param {number} layers @param {number} rows @param {number} columns
 * @param {number} [channels] */
function layered(bits, layers, rows, columns, channels = 3) {
  const texels = channels === 4 ? bits : fours(bits, layers * rows * columns);
  const found = new THREE.DataArrayTexture(texels, columns, rows, layers);
  found.type = THREE.HalfFloatType;
  found.magFilter = found.minFilter = THREE.LinearFilter;
  found.needsUpdate = true;
  return found;
}

/** @param {Uint16Array} bits @param {number} rows @param {number} columns */
function halves(bits, rows, columns) {
  const found = new THREE.DataTexture(fours(bits, rows * columns), columns, rows, THREE.RGBAFormat,
    THREE.HalfFloatType);
  found.magFilter = found.minFilter = THREE.LinearFilter;
  found.needsUpdate = true;
  return found;
}

/** Texels of four channels. @param {Uint16Array} bits of three @param {number} count */
function fours(bits, count) {
  const rgba = new Uint16Array(4 * count);
  for (let i = 0; i < count; ++i) {
    for (let c = 0; c < 3; ++c) rgba[4 * i + c] = bits[3 * i + c];
  }
  return rgba;
}

/** The open sky's irradiance in an octahedron's unfolded surface, as drawing/open_irradiance.py. */
export class OpenIrradiance {
  /** @param {SkyTable} table @param {import('./clouds.js').Clouds | null} clouds before the sky */
  constructor(table, clouds) {
    this.table = table;
    this.clouds = clouds;
    this.size = 12;
    this.values = new Float32Array(this.size * this.size * 4);
    this.texture = new THREE.DataTexture(this.values, this.size, this.size, THREE.RGBAFormat,
      THREE.FloatType);
    this.rays = spiral(768);
    this.behind = clouds ? clouds.seen(this.rays) : [];
    this.heights = Float32Array.from(this.rays, (d) => d.y);
    this.normals = Array.from({ length: this.size ** 2 }, (_, node) => octahedral(
      2 * (node % this.size) / (this.size - 1) - 1, 2 * Math.floor(node / this.size) / (this.size - 1) - 1, new THREE.Vector3()));
    /** Cosines of the rays to each normal. */
    this.cosines = this.normals.map((n) => Float32Array.from(this.rays, (d) => Math.max(n.dot(d), 0)));
    /** Irradiance of level ground by the sky, and its ratio to that of a clear sky. */
    this.up = [0, 0, 0];
    this.left = 1;
  }

  /** Irradiance of directions by sky and ground.
   * @param {Body[]} bodies @param {number} night
   * @param {(up: number[]) => number[]} groundOf the ground's radiance by that irradiance of level ground
   * @param {number} scale of the texture's values */
  update(bodies, night, groundOf, scale) {
    const { rays, cosines, size } = this, radiance = new Float64Array(3 * rays.length);
    if (night > 0) {
      rays.forEach((d, i) => this.table.glowRadiance(d).forEach((v, c) => { radiance[3 * i + c] = v * night; }));
    }
    for (const body of bodies) this.table.addRadiance(body, rays, radiance);
    const weight = 2 * Math.PI / rays.length;
    const sum = (/** @type {Float32Array} */ shares) => {
      let r = 0, g = 0, b = 0;
      for (let i = 0, k = 0; i < shares.length; ++i, k += 3) {
        const share = shares[i];
        r += share * radiance[k];
        g += share * radiance[k + 1];
        b += share * radiance[k + 2];
      }
      return [weight * r, weight * g, weight * b];
    };
    this.up = sum(this.heights);
    if (this.clouds) {
      const clear = this.up[1];
      this.clouds.cover(this.behind, radiance);
      this.up = sum(this.heights);
      this.left = this.up[1] / Math.max(clear, 1e-30);
    }
    const ground = groundOf(this.up);
    for (let node = 0; node < size * size; ++node) {
      const below = Math.PI * 0.5 * (1 - this.normals[node].y);
      sum(cosines[node]).forEach((v, c) => { this.values[4 * node + c] = (v + below * ground[c]) * scale; });
    }
    this.texture.needsUpdate = true;
  }
}

/** A direction by its place on an octahedron's unfolded surface. @param {number} x @param {number} z
 * @param {THREE.Vector3} out */
export function octahedral(x, z, out) {
  const y = 1 - Math.abs(x) - Math.abs(z);
  if (y < 0) {
    const a = (1 - Math.abs(z)) * (x < 0 ? -1 : 1), b = (1 - Math.abs(x)) * (z < 0 ? -1 : 1);
    return out.set(a, y, b).normalize();
  }
  return out.set(x, y, z).normalize();
}

/** Directions of equal solid angle over the upper hemisphere. @param {number} count */
function spiral(count) {
  return Array.from({ length: count }, (_, i) => {
    const y = (i + 0.5) / count, level = Math.sqrt(1 - y * y), turn = i * 2.399963229728653;
    return new THREE.Vector3(level * Math.cos(turn), y, level * Math.sin(turn));
  });
}
