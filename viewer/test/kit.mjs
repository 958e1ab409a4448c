// What the tests of the page share: files to view, the program, the browser.
import {execFileSync} from 'node:child_process';
import {writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';

const {SOAPFILM_PROGRAM: program, SOAPFILM_MODULES: modules, SOAPFILM_OUT: out} = process.env;
export const inOut = (name) => join(out, name);

/** Runs `soapfilm view` and returns the page's address. */
export function makePage(name, files, ...options) {
  const page = inOut(`${name}.html`);
  execFileSync(program, ['view', ...files, '--html', page, '--quiet', ...options], {
    stdio: ['ignore', 'ignore', 'inherit'],
  });
  return pathToFileURL(page).href;
}

/** A PLY with coordinates in double. `columns`: [name, type, value(i)] beside them. */
export function writePly(name, points, triangles, columns = []) {
  const head = [
    'ply',
    'format ascii 1.0',
    `element vertex ${points.length}`,
    'property double x',
    'property double y',
    'property double z',
    ...columns.map(([column, type]) => `property ${type} ${column}`),
    ...(triangles ? [`element face ${triangles.length}`, 'property list uchar int vertex_indices'] : []),
    'end_header',
  ];
  const rows = points.map((point, i) => [...point, ...columns.map(([, , value]) => value(i))].join(' '));
  const faces = (triangles ?? []).map((triangle) => `3 ${triangle.join(' ')}`);
  writeFileSync(inOut(name), `${[...head, ...rows, ...faces].join('\n')}\n`);
  return inOut(name);
}

/** A box from a corner, its sides cut into `cuts` pieces: points and triangles, outward. */
export function box(corner, size, cuts = 1) {
  const points = [],
    triangles = [],
    known = new Map();
  const vertex = (point) => {
    const key = point.join();
    if (!known.has(key)) known.set(key, points.push(point.map((v, k) => corner[k] + (v / cuts) * size[k])) - 1);
    return known.get(key);
  };
  for (let axis = 0; axis < 3; ++axis) {
    for (const side of [0, cuts]) {
      for (let i = 0; i < cuts; ++i) {
        for (let j = 0; j < cuts; ++j) {
          const at = (a, b) => {
            const point = [0, 0, 0];
            point[axis] = side;
            point[(axis + 1) % 3] = i + a;
            point[(axis + 2) % 3] = j + b;
            return vertex(point);
          };
          const square = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
          if (!side) square.reverse();
          triangles.push([square[0], square[1], square[2]], [square[0], square[2], square[3]]);
        }
      }
    }
  }
  return {points, triangles};
}

const flags = [
  '--headless',
  '--no-sandbox',
  '--disable-gpu',
  '--use-gl=angle',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

export function launch() {
  const {chromium} = createRequire(join(modules, 'modules.js'))('playwright-core');
  return chromium.launch({executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: flags});
}

/** A tab that shows the page; `faults` collects errors of the console and every request but the page's own. */
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({viewport: {width: 900, height: 640}, reducedMotion: 'reduce', ...options});
  const page = await context.newPage();
  page.setDefaultTimeout(10000);
  const faults = [];
  page.on(
    'console',
    (message) =>
      ['error', 'warning'].includes(message.type()) &&
      !/GPU stall|swiftshader/i.test(message.text()) &&
      faults.push(message.text()),
  );
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on(
    'request',
    (request) =>
      request.url() !== address && !/^(data|blob):/.test(request.url()) && faults.push(`request ${request.url()}`),
  );
  await page.goto(address);
  await page.waitForFunction(() => document.documentElement.dataset.ready, undefined, {timeout: 60000});
  return {page, faults, context};
}

/** What the views show: colors of pixels, coarsely. */
export const pixels = (page) =>
  page.evaluate(() => {
    const {app, picture} = window.soapfilm;
    const canvas = picture(app.views);
    const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const shown = [];
    for (let i = 0; i < data.length; i += 4 * 7) shown.push((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return shown;
  });

/** Share of the pixels that differ. */
export const difference = (a, b) => a.filter((color, i) => color !== b[i]).length / a.length;

/** The place on the screen of a point in the world, seen in a view. */
export const place = (page, world, view = 0) =>
  page.evaluate(
    ([point, index]) => {
      const {app, data} = window.soapfilm;
      const shown = app.views.shown()[index];
      shown.camera.updateMatrixWorld();
      const local = shown.camera.position
        .clone()
        .set(...point.map((v, k) => v - data.origin[k]))
        .project(shown.camera);
      const holder = shown.holder.getBoundingClientRect();
      return {x: holder.left + ((local.x + 1) / 2) * holder.width, y: holder.top + ((1 - local.y) / 2) * holder.height};
    },
    [world, view],
  );
