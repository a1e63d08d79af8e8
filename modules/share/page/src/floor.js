// Floors to stand on: surfaces met by rays, found by drawing them into a few texels.
import * as THREE from 'three';
import { PLACE_FRAGMENT, PLACE_VERTEX, program } from './shaders.js';

/** Layer of cameras that sees opaque surfaces alone. */
export const SURFACES = 1;
// Half width (m) of the square under a standing person, and its texels across.
const HALF_WIDTH_M = 0.2, TEXELS = 5;
// Room (m) above a floor, largest step (m) within the square, and cosine of the steepest slope.
const HEADROOM_M = 1.7, STEP_M = 0.25, LEVEL = Math.cos(20 * Math.PI / 180);
// Distance (m) from which on surfaces are seen, and farthest place that a hand points to.
const NEAR_M = 0.01, REACH_M = 100;

export class Floor {
  /** @param {THREE.WebGLRenderer} renderer @param {THREE.Scene} scene whose opaque surfaces are
   * on the layer `SURFACES` */
  constructor(renderer, scene) {
    this.renderer = renderer;
    this.scene = scene;
    this.material = program(PLACE_VERTEX, PLACE_FRAGMENT, {}, {}, { side: THREE.DoubleSide });
    const target = (/** @type {number} */ edge) =>
      new THREE.WebGLRenderTarget(edge, edge, { type: THREE.FloatType });
    this.one = target(1);
    this.square = target(TEXELS);
    this.ray = new THREE.PerspectiveCamera(0.1, 1, NEAR_M, REACH_M);
    this.down = new THREE.OrthographicCamera();
    for (const camera of [this.ray, this.down]) camera.layers.set(SURFACES);
  }

  /** Where a ray meets a surface, or null. @param {THREE.Vector3} from
   * @param {THREE.Vector3} direction @returns {THREE.Vector3 | null} */
  hit(from, direction) {
    const { ray } = this;
    ray.position.copy(from);
    ray.up.set(0, 0, Math.abs(direction.y) > 0.9 ? 1 : 0);
    if (!ray.up.z) ray.up.y = 1;
    ray.lookAt(from.clone().add(direction));
    const [x, y, z, found] = this.places(ray, this.one);
    return found > 0 ? new THREE.Vector3(x, y, z) : null;
  }

  /** The floor under a point, or null where there is none. @param {THREE.Vector3} point
   * @returns {THREE.Vector3 | null} */
  under(point) {
    return this.hit(point, new THREE.Vector3(0, -1, 0));
  }

  /** Whether a person stands at a point of a surface: the square around it is level and free up to
   * the head. @param {THREE.Vector3} point */
  holds(point) {
    const { down } = this;
    Object.assign(down, {
      left: -HALF_WIDTH_M, right: HALF_WIDTH_M, top: HALF_WIDTH_M, bottom: -HALF_WIDTH_M,
      near: 0, far: HEADROOM_M + STEP_M,
    });
    down.updateProjectionMatrix();
    down.position.copy(point).y += HEADROOM_M;
    down.up.set(0, 0, -1);
    down.lookAt(point);
    const places = this.places(down, this.square);
    for (let i = 0; i < places.length; i += 4) {
      if (places[i + 3] - 2 < LEVEL || Math.abs(places[i + 1] - point.y) > STEP_M) return false;
    }
    return true;
  }

  /** World positions of what a camera sees, and the height of their normals plus 2; 0 for nothing.
   * @param {THREE.Camera} camera @param {THREE.WebGLRenderTarget} target */
  places(camera, target) {
    const { renderer, scene } = this, texels = new Float32Array(4 * target.width * target.height);
    renderer.setClearAlpha(0);
    renderer.setRenderTarget(target);
    renderer.clear();
    scene.overrideMaterial = this.material;
    renderer.render(scene, camera);
    scene.overrideMaterial = null;
    renderer.setClearAlpha(1);
    renderer.readRenderTargetPixels(target, 0, 0, target.width, target.height, texels);
    return texels;
  }
}
