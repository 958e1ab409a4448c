// The viewer: a scene with its tools and its panel.
import {byId, choice, element} from './dom.js';
import {icon} from './icons.js';
import {colorBy, colorings, makeCoarse, showCoarse, showEdges, showIn} from './items.js';
import {listen} from './keys.js';
import {Legend} from './legend.js';
import {Measure} from './measure.js';
import {shared} from './material.js';
import {captions, head, listItems} from './panel.js';
import {showReports} from './report.js';
import {savePicture} from './screenshot.js';
import {Section} from './section.js';
import {Views} from './views.js';

const narrow = matchMedia('(max-width: 760px)');
const smoothly = 1000000; // triangles that are turned as they are

/** The two items that are compared, if there are just two: the first left, the second right. */
const compared = (data) => data.items.length === 2;

export class App {
  constructor(data, scene) {
    this.data = data;
    this.views = new Views(data, scene);
    this.section = new Section(data, this.views);
    this.measure = new Measure(data, this.views);
    this.legend = new Legend(data, () => this.views.draw());
    this.colorings = colorings(data);
    data.items.forEach((item, index) => showIn(item, compared(data) ? [index === 0, index === 1] : [true, true]));
  }

  start() {
    const {data, views} = this;
    head(data);
    showReports(data);
    this.#colors();
    this.#look();
    this.#tools();
    this.#keys();
    this.setTwo(compared(data));
    this.setPanel(!narrow.matches);
    views.look('corner', data.up);
    this.coarse = makeCoarse(data, smoothly).then((made) => {
      if (made) views.coarsely = (on) => showCoarse(data, on);
      return made;
    });
  }

  setTwo(on) {
    if (!on) for (const item of this.data.items) showIn(item, [item.views[0] || item.views[1], item.views[1]]);
    else if (compared(this.data)) this.data.items.forEach((item, index) => showIn(item, [index === 0, index === 1]));
    this.views.setTwo(on);
    this.showLayout?.(on ? 'two' : 'one');
    byId('link-row').hidden = !on;
    this.#press('two', on);
    listItems(this.data, this.views);
    captions(this.data, this.views);
  }

  setPanel(open) {
    document.body.classList.toggle('panel-open', open);
    this.#press('panel', open);
    this.views.resize();
  }

  setColoring(coloring) {
    this.coloring = coloring;
    byId('color-by').value = coloring.key;
    colorBy(this.data, coloring, {axis: this.views.up === 'y' ? 1 : 2});
    this.legend.show(coloring);
    this.views.draw();
  }

  #colors() {
    const select = byId('color-by');
    select.replaceChildren(...this.colorings.map(({key, text}) => element('option', {value: key}, text)));
    select.onchange = () => this.setColoring(this.colorings.find(({key}) => key === select.value));
    this.setColoring(this.colorings.find(({kind}) => kind === 'color') ?? this.colorings[0]);
    byId('smooth').onchange = (event) => {
      shared.smooth.value = event.target.checked ? 1 : 0;
      this.views.draw();
    };
    byId('edges').onchange = (event) => {
      showEdges(this.data, event.target.checked);
      this.views.draw();
    };
    byId('size').oninput = (event) => {
      for (const item of this.data.items)
        if (item.radius) item.object.material.uniforms.radius.value = item.radius * 2 ** Number(event.target.value);
      this.views.draw();
    };
    byId('size-row').hidden = !this.data.items.some((item) => item.radius);
    byId('edges-row').hidden = !this.data.items.some((item) => item.indices);
  }

  #look() {
    const sides = ['front', 'back', 'left', 'right', 'top', 'bottom'];
    choice(
      byId('sides'),
      sides.map((side) => [side, side[0].toUpperCase() + side.slice(1)]),
      '',
      (side) => this.views.look(side),
    );
    const showUp = choice(
      byId('up'),
      [
        ['y', 'Y'],
        ['z', 'Z'],
      ],
      this.data.up,
      (up) => {
        showUp(up);
        this.views.look('corner', up);
        if (this.coloring.key === 'height') this.setColoring(this.coloring);
      },
    );
    this.showLayout = choice(
      byId('layout'),
      [
        ['one', 'Together'],
        ['two', 'Side by side'],
      ],
      'one',
      (key) => this.setTwo(key === 'two'),
    );
    byId('layout-row').hidden = this.data.items.length < 2;
    byId('link').onchange = (event) => this.views.setLinked(event.target.checked);
  }

  #press(name, on) {
    byId(`tool-${name}`)?.setAttribute('aria-pressed', String(on));
  }

  #tools() {
    const tools = [
      ['fit', 'All in the picture (F)', () => this.views.fit()],
      ['two', 'Side by side (2)', () => this.setTwo(!this.views.two)],
      ['section', 'Section (X, Y, Z)', () => this.toggleSection()],
      ['measure', 'Measure a distance (M)', () => this.measure.setOn(!this.measure.on)],
      ['picture', 'Save a picture (P)', () => this.save()],
      ['help', 'Keys and mouse (?)', () => this.help()],
      ['panel', 'Panel (H)', () => this.setPanel(!document.body.classList.contains('panel-open'))],
    ];
    const buttons = tools.map(([name, title, action]) => {
      const button = element('button', {type: 'button', id: `tool-${name}`, title, 'aria-label': title}, icon(name));
      button.onclick = action;
      return button;
    });
    byId('tools').replaceChildren(...buttons);
    byId('tool-two').hidden = this.data.items.length < 2;
    this.measure.changed = () => this.#press('measure', this.measure.on);
  }

  /** On across x, or off. A narrow window shows the panel for its slider. */
  toggleSection() {
    this.setSection(this.section.axis === 'off' ? 'x' : 'off');
    if (this.section.axis !== 'off') this.setPanel(true);
    byId('section').scrollIntoView({block: 'nearest'});
  }

  setSection(axis) {
    this.section.setAxis(this.section.axis === axis ? 'off' : axis);
    this.#press('section', this.section.axis !== 'off');
  }

  save() {
    savePicture(this.views, this.data.title.replace(/[^\w.-]+/g, '_') || 'view');
  }

  nextColor(step) {
    const count = this.colorings.length;
    this.setColoring(this.colorings[(this.colorings.indexOf(this.coloring) + step + count) % count]);
  }

  flick(id) {
    if (byId(id).closest('[hidden]')) return;
    byId(id).checked = !byId(id).checked;
    byId(id).onchange({target: byId(id)});
  }

  help() {
    byId('help').showModal();
    byId('help').scrollTop = 0;
  }

  escape() {
    if (this.measure.points.length) this.measure.clear();
    else if (this.measure.on) this.measure.setOn(false);
    else if (this.section.axis !== 'off') this.setSection('off');
  }

  #keys() {
    const {section, views} = this;
    const move = (step) => section.axis !== 'off' && section.setShare(section.share + step);
    const arrows = [
      ['ArrowLeft', -1, 0],
      ['ArrowRight', 1, 0],
      ['ArrowUp', 0, -1],
      ['ArrowDown', 0, 1],
    ];
    const [first, ...others] = arrows.map(([name, x, y]) => [name, null, () => views.turn(x, y)]);
    const [firstShift, ...othersShift] = arrows.map(([name, x, y]) => [`Shift+${name}`, null, () => views.move(x, y)]);
    listen([
      [first[0], 'turn', first[2], '← ↑ → ↓'],
      ...others,
      [firstShift[0], 'move', firstShift[2], 'Shift + ← ↑ → ↓'],
      ...othersShift,
      ['+', 'nearer', () => views.approach(1)],
      ['=', null, () => views.approach(1)], // the key of + without Shift
      ['-', 'farther', () => views.approach(-1)],
      ['f', 'all in the picture', () => views.fit()],
      ['1', 'from the front', () => views.look('front')],
      ['3', 'from the right', () => views.look('right')],
      ['7', 'from the top', () => views.look('top')],
      ['0', 'from a corner', () => views.look('corner')],
      ['2', 'side by side, or together', () => this.data.items.length > 1 && this.setTwo(!views.two)],
      ['l', 'link the cameras, or not', () => this.flick('link')],
      ['c', 'next coloring', () => this.nextColor(1)],
      ['s', 'smooth or flat shading', () => this.flick('smooth')],
      ['e', 'edges of the triangles', () => this.flick('edges')],
      ['x', 'section across x', () => this.setSection('x')],
      ['y', 'section across y', () => this.setSection('y')],
      ['z', 'section across z', () => this.setSection('z')],
      ['v', 'section across the line of sight', () => this.setSection('view')],
      ['PageUp', 'section forward', () => move(0.01), 'Page ↑'],
      ['PageDown', 'section back', () => move(-0.01), 'Page ↓'],
      ['r', 'the other side of the section', () => section.axis !== 'off' && section.flip()],
      ['m', 'measure a distance', () => this.measure.setOn(!this.measure.on)],
      ['p', 'save a picture', () => this.save()],
      ['h', 'hide or show the panel', () => this.setPanel(!document.body.classList.contains('panel-open'))],
      ['Escape', 'clear the distance, then the tool', () => this.escape(), 'Esc'],
      ['?', 'this page', () => this.help()],
    ]);
  }
}
