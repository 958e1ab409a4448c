// The legend: what the colors mean, in numbers of the input, with a histogram and ends that can be set.
import {byId, element, svg} from './dom.js';
import {gradient, labelCss} from './color.js';
import {missing} from './items.js';
import {setMap, shared} from './material.js';
import {digitsFor, fixed, short, ticks} from './numbers.js';

const bins = 72;

/** Counts of the values between the ends, over all items that are colored. */
function histogram(coloring, lo, hi) {
  const counts = new Float64Array(bins);
  for (const {values} of coloring.shown) {
    const step = Math.max(1, Math.floor(values.length / 2e5)); // enough for a picture
    for (let i = 0; i < values.length; i += step) {
      const value = values[i];
      if (value >= missing || value < lo || value > hi) continue;
      ++counts[Math.min(bins - 1, Math.floor(((value - lo) / (hi - lo || 1)) * bins))];
    }
  }
  return counts;
}

function curve(counts) {
  const most = Math.max(...counts, 1);
  let path = 'M0 20';
  counts.forEach((count, i) => {
    path += `L${i} ${20 - 19 * Math.sqrt(count / most)}L${i + 1} ${20 - 19 * Math.sqrt(count / most)}`;
  });
  return svg(
    'svg',
    {viewBox: `0 0 ${bins} 20`, preserveAspectRatio: 'none', class: 'histogram'},
    svg('path', {d: `${path}L${bins} 20Z`}),
  );
}

export class Legend {
  constructor(data, draw) {
    this.data = data;
    this.draw = draw;
  }

  show(coloring) {
    this.coloring = coloring;
    const legend = byId('legend');
    legend.hidden = coloring.kind !== 'scalar' && coloring.kind !== 'labels';
    byId('stage').classList.toggle('legend', !legend.hidden); // views end above it where the window is narrow
    if (coloring.kind === 'labels') this.#labels(coloring);
    if (coloring.kind === 'scalar') this.setRange(coloring.low, coloring.high);
  }

  #labels(coloring) {
    setMap('labels');
    const names = coloring.labels
      .slice(0, 24)
      .map((name, index) =>
        element('li', {}, swatch(labelCss(coloring.codes ? coloring.codes[index] : index)), String(name)),
      );
    if (coloring.labels.length > 24) names.push(element('li', {}, `and ${coloring.labels.length - 24} more`));
    byId('legend').replaceChildren(element('h3', {}, coloring.text), element('ul', {class: 'labels'}, ...names));
  }

  /** Ends of the colors, relative to the coloring's offset. */
  setRange(lo, hi) {
    if (!(Number.isFinite(lo) && Number.isFinite(hi))) return;
    if (!(hi > lo)) hi = lo + Math.max(Math.abs(lo) * 1e-6, 1e-12);
    this.lo = lo;
    this.hi = hi;
    const {coloring} = this;
    const map = lo < 0 && hi > 0 && coloring.key !== 'height' ? 'diverging' : 'sequential';
    if (map === 'diverging') this.lo = -(this.hi = Math.max(-lo, hi));
    setMap(map);
    shared.range.value.set(this.lo, this.hi);
    this.#fill(map);
    this.draw();
  }

  #fill(map) {
    const {coloring, lo, hi} = this;
    const offset = coloring.offset ?? 0;
    const marks = ticks(lo + offset, hi + offset, 4);
    const digits = digitsFor(marks.length > 1 ? marks[1] - marks[0] : hi - lo);
    const tick = (mark) => {
      const made = element('span', {}, digits > 5 || Math.abs(mark) >= 1e7 ? short(mark, 3) : fixed(mark, digits));
      made.style.left = `${(100 * (mark - offset - lo)) / (hi - lo)}%`;
      return made;
    };
    const bar = element('div', {class: 'bar'});
    bar.style.background = gradient(map);
    bar.dataset.map = map;
    const whole = element('button', {type: 'button', title: 'From the least to the greatest value'}, 'All');
    whole.onclick = () => this.setRange(coloring.lo, coloring.hi);
    const most = element('button', {type: 'button', title: 'Without the outermost 2 % at both ends'}, '96 %');
    most.onclick = () => this.setRange(coloring.low, coloring.high);
    const unit = coloring.length ? this.data.unit : '';
    byId('legend').replaceChildren(
      element('h3', {}, coloring.text, unit ? element('small', {}, ` ${unit}`) : null),
      curve(histogram(coloring, lo, hi)),
      bar,
      element('div', {class: 'ticks'}, ...marks.map(tick)),
      element(
        'div',
        {class: 'ends'},
        this.#end('lo', offset),
        coloring.key === 'height' ? null : most,
        coloring.key === 'height' ? null : whole,
        this.#end('hi', offset),
      ),
    );
  }

  #end(name, offset) {
    const input = element('input', {
      type: 'number',
      step: 'any',
      'aria-label': name === 'lo' ? 'Least value' : 'Greatest value',
    });
    const value = this[name] + offset;
    input.value = offset ? fixed(value, digitsFor((this.hi - this.lo) * 1e-3)) : short(value, 4);
    input.onchange = () => {
      const typed = Number(input.value) - offset;
      const [lo, hi] = name === 'lo' ? [typed, this.hi] : [this.lo, typed];
      if (hi > lo) this.setRange(lo, hi);
      else this.setRange(this.lo, this.hi);
    };
    return input;
  }
}

/** A dot of a color. (The page allows no style attributes in markup; properties it does.) */
export function swatch(color) {
  const made = element('i', {class: 'swatch'});
  made.style.background = color;
  return made;
}
