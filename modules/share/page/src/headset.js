// The scene in a headset, by WebXR: two eyes, hands that point where to go, the hour by a stick.
import * as THREE from 'three';
import { Floor } from './floor.js';
import { Marks } from './marks.js';

// Height (m) of the eyes where the scene has no floor.
const EYE_M = 1.6;
const TURN_RAD = Math.PI / 6, HOURS_A_SECOND = 1.5;
// Deflection of a stick that turns, that has come back, and below which nothing is meant.
const PUSHED = 0.7, BACK = 0.4, STILL = 0.15;
// Seconds between measurements of the exposure, and those in which an eye follows by 1 - 1/e.
const METERED_S = 0.25, ADAPTS_S = 0.4;
const UP = new THREE.Vector3(0, 1, 0);

/** Angle about the vertical that turns -Z into a direction. @param {THREE.Vector3} d */
const headingOf = (d) => Math.atan2(-d.x, -d.z);

export class Headset {
  /** @param {import('./main.js').Page} page */
  constructor(page) {
    this.page = page;
    this.picture = page.view;
    this.floor = new Floor(this.picture.renderer, this.picture.scene);
    this.marks = new Marks();
    this.picture.scene.add(this.marks.group);
    /** @type {XRSession | null} */
    this.session = null;
    /** @type {any} the floor's, once there is a session */
    this.space = null;
    /** @type {any} of the session */
    this.layer = null;
    this.placed = false;
    this.turned = false;
    this.last = 0;
    /** Seconds since the exposure was measured. */
    this.metered = 0;
    /** Pose of the floor's origin in world axes. */
    this.rig = new THREE.Matrix4();
    this.origin = new THREE.Vector3();
    this.heading = 0;
    /** Pose of the head above the floor. */
    this.head = new THREE.Matrix4();
    this.eyes = [0, 1].map(() => {
      const camera = new THREE.PerspectiveCamera();
      camera.matrixWorldAutoUpdate = false;
      return { camera, target: new THREE.WebGLRenderTarget(4, 4) };
    });
    this.shown = new THREE.WebGLRenderTarget(4, 4);
    /** @type {XRInputSource | null} */
    this.aims = null;
    /** @type {THREE.Vector3 | null} */
    this.goal = null;
  }

  /** Whether there is a headset to enter. */
  static async isThere() {
    return Boolean(await navigator.xr?.isSessionSupported('immersive-vr'));
  }

  async enter() {
    const system = /** @type {XRSystem} */ (navigator.xr);
    const session = await system.requestSession('immersive-vr', { requiredFeatures: ['local-floor'] });
    const gl = /** @type {WebGL2RenderingContext} */ (this.picture.renderer.getContext());
    await gl.makeXRCompatible();
    this.space = await session.requestReferenceSpace('local-floor');
    this.layer = new XRWebGLLayer(session, gl, { antialias: false, depth: false, alpha: false });
    const [depthNear, depthFar] = this.picture.depths;
    session.updateRenderState({ baseLayer: this.layer, depthNear, depthFar });
    session.addEventListener('end', () => this.leave());
    session.addEventListener('selectstart', ({ inputSource }) => { this.aims = inputSource; });
    session.addEventListener('selectend', ({ inputSource }) => {
      if (inputSource !== this.aims) return;
      this.aims = null;
      if (this.goal) this.stand(this.goal);
      this.goal = null;
    });
    session.addEventListener('squeezestart', () => {
      if (this.sticks().turn === null) this.turn(-TURN_RAD);
    });
    Object.assign(this, { session, placed: false, turned: false, last: 0, metered: 0 });
    if (this.page.plays) this.page.play();
    if (this.picture.values) this.page.showValues();
    this.page.hourChanged = true;
    session.requestAnimationFrame((now, frame) => this.frame(now, frame));
  }

  /** The page's own picture again. */
  leave() {
    this.session = null;
    this.aims = this.goal = null;
    this.marks.hide();
    this.page.hourChanged = true;
    this.page.layOut();
    this.page.showHeadset();
  }

  /** @param {number} now ms @param {XRFrame} frame */
  frame(now, frame) {
    const { session } = this;
    if (!session) return;
    session.requestAnimationFrame((next, one) => this.frame(next, one));
    const pose = frame.getViewerPose(this.space);
    if (!pose) return;
    const seconds = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    this.head.fromArray(pose.transform.matrix);
    // Mirrors do not see the marks of the last frame.
    this.marks.hide();
    if (!this.placed) this.begin();
    const moves = this.follow(seconds);
    this.page.lightHour(moves);
    this.point(frame);
    this.draw(pose, seconds);
  }

  // --- the person ---

  /** Stands where the page's view is, on the floor below it, and looks its way. */
  begin() {
    const eye = this.picture.camera.position, floor = this.floor.under(eye);
    const ahead = this.picture.camera.getWorldDirection(new THREE.Vector3());
    const looks = new THREE.Vector3().setFromMatrixColumn(this.head, 2).negate();
    this.heading = headingOf(ahead) - headingOf(looks);
    this.stand(floor || eye.clone().setY(eye.y - EYE_M));
    this.placed = true;
  }

  /** Stands above a point. @param {THREE.Vector3} point */
  stand(point) {
    const beside = new THREE.Vector3().setFromMatrixPosition(this.head).setY(0).applyAxisAngle(UP, this.heading);
    this.origin.copy(point).sub(beside);
    this.rig.makeRotationY(this.heading).setPosition(this.origin);
  }

  /** Turns about the head. @param {number} angle radians, to the left */
  turn(angle) {
    const feet = new THREE.Vector3().setFromMatrixPosition(this.head).setY(0).applyMatrix4(this.rig);
    this.heading += angle;
    this.stand(feet);
  }

  // --- the hands ---

  get hands() {
    return this.session ? [...this.session.inputSources].filter((one) => one.gamepad && one.gripSpace) : [];
  }

  /** The hand whose stick sets the hour, and the one whose stick turns; null where there is none. */
  sticks() {
    const hands = this.hands, left = hands.find((one) => one.handedness === 'left');
    const hour = left || hands[0] || null;
    return { hour, turn: hands.find((one) => one !== hour) || null };
  }

  /** The hour and turns by the sticks; whether the hour moves. @param {number} seconds */
  follow(seconds) {
    const { hour, turn } = this.sticks(), { page } = this;
    const across = (/** @type {XRInputSource | null} */ hand) => {
      const axes = hand?.gamepad?.axes || [];
      return axes.length > 3 ? axes[2] : axes[0] || 0;
    };
    const side = across(turn);
    if (!this.turned && Math.abs(side) > PUSHED) this.turn(-Math.sign(side) * TURN_RAD);
    this.turned = Math.abs(side) > (this.turned ? BACK : PUSHED);
    const pushed = across(hour), moves = Math.abs(pushed) > STILL;
    if (moves) page.setHour(page.day, page.minute + pushed * seconds * HOURS_A_SECOND * 60);
    return moves;
  }

  /** Pose of a hand in world axes, or null where it is not tracked.
   * @param {XRFrame} frame @param {XRSpace | undefined} space */
  poseOf(frame, space) {
    const pose = space && frame.getPose(space, this.space);
    return pose ? new THREE.Matrix4().fromArray(pose.transform.matrix).premultiply(this.rig) : null;
  }

  /** Shows where hands point, and the clock. @param {XRFrame} frame */
  point(frame) {
    const { marks } = this;
    this.goal = null;
    this.hands.slice(0, marks.rays.length).forEach((hand, number) => {
      const pose = this.poseOf(frame, hand.targetRaySpace);
      if (!pose) return;
      if (hand !== this.aims) { marks.showRay(number, pose); return; }
      const from = new THREE.Vector3().setFromMatrixPosition(pose);
      const ahead = new THREE.Vector3().setFromMatrixColumn(pose, 2).negate().normalize();
      const met = this.floor.hit(from, ahead);
      if (!met) { marks.showRay(number, pose); return; }
      const goes = this.floor.holds(met);
      this.goal = goes ? met : null;
      marks.showRay(number, pose, met.distanceTo(from));
      marks.showRing(met, goes);
    });
    const { hour } = this.sticks(), grip = hour && this.poseOf(frame, hour.gripSpace);
    if (grip) marks.showClock(grip, this.page.words());
  }

  // --- the eyes ---

  /** @param {XRViewerPose} pose @param {number} seconds since the last frame */
  draw(pose, seconds) {
    const { picture, layer, shown } = this, { renderer } = picture;
    this.expose(pose, seconds);
    // @ts-ignore its types lack this function
    renderer.setRenderTargetFramebuffer(shown, layer.framebuffer);
    pose.views.forEach((view, number) => {
      const box = layer.getViewport(view), eye = this.eyes[number];
      if (!box || !eye) return;
      if (eye.target.width !== box.width || eye.target.height !== box.height) {
        eye.target.dispose();
        eye.target = picture.radianceTarget(box.width, box.height);
      }
      this.look(eye.camera, view);
      picture.drawRadiance(eye.camera, eye.target);
      shown.viewport.set(box.x, box.y, box.width, box.height);
      picture.display(eye.target, 1, shown);
    });
  }

  /** @param {THREE.PerspectiveCamera} camera @param {XRView} view */
  look(camera, view) {
    camera.matrixWorld.fromArray(view.transform.matrix).premultiply(this.rig);
    camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
    camera.projectionMatrix.fromArray(view.projectionMatrix);
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  }

  /** Meters what the first eye sees of the scene; both eyes have one exposure.
   * @param {XRViewerPose} pose @param {number} seconds */
  expose(pose, seconds) {
    const { picture } = this;
    this.metered += seconds;
    if (this.metered < METERED_S || !picture.exposure.automatic) return;
    const before = picture.ev, share = 1 - Math.exp(-this.metered / ADAPTS_S);
    this.metered = 0;
    this.marks.group.visible = false;
    this.look(this.eyes[0].camera, pose.views[0]);
    picture.meterView(this.eyes[0].camera);
    this.marks.group.visible = true;
    picture.ev = before + share * (picture.ev - before);
  }
}
