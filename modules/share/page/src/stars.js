// Stars over the scene: points of light that turn with the sky, behind the air.
import * as THREE from 'three';
import { Body, Illumination } from 'astronomy-engine';
import { directionOf } from './sky.js';
import { STAR_FRAGMENT, STAR_VERTEX, program } from './shaders.js';

const DAY_MS = 86400000;

/** The matrix from the axes of share/page_stars.py to the world's.
 * @param {number} turned radians by which the sky has turned since its instant
 * @param {number} latitude @param {number} northOffset radians */
export function worldFromSky(turned, latitude, northOffset) {
  const sine = Math.sin(latitude), cosine = Math.cos(latitude);
  const x = Math.cos(turned), y = Math.sin(turned);
  const east = [-y, x, 0], north = [-sine * x, -sine * y, cosine], up = [cosine * x, cosine * y, sine];
  const along = Math.cos(northOffset), across = Math.sin(northOffset);
  return [
    east.map((v, k) => along * v - across * north[k]), up,
    east.map((v, k) => -(along * north[k] + across * v)),
  ].flat();
}

export class Stars {
  /** @param {import('./data.js').PageData} data @param {import('./sun.js').Ephemeris} ephemeris
   * @param {Record<string, THREE.IUniform>} uniforms of all passes
   * @param {Record<string, any>} [defines] of clouds */
  constructor(data, ephemeris, uniforms, defines = {}) {
    this.ephemeris = ephemeris;
    const { place, stars } = data.header;
    this.about = stars;
    this.place = place;
    const values = data.array('stars'), fixed = values.length / 6;
    /** Planets come after the stars. */
    this.planets = stars.planet_light ? stars.planets : [];
    const count = fixed + this.planets.length;
    const directions = new Float32Array(3 * count), light = new Float32Array(3 * count);
    for (let n = 0; n < fixed; ++n) {
      directions.set(values.subarray(6 * n, 6 * n + 3), 3 * n);
      light.set(values.subarray(6 * n + 3, 6 * n + 6), 3 * n);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(directions, 3));
    geometry.setAttribute('light', new THREE.BufferAttribute(light, 3));
    this.geometry = geometry;
    this.fixed = fixed;
    /** From axes that turn with the sky to the world's. */
    this.world = { value: new THREE.Matrix3() };
    this.night = { value: 0 };
    this.size = { value: new THREE.Vector2(1, 1) };
    this.points = new THREE.Points(geometry, program(STAR_VERTEX, STAR_FRAGMENT, {
      ...uniforms, world_from_sky: this.world, night: this.night, size_px: this.size,
      extinction: { value: new THREE.Vector3(...stars.extinction) }, refraction: { value: ephemeris.air },
    }, defines, {
      transparent: true, depthWrite: false, depthFunc: THREE.LessEqualDepth, blending: THREE.CustomBlending,
      blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor, blendSrcAlpha: THREE.ZeroFactor,
      blendDstAlpha: THREE.OneFactor, blendEquation: THREE.AddEquation,
    }));
    Object.assign(this.points, { matrixAutoUpdate: false, frustumCulled: false, visible: false });
  }

  /** @param {Date} date @param {number} night share of the night's light */
  setHour(date, night) {
    const turned = 2 * Math.PI * this.about.turns_a_day * (date.getTime() - 1000 * this.about.seconds) / DAY_MS;
    const latitude = this.place.latitude_deg * Math.PI / 180;
    this.world.value.fromArray(worldFromSky(turned % (2 * Math.PI), latitude, this.place.north_offset_rad)).transpose();
    this.night.value = night;
    this.points.visible = night > 0;
    if (!this.points.visible) return;
    const place = this.geometry.getAttribute('position'), light = this.geometry.getAttribute('light');
    const toSky = this.world.value.clone().transpose();
    this.planets.forEach((/** @type {keyof typeof Body} */ name, /** @type {number} */ n) => {
      const { azimuthRad, trueRad } = this.ephemeris.place(Body[name], date);
      const d = directionOf(azimuthRad, trueRad).applyMatrix3(toSky);
      const dimmer = 10 ** (-0.4 * Illumination(Body[name], date).mag);
      const [r, g, b] = this.about.planet_light[n];
      place.setXYZ(this.fixed + n, d.x, d.y, d.z);
      light.setXYZ(this.fixed + n, r * dimmer, g * dimmer, b * dimmer);
    });
    if (this.planets.length) place.needsUpdate = light.needsUpdate = true;
  }
}
