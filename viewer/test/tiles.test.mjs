// `soapfilm tiles` and `simplify --lod` make what others read: Khronos's validator passes every GLB, 3DTilesRendererJS
// loads the tileset in headless Chromium, coarse from far and fine from near, upright and without a gap: node
// tiles.test.mjs (by run.sh).
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {bundler} from '../build.mjs';
import {inOut, launch} from './kit.mjs';

const {SOAPFILM_PROGRAM: program, SOAPFILM_MODULES: modules} = process.env;
const soapfilm = (...words) => execFileSync(program, ['--quiet', ...words], {stdio: ['ignore', 'ignore', 'inherit']});
const folder = inOut('tiles');
const site = 'http://localhost';
let browser;

/** What the page runs: `show(place, target)`, in parts of the tileset's size, looks from there and waits for tiles. */
const script = `
import {TilesRenderer} from '3d-tiles-renderer';
import {Box3, Color, DirectionalLight, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer} from 'three';
const renderer = new WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
renderer.setSize(640, 640);
document.body.append(renderer.domElement);
const camera = new PerspectiveCamera(40, 1, 0.001, 1000), scene = new Scene();
scene.background = new Color(0xffffff);
const light = new DirectionalLight(0xffffff, 3);
scene.add(light, camera);
const tiles = new TilesRenderer('${site}/tileset.json');
tiles.errorTarget = 0.05; // pixels
tiles.setCamera(camera);
tiles.setResolutionFromRenderer(camera, renderer);
scene.add(tiles.group);
const failed = [];
tiles.addEventListener('load-error', ({error}) => failed.push(String(error)));
const colors = ['#c9c2b4', '#9db4c9', '#d9b382', '#a9c79a', '#c99da8'];
window.show = async (place, target) => {
  const sphere = new Sphere();
  for (let still = 0; still < 20; ) {
    if (tiles.getBoundingSphere(sphere)) {
      const at = (parts) => new Vector3(...parts).multiplyScalar(sphere.radius).add(sphere.center);
      camera.position.copy(at(place));
      camera.up.set(0, 0, 1);
      camera.lookAt(at(target));
      light.position.copy(camera.position);
      light.target = tiles.group;
    }
    camera.updateMatrixWorld();
    tiles.update();
    await new Promise((next) => requestAnimationFrame(next));
    const {downloading, parsing} = tiles.stats;
    still = tiles.root && !downloading && !parsing ? still + 1 : 0;
  }
  let triangles = 0;
  const box = new Box3(), depths = new Set();
  tiles.forEachLoadedModel((model, tile) => {
    if (!tiles.visibleTiles.has(tile)) return;
    const depth = Number(tile.content.uri.match(/(\\d+)_\\d+_\\d+_\\d+\\.glb/)[1]);
    depths.add(depth);
    box.expandByObject(model, true);
    model.traverse((part) => {
      if (!part.geometry) return;
      triangles += part.geometry.index.count / 3;
      part.material.color.set(colors[depth % colors.length]);
    });
  });
  renderer.render(scene, camera);
  const [lo, hi] = [box.min.toArray(), box.max.toArray()];
  return {triangles, tiles: tiles.visibleTiles.size, depths: depths.size, failed, lo, hi};
};
document.documentElement.dataset.ready = 'true';
`;

before(async () => {
  soapfilm('scan', 'knot', '-o', inOut('knot'), '--samples', '80000');
  soapfilm('reconstruct', inOut('knot/samples.ply'), '-o', inOut('knot.ply'), '--resolution', '160');
  rmSync(folder, {recursive: true, force: true});
  soapfilm('tiles', inOut('knot.ply'), '-o', folder, '--triangles', '4000');
  browser = await launch();
});
after(() => browser?.close());

/** What the validator has to say of a GLB. */
async function issues(path) {
  const {validateBytes} = createRequire(join(modules, 'modules.js'))('gltf-validator');
  return (await validateBytes(new Uint8Array(readFileSync(path)))).issues.messages;
}

test('the validator finds nothing in any GLB', async () => {
  const names = readdirSync(join(folder, 'tiles'));
  assert.ok(names.length > 8);
  for (const name of names) assert.deepEqual(await issues(join(folder, 'tiles', name)), [], name);
});

test('levels of detail are valid: it does not know their extension, so it takes further nodes for unused', async () => {
  soapfilm('simplify', inOut('knot.ply'), '-o', inOut('lod.glb'), '--tolerance', '0.1%', '--lod', '3');
  const found = (await issues(inOut('lod.glb'))).map(({code, pointer}) => `${code} ${pointer}`);
  assert.deepEqual(found.sort(), [
    'UNSUPPORTED_EXTENSION /extensionsUsed/0',
    'UNUSED_OBJECT /nodes/1',
    'UNUSED_OBJECT /nodes/2',
    'UNUSED_OBJECT /nodes/3',
  ]);
});

test('a viewer shows it, coarse from far and whole from near', async () => {
  writeFileSync(inOut('tiles.mjs'), script);
  const bundled = await bundler(modules).bundle(inOut('tiles.mjs'));
  const html = `<body style="margin:0"><script type="module">${bundled}</script>`;
  const page = await browser.newPage({viewport: {width: 640, height: 640}});
  const faults = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  await page.route(`${site}/**`, (route) => {
    const {pathname} = new URL(route.request().url());
    if (pathname === '/') return route.fulfill({contentType: 'text/html', body: html});
    return route.fulfill({path: join(folder, pathname)});
  });
  await page.goto(`${site}/`);
  await page.waitForFunction(() => document.documentElement.dataset.ready);
  const show = (place, target) => page.evaluate((eyes) => window.show(...eyes), [place, target]);
  const far = await show([16, -21, 54], [0, 0, 0]);
  const near = await show([0.9, -1.1, 2.9], [0, 0, 0]);
  const mixed = await show([0.55, -1.0, 0.5], [0.05, 0.0, 0.0]);
  await page.screenshot({path: inOut('tiles.png')});
  assert.deepEqual([...faults, ...mixed.failed], []);
  assert.ok(mixed.depths > 1, 'fine in front, coarse behind');
  assert.equal(far.tiles, 1);
  assert.ok(near.tiles > 4 && near.triangles > 2 * far.triangles, JSON.stringify({far, near}));
  // In place and upright: glTF's y is up, a tileset's z.
  const [{box}] = JSON.parse(execFileSync(program, ['info', '--json', inOut('knot.ply')]));
  const ends = [...box.lo, ...box.hi];
  [...near.lo, ...near.hi].forEach((v, k) => assert.ok(Math.abs(v - ends[k]) < 1e-3, `${k}: ${v}, not ${ends[k]}`));
});
