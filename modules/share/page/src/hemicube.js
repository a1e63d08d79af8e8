// Irradiance at a point by all that is seen from it, on the five faces of half a cube (Cohen and
// Greenberg 1985, "The hemi-cube: a radiosity solution for complex environments").
import * as THREE from 'three';

// Texels of an edge of the face before the surface, and of a disc's picture.
const EDGE = 128, DISC_EDGE = 64;
// Width of a disc's picture, in diameters.
const AROUND = 1.2;
// Nearest distance that is drawn, as a share of the near plane's.
const CLOSEST = 0.05;

export class Hemicube {
  /** @param {THREE.WebGLRenderer} renderer
   * @param {THREE.Object3D[]} distant things without a distance, such as the sky */
  constructor(renderer, distant) {
    this.renderer = renderer;
    this.distant = distant;
    const target = (/** @type {number} */ columns, /** @type {number} */ rows) => new THREE.WebGLRenderTarget(
      columns, rows, { type: THREE.FloatType, depthTexture: new THREE.DepthTexture(columns, rows, THREE.FloatType) });
    this.front = { target: target(EDGE, EDGE), weights: frontWeights() };
    /** The upper half of each face at the sides. */
    this.side = { target: target(EDGE, EDGE / 2), weights: sideWeights() };
    const { front, side } = this, sum = (/** @type {Float64Array} */ w) => w.reduce((a, b) => a + b);
    this.disc = { target: target(DISC_EDGE, DISC_EDGE), weights: new Float64Array(DISC_EDGE ** 2) };
    const all = sum(front.weights) + 4 * sum(side.weights);
    for (const { weights } of [front, side]) weights.forEach((w, i) => { weights[i] = Math.PI * w / all; });
    this.camera = new THREE.PerspectiveCamera(90, 1);
  }

  /** Irradiance by channel, in the unit of what is drawn times sr. @param {THREE.Scene} scene
   * @param {THREE.Vector3} eye @param {THREE.Vector3} normal
   * @param {number[]} depths of the nearest and the farthest things that are drawn, m
   * @param {number} turn (rad) of the cube about the normal */
  irradiance(scene, eye, normal, [near, far], turn) {
    const { camera, front, side } = this, sum = [0, 0, 0];
    this.begin(eye, 90, near, far);
    const across = new THREE.Vector3(0, 1, 0).cross(normal);
    if (across.lengthSq() < 1e-6) across.set(1, 0, 0);
    across.normalize().applyAxisAngle(normal, turn);
    this.look(scene, normal, across, front, sum);
    camera.setViewOffset(EDGE, EDGE, 0, 0, EDGE, EDGE / 2);
    for (const towards of [across, normal.clone().cross(across)]) {
      this.look(scene, towards, normal, side, sum);
      this.look(scene, towards.clone().negate(), normal, side, sum);
    }
    return sum;
  }

  /** Irradiance by channel of a plane that faces a disc of the sky, by all that is seen around it.
   * @param {THREE.Scene} scene @param {THREE.Vector3} eye @param {THREE.Vector3} towards
   * @param {number} radius of the disc, rad @param {number[]} depths as of `irradiance` */
  ofDisc(scene, eye, towards, radius, [near, far]) {
    const sum = [0, 0, 0], half = AROUND * Math.tan(radius);
    this.begin(eye, 2 * Math.atan(half) * 180 / Math.PI, near, far);
    this.disc.weights.fill((2 * half / DISC_EDGE) ** 2);
    const up = Math.abs(towards.y) < 0.9 ? new THREE.Vector3(0, 1, 0) : new THREE.Vector3(1, 0, 0);
    this.look(scene, towards, up, this.disc, sum);
    return sum;
  }

  /** @param {THREE.Vector3} eye @param {number} fov degrees @param {number} near @param {number} far m */
  begin(eye, fov, near, far) {
    this.camera.clearViewOffset();
    this.camera.position.copy(eye);
    this.camera.fov = fov;
    this.reach(near, far);
  }

  /** @param {number} near @param {number} far m */
  reach(near, far) {
    Object.assign(this.camera, { near, far });
    this.camera.updateProjectionMatrix();
  }

  /** @param {THREE.Scene} scene @param {THREE.Vector3} towards @param {THREE.Vector3} up
   * @param {{target: THREE.WebGLRenderTarget, weights: Float64Array}} face @param {number[]} sum */
  look(scene, towards, up, { target, weights }, sum) {
    const { camera, renderer } = this, texels = new Float32Array(4 * weights.length);
    const { near, far } = camera;
    camera.up.copy(up);
    camera.lookAt(camera.position.clone().add(towards));
    renderer.setRenderTarget(target);
    renderer.clear();
    renderer.render(scene, camera);
    // What is nearer than the near plane is drawn over it, with depths of its own.
    const hidden = this.distant.filter((thing) => thing.visible);
    hidden.forEach((thing) => { thing.visible = false; });
    this.reach(CLOSEST * near, near);
    renderer.clearDepth();
    renderer.render(scene, camera);
    this.reach(near, far);
    hidden.forEach((thing) => { thing.visible = true; });
    renderer.readRenderTargetPixels(target, 0, 0, target.width, target.height, texels);
    for (let i = 0; i < weights.length; ++i) {
      for (let c = 0; c < 3; ++c) sum[c] += weights[i] * texels[4 * i + c];
    }
  }
}

/** Places of texels' middles along an edge, from -1 to 1. */
const places = () => Array.from({ length: EDGE }, (_, i) => 2 * (i + 0.5) / EDGE - 1);

/** Form factors of the face before the surface, row by row, but for a factor. */
function frontWeights() {
  return Float64Array.from(places().flatMap((y) => places().map((x) => (1 + x * x + y * y) ** -2)));
}

/** Form factors of a side's upper half, rows upwards, but for the same factor. */
function sideWeights() {
  return Float64Array.from(places().slice(EDGE / 2).flatMap((z) => places().map((x) => z * (1 + x * x + z * z) ** -2)));
}
