// What a headset shows beside the scene: rays of the hands, the ring of the aim, the clock.
import * as THREE from 'three';
import { white } from './scene.js';
import { MARK_FRAGMENT, MARK_VERTEX, program } from './shaders.js';

// Length (m) of a hand's ray that aims at nothing; radii (m) of the ring.
const IDLE_M = 0.25, RING_M = [0.22, 0.3];
// Size (m) of the clock's panel, its texels, and its place above the hand.
const PANEL_M = [0.14, 0.08], PANEL_PX = [448, 256], PANEL_AT = [0, 0.09, -0.03], TILT_RAD = -0.6;
// Display values of the marks.
const WHITE = [1, 1, 1], GOES = [0.35, 0.9, 0.5], REFUSED = [0.9, 0.3, 0.25];

/** @param {THREE.BufferGeometry} geometry @param {THREE.Texture} picture */
function mark(geometry, picture) {
  const material = program(MARK_VERTEX, MARK_FRAGMENT, {
    picture: { value: picture }, tint: { value: new THREE.Vector3(...WHITE) },
  }, {}, { side: THREE.DoubleSide });
  const found = new THREE.Mesh(geometry, material);
  Object.assign(found, { matrixAutoUpdate: false, frustumCulled: false, visible: false });
  return found;
}

export class Marks {
  constructor() {
    this.group = new THREE.Group();
    const thin = new THREE.BoxGeometry(0.004, 0.004, 1).translate(0, 0, -0.5);
    this.rays = [mark(thin, white), mark(thin, white)];
    this.ring = mark(new THREE.RingGeometry(RING_M[0], RING_M[1], 48).rotateX(-Math.PI / 2), white);
    this.paper = document.createElement('canvas');
    [this.paper.width, this.paper.height] = PANEL_PX;
    this.text = '';
    this.print = new THREE.CanvasTexture(this.paper);
    this.panel = mark(new THREE.PlaneGeometry(PANEL_M[0], PANEL_M[1]), this.print);
    this.above = new THREE.Matrix4().makeRotationX(TILT_RAD)
      .setPosition(PANEL_AT[0], PANEL_AT[1], PANEL_AT[2]);
    this.group.add(...this.rays, this.ring, this.panel);
  }

  hide() {
    for (const one of this.group.children) one.visible = false;
  }

  /** @param {number} number of the hand @param {THREE.Matrix4} pose in world axes, along -Z
   * @param {number} [metres] */
  showRay(number, pose, metres = IDLE_M) {
    this.place(this.rays[number], pose.clone().scale(new THREE.Vector3(1, 1, metres)));
  }

  /** @param {THREE.Vector3} point @param {boolean} goes whether a person can go there */
  showRing(point, goes) {
    this.ring.material.uniforms.tint.value.set(...(goes ? GOES : REFUSED));
    this.place(this.ring, new THREE.Matrix4().setPosition(point.x, point.y + 0.02, point.z));
  }

  /** @param {THREE.Matrix4} hand its pose in world axes @param {string[]} lines the clock first */
  showClock(hand, lines) {
    this.write(lines);
    this.place(this.panel, hand.clone().multiply(this.above));
  }

  /** @param {THREE.Mesh} one @param {THREE.Matrix4} pose */
  place(one, pose) {
    one.matrix.copy(pose);
    one.updateMatrixWorld(true);
    one.visible = true;
  }

  /** @param {string[]} lines */
  write(lines) {
    const text = lines.join('\n'), pen = this.paper.getContext('2d');
    if (text === this.text || !pen) return;
    this.text = text;
    const [wide, high] = PANEL_PX;
    pen.fillStyle = '#1e1f24';
    pen.fillRect(0, 0, wide, high);
    pen.fillStyle = '#fff';
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    lines.forEach((line, i) => {
      pen.font = `${i ? 36 : 96}px system-ui, sans-serif`;
      pen.fillText(line, wide / 2, i ? 120 + 56 * i : 80, wide - 24);
    });
    this.print.needsUpdate = true;
  }
}
