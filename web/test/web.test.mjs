// The page that reconstructs, in headless Chromium: node web.test.mjs (by viewer/test/run.sh, with SOAPFILM_PAGE).
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {copyFileSync, mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {after, before, test} from 'node:test';
import {pathToFileURL} from 'node:url';
import {inOut, launch, open, pixels} from '../../viewer/test/kit.mjs';

const address = pathToFileURL(resolve(process.env.SOAPFILM_PAGE)).href;
const program = process.env.SOAPFILM_PROGRAM;
const run = (...args) => execFileSync(program, [...args, '--quiet'], {stdio: ['ignore', 'ignore', 'inherit']});
let browser;

before(async () => {
  run('scan', 'torus', '-o', inOut('torus'), '--samples', '8000', '--noise', '0.2%');
  browser = await launch();
});
after(() => browser?.close());

test('scans become the mesh of the program, and nothing is asked of the network', async () => {
  const {page, faults} = await open(browser, address);
  await page.setInputFiles('#files', inOut('torus/samples.ply'));
  await page.waitForSelector('#settings:not([hidden])', {timeout: 60000});
  assert.match(await page.innerText('#found'), /8,000 samples/);
  const ids = await page.$$eval('[id]', (all) => all.map(({id}) => id));
  assert.equal(new Set(ids).size, ids.length, 'two elements of one id');
  assert.match(await page.innerText('#memory'), /at most 4,096 MiB for a page: voxels down to about 0\.00\d+ fit/);
  await page.selectOption('#upright', '-y'); // changes nothing, the samples have normals
  await page.click('#start');
  await page.waitForFunction(() => document.documentElement.dataset.ready === 'mesh', undefined, {timeout: 60000});
  assert.ok(new Set(await pixels(page)).size > 50, 'the picture is blank');
  assert.match(await page.innerText('#report'), /gap to the global optimum/);
  await page.screenshot({path: inOut('web.png')});
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save-ply')]);
  await download.saveAs(inOut('web.ply'));
  const asked = ['--distance', '--gap', '--report', inOut('program.json')];
  run('reconstruct', inOut('torus/samples.ply'), '-o', inOut('program.ply'), ...asked);
  const body = (name) => readFileSync(inOut(name), 'latin1').replace(/^comment.*\n/gm, '');
  assert.ok(body('web.ply') === body('program.ply'), 'other bytes than the program');
  const [report] = await Promise.all([page.waitForEvent('download'), page.click('#save-report')]);
  assert.equal(report.suggestedFilename(), 'samples.mesh.report.json');
  await report.saveAs(inOut('web.json'));
  assert.equal(JSON.parse(readFileSync(inOut('web.json'), 'utf8')).parameters.orient.up, '-y');
  assert.ok(!readFileSync(inOut('web.json'), 'utf8').includes('/in/'), 'a folder of the engine');
  const programs = JSON.parse(readFileSync(inOut('program.json'), 'utf8')).mesh;
  for (const [format, begins] of [
    ['ply', 'ply\n'],
    ['glb', 'glTF'],
    ['obj', 'v '],
    ['stl', ''],
  ]) {
    const [saved] = await Promise.all([page.waitForEvent('download'), page.click(`#save-${format}`)]);
    assert.equal(saved.suggestedFilename(), `samples.mesh.${format}`);
    await saved.saveAs(inOut(`saved.${format}`));
    assert.ok(readFileSync(inOut(`saved.${format}`), 'latin1').startsWith(begins), format);
    const facts = JSON.parse(execFileSync(program, ['info', '--json', inOut(`saved.${format}`)], {encoding: 'utf8'}));
    assert.equal(facts[0].triangles, programs.triangles, format);
  }
  assert.deepEqual(faults, []);
});

test('a file that is none is refused in words', async () => {
  const {page, faults} = await open(browser, address);
  await page.setInputFiles('#files', {
    name: 'broken.ply',
    mimeType: 'application/octet-stream',
    buffer: Buffer.from('ply\nno'),
  });
  await page.waitForSelector('#problem:not([hidden])');
  assert.match(await page.innerText('#problem'), /broken\.ply/);
  assert.deepEqual(faults, []);
});

/** Chooses files and waits until they are read. */
async function choose(page, ...files) {
  await page.setInputFiles('#files', files);
  await page.waitForSelector('#settings:not([hidden])', {timeout: 60000});
}

async function finish(page) {
  await page.evaluate(() => (document.documentElement.dataset.ready = 'true'));
  await page.click('#start');
  await page.waitForFunction(
    () => document.documentElement.dataset.ready === 'mesh' || !document.getElementById('problem').hidden,
    undefined,
    {timeout: 60000},
  );
  assert.ok(!(await page.isVisible('#problem')), await page.innerText('#problem'));
}

const triangles = (page) => page.evaluate(() => window.soapfilm.data.items.find(({indices}) => indices).triangles);

test('after a run that is cancelled or refused the next one works on the files that were read', async () => {
  const {page, faults} = await open(browser, address);
  await choose(page, inOut('torus/samples.ply'));
  await page.click('#start');
  await page.click('#cancel');
  assert.ok(await page.isVisible('#settings'), 'the settings are not there');
  await finish(page);
  const whole = await triangles(page);
  await page.click('#change');
  await page.fill('#voxel', '0.00001');
  await page.click('#start');
  await page.waitForSelector('#problem:not([hidden])', {timeout: 60000});
  const refusal = await page.innerText('#problem');
  assert.match(refusal, /voxel = 1e-05, must be at least 0\.000\d+/);
  assert.ok(!/--[a-z]|\/in\//.test(refusal), refusal);
  await page.fill('#resolution', '40');
  assert.equal(await page.inputValue('#voxel'), '', 'a voxel and a resolution contradict each other');
  await finish(page);
  const coarse = await triangles(page);
  assert.ok(coarse < whole, `${coarse} of ${whole} triangles`);
  assert.equal(await page.isVisible('#problem'), false);
  await page.click('#again');
  assert.ok(await page.isVisible('#drop'));
  assert.deepEqual(faults, []);
});

test('a smaller mesh, by a tolerance or by a number of triangles', async () => {
  const {page, faults} = await open(browser, address);
  await choose(page, inOut('torus/samples.ply'));
  await page.fill('#triangles', '2000');
  await finish(page);
  const report = () => page.evaluate(() => JSON.parse(window.soapfilm.state.mesh.report).surface.simplify);
  const few = await triangles(page);
  assert.ok(few <= 2000 && few > 1500, `${few} triangles`);
  assert.ok((await report()).proved_distance > 0);
  await page.click('#change');
  await page.selectOption('#simplify', 'auto');
  assert.equal(await page.inputValue('#triangles'), '', 'a tolerance and a number contradict each other');
  await finish(page);
  const {triangles_before: all, triangles: left} = await report();
  assert.equal(await triangles(page), left);
  assert.ok(left < all / 2, `${left} of ${all} triangles`);
  assert.deepEqual(faults, []);
});

test('the same file can be chosen again after it was refused, and after a mesh', async () => {
  const {page, faults} = await open(browser, address);
  for (let time = 0; time < 2; ++time) {
    await page.setInputFiles('#files', {name: 'bad.ply', mimeType: '', buffer: Buffer.from('ply\nno')});
    await page.waitForSelector('#problem:not([hidden])');
    assert.match(await page.innerText('#problem'), /^bad\.ply:/);
    assert.equal(await page.inputValue('#files'), '', 'a browser tells nothing when the same file is chosen again');
  }
  await choose(page, inOut('torus/samples.ply'));
  await page.click('#cancel');
  await choose(page, inOut('torus/samples.ply'));
  assert.deepEqual(faults, []);
});

test('a scanner position and the upright axis go into the run, a wrong position is refused', async () => {
  const points = inOut('plain.xyz');
  const rows = Array.from({length: 900}, (_, i) => [(i % 30) / 30, Math.floor(i / 30) / 30, Math.sin(i % 30) / 90]);
  writeFileSync(points, `${rows.map((row) => row.join(' ')).join('\n')}\n`);
  const {page, faults} = await open(browser, address);
  await choose(page, points);
  await page.fill('#sensor', '0.5, 0.5');
  await page.click('#start');
  assert.match(await page.innerText('#problem'), /Scanner position: three numbers/);
  await page.fill('#sensor', '0.5, 0.5, 4');
  await page.selectOption('#upright', '-z');
  await finish(page);
  const report = await page.evaluate(() => JSON.parse(window.soapfilm.state.mesh.report));
  assert.deepEqual(report.parameters.orient.sensor, [0.5, 0.5, 4]);
  assert.equal(report.parameters.orient.up, '-z');
  assert.deepEqual(faults, []);
});

test('warnings name the fields of the page, and GLB is read', async () => {
  run('reconstruct', inOut('torus/samples.ply'), '-o', inOut('torus.glb'), '--resolution', '40');
  const {page, faults} = await open(browser, address);
  await choose(page, inOut('torus.glb'));
  await page.fill('#resolution', '30');
  await finish(page);
  assert.equal(await page.textContent('#items b >> nth=1'), 'torus.mesh');
  await page.click('#again');
  const ball = Array.from({length: 2000}, (_, i) => {
    const z = 1 - (2 * i + 1) / 2000,
      r = Math.sqrt(1 - z * z);
    return `${r * Math.cos(2.399963 * i)} ${r * Math.sin(2.399963 * i)} ${z}`;
  });
  writeFileSync(inOut('ball.xyz'), `${ball.join('\n')}\n`);
  await choose(page, inOut('ball.xyz'));
  await finish(page);
  const warnings = await page.innerText('#report .warnings');
  assert.match(warnings, /“Scanner position”.*“Beyond the samples lies: solid matter”/);
  assert.ok(!/--[a-z]|\/in\//.test(await page.innerText('body')), warnings);
  assert.deepEqual(faults, []);
});

test('every kind of points that the program reads can be chosen', async () => {
  const rows = readFileSync('docs/reference/formats.md', 'utf8').matchAll(/^\| (`\.[^|]*) \| yes \|/gm);
  const extensions = [...rows].flatMap(([, names]) => [...names.matchAll(/`(\.\w+)`/g)].map(([, name]) => name));
  assert.ok(extensions.length > 20 && extensions.includes('.laz'));
  const {page} = await open(browser, address);
  const accepted = (await page.getAttribute('#files', 'accept')).split(/[\s,]+/);
  assert.deepEqual(accepted.sort(), extensions.sort());
});

test('a small window shows all of it: nothing is wider, samples stay in sight', async () => {
  const {page, faults} = await open(browser, address, {viewport: {width: 400, height: 600}});
  const shot = (name) => page.screenshot({path: inOut(`${name}.png`)});
  const fits = async (name) => {
    await page.waitForTimeout(400);
    await shot(name);
    const wide = await page.$$eval('button, input, select, p', (all) =>
      all.filter((one) => one.offsetParent && one.getBoundingClientRect().right > 400).map(({id}) => id),
    );
    assert.deepEqual(wide, [], name);
  };
  await fits('small-begin');
  await choose(page, inOut('torus/samples.ply'));
  await fits('small-settings');
  assert.ok((await page.locator('#view0').boundingBox()).height > 150, 'no room for the samples');
  await page.locator('#start').scrollIntoViewIfNeeded();
  await finish(page);
  await fits('small-mesh');
  assert.ok((await page.locator('#results').boundingBox()).height < 100, 'the buttons take the picture');
  assert.deepEqual(faults, []);
});

test('a worker of another page imports the module of the npm package', async () => {
  const folder = inOut('module');
  mkdirSync(folder, {recursive: true});
  copyFileSync(join(dirname(resolve(process.env.SOAPFILM_PAGE)), 'npm/soapfilm.mjs'), join(folder, 'soapfilm.mjs'));
  writeFileSync(join(folder, 'index.html'), '<!doctype html><link rel="icon" href="data:,"><title>Page</title>');
  const worker = `import {engine} from './soapfilm.mjs';
    onmessage = async ({data}) => {
      const soapfilm = await engine();
      soapfilm.put('a.ply', data);
      soapfilm.read('a.ply');
      soapfilm.reconstruct({place: {resolution: 48}});
      postMessage(soapfilm.mesh([0, 0, 0]).indices.length / 3);
    };`;
  writeFileSync(join(folder, 'worker.mjs'), worker);
  const server = spawn('node', ['web/serve.mjs', folder, '0'], {stdio: ['ignore', 'pipe', 'inherit']});
  try {
    const [line] = await server.stdout.map(String).take(1).toArray();
    const page = await (await browser.newContext()).newPage();
    await page.goto(line.match(/http:\S+/)[0]);
    const samples = [...readFileSync(inOut('torus/samples.ply'))];
    const triangles = await page.evaluate(
      (bytes) =>
        new Promise((done, fail) => {
          const worker = new Worker('worker.mjs', {type: 'module'});
          worker.onmessage = ({data}) => done(data);
          worker.onerror = ({message}) => fail(new Error(message));
          worker.postMessage(new Uint8Array(bytes));
        }),
      samples,
    );
    run('reconstruct', inOut('torus/samples.ply'), '-o', inOut('module.ply'), '--resolution', '48');
    const [facts] = JSON.parse(execFileSync(program, ['info', '--json', inOut('module.ply')], {encoding: 'utf8'}));
    assert.equal(triangles, facts.triangles);
  } finally {
    server.kill();
  }
});
