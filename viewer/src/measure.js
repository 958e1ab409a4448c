// Distances between two clicks, in the units of the input and with its coordinates.
import {Vector3} from 'three';
import {byId, element, svg} from './dom.js';
import {digitsFor, fixed, short} from './numbers.js';
import {pick} from './pick.js';
import {shared} from './material.js';

export class Measure {
  constructor(data, views) {
    this.data = data;
    this.views = views;
    this.on = false;
    this.points = []; // at most two, in the page's own coordinates
    this.digits = digitsFor(2e-6 * views.radius);
    this.changed = () => {};
    for (const view of views.views) this.#listen(view.holder, views.views.indexOf(view));
    addEventListener('resize', () => this.draw());
    views.listeners.push(() => this.draw());
    this.#tell();
  }

  setOn(on) {
    this.on = on;
    byId('stage').classList.toggle('measuring', on);
    this.changed();
    this.#tell();
  }

  clear() {
    this.points = [];
    this.draw();
    this.#tell();
  }

  /** World coordinates: the origin is added in double precision. */
  world(point) {
    return point.map((v, k) => v + this.data.origin[k]);
  }

  coordinates(point) {
    return this.world(point).map((v) => fixed(v, this.digits));
  }

  /** A click is a press that hardly moves; what moves farther turns the view. */
  #listen(holder, index) {
    let down = null;
    holder.addEventListener('pointerdown', (event) => {
      down = event.isPrimary ? {x: event.clientX, y: event.clientY} : null;
    });
    holder.addEventListener('pointerup', (event) => {
      if (!down || event.button !== 0 || Math.hypot(event.clientX - down.x, event.clientY - down.y) > 4) return;
      if (this.on) this.#add(this.at(event, index, event.shiftKey));
    });
    holder.addEventListener('dblclick', (event) => {
      if (this.on) return;
      const hit = this.at(event, index, false);
      if (hit) this.views.turnAbout(index, hit.point);
    });
  }

  /** What is under the pointer in a view. */
  at(event, index, toVertex) {
    const view = this.views.shown()[index];
    const box = view.holder.getBoundingClientRect();
    return pick(
      this.data,
      view,
      {x: event.clientX - box.left, y: event.clientY - box.top},
      shared.section.value,
      toVertex,
    );
  }

  #add(hit) {
    if (!hit) return;
    if (this.points.length === 2) this.points = [];
    this.points.push(hit);
    this.draw();
    this.#tell();
  }

  distance() {
    const [a, b] = this.points.map((hit) => hit.point);
    return Math.hypot(...a.map((v, k) => b[k] - v));
  }

  length(value) {
    return `${fixed(value, this.digits)}${this.data.unit ? ` ${this.data.unit}` : ''}`;
  }

  #tell() {
    const rows = this.points.map((hit, k) => this.#row(hit, k));
    if (this.points.length === 2) rows.push(...this.#result());
    if (rows.length === 0) {
      const start = element(
        'button',
        {type: 'button', 'aria-pressed': String(this.on)},
        this.on ? 'Stop measuring' : 'Measure',
      );
      start.onclick = () => this.setOn(!this.on);
      rows.push(
        element(
          'p',
          {class: 'hint'},
          this.on
            ? 'Click two points. With Shift: the nearest vertex of the triangle.'
            : 'Distance of two points, and their coordinates.',
        ),
        start,
      );
    } else {
      rows.push(this.#buttons());
    }
    byId('measured').replaceChildren(...rows);
  }

  #row(hit, k) {
    const values = hit.item.attributes.map((attribute) => [attribute.name, attribute.values[hit.vertex]]);
    const tail = values.filter(([, value]) => !Number.isNaN(value)).map(([name, value]) => `${name} ${short(value)}`);
    return element(
      'div',
      {class: 'point'},
      element('b', {}, k === 0 ? 'A' : 'B'),
      element('span', {class: 'numbers'}, this.coordinates(hit.point).join('  ')),
      tail.length ? element('small', {}, tail.join(', ')) : null,
    );
  }

  #result() {
    const [a, b] = this.points.map((hit) => hit.point);
    const steps = a.map((v, k) => `d${'xyz'[k]} ${fixed(b[k] - v, this.digits)}`).join('  ');
    return [
      element('p', {class: 'big', id: 'distance'}, this.length(this.distance())),
      element('small', {class: 'numbers'}, steps),
    ];
  }

  text() {
    const lines = this.points.map((hit, k) => `${'AB'[k]} ${this.coordinates(hit.point).join(' ')}`);
    if (this.points.length === 2) lines.push(`distance ${this.length(this.distance())}`);
    return lines.join('\n');
  }

  #buttons() {
    const clear = element('button', {type: 'button'}, 'Clear');
    clear.onclick = () => this.clear();
    const copy = element('button', {type: 'button'}, 'Copy');
    copy.onclick = () =>
      copyText(this.text()).then(() => {
        copy.textContent = 'Copied';
      });
    return element('div', {class: 'row'}, clear, copy);
  }

  /** Marks and the line between them, over every view. */
  draw() {
    const marks = [];
    for (const view of this.views.shown()) {
      const places = this.points.map((hit) => project(view, hit.point));
      if (places.length === 2 && places.every(Boolean)) {
        const [a, b] = places;
        marks.push(
          svg('line', {x1: a.x, y1: a.y, x2: b.x, y2: b.y, class: 'halo'}),
          svg('line', {x1: a.x, y1: a.y, x2: b.x, y2: b.y}),
          svg('text', {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 - 10}, this.length(this.distance())),
        );
      }
      places.forEach(
        (place, k) =>
          place &&
          marks.push(
            svg('circle', {cx: place.x, cy: place.y, r: 4.5}),
            svg('text', {x: place.x + 10, y: place.y + 16, class: 'name'}, 'AB'[k]),
          ),
      );
    }
    byId('marks').replaceChildren(...marks);
  }
}

/** The place of a point in the stage, or null if it is behind the viewer or outside of the view. */
function project(view, point) {
  const p = new Vector3(...point).project(view.camera);
  if (p.z > 1 || Math.abs(p.x) > 1 || Math.abs(p.y) > 1) return null;
  return {x: view.x + ((p.x + 1) / 2) * view.width, y: view.y + ((1 - p.y) / 2) * view.height};
}

/** Pages of files may not write the clipboard in every browser: then by a selection. */
async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = element('textarea', {value: text});
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
}
