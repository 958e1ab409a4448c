// Scenes for the viewer, made in the browser as tools/view/ makes them for pages.
import {inWords} from './words.js';

/** Center of the box, rounded to a multiple of a power of two about as large as the box. */
export function originOf(box) {
  const longest = Math.max(...box.hi.map((v, k) => v - box.lo[k]));
  if (!(longest > 0)) return box.lo;
  const step = 2 ** Math.ceil(Math.log2(longest));
  return box.lo.map((v, k) => Math.round((v + box.hi[k]) / 2 / step) * step + 0);
}

/** Ends of the values, and without 2 % at both ends. */
export function ranges(values) {
  const finite = values.filter(Number.isFinite).sort();
  const at = (share) => finite[Math.floor(share * (finite.length - 1))] ?? 0;
  return {lo: at(0), hi: at(1), low: at(0.02), high: at(0.98)};
}

export function cloudItem(name, {summary, preview}) {
  const samples = preview.positions.length / 3;
  return {
    kind: 'samples',
    name,
    samples,
    source: {samples: summary.samples, scans: summary.scans},
    box: summary.box,
    radius: 0.7 * summary.spacing * Math.sqrt(summary.samples / Math.max(samples, 1)) || 1,
    attributes: [],
    report: null,
    positions: preview.positions,
    colors: preview.colors,
  };
}

export function meshItem(name, {mesh, report}, box) {
  const triangles = mesh.indices.length / 3,
    vertices = mesh.positions.length / 3;
  return {
    kind: 'mesh',
    name,
    triangles,
    vertices,
    source: {triangles, vertices},
    error: 0,
    box,
    report: JSON.parse(report, (_, value) => (typeof value === 'string' ? inWords(value) : value)),
    ...mesh,
    attributes: mesh.attributes.map((attribute) => ({...attribute, length: attribute.name === 'distance'})),
  };
}
