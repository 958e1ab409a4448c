// The report beside the picture: what was done and what was proved, then all of it, key by key.
import {byId, element} from './dom.js';
import {grouped, percent, short} from './numbers.js';

const get = (object, path) => path.split('.').reduce((value, key) => value?.[key] ?? null, object);
const count = (value, one, many = `${one}s`) => `${grouped(value)} ${value === 1 ? one : many}`;

/** "closed, manifold, 1 component, genus 0" */
function topology(mesh) {
  if (!mesh || mesh.closed === undefined || mesh.closed === null) return null;
  const parts = [mesh.closed ? 'closed' : 'open', mesh.manifold ? 'manifold' : 'not manifold'];
  if (mesh.components !== null && mesh.components !== undefined) parts.push(count(mesh.components, 'component'));
  if (mesh.genus !== null && mesh.genus !== undefined) parts.push(`genus ${mesh.genus}`);
  return parts.join(', ');
}

function proof(report) {
  const gap = get(report, 'certificate.relative_gap_binary');
  if (gap === null) {
    const why = report.certificate ? 'This method has no lower bound.' : 'This method has no energy to judge.';
    return element('div', {class: 'proof none'}, element('b', {}, 'Nothing proved'), element('span', {}, why));
  }
  return element(
    'div',
    {class: 'proof'},
    element('b', {}, percent(gap)),
    element('span', {}, 'is the largest possible gap to the global optimum, proved by a lower bound.'),
  );
}

/** The facts that most people look for: [name, text], without those that the report does not have. */
function facts(report, unit) {
  const length = (value) => (value === null ? null : `${short(value, 4)}${unit ? ` ${unit}` : ''}`);
  const distance = get(report, 'mesh.sample_distance');
  const seconds = get(report, 'seconds.total');
  const bytes = get(report, 'memory.peak_bytes');
  const share = (path) => (get(report, path) === null ? null : percent(get(report, path)));
  const all = [
    ['Method', get(report, 'method.name')],
    ['Voxel', length(get(report, 'grid.voxel'))],
    ['Grid', get(report, 'grid.size')?.join(' × ')],
    ['Samples', get(report, 'input.samples') === null ? null : grouped(report.input.samples)],
    ['Scans', get(report, 'input.scans')],
    [
      'Samples per voxel²',
      get(report, 'input.samples_per_voxel2') === null ? null : short(report.input.samples_per_voxel2, 3),
    ],
    ['Lambda', get(report, 'certificate.lambda') === null ? null : short(report.certificate.lambda, 3)],
    ['Outside', get(report, 'border.outside')],
    ['Surface', topology(report.mesh)],
    [
      'Noise (1 sigma)',
      get(report, 'surface.refine.noise') === null ? null : `${short(report.surface.refine.noise, 2)} voxel`,
    ],
    ['Samples far from the mesh', share('self_check.lost')],
    ['Mesh far from samples', share('self_check.invented')],
    ['Distance of samples', distance ? `mean ${length(distance.mean)}, 99 %: ${length(distance.percentile99)}` : null],
    ['Coordinates', get(report, 'input.coordinate_system')],
    ['Time', seconds === null ? null : `${short(seconds, 3)} s`],
    ['Memory', bytes === null ? null : `${grouped(bytes / 2 ** 20)} MiB`],
  ];
  return all.filter(([, text]) => text !== null && text !== undefined && text !== '');
}

/** Any JSON, to be opened key by key. */
function tree(value) {
  if (value === null || typeof value !== 'object') return element('span', {}, value === null ? 'none' : String(value));
  const entries = Object.entries(value);
  if (Array.isArray(value) && entries.length <= 4 && entries.every(([, one]) => typeof one !== 'object'))
    return element('span', {}, value.join(', '));
  const rows = entries.map(([key, one]) => {
    const nested = one !== null && typeof one === 'object' && Object.keys(one).length > 0;
    if (!nested) return element('div', {class: 'leaf'}, element('span', {}, key), tree(one));
    const details = element('details', {}, element('summary', {}, key));
    details.addEventListener('toggle', () => details.childElementCount === 1 && details.append(tree(one)));
    return details;
  });
  return element('div', {class: 'tree'}, ...rows);
}

function one(item, unit, alone) {
  const {report} = item;
  const warnings = (report.warnings ?? []).map((line) => element('li', {}, line));
  const rows = facts(report, unit).flatMap(([name, text]) => [
    element('dt', {}, name),
    element('dd', {}, String(text)),
  ]);
  const all = element('details', {class: 'all'}, element('summary', {}, 'The whole report'));
  all.addEventListener('toggle', () => all.childElementCount === 1 && all.append(tree(report)));
  return [
    element('h2', {}, alone ? 'Report' : `Report of ${item.name}`),
    proof(report),
    warnings.length ? element('ul', {class: 'warnings'}, ...warnings) : null,
    element('dl', {}, ...rows),
    all,
  ];
}

export function showReports(data) {
  const reported = data.items.filter((item) => item.report);
  byId('report').hidden = reported.length === 0;
  const parts = reported.flatMap((item) => one(item, data.unit, reported.length === 1));
  byId('report').replaceChildren(...parts.filter((part) => part !== null));
}
