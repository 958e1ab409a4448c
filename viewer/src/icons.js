// Icons of the tools: strokes in a square of 24.
import {svg} from './dom.js';

const strokes = {
  fit: 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5',
  two: 'M3 5h8v14H3zM13 5h8v14h-8z',
  section: 'M12 3l8 4.5v9L12 21l-8-4.5v-9zM2 14l20-4',
  measure: 'M3 16L16 3l5 5L8 21zM7 12l2.5 2.5M10 9l1.5 1.5M13 6l2.5 2.5',
  picture: 'M4 7h4l1.5-2h5L16 7h4v12H4zM12 16a3.5 3.5 0 1 0 0-7 3.5 3.5 0 0 0 0 7z',
  panel: 'M4 6h16M4 12h16M4 18h16',
  help: 'M9 9a3 3 0 1 1 4.5 2.6c-1 .6-1.5 1.2-1.5 2.4M12 17.5v.5',
};

export function icon(name) {
  return svg('svg', {viewBox: '0 0 24 24', class: 'icon', 'aria-hidden': 'true'}, svg('path', {d: strokes[name]}));
}
