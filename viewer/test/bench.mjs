// How long the page takes to load two million triangles: run.sh PROGRAM VIEWER_BUILD FOLDER bench.mjs [TRIANGLES]
import {closeSync, openSync, statSync, writeSync} from 'node:fs';
import {fileURLToPath} from 'node:url';
import {inOut, launch, makePage} from './kit.mjs';

/** A ball with bumps as a binary PLY, some `count` triangles. */
function bumpyBall(path, count) {
  const rows = Math.round(Math.sqrt(count / 4)),
    columns = 2 * rows;
  const vertices = new Float32Array(3 * rows * columns);
  for (let r = 0, to = 0; r < rows; ++r) {
    for (let c = 0; c < columns; ++c) {
      const theta = (Math.PI * (r + 0.5)) / rows,
        phi = (2 * Math.PI * c) / columns;
      const radius =
        1 + 0.05 * Math.sin(9 * theta) * Math.sin(8 * phi) + 0.004 * Math.sin(90 * theta) * Math.cos(70 * phi);
      vertices[to++] = radius * Math.sin(theta) * Math.cos(phi);
      vertices[to++] = radius * Math.sin(theta) * Math.sin(phi);
      vertices[to++] = radius * Math.cos(theta);
    }
  }
  const triangles = 2 * (rows - 1) * columns;
  const faces = Buffer.alloc(13 * triangles);
  let to = 0;
  const face = (...corners) => {
    to = faces.writeUInt8(3, to);
    for (const corner of corners) to = faces.writeUInt32LE(corner, to);
  };
  for (let r = 0; r + 1 < rows; ++r) {
    for (let c = 0; c < columns; ++c) {
      const next = (c + 1) % columns;
      face(r * columns + c, (r + 1) * columns + c, (r + 1) * columns + next);
      face(r * columns + c, (r + 1) * columns + next, r * columns + next);
    }
  }
  const file = openSync(path, 'w');
  writeSync(
    file,
    `ply\nformat binary_little_endian 1.0\nelement vertex ${rows * columns}\nproperty float x\nproperty float y\n` +
      `property float z\nelement face ${triangles}\nproperty list uchar uint vertex_indices\nend_header\n`,
  );
  writeSync(file, Buffer.from(vertices.buffer));
  writeSync(file, faces);
  closeSync(file);
  return triangles;
}

const mesh = inOut('bench.ply');
const triangles = bumpyBall(mesh, Number(process.argv[2] ?? 2e6));
const began = performance.now();
const address = makePage('bench', [mesh], '--triangles', '0');
const written = performance.now();
const mib = (path) => (statSync(path).size / 2 ** 20).toFixed(1);
console.log(
  `${triangles} triangles: mesh ${mib(mesh)} MiB, page ${mib(fileURLToPath(address))} MiB, ` +
    `written in ${((written - began) / 1000).toFixed(2)} s`,
);
const browser = await launch();
for (let round = 0; round < 3; ++round) {
  const page = await browser.newPage({viewport: {width: 1600, height: 900}});
  const start = performance.now();
  await page.goto(address);
  await page.waitForFunction(() => document.documentElement.dataset.ready, undefined, {timeout: 60000});
  const ready = performance.now() - start;
  const own = await page.evaluate(() => window.soapfilm.ready);
  console.log(
    `loaded and drawn in ${(ready / 1000).toFixed(2)} s, of which scripts and drawing ${(own / 1000).toFixed(2)} s`,
  );
  await page.close();
}
await browser.close();
