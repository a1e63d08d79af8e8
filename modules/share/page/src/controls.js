// Looking around: orbit about a point, or walk; by mouse, touch and keys.
import * as THREE from 'three';
import { clamp } from './sky.js';

export class Controls {
  /** @param {THREE.PerspectiveCamera} camera @param {HTMLElement} element
   * @param {{lower: number[], upper: number[]}} bounds @param {() => void} moved */
  constructor(camera, element, bounds, moved) {
    this.camera = camera;
    this.moved = moved;
    this.walks = false;
    this.target = new THREE.Vector3();
    this.size = Math.hypot(...bounds.lower.map((low, i) => bounds.upper[i] - low));
    /** @type {Map<number, {x: number, y: number}>} */
    this.fingers = new Map();
    /** @type {Set<string>} */
    this.keys = new Set();
    element.addEventListener('pointerdown', (event) => {
      element.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    element.addEventListener('pointermove', (event) => this.drag(event, element));
    for (const end of ['pointerup', 'pointercancel']) {
      element.addEventListener(end, (event) =>
        this.fingers.delete(/** @type {PointerEvent} */ (event).pointerId));
    }
    element.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(Math.exp(clamp(event.deltaY, -200, 200) * 0.0015));
    }, { passive: false });
    element.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  /** @param {{eye_m: number[], target_m: number[], vertical_field_of_view_deg: number}} view */
  look(view) {
    this.camera.position.set(view.eye_m[0], view.eye_m[1], view.eye_m[2]);
    this.target.set(view.target_m[0], view.target_m[1], view.target_m[2]);
    this.camera.fov = view.vertical_field_of_view_deg;
    this.apply();
  }

  apply() {
    this.camera.lookAt(this.target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.moved();
  }

  /** @param {number} factor of the distance */
  zoom(factor) {
    if (this.walks) return this.step(0, 0, (1 - factor) * 0.05 * this.size);
    this.camera.position.sub(this.target).multiplyScalar(clamp(factor, 0.5, 2)).add(this.target);
    return this.apply();
  }

  /** @param {number} right @param {number} up @param {number} ahead metres */
  step(right, up, ahead) {
    const forward = this.camera.getWorldDirection(new THREE.Vector3());
    if (this.walks) forward.setY(0).normalize();
    const side = new THREE.Vector3().crossVectors(forward, new THREE.Vector3(0, 1, 0)).normalize();
    const move = forward.multiplyScalar(ahead).addScaledVector(side, right).add(new THREE.Vector3(0, up, 0));
    this.camera.position.add(move);
    this.target.add(move);
    this.apply();
  }

  /** @param {number} turn @param {number} tilt radians */
  turn(turn, tilt) {
    const pivot = this.walks ? this.camera.position : this.target;
    const other = this.walks ? this.target : this.camera.position;
    const off = other.clone().sub(pivot), round = new THREE.Spherical().setFromVector3(off);
    round.theta -= turn;
    round.phi = clamp(round.phi + (this.walks ? 1 : -1) * tilt, 0.02, Math.PI - 0.02);
    other.copy(pivot).add(off.setFromSpherical(round));
    this.apply();
  }

  /** @param {PointerEvent} event @param {HTMLElement} element */
  drag(event, element) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before.x, dy = event.clientY - before.y;
    if (this.fingers.size === 2) {
      const [a, b] = [...this.fingers.values()], wide = Math.hypot(a.x - b.x, a.y - b.y);
      before.x = event.clientX; before.y = event.clientY;
      const now = Math.hypot(a.x - b.x, a.y - b.y);
      this.pan(dx / 2, dy / 2, element);
      if (now > 0) this.zoom(wide / now);
      return;
    }
    before.x = event.clientX; before.y = event.clientY;
    if (event.buttons & 6 || event.shiftKey) this.pan(dx, dy, element);
    else {
      const rate = (this.walks ? -1 : 1) * 2.4 / element.clientHeight;
      this.turn(dx * rate, dy * rate * (this.walks ? -1 : 1));
    }
  }

  /** @param {number} dx @param {number} dy @param {HTMLElement} element */
  pan(dx, dy, element) {
    const reach = this.camera.position.distanceTo(this.target);
    const metres = 2 * reach * Math.tan(this.camera.fov * Math.PI / 360) / element.clientHeight;
    const side = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const up = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    const move = side.multiplyScalar(-dx * metres).addScaledVector(up, dy * metres);
    this.camera.position.add(move);
    this.target.add(move);
    this.apply();
  }

  /** Moves by held keys. @param {number} seconds */
  advance(seconds) {
    const { keys } = this;
    if (!keys.size) return false;
    const way = seconds * (this.walks ? 1.6 : 0.3 * this.size);
    const right = Number(keys.has('d')) - Number(keys.has('a'));
    const ahead = Number(keys.has('w')) - Number(keys.has('s'));
    const up = Number(keys.has('e')) - Number(keys.has('q'));
    this.step(right * way, up * way, ahead * way);
    return true;
  }
}
