// Illuminance at a point of the picture: at once by the light map, or by all that is seen from there.
import * as THREE from 'three';
import { Hemicube } from './hemicube.js';
import { keptTarget, luminance } from './picture.js';
import { CLEAR } from './scene.js';
import { octahedral } from './sky.js';

const LUMENS_PER_WATT = 683;
// Distance (m) between a surface and the eye that looks from it, and the most as a share of the
// scene's size. From a millimetre SwiftShader draws walls that end behind the eye 15 texels too long.
const OFF_SURFACE_M = 0.015, MOST_OFF = 2e-3;
// Turns of the half cube, the median of which counts: in a few of them a leak of a shadow map or an
// end of a wall falls on bright texels.
const TURNS_RAD = [0, Math.PI / 6, Math.PI / 3];

export class PointLux {
  /** @param {import('./picture.js').Picture} picture */
  constructor(picture) {
    this.picture = picture;
    this.probe = new THREE.WebGLRenderTarget(1, 1, { type: THREE.FloatType });
    this.place = keptTarget(1, 1);
    this.hemicube = new Hemicube(picture.renderer,
      picture.stars ? [picture.skyPass, picture.stars.points] : [picture.skyPass]);
  }

  /** Lux by the light map; NaN in the sky. @param {number} x @param {number} y CSS pixels */
  byMap(x, y) {
    const { light, renderer, scene, shared } = this.picture, before = shared.values_shown.value;
    light.map.complete();
    shared.values_shown.value = 1;
    this.draw(scene, this.probe, x, y);
    shared.values_shown.value = before;
    const texel = new Float32Array(4);
    renderer.readRenderTargetPixels(this.probe, 0, 0, 1, 1, texel);
    return texel[0] < 0 ? NaN : texel[0];
  }

  /** Lux by all that is seen from a place of the picture; NaN in the sky. Next to edges it is closer
   * than the light map's, whose texels are too wide there.
   * @param {number} x @param {number} y CSS pixels */
  gathered(x, y) {
    const { camera, header, keptScene, renderer } = this.picture;
    renderer.setClearAlpha(0);
    camera.layers.enable(CLEAR);
    this.draw(keptScene, this.place, x, y);
    camera.layers.disable(CLEAR);
    renderer.setClearAlpha(1);
    const [where, normals] = [0, 2].map((texture) => {
      const texel = new Uint32Array(4);
      renderer.readRenderTargetPixels(this.place, 0, 0, 1, 1, texel, undefined, texture);
      return texel;
    });
    if (!where[3]) return NaN;
    const [px, py, pz] = new Float32Array(where.buffer), [even, face] = [normals[1], normals[2]].map(folded);
    const off_m = Math.min(OFF_SURFACE_M, MOST_OFF * header.scene.size_m);
    const eye = new THREE.Vector3(px, py, pz).addScaledVector(face, off_m);
    return LUMENS_PER_WATT * luminance(this.irradiance(eye, even, face));
  }

  /** Irradiance (W m^-2) by all that is seen from a point: half a cube without the key light's disc,
   * and the disc, as the difference of two pictures with and without it.
   * @param {THREE.Vector3} eye @param {THREE.Vector3} normal @param {THREE.Vector3} face its normal */
  irradiance(eye, normal, face) {
    const { depths, keyDirection, keyRadius, scene, shared, skyPass } = this.picture;
    const { pre, values_shown: shown, diffuse_shown: diffuse, mirror_scale: level } = shared;
    const disc = /** @type {THREE.RawShaderMaterial} */ (skyPass.material).uniforms.disc_radiance.value;
    const before = [pre.value, shown.value, disc.clone()], hidden = this.picture.hideMarks();
    shown.value = 0;
    diffuse.value = true;
    const cosine = keyDirection.dot(face) > 0 ? Math.max(keyDirection.dot(normal), 0) : 0;
    const ofDisc = () => (cosine ? this.hemicube.ofDisc(scene, eye, keyDirection, keyRadius, depths) : [0, 0, 0]);
    // Pictures end at 6e4, which the disc's own radiance exceeds.
    const brightest = Math.max(...disc.toArray(), 1e-30);
    pre.value = 1 / brightest;
    const bright = ofDisc();
    disc.set(0, 0, 0);
    const dark = ofDisc();
    pre.value = 1 / level.value;
    // The picture's own depths: a tenth of the nearest one puts the ground before floors and walls.
    const found = TURNS_RAD.map((turn) => this.hemicube.irradiance(scene, eye, normal, depths, turn))
      .sort((a, b) => luminance(a) - luminance(b))[TURNS_RAD.length >> 1];
    disc.copy(before[2]);
    diffuse.value = false;
    [pre.value, shown.value] = before;
    hidden.forEach((thing) => { thing.visible = true; });
    return found.map((v, c) => level.value * v + brightest * cosine * Math.max(bright[c] - dark[c], 0));
  }

  /** Draws one pixel of the picture. @param {THREE.Scene} scene @param {THREE.WebGLRenderTarget} target
   * @param {number} x @param {number} y CSS pixels */
  draw(scene, target, x, y) {
    const { camera, ratio, renderer, shared, size: [w, h] } = this.picture;
    camera.setViewOffset(w, h, Math.floor(x * ratio), Math.floor(y * ratio), 1, 1);
    shared.jitter.value.set(0, 0);
    renderer.setRenderTarget(target);
    renderer.clear();
    renderer.render(scene, camera);
    camera.clearViewOffset();
  }
}

/** A direction by two numbers on an octahedron's unfolded surface, 16 bits each.
 * @param {number} bits */
function folded(bits) {
  const [x, z] = [bits << 16 >> 16, bits >> 16].map((v) => Math.max(v / 32767, -1));
  return octahedral(x, z, new THREE.Vector3());
}
