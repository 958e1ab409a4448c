// One or two views of the scene in one canvas: cameras, orbits, drawing when something has changed.
import {PerspectiveCamera, Vector3, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {byId} from './dom.js';
import {shared} from './material.js';

const angle = 30; // of view, degrees
const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
const dark = matchMedia('(prefers-color-scheme: dark)');
const restAfter = 200; // ms without a change of the camera

const sides = {
  y: {front: [0, 0, 1], back: [0, 0, -1], left: [-1, 0, 0], right: [1, 0, 0], top: [0, 1, 0], bottom: [0, -1, 0]},
  z: {front: [0, -1, 0], back: [0, 1, 0], left: [-1, 0, 0], right: [1, 0, 0], top: [0, 0, 1], bottom: [0, 0, -1]},
};

export class Views {
  /** `data` with its origin; `scene` of three.js. Listeners are called after each drawing. */
  constructor(data, scene) {
    this.data = data;
    this.scene = scene;
    this.listeners = [];
    this.linked = true;
    this.two = false;
    this.up = 'y';
    this.renderer = new WebGLRenderer({
      canvas: byId('canvas'),
      antialias: true,
      alpha: true,
      powerPreference: 'high-performance',
    });
    this.renderer.autoClear = false;
    this.renderer.setClearColor(0, 0);
    this.views = [0, 1].map((index) => this.#view(index));
    this.#bounds();
    new ResizeObserver(() => this.resize()).observe(byId('stage'));
    dark.addEventListener('change', () => this.draw());
    this.renderer.domElement.addEventListener('webglcontextrestored', () => this.draw());
  }

  #view(index) {
    const camera = new PerspectiveCamera(angle, 1, 0.1, 10);
    camera.layers.set(index);
    const holder = byId(`view${index}`);
    const controls = new OrbitControls(camera, holder);
    controls.enableDamping = !still;
    controls.dampingFactor = 0.14;
    controls.rotateSpeed = 0.9;
    controls.zoomToCursor = true;
    controls.addEventListener('change', () => {
      this.#moves();
      if (this.linked && this.two && this.leader === index) this.#follow(index);
      this.draw();
    });
    controls.addEventListener('start', () => {
      this.leader = index;
      this.held = true;
    });
    controls.addEventListener('end', () => {
      this.held = false;
      if (this.moving) this.#moves();
    });
    holder.addEventListener(
      'wheel',
      () => {
        this.leader = index;
      },
      {capture: true, passive: true},
    );
    return {camera, controls, holder, caption: holder.querySelector('.caption')};
  }

  /** While cameras move, items that have a coarse picture show it: `coarsely(on)` is told. */
  #moves() {
    if (!this.coarsely) return;
    clearTimeout(this.resting);
    if (!this.moving) this.coarsely((this.moving = true));
    if (!this.held) this.resting = setTimeout(() => this.rest(), restAfter);
  }

  rest() {
    clearTimeout(this.resting);
    if (!this.moving) return;
    this.coarsely((this.moving = false));
    this.draw();
  }

  /** Center and radius of all items, in the page's own coordinates. */
  #bounds() {
    const lo = [Infinity, Infinity, Infinity],
      hi = [-Infinity, -Infinity, -Infinity];
    for (const {box} of this.data.items) {
      for (let k = 0; k < 3; ++k) {
        lo[k] = Math.min(lo[k], box.lo[k] - this.data.origin[k]);
        hi[k] = Math.max(hi[k], box.hi[k] - this.data.origin[k]);
      }
    }
    this.lo = lo;
    this.hi = hi;
    this.center = new Vector3(...lo.map((v, k) => (v + hi[k]) / 2));
    this.radius = Math.max(Math.hypot(...lo.map((v, k) => hi[k] - v)) / 2, 1e-30);
  }

  /** The other view takes the camera of view `from`. */
  #follow(from) {
    const source = this.views[from],
      target = this.views[1 - from];
    target.camera.position.copy(source.camera.position);
    target.camera.quaternion.copy(source.camera.quaternion);
    target.controls.target.copy(source.controls.target);
  }

  setLinked(on) {
    this.linked = on;
    if (on) this.#follow(this.leader ?? 0);
    this.draw();
  }

  setTwo(on) {
    this.two = on;
    byId('view1').hidden = !on;
    byId('stage').classList.toggle('two', on);
    if (on && this.linked) this.#follow(0);
    this.resize();
  }

  /** Looks at all from a side: "front", ..., or "corner". */
  look(side, up = this.up) {
    this.up = up;
    this.leader = 0;
    const direction = new Vector3(...(sides[up][side] ?? (up === 'y' ? [0.55, 0.4, 1] : [0.55, -1, 0.5]))).normalize();
    for (const {camera, controls} of this.views) {
      camera.up.set(0, up === 'y' ? 1 : 0, up === 'y' ? 0 : 1);
      // OrbitControls takes the upright axis once, when it is made.
      controls._quat.setFromUnitVectors(camera.up, new Vector3(0, 1, 0));
      controls._quatInverse.copy(controls._quat).invert();
      this.#place(camera, controls, direction);
    }
    this.draw();
  }

  /** All of it in the picture, from where the viewer is. */
  fit() {
    for (const {camera, controls} of this.views) {
      const direction = camera.position.clone().sub(controls.target).normalize();
      this.#place(camera, controls, direction);
    }
    this.draw();
  }

  /** Puts a camera so far away that all corners of the box are in the picture. */
  #place(camera, controls, direction) {
    const {center} = this;
    const forward = direction.clone().negate();
    const right = new Vector3().crossVectors(forward, camera.up);
    if (right.lengthSq() < 1e-6) right.crossVectors(forward, new Vector3(0, -camera.up.z, camera.up.y)).negate();
    right.normalize();
    const above = new Vector3().crossVectors(right, forward);
    const slope = Math.tan(((angle / 2) * Math.PI) / 180) * 0.86;
    let distance = 0;
    for (let c = 0; c < 8; ++c) {
      const corner = new Vector3(...[0, 1, 2].map((k) => ((c >> k) & 1 ? this.hi[k] : this.lo[k]))).sub(center);
      const wide = Math.abs(corner.dot(right)) / Math.max(camera.aspect, 0.2);
      distance = Math.max(distance, corner.dot(direction) + Math.max(wide, Math.abs(corner.dot(above))) / slope);
    }
    controls.target.copy(center);
    camera.position.copy(center).addScaledVector(direction, Math.max(distance, this.radius * 0.5));
    controls.minDistance = this.radius * 1e-4;
    controls.maxDistance = this.radius * 40;
    controls.update();
  }

  /** Turns about this point from now on. */
  turnAbout(view, point) {
    for (const [index, {controls, camera}] of this.views.entries()) {
      if (index !== view && !this.linked) continue;
      const shift = new Vector3(...point).sub(controls.target);
      controls.target.add(shift);
      camera.position.add(shift);
      controls.update();
    }
    this.draw();
  }

  /** What keys act upon: the view that was used last. */
  #led() {
    const index = this.two ? (this.leader ?? 0) : 0;
    this.leader = index;
    return this.views[index];
  }

  /** Turns by steps of a key, as a drag to the right and down does. */
  turn(right, down) {
    const {controls} = this.#led();
    controls.rotateLeft((right * Math.PI) / 24);
    controls.rotateUp((down * Math.PI) / 24);
  }

  /** Moves what is seen by steps of a key. */
  move(right, down) {
    const {controls, holder} = this.#led();
    const step = 0.05 * Math.min(holder.clientWidth, holder.clientHeight);
    controls.pan(right * step, down * step);
  }

  /** Nearer by steps of a key, or farther. */
  approach(steps) {
    this.#led().controls.dollyIn(0.9 ** steps);
  }

  resize() {
    const stage = byId('stage');
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(stage.clientWidth, stage.clientHeight, false);
    for (const {camera, holder} of this.views)
      camera.aspect = holder.clientWidth / Math.max(holder.clientHeight, 1) || 1;
    this.draw();
  }

  draw() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = 0;
      for (const [index, {controls}] of this.views.entries()) {
        if ((index === 0 || this.two) && !(this.linked && this.two && index !== (this.leader ?? 0))) controls.update();
      }
      this.drawNow();
    });
  }

  /** The views that are shown, each with its place in the stage, CSS pixels. */
  shown() {
    const stage = byId('stage').getBoundingClientRect();
    return this.views.slice(0, this.two ? 2 : 1).map((view, index) => {
      const box = view.holder.getBoundingClientRect();
      return {
        ...view,
        index,
        x: box.left - stage.left,
        y: box.top - stage.top,
        width: box.width,
        height: box.height,
        stageHeight: stage.height,
      };
    });
  }

  drawNow() {
    this.renderer.setScissorTest(true);
    for (const view of this.shown()) {
      if (!(view.width > 0 && view.height > 0)) continue;
      const {camera} = view;
      const distance = camera.position.distanceTo(this.center);
      camera.aspect = view.width / view.height;
      camera.near = Math.max(distance - 1.01 * this.radius, camera.position.distanceTo(view.controls.target) * 0.01);
      camera.far = Math.max(distance + 1.01 * this.radius, camera.near * 1.01);
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
      const bottom = view.stageHeight - view.y - view.height;
      shared.pixels.value = (view.height * this.renderer.getPixelRatio()) / Math.tan(((angle / 2) * Math.PI) / 180);
      this.renderer.setViewport(view.x, bottom, view.width, view.height);
      this.renderer.setScissor(view.x, bottom, view.width, view.height);
      this.renderer.clear();
      this.renderer.render(this.scene, camera);
    }
    for (const listener of this.listeners) listener();
  }
}
