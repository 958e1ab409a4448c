// The worker: reads files, reconstructs, sends what the page shows. To cancel, the page ends it.
/* global createSoapfilm */
import {engine} from './engine.js';
import {runParameters} from './limits.js';
import {originOf, ranges} from './scene.js';

let soapfilm = null;
let origin = [0, 0, 0];

const send = (type, content, transfer = []) => postMessage({type, ...content}, transfer);
const buffers = (arrays) => arrays.filter(Boolean).map((array) => array.buffer);
const tell = (kind, fraction, text) => send('event', {kind, fraction, text, memory: soapfilm?.memory() ?? 0});

/** Sets name the files that belong to them: only they are read. */
const isSet = (name) => /\.(conf|mlp|aln)$/i.test(name);

async function read(files) {
  soapfilm = await engine(createSoapfilm, tell);
  for (const file of files) {
    tell('stage', 0, `read ${file.name}`);
    soapfilm.put(file.name, new Uint8Array(await file.arrayBuffer()));
  }
  const sets = files.filter((file) => isSet(file.name));
  for (const file of sets.length ? sets : files) soapfilm.read(file.name);
  for (const file of files) soapfilm.forget(file.name);
  const summary = soapfilm.summary(runParameters);
  origin = originOf(summary.box);
  const preview = soapfilm.preview(400000, origin);
  send('cloud', {summary, origin, preview, memory: soapfilm.memory()}, buffers([preview.positions, preview.colors]));
}

function reconstruct(parameters) {
  soapfilm.reconstruct(parameters);
  const report = soapfilm.report();
  const mesh = soapfilm.mesh(origin);
  for (const attribute of mesh.attributes) Object.assign(attribute, ranges(attribute.values));
  const files = {ply: soapfilm.write('mesh.ply')};
  send(
    'mesh',
    {mesh, report, files, memory: soapfilm.memory()},
    buffers([mesh.positions, mesh.colors, mesh.indices, files.ply, ...mesh.attributes.map(({values}) => values)]),
  );
}

onmessage = async ({data}) => {
  try {
    if (data.type === 'read') await read(data.files);
    else if (data.type === 'reconstruct') reconstruct(data.parameters);
    else if (data.type === 'glb') {
      const bytes = soapfilm.write('mesh.glb');
      send('glb', {bytes}, [bytes.buffer]);
    }
  } catch (error) {
    const memory = error instanceof RangeError || /out of memory|memory access|unreachable/.test(error.message);
    send('failed', {
      message: memory ? `the browser gave no more memory: take a larger voxel (${error.message})` : error.message,
    });
  }
};
