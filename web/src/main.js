// Scans dropped onto the page become a mesh, in a worker; then the viewer shows both.
import {App} from '../../viewer/src/app.js';
import {byId, element} from '../../viewer/src/dom.js';
import {buildScene} from '../../viewer/src/items.js';
import {grouped, short} from '../../viewer/src/numbers.js';
import {picture} from '../../viewer/src/screenshot.js';
import {Convergence} from './convergence.js';
import {isSet, pageBytes, runParameters} from './limits.js';
import {cloudItem, meshItem} from './scene.js';

// used: the worker has begun a run, and its samples are gone; doing: its task.
const state = {worker: null, used: false, doing: '', files: [], name: '', cloud: null, mesh: null, app: null};
const template = byId('stage').cloneNode(true);

function show(...ids) {
  for (const id of ['drop', 'run', 'settings', 'problem', 'actions']) byId(id).hidden = !ids.includes(id);
  byId('welcome').hidden = ids.length === 0;
  byId('results').hidden = ids.length > 0;
  byId('cancel').textContent = ids.includes('settings') ? 'Other files' : ids.includes('run') ? 'Cancel' : 'Close';
  state.app?.views.resize();
}

/** What was read stays: only a file that cannot be read leads back to the choice of files. */
function fail(message, during = state.doing) {
  byId('problem').textContent = message;
  if (during === 'write') return show('problem', 'actions');
  if (!state.cloud) return begin('problem');
  startWorker();
  return show('settings', 'problem', 'actions');
}

/** The worker's script is a part of the page. */
function startWorker() {
  state.worker?.terminate();
  const script = new Blob([byId('worker').textContent], {type: 'text/javascript'});
  const address = URL.createObjectURL(script);
  const worker = new Worker(address);
  worker.onmessage = ({data}) => worker === state.worker && hear[data.type](data);
  worker.onerror = (event) => worker === state.worker && fail(`the worker failed: ${event.message}`);
  Object.assign(state, {worker, used: false});
  URL.revokeObjectURL(address);
}

function ask(task, content) {
  state.doing = task;
  state.worker.postMessage({type: task, ...content});
}

const mib = (bytes) => `${grouped(bytes / 2 ** 20)} MiB`;

/** Shows a scene in a viewer that knows nothing of the one before. */
async function view(items, origin) {
  state.app?.views.renderer.dispose();
  byId('stage').replaceWith(template.cloneNode(true));
  byId('loading').remove();
  const data = {version: state.version ?? '', title: state.name, unit: '', up: state.up, origin, items};
  state.app = new App(data, await buildScene(data));
  state.app.start();
  window.soapfilm = {app: state.app, data, picture, state};
  document.body.classList.add('viewing');
}

/** All samples in sight, beside the settings. */
function showCloud() {
  state.app.setPanel(false);
  show('settings', 'actions');
  state.app.views.fit();
}

/** Positions can be shown twice: buffers that went to a viewer are its own. */
const copied = (item) => ({...item, attributes: item.attributes.map((attribute) => ({...attribute}))});

const hear = {
  event({kind, fraction, text, memory}) {
    if (kind === 'stage') state.stage = text;
    if (kind === 'stage' || kind === 'advance') {
      byId('stage-line').textContent = `${state.stage}${kind === 'advance' && text ? `: ${text}` : ''}`;
      byId('stage-bar').value = fraction;
      if (state.stage === 'solve') state.convergence?.hear(text);
    }
    if (kind === 'warning') state.warnings.push(text);
    byId('memory').textContent = memoryLine(memory);
  },
  async cloud({summary, origin, preview, memory}) {
    state.up = summary.coordinate_system ? 'z' : 'y';
    state.cloud = {item: cloudItem(state.name, {summary, preview}), origin, summary};
    byId('found').textContent =
      `${grouped(summary.samples)} samples in ${grouped(summary.scans)} scan${summary.scans === 1 ? '' : 's'}, ` +
      `about ${short(summary.spacing, 3)} apart`;
    byId('voxel').placeholder = `about ${short(summary.spacing, 2)}`;
    byId('memory').textContent = memoryLine(memory);
    await view([copied(state.cloud.item)], origin);
    showCloud();
  },
  async mesh(result) {
    state.mesh = result;
    const {item, origin, summary} = state.cloud;
    await view([copied(item), meshItem(meshName(), result, summary.box)], origin);
    show();
    state.app.views.fit();
    document.documentElement.dataset.ready = 'mesh';
  },
  written({name, bytes}) {
    save(bytes, name);
  },
  failed({message, during}) {
    fail(message, during);
  },
};

const memoryLine = (used) => {
  const smallest = state.cloud?.summary.smallest_voxel;
  return (
    `Memory: ${mib(used)} in use, at most ${mib(pageBytes)} for a page` +
    (smallest ? `: voxels down to about ${short(smallest, 2)} fit.` : '.') +
    ' A run that would not fit is refused before it begins.'
  );
};

function read(files) {
  if (!files.length) return;
  Object.assign(state, {
    files: [...files],
    name: files.length === 1 ? files[0].name : `${files.length} files`,
    cloud: null,
    mesh: null,
    warnings: [],
    stage: 'read',
  });
  byId('settings').reset();
  forgetGap();
  startWorker();
  show('run', 'actions');
  ask('read', {files: state.files});
}

function forgetGap() {
  state.convergence = null;
  byId('gap').replaceChildren();
  byId('gap-line').textContent = '';
}

/** Named after the set or the first file, as the program names it. */
function meshName() {
  const named = state.files.find(({name}) => isSet(name)) ?? state.files[0];
  return `${named.name.replace(/\.[^.]*$/, '')}.mesh`;
}

/** What the settings say, or null where they cannot be understood. */
function settings() {
  const number = (id) => Number(byId(id).value);
  const place = number('voxel') > 0 ? {voxel: number('voxel')} : null;
  const across = number('resolution') > 0 ? {resolution: number('resolution')} : null;
  const sensor = byId('sensor').value.trim();
  const position = sensor ? sensor.split(/[\s,;]+/).map(Number) : null;
  if (position && !(position.length === 3 && position.every(Number.isFinite))) return null;
  const up = byId('upright').value;
  return {
    ...runParameters,
    ...(place || across ? {place: place ?? across} : {}),
    orient: {...(up === 'auto' ? {} : {up}), ...(position ? {sensor: position} : {})},
    border: {outside: byId('outside').value},
    ...(number('triangles') > 0 ? {simplify: {triangles: number('triangles')}} : simplifyParameters()),
  };
}

function simplifyParameters() {
  const choice = byId('simplify').value;
  if (choice === 'off') return {};
  return {simplify: choice === 'auto' ? {automatic: true} : {tolerance_vox: Number(choice)}};
}

function reconstruct(event) {
  event.preventDefault();
  const parameters = settings();
  if (!parameters) {
    byId('problem').textContent = 'Scanner position: three numbers, such as 1.5, 0, 2';
    show('settings', 'problem', 'actions');
    return;
  }
  if (state.used) startWorker();
  forgetGap();
  state.convergence = new Convergence();
  state.used = true;
  state.stage = 'begin';
  show('run', 'actions');
  ask('reconstruct', {parameters, files: state.files});
}

/** A run that is cancelled leaves what was read; without a run the page begins anew. */
function cancel() {
  if (!byId('run').hidden && state.cloud) {
    startWorker();
    show('settings', 'actions');
  } else if (state.mesh && byId('settings').hidden) {
    show();
  } else {
    begin();
  }
}

/** The page as it was opened. */
function begin(...besides) {
  state.worker?.terminate();
  Object.assign(state, {worker: null, cloud: null, mesh: null});
  document.body.classList.remove('viewing');
  show('drop', ...besides);
}

/** The samples again, for a run with other settings. */
async function change() {
  state.mesh = null;
  await view([copied(state.cloud.item)], state.cloud.origin);
  showCloud();
}

function save(content, name) {
  const address = URL.createObjectURL(new Blob([content]));
  element('a', {href: address, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

addEventListener('dragover', (event) => {
  event.preventDefault();
  document.body.classList.add('over');
});
addEventListener('dragleave', () => document.body.classList.remove('over'));
addEventListener('drop', (event) => {
  event.preventDefault();
  document.body.classList.remove('over');
  read(event.dataTransfer.files);
});
byId('files').onchange = ({target}) => {
  const files = [...target.files];
  target.value = ''; // so that the same files can be chosen again
  read(files);
};
byId('settings').onsubmit = reconstruct;
for (const [id, other] of [
  ['voxel', 'resolution'],
  ['resolution', 'voxel'],
])
  byId(id).oninput = () => (byId(other).value = '');
byId('triangles').oninput = () => (byId('simplify').value = 'off');
byId('simplify').oninput = () => (byId('triangles').value = '');
byId('cancel').onclick = cancel;
byId('change').onclick = change;
byId('again').onclick = () => begin();
for (const extension of ['ply', 'glb', 'stl', 'obj'])
  byId(`save-${extension}`).onclick = () => ask('write', {name: `${meshName()}.${extension}`});
byId('save-report').onclick = () => save(state.mesh.report, `${meshName()}.report.json`);
byId('loading').remove();
show('drop');
document.documentElement.dataset.ready = 'true';
