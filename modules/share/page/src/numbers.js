// Numbers of `vrut-lite daylight` at places of the scene: coloured tiles, and the number under the
// pointer.
import * as THREE from 'three';
import { NUMBER_FRAGMENT, NUMBER_VERTEX, program } from './shaders.js';

// Edge of a tile as a share of the grid's step, and how far it stands before its place, of that too.
const EDGE = 0.8, BEFORE = 0.02;
// Pixels from the pointer within which a place is meant.
const NEAR_PX = 24;

export class Numbers {
  /** @param {import('./data.js').PageData} data @param {Record<string, THREE.IUniform>} uniforms factor on
   * radiance in the target, radiance of tiles for the meter, shift of the picture */
  constructor(data, uniforms) {
    this.about = data.header.numbers;
    this.values = data.array('numbers');
    this.places = data.array('number_places');
    this.count = this.places.length / 6;
    /** Number of the quantity that is shown; -1: none. */
    this.shown = -1;
    this.range = [0, 1];
    this.shares = new THREE.BufferAttribute(new Float32Array(4 * this.count), 1);
    this.mesh = new THREE.Mesh(this.tiles(), program(NUMBER_VERTEX, NUMBER_FRAGMENT, uniforms, {}, {
      side: THREE.DoubleSide,
    }));
    Object.assign(this.mesh, { matrixAutoUpdate: false, frustumCulled: false, visible: false });
  }

  /** Squares about the places, across their directions. */
  tiles() {
    const half = 0.5 * EDGE * this.about.spacing_m, corners = new Float32Array(12 * this.count);
    const index = new Uint32Array(6 * this.count), normal = new THREE.Vector3();
    const place = new THREE.Vector3(), right = new THREE.Vector3(), up = new THREE.Vector3();
    for (let n = 0; n < this.count; ++n) {
      place.fromArray(this.places, 6 * n);
      normal.fromArray(this.places, 6 * n + 3);
      right.set(0, 1, 0).cross(normal);
      if (right.lengthSq() < 1e-6) right.set(1, 0, 0);
      right.normalize();
      up.copy(normal).cross(right);
      place.addScaledVector(normal, BEFORE * this.about.spacing_m);
      for (let k = 0; k < 4; ++k) {
        const [x, y] = [k & 1 ? half : -half, k & 2 ? half : -half];
        place.clone().addScaledVector(right, x).addScaledVector(up, y).toArray(corners, 12 * n + 3 * k);
      }
      index.set([0, 1, 2, 2, 1, 3].map((k) => 4 * n + k), 6 * n);
    }
    const found = new THREE.BufferGeometry();
    found.setAttribute('position', new THREE.BufferAttribute(corners, 3));
    found.setAttribute('share', this.shares);
    found.setIndex(new THREE.BufferAttribute(index, 1));
    return found;
  }

  /** Shows a quantity, or none. @param {number} number */
  show(number) {
    this.shown = number;
    this.mesh.visible = number >= 0;
    if (number < 0) return;
    const own = this.of(number), sorted = own.filter(Number.isFinite).sort();
    const high = sorted[Math.ceil(0.99 * (sorted.length - 1))];
    this.range = [Math.min(sorted[0], 0), high > sorted[0] ? high : sorted[0] + 1];
    const [low, top] = this.range, shares = this.shares.array;
    // Without a value no tile: its corners fall together in the shader.
    own.forEach((/** @type {number} */ v, /** @type {number} */ n) => {
      const share = Number.isFinite(v) ? Math.min(Math.max((v - low) / (top - low), 0), 1) : -1;
      for (let k = 0; k < 4; ++k) shares[4 * n + k] = share;
    });
    this.shares.needsUpdate = true;
  }

  /** @param {number} number @returns {Float32Array} a quantity's values */
  of(number) {
    return this.values.slice(number * this.count, (number + 1) * this.count);
  }

  /** A value as people write it. @param {number} value */
  text(value) {
    const size = Math.abs(value);
    const said = size >= 100 ? Math.round(value).toLocaleString('en') : String(Number(value.toPrecision(2)));
    return `${said} ${this.about.units[this.shown]}`.trim();
  }

  /** The number nearest to a point of the picture, or "". @param {THREE.Camera} camera
   * @param {number} x @param {number} y pixels from the upper left @param {number} width
   * @param {number} height */
  at(camera, x, y, width, height) {
    if (this.shown < 0) return '';
    const own = this.of(this.shown), p = new THREE.Vector3();
    let best = NEAR_PX * NEAR_PX, found = NaN;
    for (let n = 0; n < this.count; ++n) {
      p.fromArray(this.places, 6 * n).project(camera);
      if (Math.abs(p.z) > 1) continue;
      const dx = (0.5 + 0.5 * p.x) * width - x, dy = (0.5 - 0.5 * p.y) * height - y;
      if (dx * dx + dy * dy < best && Number.isFinite(own[n])) {
        best = dx * dx + dy * dy;
        found = own[n];
      }
    }
    return Number.isFinite(found) ? this.text(found) : '';
  }
}
