// The picture of an hour: light map, sky, shadows, surfaces, exposure and display.
import * as THREE from 'three';
import { Clouds } from './clouds.js';
import { adaptedCd, automaticEv, scaleOf } from './exposure.js';
import { LightMap } from './light.js';
import { Numbers } from './numbers.js';
import { PointLux } from './point_lux.js';
import { sceneOf } from './scene.js';
import {
  COPY_FRAGMENT, CUBE_FRAGMENT, SKY_FRAGMENT, SKY_VERTEX, TONE_FRAGMENT, fullScreen, program,
} from './shaders.js';
import { OpenIrradiance, SkyTable, directionOf, placed } from './sky.js';
import { Stars } from './stars.js';
import { RELIGHT_FRAGMENT } from './surface_shaders.js';
import { Ephemeris, moonAxes, nightShare, sunShare, visible } from './sun.js';

// Factor on lux in half floats: sunlight has more than these hold.
const LUX_SCALE = 1 / 8;
// Least and most that moving pictures of a processor are coarser, and seconds of a picture below and
// above which that changes: twenty a second.
const COARSER = [2, 5], PACE_S = [0.025, 0.05];
// Linear value, 1 being white, that the meter sees of tiles with numbers.
const GREY = 0.18;
// Turn of the key light (rad), two minutes of the day, within which drafts keep their shadow map.
const DRAFT_TURN_RAD = 0.0087;
// Texels of an edge of drafts' shadow map, and of the cubes in which surfaces mirror the sky.
const DRAFT_SHADOW_EDGE = 640, CUBE_EDGE = 64, METER = [128, 72], DRAFT_METER = [64, 36], STILLS = 16;
const WEIGHTS = [0.2126390058715104, 0.7151686787677559, 0.07219231536073371];
export const luminance = (/** @type {number[]} */ c) => c[0] * WEIGHTS[0] + c[1] * WEIGHTS[1] + c[2] * WEIGHTS[2];

/** @param {number[]} rows of a 3 x 3 matrix, row after row */
const matrix = (rows) => new THREE.Matrix3().fromArray(rows).transpose();

export class Picture {
  /** @param {import('./data.js').PageData} data @param {HTMLCanvasElement} canvas */
  constructor(data, canvas) {
    const { header } = data;
    this.header = header;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false, alpha: false });
    this.renderer.autoClear = false;
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    const gl = this.renderer.getContext();
    const about = gl.getExtension('WEBGL_debug_renderer_info');
    const name = about ? String(gl.getParameter(about.UNMASKED_RENDERER_WEBGL)) : '';
    /** Whether a processor draws. */
    this.soft = /swiftshader|llvmpipe|software|basic render/i.test(name);
    this.table = new SkyTable(data);
    this.light = new LightMap(data, this.table, this.soft);
    /** Frozen clouds of pages that have them. */
    this.clouds = header.clouds ? new Clouds(data, this.table) : null;
    this.open = new OpenIrradiance(this.table, this.clouds);
    this.ephemeris = new Ephemeris(header.place, header.moon);
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.05, 1e5);
    this.exposure = { automatic: true, ev: 12, compensation: 0 };
    this.ev = 12;
    this.values = false;
    this.stillCount = 0;
    this.keyDirection = new THREE.Vector3(0, 1, 0);
    this.softRadius = 0.0045;
    this.white = 0;
    const [columns, rows] = [this.table.columns, this.table.rows];
    this.defines = {
      COLUMNS: columns.toFixed(1), ROWS: rows.toFixed(1), LOWER: this.table.lower.toFixed(1),
      BELOW: header.sky.below.toFixed(1),
      ...this.clouds?.defines,
      GLOW_BEGINS: Math.cos(header.glow_rad).toFixed(6), GLOW_WHOLE: Math.cos(0.5 * header.glow_rad).toFixed(6),
    };
    const tone = header.tone;
    const sky = data.array('visible_sky'), [mapHeight, mapWidth] = data.shape('visible_sky');
    const skyTexture = new THREE.DataTexture(sky, mapWidth, mapHeight, THREE.RGBAFormat,
      THREE.HalfFloatType);
    skyTexture.magFilter = skyTexture.minFilter = THREE.LinearFilter;
    skyTexture.needsUpdate = true;
    const tableEdge = data.shape('reflectance')[0];
    const reflectance = new THREE.DataTexture(data.array('reflectance'), tableEdge, tableEdge,
      THREE.RGBAFormat, THREE.HalfFloatType);
    reflectance.magFilter = reflectance.minFilter = THREE.LinearFilter;
    reflectance.needsUpdate = true;
    this.near = nearnessOf(data);
    this.fineCubes = skyCubes(CUBE_EDGE, CUBE_EDGE);
    /** For an hour that moves: a processor takes a sixth of the time. */
    this.draftCubes = this.soft ? skyCubes(CUBE_EDGE / 2, CUBE_EDGE / 4) : this.fineCubes;
    this.fineShadow = shadowTarget(this.soft ? 2048 : 4096);
    /** For an hour that moves: a processor takes a tenth of the time. */
    this.draftShadow = this.soft ? shadowTarget(DRAFT_SHADOW_EDGE) : this.fineShadow;
    this.shadow = this.fineShadow;
    /** Direction of the key light in the shadow map; 0 in a map without light. */
    this.shadowTowards = new THREE.Vector3();
    const edge = this.fineShadow.width;
    this.tinted = new THREE.WebGLRenderTarget(edge / 2, edge / 2, { depthBuffer: false });
    const body = () => ({ light: new THREE.Vector3(), azimuth: new THREE.Vector2(), height: 0, layer: 0, share: 0 });
    /** @type {Record<string, THREE.IUniform>} */
    this.shared = {
      bodies: { value: [body(), body()] },
      body_count: { value: 0 },
      sky_table: { value: this.table.texture },
      glow_map: { value: this.table.glow },
      glow: { value: 0 },
      sky_from_world: { value: this.table.skyFromWorld },
      star_extinction: { value: this.table.extinction },
      ...this.clouds?.uniforms,
      below_horizon: { value: new THREE.Vector3() },
      air_table: { value: this.table.air },
      near_air: { value: this.fineCubes.air.texture },
      air_scale: { value: 1 },
      optical_depth: { value: this.table.opticalDepth },
      scene_m: { value: header.scene.size_m },
      from_radiance: { value: new THREE.Matrix3() },
      outset: { value: matrix(tone.outset) },
      stops: { value: new THREE.Vector2(tone.darkest, 1 / (tone.brightest - tone.darkest)) },
      curve: { value: tone.sigmoid },
      contrast: { value: tone.contrast },
      saturation: { value: tone.saturation },
      night_field: { value: 0 },
      xyz_from_srgb: { value: matrix(tone.xyz_from_srgb) },
      rods_grey: { value: new THREE.Vector3(...tone.rods_grey) },
      rods_blue: { value: new THREE.Vector3(...tone.rods_blue) },
      rods_range: { value: new THREE.Vector2(...tone.rods_range) },
      pre: { value: 1 },
      values_shown: { value: 0 },
      diffuse_shown: { value: false },
      jitter: { value: new THREE.Vector2() },
      picture_share: { value: 0 },
      light_map: { value: this.light.texture },
      visible_sky: { value: skyTexture },
      open_sky: { value: this.open.texture },
      open_up: { value: new THREE.Vector3() },
      reflectance: { value: reflectance },
      mirrored_sky: { value: this.fineCubes.mirrored.texture },
      light_scale: { value: 1 },
      open_scale: { value: 1 },
      mirror_scale: { value: 1 },
      mirror_levels: { value: Math.log2(CUBE_EDGE) },
      light_size: { value: new THREE.Vector2(...this.light.size) },
      key_direction: { value: new THREE.Vector3(0, 1, 0) },
      key_irradiance: { value: new THREE.Vector3() },
      shadow_map: { value: this.shadow.depthTexture },
      glass_map: { value: this.tinted.texture },
      shadow_from_world: { value: new THREE.Matrix4() },
      plane_scale: { value: new THREE.Vector3() },
      shadow_texel_depth: { value: 0 },
      ground_albedo: { value: new THREE.Vector4(0.1, 0.1, 0.1, 1) },
    };
    if (header.map.chart) {
      const { chart } = header.map;
      this.shared.chart = { value: new THREE.Vector4(chart.corner_px[0] + 0.5, chart.corner_px[1] + 0.5, chart.edge_px - 1, chart.half_width_m) };
      this.shared.chart_place = { value: new THREE.Vector3(chart.centre_xz_m[0], chart.centre_xz_m[1], chart.warp) };
    }
    if (header.map.probes) {
      const { probes } = header.map;
      this.shared.probe_lower = { value: new THREE.Vector3(...probes.lower_m) };
      this.shared.probe_per_m = { value: new THREE.Vector3(...probes.step_m.map((/** @type {number} */ s) => 1 / s)) };
      this.shared.probe_counts = { value: probes.counts };
      this.shared.probe_row = { value: probes.row };
    }
    this.moonAlbedo = albedoOf(data);
    const one = this.shared;
    this.skyPass = new THREE.Mesh(new THREE.BufferGeometry(), program(SKY_VERTEX, SKY_FRAGMENT, {
      ...one,
      world_from_clip: { value: new THREE.Matrix4() },
      disc_direction: { value: new THREE.Vector3() },
      disc_radiance: { value: new THREE.Vector3() },
      disc_radius: { value: 0.005 },
      to_sun: { value: new THREE.Vector3() },
      moon_level: { value: 1 },
      moon_albedo: { value: this.moonAlbedo.texture },
      moon_from_world: { value: new THREE.Matrix3() },
      limb: { value: Array.from({ length: 6 }, () => new THREE.Vector3()) },
      eye_height: { value: 1.7 },
    }, this.defines, { depthFunc: THREE.LessEqualDepth, depthWrite: false }));
    this.skyPass.geometry.setAttribute('position', new THREE.BufferAttribute(
      new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.skyPass.frustumCulled = false;
    // After opaque surfaces, as far away as the target is deep: no sky is computed behind them.
    this.skyPass.renderOrder = 1;
    this.skyPass.onBeforeRender = (_renderer, _scene, camera) => {
      const u = /** @type {THREE.RawShaderMaterial} */ (this.skyPass.material).uniforms;
      const view = camera.matrixWorld.clone();
      u.world_from_clip.value.copy(view).multiply(camera.projectionMatrixInverse);
      const jitter = one.jitter.value;
      if (jitter.x || jitter.y) {
        u.world_from_clip.value.multiply(new THREE.Matrix4().makeTranslation(-jitter.x, -jitter.y, 0));
      }
      u.eye_height.value = new THREE.Vector3().setFromMatrixPosition(view).y - header.scene.ground_m;
      /** @type {THREE.RawShaderMaterial} */ (this.skyPass.material).uniformsNeedUpdate = true;
    };
    const cube = { ...one, face: { value: 0 }, cube_scale: { value: 1 }, key_body: { value: 0 }, cloud_passed: { value: [1, 1] }, cloud_lit: { value: 1 } };
    this.cubePass = fullScreen(CUBE_FRAGMENT, cube, this.defines);
    this.airPass = fullScreen(CUBE_FRAGMENT, cube, { ...this.defines, AIR: 1 });
    this.copy = fullScreen(COPY_FRAGMENT, { from: { value: null }, factor: { value: 1 } });
    this.add = fullScreen(COPY_FRAGMENT, { from: { value: null }, factor: { value: 1 } }, {}, {
      transparent: true, blending: THREE.CustomBlending, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor,
      blendEquation: THREE.AddEquation,
    });
    const ramp = new THREE.DataTexture(new Uint8Array(header.false_colours.flat()), header.false_colours.length, 1);
    ramp.magFilter = ramp.minFilter = THREE.LinearFilter;
    ramp.needsUpdate = true;
    this.tone = fullScreen(TONE_FRAGMENT, {
      ...one, radiance: { value: null }, pictures: { value: 1 }, range: { value: new THREE.Vector2(0, 1) }, colours: { value: ramp },
    });
    this.range = [10, 10000];
    const meter = (/** @type {number[]} */ [w, h]) => new THREE.WebGLRenderTarget(w, h, { type: THREE.FloatType, depthBuffer: false });
    this.meter = meter(METER);
    this.draftMeter = meter(DRAFT_METER);
    this.glimpse = new THREE.WebGLRenderTarget(METER[0], METER[1], { type: THREE.HalfFloatType });
    this.scene = new THREE.Scene();
    this.scene.matrixWorldAutoUpdate = false;
    this.stars = header.stars
      ? new Stars(data, this.ephemeris, { pre: one.pre, values_shown: one.values_shown, jitter: one.jitter, ...this.clouds?.uniforms }, this.clouds?.defines) : null;
    if (this.stars) {
      this.stars.points.renderOrder = 1.5;
      this.scene.add(this.stars.points);
    }
    this.neutral = { value: 0 };
    this.numbers = header.numbers ? new Numbers(data, { pre: one.pre, neutral: this.neutral, jitter: one.jitter }) : null;
    this.points = new PointLux(this);
    if (this.numbers) this.scene.add(this.numbers.mesh);
    this.casters = new THREE.Scene();
    this.tints = new THREE.Scene();
    this.size = [4, 4];
    /** Pixels of the picture in one of CSS. */
    this.ratio = 1;
    this.target = new THREE.WebGLRenderTarget(4, 4);
    /** For moving pictures of a processor, whose width and height are divided by `coarser`. */
    this.coarse = new THREE.WebGLRenderTarget(4, 4);
    this.coarser = COARSER[0];
    /** What surfaces are in pictures of `coarse`; drawn when the view has changed. */
    this.kept = keptTarget(4, 4);
    this.keptView = new THREE.Matrix4();
    this.keptScene = new THREE.Scene();
    /** @type {Uint8Array | null} */
    this.seen = null;
    /** @type {THREE.Mesh[]} */
    this.glass = [];
    this.drawn = this.target;
    this.sum = new THREE.WebGLRenderTarget(4, 4);
    /** @type {{meshes: THREE.Mesh[], camera: THREE.CubeCamera, hollow: boolean}[]} */
    this.mirrors = [];
    this.opaque = new THREE.Group();
    /** Lights what is kept. */
    this.relit = new THREE.Mesh();
  }

  /** @param {ArrayBuffer} glb */
  async load(glb) {
    const defines = { ...this.defines };
    const map = this.header.map;
    if (this.header.scene.glass) Object.assign(defines, { GLASS_SHADOW: 1 });
    const found = await sceneOf(glb, this.shared, defines, map);
    this.opaque = found.opaque;
    this.keptScene = found.kept;
    this.glass = /** @type {THREE.Mesh[]} */ (found.glass.children);
    const [first, second, third, fourth] = this.kept.textures;
    this.relit = fullScreen(RELIGHT_FRAGMENT, {
      ...this.shared, first: { value: first }, second: { value: second }, third: { value: third }, fourth: { value: fourth },
    }, { ...defines, DRAFT: 1, ...(map.probes ? { PROBES: 1 } : {}) }, { depthTest: true, depthWrite: true, depthFunc: THREE.AlwaysDepth }).mesh;
    this.relit.renderOrder = -1;
    this.relit.visible = false;
    this.scene.add(this.skyPass, this.relit, found.opaque, found.mirroring, found.glass);
    found.glass.renderOrder = 2;
    this.mirrors = this.header.mirrors.map(
      (/** @type {{centre_m: number[], hollow: boolean}} */ about, /** @type {number} */ n) => (
        this.mirrorOf(about, n, found.mirrors.get(n) || [])));
    found.casters.forEach((mesh) => this.casters.add(mesh));
    found.tints.forEach((mesh) => this.tints.add(mesh));
    this.scene.updateMatrixWorld(true);
  }

  /** @param {number} width @param {number} height CSS pixels @param {number} ratio */
  resize(width, height, ratio) {
    this.ratio = ratio;
    const w = Math.max(1, Math.round(width * ratio)), h = Math.max(1, Math.round(height * ratio));
    for (const target of [this.target, this.coarse, this.sum]) target.dispose();
    this.size = [w, h];
    this.target = this.drawn = this.radianceTarget(w, h);
    this.coarse = this.radianceTarget(w, h);
    this.sizeCoarse();
    this.sum = new THREE.WebGLRenderTarget(w, h, {
      type: THREE.FloatType, depthBuffer: false, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter,
    });
    this.camera.aspect = w / h;
    this.camera.updateProjectionMatrix();
    this.stillCount = 0;
  }

  /** Makes a processor's moving pictures coarser where the last took long, finer where it did not.
   * @param {number} seconds that it took */
  keepPace(seconds) {
    if (!this.soft) return;
    const step = seconds > PACE_S[1] ? 1 : seconds < PACE_S[0] ? -1 : 0;
    const coarser = Math.min(Math.max(this.coarser + step, COARSER[0]), COARSER[1]);
    if (coarser === this.coarser) return;
    this.coarser = coarser;
    this.sizeCoarse();
  }

  /** @param {THREE.WebGLRenderTarget} target whose size the canvas takes */
  sizeCanvas({ width, height }) {
    const { domElement: canvas } = this.renderer;
    if (canvas.width !== width || canvas.height !== height) this.renderer.setDrawingBufferSize(width, height, 1);
  }

  sizeCoarse() {
    const [w, h] = this.size.map((v) => Math.ceil(v / this.coarser));
    for (const target of [this.coarse, this.kept]) target.setSize(w, h);
    this.keptView = new THREE.Matrix4();
  }

  /** A target for a picture's radiance. @param {number} width @param {number} height */
  radianceTarget(width, height) {
    return new THREE.WebGLRenderTarget(width, height, {
      type: THREE.HalfFloatType, samples: this.soft ? 0 : 4, minFilter: THREE.NearestFilter,
      magFilter: THREE.NearestFilter,
    });
  }

  /** Distances (m) of the nearest and the farthest things that are drawn. */
  get depths() {
    const size = this.header.scene.size_m;
    return [Math.max(0.02, 2e-4 * size), 150 * size];
  }

  /** Lights the scene at an instant. @param {Date} date
   * @param {boolean} [draft] with a coarse shadow map, without new images of what glossy parts see */
  setHour(date, draft = false) {
    const sun = this.ephemeris.sun(date), moon = this.ephemeris.moon(date);
    this.sun = sun;
    this.moon = moon;
    const left = sunShare(sun.trueRad), night = nightShare(sun.trueRad);
    const bodies = [
      { ...sun, share: [left, left, left] },
      { ...moon, share: moon.share.map((v) => v * night * (moon.trueRad > -0.02 ? 1 : 0)) },
    ].map((body) => {
      // Towards the body, the share of its rays that passes clouds, and their irradiance without these.
      const towards = directionOf(body.azimuthRad, body.apparentRad), passed = this.clouds?.transmittance(towards) ?? 1;
      return { ...body, towards, passed, rays: this.table.of('key', body.trueRad).map((v, c) => v * body.share[c]) };
    });
    if (this.stars) {
      this.stars.setHour(date, night);
      this.table.skyFromWorld.copy(this.stars.world.value).transpose();
    }
    const coefficients = new Float64Array(this.light.count);
    const { glow, lamps } = this.light;
    for (let i = 0; i < coefficients.length; ++i) coefficients[i] = night * glow[i] + lamps[i];
    const lit = bodies.filter((body) => body.share[1] > 0), uniform = this.shared.bodies.value;
    this.shared.body_count.value = lit.length;
    lit.forEach((body, number) => {
      const level = this.table.level(body.trueRad);
      const [layer, share] = placed(this.table.about.true_rad, body.trueRad);
      uniform[number].light.set(...level.map((v, c) => v * body.share[c]));
      uniform[number].azimuth.set(Math.sin(body.azimuthRad), -Math.cos(body.azimuthRad));
      uniform[number].height = Math.max(body.apparentRad, 0);
      Object.assign(uniform[number], { layer, share });
      this.light.add(body, body.passed, coefficients);
    });
    this.shared.glow.value = night * this.table.glowScale;
    this.shared.ground_albedo.value.set(...this.table.albedo(sun.trueRad), 1);
    // The key light: the sun while any of its disc is up, else the moon.
    const byDay = visible(sun.apparentRad) > 0;
    const key = byDay ? bodies[0] : bodies[1];
    const shown = byDay ? 1 : visible(moon.apparentRad) > 0 ? 1 : 0;
    const strength = key.share[1] > 0 ? key.rays.map((v) => v * key.passed * shown) : [0, 0, 0];
    this.keyDirection = key.towards;
    this.shared.key_direction.value.copy(this.keyDirection);
    this.shared.key_irradiance.value.set(...strength);
    const level = Math.max(...lit.flatMap((body) => this.table.level(body.trueRad).map((v, c) => v * body.share[c])), night * this.header.basis.glow_bright, 1e-9);
    this.light.share(lit, night * this.header.basis.glow_bright);
    this.clouds?.update(lit, night, 1 / level);
    const albedo = this.table.albedo(sun.trueRad);
    /** The open ground's radiance; of a clear sky by its table. @param {number[]} up */
    const groundOf = (up) => [0, 1, 2].map((c) => (this.clouds
      ? albedo[c] / Math.PI * lit.reduce((sum, { rays, passed, towards: { y } }) => sum + rays[c] * passed * Math.max(y, 0), up[c])
      : lit.reduce((sum, body) => sum + this.table.of('ground', body.trueRad)[c] * body.share[c], night * this.header.glow_ground[c])));
    this.open.update(lit, night, groundOf, 1 / level);
    this.shared.open_scale.value = level;
    this.shared.open_up.value.set(...this.open.up);
    this.shared.below_horizon.value.set(...groundOf(this.open.up));
    this.shared.mirror_scale.value = this.shared.air_scale.value = level;
    const { mirrored, air } = draft ? this.draftCubes : this.fineCubes;
    this.shared.mirrored_sky.value = mirrored.texture;
    this.shared.mirror_levels.value = Math.log2(mirrored.width);
    this.shared.near_air.value = air.texture;
    for (const [pass, target] of /** @type {const} */ ([[this.cubePass, mirrored], [this.airPass, air]])) {
      pass.material.uniforms.cube_scale.value = 1 / level;
      pass.material.uniforms.key_body.value = lit.indexOf(key);
      pass.material.uniforms.cloud_passed.value = [0, 1].map((k) => lit[k]?.passed ?? 0);
      pass.material.uniforms.cloud_lit.value = this.open.left;
      const { texture } = target, levels = texture.generateMipmaps;
      for (let face = 0; face < 6; ++face) {
        pass.material.uniforms.face.value = face;
        pass.material.uniformsNeedUpdate = true;
        // Once a cube, not after each face.
        texture.generateMipmaps = levels && face === 5;
        pass.draw(this.renderer, target, face);
      }
      texture.generateMipmaps = levels;
    }
    const { disc } = this.header, u = /** @type {THREE.RawShaderMaterial} */ (this.skyPass.material).uniforms;
    const moonRadius = Math.asin(1737.4 / moon.distanceKm);
    const radius = byDay ? disc.angular_radius_rad : moonRadius;
    const solid = 2 * Math.PI * (1 - Math.cos(radius));
    u.disc_direction.value.copy(this.keyDirection);
    const covered = byDay ? Math.max(visible(sun.apparentRad), 1e-3) : 1;
    u.disc_radiance.value.set(...strength.map((v) => v / solid / covered));
    u.disc_radius.value = radius;
    this.keyRadius = radius;
    const towards = directionOf(sun.azimuthRad, sun.trueRad);
    u.to_sun.value.copy(byDay ? new THREE.Vector3() : towards);
    if (!byDay) {
      const axes = moonAxes(date, this.ephemeris.observer, this.header.place.north_offset_rad);
      u.moon_from_world.value.set(...axes.flat());
      u.moon_level.value = 1 / meanShade(this.keyDirection, towards, u.moon_from_world.value, this.moonAlbedo.at);
    }
    for (let k = 0; k < 6; ++k) {
      u.limb.value[k].set(...[0, 1, 2].map((c) => (byDay ? disc.limb_darkening_rgb[c][k] || 0 : k === 0 ? 1 : 0)));
    }
    this.white = (luminance(this.open.up) + luminance(strength)) / Math.PI;
    this.softRadius = byDay ? disc.even_radius_rad : moonRadius;
    this.chooseShadow(draft);
    // The light map is summed while the browser's other process draws cubes and shadows.
    this.renderer.getContext().flush();
    this.light.map.choose(draft && this.seesKept ? this.seenTexels() : null);
    this.light.draw(this.renderer, coefficients, Math.max(level, this.header.basis.lamps_bright));
    this.shared.light_scale.value = this.light.scale;
    if (!draft) this.drawMirrors();
    this.stillCount = 0;
  }

  /** The cube map of what meshes see around them.
   * @param {{centre_m: number[], hollow: boolean}} about @param {number} n its number
   * @param {THREE.Mesh[]} meshes */
  mirrorOf({ centre_m: middle, hollow }, n, meshes) {
    const size = this.header.scene.size_m, { mirrors } = this.header;
    const edge = this.header.sections.mirror_nearness.shape[2], most = mirrors.length > 2 ? 32 : 64;
    const target = new THREE.WebGLCubeRenderTarget(this.soft ? Math.min(edge, most) : edge, {
      type: THREE.HalfFloatType, generateMipmaps: true, minFilter: THREE.LinearMipmapLinearFilter,
    });
    const camera = new THREE.CubeCamera(1e-3 * size, 150 * size, target);
    camera.position.set(middle[0], middle[1], middle[2]);
    camera.updateMatrixWorld(true);
    for (const mesh of meshes) {
      const { uniforms } = /** @type {THREE.RawShaderMaterial} */ (mesh.material);
      uniforms.mirror.value = target.texture;
      uniforms.mirror_nearness.value = this.near[n];
      uniforms.mirror_middle.value.copy(camera.position);
    }
    return { meshes, camera, hollow };
  }

  /** Hides tiles of numbers and stars, which light nothing; returns those that were shown. */
  hideMarks() {
    const shown = [];
    for (const thing of [this.numbers?.mesh, this.stars?.points]) {
      if (!thing?.visible) continue;
      thing.visible = false;
      shown.push(thing);
    }
    return shown;
  }

  /** What glossy parts see around them: surfaces without the sky, which each adds itself. */
  drawMirrors() {
    const { pre, values_shown: shown, jitter } = this.shared;
    shown.value = 0;
    jitter.value.set(0, 0);
    pre.value = 1 / this.shared.mirror_scale.value;
    this.skyPass.visible = false;
    const hidden = this.hideMarks();
    const alpha = this.renderer.getClearAlpha();
    this.renderer.setClearAlpha(0);
    this.renderer.autoClear = true;
    for (const { meshes, camera, hollow } of this.mirrors) {
      const cube = camera.renderTarget.texture;
      for (const mesh of meshes) {
        mesh.visible = hollow;
        // A cube that is drawn into cannot be read.
        this.showMirror(mesh, this.fineCubes.mirrored.texture, 0);
      }
      camera.update(this.renderer, this.scene);
      for (const mesh of meshes) {
        mesh.visible = true;
        this.showMirror(mesh, cube, 1);
      }
    }
    this.renderer.autoClear = false;
    this.renderer.setClearAlpha(alpha);
    this.skyPass.visible = true;
    hidden.forEach((thing) => { thing.visible = true; });
  }

  /** @param {THREE.Mesh} mesh @param {THREE.CubeTexture} cube @param {number} share */
  showMirror(mesh, cube, share) {
    const material = /** @type {THREE.RawShaderMaterial} */ (mesh.material);
    material.uniforms.mirror.value = cube;
    material.uniforms.mirror_shown.value = share;
    material.uniformsNeedUpdate = true;
  }

  /** Draws the hour's shadow map; a draft's anew only where the key light has turned so far that
   * its shadows show it. @param {boolean} draft */
  chooseShadow(draft) {
    const drawn = draft ? this.draftShadow : this.fineShadow, lit = this.shared.key_irradiance.value.y > 0;
    if (draft && lit && this.shadow === drawn && this.shadowTowards.angleTo(this.keyDirection) < DRAFT_TURN_RAD) return;
    this.shadow = drawn;
    this.shared.shadow_map.value = drawn.depthTexture;
    this.drawShadow(this.keyDirection);
    this.shadowTowards.copy(this.keyDirection).multiplyScalar(lit ? 1 : 0);
  }

  /** @param {THREE.Vector3} towards the key light */
  drawShadow(towards) {
    const { lower, upper } = this.header.scene;
    const middle = new THREE.Vector3(...lower.map((/** @type {number} */ v, /** @type {number} */ i) => 0.5 * (v + upper[i])));
    const up = Math.abs(towards.y) > 0.99 ? new THREE.Vector3(0, 0, -1) : new THREE.Vector3(0, 1, 0);
    const view = new THREE.Matrix4().lookAt(towards, new THREE.Vector3(), up).setPosition(middle).invert();
    const box = new THREE.Box3();
    for (let k = 0; k < 8; ++k) {
      box.expandByPoint(new THREE.Vector3(...[0, 1, 2].map((i) => (k >> i & 1 ? upper : lower)[i])).applyMatrix4(view));
    }
    const pad = 0.01 * this.header.scene.size_m;
    box.expandByScalar(pad);
    const project = new THREE.Matrix4().makeOrthographic(box.min.x, box.max.x, box.max.y, box.min.y, -box.max.z, -box.min.z);
    this.shared.shadow_from_world.value.multiplyMatrices(project, view);
    const [wide, high, deep] = box.getSize(new THREE.Vector3()).toArray();
    this.shared.plane_scale.value.set(wide * wide, high * high, deep * deep);
    this.shared.shadow_texel_depth.value = Math.max(wide, high) / this.shadow.width / deep;
    // Without light too: surfaces cannot be drawn with a map that was never there.
    this.renderer.setRenderTarget(this.shadow);
    this.renderer.clear(false);
    if (!(this.shared.key_irradiance.value.y > 0)) return;
    this.renderer.render(this.casters, this.camera);
    if (this.header.scene.glass) {
      this.renderer.setRenderTarget(this.tinted);
      this.renderer.setClearColor(0xffffff, 1);
      this.renderer.clear();
      this.renderer.render(this.tints, this.camera);
      this.renderer.setClearColor(0x000000, 1);
    }
  }

  /** Draws a picture; the first after a change alone, further ones refine it. Returns whether one
   * more would. @param {boolean} refines */
  draw(refines) {
    const count = this.stillCount;
    if (count >= STILLS) return false;
    const { jitter, pre } = this.shared, [w, h] = this.size;
    // A second picture at rest starts the mean, with shifts and parts of the sun's disc.
    const still = refines && count > 0;
    if (still) {
      const k = count - 1;
      jitter.value.set(2 * (halton(k + 1, 2) - 0.5) / w, 2 * (halton(k + 1, 3) - 0.5) / h);
      if (this.shared.key_irradiance.value.y > 0) this.drawShadow(this.inDisc(k));
      this.shared.picture_share.value = (k * 0.6180339887) % 1;
    } else {
      jitter.value.set(0, 0);
      this.shared.picture_share.value = 0;
    }
    [this.camera.near, this.camera.far] = this.depths;
    this.camera.updateProjectionMatrix();
    this.drawn = this.soft && !refines ? this.coarse : this.target;
    this.drawRadiance(this.camera, this.drawn, count === 0);
    const { renderer } = this;
    let shown = this.drawn;
    if (still) {
      const k = count - 1;
      const pass = k === 0 ? this.copy : this.add;
      pass.material.uniforms.from.value = this.target.texture;
      pass.draw(renderer, this.sum);
      shown = this.sum;
    }
    const factor = still ? 1 / count : 1;
    if (this.exposure.automatic && !this.values && (count === 0 || count === STILLS - 1)) this.meterPicture(shown, factor * 1 / pre.value);
    if (!this.exposure.automatic) this.ev = this.exposure.ev;
    this.display(shown, still ? count : 1);
    this.stillCount = refines || count === 0 ? count + 1 : 1;
    return this.stillCount < STILLS;
  }

  /** Draws what a camera sees. @param {THREE.Camera} camera @param {THREE.WebGLRenderTarget} target
   * @param {boolean} [scales] by the present exposure */
  drawRadiance(camera, target, scales = true) {
    const { renderer, shared } = this;
    shared.values_shown.value = this.values ? LUX_SCALE : 0;
    if (scales) shared.pre.value = 0.3 * scaleOf(this.ev);
    if (this.stars) this.stars.size.value.set(target.width, target.height);
    this.neutral.value = GREY / scaleOf(this.ev);
    const drafts = target === this.coarse;
    if (drafts) this.keepSurfaces();
    else this.light.map.complete();
    this.opaque.visible = !drafts;
    this.relit.visible = drafts;
    renderer.setRenderTarget(target);
    renderer.clear();
    renderer.render(this.scene, camera);
    this.opaque.visible = true;
    this.relit.visible = false;
  }

  /** Whether the present view is that of what is kept. */
  get seesKept() {
    this.camera.updateMatrixWorld();
    return clipFromWorld(this.camera).equals(this.keptView);
  }

  /** Draws what surfaces are, which an hour that moves only lights. */
  keepSurfaces() {
    if (this.seesKept) return;
    const { renderer, camera } = this;
    this.keptView = clipFromWorld(camera);
    this.seen = null;
    this.light.map.complete();
    renderer.setClearAlpha(0);
    renderer.setRenderTarget(this.kept);
    renderer.clear();
    renderer.render(this.keptScene, camera);
    renderer.setClearAlpha(1);
  }

  /** The texels of the light map that the kept view shows, and those of glass. */
  seenTexels() {
    if (this.seen) return this.seen;
    const { width, height } = this.kept, found = new Uint8Array(this.light.size[0] * this.light.size[1]);
    const places = new Uint32Array(4 * width * height);
    this.renderer.readRenderTargetPixels(this.kept, 0, 0, width, height, places, undefined, 1);
    const px = new Float32Array(places.buffer);
    for (let i = 0; i < places.length; i += 4) this.mark(found, px[i], px[i + 1], px[i], px[i + 1]);
    for (const { geometry } of this.glass) {
      const at = geometry.getAttribute('light_px'), corners = /** @type {THREE.BufferAttribute} */ (geometry.index);
      for (let k = 0; k < corners.count; k += 3) {
        const us = [0, 1, 2].map((n) => at.getX(corners.getX(k + n))), vs = [0, 1, 2].map((n) => at.getY(corners.getX(k + n)));
        this.mark(found, Math.min(...us), Math.min(...vs), Math.max(...us), Math.max(...vs));
      }
    }
    // Probes light what has no place in the map, and rear sides.
    const { probes } = this.header.map;
    if (probes) found.fill(1, probes.row * this.light.size[0]);
    this.seen = found;
    return found;
  }

  /** Marks texels that a rectangle of the light map is interpolated from. @param {Uint8Array} texels
   * @param {number} left @param {number} top @param {number} right @param {number} bottom */
  mark(texels, left, top, right, bottom) {
    const [width, height] = this.light.size;
    for (let row = Math.max(Math.floor(top - 0.5), 0); row <= Math.min(Math.floor(bottom + 0.5), height - 1); ++row) {
      const first = row * width + Math.max(Math.floor(left - 0.5), 0);
      texels.fill(1, first, row * width + Math.min(Math.floor(right + 0.5), width - 1) + 1);
    }
  }

  /** @param {number} k */
  inDisc(k) {
    const far = this.softRadius * Math.sqrt((k + 0.5) / (STILLS - 1)), turn = 2.399963 * k;
    const side = new THREE.Vector3(0, 1, 0).cross(this.keyDirection);
    if (side.lengthSq() < 1e-6) side.set(1, 0, 0);
    side.normalize();
    const up = this.keyDirection.clone().cross(side);
    return this.keyDirection.clone().addScaledVector(side, far * Math.cos(turn)).addScaledVector(up, far * Math.sin(turn)).normalize();
  }

  /** Exposes for what a camera sees. @param {THREE.Camera} camera */
  meterView(camera) {
    this.drawRadiance(camera, this.glimpse);
    this.meterPicture(this.glimpse, 1 / this.shared.pre.value);
  }

  /** @param {THREE.WebGLRenderTarget} target @param {number} factor */
  meterPicture(target, factor) {
    this.copy.material.uniforms.from.value = target.texture;
    this.copy.material.uniforms.factor.value = factor;
    const meter = target === this.coarse ? this.draftMeter : this.meter, { width, height } = meter;
    this.copy.draw(this.renderer, meter);
    this.copy.material.uniforms.factor.value = 1;
    const texels = new Float32Array(4 * width * height), values = new Float32Array(width * height);
    this.renderer.readRenderTargetPixels(meter, 0, 0, width, height, texels);
    for (let i = 0; i < values.length; ++i) values[i] = luminance([texels[4 * i], texels[4 * i + 1], texels[4 * i + 2]]);
    this.ev = automaticEv(values, this.white) - this.exposure.compensation;
  }

  /** Sets the range of false colours by the picture's values. */
  meterValues() {
    this.copy.material.uniforms.from.value = this.drawn.texture;
    this.copy.draw(this.renderer, this.meter);
    const texels = new Float32Array(4 * METER[0] * METER[1]);
    this.renderer.readRenderTargetPixels(this.meter, 0, 0, METER[0], METER[1], texels);
    const values = texels.filter((v, i) => i % 4 === 0 && v > 0).sort();
    if (!values.length) return;
    const high = values[Math.floor(0.99 * (values.length - 1))] / LUX_SCALE;
    const low = Math.max(values[Math.floor(0.01 * (values.length - 1))] / LUX_SCALE, high / 1e3);
    const before = this.range;
    this.range = [low, Math.max(high, low * 1.01)];
    if (before[0] !== this.range[0] || before[1] !== this.range[1]) this.display(this.drawn, 1);
  }

  /** @param {THREE.WebGLRenderTarget} target @param {number} count of the pictures in it
   * @param {THREE.WebGLRenderTarget | null} [into] null for the page's canvas, which takes the target's
   *   size and which the browser enlarges */
  display(target, count, into = null) {
    if (!into) this.sizeCanvas(target);
    this.setTone();
    const u = this.tone.material.uniforms;
    u.radiance.value = target.texture;
    u.pictures.value = count;
    u.range.value.set(Math.log(this.range[0]), Math.log(this.range[1]));
    const kept = this.shared.pre.value;
    this.shared.pre.value = count * (this.values ? 1 : kept);
    this.tone.draw(this.renderer, into);
    this.shared.pre.value = kept;
  }

  setTone() {
    const inset = matrix(this.header.tone.inset).multiplyScalar(scaleOf(this.ev));
    this.shared.from_radiance.value.copy(inset);
    this.shared.night_field.value = adaptedCd(this.ev) / 683;
  }
}

/** Mean of the shade (Lommel and Seeliger) times albedo over a disc that is seen towards `seen` and
 * lit from `towards`. @param {THREE.Vector3} seen @param {THREE.Vector3} towards
 * @param {THREE.Matrix3} own from the world's axes to the moon's
 * @param {(n: THREE.Vector3) => number} albedo at a normal in the moon's axes */
export function meanShade(seen, towards, own, albedo) {
  const right = new THREE.Vector3(0, 1, 0).cross(seen).negate().normalize(), upper = right.clone().cross(seen);
  const n = new THREE.Vector3();
  let sum = 0, count = 0;
  for (let i = 0; i < 40; ++i) {
    for (let j = 0; j < 40; ++j) {
      const x = (i + 0.5) / 20 - 1, y = (j + 0.5) / 20 - 1, beside = x * x + y * y;
      if (beside >= 1) continue;
      const mu = Math.sqrt(1 - beside);
      n.set(0, 0, 0).addScaledVector(right, x).addScaledVector(upper, y).addScaledVector(seen, -mu);
      const lit = Math.max(n.dot(towards), 0);
      if (lit > 0) sum += albedo(n.applyMatrix3(own)) * lit / Math.max(lit + mu, 1e-4);
      ++count;
    }
  }
  return Math.max(sum / count, 1e-4);
}

/** A target for what surfaces are. @param {number} width @param {number} height */
export function keptTarget(width, height) {
  return new THREE.WebGLRenderTarget(width, height, {
    count: 4, type: THREE.UnsignedIntType, format: THREE.RGBAIntegerFormat, internalFormat: 'RGBA32UI',
    minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter,
  });
}

/** Cube maps of the sky that surfaces mirror, and of the air before them.
 * @param {number} edge @param {number} airEdge texels */
function skyCubes(edge, airEdge) {
  return {
    mirrored: new THREE.WebGLCubeRenderTarget(edge, {
      type: THREE.HalfFloatType, generateMipmaps: true, minFilter: THREE.LinearMipmapLinearFilter,
      depthBuffer: false,
    }),
    air: new THREE.WebGLCubeRenderTarget(airEdge, { type: THREE.HalfFloatType, depthBuffer: false }),
  };
}

/** @param {THREE.Camera} camera */
function clipFromWorld(camera) {
  return camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse);
}

/** A depth map of what key light meets. @param {number} edge */
function shadowTarget(edge) {
  const target = new THREE.WebGLRenderTarget(edge, edge, { depthBuffer: true });
  const depth = new THREE.DepthTexture(edge, edge, THREE.FloatType);
  depth.magFilter = depth.minFilter = THREE.NearestFilter;
  target.depthTexture = depth;
  return target;
}

/** The moon's albedo: a texture, and a function of normals in its own axes.
 * @param {import('./data.js').PageData} data */
function albedoOf(data) {
  const [rows, columns] = data.shape('moon_albedo'), fromNorth = data.array('moon_albedo');
  const texels = new Uint8Array(rows * columns);
  for (let row = 0; row < rows; ++row) {
    texels.set(fromNorth.subarray(row * columns, (row + 1) * columns), (rows - 1 - row) * columns);
  }
  const texture = new THREE.DataTexture(texels, columns, rows, THREE.RedFormat);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  const at = (/** @type {THREE.Vector3} */ n) => {
    const row = Math.floor((0.5 + Math.asin(Math.min(Math.max(n.z, -1), 1)) / Math.PI) * rows);
    const column = Math.floor((Math.atan2(n.y, n.x) / (2 * Math.PI) + 0.5) * columns);
    return texels[Math.min(row, rows - 1) * columns + column % columns] / 255;
  };
  return { texture, at };
}

/** Cubes of one over the distance (1/m) around glossy parts. @param {import('./data.js').PageData} data */
function nearnessOf(data) {
  const { mirrors } = data.header;
  if (!mirrors.length) return [];
  const bits = data.array('mirror_nearness'), edge = data.shape('mirror_nearness')[2], face = edge * edge;
  return mirrors.map((/** @type {any} */ _, /** @type {number} */ n) => {
    const faces = [0, 1, 2, 3, 4, 5].map((k) => {
      const first = (6 * n + k) * face;
      const texture = new THREE.DataTexture(bits.subarray(first, first + face), edge, edge, THREE.RedFormat, THREE.HalfFloatType);
      texture.needsUpdate = true;
      return texture;
    });
    const cube = new THREE.CubeTexture(/** @type {any} */ (faces), undefined, undefined, undefined,
      THREE.LinearFilter, THREE.LinearFilter, THREE.RedFormat, THREE.HalfFloatType);
    cube.generateMipmaps = false;
    cube.needsUpdate = true;
    return cube;
  });
}

/** @param {number} i @param {number} base */
function halton(i, base) {
  let f = 1, r = 0;
  for (; i > 0; i = Math.floor(i / base)) { f /= base; r += f * (i % base); }
  return r;
}
