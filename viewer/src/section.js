// The section plane: what lies beyond it is cut away.
import {Vector3} from 'three';
import {byId, choice} from './dom.js';
import {shared} from './material.js';
import {digitsFor, fixed} from './numbers.js';

export class Section {
  constructor(data, views) {
    this.data = data;
    this.views = views;
    this.axis = 'off';
    this.share = 0.5;
    this.flipped = false;
    this.digits = digitsFor(2e-5 * views.radius);
    this.show = choice(
      byId('axis'),
      [
        ['off', 'Off'],
        ['x', 'X'],
        ['y', 'Y'],
        ['z', 'Z'],
        ['view', 'View', 'Across the line of sight'],
      ],
      this.axis,
      (axis) => this.setAxis(axis),
    );
    byId('section-at').oninput = (event) => this.setShare(Number(event.target.value));
    byId('section-number').onchange = (event) => this.#setPosition(Number(event.target.value));
    byId('flip').onclick = () => this.flip();
  }

  /** Unit normal, and where its plane can be: [lo, hi] along it. */
  #range() {
    const corners = [];
    for (let c = 0; c < 8; ++c)
      corners.push([0, 1, 2].map((k) => ((c >> k) & 1 ? this.views.hi[k] : this.views.lo[k])));
    const heights = corners.map((corner) => corner.reduce((sum, v, k) => sum + v * this.normal[k], 0));
    return [Math.min(...heights), Math.max(...heights)];
  }

  setAxis(axis) {
    this.axis = axis;
    if (axis === 'view') {
      const {camera, controls} = this.views.views[0];
      this.normal = camera.position.clone().sub(controls.target).normalize().toArray();
    } else {
      this.normal = new Vector3(axis === 'x' ? 1 : 0, axis === 'y' ? 1 : 0, axis === 'z' ? 1 : 0).toArray();
    }
    this.flipped = axis !== 'off' && this.#away();
    this.show(axis);
    byId('section-on').hidden = axis === 'off';
    this.#apply();
  }

  /** Whether the normal looks away from the viewer: the half in front is to be cut. */
  #away() {
    const {camera, controls} = this.views.views[0];
    return (
      camera.position
        .clone()
        .sub(controls.target)
        .dot(new Vector3(...this.normal)) < 0
    );
  }

  setShare(share) {
    this.share = Math.min(1, Math.max(0, share));
    this.#apply();
  }

  flip() {
    this.flipped = !this.flipped;
    this.#apply();
  }

  /** Of the plane's points n . p, in the input's coordinates. */
  #offset() {
    return this.normal.reduce((sum, v, k) => sum + v * this.data.origin[k], 0);
  }

  #setPosition(world) {
    const [lo, hi] = this.#range();
    if (Number.isFinite(world) && hi > lo) this.setShare((world - this.#offset() - lo) / (hi - lo));
  }

  #apply() {
    const plane = shared.section.value;
    if (this.axis === 'off') {
      plane.set(0, 0, 0, 0);
    } else {
      const [lo, hi] = this.#range();
      const at = lo + this.share * (hi - lo);
      const sign = this.flipped ? -1 : 1;
      plane.set(...this.normal.map((v) => sign * v), sign * at);
      byId('section-at').value = this.share;
      byId('section-number').value = fixed(at + this.#offset(), this.digits);
    }
    this.views.draw();
  }
}
