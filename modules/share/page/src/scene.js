// The scene's meshes, and for each a program that lights it.
import * as THREE from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { SURFACES } from './floor.js';
import { DEPTH_FRAGMENT, DEPTH_VERTEX, TINT_FRAGMENT, program } from './shaders.js';
import { KEEP_FRAGMENT, SURFACE_FRAGMENT, SURFACE_VERTEX } from './surface_shaders.js';

/** Layer of cameras that sees what clear surfaces are, beside opaque ones. */
export const CLEAR = 2;
// Roughness above which no lobe of a coat is narrower than the texels of the sky's cube map.
const SMOOTH = 0.21;

/** @param {number[]} values */
const vec3 = (values) => new THREE.Vector3(values[0], values[1], values[2]);
export const white = new THREE.DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1);
white.needsUpdate = true;

/** Linear colour: the scene's factors are linear already. @param {THREE.Color} c */
const rgb = (c) => [c.r, c.g, c.b];

/**
 * @param {ArrayBuffer} glb
 * @param {Record<string, THREE.IUniform>} shared uniforms of all surfaces
 * @param {Record<string, any>} defines
 * @param {any} map the header's light map
 */
export async function sceneOf(glb, shared, defines, map) {
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
  const found = await loader.parseAsync(glb, '');
  const opaque = new THREE.Group(), glass = new THREE.Group(), mirroring = new THREE.Group();
  const kept = new THREE.Scene();
  /** @type {THREE.Mesh[]} */
  const casters = [];
  /** @type {THREE.Mesh[]} */
  const tints = [];
  /** @type {Map<number, THREE.Mesh[]>} */
  const glossy = new Map();
  found.scene.updateMatrixWorld(true);
  /** @type {THREE.Mesh[]} */
  const meshes = [];
  found.scene.traverse((node) => {
    if (node instanceof THREE.Mesh) meshes.push(node);
  });
  for (const mesh of meshes) {
    const material = /** @type {THREE.MeshStandardMaterial} */ (mesh.material);
    const more = material.userData || {}, geometry = prepared(mesh.geometry);
    /** @type {number | undefined} */
    const mirror = mesh.userData.mirror;
    const ground = more.ground === 1, clear = (more.transmission || 0) > 0 || material.transparent;
    const mapped = geometry.userData.mapped;
    const textures = {
      base: material.map, rough: material.roughnessMap, normal: material.normalMap,
      occlusion: material.aoMap, emission: material.emissiveMap,
    };
    const layer = (/** @type {THREE.Texture | null} */ t) => (t ? t.channel : 0);
    const uniforms = {
      ...shared,
      base_factor: { value: new THREE.Vector4(...rgb(material.color), material.opacity) },
      emission: { value: vec3(more.emission_cd || [0, 0, 0]) },
      metallic_factor: { value: material.metalness },
      roughness_factor: { value: material.roughness },
      alpha_cutoff: { value: material.alphaTest },
      dielectric_f0: { value: vec3(ground ? [0, 0, 0] : more.f0 || [0.04, 0.04, 0.04]) },
      dielectric_f90: { value: ground ? 0 : more.f90 ?? 1 },
      transmission_factor: { value: more.transmission || 0 },
      unlit: { value: more.unlit || 0 },
      base_map: { value: textures.base || white },
      rough_map: { value: textures.rough || white },
      normal_map: { value: textures.normal || white },
      occlusion_map: { value: textures.occlusion || white },
      emission_map: { value: textures.emission || white },
      mirror: { value: null },
      mirror_nearness: { value: null },
      mirror_middle: { value: new THREE.Vector3() },
      mirror_shown: { value: 0 },
      layers: { value: [layer(textures.base), layer(textures.rough), layer(textures.normal), layer(textures.occlusion)] },
      map_strength: { value: new THREE.Vector2(material.normalScale?.x ?? 1, material.aoMapIntensity ?? 1) },
    };
    /** @type {Record<string, any>} */
    const own = { ...defines };
    if (textures.base) own.BASE_MAP = 1;
    if (textures.rough) own.ROUGH_MAP = 1;
    if (textures.normal) own.NORMAL_MAP = 1;
    if (textures.occlusion) own.OCCLUSION_MAP = 1;
    if (textures.emission) own.EMISSION_MAP = 1;
    if (ground) own.GROUND = 1;
    if (ground && map.chart) own.CHART = 1;
    if (!ground && mapped) own.LIGHT_MAP = 1;
    if (!ground && map.probes) own.PROBES = 1;
    if (clear) own.GLASS = 1;
    if (textures.rough || material.roughness < SMOOTH) own.SMOOTH = 1;
    if (mirror !== undefined) own.MIRROR = 1;
    if (ground) uniforms.base_factor.value = shared.ground_albedo.value;
    const blend = clear ? {
      transparent: true, depthWrite: false, blending: THREE.CustomBlending, blendSrc: THREE.OneFactor,
      blendDst: THREE.OneMinusSrcAlphaFactor, blendEquation: THREE.AddEquation,
    } : {};
    for (const texture of Object.values(textures)) {
      if (texture) texture.anisotropy = 8;
    }
    const placed = twin(mesh, program(SURFACE_VERTEX, SURFACE_FRAGMENT, uniforms, own, {
      side: material.side, ...blend,
    }));
    if (!clear) placed.layers.enable(SURFACES);
    (clear ? glass : mirror !== undefined ? mirroring : opaque).add(placed);
    if (mirror !== undefined) glossy.set(mirror, [...(glossy.get(mirror) || []), placed]);
    const keeps = twin(placed, program(SURFACE_VERTEX, KEEP_FRAGMENT, uniforms, own, { side: material.side }));
    if (clear) keeps.layers.set(CLEAR);
    kept.add(keeps);
    if (ground) continue;
    const cut = material.alphaTest > 0;
    const tint = [0, 1, 2].map((c) => (clear
      ? uniforms.base_factor.value.getComponent(c) * (more.transmission || 1 - material.opacity) * 0.92 : 1));
    const depth = twin(placed, program(DEPTH_VERTEX, clear ? TINT_FRAGMENT : DEPTH_FRAGMENT, {
      clip_from_world: shared.shadow_from_world, base_map: uniforms.base_map,
      alpha_cutoff: uniforms.alpha_cutoff, base_alpha: { value: material.opacity },
      tint: { value: vec3(tint) },
    }, cut ? { CUT_OUT: 1 } : {}, clear
      ? { side: THREE.DoubleSide, depthTest: false, depthWrite: false, transparent: true, blending: THREE.MultiplyBlending, premultipliedAlpha: true }
      : { side: THREE.DoubleSide, colorWrite: false }));
    (clear ? tints : casters).push(depth);
  }
  return { opaque, mirroring, glass, kept, casters, tints, mirrors: glossy };
}

/** A mesh with the geometry and the place of another. @param {THREE.Mesh} mesh
 * @param {THREE.Material} material */
function twin(mesh, material) {
  const found = new THREE.Mesh(mesh.geometry, material);
  found.matrixAutoUpdate = false;
  found.matrix.copy(mesh.matrixWorld);
  found.matrixWorld.copy(mesh.matrixWorld);
  found.frustumCulled = false;
  return found;
}

/** A geometry with all attributes that programs read. @param {THREE.BufferGeometry} geometry */
function prepared(geometry) {
  const count = geometry.getAttribute('position').count;
  const light = geometry.getAttribute('_light');
  geometry.userData.mapped = Boolean(light);
  const constant = (/** @type {string} */ name, /** @type {number} */ size, /** @type {number} */ value) => {
    if (geometry.getAttribute(name)) return;
    geometry.setAttribute(name, new THREE.BufferAttribute(new Uint8Array(count * size).fill(value), size, true));
  };
  constant('uv', 2, 0);
  constant('uv1', 2, 0);
  constant('color', 4, 255);
  if (light) geometry.setAttribute('light_px', light);
  else constant('light_px', 2, 0);
  return geometry;
}
