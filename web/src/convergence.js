// The gap to the global optimum over time, as it shrinks.
import {byId, svg} from '../../viewer/src/dom.js';
import {percent} from '../../viewer/src/numbers.js';

export class Convergence {
  constructor() {
    this.began = performance.now();
    this.gaps = []; // [seconds, gap]
  }

  /** `detail` as the engine tells it: "level 2, gap 3.1e-4". */
  hear(detail) {
    const found = /gap ([\d.e+-]+)/.exec(detail);
    if (!found || !(Number(found[1]) > 0)) return;
    this.gaps.push([(performance.now() - this.began) / 1000, Number(found[1])]);
    this.draw();
  }

  draw() {
    const {gaps} = this;
    const begin = gaps[0][0],
      end = gaps.at(-1)[0];
    const logs = gaps.map(([, gap]) => Math.log10(gap));
    const top = Math.ceil(Math.max(...logs) + 0.01),
      bottom = Math.floor(Math.min(...logs) - 0.01);
    const x = (seconds) => (400 * (seconds - begin)) / Math.max(end - begin, 1e-3);
    const y = (log) => 4 + (112 * (top - log)) / Math.max(top - bottom, 1);
    const lines = [];
    for (let power = bottom; power <= top; ++power) lines.push(svg('path', {class: 'grid', d: `M0 ${y(power)}H400`}));
    const path = gaps
      .map(([seconds], i) => `${i ? 'L' : 'M'}${x(seconds).toFixed(1)} ${y(logs[i]).toFixed(1)}`)
      .join('');
    byId('gap').replaceChildren(...lines, svg('path', {d: path}));
    byId('gap-line').textContent =
      `within ${percent(gaps.at(-1)[1])} of the optimum of this level (${10 ** top} to ${10 ** bottom}, logarithmic)`;
  }
}
