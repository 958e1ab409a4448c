// Scans dropped onto the page become a mesh, in a worker; then the viewer shows both.
import {App} from '../../viewer/src/app.js';
import {byId, element} from '../../viewer/src/dom.js';
import {buildScene} from '../../viewer/src/items.js';
import {grouped, short} from '../../viewer/src/numbers.js';
import {picture} from '../../viewer/src/screenshot.js';
import {Convergence} from './convergence.js';
import {pageBytes, runParameters} from './limits.js';
import {cloudItem, meshItem} from './scene.js';

const state = {worker: null, name: '', cloud: null, mesh: null, app: null};
const template = byId('stage').cloneNode(true);

function show(...ids) {
  for (const id of ['drop', 'run', 'settings', 'problem', 'actions']) byId(id).hidden = !ids.includes(id);
  byId('welcome').hidden = ids.length === 0;
}

function fail(message) {
  byId('problem').textContent = message;
  show('drop', 'problem', ...(state.cloud && state.worker ? ['settings'] : []));
}

/** The worker's script is a part of the page. */
function startWorker() {
  state.worker?.terminate();
  const script = new Blob([byId('worker').textContent], {type: 'text/javascript'});
  const address = URL.createObjectURL(script);
  state.worker = new Worker(address);
  state.worker.onmessage = ({data}) => hear[data.type](data);
  state.worker.onerror = (event) => fail(`the worker failed: ${event.message}`);
  URL.revokeObjectURL(address);
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
    state.app.setPanel(false);
    show('settings', 'actions');
  },
  async mesh(result) {
    state.mesh = result;
    const {item, origin, summary} = state.cloud;
    await view([copied(item), meshItem('mesh', result, summary.box)], origin);
    show();
    byId('results').hidden = false;
    document.documentElement.dataset.ready = 'mesh';
  },
  glb({bytes}) {
    save(bytes, 'glb');
  },
  failed({message}) {
    fail(message);
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
    name: files.length === 1 ? files[0].name : `${files.length} files`,
    cloud: null,
    mesh: null,
    warnings: [],
    stage: 'read',
    convergence: null,
  });
  byId('results').hidden = true;
  byId('gap').replaceChildren();
  byId('gap-line').textContent = '';
  startWorker();
  show('run', 'actions');
  state.worker.postMessage({type: 'read', files: [...files]});
}

function reconstruct(event) {
  event.preventDefault();
  state.convergence = new Convergence();
  const voxel = Number(byId('voxel').value);
  const up = byId('up').value;
  const parameters = {
    ...runParameters,
    ...(voxel > 0 ? {place: {voxel}} : {}),
    ...(up === 'auto' ? {} : {orient: {up}}),
    border: {outside: byId('outside').value},
  };
  show('run', 'actions');
  state.worker.postMessage({type: 'reconstruct', parameters});
}

function cancel() {
  state.worker?.terminate();
  state.worker = null;
  state.cloud = null;
  show('drop');
}

function save(bytes, extension) {
  const address = URL.createObjectURL(new Blob([bytes]));
  element('a', {href: address, download: `${state.name.replace(/\.[^.]*$/, '') || 'mesh'}.${extension}`}).click();
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
byId('files').onchange = (event) => read(event.target.files);
byId('settings').onsubmit = reconstruct;
byId('cancel').onclick = cancel;
byId('again').onclick = () => {
  document.body.classList.remove('viewing');
  byId('results').hidden = true;
  cancel();
};
byId('save-ply').onclick = () => save(state.mesh.files.ply, 'ply');
byId('save-glb').onclick = () => state.worker.postMessage({type: 'glb'});
byId('save-report').onclick = () => save(state.mesh.report, 'report.json');
byId('loading').remove();
show('drop');
document.documentElement.dataset.ready = 'true';
