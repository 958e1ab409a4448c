// The worker: reads files, reconstructs, sends what the page shows. To cancel, the page ends it.
/* global createSoapfilm */
import {engine} from './engine.js';
import {isSet, runParameters} from './limits.js';
import {originOf, ranges} from './scene.js';
import {inWords, withoutFolders} from './words.js';

let soapfilm = null;
let origin = [0, 0, 0];

const send = (type, content, transfer = []) => postMessage({type, ...content}, transfer);
const buffers = (arrays) => arrays.filter(Boolean).map((array) => array.buffer);
const tell = (kind, fraction, text) => send('event', {kind, fraction, text, memory: soapfilm?.memory() ?? 0});

async function load(files) {
  soapfilm = await engine(createSoapfilm, tell);
  for (const file of files) {
    tell('stage', 0, `read ${file.name}`);
    soapfilm.put(file.name, new Uint8Array(await file.arrayBuffer()));
  }
  const sets = files.filter((file) => isSet(file.name));
  for (const file of sets.length ? sets : files) soapfilm.read(file.name);
  for (const file of files) soapfilm.forget(file.name);
}

async function read({files}) {
  await load(files);
  const summary = soapfilm.summary(runParameters);
  origin = originOf(summary.box);
  const preview = soapfilm.preview(400000, origin);
  send('cloud', {summary, origin, preview, memory: soapfilm.memory()}, buffers([preview.positions, preview.colors]));
}

/** A worker that did not read the files, since the one before was ended, reads them now. */
async function reconstruct({parameters, files}) {
  if (!soapfilm) await load(files);
  soapfilm.reconstruct(parameters);
  const report = withoutFolders(soapfilm.report());
  const mesh = soapfilm.mesh(origin);
  for (const attribute of mesh.attributes) Object.assign(attribute, ranges(attribute.values));
  send(
    'mesh',
    {mesh, report, memory: soapfilm.memory()},
    buffers([mesh.positions, mesh.colors, mesh.indices, ...mesh.attributes.map(({values}) => values)]),
  );
}

function write({name}) {
  const bytes = soapfilm.write(name);
  send('written', {name, bytes}, [bytes.buffer]);
}

const tasks = {read, reconstruct, write};

onmessage = async ({data}) => {
  try {
    await tasks[data.type](data);
  } catch (error) {
    const memory = error instanceof RangeError || /out of memory|memory access|unreachable/.test(error.message);
    const message = inWords(error.message);
    send('failed', {
      during: data.type,
      message: memory ? `the browser gave no more memory: take a larger voxel (${message})` : message,
    });
  }
};
