// The gap to the global optimum over time, as it shrinks on each level of the pyramid, coarse to fine.
import {byId, svg} from '../../viewer/src/dom.js';
import {percent} from '../../viewer/src/numbers.js';

export class Convergence {
  constructor() {
    this.began = performance.now();
    this.levels = []; // {level, gaps: [seconds, log10 of the gap]}
  }

  /** `detail` of the stage `solve`, as the engine tells it: "level 2, 60 iterations, gap 3.1e-4". */
  hear(detail) {
    const found = /level (\d+).*gap ([\d.e+-]+)/.exec(detail);
    if (!found || !(Number(found[2]) > 0)) return;
    const level = Number(found[1]);
    if (this.levels.at(-1)?.level !== level) this.levels.push({level, gaps: []});
    this.levels.at(-1).gaps.push([(performance.now() - this.began) / 1000, Math.log10(Number(found[2]))]);
    this.draw();
  }

  draw() {
    const gaps = this.levels.flatMap((level) => level.gaps);
    const begin = gaps[0][0],
      end = gaps.at(-1)[0];
    const logs = gaps.map(([, log]) => log);
    const top = Math.ceil(Math.max(...logs) + 0.01),
      bottom = Math.floor(Math.min(...logs) - 0.01);
    const x = (seconds) => ((400 * (seconds - begin)) / Math.max(end - begin, 1e-3)).toFixed(1);
    const y = (log) => (4 + (112 * (top - log)) / Math.max(top - bottom, 1)).toFixed(1);
    const lines = [];
    for (let power = bottom; power <= top; ++power) lines.push(svg('path', {class: 'grid', d: `M0 ${y(power)}H400`}));
    for (const level of this.levels) {
      const path = level.gaps.map(([seconds, log]) => `${x(seconds)} ${y(log)}`).join('L');
      lines.push(svg('path', {class: level === this.levels.at(-1) ? 'now' : 'coarser', d: `M${path}h.1`}));
    }
    byId('gap').replaceChildren(...lines);
    const {level, gaps: own} = this.levels.at(-1);
    const which = level === 0 ? 'the finest level' : `level ${level}, 0 is the finest`;
    byId('gap-line').textContent =
      `${which}: within ${percent(10 ** own.at(-1)[1])} of its optimum (lines: ${percent(10 ** top)} to ` +
      `${percent(10 ** bottom)}, by ten)`;
  }
}
