// The page that `soapfilm view` writes: reads its data, makes the scene, starts the viewer.
import {App} from './app.js';
import {readScene} from './data.js';
import {byId} from './dom.js';
import {buildScene} from './items.js';
import {picture} from './screenshot.js';

function loading(share, text) {
  byId('loading-bar').value = share;
  if (text) byId('loading-text').textContent = text;
}

async function main() {
  const began = performance.now();
  try {
    const data = await readScene((share) => loading(0.9 * share));
    loading(0.95, 'Preparing');
    const scene = await buildScene(data);
    const app = new App(data, scene);
    app.start();
    app.views.drawNow();
    byId('loading').remove();
    window.soapfilm = {app, data, picture, ready: performance.now() - began}; // for tests and the curious
    document.documentElement.dataset.ready = 'true';
  } catch (error) {
    byId('loading').classList.add('failed');
    loading(
      0,
      /WebGL/i.test(error.message)
        ? 'This browser has no WebGL 2, which the picture needs.'
        : `This page cannot be shown: ${error.message}`,
    );
    document.documentElement.dataset.ready = 'failed';
    throw error;
  }
}

main();
